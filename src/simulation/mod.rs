//! One contact, driven by its inputs: the object that the command line, the FMU and Rust programs use.

mod bodies;
mod derivatives;
mod drive;
mod steady;
mod transient;

use serde::{Deserialize, Serialize};

use self::bodies::{Bodies, ReusableTangent, State};
pub use self::drive::Drive;
use self::steady::Way;
use self::transient::Motion;
use crate::equations::grid::Grid;
use crate::equations::system::{Solved, System};
use crate::error::Error;
use crate::fields::Fields;
use crate::memory;
use crate::outputs::{Outputs, STATIONS, profile_stations};
use crate::parameters::{Control, Fidelity, Inputs, Parameters, TimeIntegration};
use crate::solver::deadline::Deadline;

/// The continuous inputs, in the order of the derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// [`Inputs::penetration_depth`].
    PenetrationDepth,
    /// [`Inputs::sliding_speed`].
    SlidingSpeed,
    /// [`Inputs::slide_to_roll_ratio`].
    SlideToRollRatio,
    /// [`Inputs::approach_speed`].
    ApproachSpeed,
    /// [`Inputs::applied_load`].
    AppliedLoad,
}

impl Input {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::PenetrationDepth, Self::SlidingSpeed, Self::SlideToRollRatio, Self::ApproachSpeed, Self::AppliedLoad];
}

/// The whole state of a [`Simulation`]: going on from it gives the same bits as going on from where it was taken.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Snapshot(Option<Step>);

/// The last step: where it ended, and what the next one starts from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Step {
    state: State,
    iterations: i32,
    /// What the inputs did, and how long that was \[s\].
    drive: Drive,
    duration: f64,
    path: Path,
}

/// How a state was reached, for the next one and for derivatives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Path {
    /// The reusable tangent.
    Steady(Option<Box<ReusableTangent>>),
    Transient(Box<Motion>),
}

/// What contact the mesh is made for at the end of a step in time, from that of the inputs: as the last two steps make one expect, so that
/// its motion is smooth and a step has its derivatives on a given mesh; where the inputs do something else, the nearest of a ladder of
/// widths. 0 stays 0.
fn contact_for(wanted: f64, expected: Option<f64>) -> f64 {
    /// How far what is expected may be off, as a logarithm: the edges of the contact are some hundredths wide.
    const NEAR: f64 = 5e-3;
    /// Between the rungs, likewise.
    const RUNG: f64 = 1e-3;
    let off = |expected: &f64| (wanted / expected).ln().abs();
    match expected.filter(|expected| off(expected) < NEAR) {
        Some(expected) => expected,
        None if wanted > 0.0 => ((wanted.ln() / RUNG).round() * RUNG).exp(),
        None => 0.0,
    }
}

/// Two cartilage layers with a film between them.
#[derive(Debug)]
pub struct Simulation {
    bodies: Bodies,
    last: Option<Step>,
    inputs: Inputs,
    outputs: Outputs,
    /// What mesh and sector do not resolve.
    warnings: Vec<String>,
    position: Vec<f64>,
    /// Of the present state, once they were asked for.
    derivatives: Option<Vec<Outputs>>,
    /// Likewise by the slide-to-roll ratio of a mirrored pair.
    by_ratio: Option<Outputs>,
    rates: Option<Outputs>,
}

impl Simulation {
    /// Meshes the two bodies. Nothing is solved yet; the outputs are zero.
    ///
    /// # Errors
    /// [`Error::Value`] where a parameter is out of range.
    pub fn new(parameters: &Parameters) -> Result<Self, Error> {
        parameters.validate()?;
        if parameters.fidelity == Fidelity::Reduced {
            return Err(Error::value("fidelity", "reduced", "full: only an FMU has a reduced model in its resources"));
        }
        memory::check(parameters, 1)?;
        let mut bodies = Bodies::new(parameters);
        let position = profile_stations(bodies.system(bodies.equal()).half_width());
        Ok(Self {
            bodies,
            last: None,
            inputs: Inputs::default(),
            outputs: nothing(),
            warnings: Vec::new(),
            position,
            derivatives: None,
            by_ratio: None,
            rates: None,
        })
    }

    /// Works on up to this many threads; on one unless told otherwise. The results are the same bits.
    pub fn set_threads(&mut self, threads: usize) {
        self.bodies.set_threads(threads);
    }

    /// The present state under other parameters, from where the next step goes on. Fields and results are those of before until then,
    /// so that what tissue and film hold is kept.
    ///
    /// # Errors
    /// As [`Simulation::new`]; also [`Error::State`] where the unknowns are others: another number of elements, smooth surfaces in place
    /// of rough ones.
    pub fn with_parameters(&mut self, parameters: &Parameters) -> Result<Self, Error> {
        let mut next = Self::new(parameters)?;
        let Some(Step { state, iterations, drive, duration, .. }) = self.last.clone() else { return Ok(next) };
        let mirrored = state.mirrored && next.bodies.equal();
        let mut state = State { rates: None, ..self.bodies.converted(state, mirrored) };
        let grid = Grid::new(parameters, state.contact_half_width, &state.shifts);
        let system = next.bodies.system(mirrored);
        let (count, contact_law) = (system.unknowns(), system.contact_law());
        if count != state.unknowns.len() || grid.stations.len() != state.active.len() {
            return Err(Error::State("another mesh needs a new run".into()));
        }
        if !contact_law.same_kind(&self.bodies.system_of(&state).contact_law()) {
            return Err(Error::State("rough surfaces stay rough and smooth ones smooth during a run".into()));
        }
        state.unknowns = self.bodies.system_of(&state).interpolated(&state.unknowns, &grid);
        next.bodies.system_of(&state);
        next.last = Some(Step { state, iterations, drive, duration, path: Path::Steady(None) });
        (next.inputs, next.outputs) = (self.inputs, self.outputs.clone());
        (next.warnings, next.position) = (self.warnings.clone(), self.position.clone());
        Ok(next)
    }

    /// The parameters it was made with.
    pub fn parameters(&self) -> &Parameters {
        &self.bodies.parameters
    }

    /// The inputs of the last solution.
    pub fn inputs(&self) -> &Inputs {
        &self.inputs
    }

    /// Finds the steady state for these inputs, starting from the present state. Under [`crate::parameters::Control::Load`] the depth
    /// is found with it.
    ///
    /// # Errors
    /// [`Error::Value`] for inputs that are not finite or a load that no film carries, [`Error::NotConverged`] where no solution
    /// was found; either way the state is what it was before.
    pub fn solve_steady(&mut self, inputs: Inputs) -> Result<(), Error> {
        self.steady(Drive::constant(inputs), 0.0)
    }

    /// Goes on for a step of this length \[s\]: in time, or to the steady state of the inputs at its end, as the parameter
    /// `time_integration` says. The first state in time is the steady one of the inputs at the start.
    ///
    /// # Errors
    /// As [`Simulation::solve_steady`]; also [`Error::Value`] for a length that is not positive.
    pub fn advance(&mut self, drive: Drive, duration: f64) -> Result<(), Error> {
        if !(duration.is_finite() && duration > 0.0) {
            return Err(Error::value("the length of the step", duration, "a positive number of seconds"));
        }
        if self.parameters().time_integration == TimeIntegration::QuasiSteady {
            return self.steady(drive, duration);
        }
        for inputs in [drive.inputs, drive.at(duration)] {
            check(&inputs)?;
        }
        if self.last.is_none() {
            self.solve_steady(drive.inputs)?;
        }
        let Some(last) = &self.last else { return Ok(()) };
        self.bodies.reserve()?;
        self.bodies.deadline = Deadline::after(self.bodies.parameters.maximum_solve_time);
        let motion = match &last.path {
            Path::Steady(_) => None,
            Path::Transient(motion) => Some(&**motion),
        };
        // The mesh goes along with the contact.
        let control = self.bodies.parameters.control;
        let [before, now, wanted] = [last.drive.at(0.0), last.drive.at(last.duration), drive.at(duration)]
            .map(|inputs| self.bodies.contact_half_width(&inputs, control));
        let expected = motion.map(|_| now * (now / before).powf(duration / last.duration));
        // Under a given load the contact goes with the depth, which lags behind.
        let lag = self.bodies.contact_half_width(&last.state.inputs, Control::Depth) / now;
        let lag = if control == Control::Load && lag.is_finite() { lag } else { 1.0 };
        let contact = contact_for(lag * wanted, expected.map(|expected| lag * expected));
        let (state, motion, iterations) =
            transient::advance(&mut self.bodies, &last.state, motion, contact, &drive, duration)?;
        self.accept(Step {
            state,
            iterations: iterations as i32,
            drive,
            duration,
            path: Path::Transient(Box::new(motion)),
        });
        Ok(())
    }

    fn steady(&mut self, drive: Drive, duration: f64) -> Result<(), Error> {
        let inputs = drive.at(duration);
        check(&inputs)?;
        self.bodies.reserve()?;
        let from = self.last.as_ref().map(|last| {
            let reusable = match &last.path {
                Path::Steady(reusable) => reusable.clone(),
                Path::Transient(_) => None,
            };
            (State { rates: None, ..last.state.clone() }, reusable)
        });
        self.bodies.deadline = Deadline::after(self.bodies.parameters.maximum_solve_time);
        let Way { state, reusable, iterations, .. } = steady::solve(&mut self.bodies, from, &inputs)?;
        self.accept(Step { state, iterations: iterations as i32, drive, duration, path: Path::Steady(reusable) });
        Ok(())
    }

    /// Makes the end of a step the present state.
    fn accept(&mut self, step: Step) {
        let system = self.bodies.system_of(&step.state);
        self.position = profile_stations(system.half_width());
        (self.outputs, self.warnings) = Solved { system, state: &step.state }.outputs();
        self.outputs.newton_iterations = step.iterations;
        self.inputs = step.drive.at(step.duration);
        self.last = Some(step);
        (self.derivatives, self.by_ratio, self.rates) = (None, None, None);
    }

    /// Results of the last solution.
    pub fn outputs(&self) -> &Outputs {
        &self.outputs
    }

    /// What mesh and sector do not resolve of the last solution, one sentence each with what to do; none where all is well.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    fn differentiated(&mut self) -> Result<&[Outputs], Error> {
        let Some(last) = &self.last else { return Err(unsolved()) };
        match &mut self.derivatives {
            Some(derivatives) => Ok(derivatives),
            slot => {
                self.bodies.reserve()?;
                Ok(slot.insert(derivatives::by_inputs(&mut self.bodies, last).map_err(Error::State)?))
            }
        }
    }

    /// Derivatives of the results with respect to one input, held at another value during the last step: of the steady state, or of
    /// the discrete step in time. Found when they are first asked for, at the cost of a Newton iteration or, in time, of the step.
    /// The fields that are not continuous (regime, iterations) are meaningless there.
    ///
    /// # Errors
    /// [`Error::State`] where nothing was solved yet.
    pub fn derivatives(&mut self, input: Input) -> Result<&Outputs, Error> {
        if let (Input::SlideToRollRatio, Some(last)) = (input, self.last.as_ref().filter(|last| last.state.mirrored)) {
            return match &mut self.by_ratio {
                Some(outputs) => Ok(outputs),
                slot => Ok(slot.insert(derivatives::by_ratio(&mut self.bodies, last).map_err(Error::State)?)),
            };
        }
        Ok(&self.differentiated()?[input as usize])
    }

    /// Rate of change of the normal force with the penetration depth \[N/m\]: of the steady state, or in time of the discrete step, as all
    /// its derivatives. Where the load is given, what it has to differ by for a unit of depth.
    ///
    /// # Errors
    /// As [`Simulation::derivatives`].
    pub fn contact_stiffness(&mut self) -> Result<f64, Error> {
        let Parameters { control, width, .. } = *self.parameters();
        Ok(match control {
            Control::Depth => self.derivatives(Input::PenetrationDepth)?.normal_force,
            Control::Load => width / self.derivatives(Input::AppliedLoad)?.penetration_depth,
        })
    }

    /// Derivatives of the results with respect to time at the end of the last step, the inputs going on at their rates.
    ///
    /// # Errors
    /// As [`Simulation::derivatives`].
    pub fn rates(&mut self) -> Result<&Outputs, Error> {
        let Some(last) = &self.last else { return Err(unsolved()) };
        match &mut self.rates {
            Some(rates) => Ok(rates),
            slot => {
                self.bodies.reserve()?;
                Ok(slot.insert(derivatives::by_time(&mut self.bodies, last).map_err(Error::State)?))
            }
        }
    }

    /// The fixed stations of the profiles \[m\], [`STATIONS`] of them, ascending.
    pub fn position(&self) -> &[f64] {
        &self.position
    }

    /// Fields of the last solution over both bodies and along the interface; `None` before anything was solved.
    pub fn fields(&self) -> Option<Fields> {
        let state = &self.last.as_ref()?.state;
        // A state was accepted only with all elements the right way out.
        Solved { system: self.bodies.made(state.mirrored)?, state }.fields().ok()
    }

    /// Number of unknowns of the present state's equations, or of those that would be solved first.
    pub fn unknowns(&self) -> usize {
        let mirrored = self.last.as_ref().map_or(self.bodies.equal(), |last| last.state.mirrored);
        self.bodies.made(mirrored).map_or(0, System::unknowns)
    }

    /// A copy of the state.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot(self.last.clone())
    }

    /// Returns to a state taken from this simulation or from one with equal parameters.
    ///
    /// # Errors
    /// [`Error::State`] where the snapshot does not fit; the state is then unchanged.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), Error> {
        let Some(step) = &snapshot.0 else {
            self.last = None;
            (self.inputs, self.outputs, self.warnings) = (Inputs::default(), nothing(), Vec::new());
            (self.derivatives, self.by_ratio, self.rates) = (None, None, None);
            return Ok(());
        };
        if step.state.mirrored && !self.bodies.equal() {
            return Err(Error::State("it is of two equal bodies, and these are not".into()));
        }
        let system = self.bodies.system(step.state.mirrored);
        if !step.fits(system) {
            let (given, expected) = (step.state.unknowns.len(), system.unknowns());
            return Err(Error::State(format!("it has {given} unknowns, this mesh {expected}")));
        }
        self.accept(step.clone());
        Ok(())
    }
}

impl Step {
    /// Whether it is of these equations.
    fn fits(&self, system: &System) -> bool {
        system.admits(&self.state)
            && match &self.path {
                Path::Steady(reusable) => reusable.as_ref().is_none_or(|reusable| reusable.fits(system)),
                Path::Transient(motion) => motion.fits(system),
            }
    }
}

fn unsolved() -> Error {
    Error::State("nothing has been solved yet".into())
}

fn nothing() -> Outputs {
    Outputs {
        film_thickness: vec![0.0; STATIONS],
        fluid_pressure: vec![0.0; STATIONS],
        contact_pressure: vec![0.0; STATIONS],
        ..Outputs::default()
    }
}

fn check(inputs: &Inputs) -> Result<(), Error> {
    match inputs.named().into_iter().find(|(_, value)| !value.is_finite()) {
        Some((name, value)) => Err(Error::value(name, value, "a finite number")),
        None => Ok(()),
    }
}
