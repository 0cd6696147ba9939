//! A given load: the depth follows.

use approx::assert_relative_eq;
use cartilage_contact::equations::grid;
use cartilage_contact::error::Error;
use cartilage_contact::parameters::{Control, Formulation, Inputs, Parameters};
use cartilage_contact::simulation::{Drive, Simulation};

use crate::{MICRON, between, coarse, depth, load};

/// The depth that carries a load, steady: over seven decades, in film and in contact, moving and at rest.
#[test]
fn the_depth_of_a_load_carries_that_load() {
    for formulation in [Formulation::Paper, Formulation::Consistent] {
        let mut by_load = Simulation::new(&coarse(formulation, Control::Load)).unwrap();
        let mut by_depth = Simulation::new(&coarse(formulation, Control::Depth)).unwrap();
        for (given, speed) in [(1e-3, 0.2), (50.0, 0.2), (70.0, 0.2), (2000.0, 0.2), (500.0, 0.0), (20.0, -0.1)] {
            by_load.solve_steady(load(given, speed)).unwrap();
            let found = by_load.outputs().clone();
            assert_relative_eq!(found.load, given, max_relative = 1e-6);
            by_depth.solve_steady(Inputs { penetration_depth: found.penetration_depth, ..depth(0.0, speed) }).unwrap();
            assert_relative_eq!(by_depth.outputs().load, given, max_relative = 1e-4);
            assert_relative_eq!(by_depth.outputs().contact_length, found.contact_length, epsilon = 1e-6);
        }
    }
}

/// At rest and in motion, steady and from a light touch in time.
#[test]
fn thirty_per_cent_of_compression_under_load() {
    for speed in [0.0, 0.2] {
        let wide = Parameters { sector_half_angle: 0.15, ..coarse(Formulation::Consistent, Control::Depth) };
        let mut simulation = Simulation::new(&wide).unwrap();
        simulation.solve_steady(depth(600.0, speed)).unwrap();
        let given = simulation.outputs().load;
        let mut simulation = Simulation::new(&Parameters { control: Control::Load, ..wide }).unwrap();
        simulation.solve_steady(load(given, speed)).unwrap();
        assert_relative_eq!(simulation.outputs().penetration_depth, 600.0 * MICRON, max_relative = 1e-5);
        // In time, before the tissue drains it gives way less.
        simulation.solve_steady(load(10.0, speed)).unwrap();
        assert_eq!(simulation.outputs().solid_load == 0.0, speed > 0.0);
        simulation.advance(between(load(10.0, speed), load(given, speed), 0.2), 0.2).unwrap();
        let at_once = simulation.outputs().penetration_depth;
        assert!(at_once > 100.0 * MICRON && at_once < 590.0 * MICRON, "{at_once}");
        assert!(simulation.outputs().fluid_load_support > 0.2);
        for _ in 0..6 {
            simulation.advance(Drive::constant(load(given, speed)), 1e3).unwrap();
        }
        assert_relative_eq!(simulation.outputs().penetration_depth, 600.0 * MICRON, max_relative = 1e-4);
    }
}

/// A mesh that goes with the contact goes with that which the depth makes. In time the tissue gives way to a load for long, and the mesh is
/// made for the depth at the end of the step before.
#[test]
fn in_time_the_mesh_goes_with_the_depth_and_not_with_the_load() {
    let parameters = Parameters { sector_half_angle: 0.0, ..coarse(Formulation::Consistent, Control::Load) };
    let half_width = |inputs: &Inputs, control| {
        grid::half_width(&parameters, grid::contact_half_width(&parameters, inputs, control))
    };
    let given = load(2000.0, 0.2);
    let mut simulation = Simulation::new(&parameters).unwrap();
    simulation.advance(between(load(50.0, 0.2), given, 0.05), 0.05).unwrap();
    let mut depths = Vec::new();
    for _ in 0..3 {
        simulation.advance(Drive::constant(given), 0.02).unwrap();
        depths.push(simulation.outputs().penetration_depth);
    }
    assert!(depths.is_sorted());
    let reached = half_width(&Inputs { penetration_depth: depths[1], ..given }, Control::Depth);
    let made_for = *simulation.fields().unwrap().interface.position.last().unwrap();
    assert_relative_eq!(made_for, reached, max_relative = 1e-6);
    assert!((half_width(&given, Control::Load) / reached - 1.0).abs() > 0.01);
}

#[test]
fn a_load_that_no_film_carries_is_refused_with_the_least_one() {
    let mut simulation = Simulation::new(&coarse(Formulation::Paper, Control::Load)).unwrap();
    for given in [0.0, -5.0] {
        let error = simulation.solve_steady(load(given, 0.2)).unwrap_err();
        assert!(matches!(error, Error::Value { .. }) && error.to_string().contains("1e-6 N/m or more"), "{error}");
    }
    // In time no load at all lets the bodies drift apart.
    simulation.solve_steady(load(20.0, 0.2)).unwrap();
    let before = simulation.outputs().penetration_depth;
    simulation.advance(between(load(20.0, 0.2), load(0.0, 0.2), 0.01), 0.01).unwrap();
    simulation.advance(Drive::constant(load(0.0, 0.2)), 0.05).unwrap();
    assert!(simulation.outputs().load.abs() < 1e-4);
    assert!(simulation.outputs().penetration_depth < before - 1.0 * MICRON);
}
