//! Steps in time by [`runge_kutta`], with internal steps of their own choice.
//!
//! A one-step method, because inputs may jump wherever the importer sets them: what is stored (J of the tissue, r h of the
//! film) goes on from where it was, and nothing older matters. Internal steps are the communication step halved again and
//! again, so that a small change of the inputs does not change them.

use serde::{Deserialize, Serialize};

use super::bodies::{Bodies, LinearizationPoint, Point, PredictorEstimate, Task};
use super::drive::Drive;
use super::steady::PATIENCE;
use crate::equations::system::{Rates, StoredVolumes};
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
    fn followed(&self, carried: &Point, solved: &Point, interval: f64, step: f64) -> Self {
        let of = |point: &Point| [&point.unknowns[..], &[point.inputs.penetration_depth]].concat();
        let rates: Vec<f64> =
            of(carried).iter().zip(of(solved)).map(|(before, now)| (now - before) / interval).collect();
        let between = self.half + step - 0.5 * interval;
        let changes = rates.iter().zip(&self.rates).map(|(now, before)| (now - before) / between).collect();
        Self { rates, changes, half: 0.5 * interval, film: Vec::new() }
    }
}

/// What a transient state has beside its solution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Motion {
    /// Rates of change of what is stored, at the end.
    pub rate: StoredVolumes,
    pub trend: Trend,
    /// Length of the next internal step \[s\].
    suggestion: f64,
    /// Where the last tangent was formed.
    pub reusable: Option<LinearizationPoint>,
    /// How the last communication step went, for its derivatives.
    pub last: LastStep,
}

impl Motion {
    /// The rates as a difference formula.
    pub fn rates(&self) -> Rates {
        Rates { rate: 0.0, history: self.rate.clone() }
    }

    /// Whether it is of equations with so many unknowns.
    pub fn fits(&self, unknowns: usize, columns: usize) -> bool {
        let fits = |values: &Vec<f64>| values.is_empty() || values.len() == unknowns + 1;
        let trend = |trend: &Trend| fits(&trend.rates) && fits(&trend.changes);
        let rates = self.reusable.as_ref().and_then(|linearization| linearization.rates.as_ref());
        let stored_volumes =
            |stored: &StoredVolumes| stored.film.len() == columns && stored.stations.len() == 2 * columns + 1;
        let film = |trend: &Trend| trend.film.is_empty() || trend.film.len() == columns;
        let meshed = |contact: f64| contact.is_finite() && contact >= 0.0;
        trend(&self.trend)
            && trend(&self.last.trend)
            && film(&self.trend)
            && meshed(self.last.contact_half_width)
            && stored_volumes(&self.rate)
            && rates.is_none_or(|rates| stored_volumes(&rates.history))
    }
}

/// The course of a communication step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct LastStep {
    pub start: Point,
    /// What contact the mesh is made for at its end \[m\].
    contact_half_width: f64,
    trend: Trend,
    /// Lengths of its internal steps \[s\].
    pub steps: Vec<f64>,
}

impl LastStep {
    /// What contact the mesh is made for after a fraction of the step \[m\].
    fn contact_half_width(&self, share: f64) -> f64 {
        let [from, to] = [self.start.contact_half_width, self.contact_half_width];
        if from == to { from } else { from * (to / from).powf(share) }
    }
}

/// A stage: its solution, and the difference formula that it satisfies.
pub(super) struct Stage {
    pub formula: runge_kutta::Stage,
    pub point: Point,
    pub rates: Rates,
    /// Rates of change of what is stored.
    pub rate: StoredVolumes,
    stored_volumes: StoredVolumes,
    /// Its unknowns as the mesh carried them along from the state before.
    carried: Point,
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

/// Where a march is.
struct TimeStepper<'a> {
    course: &'a LastStep,
    duration: f64,
    point: Point,
    stored_volumes: StoredVolumes,
    trend: Trend,
    /// Where the last tangent was formed.
    reusable: Option<LinearizationPoint>,
    iterations: usize,
}

impl<'a> TimeStepper<'a> {
    fn new(bodies: &mut Bodies, course: &'a LastStep, duration: f64, reusable: Option<LinearizationPoint>) -> Self {
        let point = course.start.clone();
        let stored_volumes = bodies.system_of(&point).stored_volumes(&point.unknowns, &point.inputs);
        Self { course, duration, point, stored_volumes, trend: course.trend.clone(), reusable, iterations: 0 }
    }

    /// Both stages of an internal step; `visit` is told of each with the time from the start of the march.
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
        let before = first.map_or(&self.point, |first| &first.point);
        let carried = carried(bodies, before, self.course.contact_half_width(time / self.duration));
        let mut guess = carried.clone();
        let system = bodies.system_of(&guess);
        let mut update = self.trend.update(formula.time - later, later);
        let followed = guess.inputs.penetration_depth - update.pop().unwrap_or_default();
        if !update.is_empty() {
            system.apply(&mut guess.unknowns, &update, &guess.active);
        }
        match parameters.control {
            Control::Depth => system.compress(&mut guess.unknowns, inputs.penetration_depth - followed),
            Control::Load => guess.inputs.penetration_depth = followed,
        }
        let history = history(&formula, &self.stored_volumes, first.map(|first| &first.rate));
        let rates = Rates { rate: formula.present, history };
        let settings = newton::Settings {
            tolerance: parameters.tolerance,
            maximum_iterations: ITERATIONS,
            patience: PATIENCE,
            most_large: LARGE_UPDATES,
            deadline: bodies.deadline,
        };
        let reusable = self.reusable.as_ref().map(|linearization| (linearization, PredictorEstimate::default()));
        let task = Task { inputs, rates: Some(&rates), control: parameters.control, settings, reusable };
        let (point, iterations) = bodies.settle(guess, &task);
        self.iterations += iterations;
        let point = point?;
        let linearization = bodies.linearization(point.mirrored);
        if self.reusable.as_ref() != linearization {
            self.reusable = linearization.cloned();
        }
        let stored_volumes = bodies.system_of(&point).stored_volumes(&point.unknowns, &point.inputs);
        let rate = rates.of(&stored_volumes);
        Ok(Stage { formula, point, rates, rate, stored_volumes, carried })
    }

    fn accept(&mut self, bodies: &Bodies, [first, second]: [Stage; 2], step: f64) -> StoredVolumes {
        let between = (1.0 - GAMMA) * step;
        let film = second.rate.combined(1.0 / between, -1.0 / between, &first.rate).film;
        let mut trend = self.trend.followed(&second.carried, &second.point, between, step);
        if bodies.parameters.cavitation {
            // A film that cavitates and heals moves with kinks.
            trend.changes.clear();
        }
        self.trend = Trend { film, ..trend };
        self.point = second.point;
        self.stored_volumes = second.stored_volumes;
        second.rate
    }
}

/// A guess of the state a little later, on the mesh of the contact then.
fn carried(bodies: &mut Bodies, point: &Point, contact_half_width: f64) -> Point {
    let mut guess = Point { contact_half_width, ..point.clone() };
    if contact_half_width != point.contact_half_width {
        let system = bodies.system(point.mirrored);
        let ratio = system.carry(&mut guess.unknowns, point.contact_half_width, contact_half_width);
        guess.inputs.penetration_depth *= ratio;
    }
    guess
}

/// Goes on for a communication step, at the end of which the mesh is made for a contact of this half-width. Returns the state at its end and the Newton iterations spent.
pub(super) fn advance(
    bodies: &mut Bodies,
    from: &Point,
    motion: Option<&Motion>,
    contact_half_width: f64,
    drive: &Drive,
    duration: f64,
) -> Result<(Point, Motion, usize), Error> {
    let mut start = LastStep {
        start: from.clone(),
        contact_half_width,
        trend: motion.map(|motion| motion.trend.clone()).unwrap_or_default(),
        steps: Vec::new(),
    };
    let mut rate = motion.map(|motion| motion.rate.clone());
    let suggestion = motion.map_or(duration, |motion| motion.suggestion);
    let mut spent = 0;
    let mut apart = !(bodies.may_mirror(&drive.at(0.0)) && bodies.may_mirror(&drive.at(duration)));
    loop {
        if apart && start.start.mirrored {
            separate(bodies, &mut start, &mut rate);
        }
        let reusable = motion.and_then(|motion| motion.reusable.clone());
        let (result, iterations) = integrate(bodies, &start, rate.clone(), drive, duration, suggestion, reusable);
        spent += iterations;
        match result {
            Ok((point, motion)) => return Ok((point, motion, spent)),
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
fn separate(bodies: &mut Bodies, start: &mut LastStep, rate: &mut Option<StoredVolumes>) {
    start.trend = Trend { film: std::mem::take(&mut start.trend.film), ..Trend::default() };
    start.start = bodies.converted(start.start.clone(), false);
    if let Some(rate) = rate {
        rate.volume.extend_from_within(..);
    }
}

/// The same motion in the unknowns of two bodies.
pub(super) fn apart(bodies: &mut Bodies, motion: &Motion) -> Motion {
    let mut motion = Motion { reusable: None, ..motion.clone() };
    let mut rate = Some(motion.rate.clone());
    separate(bodies, &mut motion.last, &mut rate);
    motion
}

/// Why a march ended early.
enum Stop {
    Dragged,
    Stuck { time: f64, reason: String },
}

fn integrate(
    bodies: &mut Bodies,
    start: &LastStep,
    mut rate: Option<StoredVolumes>,
    drive: &Drive,
    duration: f64,
    suggestion: f64,
    reusable: Option<LinearizationPoint>,
) -> (Result<(Point, Motion), Stop>, usize) {
    let longest = bodies.parameters.maximum_internal_step;
    let shortest = f64::from(-HALVINGS).exp2();
    let mut stepper = TimeStepper::new(bodies, start, duration, reusable);
    let (mut done, mut wanted, mut steps) = (0.0, suggestion, Vec::new());
    let mut trials = 0;
    while done < 1.0 {
        trials += 1;
        let share = share_of_step(done, (1.2 * wanted).min(longest) / duration);
        let (time, step) = (done * duration, share * duration);
        let stuck = |reason| Stop::Stuck { time, reason };
        if trials > MOST_TRIALS {
            let reason = format!("{MOST_TRIALS} internal steps were not enough");
            return (Err(stuck(reason)), stepper.iterations);
        }
        match stepper.stages(bodies, drive, time, step, |_, _, _| Ok(())) {
            Ok([_, second]) if second.point.mirrored && bodies.drags(&second.point) => {
                return (Err(Stop::Dragged), stepper.iterations);
            }
            Ok(stages) => {
                let factor = match growth(bodies, &stages, rate.as_ref()) {
                    Ok(factor) => factor,
                    Err(reason) => return (Err(stuck(reason)), stepper.iterations),
                };
                if factor < 1.0 && share > shortest {
                    wanted = step * (0.9 * factor).clamp(0.1, 0.4);
                    continue;
                }
                rate = Some(stepper.accept(bodies, stages, step));
                steps.push(step);
                done += share;
                wanted = step * (0.9 * factor).min(4.0);
            }
            Err(_) if share > shortest => wanted = 0.2 * step,
            Err(reason) => return (Err(stuck(reason)), stepper.iterations),
        }
    }
    let TimeStepper { point, trend, reusable, iterations, .. } = stepper;
    let last = LastStep { steps, ..start.clone() };
    let motion = rate.map(|rate| Motion { rate, trend, suggestion: wanted, reusable, last });
    let end = motion.map(|motion| (point, motion));
    (end.ok_or_else(|| Stop::Stuck { time: 0.0, reason: "the step has no length".into() }), iterations)
}

/// The next internal step as a fraction of the communication step: one over a power of two, not above `most`, and ending where
/// steps of that length end.
fn share_of_step(done: f64, most: f64) -> f64 {
    let mut share = most.min(1.0).log2().floor().exp2();
    // Exact: both are sums of powers of two.
    while (done / share).fract() != 0.0 {
        share *= 0.5;
    }
    share
}

/// By how much the step could have been longer for the error that is allowed; below 1 it was too long.
fn growth(bodies: &mut Bodies, [first, second]: &[Stage; 2], before: Option<&StoredVolumes>) -> Result<f64, String> {
    let allowed = bodies.parameters.relative_tolerance;
    let system = bodies.system_of(&second.point);
    let size = |error: StoredVolumes| {
        let mut update = vec![0.0; system.unknowns()];
        system.add_storage(&second.point.unknowns, &second.point.inputs, &error, &mut update);
        system.solve(&mut update).map_err(|singular| singular.to_string())?;
        Ok::<_, String>((system.mean_relative_size(&second.point.unknowns, &update) / allowed).max(1e-9))
    };
    // Against the method of first order that goes on with the rates of the first stage; the error in what is stored is this
    // times gamma times the step, which the tangent divides by again.
    let change = second.rate.combined(1.0, -1.0, &first.rate);
    let by_first_order = size(change.clone())?.powf(-1.0 / 2.0);
    // Where the motion is smooth the error of the method itself is less: its error constant times the third derivative, from
    // divided differences of the rates at the start and at the two stages.
    let Some(before) = before else { return Ok(by_first_order) };
    let earlier = first.rate.combined(1.0, -1.0, before);
    let error = change.combined(1.0 / (1.0 - GAMMA), -1.0 / GAMMA, &earlier).scaled(2.0 * ERROR_CONSTANT / GAMMA);
    Ok(by_first_order.max(size(error)?.powf(-1.0 / 3.0)))
}

/// Takes the course of a communication step again; `visit` is told of each stage with its time.
pub(super) fn replay(
    bodies: &mut Bodies,
    last: &LastStep,
    drive: &Drive,
    duration: f64,
    mut visit: impl FnMut(&mut Bodies, &Stage, f64) -> Result<(), String>,
) -> Result<(), String> {
    // Long after the step, perhaps.
    bodies.deadline = Deadline::after(bodies.parameters.maximum_solve_time);
    let mut stepper = TimeStepper::new(bodies, last, duration, None);
    let mut time = 0.0;
    for step in &last.steps {
        let stages = stepper.stages(bodies, drive, time, *step, &mut visit)?;
        stepper.accept(bodies, stages, *step);
        time += step;
    }
    Ok(())
}
