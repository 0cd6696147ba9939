//! Derivatives of the discrete step, by inputs and by time.

use cartilage_contact::parameters::{Control, Formulation, Inputs, Parameters};
use cartilage_contact::simulation::{Drive, Input, Simulation};

use crate::{between, coarse, depth, load, numbers, size, unlike};

#[derive(PartialEq)]
enum Kind {
    Plain,
    Cavitates,
    Rubs,
}

/// Derivatives of the discrete step by every input against central differences: 1e-5 of the derivative plus 1e-5 of the output's size
/// over the input's. Varied: formulation, control, film, contact and cavitated film, unlike bodies that rub, one and several internal steps. Internal steps are bounded so
/// that they stay the same.
#[test]
fn derivatives_of_the_discrete_step() {
    let step = 2e-3;
    for (formulation, control, first, then, longest, kind) in [
        (Formulation::Paper, Control::Depth, depth(5.0, 0.2), depth(6.0, 0.19), 1.0, Kind::Plain),
        (Formulation::Consistent, Control::Depth, depth(22.0, 0.1), depth(22.5, 0.11), 1e-3, Kind::Plain),
        (Formulation::Paper, Control::Depth, depth(20.0, 0.1), depth(20.5, 0.11), 5e-4, Kind::Plain),
        (Formulation::Paper, Control::Load, load(40.0, 0.2), load(42.0, 0.19), 1e-3, Kind::Plain),
        (Formulation::Consistent, Control::Load, load(150.0, 0.1), load(152.0, 0.11), 5e-4, Kind::Plain),
        (Formulation::Paper, Control::Depth, depth(3.0, 0.2), depth(2.5, 0.19), 1e-3, Kind::Cavitates),
        (Formulation::Consistent, Control::Load, load(40.0, 0.2), load(42.0, 0.19), 1e-3, Kind::Cavitates),
        (Formulation::Consistent, Control::Depth, depth(24.0, 0.01), depth(24.5, 0.011), 1e-3, Kind::Rubs),
        (Formulation::Consistent, Control::Load, load(300.0, 0.01), load(310.0, 0.011), 1e-3, Kind::Rubs),
    ] {
        let cavitation = kind == Kind::Cavitates;
        let parameters = Parameters {
            tolerance: 1e-11,
            relative_tolerance: 0.1,
            maximum_internal_step: longest,
            cavitation,
            cavitation_pressure: -1e3,
            ..coarse(formulation, control)
        };
        let parameters = if kind == Kind::Rubs { unlike(parameters) } else { parameters };
        let ratio = if kind == Kind::Rubs { 0.02 } else { 0.3 };
        let mut simulation = Simulation::new(&parameters).unwrap();
        let first = Inputs { slide_to_roll_ratio: ratio, ..first };
        let then = Inputs { slide_to_roll_ratio: ratio, ..then };
        simulation.solve_steady(first).unwrap();
        simulation.advance(between(first, then, step), step).unwrap();
        let start = simulation.snapshot();
        let drive = Drive {
            inputs: Inputs { approach_speed: 1e-4, ..then },
            rates: Inputs { sliding_speed: 2.0, ..Inputs::NONE },
        };
        simulation.advance(drive, step).unwrap();
        let value = simulation.outputs().clone();
        let touching = value.contact_length > 0.0;
        assert!(kind != Kind::Rubs || value.boundary_friction_dissipation > 0.1 * value.film_dissipation, "{value:?}");
        assert_eq!(value.cavitated_length > 0.0, cavitation);
        for (input, scale) in Input::ALL.into_iter().zip([1e-5, 0.2, 1.0, 1e-2, 50.0]) {
            let exact = simulation.derivatives(input).unwrap().clone();
            let h = scale * if touching { 3e-6 } else { 1e-4 };
            let moved = |s: f64| {
                let mut other = Simulation::new(&parameters).unwrap();
                other.restore(&start).unwrap();
                let mut inputs = drive.inputs;
                match input {
                    Input::PenetrationDepth => inputs.penetration_depth += s,
                    Input::SlidingSpeed => inputs.sliding_speed += s,
                    Input::SlideToRollRatio => inputs.slide_to_roll_ratio += s,
                    Input::ApproachSpeed => inputs.approach_speed += s,
                    Input::AppliedLoad => inputs.applied_load += s,
                }
                other.advance(Drive { inputs, ..drive }, step).unwrap();
                numbers(other.outputs())
            };
            let (plus, minus) = (moved(h), moved(-h));
            for (i, (name, exact)) in numbers(&exact).into_iter().enumerate() {
                let difference = (plus[i].1 - minus[i].1) / (2.0 * h);
                let error = (difference - exact).abs() / (exact.abs() + size(name, &value) / scale);
                assert!(
                    error < 1e-5,
                    "{formulation:?} {control:?} {input:?} {name}: {exact:e}, by differences {difference:e} ({error:e})"
                );
            }
        }
    }
}

/// The contact stiffness in time against central differences of the step, 1e-4; from a tolerance to the next it changes by what the
/// step itself does.
#[test]
fn contact_stiffness_is_that_of_the_step() {
    let mut found = Vec::new();
    for control in [Control::Depth, Control::Load] {
        for relative_tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
            let parameters = Parameters {
                tolerance: 1e-11,
                relative_tolerance,
                width: 0.5,
                ..coarse(Formulation::Consistent, control)
            };
            let mut simulation = Simulation::new(&parameters).unwrap();
            let (first, then) =
                (Inputs { applied_load: 40.0, ..depth(8.0, 0.2) }, Inputs { applied_load: 45.0, ..depth(9.0, 0.2) });
            simulation.solve_steady(first).unwrap();
            simulation.advance(between(first, then, 5e-3), 5e-3).unwrap();
            let start = simulation.snapshot();
            let mut ahead = |s: f64| {
                simulation.restore(&start).unwrap();
                let more = match control {
                    Control::Depth => Inputs { penetration_depth: s * 1e-9, ..Inputs::NONE },
                    Control::Load => Inputs { applied_load: s * 1e-2, ..Inputs::NONE },
                };
                let from = then.combined(&more, |a, b| a + b);
                simulation
                    .advance(Drive { inputs: from, rates: Inputs { penetration_depth: 1e-4, ..Inputs::NONE } }, 5e-3)
                    .unwrap();
                (simulation.outputs().clone(), simulation.contact_stiffness().unwrap())
            };
            let (plus, minus, (_, stiffness)) = (ahead(1.0).0, ahead(-1.0).0, ahead(0.0));
            let difference =
                (plus.normal_force - minus.normal_force) / (plus.penetration_depth - minus.penetration_depth);
            println!("{control:?}, tolerance {relative_tolerance}: {stiffness:e} N/m, by differences {difference:e}");
            assert!((stiffness / difference - 1.0).abs() < 1e-4, "{stiffness:e} {difference:e}");
            found.push(stiffness);
        }
    }
    for of_control in found.chunks_exact(4) {
        assert!((of_control[2] / of_control[3] - 1.0).abs() < 0.02, "{of_control:?}");
    }
}

/// d/dt at the end of a step against differences over short steps that go on in the same way.
#[test]
fn derivatives_by_time() {
    for (control, first, then, rubs) in [
        (Control::Depth, depth(5.0, 0.2), depth(9.0, 0.15), false),
        (Control::Load, load(40.0, 0.2), load(60.0, 0.15), false),
        (Control::Load, load(300.0, 0.02), load(400.0, 0.015), true),
        (Control::Depth, depth(24.0, 0.02), depth(26.0, 0.015), true),
    ] {
        let parameters = Parameters { tolerance: 1e-10, ..coarse(Formulation::Consistent, control) };
        let parameters = if rubs { unlike(parameters) } else { parameters };
        let mut simulation = Simulation::new(&parameters).unwrap();
        simulation.solve_steady(first).unwrap();
        let drive = between(first, then, 0.1);
        let go = |simulation: &mut Simulation, time: f64, step: f64| {
            let inputs = drive.inputs.combined(&drive.rates, |value, rate| value + time * rate);
            simulation.advance(Drive { inputs, ..drive }, step).unwrap();
        };
        // Friction goes with the speeds of the surfaces, which are those of the steps before: there all are short.
        let (steps, short) = if rubs { (400_i32, 2.5e-4) } else { (1, 2e-5) };
        let step = 0.1 / f64::from(steps);
        (0..steps).for_each(|i| go(&mut simulation, f64::from(i) * step, step));
        let rates = simulation.rates().unwrap().clone();
        let values = simulation.outputs().clone();
        let mut ahead = |steps: f64| {
            go(&mut simulation, 0.1 + (steps - 1.0) * short, short);
            numbers(simulation.outputs())
        };
        let (one, two) = (ahead(1.0), ahead(2.0));
        for (i, (name, rate)) in numbers(&rates).into_iter().enumerate() {
            if name == "net_fluid_exudation" {
                continue;
            }
            let now = numbers(&values)[i].1;
            let difference = (4.0 * one[i].1 - 3.0 * now - two[i].1) / (2.0 * short);
            let error = (difference - rate).abs() / (rate.abs() + size(name, &values) / 0.1);
            assert!(error < 1e-2, "{control:?} {name}: {rate:e}, by differences {difference:e} ({error:e})");
        }
    }
}
