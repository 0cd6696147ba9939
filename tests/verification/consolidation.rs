//! One-dimensional consolidation of a confined layer with a drained surface (Terzaghi; Mow et al. 1980).
//!
//! T = c_v t/H^2, c_v = k M, m = (2n+1) pi/2, alpha = 1. Under a sudden load p0: settlement u = (p0 H/M) U(T),
//! U(T) = 1 - sum (2/m^2) exp(-m^2 T); pressure at the base p/p0 = sum (2/m) (-1)^n exp(-m^2 T). U is also the creep of Mow et al.
//! Under a ramp of the surface's displacement V t: stress M (V/H) [t + (2 H^2/(c_v pi^2)) sum n^-2 (1 - exp(-n^2 pi^2 T))]; holding
//! the displacement from t0 on subtracts the same with t - t0. Varied: time step; both formulations. Strains of 1e-5: they are
//! finite in the code, so that 1e-4 is the tolerance.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use cartilage_contact::equations::tissue::Tissue;
use cartilage_contact::laws::solid::NeoHookean;

use crate::strip::{Condition, P, Strip, X, Y, flat, orders, uniform};

const H: f64 = 1e-3;
const K: f64 = 1e-12;
const M: f64 = 0.5e6 + 0.6e6;

/// A column, drained at the surface; the surface's displacement is free or prescribed.
fn column(consistent: bool, order: i32, surface: Condition) -> Strip {
    let tissue = Tissue {
        solid: NeoHookean { shear_modulus: 0.45e6, bulk_modulus: 0.5e6 }.into(),
        biot_coefficient: 1.0,
        mobility: K,
        tangential_ratio: 1.0,
        profile: None,
        strain_dependence: None,
        fluid_compressibility: 0.0,
        consistent,
    };
    let depths = uniform(1.0, if order == 2 { 24 } else { 64 }).into_iter().map(|s| H * s * s).collect::<Vec<_>>();
    let base = depths.len() - 1;
    Strip::new(flat(&uniform(H / 4.0, 1), &depths, order), tissue, [1e-8, 10.0], |field, i, j| match (field, i, j) {
        (X, 0 | 2, _) => Condition::Fixed,
        (X | Y, _, j) if j == base => Condition::Fixed,
        (X, _, 0) | (P, _, 0) => Condition::Fixed,
        (Y, 1 | 2, 0) if surface == Condition::Free => Condition::SameAs(0, 0),
        (Y, _, 0) => surface,
        _ => Condition::Free,
    })
}

fn terms(f: impl Fn(f64, f64) -> f64) -> f64 {
    (0..400).map(|n| f((f64::from(n) + 0.5) * PI, if n % 2 == 0 { 1.0 } else { -1.0 })).sum()
}

fn settlement(time: f64) -> f64 {
    1.0 - terms(|m, _| 2.0 / (m * m) * (-m * m * time).exp())
}

fn base_pressure(time: f64) -> f64 {
    terms(|m, sign| 2.0 / m * sign * (-m * m * time).exp())
}

/// Settlement and pressure at the base after a sudden load, relative, at T.
fn creep(consistent: bool, order: i32, time: f64, steps: usize) -> [f64; 2] {
    let p0 = 10.0;
    let mut strip = column(consistent, order, Condition::Free);
    let dt = time * H * H / (K * M) / steps as f64;
    for step in 0..steps {
        strip.step(step as f64 * dt, dt, |strip, _| strip.sources[Y][0] = -p0 * H / 4.0);
    }
    [strip.value(Y, 0) * -M / (p0 * H), strip.value(P, strip.node(0, strip.mesh.levels() - 1)) / p0]
}

#[test]
fn terzaghi_and_the_creep_of_mow() {
    for (time, u, p) in [(0.1, 0.356823, 0.949305), (0.5, 0.763950, 0.370777)] {
        assert_relative_eq!(settlement(time), u, max_relative = 2e-6);
        assert_relative_eq!(base_pressure(time), p, max_relative = 2e-6);
        for (consistent, order) in [(false, 2), (true, 2), (true, 1)] {
            let [measured, base] = creep(consistent, order, time, 64);
            println!("T {time}, consistent {consistent}, order {order}: U {measured}, p_base/p0 {base}");
            assert_relative_eq!(measured, u, max_relative = 1e-3);
            assert_relative_eq!(base, p, max_relative = 1e-3);
        }
    }
}

/// Even after the jump at t = 0 the L-stable method is of order two at a later time.
#[test]
fn terzaghi_is_of_second_order_in_time() {
    let time = 0.5;
    let errors = [4, 8, 16].map(|steps| (creep(true, 2, time, steps)[1] - base_pressure(time)).abs());
    let observed = orders(&errors);
    println!("errors {errors:?}, orders {observed:?}");
    assert!((observed[1] - 2.0).abs() < 0.3, "{observed:?} of {errors:?}");
}

/// Varied: both formulations; before and after the end of the ramp at T0 = 0.2.
#[test]
fn ramp_and_relaxation_of_mow() {
    let unit = H * H / (K * M);
    let (end, speed) = (0.2 * unit, 1e-5 * H / (0.2 * unit));
    let ramp = |t: f64| {
        let sum: f64 = (1..2000).map(f64::from).map(|n| (1.0 - (-(n * PI).powi(2) * t / unit).exp()) / (n * n)).sum();
        if t > 0.0 { M * speed / H * (t + 2.0 * unit / PI.powi(2) * sum) } else { 0.0 }
    };
    for consistent in [false, true] {
        let mut strip = column(consistent, 2, Condition::Fixed);
        let dt = end / 40.0;
        for step in 0..80 {
            strip.step(f64::from(step) * dt, dt, |strip, time| {
                for n in [0, 1, 2].map(|i| strip.node(i, 0)) {
                    strip.prescribed[Y][n] = -speed * time.min(end);
                }
            });
            let time = f64::from(step + 1) * dt;
            if [20, 40, 60, 80].contains(&(step + 1)) {
                // With p = 0 on the surface the effective stress is the total one.
                let force: f64 = (0..3).map(|i| strip.reactions[Y][strip.node(i, 0)]).sum();
                let exact = ramp(time) - ramp(time - end);
                println!("consistent {consistent}, t/t0 {}: {} of {exact} Pa", time / end, -force / (H / 4.0));
                assert_relative_eq!(-force / (H / 4.0), exact, max_relative = 1e-3);
            }
        }
    }
}
