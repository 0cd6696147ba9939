//! Tissue whose properties change with depth, and whose permeability is not the same along the surface and through the depth.
//!
//! A confined column of thickness H with M(z) = M f(z), k(z) = k g(z), f and g linear from r at the surface to 1 at the middle zone,
//! constant in it, and linear to d at the bone (layers in series):
//!
//! - drained stiffness: stress = u / int dz/M, with int over a linear piece of length l from a to b = l ln(b/a)/(b - a);
//! - flow through it: q = dp / int dz/k, likewise;
//! - consolidation under a sudden load p0: p_t/M = (k p_z)_z, p = 0 at the surface, sealed base; here by finite volumes in 400 cells
//!   and 4000 backward Euler steps, a code of its own, which the uniform column compares with Terzaghi's series;
//! - slabs of strained tissue under a pressure difference along and across the layers: k_t and k_n per deformed length and area.
//!
//! Strains of 1e-5 except in the slabs. Tolerances 1e-3 for consolidation (both discretisations), 1e-4 for the column (finite strain,
//! quadrature of a rational function), 1e-8 for slabs.

use approx::assert_relative_eq;
use cartilage_contact::equations::tissue::{Tissue, VolumeRate};
use cartilage_contact::laws::depth::{DepthProfile, Factors};
use cartilage_contact::laws::solid::NeoHookean;

use crate::strip::{Condition, P, Strip, X, Y, flat, uniform};

const H: f64 = 1e-3;
const MOBILITY: f64 = 1e-12;
const M: f64 = 0.5e6 + 0.6e6;
const WIDTH: f64 = H / 4.0;

fn tissue(profile: Option<DepthProfile>) -> Tissue {
    Tissue {
        solid: NeoHookean { shear_modulus: 0.45e6, bulk_modulus: 0.5e6 }.into(),
        biot_coefficient: 1.0,
        mobility: MOBILITY,
        tangential_ratio: 1.0,
        profile,
        strain_dependence: None,
        fluid_compressibility: 0.0,
        consistent: true,
    }
}

/// Aggregate modulus and permeability of three parts in value: at the surface, in the middle, at the bone.
fn profile(modulus: [f64; 2], permeability: [f64; 2]) -> DepthProfile {
    let [surface, deep] = [0, 1].map(|i| Factors {
        shear_modulus: modulus[i],
        bulk_modulus: modulus[i],
        permeability: permeability[i],
        ..Factors::NONE
    });
    DepthProfile { surface, deep, middle_zone: [0.25, 0.625] }
}

/// int ds / factor over the depth from 0 to 1.
fn compliance([surface, deep]: [f64; 2]) -> f64 {
    let piece = |length: f64, from: f64, to: f64| length * (to / from).ln() / (to - from);
    piece(0.25, surface, 1.0) + 0.375 + piece(0.375, 1.0, deep)
}

/// The column; nodes of its surface move as one.
fn column(tissue: Tissue, surface: Condition, base_pressure: Condition) -> Strip {
    let depths: Vec<f64> = uniform(1.0, 32).into_iter().map(|s| H * s).collect();
    let base = depths.len() - 1;
    Strip::new(flat(&uniform(WIDTH, 1), &depths, 2), tissue, [1e-8, 10.0], |field, i, j| match (field, i, j) {
        (X, 0 | 2, _) => Condition::Fixed,
        (X | Y, _, j) if j == base => Condition::Fixed,
        (X, _, 0) | (P, _, 0) => Condition::Fixed,
        (P, _, j) if j == base => base_pressure,
        (Y, 1 | 2, 0) if surface == Condition::Free => Condition::SameAs(0, 0),
        (Y, _, 0) => surface,
        _ => Condition::Free,
    })
}

#[test]
fn layers_in_series() {
    let (modulus, permeability) = ([0.2, 4.0], [5.0, 0.1]);
    let strain = 1e-5;
    let mut strip = column(tissue(Some(profile(modulus, permeability))), Condition::Fixed, Condition::Fixed);
    let base = strip.mesh.levels() - 1;
    for i in 0..3 {
        let surface = strip.node(i, 0);
        strip.prescribed[Y][surface] = -strain * H;
    }
    strip.solve();
    let force: f64 = (0..3).map(|i| strip.reactions[Y][strip.node(i, 0)]).sum();
    assert_relative_eq!(-force / WIDTH, M * strain / compliance(modulus), max_relative = 1e-4);

    // Flow alone: nothing moves.
    let mut strip = column(tissue(Some(profile(modulus, permeability))), Condition::Fixed, Condition::Fixed);
    for i in 0..3 {
        let node = strip.node(i, base);
        strip.prescribed[P][node] = 1.0;
    }
    strip.solve();
    let flow: f64 = (0..3).map(|i| strip.reactions[P][strip.node(i, base)]).sum();
    assert_relative_eq!(flow, MOBILITY * WIDTH / (H * compliance(permeability)), max_relative = 1e-4);
}

/// Settlement over p0 H/M and pressure at the base over p0 at T = k M t/H^2, by finite volumes.
fn finite_volumes(profile: Option<&DepthProfile>, time: f64) -> [f64; 2] {
    const CELLS: usize = 400;
    const STEPS: usize = 4000;
    let factors = |depth: f64| profile.map_or(Factors::NONE, |profile| profile.at(depth));
    let (size, step) = (1.0 / CELLS as f64, time / STEPS as f64);
    let middle = |i: usize| (i as f64 + 0.5) * size;
    // Conductance between cells, and to the surface.
    let link: Vec<f64> = (0..CELLS)
        .map(|i| if i == 0 { 2.0 * factors(0.25 * size).permeability } else { factors(i as f64 * size).permeability } / size)
        .collect();
    let compliance: Vec<f64> = (0..CELLS).map(|i| size / factors(middle(i)).bulk_modulus).collect();
    let mut p = vec![1.0; CELLS];
    for _ in 0..STEPS {
        // Thomas' algorithm.
        let (mut upper, mut right) = (vec![0.0; CELLS], vec![0.0; CELLS]);
        for i in 0..CELLS {
            let below = if i + 1 < CELLS { link[i + 1] } else { 0.0 };
            let above = if i > 0 { -link[i] } else { 0.0 };
            let diagonal = compliance[i] / step + link[i] + below;
            let (before, known) = if i > 0 { (upper[i - 1], right[i - 1]) } else { (0.0, 0.0) };
            let pivot = diagonal - above * before;
            upper[i] = -below / pivot;
            right[i] = (compliance[i] / step * p[i] - above * known) / pivot;
        }
        p[CELLS - 1] = right[CELLS - 1];
        for i in (0..CELLS - 1).rev() {
            p[i] = right[i] - upper[i] * p[i + 1];
        }
    }
    [p.iter().zip(&compliance).map(|(p, c)| (1.0 - p) * c).sum(), p[CELLS - 1]]
}

#[test]
fn layered_columns_consolidate() {
    // Terzaghi: U(0.1) and p_base/p0.
    let [settlement, base] = finite_volumes(None, 0.1);
    assert_relative_eq!(settlement, 0.356823, max_relative = 1e-3);
    assert_relative_eq!(base, 0.949305, max_relative = 1e-3);
    for (modulus, permeability, time) in [
        ([0.4, 1.5], [5.0, 0.5], 0.1),
        ([0.4, 1.5], [5.0, 0.5], 0.4),
        ([1.0, 1.0], [0.2, 3.0], 0.1),
        ([3.0, 0.5], [1.0, 1.0], 0.1),
    ] {
        let profile = profile(modulus, permeability);
        let p0 = 10.0;
        let mut strip = column(tissue(Some(profile)), Condition::Free, Condition::Free);
        let steps = 64;
        let dt = time * H * H / (MOBILITY * M) / f64::from(steps);
        for step in 0..steps {
            strip.step(f64::from(step) * dt, dt, |strip, _| strip.sources[Y][0] = -p0 * WIDTH);
        }
        let computed = [strip.value(Y, 0) * -M / (p0 * H), strip.value(P, strip.node(0, strip.mesh.levels() - 1)) / p0];
        let exact = finite_volumes(Some(&profile), time);
        println!("M {modulus:?}, k {permeability:?}, T {time}: {computed:?} of {exact:?}");
        for (computed, exact) in computed.into_iter().zip(exact) {
            assert_relative_eq!(computed, exact, max_relative = 2e-3);
        }
    }
}

#[test]
fn slabs_conduct_along_and_across_their_layers() {
    let (length, ratio) = (3e-3, 2.5);
    let (stretch, squeeze) = (1.1, 0.75);
    for consistent in [true, false] {
        for along in [true, false] {
            let tissue = Tissue { tangential_ratio: ratio, consistent, biot_coefficient: 0.0, ..tissue(None) };
            let (lengths, depths) = (uniform(length, 4), uniform(H, 3));
            let (last, base) = (lengths.len() - 1, depths.len() - 1);
            let mut strip = Strip::new(flat(&lengths, &depths, 2), tissue, [1e-4, 1e3], |field, i, j| match field {
                X if i == 0 || i == last => Condition::Fixed,
                Y if j == 0 || j == base => Condition::Fixed,
                P if along && (i == 0 || i == last) || !along && (j == 0 || j == base) => Condition::Fixed,
                _ => Condition::Free,
            });
            strip.rates.fill(VolumeRate::default());
            let drop = 1e3;
            for (i, x) in lengths.iter().enumerate() {
                for (j, depth) in depths.iter().enumerate() {
                    let node = strip.node(i, j);
                    for (field, value) in [(X, (stretch - 1.0) * x), (Y, (1.0 - squeeze) * depth)] {
                        strip.prescribed[field][node] = value;
                        strip.start_from(field, node, value);
                    }
                    strip.prescribed[P][node] = if (along && i == 0) || (!along && j == 0) { drop } else { 0.0 };
                }
            }
            strip.solve();
            let flow: f64 = if along {
                (0..=base).map(|j| strip.reactions[P][strip.node(0, j)]).sum()
            } else {
                (0..=last).map(|i| strip.reactions[P][strip.node(i, 0)]).sum()
            };
            // The paper's law is that of the undeformed tissue.
            let (a, b) = if consistent { (stretch * length, squeeze * H) } else { (length, H) };
            let exact = if along { ratio * MOBILITY * drop * b / a } else { MOBILITY * drop * a / b };
            assert_relative_eq!(flow, exact, max_relative = 1e-8);
        }
    }
}
