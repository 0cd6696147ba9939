//! The way to a steady state: steps of the inputs, and where they fail, motion in time that comes to rest.

use serde::{Deserialize, Serialize};

use super::bodies::{Bodies, LONGEST_APPROACH, Point, Task};
use crate::equations::system::{Direction, Rates};
use crate::error::Error;
use crate::parameters::{Control, Inputs};
use crate::solver::{continuation, newton};

/// A steady state, with its tangent for the next step.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Steady {
    pub point: Point,
    pub tangent: Option<Tangent>,
}

/// How a steady state changes with depth, speed and slide-to-roll ratio; near enough to predict a state nearby.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Tangent {
    unknowns: [Vec<f64>; 3],
    load: [f64; 3],
}

impl Tangent {
    /// Whether it is of equations with so many unknowns.
    pub fn fits(&self, unknowns: usize) -> bool {
        self.unknowns.iter().all(|values| values.is_empty() || values.len() == unknowns)
    }
}

/// Most Newton iterations from a state nearby, which takes three to eight.
const WARM_ITERATIONS: usize = 12;
/// Most Newton iterations from rest, which takes ten to fifteen.
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
    let from = from.unwrap_or_else(|| rest(bodies, inputs));
    let result = travel(bodies, &from, inputs, iterations);
    if result.is_ok() {
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
        let arrived = continuation::advance(|to| {
            let target = between(&from.point.inputs, inputs, to);
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
    let mut state = from.unwrap_or_else(|| rest(bodies, inputs));
    let (mut stride, mut last_side) = (FIRST_STRIDE * thickness, 0.0);
    let mut depth = state.point.inputs.penetration_depth;
    loop {
        state = at_depth(bodies, Some(state), &Inputs { penetration_depth: depth, ..*inputs }, iterations)?;
        let load = load(bodies, &state.point);
        let reason = if load > given / NEAR && load < given * NEAR {
            let (result, spent) = step(bodies, &state, inputs, COLD_ITERATIONS, Control::Load);
            *iterations += spent;
            match result {
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
                reached: format!("{load} N/m at {}", state.point.inputs),
                fraction: 0.0,
                reason,
            });
        }
    }
}

/// Load per unit depth [N/m].
pub(super) fn load(bodies: &mut Bodies, point: &Point) -> f64 {
    bodies.system(point.mirrored).load(&point.unknowns, &point.contact_forces)
}

fn rest(bodies: &mut Bodies, inputs: &Inputs) -> Steady {
    Steady { point: bodies.rest(inputs), tangent: None }
}

/// Goes from one state to others by steps of the inputs, at the end through time.
fn travel(bodies: &mut Bodies, from: &Steady, inputs: &Inputs, iterations: &mut usize) -> Result<Steady, Error> {
    let cold = from.tangent.is_none();
    let limit = if cold { COLD_ITERATIONS } else { WARM_ITERATIONS };
    let mut rest = (!cold).then(|| rest(bodies, inputs));
    let mut state = from.clone();
    let result = continuation::advance(|to| {
        let target = between(&from.point.inputs, inputs, to);
        let (mut next, spent) = step(bodies, &state, &target, limit, Control::Depth);
        *iterations += spent;
        let mut reached = to;
        if let (Err(_), Some(rest)) = (&next, rest.take()) {
            // Surfaces close more readily than they part: from rest even far targets are often reached at once.
            let (whole, spent) = step(bodies, &rest, inputs, COLD_ITERATIONS, Control::Depth);
            *iterations += spent;
            if whole.is_ok() {
                (next, reached) = (whole, 1.0);
            }
        }
        state = next?;
        Ok(reached)
    });
    let Err(continuation::Stuck { fraction, reason }) = result else { return Ok(state) };
    let (relaxed, spent) = relax(bodies, &state.point, inputs);
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
    let guess = predict(bodies, from, target, control);
    let guess = bodies.converted(guess, mirrored);
    let (result, mut spent) = settle(bodies, guess, target, limit, control);
    let state = match result {
        Ok(state) => state,
        Err(reason) => return (Err(reason), spent),
    };
    // Boundary friction pulls the two bodies apart sideways; without it they are mirror images again.
    match (state.point.mirrored, bodies.drags(&state.point)) {
        (true, true) => {
            let guess = bodies.converted(state.point, false);
            let (result, more) = settle(bodies, guess, target, limit, control);
            spent += more;
            (result, spent)
        }
        (false, false) if bodies.may_mirror(target) => {
            let tangent = state.tangent.map(|Tangent { unknowns, load }| {
                let [depth, speed, _] = unknowns;
                let convert = |values: Vec<f64>| bodies.converted_values(&values, true);
                let [depth, speed] = [depth, speed].map(convert);
                Tangent { unknowns: [depth, speed, Vec::new()], load: [load[0], load[1], 0.0] }
            });
            (Ok(Steady { point: bodies.converted(state.point, true), tangent }), spent)
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
) -> (Result<Steady, String>, usize) {
    let settings = newton::Settings { tolerance: bodies.parameters.tolerance, maximum_iterations: limit, reuse: 0.0 };
    let (result, spent) = bodies.settle(guess, &Task { inputs: target, rates: None, control, settings });
    let state = result.and_then(|point| {
        // A mirrored pair does not change with the slide-to-roll ratio.
        let directions = if point.mirrored { &Direction::UNIT[..2] } else { &Direction::UNIT[..] };
        let causes = directions.iter().map(|direction| (*direction, None)).collect();
        let system = bodies.system(point.mirrored);
        let changes = system.respond(point.at(None), causes).map_err(|singular| singular.to_string())?;
        let load = |k: usize| changes.get(k).map_or(0.0, |c| system.load(&c.unknowns, &c.contact_forces));
        let load = [load(0), load(1), load(2)];
        let mut changes = changes.into_iter().map(|change| change.unknowns);
        let unknowns = std::array::from_fn(|_| changes.next().unwrap_or_default());
        Ok(Steady { point, tangent: Some(Tangent { unknowns, load }) })
    });
    (state, spent)
}

/// Steady state as the end of a motion in time: squeeze and drainage damp what Newton's method alone would overshoot. The
/// bones approach bit by bit; the steps of backward Euler grow as they succeed, until time plays no part.
fn relax(bodies: &mut Bodies, from: &Point, target: &Inputs) -> (Result<Steady, String>, usize) {
    let mirrored = from.mirrored && bodies.may_mirror(target);
    let mut state = bodies.converted(from.clone(), mirrored);
    let mut before = bodies.system(mirrored).contents(&state.unknowns, &state.inputs);
    let approach = (target.penetration_depth - from.inputs.penetration_depth).abs();
    let thickness = bodies.parameters.upper.thickness.min(bodies.parameters.lower.thickness);
    let stride = |step: f64| RELAXING_APPROACH * thickness / approach * (step / 1e-3).min(1.0);
    let settings = newton::Settings { tolerance: 1e-2, maximum_iterations: RELAXING_ITERATIONS, reuse: 0.0 };
    let (mut step, mut done, mut patience, mut quick, mut spent) = (1e-5, 0.0, 0, 0, 0);
    while quick < 3 {
        let next = f64::min(done + stride(step), 1.0);
        let inputs = between(&from.inputs, target, next);
        let rates = Rates::backward_euler(step, &before);
        let mut guess = state.clone();
        let approach = inputs.penetration_depth - state.inputs.penetration_depth;
        bodies.system(mirrored).compress(&mut guess.unknowns, approach);
        let task = Task { inputs: &inputs, rates: Some(&rates), control: Control::Depth, settings };
        let (result, iterations) = bodies.settle(guess, &task);
        spent += iterations;
        match result {
            Ok(solved) => {
                state = solved;
                before = bodies.system(mirrored).contents(&state.unknowns, &inputs);
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
    let (result, iterations) = settle(bodies, state, target, COLD_ITERATIONS, Control::Depth);
    (result, spent + iterations)
}

/// The state on the tangent at the target inputs.
fn predict(bodies: &mut Bodies, from: &Steady, target: &Inputs, control: Control) -> Point {
    let mut point = from.point.clone();
    let at = point.inputs;
    let mut changes = [
        target.penetration_depth - at.penetration_depth,
        target.sliding_speed - at.sliding_speed,
        target.slide_to_roll_ratio - at.slide_to_roll_ratio,
    ];
    let system = bodies.system(point.mirrored);
    let Some(tangent) = &from.tangent else {
        system.compress(&mut point.unknowns, changes[0]);
        return point;
    };
    if control == Control::Load {
        let load = system.load(&point.unknowns, &point.contact_forces);
        let [stiffness, by_speed, by_ratio] = tangent.load;
        let most = LONGEST_APPROACH * system.thickness();
        let wanted = target.applied_load - load - by_speed * changes[1] - by_ratio * changes[2];
        changes[0] = if stiffness > 0.0 { (wanted / stiffness).clamp(-most, most) } else { 0.0 };
        point.inputs.penetration_depth += changes[0];
    }
    let mut update = vec![0.0; point.unknowns.len()];
    for (derivative, change) in tangent.unknowns.iter().zip(changes) {
        update.iter_mut().zip(derivative).for_each(|(u, s)| *u -= s * change);
    }
    system.apply(&mut point.unknowns, &update, &point.active);
    point
}

/// The inputs at a fraction of the way.
fn between(from: &Inputs, to: &Inputs, fraction: f64) -> Inputs {
    if fraction == 1.0 {
        return *to;
    }
    from.combined(to, |a, b| a + fraction * (b - a))
}
