//! One contact, driven by its inputs: the object that the command line, the FMU and Rust programs use.

mod bodies;
mod derivatives;
mod drive;
mod predictor;
mod relaxation;
mod steady;
mod transient;

use serde::{Deserialize, Serialize};

use self::bodies::{Bodies, Point};
pub use self::drive::Drive;
use self::predictor::ReusableTangent;
use self::steady::Steady;
use self::transient::Motion;
use crate::equations::grid::Grid;
use crate::equations::system::{Rates, System};
use crate::error::Error;
use crate::fields::{Fields, Solution};
use crate::memory;
use crate::outputs::{Outputs, STATIONS, Solved, profile_stations};
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
pub struct Snapshot(Option<State>);

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct State {
    point: Point,
    iterations: i32,
    /// What the inputs did in the last step, and how long that was \[s\].
    drive: Drive,
    duration: f64,
    path: Path,
}

/// How a state was reached, for the next one and for derivatives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Path {
    /// The reusable tangent, and the state before on another mesh.
    Steady(Option<Box<ReusableTangent>>, Option<Box<Point>>),
    Transient(Box<Motion>),
}

impl Path {
    /// Rates of change of what is stored, as a difference formula; none of a steady state.
    fn rates(&self) -> Option<Rates> {
        match self {
            Self::Steady(..) => None,
            Self::Transient(motion) => Some(motion.rates()),
        }
    }
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
    state: Option<State>,
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
            state: None,
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
        let Some(State { point, iterations, drive, duration, .. }) = self.state.clone() else { return Ok(next) };
        let mirrored = point.mirrored && next.bodies.equal();
        let mut point = self.bodies.converted(point, mirrored);
        let grid = Grid::new(parameters, point.contact_half_width);
        let count = next.bodies.system(mirrored).unknowns();
        let rough = |parameters: &Parameters| parameters.surface_roughness > 0.0;
        if count != point.unknowns.len() || grid.stations.len() != point.active.len() {
            return Err(Error::State("another mesh needs a new run".into()));
        }
        if rough(parameters) != rough(self.parameters()) {
            return Err(Error::State("rough surfaces stay rough and smooth ones smooth during a run".into()));
        }
        point.unknowns = self.bodies.system_of(&point).interpolated(&point.unknowns, &grid);
        next.bodies.system_of(&point);
        next.state = Some(State { point, iterations, drive, duration, path: Path::Steady(None, None) });
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
        if self.state.is_none() {
            self.solve_steady(drive.inputs)?;
        }
        let Some(state) = &self.state else { return Ok(()) };
        self.bodies.reserve()?;
        self.bodies.deadline = Deadline::after(self.bodies.parameters.maximum_solve_time);
        let motion = match &state.path {
            Path::Steady(..) => None,
            Path::Transient(motion) => Some(&**motion),
        };
        // The mesh goes along with the contact.
        let control = self.bodies.parameters.control;
        let [before, last, wanted] = [state.drive.at(0.0), state.drive.at(state.duration), drive.at(duration)]
            .map(|inputs| self.bodies.contact_half_width(&inputs, control));
        let expected = motion.map(|_| last * (last / before).powf(duration / state.duration));
        let contact = contact_for(wanted, expected);
        let (point, motion, iterations) =
            transient::advance(&mut self.bodies, &state.point, motion, contact, &drive, duration)?;
        self.accept(State {
            point,
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
        let from = self.state.as_ref().map(|state| Steady {
            point: state.point.clone(),
            reusable: match &state.path {
                Path::Steady(reusable, _) => reusable.clone(),
                Path::Transient(_) => None,
            },
            before: match &state.path {
                Path::Steady(_, before) => before.clone(),
                Path::Transient(_) => None,
            },
        });
        let mut iterations = 0;
        self.bodies.deadline = Deadline::after(self.bodies.parameters.maximum_solve_time);
        let Steady { point, reusable, before } = steady::solve(&mut self.bodies, from, &inputs, &mut iterations)?;
        self.accept(State {
            point,
            iterations: iterations as i32,
            drive,
            duration,
            path: Path::Steady(reusable, before),
        });
        Ok(())
    }

    /// Makes a converged state the present one.
    fn accept(&mut self, state: State) {
        let parameters = self.bodies.parameters;
        let rates = state.path.rates();
        let system = self.bodies.system_of(&state.point);
        self.position = profile_stations(system.half_width());
        let solved = Solved { system, parameters: &parameters, at: state.point.at(rates.as_ref()) };
        (self.outputs, self.warnings) = solved.outputs();
        self.outputs.newton_iterations = state.iterations;
        self.inputs = state.drive.at(state.duration);
        self.state = Some(state);
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
        let Some(state) = &self.state else { return Err(unsolved()) };
        match &mut self.derivatives {
            Some(derivatives) => Ok(derivatives),
            slot => {
                self.bodies.reserve()?;
                Ok(slot.insert(derivatives::by_inputs(&mut self.bodies, state).map_err(Error::State)?))
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
        if let (Input::SlideToRollRatio, Some(state)) =
            (input, self.state.as_ref().filter(|state| state.point.mirrored))
        {
            return match &mut self.by_ratio {
                Some(outputs) => Ok(outputs),
                slot => Ok(slot.insert(derivatives::by_ratio(&mut self.bodies, state).map_err(Error::State)?)),
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
        let Some(state) = &self.state else { return Err(unsolved()) };
        match &mut self.rates {
            Some(rates) => Ok(rates),
            slot => {
                self.bodies.reserve()?;
                Ok(slot.insert(derivatives::by_time(&mut self.bodies, state).map_err(Error::State)?))
            }
        }
    }

    /// The fixed stations of the profiles \[m\], [`STATIONS`] of them, ascending.
    pub fn position(&self) -> &[f64] {
        &self.position
    }

    /// Fields of the last solution over both bodies and along the interface; `None` before anything was solved.
    pub fn fields(&self) -> Option<Fields> {
        let State { point, path, .. } = self.state.as_ref()?;
        let rates = path.rates();
        let system = self.bodies.made(point.mirrored)?;
        let Point { inputs, unknowns, active, .. } = point;
        let parameters = self.parameters();
        let solution = Solution { system, parameters, inputs, unknowns, active, rates: rates.as_ref() };
        // A state was accepted only with all elements the right way out.
        solution.fields().ok()
    }

    /// Number of unknowns of the present state's equations, or of those that would be solved first.
    pub fn unknowns(&self) -> usize {
        let mirrored = self.state.as_ref().map_or(self.bodies.equal(), |state| state.point.mirrored);
        self.bodies.made(mirrored).map_or(0, System::unknowns)
    }

    /// A copy of the state.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot(self.state.clone())
    }

    /// Returns to a state taken from this simulation or from one with equal parameters.
    ///
    /// # Errors
    /// [`Error::State`] where the snapshot does not fit; the state is then unchanged.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), Error> {
        let Some(state) = &snapshot.0 else {
            self.state = None;
            (self.inputs, self.outputs, self.warnings) = (Inputs::default(), nothing(), Vec::new());
            (self.derivatives, self.by_ratio, self.rates) = (None, None, None);
            return Ok(());
        };
        if state.point.mirrored && !self.bodies.equal() {
            return Err(Error::State("it is of two equal bodies, and these are not".into()));
        }
        let (expected, stations) = {
            let system = self.bodies.system(state.point.mirrored);
            (system.unknowns(), system.stations.len())
        };
        if !state.fits(expected, stations) {
            let given = state.point.unknowns.len();
            return Err(Error::State(format!("it has {given} unknowns, this mesh {expected}")));
        }
        self.accept(state.clone());
        Ok(())
    }
}

impl State {
    fn fits(&self, unknowns: usize, stations: usize) -> bool {
        let fits = |point: &Point| {
            point.mirrored == self.point.mirrored
                && point.unknowns.len() == unknowns
                && point.active.len() == stations
                && point.contact_forces.len() == stations
        };
        let reusable = match &self.path {
            Path::Steady(reusable, _) => reusable.as_ref().map(|reusable| &reusable.linearization),
            Path::Transient(motion) => motion.reusable.as_ref(),
        };
        fits(&self.point)
            && reusable.is_none_or(|linearization| fits(&linearization.point))
            && match &self.path {
                Path::Steady(reusable, before) => {
                    reusable.as_ref().is_none_or(|reusable| reusable.fits(unknowns))
                        && before.as_ref().is_none_or(|point| fits(point))
                }
                Path::Transient(motion) => motion.fits(unknowns, (stations - 1) / 2) && fits(&motion.last.start),
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
