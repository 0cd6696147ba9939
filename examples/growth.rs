//! What a mesh costs: unknowns, memory of the factors, and the least time of the parts of a Newton iteration, for meshes that grow in
//! columns, in rows and in both, as a table with one row a mesh. `benches/growth.py` draws it.
//!
//! `cargo run --release --example growth`

use std::time::Instant;

use cartilage_contact::equations::system::{State, System};
use cartilage_contact::parameters::{Inputs, Mesh, Parameters};
use clap::Parser;

#[derive(Parser)]
struct Arguments {
    /// Threads to work on
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Each part is done for so long, and at least three times \[s\]
    #[arg(long, default_value_t = 1.0)]
    seconds: f64,
}

/// The least time that something takes \[s\].
fn least<E>(seconds: f64, mut work: impl FnMut() -> Result<(), E>) -> Result<f64, E> {
    let (start, mut least, mut count) = (Instant::now(), f64::INFINITY, 0);
    while count < 3 || start.elapsed().as_secs_f64() < seconds {
        let one = Instant::now();
        work()?;
        least = least.min(one.elapsed().as_secs_f64());
        count += 1;
    }
    Ok(least)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let Arguments { threads, seconds } = Arguments::parse();
    let columns = [25, 50, 100, 200, 400, 800].map(|columns| ("columns", columns, 8));
    let rows = [2, 4, 8, 16, 32].map(|rows| ("rows", 100, rows));
    let both = [(25, 2), (50, 4), (100, 8), (200, 16), (400, 32)].map(|(columns, rows)| ("both", columns, rows));
    println!("growing,columns,rows,unknowns,factor_entries,make_s,residual_s,factorise_s,solve_s");
    for (growing, columns, rows) in columns.into_iter().chain(rows).chain(both) {
        let mesh = Mesh { columns, rows, ..Parameters::default().mesh };
        let start = Instant::now();
        let mut system = System::new(&Parameters { mesh, ..Parameters::default() }, true, 0.0);
        let make = start.elapsed().as_secs_f64();
        system.set_threads(threads);
        let inputs = Inputs::default();
        let mut state = State { inputs, ..system.rest(inputs) };
        let mut residual = Vec::new();
        let of_residual = least(seconds, || system.residual_at(&mut state, &mut residual).map(|_| ()))?;
        let of_tangent = least(seconds, || system.factorise_at(&state))?;
        let mut solution = residual.clone();
        let of_solution = least(seconds, || {
            solution.clone_from(&residual);
            system.solve(&mut solution)
        })?;
        println!(
            "{growing},{columns},{rows},{},{},{make:.5},{of_residual:.6},{of_tangent:.6},{of_solution:.6}",
            system.unknowns(),
            system.factor_entries()
        );
    }
    Ok(())
}
