//! A pressure p = P exp(i q x/t) that stands still on the surface of a layer moving with +v; linear, steady, impermeable base, the
//! surface's effective traction -s P n (literal paper: s = 0; total stress: s = 1 - alpha). Computed by an independent code for
//! G = 0.45 MPa, K = 0.5 MPa, t = 1 mm, v = 0.1 m/s, k = 1e-12 m^4/(N s): u_y G/(t P), outflow V t/(k P), pressure at the base
//! p_base/P, all complex. Without motion V = -q tanh q and p_base = 1/cosh q.
//!
//! On one period of a flat strip whose ends are one, so that there is no entry. A real wave P cos(q x/t) of 1e-3 Pa (linear to
//! 1e-8); its answers by their Fourier coefficients, V from the reactions of the surface's fluid balances.
//! Varied: q, formulation, motion. 96 x 24 elements, finer at the surface; tolerance 2e-4 of the answer's size (five digits in
//! the table, and a boundary layer of a tenth of t).

use std::f64::consts::PI;

use cartilage_contact::equations::tissue::Tissue;
use cartilage_contact::fem::mesh::{graded, quadratic_stations};
use cartilage_contact::laws::solid::NeoHookean;

use crate::strip::{Condition, P, Strip, X, Y, flat, uniform};

const G: f64 = 0.45e6;
const T: f64 = 1e-3;
const K: f64 = 1e-12;

/// u_y G/(t P), V t/(k P), p_base/P, each as real and imaginary part.
fn answer(q: f64, consistent: bool, speed: f64) -> [[f64; 2]; 3] {
    let tissue = Tissue {
        solid: NeoHookean { shear_modulus: G, bulk_modulus: 0.5e6 }.into(),
        biot_coefficient: 0.9,
        mobility: K,
        tangential_ratio: 1.0,
        profile: None,
        strain_dependence: None,
        fluid_compressibility: 0.0,
        consistent,
    };
    let lengths = uniform(2.0 * PI * T / q, 96);
    let depths = quadratic_stations(24, |j| T * graded(j as f64 / 24.0, 2.0));
    let (last, base) = (lengths.len() - 1, depths.len() - 1);
    let mut strip = Strip::new(flat(&lengths, &depths, 2), tissue, [1e-12, 1e-3], |field, i, j| match field {
        X | Y if j == base => Condition::Fixed,
        P if j == 0 => Condition::Fixed,
        _ if i == last => Condition::SameAs(0, j),
        _ => Condition::Free,
    });
    strip.speed = speed;
    strip.loaded_side = if consistent { -1.0 } else { 0.0 };
    let amplitude = 1e-3;
    for (i, x) in lengths.iter().enumerate() {
        let n = strip.node(i, 0);
        strip.prescribed[P][n] = amplitude * (q * x / T).cos();
    }
    strip.solve();
    let fourier = |value: &dyn Fn(usize) -> f64| -> [f64; 2] {
        let sum = |wave: fn(f64) -> f64| (0..last).map(|i| value(i) * wave(q * lengths[i] / T)).sum::<f64>();
        [2.0 / amplitude * sum(f64::cos), -2.0 / amplitude * sum(f64::sin)]
    };
    let intervals = last as f64;
    let inflow = |i: usize| {
        let other = if i == 0 { strip.reactions[P][strip.node(last, 0)] } else { 0.0 };
        strip.reactions[P][strip.node(i, 0)] + other
    };
    let wavelength = lengths[last];
    [
        fourier(&|i| strip.value(Y, strip.node(i, 0)) * G / T / intervals),
        fourier(&|i| -inflow(i) * T / K / wavelength),
        fourier(&|i| strip.value(P, strip.node(i, base)) / intervals),
    ]
}

fn compare(measured: [[f64; 2]; 3], expected: [[f64; 2]; 3]) {
    println!("{measured:?}");
    for (measured, expected) in measured.into_iter().zip(expected) {
        let error = (measured[0] - expected[0]).hypot(measured[1] - expected[1]);
        assert!(error < 2e-4 * expected[0].hypot(expected[1]), "{measured:?}, expected {expected:?}");
    }
}

#[test]
fn paper_formulation() {
    compare(answer(0.5, false, 0.1), [[-0.045883, -0.004540], [-0.77404, -0.71625], [0.88570, 0.02842]]);
    compare(answer(1.0, false, 0.1), [[-0.101987, -0.004886], [-2.22021, -1.81193], [0.75783, 0.04610]]);
}

#[test]
fn total_stress() {
    compare(answer(1.0, true, 0.1), [[-0.115692, -0.002921], [-1.71875, -1.33729], [0.84492, 0.04815]]);
}

/// Without motion the pressure is that of Laplace's equation, exactly.
#[test]
fn at_rest() {
    for (q, consistent) in [(0.5, false), (1.0, false), (1.0, true), (3.0, true)] {
        let [u, v, p] = answer(q, consistent, 0.0);
        println!("q {q}: {u:?} {v:?} {p:?}");
        let size = (v[0] + q * q.tanh()).abs() / (q * q.tanh());
        assert!(size < 1e-5 && (p[0] - 1.0 / q.cosh()).abs() < 1e-5, "{v:?} {p:?}");
        assert!(v[1].abs() < 1e-6 && p[1].abs() < 1e-6);
    }
}
