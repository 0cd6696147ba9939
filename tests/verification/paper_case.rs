//! The paper's case (de Boer et al. 2020, Table 2) as three independent codes solve it, literal formulation, boundary friction not
//! loading the tissue; and the depth of first touch.
//!
//! Varied: penetration depth -50 to 13 micron. Mesh 240 x 12, graded 3 and 2. Tolerance: half a unit of the last digit given.

use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Inputs, Mesh, Parameters};
use cartilage_contact::simulation::{Input, Simulation};

fn simulation() -> Simulation {
    let parameters = Parameters {
        boundary_friction_loads_tissue: false,
        mesh: Mesh { columns: 240, rows: 12, column_grading: 3.0, row_grading: 2.0 },
        ..Parameters::default()
    };
    Simulation::new(&parameters).unwrap()
}

fn at(simulation: &mut Simulation, micron: f64) -> Outputs {
    let inputs = Inputs { penetration_depth: micron * 1e-6, sliding_speed: 0.2, slide_to_roll_ratio: 0.0 };
    simulation.solve_steady(inputs).unwrap();
    simulation.outputs().clone()
}

#[test]
fn table_of_three_codes() {
    let mut simulation = simulation();
    for micron in [-50.0, -10.0, 0.0, 10.0, 12.0, 12.5, 12.6, 12.65, 12.7, 13.0] {
        let start = std::time::Instant::now();
        let o = at(&mut simulation, micron);
        println!(
            "{micron} L {:.6} h_min {:.5e} h0 {:.5e} p {:.2} {:.2} mu_f {:.6} Ls {:.5} b {:.4e} dL/dd {:.5e} dh {:.4e} it {} {:?}",
            o.load,
            o.minimum_film_thickness,
            o.central_film_thickness,
            o.maximum_fluid_pressure,
            o.minimum_fluid_pressure,
            o.fluid_friction_coefficient,
            o.solid_load,
            o.contact_length,
            simulation.derivatives(Input::PenetrationDepth).load,
            simulation.derivatives(Input::PenetrationDepth).minimum_film_thickness,
            o.newton_iterations,
            start.elapsed()
        );
    }
}
