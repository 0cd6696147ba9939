//! The way to a steady state does not matter.
//!
//! Simulations wander: small equal changes of depth or load and speed, now and then a jump, equal bodies that move alike or not. Every
//! state is compared with one found from rest with a tolerance of 1e-10. Varied: formulation, control, cavitation. Tolerance: 1e-5
//! of loads, pressures and films (of 0.1 micron where they are thinner), 10 nm of contact length, 0.1 nm of depth.

use cartilage_contact::laws::Formulation;
use cartilage_contact::parameters::{Control, Inputs, Mesh, Parameters};
use cartilage_contact::simulation::Simulation;

/// A number between -0.5 and 0.5, as good as random.
fn draw(step: u32, irrational: f64) -> f64 {
    (f64::from(step * step) * irrational).fract() - 0.5
}

#[test]
fn states_do_not_depend_on_the_way_to_them() {
    for (formulation, control, cavitation) in [
        (Formulation::Paper, Control::Depth, false),
        (Formulation::Consistent, Control::Depth, false),
        (Formulation::Paper, Control::Depth, true),
        (Formulation::Consistent, Control::Load, false),
        (Formulation::Consistent, Control::Load, true),
    ] {
        let parameters = Parameters {
            formulation,
            control,
            cavitation,
            cavitation_pressure: -2000.0,
            mesh: Mesh { columns: 48, rows: 3, column_grading: 2.5, row_grading: 2.0 },
            ..Parameters::default()
        };
        let mut wanderer = Simulation::new(&parameters).unwrap();
        let mut inputs = Inputs { penetration_depth: 10e-6, ..Inputs::default() };
        let mut touched = 0;
        for step in 1..=30 {
            // Nine equal steps in one direction, then a jump.
            let (scale, leg) = if step % 10 == 0 { (1.0, step) } else { (0.02, step / 10 + 5) };
            let depth = inputs.penetration_depth + scale * 100e-6 * draw(leg, 2.0_f64.sqrt());
            inputs.penetration_depth = depth.clamp(-30e-6, 50e-6);
            inputs.sliding_speed = (inputs.sliding_speed + scale * 0.3 * draw(leg, 3.0_f64.sqrt())).clamp(0.02, 0.4);
            inputs.applied_load =
                (inputs.applied_load * (scale * 3.0 * draw(leg, 5.0_f64.sqrt())).exp()).clamp(1.0, 1e3);
            inputs.slide_to_roll_ratio = if step > 15 { 0.3 } else { 0.0 };
            wanderer.solve_steady(inputs).unwrap();
            let mut settler = Simulation::new(&Parameters { tolerance: 1e-10, ..parameters }).unwrap();
            settler.solve_steady(inputs).unwrap();
            let (a, b) = (wanderer.outputs(), settler.outputs());
            let film = |of: f64| of.abs() + 1e-7;
            for (name, a, b, size) in [
                ("load", a.load, b.load, b.load.abs()),
                ("fluid load", a.fluid_load, b.fluid_load, b.load.abs()),
                ("central film", a.central_film_thickness, b.central_film_thickness, film(b.central_film_thickness)),
                ("least film", a.minimum_film_thickness, b.minimum_film_thickness, film(b.minimum_film_thickness)),
                ("contact length", a.contact_length, b.contact_length, 1e-3),
                ("pressure", a.maximum_fluid_pressure, b.maximum_fluid_pressure, b.maximum_fluid_pressure),
                ("depth", a.penetration_depth, b.penetration_depth, 1e-5),
            ] {
                assert!((a - b).abs() <= 1e-5 * size, "{name}: {a} and {b} at {inputs}, step {step}");
            }
            touched += u32::from(b.contact_length > 0.0);
        }
        assert!(touched > 0 && touched < 30, "{formulation:?} {control:?}: {touched}");
    }
}

/// Where inputs go on evenly, predictions learn from what the last two missed: 100 steps of 30 nm take 180 iterations in all, and
/// 299 where the tangent alone predicts.
#[test]
fn a_slow_stream_takes_two_iterations_a_step() {
    let mesh = Mesh { columns: 48, rows: 3, column_grading: 2.5, row_grading: 2.0 };
    let mut simulation = Simulation::new(&Parameters { mesh, ..Parameters::default() }).unwrap();
    let iterations: Vec<i32> = (0..=100)
        .map(|k| {
            let penetration_depth = 30e-9 * f64::from(k);
            simulation.solve_steady(Inputs { penetration_depth, sliding_speed: 0.2, ..Inputs::NONE }).unwrap();
            simulation.outputs().newton_iterations
        })
        .collect();
    println!("{iterations:?}");
    assert!(iterations[1..].iter().sum::<i32>() <= 220, "{iterations:?}");
}
