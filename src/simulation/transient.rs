//! Steps in time by [`runge_kutta`], with internal steps of their own choice.
//!
//! A one-step method, because inputs may jump wherever the importer sets them: what is stored (J of the tissue, r h of the
//! film) goes on from where it was, and nothing older matters. Internal steps are those of [`time_stepping`].

use serde::{Deserialize, Serialize};

use super::bodies::{Bodies, PredictorEstimate, State, Task};
use super::drive::Drive;
use super::steady::PATIENCE;
use crate::equations::system::{Rates, ReusableTangent, StoredVolumes, System};
use crate::error::Error;
use crate::parameters::Control;
use crate::solver::deadline::Deadline;
use crate::solver::newton;
use crate::solver::predictor::Trend;
use crate::solver::runge_kutta::{self, GAMMA, Linear};
use crate::solver::time_stepping::{self, Failure, Method, Stuck};

/// Most Newton iterations of a stage; where it takes more, a shorter step is the better way.
const ITERATIONS: usize = 12;
/// Most of them with an update larger than the unknowns.
const LARGE_UPDATES: usize = 3;
/// And where the step was found once and has to be found again.
const ITERATIONS_AGAIN: usize = 60;

/// What the next step in time goes by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Motion {
    /// How unknowns and depth move beyond what the mesh carries along, to where the next stage is expected.
    trend: Trend,
    /// How fast the rate of the film's mass changes \[m^2/s^2\].
    pub film_trend: Vec<[f64; 3]>,
    /// Length of the next internal step \[s\].
    suggestion: f64,
    /// The last tangent.
    pub reusable: Option<ReusableTangent>,
    /// How the last communication step went, for its derivatives.
    pub course: Course,
}

impl Motion {
    /// Whether it is of these equations.
    pub fn fits(&self, system: &System) -> bool {
        let contact = self.course.contact_half_width;
        [&self.trend, &self.course.trend].into_iter().all(|trend| trend.fits(system.unknowns() + 1))
            && self.film_trend.len() == system.stations.len() / 2
            && contact.is_finite()
            && contact >= 0.0
            && system.admits_shifts(&self.course.shifts)
            && system.admits(&self.course.start)
            && [&self.reusable, &self.course.reusable].into_iter().flatten().all(|reusable| reusable.fits(system))
    }
}

/// The course of a communication step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Course {
    pub start: State,
    /// What contact the mesh is made for at its end \[m\].
    contact_half_width: f64,
    /// How the surfaces' nodes are shifted against each other at its end, see [`State::shifts`].
    shifts: Vec<f64>,
    trend: Trend,
    /// The tangent that it began with.
    reusable: Option<ReusableTangent>,
    /// Lengths of its internal steps \[s\].
    pub steps: Vec<f64>,
}

impl Course {
    /// What contact the mesh is made for after a fraction of the step \[m\].
    fn contact_half_width(&self, fraction: f64) -> f64 {
        let [from, to] = [self.start.contact_half_width, self.contact_half_width];
        if from == to { from } else { from * (to / from).powf(fraction) }
    }

    /// How the surfaces' nodes are shifted against each other after a fraction of the step.
    fn shifts(&self, fraction: f64) -> Vec<f64> {
        let from = |i: usize| self.start.shifts.get(i).copied().unwrap_or_default();
        self.shifts.iter().enumerate().map(|(i, to)| from(i) + fraction * (to - from(i))).collect()
    }
}

/// A stage: its solution, with the rates by its difference formula.
pub(super) struct Stage {
    pub formula: runge_kutta::Stage,
    pub state: State,
    /// Rates of change of what is stored.
    pub rate: StoredVolumes,
    stored_volumes: StoredVolumes,
    /// Its unknowns as the mesh carried them along from the state before.
    carried: State,
    /// By how much unknowns and depth are off from where they were expected.
    missed: Vec<f64>,
}

/// The rest of a stage's difference formula. Linear in what was stored before and in the rates of the first stage: changes
/// follow the same formula.
pub(super) fn history(
    stage: &runge_kutta::Stage,
    before: &StoredVolumes,
    first: Option<&StoredVolumes>,
) -> StoredVolumes {
    before.combined(stage.before, stage.first, first.unwrap_or(before))
}

/// How far an integration is.
struct TimeStepper<'a> {
    bodies: &'a mut Bodies,
    drive: &'a Drive,
    course: &'a Course,
    duration: f64,
    state: State,
    stored_volumes: StoredVolumes,
    trend: Trend,
    film_trend: Vec<[f64; 3]>,
    reusable: Option<ReusableTangent>,
    iterations: usize,
    /// Most iterations of a stage, and most of them with a large update.
    most: [usize; 2],
}

impl<'a> TimeStepper<'a> {
    fn new(bodies: &'a mut Bodies, drive: &'a Drive, course: &'a Course, duration: f64) -> Self {
        let state = course.start.clone();
        let stored_volumes = bodies.system_of(&state).stored_volumes(&state);
        let (trend, film_trend, reusable) = (course.trend.clone(), Vec::new(), course.reusable.clone());
        let most = [ITERATIONS, LARGE_UPDATES];
        Self {
            bodies,
            drive,
            course,
            duration,
            state,
            stored_volumes,
            trend,
            film_trend,
            reusable,
            iterations: 0,
            most,
        }
    }

    /// Both stages of an internal step; `visit` is told of each with the time from the start.
    fn stages(
        &mut self,
        time: f64,
        step: f64,
        mut visit: impl FnMut(&mut Bodies, &Stage, f64) -> Result<(), String>,
    ) -> Result<[Stage; 2], String> {
        let [formula, last] = runge_kutta::stages(step);
        let end = time + formula.time;
        let first = self.stage(None, end, formula)?;
        visit(self.bodies, &first, end)?;
        self.reusable = self.bodies.system(first.state.mirrored).reusable_tangent();
        let end = time + last.time;
        let second = self.stage(Some(&first), end, last)?;
        visit(self.bodies, &second, end)?;
        self.reusable = self.bodies.system(second.state.mirrored).reusable_tangent();
        Ok([first, second])
    }

    fn stage(&mut self, first: Option<&Stage>, time: f64, formula: runge_kutta::Stage) -> Result<Stage, String> {
        let bodies = &mut *self.bodies;
        let parameters = bodies.parameters;
        let inputs = &self.drive.at(time);
        let later = formula.time - first.map_or(0.0, |first| first.formula.time);
        let before = first.map_or(&self.state, |first| &first.state);
        let fraction = time / self.duration;
        let carried = bodies.carried(before, self.course.contact_half_width(fraction), self.course.shifts(fraction));
        let mut guess = carried.clone();
        let system = bodies.system_of(&guess);
        // What the first stage was off by goes on growing.
        let corrected = first.map(|first| self.trend.corrected(&first.missed, first.formula.time));
        let mut update = corrected.as_ref().unwrap_or(&self.trend).update(formula.time - later, later);
        let followed = guess.inputs.penetration_depth - update.pop().unwrap_or_default();
        if !update.is_empty() {
            system.apply(&mut guess.unknowns, &update, &guess.active);
        }
        if parameters.control == Control::Depth {
            system.compress(&mut guess.unknowns, inputs.penetration_depth - followed);
        }
        guess.inputs.penetration_depth = followed;
        let history = history(&formula, &self.stored_volumes, first.map(|first| &first.rate));
        let rates = Rates { rate: formula.present, history };
        guess.rates = Some(rates.clone());
        let settings = newton::Settings {
            tolerance: parameters.tolerance,
            maximum_iterations: self.most[0],
            patience: PATIENCE,
            most_large: self.most[1],
            deadline: bodies.deadline,
        };
        let reusable = self.reusable.as_ref().map(|reusable| {
            let estimate = PredictorEstimate { remainder: reusable.remainder, ..PredictorEstimate::default() };
            (&reusable.linearization, estimate)
        });
        let task = Task { control: parameters.control, settings, distance_counts: true, reusable };
        let guess = guess.guess_for(inputs, parameters.control);
        let expected = guess.unknowns_and_depth();
        let (result, iterations) = bodies.settle(guess, &task);
        self.iterations += iterations;
        let state = result?;
        let missed =
            state.unknowns_and_depth().iter().zip(&expected).map(|(found, expected)| found - expected).collect();
        let stored_volumes = bodies.system_of(&state).stored_volumes(&state);
        let rate = rates.of(&stored_volumes);
        Ok(Stage { formula, state, rate, stored_volumes, carried, missed })
    }
}

/// Why an integration ended early.
enum Reason {
    /// Friction pulls the bodies of a mirrored pair apart sideways.
    Dragged,
    Words(String),
}

impl From<String> for Reason {
    fn from(words: String) -> Self {
        Self::Words(words)
    }
}

impl Method for TimeStepper<'_> {
    type Step = [Stage; 2];
    type Reason = Reason;

    fn attempt(&mut self, time: f64, step: f64) -> Result<([Stage; 2], f64), Failure<Reason>> {
        let stages = self.stages(time, step, |_, _, _| Ok(())).map_err(|words| Failure::Retry(words.into()))?;
        let state = &stages[1].state;
        if state.mirrored && self.bodies.drags(state) {
            return Err(Failure::Stop(Reason::Dragged));
        }
        let growth = growth(self.bodies, &stages, self.state.rates.as_ref());
        growth.map(|growth| (stages, growth)).map_err(|words| Failure::Retry(words.into()))
    }

    fn accept(&mut self, [first, second]: [Stage; 2], step: f64) {
        let between = (1.0 - GAMMA) * step;
        self.film_trend = second.rate.combined(1.0 / between, -1.0 / between, &first.rate).film;
        let [carried, solved] = [&second.carried, &second.state].map(State::unknowns_and_depth);
        let trend = self.trend.followed([&carried, &solved], between, step);
        // A film that cavitates and heals moves with kinks.
        self.trend = if self.bodies.parameters.cavitation { trend.straight() } else { trend };
        self.state = State { rates: Some(Rates::known(second.rate)), ..second.state };
        self.stored_volumes = second.stored_volumes;
    }
}

/// Goes on for a communication step, at the end of which the mesh is made for a contact of this half-width. Returns the state at its end and the Newton iterations spent.
pub(super) fn advance(
    bodies: &mut Bodies,
    from: &State,
    motion: Option<&Motion>,
    contact_half_width: f64,
    drive: &Drive,
    duration: f64,
) -> Result<(State, Motion, usize), Error> {
    let system = bodies.system_of(from);
    let shifts = if system.pairs_deformed() { system.wanted_shifts(from) } else { from.shifts.clone() };
    let mut course = Course {
        start: from.clone(),
        contact_half_width,
        shifts,
        trend: motion.map(|motion| motion.trend.clone()).unwrap_or_default(),
        reusable: motion.and_then(|motion| motion.reusable.clone()),
        steps: Vec::new(),
    };
    let suggestion = motion.map_or(duration, |motion| motion.suggestion);
    let mut spent = 0;
    let mut apart = !(bodies.may_mirror(&drive.at(0.0)) && bodies.may_mirror(&drive.at(duration)));
    loop {
        if apart && course.start.mirrored {
            course = separate(bodies, course);
        }
        let longest = bodies.parameters.maximum_internal_step;
        let mut stepper = TimeStepper::new(bodies, drive, &course, duration);
        let result = time_stepping::advance(&mut stepper, duration, suggestion, longest);
        let TimeStepper { state, trend, film_trend, reusable, iterations, .. } = stepper;
        spent += iterations;
        match result {
            Ok((steps, suggestion)) => {
                let course = Course { steps, ..course };
                return Ok((state, Motion { trend, film_trend, suggestion, reusable, course }, spent));
            }
            // The step starts anew with both bodies.
            Err(Stuck { reason: Reason::Dragged, .. }) => apart = true,
            Err(Stuck { time, reason: Reason::Words(reason) }) => {
                let described = |time| drive.at(time).described(bodies.parameters.control);
                return Err(Error::NotConverged {
                    requested: format!("the end of a step of {duration} s ({})", described(duration)),
                    reached: format!("{time:e} s ({})", described(time)),
                    fraction: time / duration,
                    reason,
                });
            }
        }
    }
}

/// From a mirrored pair to two bodies.
fn separate(bodies: &mut Bodies, course: Course) -> Course {
    Course { start: bodies.converted(course.start, false), trend: Trend::default(), reusable: None, ..course }
}

/// The same motion in the unknowns of two bodies.
pub(super) fn apart(bodies: &mut Bodies, motion: &Motion) -> Motion {
    Motion { reusable: None, course: separate(bodies, motion.course.clone()), ..motion.clone() }
}

/// By how much the step could have been longer for the error that is allowed; below 1 it was too long.
fn growth(bodies: &mut Bodies, [first, second]: &[Stage; 2], before: Option<&Rates>) -> Result<f64, String> {
    let allowed = bodies.parameters.relative_tolerance;
    let system = bodies.system_of(&second.state);
    runge_kutta::growth(before.map(|before| &before.history), [&first.rate, &second.rate], |error| {
        let mut update = vec![0.0; system.unknowns()];
        system.add_storage(&second.state, error, &mut update);
        let given = update.clone();
        if system.solve(&mut update).is_err() {
            // The tangent may be of another mesh, on which no solution can be refined.
            update = given;
            let formed = system.form(&second.state);
            formed.and_then(|()| system.solve(&mut update)).map_err(|singular| singular.to_string())?;
        }
        Ok(system.mean_relative_size(&second.state.unknowns, &update) / allowed)
    })
}

/// Takes the course of a communication step again; `visit` is told of each stage with its time. The tangents that it forms are
/// those of the stages after: one nearer than those of the step, from which the stage is reached the more surely.
pub(super) fn replay(
    bodies: &mut Bodies,
    course: &Course,
    drive: &Drive,
    duration: f64,
    mut visit: impl FnMut(&mut Bodies, &Stage, f64) -> Result<(), String>,
) -> Result<(), String> {
    // Long after the step, perhaps.
    bodies.deadline = Deadline::after(bodies.parameters.maximum_solve_time);
    let mut stepper = TimeStepper::new(bodies, drive, course, duration);
    stepper.most = [ITERATIONS_AGAIN; 2];
    let mut time = 0.0;
    for step in &course.steps {
        let stages = stepper.stages(time, *step, &mut visit)?;
        stepper.accept(stages, *step);
        time += step;
    }
    Ok(())
}
