//! Solves a row of penetration depths, one after the other, and says what a Newton iteration costs: everything that a
//! simulation does between two inputs, the outputs included, divided by the iterations it took.
//!
//! `cargo run --release --example sweep -- --mesh 100x8 --from -10 --to 100`

use std::time::Instant;

use cartilage_contact::parameters::{Inputs, Mesh, Parameters};
use cartilage_contact::simulation::Simulation;
use clap::Parser;

#[derive(Parser)]
struct Arguments {
    /// Columns and rows of elements of each body
    #[arg(long, default_value = "100x8")]
    mesh: String,
    /// Strength of the grading along the surface and through the thickness; 0 is uniform
    #[arg(long, default_value = "2.5,2.0")]
    grading: String,
    /// First depth [micron]
    #[arg(long, default_value_t = -10.0, allow_negative_numbers = true)]
    from: f64,
    /// Last depth [micron]
    #[arg(long, default_value_t = 100.0, allow_negative_numbers = true)]
    to: f64,
    /// From one depth to the next [micron]
    #[arg(long, default_value_t = 1.0)]
    step: f64,
    /// Threads to work on
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Boundary friction loads the tissue: two bodies are solved for where they touch
    #[arg(long)]
    friction: bool,
}

fn pair<T: std::str::FromStr>(text: &str, separator: char) -> Result<[T; 2], String> {
    let parsed = text.split_once(separator).and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
    parsed.ok_or_else(|| format!("two numbers with {separator:?} between them, not {text:?}"))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::parse();
    let [columns, rows] = pair(&arguments.mesh, 'x')?;
    let [column_grading, row_grading] = pair(&arguments.grading, ',')?;
    let parameters = Parameters {
        mesh: Mesh { columns, rows, column_grading, row_grading },
        boundary_friction_loads_tissue: arguments.friction,
        ..Parameters::default()
    };
    let start = Instant::now();
    let mut simulation = Simulation::new(&parameters)?;
    simulation.set_threads(arguments.threads);
    println!("# {} unknowns, made in {:.4} s", simulation.unknowns(), start.elapsed().as_secs_f64());
    println!("# {:>6} {:>18} {:>14} {:>10} {:>9}", "d [um]", "L [N/m]", "L_s [N/m]", "iterations", "seconds");
    let (mut iterations, start) = (0, Instant::now());
    for index in 0..=((arguments.to - arguments.from) / arguments.step).round() as usize {
        let micron = arguments.from + index as f64 * arguments.step;
        let point = Instant::now();
        simulation.solve_steady(Inputs { penetration_depth: micron * 1e-6, ..Inputs::default() })?;
        let outputs = simulation.outputs();
        let seconds = point.elapsed().as_secs_f64();
        let (load, solid) = (outputs.load, outputs.solid_load);
        println!("{micron:8} {load:18.12e} {solid:14.8} {:10} {seconds:9.4}", outputs.newton_iterations);
        iterations += outputs.newton_iterations;
    }
    let seconds = start.elapsed().as_secs_f64();
    println!("# {seconds:.3} s, {iterations} iterations, {:.5} s per iteration", seconds / f64::from(iterations));
    Ok(())
}
