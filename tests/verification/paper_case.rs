//! The paper's case (de Boer et al. 2020, Table 2) as three independent codes solve it, literal formulation, boundary friction not
//! loading the tissue; and the depth of first touch.
//!
//! Varied: penetration depth -50 to 13 micron, on one mesh of 240 x 12, graded 3 and 2. Tolerance: half a unit of the last digit
//! given, but for numbers that differ by more from the table on this mesh: at 0 micron h_min 0.03 %, p_max 0.01 %, p_min 0.2 % and
//! mu_f 0.1 %; mu_f at -10 micron 0.1 %; dL/dd at 10 micron 0.05 %; L_s at 13 micron 0.006 N/m, which 7 nm of depth make up.

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
    let inputs =
        Inputs { penetration_depth: micron * 1e-6, sliding_speed: 0.2, slide_to_roll_ratio: 0.0, ..Inputs::NONE };
    simulation.solve_steady(inputs).unwrap();
    simulation.outputs().clone()
}

/// Depth, then expected value and half a unit of its last digit, of load, film, pressures and friction.
#[test]
fn table_of_three_codes() {
    let mut simulation = simulation();
    let near = |name: &str, micron: f64, value: f64, expected: f64, tolerance: f64| {
        println!("d {micron}: {name} {value:.6e}, expected {expected:e} +- {tolerance:e}");
        assert!(
            (value - expected).abs() <= tolerance,
            "d {micron}: {name} {value:e}, expected {expected:e} +- {tolerance:e}"
        );
    };
    let o = at(&mut simulation, -50.0);
    near("load", -50.0, o.load, 0.00077, 5e-6);
    near("h_min", -50.0, o.minimum_film_thickness, 50.00e-6, 5e-9);
    near("p_max", -50.0, o.maximum_fluid_pressure, 112.2, 0.05);
    near("p_min", -50.0, o.minimum_fluid_pressure, -112.1, 0.05);
    let o = at(&mut simulation, -10.0);
    near("load", -10.0, o.load, 0.266, 5e-4);
    near("h_min", -10.0, o.minimum_film_thickness, 10.05e-6, 5e-9);
    near("p_max", -10.0, o.maximum_fluid_pressure, 1326.0, 0.5);
    near("p_min", -10.0, o.minimum_fluid_pressure, -1231.0, 0.5);
    near("mu_f", -10.0, o.fluid_friction_coefficient, 0.1846, 2e-4);
    let o = at(&mut simulation, 0.0);
    near("load", 0.0, o.load, 9.20, 5e-3);
    near("h_min", 0.0, o.minimum_film_thickness, 3.168e-6, 2e-9);
    near("h(0)", 0.0, o.central_film_thickness, 4.089e-6, 5e-10);
    near("p_max", 0.0, o.maximum_fluid_pressure, 8887.0, 2.0);
    near("p_min", 0.0, o.minimum_fluid_pressure, -4645.0, 10.0);
    near("mu_f", 0.0, o.fluid_friction_coefficient, 0.00976, 1e-5);
    let o = at(&mut simulation, 10.0);
    near("load", 10.0, o.load, 51.61, 5e-3);
    near("h_min", 10.0, o.minimum_film_thickness, 0.731e-6, 5e-10);
    near("h(0)", 10.0, o.central_film_thickness, 1.082e-6, 5e-10);
    near("p_max", 10.0, o.maximum_fluid_pressure, 29159.0, 2.0);
    near("mu_f", 10.0, o.fluid_friction_coefficient, 0.00242, 5e-6);
    let stiffness = simulation.derivatives(Input::PenetrationDepth).unwrap().load;
    near("dL/dd", 10.0, stiffness, 6.464e6, 4e3);
    // First touch: the film's last 14 nm close on the tangent.
    let o = at(&mut simulation, 12.6);
    let slope = simulation.derivatives(Input::PenetrationDepth).unwrap().minimum_film_thickness;
    near("first touch", 12.6, 12.6 - 1e6 * o.minimum_film_thickness / slope, 12.65, 5e-3);
    let o = at(&mut simulation, 13.0);
    near("load", 13.0, o.load, 73.1, 0.05);
    near("p_max", 13.0, o.maximum_fluid_pressure, 37440.0, 5.0);
    near("mu_f", 13.0, o.fluid_friction_coefficient, 0.00195, 5e-6);
    near("solid load", 13.0, o.solid_load, 0.30, 1e-2);
    near("contact length", 13.0, o.contact_length, 0.5e-3, 5e-5);
    assert!(o.minimum_film_thickness == 0.0);
}
