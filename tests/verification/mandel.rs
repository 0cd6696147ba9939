//! Mandel's problem (Mandel 1953; Cheng & Detournay 1988), a layer squeezed between rigid, frictionless, impermeable plates and
//! drained at its sides, in plane strain with alpha = 1 and nu_u = 1/2:
//!
//! p/p0 = 2 sum sin b/(b - sin b cos b) (cos(b x/a) - cos b) exp(-b^2 T), tan b = ((1-nu)/(nu_u-nu)) b, T = c_v t/a^2, p0 = F/(2a).
//!
//! nu = 0.2. Varied: time step and order of the pressure (`consistent`: the total stress is what the plates balance). The pressure
//! rises before it falls, which only the coupling can do. Finite strains of 1e-5.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use cartilage_contact::equations::tissue::Tissue;
use cartilage_contact::laws::solid::NeoHookean;

use crate::strip::{Condition, P, Strip, X, Y, flat, orders, uniform};

const A: f64 = 1e-3;
const G: f64 = 0.5e6;
const BULK: f64 = G * 2.0 * 1.2 / (3.0 * 0.6);
const MOBILITY: f64 = 1e-12;

/// Pressure at the centre relative to p0.
fn centre(time: f64) -> f64 {
    let roots = (0..60).map(|n| {
        // tan b = (0.8/0.3) b, one root in each ((n) pi, (n + 1/2) pi).
        let (mut low, mut high) = (f64::from(n) * PI + 1e-9, (f64::from(n) + 0.5) * PI - 1e-12);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if middle.tan() < 0.8 / 0.3 * middle { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    });
    roots.map(|b| 2.0 * b.sin() / (b - b.sin() * b.cos()) * (1.0 - b.cos()) * (-b * b * time).exp()).sum()
}

/// The same by the code, in equal steps.
fn computed(time: f64, steps: usize, order: i32) -> f64 {
    let tissue = Tissue {
        solid: NeoHookean { shear_modulus: G, bulk_modulus: BULK }.into(),
        biot_coefficient: 1.0,
        mobility: MOBILITY,
        tangential_ratio: 1.0,
        profile: None,
        strain_dependence: None,
        fluid_compressibility: 0.0,
        consistent: true,
    };
    // A quarter: x from the centre to the drained side, the plate at the "surface" y = 0.
    let lengths: Vec<f64> =
        uniform(1.0, if order == 2 { 24 } else { 64 }).into_iter().map(|s| A * s * (2.0 - s)).collect();
    let last = lengths.len() - 1;
    let mesh = flat(&lengths, &uniform(A / 4.0, 2), order);
    let base = mesh.levels() - 1;
    let mut strip = Strip::new(mesh, tissue, [1e-8, 10.0], |field, i, j| match field {
        X if i == 0 => Condition::Fixed,
        Y if j == base => Condition::Fixed,
        Y if j == 0 && i > 0 => Condition::SameAs(0, 0),
        P if i == last => Condition::Fixed,
        _ => Condition::Free,
    });
    let p0 = 10.0;
    let dt = time * A * A / (MOBILITY * (BULK + 4.0 / 3.0 * G)) / steps as f64;
    for step in 0..steps {
        strip.step(step as f64 * dt, dt, |strip, _| strip.sources[Y][0] = -2.0 * p0 * A);
    }
    strip.value(P, 0) / p0
}

#[test]
fn pressure_at_the_centre_rises_and_falls() {
    for (time, p) in [(0.01, 1.04376), (0.1, 1.09541), (0.5, 0.59279)] {
        assert_relative_eq!(centre(time), p, max_relative = 1e-5);
        for order in [2, 1] {
            let measured = computed(time, 64, order);
            println!("T {time}, pressure order {order}: p/p0 {measured}, exact {p}");
            assert_relative_eq!(measured, p, max_relative = 1e-3);
        }
    }
}

#[test]
fn it_is_of_second_order_in_time() {
    let errors = [4, 8, 16].map(|steps| (computed(0.5, steps, 2) - centre(0.5)).abs());
    let observed = orders(&errors);
    println!("errors {errors:?}, orders {observed:?}");
    assert!((observed[1] - 2.0).abs() < 0.3, "{observed:?} of {errors:?}");
}
