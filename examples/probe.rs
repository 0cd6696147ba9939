//! probe
use cartilage_contact::{parameters::*, simulation::*};
use std::time::Instant;
fn main() {
    let mut p = Parameters::default();
    let args: Vec<String> = std::env::args().collect();
    p.mesh.columns = args[1].parse().unwrap();
    p.mesh.rows = args[2].parse().unwrap();
    p.mesh.column_grading = args[3].parse().unwrap();
    p.mesh.row_grading = args[4].parse().unwrap();
    p.boundary_friction_loads_tissue = args[5] == "1";
    let mut s = Simulation::new(&p).unwrap();
    println!("unknowns {}", s.unknowns());
    for d in args[6].split(',').map(|d| d.parse::<f64>().unwrap()) {
        let t = Instant::now();
        let r = s.solve_steady(Inputs { penetration_depth: d * 1e-6, ..Inputs::default() });
        let o = s.outputs();
        println!(
            "{d:6.1} L {:.6} h {:.4} h0 {:.4} pmax {:.1} pmin {:.1} muf {:.6} Ls {:.4} b {:.4} k {:.5e} Tf {:.5e} it {} {:.3}s {:?}",
            o.load,
            o.minimum_film_thickness * 1e6,
            o.central_film_thickness * 1e6,
            o.maximum_fluid_pressure,
            o.minimum_fluid_pressure,
            o.fluid_friction_coefficient,
            o.solid_load,
            o.contact_length * 1e3,
            o.contact_stiffness,
            o.upper_friction_force,
            o.newton_iterations,
            t.elapsed().as_secs_f64(),
            r.err()
        );
    }
}
