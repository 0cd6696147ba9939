//! Dry contact: a parabolic indenter without friction on a layer of thickness t that is bonded to a rigid base (Meijers 1968;
//! Jaffar 1989; the numbers were computed to 0.05 %). With contact half-width a: W R/(G a^2), p0 R/(G a), delta R/a^2.
//!
//! At rest the film has no pressure, so that the two bodies are elastic layers (`consistent`, alpha = 0: G and K are the drained
//! moduli). Two equal layers pressed together are the same with R the radius of one surface and delta half the depth; so is one
//! layer against a rigid body, with 1/R the sum of the curvatures. Given: delta. Compared: W, p0 and a.
//! Varied: Poisson's ratio 0.154, 0.3, 0.5; a/t 0.5 to 4. Tolerance 0.3 % on W and p0: 0.05 % of the table's numbers times the
//! powers 3/2 to 3 of delta with which they rise, and finite strains of 5e-4.

use approx::assert_relative_eq;
use cartilage_contact::equations::tissue::{Tissue, VolumeRate};
use cartilage_contact::fem::element::POINTS;
use cartilage_contact::fem::mesh::{graded, quadratic_stations};
use cartilage_contact::laws::solid::NeoHookean;
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Body, Formulation, Inputs, Mesh, Parameters};
use cartilage_contact::simulation::Simulation;

use crate::strip::{Condition, Strip, X, Y, flat};

const T: f64 = 1e-3;
/// Half of the surface that is meshed.
const HALF_WIDTH: f64 = 0.02;
const COLUMNS: i32 = 200;
const GRADING: f64 = 4.0;

fn layer(radius: f64, poisson: f64, shear_modulus: f64) -> Body {
    Body {
        outer_radius: radius,
        thickness: T,
        shear_modulus,
        bulk_modulus: shear_modulus * 2.0 * (1.0 + poisson) / (3.0 * (1.0 - 2.0 * poisson)),
        permeability: 1e-15,
        biot_coefficient: 0.0,
        ..Parameters::default().upper
    }
}

fn pressed(upper: Body, lower: Body, penetration_depth: f64, rows: i32) -> Outputs {
    let parameters = Parameters {
        upper,
        lower,
        sector_half_angle: HALF_WIDTH / upper.outer_radius.min(lower.outer_radius),
        formulation: Formulation::Consistent,
        boundary_friction_loads_tissue: false,
        mesh: Mesh { columns: COLUMNS, rows, column_grading: GRADING, row_grading: 2.0 },
        ..Parameters::default()
    };
    let mut simulation = Simulation::new(&parameters).unwrap();
    simulation
        .solve_steady(Inputs { penetration_depth, sliding_speed: 0.0, slide_to_roll_ratio: 0.0, ..Inputs::NONE })
        .unwrap();
    let outputs = simulation.outputs().clone();
    assert!(outputs.maximum_fluid_pressure.abs() < 1e-6 * outputs.maximum_contact_pressure);
    outputs
}

/// Compares W R/(G a^2) and p0 R/(G a); and a to the size of the element that the edge is in.
fn compare(outputs: &Outputs, radius: f64, shear_modulus: f64, a: f64, [load, peak]: [f64; 2], tolerance: f64) {
    let w = outputs.solid_load * radius / (shear_modulus * a * a);
    let p0 = outputs.maximum_contact_pressure * radius / (shear_modulus * a);
    println!("a/t {}: W {w} ({load}), p0 {p0} ({peak}), a {}", a / T, outputs.contact_length / 2.0 / a);
    assert_relative_eq!(w, load, max_relative = tolerance);
    assert_relative_eq!(p0, peak, max_relative = tolerance);
    let element = 2.0 * GRADING / f64::from(COLUMNS) * (HALF_WIDTH / GRADING.sinh()).hypot(a);
    assert!((outputs.contact_length / 2.0 - a).abs() < element);
}

#[test]
fn two_compressible_layers() {
    let table = [
        (0.154, 0.5, 2.1246, 1.3583, 0.8643),
        (0.154, 1.0, 2.7463, 1.8001, 0.6879),
        (0.154, 2.0, 4.2713, 2.9480, 0.5940),
        (0.154, 4.0, 7.4836, 5.3705, 0.5470),
        (0.30, 1.0, 3.4915, 2.3000, 0.6541),
        (0.30, 4.0, 10.239, 7.4122, 0.5333),
    ];
    let radius = 20.0;
    for (poisson, ratio, load, peak, delta) in table {
        let a = ratio * T;
        let body = layer(radius, poisson, 0.5e6);
        let outputs = pressed(body, body, 2.0 * delta * a * a / radius, 8);
        compare(&outputs, radius, body.shear_modulus, a, [load, peak], 3e-3);
    }
}

/// Poisson's ratio 1/2: the undrained answer of a flat layer to a parabolic indenter, alpha (J - 1) = 0 with the pore pressure of
/// order 1 for its multiplier (displacements of order 2 alone lock: their contact pressures oscillate).
#[test]
fn an_incompressible_layer() {
    let (radius, shear_modulus) = (20.0, 0.5e6);
    for (ratio, load, peak, delta) in [(1.0, 5.9807, 4.0052, 0.4384), (4.0, 37.681, 29.229, 0.2635)] {
        let a = ratio * T;
        let tissue = Tissue {
            solid: NeoHookean { shear_modulus, bulk_modulus: shear_modulus }.into(),
            biot_coefficient: 1.0,
            mobility: 1e-12,
            tangential_ratio: 1.0,
            profile: None,
            strain_dependence: None,
            fluid_compressibility: 0.0,
            consistent: true,
        };
        let lengths = quadratic_stations(100, |i| HALF_WIDTH * graded(i as f64 / 100.0, GRADING));
        let depths = quadratic_stations(12, |j| T * graded(j as f64 / 12.0, 1.5));
        let (last, base) = (lengths.len() - 1, depths.len() - 1);
        let mut strip = Strip::new(flat(&lengths, &depths, 1), tissue, [1e-7, 1e3], |field, i, j| match field {
            X if i == 0 || i == last || j == base => Condition::Fixed,
            Y if j == base => Condition::Fixed,
            _ => Condition::Free,
        });
        // So fast that no fluid moves: k M/t^2 = 1e-5 of the rate.
        strip.rates.fill(VolumeRate { rate: 1e5, history: [0.0; POINTS] });
        strip.obstacle = lengths.iter().map(|x| x * x / (2.0 * radius) - delta * a * a / radius).collect();
        strip.solve();
        let force = |i: usize| -strip.reactions[Y][strip.node(i, 0)];
        let w =
            2.0 * (0..=last).filter(|i| strip.active[*i]).map(force).sum::<f64>() * radius / (shear_modulus * a * a);
        let p0 = force(0) / (lengths[2] / 6.0) * radius / (shear_modulus * a);
        let edge = lengths[strip.active.iter().rposition(|active| *active).unwrap()];
        println!("a/t {ratio}: W {w} ({load}), p0 {p0} ({peak}), a {}", edge / a);
        assert_relative_eq!(w, load, max_relative = 3e-3);
        assert_relative_eq!(p0, peak, max_relative = 3e-3);
        let element = GRADING / 100.0 * (HALF_WIDTH / GRADING.sinh()).hypot(a);
        assert!((edge - a).abs() < element);
    }
}

#[test]
fn a_layer_on_a_rigid_body() {
    let rigid = Body {
        outer_radius: 500.0,
        thickness: 1e-5,
        shear_modulus: 1e10,
        bulk_modulus: 1e10,
        ..layer(500.0, 0.3, 1e10)
    };
    let radius = 20.0 * 500.0 / 520.0;
    let a = T;
    let outputs = pressed(layer(20.0, 0.154, 0.5e6), rigid, 0.6879 * a * a / radius, 8);
    compare(&outputs, radius, 0.5e6, a, [2.7463, 1.8001], 3e-3);
    let outputs = pressed(rigid, layer(20.0, 0.154, 0.5e6), 0.6879 * a * a / radius, 8);
    compare(&outputs, radius, 0.5e6, a, [2.7463, 1.8001], 3e-3);
}
