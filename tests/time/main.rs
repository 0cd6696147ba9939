//! The simulation in time and under a given load.

#![allow(clippy::unwrap_used, clippy::panic)]

mod derivatives;
mod given_load;
mod motion;
mod states;

use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Body, Control, Formulation, Inputs, Mesh, Parameters, TimeIntegration};
use cartilage_contact::simulation::Drive;

const MICRON: f64 = 1e-6;

fn coarse(formulation: Formulation, control: Control) -> Parameters {
    Parameters {
        formulation,
        control,
        time_integration: TimeIntegration::Transient,
        maximum_internal_step: 1e6,
        mesh: Mesh { columns: 40, rows: 3, column_grading: 2.5, row_grading: 2.0 },
        ..Parameters::default()
    }
}

/// Rough, the lower layer twice as stiff: they rub on each other as they are squeezed and rolled.
fn unlike(base: Parameters) -> Parameters {
    let lower = Body { shear_modulus: 2.0 * base.upper.shear_modulus, ..base.lower };
    Parameters { lower, surface_roughness: 0.5e-6, ..base }
}

fn depth(micron: f64, sliding_speed: f64) -> Inputs {
    Inputs { penetration_depth: micron * MICRON, sliding_speed, ..Inputs::NONE }
}

fn load(applied_load: f64, sliding_speed: f64) -> Inputs {
    Inputs { applied_load, sliding_speed, ..Inputs::NONE }
}

/// Inputs that go from one to the other in this time.
fn between(from: Inputs, to: Inputs, duration: f64) -> Drive {
    Drive { inputs: from, rates: to.combined(&from, |to, from| (to - from) / duration) }
}

fn numbers(o: &Outputs) -> Vec<(&'static str, f64)> {
    vec![
        ("load", o.load),
        ("fluid_load", o.fluid_load),
        ("solid_load", o.solid_load),
        ("upper_friction_force", o.upper_friction_force),
        ("lower_friction_force", o.lower_friction_force),
        ("upper_force_x", o.upper_force_x),
        ("upper_moment", o.upper_moment),
        ("stored_elastic_energy", o.stored_elastic_energy),
        ("pore_flow_dissipation", o.pore_flow_dissipation),
        ("friction_coefficient", o.friction_coefficient),
        ("fluid_load_support", o.fluid_load_support),
        ("minimum_film_thickness", o.minimum_film_thickness),
        ("central_film_thickness", o.central_film_thickness),
        ("contact_length", o.contact_length),
        ("maximum_fluid_pressure", o.maximum_fluid_pressure),
        ("maximum_contact_pressure", o.maximum_contact_pressure),
        ("maximum_von_mises_stress", o.maximum_von_mises_stress),
        ("penetration_depth", o.penetration_depth),
        ("net_fluid_exudation", o.net_fluid_exudation),
        ("film_thickness[40]", o.film_thickness[40]),
        ("fluid_pressure[45]", o.fluid_pressure[45]),
    ]
}

/// Sizes below which a difference is round-off of Newton's method.
fn size(name: &str, o: &Outputs) -> f64 {
    match name {
        n if n.contains("thickness") || n.contains("length") || n == "penetration_depth" => MICRON,
        n if n.contains("pressure") || n.contains("stress") => o.maximum_fluid_pressure.abs(),
        n if n.contains("force") => o.load.abs() * o.friction_coefficient,
        "stored_elastic_energy" => o.stored_elastic_energy,
        "pore_flow_dissipation" => o.pore_flow_dissipation,
        n if n.contains("moment") => 1e-3 * o.load.abs(),
        n if n.ends_with("load") => o.load.abs(),
        n if n.contains("exudation") => o.fluid_exudation,
        _ => 1.0,
    }
}
