//! Boundary friction by the speeds of the surfaces: what sticks, and what slips.

use cartilage_contact::io::case::Case;
use cartilage_contact::outputs::profile_stations;
use cartilage_contact::parameters::{Body, Control, Formulation, Inputs, Mesh, Parameters};
use cartilage_contact::simulation::Simulation;

/// Thin drained layers that roll and slide a little: where they enter the contact they stick, and friction grows by G S/t along the way at the
/// slide-to-roll ratio S until it is mu p. Kalker's simplified theory (Vehicle System Dynamics 11 (1982) 1-13) with the compliance t/G of each layer and
/// the computed pressure; the contact is 28 layers long.
#[test]
fn thin_layers_stick_and_slip_as_by_simplified_theory() {
    let base = Parameters::default();
    let shear_modulus = base.upper.shear_modulus;
    let bulk_modulus = 2.0 / 3.0 * shear_modulus;
    let body = Body { outer_radius: 0.4, thickness: 0.25e-3, bulk_modulus, permeability: 1e-12, ..base.upper };
    let parameters = Parameters {
        formulation: Formulation::Consistent,
        upper: body,
        lower: body,
        surface_roughness: 0.5e-6,
        boundary_friction_coefficient: 0.3,
        friction_regularisation_speed: 1e-5,
        sector_half_angle: 0.02,
        mesh: Mesh { columns: 120, rows: 6, column_grading: 0.0, row_grading: 1.0 },
        ..base
    };
    let mut simulation = Simulation::new(&parameters).unwrap();
    let inputs = Inputs { penetration_depth: 30e-6, sliding_speed: 0.1, ..Inputs::NONE };
    let mobilised = [3e-4, 1e-3, 2e-3, 5e-3].map(|slide_to_roll_ratio| {
        simulation.solve_steady(Inputs { slide_to_roll_ratio, ..inputs }).unwrap();
        let o = simulation.outputs();
        let x = profile_stations(o.mesh_half_width);
        let growth = shear_modulus * slide_to_roll_ratio / body.thickness;
        let (mut friction, mut sum, parts) = (0.0_f64, 0.0, 100);
        for (x, pressure) in x.windows(2).zip(o.contact_pressure.windows(2)) {
            let step = (x[1] - x[0]) / f64::from(parts);
            for k in 0..parts {
                let pressure = pressure[0] + (pressure[1] - pressure[0]) * f64::from(k) / f64::from(parts);
                friction = (friction + growth * step).min(parameters.boundary_friction_coefficient * pressure);
                sum += friction * step;
            }
        }
        let found = 0.5 * (o.upper_friction_force + o.lower_friction_force);
        println!("{slide_to_roll_ratio}: {found} N/m, {sum} by simplified theory");
        assert!((found / sum - 1.0).abs() < 0.015, "{found} {sum}");
        assert!((o.solid_load / o.load - 1.0).abs() < 1e-3, "{o:?}");
        found / (parameters.boundary_friction_coefficient * o.solid_load)
    });
    // Mostly stuck, and all of it slipping.
    assert!(mobilised[0] < 0.2 && mobilised[3] > 0.99, "{mobilised:?}");
}

/// Unlike layers that roll are stretched unlike and rub on each other; like ones do not. The work is that of the bones.
#[test]
fn unlike_bodies_that_roll_rub_on_each_other() {
    let knee = Case::load("examples/knee.toml".as_ref()).unwrap().parameters;
    assert_ne!(knee.upper, knee.lower);
    for (lower, applied_load) in [(knee.lower, 10e3), (knee.lower, 30e3), (knee.upper, 10e3)] {
        let parameters = Parameters { lower, control: Control::Load, ..knee };
        let mut simulation = Simulation::new(&parameters).unwrap();
        let inputs = Inputs { applied_load, sliding_speed: 0.2, ..Inputs::NONE };
        simulation.solve_steady(inputs).unwrap();
        let o = simulation.outputs();
        let rubbed = o.boundary_friction_dissipation;
        let taken = o.film_dissipation + o.pore_flow_dissipation + rubbed + o.carried_power;
        println!("{applied_load} N/m: friction {}, {} and {taken} W", o.friction_coefficient, o.rotation_power);
        if lower == knee.upper {
            assert!(rubbed.abs() < 1e-9 * taken && o.friction_coefficient < 1e-4, "{o:?}");
        } else {
            assert!((o.rotation_power / taken - 1.0).abs() < 0.01, "{} {taken}", o.rotation_power);
            assert!(rubbed > 0.9 * taken && o.friction_coefficient > 0.01, "{o:?}");
            assert!(simulation.warnings().is_empty(), "{:?}", simulation.warnings());
        }
    }
}
