//! States that have to be reached: 30 % of the two layers' thickness, and tissue a thousand times tighter than the paper's.
//!
//! Of the answers only this is checked: the load grows with the depth, and the film is open or the solids carry. Varied: depth, speed,
//! permeability. All `consistent`.

use cartilage_contact::error::Error;
use cartilage_contact::parameters::{Body, Formulation, Inputs, Mesh, Parameters};
use cartilage_contact::simulation::Simulation;

/// Presses to these depths [micron], one after the other.
fn press(parameters: &Parameters, sliding_speed: f64, depths: &[f64]) -> Result<(), Error> {
    let mut simulation = Simulation::new(parameters)?;
    let mut load = -1.0;
    for d in depths {
        simulation.solve_steady(Inputs {
            penetration_depth: d * 1e-6,
            sliding_speed,
            slide_to_roll_ratio: 0.0,
            ..Inputs::NONE
        })?;
        let o = simulation.outputs();
        println!(
            "d {d}: L {} L_s {} h_min {:e}, {} iterations",
            o.load, o.solid_load, o.minimum_film_thickness, o.newton_iterations
        );
        assert!(o.load > load);
        assert!((o.minimum_film_thickness > 0.0) != (o.solid_load > 0.0) || o.load == 0.0);
        load = o.load;
    }
    Ok(())
}

fn wide() -> Parameters {
    Parameters {
        formulation: Formulation::Consistent,
        sector_half_angle: 0.15,
        mesh: Mesh { columns: 100, rows: 6, column_grading: 1.0, row_grading: 2.0 },
        ..Parameters::default()
    }
}

#[test]
fn thirty_per_cent_at_rest() {
    press(&wide(), 0.0, &[0.0, 100.0, 200.0, 300.0, 400.0, 500.0, 600.0]).unwrap();
}

#[test]
fn fifty_micron_in_motion() {
    press(&wide(), 0.2, &[0.0, 25.0, 50.0]).unwrap();
}

#[test]
fn thirty_per_cent_in_motion() {
    press(&wide(), 0.2, &[0.0, 50.0, 100.0, 200.0, 400.0, 600.0]).unwrap();
}

fn tissue() -> Parameters {
    let body = Body { permeability: 1e-18, biot_coefficient: 1.0, ..Parameters::default().upper };
    Parameters {
        upper: body,
        lower: body,
        formulation: Formulation::Consistent,
        pressure_order: 1,
        mesh: Mesh { columns: 120, rows: 12, column_grading: 2.5, row_grading: 4.0 },
        ..Parameters::default()
    }
}

#[test]
fn tissue_permeability() {
    press(&tissue(), 0.2, &[-10.0, 0.0, 10.0, 20.0]).unwrap();
}

#[test]
fn tissue_permeability_pressed_far() {
    press(&tissue(), 0.2, &[0.0, 20.0, 50.0, 100.0, 200.0]).unwrap();
}
