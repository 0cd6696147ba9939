//! Steps in time by [`runge_kutta`], with internal steps of their own choice.
//!
//! A one-step method, because inputs may jump wherever the importer sets them: what is stored (J of the tissue, r h of the
//! film) goes on from where it was, and nothing older matters. Internal steps are the communication step halved again and
//! again, so that a small change of the inputs does not change them.

use serde::{Deserialize, Serialize};

use super::bodies::{Bodies, PredictorEstimate, State, Task};
use super::drive::Drive;
use super::steady::PATIENCE;
use crate::equations::system::{Rates, StoredVolumes, System};
use crate::error::Error;
use crate::parameters::Control;
use crate::solver::deadline::Deadline;
use crate::solver::newton;
use crate::solver::runge_kutta::{self, ERROR_CONSTANT, GAMMA};

/// Most Newton iterations of a stage; where it takes more, a shorter step is the better way.
const ITERATIONS: usize = 12;
/// Most of them with an update larger than the unknowns.
const LARGE_UPDATES: usize = 3;
/// Internal steps are no shorter than the communication step over two to this power.
const HALVINGS: i32 = 24;
/// Most internal steps of a communication step, tried and taken: a host tool must not wait for ever.
const MOST_TRIALS: usize = 20_000;

/// How unknowns and depth move beyond what the mesh carries along, where to start looking for the next stage. From the changes within the last
/// two steps alone: from step to step the unknowns may jump with the rates of the inputs.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Trend {
    /// Rates of change between the two stages of the last step, unknowns and then the depth; empty where nothing is known.
    rates: Vec<f64>,
    /// How fast these change; empty likewise.
    changes: Vec<f64>,
    /// Half the time between those stages \[s\].
    half: f64,
    /// How fast the rate of the film's mass changes \[m^2/s^2\].
    pub film: Vec<[f64; 3]>,
}

impl Trend {
    /// What changes in an interval that begins so much after the last step, negative as an update of Newton's method.
    fn update(&self, after: f64, interval: f64) -> Vec<f64> {
        let mut update: Vec<f64> = self.rates.iter().map(|rate| -interval * rate).collect();
        let factor = interval * (self.half + after + 0.5 * interval);
        update.iter_mut().zip(&self.changes).for_each(|(update, change)| *update -= factor * change);
        update
    }

    /// After a step whose second stage came from what the mesh had carried to it, so much after the first.
    fn followed(&self, carried: &State, solved: &State, interval: f64, step: f64) -> Self {
        let of = |state: &State| [&state.unknowns[..], &[state.inputs.penetration_depth]].concat();
        let rates: Vec<f64> =
            of(carried).iter().zip(of(solved)).map(|(before, now)| (now - before) / interval).collect();
        let between = self.half + step - 0.5 * interval;
        let changes = rates.iter().zip(&self.rates).map(|(now, before)| (now - before) / between).collect();
        Self { rates, changes, half: 0.5 * interval, film: Vec::new() }
    }
}

/// What the next step in time goes by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Motion {
    pub trend: Trend,
    /// Length of the next internal step \[s\].
    suggestion: f64,
    /// Where the last tangent was formed.
    pub reusable: Option<State>,
    /// How the last communication step went, for its derivatives.
    pub course: Course,
}

impl Motion {
    /// Whether it is of these equations.
    pub fn fits(&self, system: &System) -> bool {
        let fits = |values: &Vec<f64>| values.is_empty() || values.len() == system.unknowns() + 1;
        let film = |trend: &Trend| trend.film.is_empty() || trend.film.len() == system.stations.len() / 2;
        let trend = |trend: &Trend| fits(&trend.rates) && fits(&trend.changes) && film(trend);
        let contact = self.course.contact_half_width;
        trend(&self.trend)
            && trend(&self.course.trend)
            && contact.is_finite()
            && contact >= 0.0
            && system.admits(&self.course.start)
            && self.reusable.as_ref().is_none_or(|linearization| system.admits(linearization))
    }
}

/// The course of a communication step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Course {
    pub start: State,
    /// What contact the mesh is made for at its end \[m\].
    contact_half_width: f64,
    trend: Trend,
    /// Lengths of its internal steps \[s\].
    pub steps: Vec<f64>,
}

impl Course {
    /// What contact the mesh is made for after a fraction of the step \[m\].
    fn contact_half_width(&self, fraction: f64) -> f64 {
        let [from, to] = [self.start.contact_half_width, self.contact_half_width];
        if from == to { from } else { from * (to / from).powf(fraction) }
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
    course: &'a Course,
    duration: f64,
    state: State,
    stored_volumes: StoredVolumes,
    trend: Trend,
    /// Where the last tangent was formed.
    reusable: Option<State>,
    iterations: usize,
}

impl<'a> TimeStepper<'a> {
    fn new(bodies: &mut Bodies, course: &'a Course, duration: f64, reusable: Option<State>) -> Self {
        let state = course.start.clone();
        let stored_volumes = bodies.system_of(&state).stored_volumes(&state);
        Self { course, duration, state, stored_volumes, trend: course.trend.clone(), reusable, iterations: 0 }
    }

    /// Both stages of an internal step; `visit` is told of each with the time from the start.
    fn stages(
        &mut self,
        bodies: &mut Bodies,
        drive: &Drive,
        time: f64,
        step: f64,
        mut visit: impl FnMut(&mut Bodies, &Stage, f64) -> Result<(), String>,
    ) -> Result<[Stage; 2], String> {
        let [formula, last] = runge_kutta::stages(step);
        let end = time + formula.time;
        let first = self.stage(bodies, None, drive, end, formula)?;
        visit(bodies, &first, end)?;
        let end = time + last.time;
        let second = self.stage(bodies, Some(&first), drive, end, last)?;
        visit(bodies, &second, end)?;
        Ok([first, second])
    }

    fn stage(
        &mut self,
        bodies: &mut Bodies,
        first: Option<&Stage>,
        drive: &Drive,
        time: f64,
        formula: runge_kutta::Stage,
    ) -> Result<Stage, String> {
        let parameters = bodies.parameters;
        let inputs = &drive.at(time);
        let later = formula.time - first.map_or(0.0, |first| first.formula.time);
        let before = first.map_or(&self.state, |first| &first.state);
        let carried = carried(bodies, before, self.course.contact_half_width(time / self.duration));
        let mut guess = carried.clone();
        let system = bodies.system_of(&guess);
        let mut update = self.trend.update(formula.time - later, later);
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
            maximum_iterations: ITERATIONS,
            patience: PATIENCE,
            most_large: LARGE_UPDATES,
            deadline: bodies.deadline,
        };
        let reusable = self.reusable.as_ref().map(|linearization| (linearization, PredictorEstimate::default()));
        let task = Task { control: parameters.control, settings, reusable };
        let (result, iterations) = bodies.settle(guess.guess_for(inputs, parameters.control), &task);
        self.iterations += iterations;
        let state = result?;
        let linearization = bodies.linearization(state.mirrored);
        if self.reusable.as_ref() != linearization {
            self.reusable = linearization.cloned();
        }
        let stored_volumes = bodies.system_of(&state).stored_volumes(&state);
        let rate = rates.of(&stored_volumes);
        Ok(Stage { formula, state, rate, stored_volumes, carried })
    }

    fn accept(&mut self, bodies: &Bodies, [first, second]: [Stage; 2], step: f64) {
        let between = (1.0 - GAMMA) * step;
        let film = second.rate.combined(1.0 / between, -1.0 / between, &first.rate).film;
        let mut trend = self.trend.followed(&second.carried, &second.state, between, step);
        if bodies.parameters.cavitation {
            // A film that cavitates and heals moves with kinks.
            trend.changes.clear();
        }
        self.trend = Trend { film, ..trend };
        self.state = State { rates: Some(Rates::known(second.rate)), ..second.state };
        self.stored_volumes = second.stored_volumes;
    }
}

/// A guess of the state a little later, on the mesh of the contact then.
fn carried(bodies: &mut Bodies, state: &State, contact_half_width: f64) -> State {
    let mut guess = State { contact_half_width, ..state.clone() };
    if contact_half_width != state.contact_half_width {
        let system = bodies.system(state.mirrored);
        let ratio = system.carry(&mut guess.unknowns, state.contact_half_width, contact_half_width);
        guess.inputs.penetration_depth *= ratio;
    }
    guess
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
    let mut course = Course {
        start: from.clone(),
        contact_half_width,
        trend: motion.map(|motion| motion.trend.clone()).unwrap_or_default(),
        steps: Vec::new(),
    };
    let suggestion = motion.map_or(duration, |motion| motion.suggestion);
    let mut spent = 0;
    let mut apart = !(bodies.may_mirror(&drive.at(0.0)) && bodies.may_mirror(&drive.at(duration)));
    loop {
        if apart && course.start.mirrored {
            course = separate(bodies, course);
        }
        let reusable = motion.and_then(|motion| motion.reusable.clone());
        let (result, iterations) = integrate(bodies, &course, drive, duration, suggestion, reusable);
        spent += iterations;
        match result {
            Ok((state, motion)) => return Ok((state, motion, spent)),
            // Friction pulls the bodies apart sideways: the step starts anew with both of them.
            Err(Stop::Dragged) => apart = true,
            Err(Stop::Stuck { time, reason }) => {
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
    let trend = Trend { film: course.trend.film, ..Trend::default() };
    Course { start: bodies.converted(course.start, false), trend, ..course }
}

/// The same motion in the unknowns of two bodies.
pub(super) fn apart(bodies: &mut Bodies, motion: &Motion) -> Motion {
    Motion { reusable: None, course: separate(bodies, motion.course.clone()), ..motion.clone() }
}

/// Why an integration ended early.
enum Stop {
    Dragged,
    Stuck { time: f64, reason: String },
}

fn integrate(
    bodies: &mut Bodies,
    course: &Course,
    drive: &Drive,
    duration: f64,
    suggestion: f64,
    reusable: Option<State>,
) -> (Result<(State, Motion), Stop>, usize) {
    let longest = bodies.parameters.maximum_internal_step;
    let shortest = f64::from(-HALVINGS).exp2();
    let mut stepper = TimeStepper::new(bodies, course, duration, reusable);
    let (mut done, mut wanted, mut steps) = (0.0, suggestion, Vec::new());
    let mut trials = 0;
    while done < 1.0 {
        trials += 1;
        let fraction = fraction_of_step(done, (1.2 * wanted).min(longest) / duration);
        let (time, step) = (done * duration, fraction * duration);
        let stuck = |reason| Stop::Stuck { time, reason };
        if trials > MOST_TRIALS {
            let reason = format!("{MOST_TRIALS} internal steps were not enough");
            return (Err(stuck(reason)), stepper.iterations);
        }
        let tried = stepper.stages(bodies, drive, time, step, |_, _, _| Ok(()));
        let tried = tried.and_then(|stages| Ok((growth(bodies, &stages, stepper.state.rates.as_ref())?, stages)));
        match tried {
            Ok((_, [_, second])) if second.state.mirrored && bodies.drags(&second.state) => {
                return (Err(Stop::Dragged), stepper.iterations);
            }
            Ok((factor, _)) if factor < 1.0 && fraction > shortest => wanted = step * (0.9 * factor).clamp(0.1, 0.4),
            Ok((factor, stages)) => {
                stepper.accept(bodies, stages, step);
                steps.push(step);
                done += fraction;
                wanted = step * (0.9 * factor).min(4.0);
            }
            Err(_) if fraction > shortest => wanted = 0.2 * step,
            Err(reason) => return (Err(stuck(reason)), stepper.iterations),
        }
    }
    let TimeStepper { state, trend, reusable, iterations, .. } = stepper;
    let course = Course { steps, ..course.clone() };
    (Ok((state, Motion { trend, suggestion: wanted, reusable, course })), iterations)
}

/// The next internal step as a fraction of the communication step: one over a power of two, not above `most`, and ending where
/// steps of that length end.
fn fraction_of_step(done: f64, most: f64) -> f64 {
    let mut fraction = most.min(1.0).log2().floor().exp2();
    // Exact: both are sums of powers of two.
    while (done / fraction).fract() != 0.0 {
        fraction *= 0.5;
    }
    fraction
}

/// By how much the step could have been longer for the error that is allowed; below 1 it was too long.
fn growth(bodies: &mut Bodies, [first, second]: &[Stage; 2], before: Option<&Rates>) -> Result<f64, String> {
    let allowed = bodies.parameters.relative_tolerance;
    let system = bodies.system_of(&second.state);
    let size = |error: StoredVolumes| {
        let mut update = vec![0.0; system.unknowns()];
        system.add_storage(&second.state, &error, &mut update);
        system.solve(&mut update).map_err(|singular| singular.to_string())?;
        Ok::<_, String>((system.mean_relative_size(&second.state.unknowns, &update) / allowed).max(1e-9))
    };
    // Against the method of first order that goes on with the rates of the first stage; the error in what is stored is this
    // times gamma times the step, which the tangent divides by again.
    let change = second.rate.combined(1.0, -1.0, &first.rate);
    let by_first_order = size(change.clone())?.powf(-1.0 / 2.0);
    // Where the motion is smooth the error of the method itself is less: its error constant times the third derivative, from
    // divided differences of the rates at the start and at the two stages.
    let Some(before) = before else { return Ok(by_first_order) };
    let earlier = first.rate.combined(1.0, -1.0, &before.history);
    let error = change.combined(1.0 / (1.0 - GAMMA), -1.0 / GAMMA, &earlier).scaled(2.0 * ERROR_CONSTANT / GAMMA);
    Ok(by_first_order.max(size(error)?.powf(-1.0 / 3.0)))
}

/// Takes the course of a communication step again; `visit` is told of each stage with its time.
pub(super) fn replay(
    bodies: &mut Bodies,
    course: &Course,
    drive: &Drive,
    duration: f64,
    mut visit: impl FnMut(&mut Bodies, &Stage, f64) -> Result<(), String>,
) -> Result<(), String> {
    // Long after the step, perhaps.
    bodies.deadline = Deadline::after(bodies.parameters.maximum_solve_time);
    let mut stepper = TimeStepper::new(bodies, course, duration, None);
    let mut time = 0.0;
    for step in &course.steps {
        let stages = stepper.stages(bodies, drive, time, *step, &mut visit)?;
        stepper.accept(bodies, stages, *step);
        time += step;
    }
    Ok(())
}
