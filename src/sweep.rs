//! Many states of one case, on several threads.

use std::ops::{ControlFlow, Range};
use std::sync::{Mutex, PoisonError};
use std::thread::{Builder, Scope, ScopedJoinHandle};

use crate::error::Error;
use crate::memory;
use crate::parameters::{Control, Inputs, Parameters};
use crate::simulation::{Simulation, Snapshot};

/// Fewer points than this are not shared out: a state far from the last one costs as much as several nearby.
const SMALLEST_RANGE: usize = 4;

/// Hears of a point, by its index; says whether to go on.
pub type Done<'a> = &'a (dyn Fn(usize, Result<&mut Simulation, Error>) -> ControlFlow<()> + Sync);

/// Begins a thread of a scope.
///
/// # Errors
/// [`Error::Memory`] where the system refuses another one.
pub fn spawn<'scope, T: Send + 'scope>(
    scope: &'scope Scope<'scope, '_>,
    work: impl FnOnce() -> T + Send + 'scope,
) -> Result<ScopedJoinHandle<'scope, T>, Error> {
    Builder::new().spawn_scoped(scope, work).map_err(|error| {
        Error::Memory(format!("the system refuses another thread: {error}; take fewer --threads, or allow more memory"))
    })
}

/// Solves all points. Every thread takes consecutive points, each starting from the one before; a thread that has no more takes
/// over half of what is left to another. `done` hears of every point as it is solved, or why it was not; where it breaks, no further
/// point is begun.
///
/// # Errors
/// [`Error::Value`] where a parameter is out of range, [`Error::Memory`] where the system refuses a thread.
pub fn solve(parameters: &Parameters, points: &[Inputs], threads: usize, done: Done<'_>) -> Result<(), Error> {
    let threads = threads.clamp(1, points.len().div_ceil(SMALLEST_RANGE).max(1));
    let length = points.len().div_ceil(threads);
    let ranges: Vec<_> =
        (0..threads).map(|i| (i * length).min(points.len())..((i + 1) * length).min(points.len())).collect();
    let ranges = Mutex::new(ranges);
    memory::check(parameters, threads)?;
    let simulations: Result<Vec<_>, _> = (0..threads).map(|_| Simulation::new(parameters)).collect();
    std::thread::scope(|scope| {
        for (own, mut simulation) in simulations?.into_iter().enumerate() {
            let ranges = &ranges;
            let worker = move || {
                let rest = simulation.snapshot();
                loop {
                    // A `while let` would hold the lock while the point is solved, and the threads would take turns.
                    let index = next(&mut ranges.lock().unwrap_or_else(PoisonError::into_inner), own);
                    let Some(index) = index else { break };
                    let result = solve_next(&mut simulation, &rest, points[index]);
                    if done(index, result.map(|()| &mut simulation)).is_break() {
                        ranges.lock().unwrap_or_else(PoisonError::into_inner).fill(0..0);
                    }
                }
            };
            if let Err(error) = spawn(scope, worker) {
                ranges.lock().unwrap_or_else(PoisonError::into_inner).fill(0..0);
                return Err(error);
            }
        }
        Ok(())
    })
}

/// Solves a point from the one before, or from rest: smooth surfaces close more readily than they part.
///
/// # Errors
/// Those of [`Simulation::solve_steady`].
pub fn solve_next(simulation: &mut Simulation, rest: &Snapshot, point: Inputs) -> Result<(), Error> {
    let (parameters, last) = (simulation.parameters(), simulation.inputs());
    let parting = match parameters.control {
        Control::Depth => point.penetration_depth < last.penetration_depth,
        Control::Load => point.applied_load < last.applied_load,
    };
    if parting && parameters.surface_roughness == 0.0 {
        simulation.restore(rest)?;
    }
    simulation.solve_steady(point)
}

/// The next point of a worker.
fn next(ranges: &mut [Range<usize>], worker: usize) -> Option<usize> {
    if ranges[worker].is_empty() {
        let largest = (0..ranges.len()).max_by_key(|other| ranges[*other].len())?;
        let Range { start, end } = ranges[largest];
        if end - start < SMALLEST_RANGE {
            return None;
        }
        let middle = start + (end - start) / 2;
        ranges[largest] = start..middle;
        ranges[worker] = middle..end;
    }
    ranges[worker].next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sweep_stops_where_it_is_told() {
        let mut parameters = Parameters::default();
        (parameters.mesh.columns, parameters.mesh.rows) = (8, 1);
        let points: Vec<_> =
            (0..12).map(|i| Inputs { penetration_depth: -20e-6 + 1e-6 * f64::from(i), ..Inputs::default() }).collect();
        let heard = Mutex::new(0);
        let done = |_, result: Result<&mut Simulation, Error>| {
            result.unwrap();
            *heard.lock().unwrap() += 1;
            ControlFlow::Break(())
        };
        solve(&parameters, &points, 2, &done).unwrap();
        // What another thread had begun is finished.
        assert!((1..=2).contains(&*heard.lock().unwrap()));
    }

    #[test]
    fn every_point_is_given_out_once() {
        let mut ranges = vec![0..10, 10..20, 20..20];
        let mut given: Vec<usize> = Vec::new();
        let mut idle = 0;
        while idle < 5 {
            idle = 0;
            for worker in [2, 0, 2, 2, 1] {
                match next(&mut ranges, worker) {
                    Some(point) => given.push(point),
                    None => idle += 1,
                }
            }
        }
        given.sort_unstable();
        assert_eq!(given, (0..20).collect::<Vec<_>>());
    }
}
