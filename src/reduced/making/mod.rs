//! Making a reduced model: states are solved on a coarse grid and halfway between its lines, and where the table does not meet the
//! states halfway, it gets a line. Then it has to meet states at places that have nothing to do with the grid.
//!
//! `grid.rs` has the lines and fills the table, `touch.rs` finds first touch, `refine.rs` decides where lines are missing and when the
//! table is done, and `compare.rs` measures the table beside the full model.

mod compare;
mod grid;
mod refine;
mod touch;

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

use self::touch::Touch;
use super::chart::Side;
use super::quantities::{State, quantities};
use super::{Range, ReducedModel, boundary_friction, coordinate, pressed};
use crate::error::Error;
use crate::outputs::Regime;
use crate::parameters::{Control, Fidelity, Inputs, Parameters};
use crate::simulation::{Input, Simulation};
use crate::sweep;

/// What a table has to keep: the largest errors between its states, relative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Of the load; where that is given, of the depth.
    pub load: f64,
    /// Of the least film thickness.
    pub minimum_film_thickness: f64,
    /// Of the friction coefficient away from first touch.
    pub friction_coefficient: f64,
    /// Of the profile of the fluid pressure: root mean square over the stations, relative to the largest one.
    pub fluid_pressure: f64,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { load: 0.01, minimum_film_thickness: 0.02, friction_coefficient: 0.02, fluid_pressure: 0.03 }
    }
}

/// How far a table has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// States that are solved.
    pub solved: usize,
    /// States that are to be solved before the table is looked at again.
    pub planned: usize,
}

/// A solved state.
#[derive(Clone)]
struct Sample {
    inputs: Inputs,
    /// What its place is on the axis of depths.
    depth: f64,
    state: Box<State>,
    /// On which side of first touch it is.
    touching: bool,
    resolved: bool,
}

/// ln U at rest.
const REST: f64 = f64::NEG_INFINITY;
/// In a table that goes down to rest, the slowest line is at first so much slower than the fastest.
const FIRST_RATIO: f64 = 256.0;

/// Logarithms of the slowest and the fastest speed of the first lines.
fn first_lines(range: &Range) -> [f64; 2] {
    let [slowest, fastest] = range.speeds;
    [if slowest > 0.0 { slowest } else { fastest / FIRST_RATIO }, fastest].map(f64::ln)
}

/// A place of the grid. Numbers are compared by their bits.
type Key = (Side, u64, u64);

struct Builder<'a> {
    parameters: &'a Parameters,
    range: Range,
    tolerance: Tolerance,
    threads: usize,
    progress: &'a (dyn Fn(Progress) + Sync),
    solved: usize,
    /// The lines but for that at rest.
    log_speeds: Vec<f64>,
    stations: Vec<(Side, Vec<f64>)>,
    samples: HashMap<Key, Sample>,
    touches: HashMap<u64, Touch>,
    /// Depths that are asked for.
    asked: [f64; 2],
    /// Depths that the table covers, and whether first touch is among them.
    depths: [f64; 2],
    has_touch: bool,
}

const FIRST_SPEEDS: usize = 4;

impl ReducedModel {
    /// Makes a table for a case that keeps a tolerance, on several threads. `progress` hears of every state that is solved.
    ///
    /// # Errors
    /// [`Error::Value`] for a range that is none, or a tolerance that a table of a few thousand states does not keep;
    /// [`Error::NotConverged`] where the full model has no solution.
    pub fn build(
        parameters: &Parameters,
        range: Range,
        tolerance: Tolerance,
        threads: usize,
        progress: &(dyn Fn(Progress) + Sync),
    ) -> Result<Self, Error> {
        let parameters = &Parameters { fidelity: Fidelity::Full, ..*parameters };
        parameters.validate()?;
        check(&range, parameters.control)?;
        if parameters.cavitation {
            return Err(Error::value(
                "cavitation",
                true,
                "false: a reduced model has no cavitated film; fidelity = full has",
            ));
        }
        let [slowest, fastest] = first_lines(&range);
        let last = (FIRST_SPEEDS - 1) as f64;
        let asked = range.pressed.map(|end| coordinate(parameters.control, end));
        let log_speeds = (0..FIRST_SPEEDS).map(|i| slowest + (fastest - slowest) * i as f64 / last).collect();
        let mut builder = Builder {
            parameters,
            range,
            tolerance,
            threads,
            progress,
            solved: 0,
            log_speeds,
            stations: Vec::new(),
            samples: HashMap::new(),
            touches: HashMap::new(),
            asked,
            depths: asked,
            has_touch: false,
        };
        builder.lay_out()?;
        builder.refine()
    }
}

fn check(range: &Range, control: Control) -> Result<(), Error> {
    let [least, most] = range.pressed;
    let [slowest, fastest] = range.speeds;
    let (name, limits, allowed) = match control {
        Control::Depth => ("depths", -1e-2..=1e-2, "two ascending numbers from -1e-2 to 1e-2 m"),
        Control::Load => ("loads", 1e-3..=1e7, "two ascending numbers from 1e-3 to 1e7 N/m"),
    };
    if !limits.contains(&least) || !limits.contains(&most) || least >= most {
        return Err(Error::value(name, format!("{least:e}:{most:e}"), allowed));
    }
    if !(slowest == 0.0 || (1e-6..10.0).contains(&slowest)) || fastest <= slowest || !(1e-3..=10.0).contains(&fastest) {
        return Err(Error::value(
            "speeds",
            format!("{slowest}:{fastest}"),
            "two ascending numbers: 0 or from 1e-6, and from 1e-3 to 10 m/s",
        ));
    }
    if !(-10.0..=10.0).contains(&range.slide_to_roll_ratio) {
        return Err(Error::value("slide_to_roll_ratio", range.slide_to_roll_ratio, "a number from -10 to 10"));
    }
    Ok(())
}

impl Builder<'_> {
    fn is_rough(&self) -> bool {
        self.parameters.surface_roughness > 0.0
    }

    /// Whether the table goes down to rest.
    fn rests(&self) -> bool {
        self.range.speeds[0] == 0.0
    }

    /// ln U of all lines.
    fn lines(&self) -> Vec<f64> {
        let rest = self.rests().then_some(REST);
        rest.into_iter().chain(self.log_speeds.iter().copied()).collect()
    }

    fn inputs(&self, depth: f64, log_speed: f64) -> Inputs {
        let [slowest, fastest] = self.range.speeds;
        let inputs = Inputs {
            sliding_speed: log_speed.exp().clamp(slowest, fastest),
            slide_to_roll_ratio: self.range.slide_to_roll_ratio,
            ..Inputs::NONE
        };
        match self.parameters.control {
            Control::Depth => Inputs { penetration_depth: depth, ..inputs },
            Control::Load => Inputs { applied_load: depth.exp(), ..inputs },
        }
    }

    /// Solves all points, in the order in which they are best solved.
    fn solve(&mut self, points: &[Inputs]) -> Result<Vec<Sample>, Error> {
        let planned = self.solved + points.len();
        let found: Mutex<Vec<Option<Sample>>> = Mutex::new(vec![None; points.len()]);
        let trouble = Mutex::new(None);
        sweep::solve(self.parameters, points, self.threads, &|index, result| match result.and_then(sample) {
            Ok(sample) => {
                let mut found = found.lock().unwrap_or_else(PoisonError::into_inner);
                found[index] = Some(sample);
                let solved = planned - found.iter().filter(|sample| sample.is_none()).count();
                (self.progress)(Progress { solved, planned });
                ControlFlow::Continue(())
            }
            Err(error) => {
                *trouble.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                ControlFlow::Break(())
            }
        })?;
        if let Some(error) = trouble.into_inner().unwrap_or_else(PoisonError::into_inner) {
            return Err(error);
        }
        self.solved = planned;
        Ok(found.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().flatten().collect())
    }
}

fn sample(simulation: &mut Simulation) -> Result<Sample, Error> {
    let (p, inputs, outputs) = (*simulation.parameters(), *simulation.inputs(), simulation.outputs().clone());
    let boundary = boundary_friction(&p, &inputs);
    let mut state = Box::new([quantities(&outputs, boundary[0] * outputs.solid_load, p.width); 4]);
    let (pressing, scale) = match p.control {
        Control::Depth => (Input::PenetrationDepth, 1.0),
        // By the logarithm.
        Control::Load => (Input::AppliedLoad, inputs.applied_load),
    };
    for (k, input) in [(1, pressing), (2, Input::SlidingSpeed), (3, Input::SlideToRollRatio)] {
        let derivatives = simulation.derivatives(input)?;
        let friction = boundary[0] * derivatives.solid_load + boundary[k] * outputs.solid_load;
        let scale = if k == 1 { scale } else { 1.0 };
        state[k] = quantities(derivatives, friction, p.width).map(|slope| scale * slope);
    }
    let touching = match p.surface_roughness {
        0.0 => matches!(outputs.lubrication_regime, Regime::BoundaryContact | Regime::HighFriction),
        rms => outputs.minimum_film_thickness < rms,
    };
    let depth = coordinate(p.control, pressed(p.control, &inputs).2);
    Ok(Sample { inputs, depth, state, touching, resolved: outputs.well_resolved })
}
