//! The derivatives that `Simulation::derivatives` reports against central differences of re-solved states.
//!
//! Varied: formulation, film and contact, smooth and rough surfaces, slide-to-roll ratio, all three inputs, every output and its
//! profiles. Fourth-order
//! differences over short steps (Newton's tolerance 1e-11), so that no station enters or leaves the contact. Tolerance: 1e-6 of
//! the derivative plus 1e-6 of the output's size over the input's scale (10 micron, 0.2 m/s, 1). Of two equal bodies that move
//! alike the more stressed one changes where the slide-to-roll ratio passes zero: there the largest von Mises stress has a kink,
//! as the magnitude of sliding friction, and both are left out.

use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Body, FluidLaw, Formulation, Inputs, Mesh, Parameters};
use cartilage_contact::simulation::{Input, Simulation};

/// The numbers of the outputs that are differentiable, with their names.
fn numbers(o: &Outputs) -> Vec<(String, f64)> {
    let mut all: Vec<(String, f64)> = [
        ("load", o.load),
        ("fluid_load", o.fluid_load),
        ("solid_load", o.solid_load),
        ("normal_force", o.normal_force),
        ("upper_friction_force", o.upper_friction_force),
        ("lower_friction_force", o.lower_friction_force),
        ("tangential_load", o.tangential_load),
        ("load_moment", o.load_moment),
        ("lower_force_x", o.lower_force_x),
        ("upper_moment", o.upper_moment),
        ("rotation_power", o.rotation_power),
        ("film_dissipation", o.film_dissipation),
        ("pore_flow_dissipation", o.pore_flow_dissipation),
        ("boundary_friction_dissipation", o.boundary_friction_dissipation),
        ("carried_power", o.carried_power),
        ("stored_elastic_energy", o.stored_elastic_energy),
        ("friction_coefficient", o.friction_coefficient),
        ("fluid_friction_coefficient", o.fluid_friction_coefficient),
        ("fluid_load_support", o.fluid_load_support),
        ("minimum_film_thickness", o.minimum_film_thickness),
        ("minimum_film_position", o.minimum_film_position),
        ("central_film_thickness", o.central_film_thickness),
        ("contact_length", o.contact_length),
        ("maximum_fluid_pressure", o.maximum_fluid_pressure),
        ("minimum_fluid_pressure", o.minimum_fluid_pressure),
        ("maximum_contact_pressure", o.maximum_contact_pressure),
        ("maximum_von_mises_stress", o.maximum_von_mises_stress),
        ("sommerfeld_number", o.sommerfeld_number),
        ("fluid_exudation", o.fluid_exudation),
        ("net_fluid_exudation", o.net_fluid_exudation),
        ("penetration_depth", o.penetration_depth),
    ]
    .map(|(name, value)| (name.to_string(), value))
    .into();
    for i in (0..101).step_by(10) {
        all.push((format!("film_thickness[{i}]"), o.film_thickness[i]));
        all.push((format!("fluid_pressure[{i}]"), o.fluid_pressure[i]));
        all.push((format!("contact_pressure[{i}]"), o.contact_pressure[i]));
    }
    all
}

fn compare(simulation: &mut Simulation, at: Inputs, steps: [f64; 3]) {
    simulation.solve_steady(at).unwrap();
    let start = simulation.snapshot();
    let value = simulation.outputs().clone();
    let derivatives = [Input::PenetrationDepth, Input::SlidingSpeed, Input::SlideToRollRatio]
        .map(|i| simulation.derivatives(i).unwrap().clone());
    for (k, (derivative, step)) in derivatives.into_iter().zip(steps).enumerate() {
        let mut moved = |s: f64| {
            simulation.restore(&start).unwrap();
            let mut inputs = at;
            match k {
                0 => inputs.penetration_depth += s,
                1 => inputs.sliding_speed += s,
                _ => inputs.slide_to_roll_ratio += s,
            }
            // Each time from where the last one ended: differences of such small steps need the solution to round-off.
            (0..4).for_each(|_| simulation.solve_steady(inputs).unwrap());
            numbers(simulation.outputs())
        };
        // Fourth order: the steps may be long enough for round-off not to matter.
        let [a, b, c, d] = [moved(-2.0 * step), moved(-step), moved(step), moved(2.0 * step)];
        let names = numbers(&derivative);
        for (i, (name, exact)) in names.into_iter().enumerate() {
            let difference = (8.0 * (c[i].1 - b[i].1) - (d[i].1 - a[i].1)) / (12.0 * step);
            let size = match name.as_str() {
                n if n.starts_with("film_thickness") => 1e-6,
                n if n.ends_with("film_thickness") || n.ends_with("position") || n == "contact_length" => 1e-6,
                n if n.contains("pressure") => value.maximum_fluid_pressure,
                // Sums that nearly cancel.
                n if n.contains("exudation") => value.fluid_exudation,
                n if n.contains("power") || n.contains("dissipation") => value.film_dissipation,
                n if n.contains("moment") => 1e-3 * value.load,
                n if n.contains("force") || n == "tangential_load" => value.load * value.friction_coefficient,
                n if n.contains("load") && !n.contains("support") => value.load,
                _ => numbers(&value)[i].1.abs(),
            };
            let error = (difference - exact).abs() / (exact.abs() + size / [1e-5, 0.2, 1.0][k]);
            let kinks = ["maximum_von_mises_stress", "friction_coefficient", "fluid_friction_coefficient"];
            let kink = k == 2 && at.slide_to_roll_ratio == 0.0 && kinks.contains(&name.as_str());
            assert!(error < 1e-6 || kink, "{at}, input {k}, {name}: {exact}, by differences {difference}");
        }
    }
    simulation.restore(&start).unwrap();
}

#[test]
fn in_film_and_in_contact() {
    for formulation in [Formulation::Paper, Formulation::Consistent] {
        let parameters = Parameters {
            formulation,
            tolerance: 1e-12,
            mesh: Mesh { columns: 60, rows: 4, column_grading: 2.5, row_grading: 2.0 },
            ..Parameters::default()
        };
        let mut simulation = Simulation::new(&parameters).unwrap();
        for (micron, ratio, steps) in [
            (-10.0, 0.0, [1e-9, 2e-5, 1e-4]),
            (5.0, 0.3, [1e-9, 2e-5, 1e-4]),
            (16.0, 0.3, [1e-11, 1e-6, 1e-5]),
            (16.0, 0.0, [1e-11, 1e-6, 1e-5]),
            (28.0, 0.3, [1e-11, 1e-6, 1e-5]),
        ] {
            let at = Inputs {
                penetration_depth: micron * 1e-6,
                sliding_speed: 0.2,
                slide_to_roll_ratio: ratio,
                ..Inputs::NONE
            };
            compare(&mut simulation, at, steps);
            assert_eq!(
                simulation.outputs().solid_load > 1.0,
                micron > 20.0 || (micron > 12.0 && formulation == Formulation::Paper)
            );
        }
    }
}

/// Rough surfaces in film and in contact, with boundary friction on the tissue and fluid pressure in real contact. A rough contact's
/// length and least film have a kink where a node passes three times the roughness: steps are short.
#[test]
fn of_rough_surfaces() {
    let body = Body { permeability: 1e-17, biot_coefficient: 1.0, ..Parameters::default().upper };
    let parameters = Parameters {
        upper: body,
        lower: Body { shear_modulus: 0.7e6, thickness: 1.2e-3, ..body },
        formulation: Formulation::Consistent,
        tolerance: 1e-12,
        surface_roughness: 0.5e-6,
        solid_fraction: 0.1,
        mesh: Mesh { columns: 60, rows: 4, column_grading: 2.5, row_grading: 2.0 },
        ..Parameters::default()
    };
    for pressure_order in [1, 2] {
        let mut simulation = Simulation::new(&Parameters { pressure_order, ..parameters }).unwrap();
        for (micron, ratio) in [(6.0, 0.3), (20.0, 0.0), (20.0, 0.5), (30.0, 1.5)] {
            let at = Inputs {
                penetration_depth: micron * 1e-6,
                sliding_speed: 0.05,
                slide_to_roll_ratio: ratio,
                ..Inputs::NONE
            };
            compare(&mut simulation, at, [1e-10, 2e-6, 1e-5]);
            let o = simulation.outputs();
            println!("{at}: L {} L_s {} h_min {}", o.load, o.solid_load, o.minimum_film_thickness);
        }
        assert!(simulation.outputs().solid_load > 0.02 * simulation.outputs().load);
    }
}

/// A film that thins where it is sheared, by sliding and by pressure: smooth and rough, one body and its mirror image and two.
#[test]
fn of_a_thinning_fluid() {
    let thinning = Parameters {
        fluid_law: FluidLaw::Carreau,
        zero_shear_viscosity: 1e-2,
        relaxation_time: 1e-4,
        flow_index: 0.5,
        tolerance: 1e-12,
        mesh: Mesh { columns: 60, rows: 4, column_grading: 2.5, row_grading: 2.0 },
        ..Parameters::default()
    };
    let consistent = Parameters { formulation: Formulation::Consistent, ..thinning };
    let rough = Parameters { surface_roughness: 0.5e-6, ..consistent };
    for (parameters, micron, steps) in [
        (thinning, 5.0, [1e-9, 2e-5, 1e-5]),
        (consistent, 5.0, [1e-9, 2e-5, 1e-5]),
        (thinning, 24.0, [1e-11, 1e-6, 1e-5]),
        (rough, 24.0, [3e-10, 2e-6, 1e-5]),
    ] {
        for ratio in [0.0, 0.4, -1.5] {
            let mut simulation = Simulation::new(&parameters).unwrap();
            let inputs = Inputs { penetration_depth: micron * 1e-6, sliding_speed: 0.2, ..Inputs::NONE };
            compare(&mut simulation, Inputs { slide_to_roll_ratio: ratio, ..inputs }, steps);
        }
    }
}

/// Where the film is cavitated: fully void downstream, cavitated and formed again, and beside contact.
#[test]
fn where_the_film_is_torn() {
    for formulation in [Formulation::Paper, Formulation::Consistent] {
        for (micron, cavitation_pressure, ratio, steps) in [
            (-10.0, 0.0, 0.0, [1e-9, 2e-5, 1e-4]),
            (5.0, -500.0, 0.3, [1e-10, 2e-6, 1e-5]),
            (20.0, -2000.0, 0.3, [1e-11, 1e-6, 1e-5]),
        ] {
            let parameters = Parameters {
                formulation,
                tolerance: 1e-11,
                cavitation: true,
                cavitation_pressure,
                mesh: Mesh { columns: 60, rows: 4, column_grading: 2.5, row_grading: 2.0 },
                ..Parameters::default()
            };
            let mut simulation = Simulation::new(&parameters).unwrap();
            let inputs = Inputs { penetration_depth: micron * 1e-6, sliding_speed: 0.2, ..Inputs::NONE };
            compare(&mut simulation, Inputs { slide_to_roll_ratio: ratio, ..inputs }, steps);
            assert!(simulation.outputs().cavitated_length > 1e-4);
        }
    }
}
