//! The way to a steady state: steps of the inputs, and where they fail, motion in time that comes to rest.

use serde::{Deserialize, Serialize};

use super::bodies::{Bodies, Foreseen, LONGEST_APPROACH, Place, Point, Task};
use crate::equations::grid;
use crate::equations::system::Rates;
use crate::error::Error;
use crate::outputs::Solved;
use crate::parameters::{Control, Formulation, Inputs};
use crate::solver::linear::Singular;
use crate::solver::{continuation, newton};

/// A steady state, and the tangent that led to it: near enough to predict states nearby and to solve for them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Steady {
    pub point: Point,
    pub kept: Option<Box<Kept>>,
    /// The state before, where the mesh goes with the contact.
    pub before: Option<Box<Point>>,
}

/// Where a tangent was formed, and what it missed in the last step that was predicted with it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Kept {
    pub place: Place,
    miss: Option<Miss>,
}

impl Kept {
    /// Whether what was missed is of equations with so many unknowns.
    pub fn fits(&self, unknowns: usize) -> bool {
        let fits = |values: &[f64]| values.len() == unknowns + 1;
        self.miss.as_ref().is_none_or(|miss| fits(&miss.now) && fits(&miss.next))
    }
}

/// The difference of a solution to its prediction, unknowns and then the depth. Along a smooth way it grows evenly from step to step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Miss {
    /// See [`changes`].
    changes: [f64; 3],
    now: Vec<f64>,
    /// What a step like this one is expected to miss.
    next: Vec<f64>,
}

impl Miss {
    /// What was missed by these changes, after what was missed before.
    fn new(before: Option<&Self>, changes: [f64; 3], solved: &Point, predicted: &Point) -> Self {
        let of = |point: &Point| [&point.unknowns[..], &[point.inputs.penetration_depth]].concat();
        let now: Vec<f64> = of(solved).into_iter().zip(of(predicted)).map(|(z, p)| z - p).collect();
        let next = match before.and_then(|before| Some((&before.now, before.share(changes)?))) {
            Some((before, share)) => now.iter().zip(before).map(|(now, before)| 2.0 * now - share * before).collect(),
            None => now.clone(),
        };
        Self { changes, now, next }
    }

    /// How many times as far these changes go in the same direction; none if in another.
    fn share(&self, changes: [f64; 3]) -> Option<f64> {
        proportion(changes, self.changes)
    }
}

/// How many times as far as before changes go in the same direction; none if in another, or much further.
fn proportion(now: [f64; 3], then: [f64; 3]) -> Option<f64> {
    const ALIKE: f64 = 0.3;
    let mut shares = now.into_iter().zip(then).filter(|(now, then)| *now != 0.0 || *then != 0.0);
    let share = shares.next().map(|(now, then)| now / then)?;
    let alike = shares.all(|(now, then)| (now / then - share).abs() <= ALIKE * share.abs());
    (alike && share.abs() < 3.0).then_some(share)
}

/// A guess of a state, from what it was predicted, and how far it may be trusted.
struct Guess {
    point: Point,
    /// The prediction by the tangent alone.
    predicted: Point,
    changes: [f64; 3],
    foreseen: Option<Foreseen>,
}

/// Changes of what is given: depth or load, speed, and slide-to-roll ratio.
fn changes(from: &Inputs, to: &Inputs, control: Control) -> [f64; 3] {
    let first = match control {
        Control::Depth => to.penetration_depth - from.penetration_depth,
        Control::Load => to.applied_load - from.applied_load,
    };
    [first, to.sliding_speed - from.sliding_speed, to.slide_to_roll_ratio - from.slide_to_roll_ratio]
}

/// A tangent is kept for as many Newton iterations as cost about as much as its factorisation, see [`newton::Settings::patience`].
pub(super) const PATIENCE: f64 = 4.0;
/// Most Newton iterations with a new tangent from a state nearby.
const WARM_ITERATIONS: usize = 12;
/// Likewise from rest, which takes ten to fifteen.
const COLD_ITERATIONS: usize = 25;

/// Most Newton iterations of one step in time on the way to a steady state, and of all of them.
const RELAXING_ITERATIONS: usize = 10;
/// How far the bones approach in one such step of a millisecond or more, as a share of the layers' thickness; in proportion less
/// in shorter ones.
const RELAXING_APPROACH: f64 = 0.02;
const LONGEST_RELAXATION: usize = 2000;

/// The steady state for these inputs, from a state that may be near, or from rest; adds to the count of iterations.
pub(super) fn solve(
    bodies: &mut Bodies,
    from: Option<Steady>,
    inputs: &Inputs,
    iterations: &mut usize,
) -> Result<Steady, Error> {
    match bodies.parameters.control {
        Control::Depth => at_depth(bodies, from, inputs, iterations),
        Control::Load => under_load(bodies, from, inputs, iterations),
    }
}

fn at_depth(
    bodies: &mut Bodies,
    from: Option<Steady>,
    inputs: &Inputs,
    iterations: &mut usize,
) -> Result<Steady, Error> {
    let from = match from {
        Some(from) => from,
        None if grid::moves(&bodies.parameters) => {
            // Set in motion before they are pressed: a film is there from the start, and the mesh goes along with the contact.
            let rest = rest(bodies, inputs);
            let apart = Inputs { penetration_depth: rest.point.inputs.penetration_depth, ..*inputs };
            travel(bodies, &rest, &apart, iterations)?
        }
        None => rest(bodies, inputs),
    };
    let result = travel(bodies, &from, inputs, iterations);
    if result.as_ref().err().is_none_or(is_unresolved) {
        return result;
    }
    // Without motion fluid and film play no part, and pressing is easy; then the surfaces are set in motion.
    let rest = rest(bodies, inputs);
    let pressed = Inputs { sliding_speed: 0.0, ..*inputs };
    let moved =
        travel(bodies, &rest, &pressed, iterations).and_then(|state| travel(bodies, &state, inputs, iterations));
    moved.or(result)
}

/// Least load for which there is a steady film worth the name [N/m].
const LEAST_LOAD: f64 = 1e-6;
/// First stride on the way to the depth of a load, as a share of the layers' thickness.
const FIRST_STRIDE: f64 = 2e-3;
/// Newton's method takes over where the load is right within this factor.
const NEAR: f64 = 3.0;

fn under_load(
    bodies: &mut Bodies,
    from: Option<Steady>,
    inputs: &Inputs,
    iterations: &mut usize,
) -> Result<Steady, Error> {
    let given = inputs.applied_load;
    if given < LEAST_LOAD {
        let allowed = format!("{LEAST_LOAD:e} N/m or more: with less the surfaces part, and there is no steady state");
        return Err(Error::value("applied_load", given, allowed));
    }
    if let Some(from) = &from {
        let mut state = from.clone();
        let arrived = continuation::advance(first_load_step(&from.point.inputs, inputs), |to| {
            let target = along_load(&from.point.inputs, inputs, to);
            let (next, spent) = step(bodies, &state, &target, WARM_ITERATIONS, Control::Load);
            *iterations += spent;
            state = next?;
            Ok::<_, String>(to)
        });
        if arrived.is_ok() {
            return Ok(state);
        }
    }
    // By strides of the depth until the load is near; each stride is a problem that is known to be solvable.
    let thickness = bodies.system(bodies.equal()).thickness();
    let mut state = from;
    let (mut stride, mut last_side) = (FIRST_STRIDE * thickness, 0.0);
    let mut depth = match &state {
        None if grid::moves(&bodies.parameters) => grid::depth_under(&bodies.parameters, given),
        state => {
            state.as_ref().map_or_else(|| bodies.rest(inputs).inputs, |state| state.point.inputs).penetration_depth
        }
    };
    loop {
        let next = at_depth(bodies, state, &Inputs { penetration_depth: depth, ..*inputs }, iterations)?;
        let load = load(bodies, &next.point);
        let reason = if load > given / NEAR && load < given * NEAR {
            match carried_by(bodies, &next, inputs, iterations) {
                Ok(state) => return Ok(state),
                Err(reason) => reason,
            }
        } else {
            "the load jumps with the depth".into()
        };
        let side = if load < given { 1.0 } else { -1.0 };
        stride *= if side * last_side < 0.0 {
            0.3
        } else if last_side == 0.0 {
            1.0
        } else {
            1.5
        };
        last_side = side;
        depth += side * stride;
        if stride < 1e-9 * thickness || depth.abs() > 10.0 * thickness {
            return Err(Error::NotConverged {
                requested: format!("applied_load = {given} N/m, {inputs}"),
                reached: format!("{load} N/m at {}", next.point.inputs),
                fraction: 0.0,
                reason,
            });
        }
        state = Some(next);
    }
}

/// The state under the given load, from one whose load is near: on the mesh of that load first, then by Newton's method.
fn carried_by(bodies: &mut Bodies, near: &Steady, inputs: &Inputs, iterations: &mut usize) -> Result<Steady, String> {
    let contact = bodies.contact_half_width(inputs, Control::Load);
    let depth = Inputs { penetration_depth: near.point.inputs.penetration_depth, ..*inputs };
    let mut state = near.clone();
    if contact != near.point.contact_half_width {
        let guess = bodies.remeshed(&near.point, contact);
        let (result, spent) = settle(bodies, guess, &depth, COLD_ITERATIONS, Control::Depth, None);
        *iterations += spent;
        state = result?;
    }
    let (result, spent) = step(bodies, &state, inputs, COLD_ITERATIONS, Control::Load);
    *iterations += spent;
    result
}

/// Load per unit depth [N/m].
pub(super) fn load(bodies: &mut Bodies, point: &Point) -> f64 {
    bodies.system_of(point).load(point.at(None))
}

fn rest(bodies: &mut Bodies, inputs: &Inputs) -> Steady {
    Steady { point: bodies.rest(inputs), kept: None, before: None }
}

/// Why no other way is tried, however long it would take.
const UNRESOLVED: &str = "the stress of the tissue is far above every pressure: the mesh does not resolve how the pressure falls in so \
                          tight a tissue, which in the paper's formulation turns elements inside out (formulation = \"consistent\" \
                          has no such limit, a larger permeability is further from it)";
/// Stress over pressure of such a state. On a mesh that is good enough they are of one size.
const UNRESOLVED_STRESS: f64 = 1e3;

fn is_unresolved(error: &Error) -> bool {
    matches!(error, Error::NotConverged { reason, .. } if reason == UNRESOLVED)
}

/// Whether a state of the paper's equations is one from which no step is worth trying that failed once.
fn unresolved(bodies: &mut Bodies, point: &Point) -> bool {
    let parameters = bodies.parameters;
    if parameters.formulation != Formulation::Paper {
        return false;
    }
    let solved = Solved { system: bodies.system_of(point), parameters: &parameters, at: point.at(None) };
    let (outputs, _) = solved.outputs();
    let fluid = outputs.maximum_fluid_pressure.max(-outputs.minimum_fluid_pressure);
    let largest = fluid.max(outputs.maximum_contact_pressure);
    largest > 0.0 && outputs.maximum_von_mises_stress > UNRESOLVED_STRESS * largest
}

/// Goes from one state to others by steps of the inputs, at the end through time.
fn travel(bodies: &mut Bodies, from: &Steady, inputs: &Inputs, iterations: &mut usize) -> Result<Steady, Error> {
    let cold = from.kept.is_none();
    let moves = grid::moves(&bodies.parameters);
    let limit = if cold || moves { COLD_ITERATIONS } else { WARM_ITERATIONS };
    let mut rest = (!cold).then(|| rest(bodies, inputs));
    let mut state = from.clone();
    let way = |to: f64| {
        if moves { along_contact(&from.point.inputs, inputs, to) } else { between(&from.point.inputs, inputs, to) }
    };
    let first = if moves { first_step(&from.point.inputs, inputs) } else { 1.0 };
    let mut lost = false;
    let result = continuation::advance(first, |to| {
        if lost {
            return Err(UNRESOLVED.to_string());
        }
        let target = way(to);
        let (mut next, spent) = step(bodies, &state, &target, limit, Control::Depth);
        *iterations += spent;
        let mut reached = to;
        if let (Err(_), Some(rest)) = (&next, rest.take().filter(|_| !moves)) {
            // Surfaces close more readily than they part: from rest even far targets are often reached at once.
            let (whole, spent) = step(bodies, &rest, inputs, COLD_ITERATIONS, Control::Depth);
            *iterations += spent;
            if whole.is_ok() {
                (next, reached) = (whole, 1.0);
            }
        }
        lost = next.is_err() && unresolved(bodies, &state.point);
        state = next?;
        Ok(reached)
    });
    let Err(continuation::Stuck { fraction, reason }) = result else { return Ok(state) };
    let (relaxed, spent) = if lost { (Err(reason.clone()), 0) } else { relax(bodies, &state.point, inputs) };
    *iterations += spent;
    relaxed.map_err(|_| Error::NotConverged {
        requested: inputs.to_string(),
        reached: state.point.inputs.to_string(),
        fraction,
        reason,
    })
}

/// One step of the continuation: the state at `target`, or why not; and the Newton iterations spent.
fn step(
    bodies: &mut Bodies,
    from: &Steady,
    target: &Inputs,
    limit: usize,
    control: Control,
) -> (Result<Steady, String>, usize) {
    let mirrored = from.point.mirrored && bodies.may_mirror(target);
    let contact = bodies.contact_half_width(target, control);
    if contact != from.point.contact_half_width {
        let guess = carry(bodies, from, target, contact, control);
        let guess = bodies.converted(guess, mirrored);
        let kept = from.kept.as_ref().map(|kept| (&kept.place, Foreseen::default()));
        let (result, spent) = settle(bodies, guess, target, limit, control, kept);
        let before = Some(Box::new(from.point.clone()));
        return (result.map(|state| Steady { before, ..state }), spent);
    }
    let Guess { point, predicted, changes, foreseen } = predict(bodies, from, target, control);
    let guess = bodies.converted(point, mirrored);
    let kept = from.kept.as_ref().map(|kept| &kept.place);
    let (result, mut spent) = settle(bodies, guess, target, limit, control, kept.zip(foreseen));
    let mut state = match result {
        Ok(state) => state,
        Err(reason) => return (Err(reason), spent),
    };
    if let (Some(new), Some(old)) = (&mut state.kept, kept)
        && new.place == *old
        && state.point.mirrored == predicted.mirrored
    {
        let before = from.kept.as_ref().and_then(|kept| kept.miss.as_ref());
        new.miss = Some(Miss::new(before, changes, &state.point, &predicted));
    }
    // Boundary friction pulls the two bodies apart sideways; without it they are mirror images again.
    match (state.point.mirrored, bodies.drags(&state.point)) {
        (true, true) => {
            let guess = bodies.converted(state.point, false);
            let (result, more) = settle(bodies, guess, target, limit, control, None);
            spent += more;
            (result, spent)
        }
        (false, false) if bodies.may_mirror(target) => {
            let mut kept = state.kept;
            if let Some(kept) = &mut kept {
                kept.place.point = bodies.converted(kept.place.point.clone(), true);
                kept.miss = None;
            }
            (Ok(Steady { point: bodies.converted(state.point, true), kept, before: None }), spent)
        }
        _ => (Ok(state), spent),
    }
}

/// Newton's method from a guess to a steady state.
fn settle(
    bodies: &mut Bodies,
    guess: Point,
    target: &Inputs,
    limit: usize,
    control: Control,
    kept: Option<(&Place, Foreseen)>,
) -> (Result<Steady, String>, usize) {
    let tolerance = bodies.parameters.tolerance;
    let settings =
        newton::Settings { tolerance, maximum_iterations: limit, patience: PATIENCE, deadline: bodies.deadline };
    let task = Task { inputs: target, rates: None, control, settings, kept };
    let (result, spent) = bodies.settle(guess, &task);
    let kept = bodies.place().map(|place| Box::new(Kept { place: place.clone(), miss: None }));
    (result.map(|point| Steady { point, kept, before: None }), spent)
}

/// Steady state as the end of a motion in time: squeeze and drainage damp what Newton's method alone would overshoot. The
/// bones approach bit by bit; the steps of backward Euler grow as they succeed, until time plays no part.
fn relax(bodies: &mut Bodies, from: &Point, target: &Inputs) -> (Result<Steady, String>, usize) {
    let mirrored = from.mirrored && bodies.may_mirror(target);
    let mut state = bodies.converted(from.clone(), mirrored);
    // On the mesh of the target all the way.
    let contact = bodies.contact_half_width(target, Control::Depth);
    if contact != state.contact_half_width {
        let system = bodies.system(mirrored);
        let ratio = system.carry(&mut state.unknowns, state.contact_half_width, contact);
        let depth = ratio * state.inputs.penetration_depth;
        system.compress(&mut state.unknowns, from.inputs.penetration_depth - depth);
        state.contact_half_width = contact;
    }
    let mut before = bodies.system_of(&state).contents(&state.unknowns, &state.inputs);
    let approach = (target.penetration_depth - from.inputs.penetration_depth).abs();
    let thickness = bodies.parameters.upper.thickness.min(bodies.parameters.lower.thickness);
    let stride = |step: f64| RELAXING_APPROACH * thickness / approach * (step / 1e-3).min(1.0);
    let settings = newton::Settings {
        tolerance: 1e-2,
        maximum_iterations: RELAXING_ITERATIONS,
        patience: 0.0,
        deadline: bodies.deadline,
    };
    let (mut step, mut done, mut patience, mut quick, mut spent) = (1e-5, 0.0, 0, 0, 0);
    while quick < 3 {
        let next = f64::min(done + stride(step), 1.0);
        let inputs = between(&from.inputs, target, next);
        let rates = Rates::backward_euler(step, &before);
        let mut guess = state.clone();
        let approach = inputs.penetration_depth - state.inputs.penetration_depth;
        bodies.system(mirrored).compress(&mut guess.unknowns, approach);
        let rates = Some(&rates);
        let task = Task { inputs: &inputs, rates, control: Control::Depth, settings, kept: None };
        let (result, iterations) = bodies.settle(guess, &task);
        spent += iterations;
        match result {
            Ok(solved) => {
                state = solved;
                before = bodies.system_of(&state).contents(&state.unknowns, &inputs);
                patience -= 1;
                if patience < 0 {
                    step *= if iterations < 5 { 2.0 } else { 1.2 };
                }
                quick = if done == 1.0 && iterations < 2 { quick + 1 } else { 0 };
                done = next;
            }
            Err(reason) if step < 1e-10 || spent > LONGEST_RELAXATION => return (Err(reason), spent),
            Err(_) => {
                step /= 3.0;
                patience = 3;
            }
        }
    }
    let (result, iterations) = settle(bodies, state, target, COLD_ITERATIONS, Control::Depth, None);
    (result, spent + iterations)
}

/// The state at the target inputs on the mesh of another contact: each node keeps what it has in proportion to the contact, and what
/// that missed in the last step is added in the proportion of the steps.
fn carry(bodies: &mut Bodies, from: &Steady, target: &Inputs, contact: f64, control: Control) -> Point {
    let now = &from.point;
    let mut point = Point { contact_half_width: contact, ..now.clone() };
    let system = bodies.system(now.mirrored);
    let ratio = system.carry(&mut point.unknowns, now.contact_half_width, contact);
    point.inputs.penetration_depth *= ratio;
    let before = from.before.as_ref().filter(|before| before.mirrored == now.mirrored).and_then(|before| {
        let way = changes(&before.inputs, &now.inputs, control);
        proportion(changes(&now.inputs, target, control), way)?;
        let share = (contact / now.contact_half_width).ln() / (now.contact_half_width / before.contact_half_width).ln();
        (0.0..=3.0).contains(&share).then_some((before, share))
    });
    if let Some((before, share)) = before {
        let mut carried = before.unknowns.clone();
        let last = system.carry(&mut carried, before.contact_half_width, now.contact_half_width);
        let kept = point.unknowns.clone();
        for ((guess, now), carried) in point.unknowns.iter_mut().zip(&now.unknowns).zip(&carried) {
            *guess += share * ratio * (now - carried);
        }
        system.keep_films(&mut point.unknowns, &kept);
        point.inputs.penetration_depth +=
            share * ratio * (now.inputs.penetration_depth - last * before.inputs.penetration_depth);
    }
    if control == Control::Depth {
        system.compress(&mut point.unknowns, target.penetration_depth - point.inputs.penetration_depth);
    }
    point
}

/// The state at the target inputs on the tangent, and beyond that by what the tangent missed in the last step.
fn predict(bodies: &mut Bodies, from: &Steady, target: &Inputs, control: Control) -> Guess {
    let mut point = from.point.clone();
    let changes = changes(&point.inputs, target, control);
    let kept = from.kept.as_ref();
    let update = kept.and_then(|kept| along(bodies, &point, &kept.place, target, control).ok());
    let system = bodies.system(point.mirrored);
    let Some((update, approach)) = update else {
        system.compress(&mut point.unknowns, target.penetration_depth - point.inputs.penetration_depth);
        return Guess { predicted: point.clone(), point, changes, foreseen: None };
    };
    point.inputs.penetration_depth += approach;
    let mut foreseen = Foreseen { step: system.relative_size(&point.unknowns, &update), corrected: 0.0 };
    system.apply(&mut point.unknowns, &update, &point.active);
    let predicted = point.clone();
    if let Some((miss, share)) = kept.and_then(|kept| kept.miss.as_ref()).and_then(|m| Some((m, m.share(changes)?))) {
        let mut correction: Vec<f64> = miss.next.iter().map(|missed| -share * missed).collect();
        let approach = -correction.pop().unwrap_or_default();
        foreseen.corrected = system.relative_size(&point.unknowns, &correction);
        system.apply(&mut point.unknowns, &correction, &point.active);
        if control == Control::Load {
            point.inputs.penetration_depth += approach;
        }
    }
    Guess { point, predicted, changes, foreseen: Some(foreseen) }
}

/// What to subtract from the unknowns for these changes of depth, speed and slide-to-roll ratio, by a tangent formed nearby; and the
/// change of the depth, which under a load follows from that.
fn along(
    bodies: &mut Bodies,
    point: &Point,
    place: &Place,
    target: &Inputs,
    control: Control,
) -> Result<(Vec<f64>, f64), Singular> {
    if place.point.mirrored != point.mirrored {
        return Err(Singular);
    }
    bodies.form(place)?;
    let mut changes = changes(&point.inputs, target, Control::Depth);
    if point.mirrored {
        // A mirrored pair does not change with the slide-to-roll ratio.
        changes[2] = 0.0;
    }
    if control == Control::Load {
        let mut wanted = target.applied_load - load(bodies, point);
        for input in (1..3).filter(|input| changes[*input] != 0.0) {
            wanted -= bodies.slope(input)?.load * changes[input];
        }
        let most = LONGEST_APPROACH * bodies.system(point.mirrored).thickness();
        let stiffness = bodies.slope(0)?.load;
        changes[0] = if stiffness > 0.0 { (wanted / stiffness).clamp(-most, most) } else { 0.0 };
    }
    let mut update = vec![0.0; point.unknowns.len()];
    for (input, change) in changes.into_iter().enumerate().filter(|(_, change)| *change != 0.0) {
        update.iter_mut().zip(&bodies.slope(input)?.unknowns).for_each(|(u, s)| *u -= s * change);
    }
    Ok((update, changes[0]))
}

/// Depths of contacts grow by the same factor in equal fractions of the way, counted from this much clearance [m].
const CLEARANCE: f64 = 20e-6;

/// The inputs at a fraction of a way along which the contact grows or shrinks evenly.
fn along_contact(from: &Inputs, to: &Inputs, fraction: f64) -> Inputs {
    let depths = [from, to].map(|inputs| inputs.penetration_depth + CLEARANCE);
    let mut inputs = between(from, to, fraction);
    if fraction < 1.0 && depths.iter().all(|depth| *depth > 0.0) {
        inputs.penetration_depth = depths[0] * (depths[1] / depths[0]).powf(fraction) - CLEARANCE;
    }
    inputs
}

/// The first step to try on that way: the depth by a third.
fn first_step(from: &Inputs, to: &Inputs) -> f64 {
    let depths = [from, to].map(|inputs| (inputs.penetration_depth + CLEARANCE).max(0.1 * CLEARANCE));
    (0.3 / (depths[1] / depths[0]).ln().abs()).min(1.0)
}

/// The inputs at a fraction of a way along which the load grows or shrinks by the same factor in equal fractions.
fn along_load(from: &Inputs, to: &Inputs, fraction: f64) -> Inputs {
    let mut inputs = between(from, to, fraction);
    if fraction < 1.0 && from.applied_load > 0.0 && to.applied_load > 0.0 {
        inputs.applied_load = from.applied_load * (to.applied_load / from.applied_load).powf(fraction);
    }
    inputs
}

/// The first step to try on that way: the load by two thirds.
fn first_load_step(from: &Inputs, to: &Inputs) -> f64 {
    (0.5 / (to.applied_load / from.applied_load).ln().abs()).clamp(1e-3, 1.0)
}

/// The inputs at a fraction of the way.
fn between(from: &Inputs, to: &Inputs, fraction: f64) -> Inputs {
    if fraction == 1.0 {
        return *to;
    }
    from.combined(to, |a, b| a + fraction * (b - a))
}
