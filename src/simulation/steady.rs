//! The way to a steady state: steps of what is given, and where they fail, motion in time that comes to rest.

mod relaxation;

use self::relaxation::relax;
use super::bodies::{Bodies, PredictorEstimate, State, Task};
use super::predictor::{Prediction, ReusableTangent, Steady, Target, carry, predict, unknowns_and_depth};
use crate::equations::grid;
use crate::equations::system::Solved;
use crate::error::Error;
use crate::parameters::{Control, Formulation, Inputs, Parameters};
use crate::solver::predictor::PredictorError;
use crate::solver::{continuation, newton};

/// A tangent is reused for as many Newton iterations as cost about as much as its factorisation, see [`newton::Settings::patience`].
pub(super) const PATIENCE: f64 = 4.0;
/// How often surface nodes are paired anew in a steady state at most, see [`Bodies::paired_anew`].
const PAIRINGS: usize = 10;
/// And by what part of the way at least, where all of it at once is too far.
const SMALLEST_PART: f64 = 0.2;
/// Most Newton iterations of a step.
const ITERATIONS: usize = 25;
/// Most of them with an update larger than the unknowns, where the edges of the contact move with the mesh.
const LARGE_UPDATES: usize = 4;

/// How many times its own viscosity the fluid has at most, in film and pores, on the way to a state from rest: so thick that no fluid to speak
/// of comes out of the tissue where it enters the contact. A thin film cannot carry that off (of a flux Q = U h/2 - h^3 p'/(12 eta) there
/// is a most), it piles up in a jump, and the jump moves through the mesh as the load grows.
const THICKENING: f64 = 1000.0;
/// But not so thick that the film is thicker than about this fraction of the depth: between surfaces that all but conform it would be, and would
/// hold them together beyond the contact.
const THICKEST_FILM: f64 = 0.2;
/// From what depth such a way starts at once, or from a half or a quarter of it, and with a film of what thickness, as fractions of a layer's
/// thickness.
const AFLOAT: (f64, f64) = (0.1, 0.02);

/// Fractions of the depth and of the load from which a state is reached that is not from rest.
const LESS: (f64, f64) = (0.75, 0.5);

/// Fibres make tissue far stiffer than the theory that says what depth goes with a load. From this load on it is followed up \[N/m\].
const FIRST_LOAD: f64 = 50.0;

/// Slower motion is followed down from this speed: the slower tissue passes the contact, the more of its fluid it gives off \[m/s\].
const FIRST_SPEED: f64 = 0.03;

/// Least load for which there is a steady film worth the name \[N/m\].
const LEAST_LOAD: f64 = 1e-6;

/// The steady state for these inputs, from a state that may be near, or from rest; adds to the count of iterations.
pub(super) fn solve(
    bodies: &mut Bodies,
    from: Option<Steady>,
    inputs: &Inputs,
    iterations: &mut usize,
) -> Result<Steady, Error> {
    let control = bodies.parameters.control;
    if control == Control::Load && inputs.applied_load < LEAST_LOAD {
        let allowed = format!("{LEAST_LOAD:e} N/m or more: with less the surfaces part, and there is no steady state");
        return Err(Error::value("applied_load", inputs.applied_load, allowed));
    }
    let target = Target { inputs: *inputs, thickening: 1.0 };
    // Tissue that turns round comes to rest on its way, and there it drains: such states are further from each other than from rest.
    let ways = |inputs: &Inputs| inputs.surface_speeds().map(|speed| if speed == 0.0 { 0.0 } else { speed.signum() });
    let near = |from: &Steady| !grid::moves(&bodies.parameters) || ways(&from.state.inputs) == ways(inputs);
    let result = match from {
        None => from_rest(bodies, inputs, iterations),
        Some(from) if near(&from) => match follow(bodies, &from, target, control, iterations) {
            Err(stuck) if stuck.reason != UNRESOLVED => from_rest(bodies, inputs, iterations),
            result => result,
        },
        Some(from) => {
            from_rest(bodies, inputs, iterations).or_else(|_| follow(bodies, &from, target, control, iterations))
        }
    };
    result.map_err(|stuck| Error::NotConverged {
        requested: inputs.described(control),
        reached: stuck.reached.state.inputs.to_string(),
        fraction: stuck.fraction,
        reason: stuck.reason,
    })
}

/// Where a way ended early.
struct Stuck {
    reached: Steady,
    fraction: f64,
    reason: String,
}

/// From rest: at once, or where that fails and the mesh goes with the contact, from less depth or load.
fn from_rest(bodies: &mut Bodies, inputs: &Inputs, iterations: &mut usize) -> Result<Steady, Box<Stuck>> {
    let control = bodies.parameters.control;
    let less = match control {
        Control::Depth => Inputs { penetration_depth: LESS.0 * inputs.penetration_depth, ..*inputs },
        Control::Load => Inputs { applied_load: LESS.1 * inputs.applied_load, ..*inputs },
    };
    let depth = grid::Expected::new(&bodies.parameters, &less, control).depth;
    let deep = grid::moves(&bodies.parameters) && depth > AFLOAT.0 * bodies.system(bodies.equal()).thickness();
    match at_once(bodies, inputs, iterations) {
        Err(stuck) if deep && !bodies.deadline.passed() => match from_rest(bodies, &less, iterations) {
            Ok(near) => follow(bodies, &near, Target { inputs: *inputs, thickening: 1.0 }, control, iterations),
            Err(_) => Err(stuck),
        },
        result => result,
    }
}

/// From rest at once. Where the mesh goes with the contact: afloat on a thick fluid, then pressed on each other, and last the fluid becomes
/// what it is in time. Else the surfaces are set in motion before they touch, and then pressed on each other.
fn at_once(bodies: &mut Bodies, inputs: &Inputs, iterations: &mut usize) -> Result<Steady, Box<Stuck>> {
    let parameters = bodies.parameters;
    let control = parameters.control;
    let fibres = [parameters.upper, parameters.lower].iter().any(|body| body.fibre_modulus > 0.0);
    let mut first = *inputs;
    if control == Control::Load && fibres {
        first.applied_load = inputs.applied_load.min(FIRST_LOAD);
    }
    let speed = inputs.sliding_speed;
    if grid::moves(&parameters) && speed != 0.0 {
        first.sliding_speed = speed.abs().max(FIRST_SPEED).copysign(speed);
    }
    if first != *inputs {
        let first = from_rest(bodies, &first, iterations)?;
        return follow(bodies, &first, Target { inputs: *inputs, thickening: 1.0 }, control, iterations);
    }
    let expected = grid::Expected::new(&parameters, inputs, control);
    let depth = match control {
        Control::Depth => inputs.penetration_depth,
        Control::Load => expected.depth,
    };
    let thickening = if grid::moves(&parameters) { thickening(&parameters, inputs, &expected) } else { 1.0 };
    let rest = State { thickening, ..bodies.rest(inputs) };
    let apart = Inputs { penetration_depth: rest.inputs.penetration_depth, ..*inputs };
    let pressed = Inputs { penetration_depth: depth, ..*inputs };
    let (mut reached, mut ways) = (Steady { state: rest, reusable: None }, vec![apart, pressed]);
    if thickening > 1.0 {
        let thickness = bodies.system(bodies.equal()).thickness();
        // Not from nearby: what was no more than guessed changes by much.
        let settings = newton::Settings { most_large: ITERATIONS, ..settings(bodies) };
        for part in [1.0, 0.5, 0.25] {
            let afloat = Inputs { penetration_depth: part * depth.min(AFLOAT.0 * thickness), ..*inputs };
            let guess = bodies.afloat(&afloat, AFLOAT.1 * thickness, thickening);
            let (result, spent) = bodies
                .settle(guess, &Task { control: Control::Depth, settings, distance_counts: true, reusable: None });
            *iterations += spent;
            if let Ok(state) = result {
                (reached, ways) = (Steady { state, reusable: None }, vec![pressed]);
                break;
            }
        }
    }
    for inputs in ways {
        reached = follow(bodies, &reached, Target { inputs, thickening }, Control::Depth, iterations)?;
    }
    let target = Target { inputs: *inputs, thickening: 1.0 };
    match (control, thickening) {
        (Control::Depth, 1.0) => Ok(reached),
        _ => relaxed(bodies, &reached, &target, control, iterations),
    }
}

/// How many times its own viscosity the fluid has on the way from rest to a contact like this.
fn thickening(parameters: &Parameters, inputs: &Inputs, expected: &grid::Expected) -> f64 {
    let grid::Expected { depth, half_width, load } = *expected;
    // Viscosity times speed times half-width over the mean pressure is about the square of the film's thickness.
    let square = parameters.viscosity * inputs.sliding_speed.abs() * half_width / (load / (2.0 * half_width));
    ((THICKEST_FILM * depth).powi(2) / square).clamp(1.0, THICKENING)
}

fn relaxed(
    bodies: &mut Bodies,
    from: &Steady,
    to: &Target,
    control: Control,
    iterations: &mut usize,
) -> Result<Steady, Box<Stuck>> {
    let (result, spent) = relax(bodies, from, to, control);
    *iterations += spent;
    result.map_err(|reason| Box::new(Stuck { reached: from.clone(), fraction: 0.0, reason }))
}

/// Why no other way is tried, however long it would take.
const UNRESOLVED: &str = "the stress of the tissue is far above every pressure: the mesh does not resolve how the pressure falls in so \
                          tight a tissue, which in the paper's formulation turns elements inside out (formulation = \"consistent\" \
                          has no such limit, a larger permeability is further from it)";
/// Stress over pressure of such a state. On a mesh that is good enough they are of one size.
const UNRESOLVED_STRESS: f64 = 1e3;

/// Whether a state of the paper's equations is one from which no step is worth trying that failed once.
fn unresolved(bodies: &mut Bodies, state: &State) -> bool {
    if bodies.parameters.formulation != Formulation::Paper {
        return false;
    }
    let (outputs, _) = Solved { system: bodies.system_of(state), state }.outputs();
    let fluid = outputs.maximum_fluid_pressure.max(-outputs.minimum_fluid_pressure);
    let largest = fluid.max(outputs.maximum_contact_pressure);
    largest > 0.0 && outputs.maximum_von_mises_stress > UNRESOLVED_STRESS * largest
}

/// Goes from one state to another by steps of what is given, and from where they fail by motion in time.
fn follow(
    bodies: &mut Bodies,
    from: &Steady,
    to: Target,
    control: Control,
    iterations: &mut usize,
) -> Result<Steady, Box<Stuck>> {
    match continue_to(bodies, from, to, control, iterations) {
        Err(stuck) if stuck.reason != UNRESOLVED => relaxed(bodies, &stuck.reached, &to, control, iterations),
        result => result,
    }
}

/// The shortest step before giving up: as a fraction of the way, and where the mesh goes with the contact as one of the first step, since
/// shorter ones take longer than motion in time.
const SHORTEST: [f64; 2] = [1.0 / 1024.0, 0.1];

/// Goes from one state to another by steps of what is given.
fn continue_to(
    bodies: &mut Bodies,
    from: &Steady,
    to: Target,
    control: Control,
    iterations: &mut usize,
) -> Result<Steady, Box<Stuck>> {
    let moves = grid::moves(&bodies.parameters);
    let start = from.state.target();
    let way = |fraction: f64| between(&start, &to, fraction, control, moves);
    let mut reached = from.clone();
    let first = if moves { first_step(&start, &to, control) } else { 1.0 };
    let shortest = if moves { SHORTEST[1] * first } else { SHORTEST[0] };
    let mut lost = false;
    let result = continuation::advance(first, shortest, |fraction| {
        if lost {
            return Err(UNRESOLVED.to_string());
        }
        let (next, spent) = step(bodies, &reached, &way(fraction), control);
        *iterations += spent;
        lost = next.is_err() && unresolved(bodies, &reached.state);
        reached = next?;
        Ok(spent)
    });
    match result {
        Ok(()) => Ok(reached),
        Err(continuation::Stuck { fraction, reason }) => Err(Box::new(Stuck { reached, fraction, reason })),
    }
}

/// One step of the continuation: the state at `target`, or why not; and the Newton iterations spent.
fn step(bodies: &mut Bodies, from: &Steady, target: &Target, control: Control) -> (Result<Steady, String>, usize) {
    let inputs = &target.inputs;
    let mirrored = from.state.mirrored && bodies.may_mirror(inputs);
    let contact = bodies.contact_half_width(inputs, control);
    let reusable = from.reusable.as_ref().map(|reusable| &reusable.linearization);
    if contact != from.state.contact_half_width || target.thickening != from.state.thickening {
        let guess = carry(bodies, &from.state, target, contact, control);
        let guess = bodies.converted(guess, mirrored);
        let reusable = reusable.map(|linearization| (linearization, PredictorEstimate::default()));
        return settle(bodies, guess, inputs, control, reusable);
    }
    let Prediction { guess, by_tangent, changes, estimate } = predict(bodies, from, target, control);
    let guess = bodies.converted(guess, mirrored);
    let (result, mut spent) = settle(bodies, guess, inputs, control, reusable.zip(estimate));
    let mut reached = match result {
        Ok(reached) => reached,
        Err(reason) => return (Err(reason), spent),
    };
    if let (Some(new), Some(old)) = (&mut reached.reusable, reusable)
        && new.linearization == *old
        && reached.state.mirrored == by_tangent.mirrored
    {
        let before = from.reusable.as_ref().and_then(|reusable| reusable.predictor_error.as_ref());
        let [solved, predicted] = [&reached.state, &by_tangent].map(unknowns_and_depth);
        new.predictor_error = Some(PredictorError::new(before, &changes, &solved, &predicted));
    }
    // Boundary friction pulls the two bodies apart sideways; without it they are mirror images again.
    match (reached.state.mirrored, bodies.drags(&reached.state)) {
        (true, true) => {
            let guess = bodies.converted(reached.state, false);
            let (result, more) = settle(bodies, guess, inputs, control, None);
            spent += more;
            (result, spent)
        }
        (false, false) if bodies.may_mirror(inputs) => {
            let reusable = reached.reusable.map(|reusable| {
                let linearization = bodies.converted(reusable.linearization, true);
                Box::new(ReusableTangent { linearization, predictor_error: None, remainder: None })
            });
            (Ok(Steady { state: bodies.converted(reached.state, true), reusable }), spent)
        }
        _ => (Ok(reached), spent),
    }
}

fn settings(bodies: &Bodies) -> newton::Settings {
    newton::Settings {
        tolerance: bodies.parameters.tolerance,
        maximum_iterations: ITERATIONS,
        patience: PATIENCE,
        most_large: if grid::moves(&bodies.parameters) { LARGE_UPDATES } else { ITERATIONS },
        deadline: bodies.deadline,
    }
}

/// Newton's method from a guess to a steady state.
fn settle(
    bodies: &mut Bodies,
    guess: State,
    target: &Inputs,
    control: Control,
    reusable: Option<(&State, PredictorEstimate)>,
) -> (Result<Steady, String>, usize) {
    let mirrored = guess.mirrored;
    let guess = State { rates: None, ..guess.guess_for(target, control) };
    let thickening = guess.thickening;
    let (mut result, mut spent) =
        bodies.settle(guess, &Task { control, settings: settings(bodies), distance_counts: true, reusable });
    let mut part = 1.0;
    for _ in 0..PAIRINGS {
        let Some(guess) = result.as_ref().ok().and_then(|state| bodies.paired_anew(state, part)) else { break };
        // Not from nearby: the edges of the contact move on the surfaces.
        let settings = newton::Settings { most_large: ITERATIONS, ..settings(bodies) };
        let (again, more) = bodies.settle(guess, &Task { control, settings, distance_counts: true, reusable: None });
        spent += more;
        match again {
            Ok(_) => (result, part) = (again, (2.0 * part).min(1.0)),
            Err(_) if part > SMALLEST_PART => part *= 0.5,
            // On the way they may stay apart.
            Err(_) if thickening != 1.0 => break,
            Err(_) => result = again,
        }
    }
    let reusable = ReusableTangent::last(bodies, mirrored).map(Box::new);
    (result.map(|state| Steady { state, reusable }), spent)
}

/// Depths of contacts grow by the same factor in equal fractions of the way, counted from this much clearance \[m\].
const CLEARANCE: f64 = 20e-6;

/// What is given at a fraction of the way: viscosities, loads and, where the mesh goes with the contact, depths and speeds grow by the same
/// factor in equal fractions, the rest evenly.
fn between(from: &Target, to: &Target, fraction: f64, control: Control, moves: bool) -> Target {
    // To the last digit.
    if fraction == 1.0 {
        return *to;
    }
    let mix = |a: f64, b: f64| a + fraction * (b - a);
    let grow = |a: f64, b: f64| if a > 0.0 && b > 0.0 { a * (b / a).powf(fraction) } else { mix(a, b) };
    let mut inputs = from.inputs.combined(&to.inputs, mix);
    if control == Control::Load {
        inputs.applied_load = grow(from.inputs.applied_load, to.inputs.applied_load);
    } else if moves {
        let [a, b] = [from, to].map(|target| target.inputs.penetration_depth + CLEARANCE);
        inputs.penetration_depth = grow(a, b) - CLEARANCE;
    }
    let [a, b] = [from, to].map(|target| target.inputs.sliding_speed);
    if moves && a * b > 0.0 {
        inputs.sliding_speed = grow(a.abs(), b.abs()).copysign(a);
    }
    Target { inputs, thickening: grow(from.thickening, to.thickening) }
}

/// The first step to try on that way, where the mesh goes with the contact.
fn first_step(from: &Target, to: &Target, control: Control) -> f64 {
    let growth = |a: f64, b: f64| (b / a).ln().abs();
    let size = match control {
        Control::Depth => {
            let [a, b] = [from, to].map(|target| (target.inputs.penetration_depth + CLEARANCE).max(0.1 * CLEARANCE));
            growth(a, b) / 0.25
        }
        Control::Load => growth(from.inputs.applied_load, to.inputs.applied_load) / 0.5,
    };
    let [a, b] = [from, to].map(|target| target.inputs.sliding_speed);
    let faster = if a * b > 0.0 { growth(a.abs(), b.abs()) / 1.2 } else { 0.0 };
    (1.0 / size.max(growth(from.thickening, to.thickening)).max(faster)).min(1.0)
}
