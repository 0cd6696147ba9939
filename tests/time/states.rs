//! Where a run goes on from: saved states, the steps before, and other parameters.

use approx::assert_relative_eq;
use cartilage_contact::error::Error;
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Control, Formulation, Mesh, Parameters, Preset, TimeIntegration};
use cartilage_contact::simulation::{Drive, Input, Simulation};

use crate::{between, coarse, depth, load, numbers, size};

fn course(simulation: &mut Simulation, from: i32, to: i32) -> Vec<Outputs> {
    (from..to)
        .map(|k| {
            let at = |k: i32| load(60.0 + 20.0 * (f64::from(k) * 0.7).sin(), 0.1 + 0.05 * (f64::from(k) * 0.3).cos());
            simulation.advance(between(at(k), at(k + 1), 5e-3), 5e-3).unwrap();
            simulation.outputs().clone()
        })
        .collect()
}

#[test]
fn a_state_goes_on_with_the_same_bits() {
    let parameters = coarse(Formulation::Paper, Control::Load);
    let mut simulation = Simulation::new(&parameters).unwrap();
    simulation.solve_steady(load(60.0, 0.15)).unwrap();
    course(&mut simulation, 0, 4);
    let saved = simulation.snapshot();
    let (slope, rate) =
        (simulation.derivatives(Input::AppliedLoad).unwrap().clone(), simulation.rates().unwrap().clone());
    let on = course(&mut simulation, 4, 8);
    simulation.restore(&saved).unwrap();
    assert_eq!(course(&mut simulation, 4, 8), on);
    let mut fresh = Simulation::new(&parameters).unwrap();
    fresh.restore(&saved).unwrap();
    assert_eq!(fresh.derivatives(Input::AppliedLoad).unwrap(), &slope);
    assert_eq!(fresh.rates().unwrap(), &rate);
    assert_eq!(course(&mut fresh, 4, 8), on);
    // A step that is refused leaves no trace.
    fresh.restore(&saved).unwrap();
    assert!(fresh.advance(Drive::constant(load(f64::NAN, 0.1)), 1e-3).is_err());
    assert!(fresh.advance(Drive::constant(load(60.0, 0.1)), 0.0).is_err());
    assert_eq!(fresh.snapshot(), saved);
    assert_eq!(course(&mut fresh, 4, 8), on);
}

/// Tangents are kept from step to step. What was asked for in between, saving and restoring, and the number of threads change nothing.
#[test]
fn a_quasi_steady_stream_has_the_same_bits_whatever_is_asked_of_it() {
    let quasi_steady = Parameters {
        time_integration: TimeIntegration::QuasiSteady,
        tolerance: 1e-10,
        ..coarse(Formulation::Paper, Control::Depth)
    };
    let at = |k: i32| depth(8.0 + 4.0 * (0.1 * f64::from(k)).sin(), 0.2);
    let stream = |simulation: &mut Simulation, from: i32, to: i32, ask: bool| -> Vec<Outputs> {
        let step = |k: i32| {
            simulation.advance(between(at(k), at(k + 1), 1e-3), 1e-3).unwrap();
            if ask {
                simulation.derivatives(Input::SlidingSpeed).unwrap();
                simulation.restore(&simulation.snapshot()).unwrap();
            }
            simulation.outputs().clone()
        };
        (from..to).map(step).collect()
    };
    let mut simulation = Simulation::new(&quasi_steady).unwrap();
    let plain = stream(&mut simulation, 0, 24, false);
    let mut asked = Simulation::new(&quasi_steady).unwrap();
    asked.set_threads(2);
    assert_eq!(stream(&mut asked, 0, 12, true), plain[..12]);
    let mut fresh = Simulation::new(&quasi_steady).unwrap();
    fresh.restore(&asked.snapshot()).unwrap();
    assert_eq!(stream(&mut fresh, 12, 24, false), plain[12..]);
    // And they are the states that are found from rest, to the tolerance.
    for k in [5, 17, 23] {
        let mut alone = Simulation::new(&quasi_steady).unwrap();
        alone.solve_steady(at(k + 1)).unwrap();
        for ((name, value), (_, kept)) in numbers(alone.outputs()).into_iter().zip(numbers(&plain[k as usize])) {
            let error = (value - kept).abs() / size(name, alone.outputs());
            assert!(error < 1e-6, "{name} at {k}: {value}, {kept}");
        }
    }
}

/// Other parameters during a run: twice as viscous a fluid leaves a film under the same load half as fast, from where it was.
#[test]
fn other_parameters_go_on_from_what_film_and_tissue_hold() {
    for formulation in [Formulation::Paper, Formulation::Consistent] {
        let first = coarse(formulation, Control::Load);
        let mut simulation = Simulation::new(&first).unwrap();
        simulation.solve_steady(load(20.0, 0.2)).unwrap();
        let still = Drive::constant(load(20.0, 0.0));
        let short = 1e-5;
        let step = |simulation: &mut Simulation| {
            let before = simulation.outputs().penetration_depth;
            simulation.advance(still, short).unwrap();
            (simulation.outputs().penetration_depth - before) / short
        };
        simulation.advance(still, 1e-3).unwrap();
        let as_it_was = step(&mut simulation);
        // Twice the permeability too: tissue then drains as before.
        let mut viscous = first;
        viscous.viscosity *= 2.0;
        viscous.upper.permeability *= 2.0;
        viscous.lower.permeability *= 2.0;
        let results = simulation.outputs().clone();
        let mut simulation = simulation.with_parameters(&viscous).unwrap();
        assert_eq!(*simulation.outputs(), results);
        let halved = step(&mut simulation);
        assert!(as_it_was > 3e-5, "{as_it_was} m/s");
        assert_relative_eq!(halved, 0.5 * as_it_was, max_relative = 0.05);
    }
}

/// Where rows follow the permeability, fields go over to the new ones; where only one body changes, there are two from then on.
#[test]
fn other_parameters_are_reached_on_other_rows_and_with_one_body_changed() {
    let preset = Parameters {
        mesh: Mesh { columns: 64, rows: 6, ..Preset::HumanNormal.parameters().mesh },
        ..Preset::HumanNormal.parameters()
    };
    let mut simulation = Simulation::new(&preset).unwrap();
    simulation.solve_steady(depth(10.0, 0.1)).unwrap();
    let before = simulation.outputs().load;
    let mut changed = preset;
    changed.upper.permeability *= 20.0;
    let mut simulation = simulation.with_parameters(&changed).unwrap();
    assert_eq!(simulation.outputs().load, before);
    simulation.solve_steady(depth(10.0, 0.1)).unwrap();
    let mut fresh = Simulation::new(&changed).unwrap();
    fresh.solve_steady(depth(10.0, 0.1)).unwrap();
    assert_relative_eq!(simulation.outputs().load, fresh.outputs().load, max_relative = 1e-6);
    assert!((before / fresh.outputs().load - 1.0).abs() > 1e-3, "the permeability plays a part");

    let finer = Parameters { mesh: Mesh { rows: 7, ..changed.mesh }, ..changed };
    assert!(matches!(simulation.with_parameters(&finer), Err(Error::State(_))));
}
