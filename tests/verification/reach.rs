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
fn probe_thirty() {
    let u: f64 = std::env::var("SPEED").unwrap().parse().unwrap();
    let order: i32 = std::env::var("ORDER").unwrap().parse().unwrap();
    let n: i32 = std::env::var("N").unwrap().parse().unwrap();
    let parameters = Parameters {
        formulation: Formulation::Consistent,
        sector_half_angle: 0.15,
        pressure_order: order,
        mesh: Mesh { columns: n, rows: 6, column_grading: 1.0, row_grading: 2.0 },
        ..Parameters::default()
    };
    let mut simulation = Simulation::new(&parameters).unwrap();
    for d in [0.0, 25.0, 50.0, 60.0, 70.0, 80.0, 90.0, 100.0, 120.0, 150.0, 200.0, 300.0, 400.0, 500.0, 600.0] {
        let result =
            simulation.solve_steady(Inputs { penetration_depth: d * 1e-6, sliding_speed: u, slide_to_roll_ratio: 0.0 });
        let o = simulation.outputs();
        println!(
            "U {u} order {order} d {d}: {:?} L {} Ls {} dL/dd {:e} p {:e} b {:e} it {}",
            result.is_ok(),
            o.load,
            o.solid_load,
            o.contact_stiffness,
            o.maximum_fluid_pressure,
            o.contact_length,
            o.newton_iterations
        );
        if result.is_err() {
            println!("{result:?}");
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
