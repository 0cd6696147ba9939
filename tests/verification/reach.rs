//! States that must be reachable: a third of the layers' thickness, and tissue a thousand times tighter than the paper's.

use cartilage_contact::parameters::{Body, Formulation, Inputs, Mesh, Parameters};
use cartilage_contact::simulation::Simulation;

fn go(parameters: &Parameters, depths: &[f64]) {
    let mut simulation = Simulation::new(parameters).unwrap();
    for d in depths {
        let start = std::time::Instant::now();
        let result = simulation.solve_steady(Inputs {
            penetration_depth: d * 1e-6,
            sliding_speed: 0.2,
            slide_to_roll_ratio: 0.0,
        });
        let o = simulation.outputs();
        println!(
            "d {d}: {result:?} L {} Ls {} h_min {:e} p {:e} b {:e} it {} {:?}",
            o.load,
            o.solid_load,
            o.minimum_film_thickness,
            o.maximum_fluid_pressure,
            o.contact_length,
            o.newton_iterations,
            start.elapsed()
        );
        if result.is_err() {
            break;
        }
    }
}

#[test]
fn thirty_per_cent() {
    for formulation in [Formulation::Consistent] {
        let parameters = Parameters {
            formulation,
            sector_half_angle: 0.2,
            mesh: Mesh { columns: 100, rows: 6, column_grading: 2.5, row_grading: 2.0 },
            ..Parameters::default()
        };
        println!("{formulation:?} sector 0.2");
        go(&parameters, &[0.0, 50.0, 150.0, 300.0, 450.0, 600.0]);
        println!("{formulation:?} sector pi/36");
        go(
            &Parameters { sector_half_angle: std::f64::consts::PI / 36.0, ..parameters },
            &[0.0, 50.0, 150.0, 300.0, 450.0, 600.0],
        );
    }
}

#[test]
fn tissue() {
    let body = Body { permeability: 1e-18, biot_coefficient: 1.0, ..Parameters::default().upper };
    let parameters = Parameters {
        upper: body,
        lower: body,
        formulation: Formulation::Consistent,
        pressure_order: 1,
        mesh: Mesh { columns: 120, rows: 12, column_grading: 2.5, row_grading: 4.0 },
        ..Parameters::default()
    };
    println!("tissue");
    go(&parameters, &[-10.0, 0.0, 10.0, 20.0, 50.0, 100.0]);
}
