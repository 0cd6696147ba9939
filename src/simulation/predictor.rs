//! Guesses of a steady state from one nearby: by its tangent, or on the mesh of another contact.

use serde::{Deserialize, Serialize};

use super::bodies::{Bodies, PredictorEstimate, State};
use crate::equations::load::LARGEST_APPROACH;
use crate::equations::system::System;
use crate::parameters::{Control, Inputs};
use crate::solver::linear::Singular;
use crate::solver::predictor::PredictorError;

/// Changes of what is given: depth or load, speed, slide-to-roll ratio, and the logarithm of the film's viscosity.
pub(super) type Changes = [f64; 4];

pub(super) fn changes(from: &Target, to: &Target, control: Control) -> Changes {
    let [before, after] = [from.inputs, to.inputs];
    let first = match control {
        Control::Depth => after.penetration_depth - before.penetration_depth,
        Control::Load => after.applied_load - before.applied_load,
    };
    let speed = after.sliding_speed - before.sliding_speed;
    let ratio = after.slide_to_roll_ratio - before.slide_to_roll_ratio;
    [first, speed, ratio, (to.thickening / from.thickening).ln()]
}

/// What a state is the solution for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Target {
    pub inputs: Inputs,
    /// See [`State::thickening`].
    pub thickening: f64,
}

impl State {
    pub(super) fn target(&self) -> Target {
        Target { inputs: self.inputs, thickening: self.thickening }
    }
}

/// A tangent that may serve once more.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct ReusableTangent {
    /// Where it was formed.
    pub linearization: State,
    /// By how much the last steady state that was predicted with it was off, unknowns and then the depth.
    pub predictor_error: Option<PredictorError>,
    /// What the first update with it left the last time, see [`crate::solver::newton::Solution::remainder`]; of use in time.
    pub remainder: Option<f64>,
}

impl ReusableTangent {
    /// The last one of the equations of one body (`mirrored`) or of two.
    pub fn last(bodies: &Bodies, mirrored: bool) -> Option<Self> {
        let system = bodies.made(mirrored)?;
        let linearization = system.linearization()?.clone();
        Some(Self { linearization, predictor_error: None, remainder: system.remainder() })
    }

    /// Whether it is of these equations.
    pub fn fits(&self, system: &System) -> bool {
        let error = self.predictor_error.as_ref();
        system.admits(&self.linearization) && error.is_none_or(|error| error.fits(system.unknowns() + 1))
    }
}

/// The unknowns, and then the depth.
pub(super) fn unknowns_and_depth(state: &State) -> Vec<f64> {
    [&state.unknowns[..], &[state.inputs.penetration_depth]].concat()
}

/// A steady state, and the tangent that led to it: near enough to predict states nearby and to solve for them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Steady {
    pub state: State,
    pub reusable: Option<Box<ReusableTangent>>,
}

/// A guess of a state, from what it was predicted, and how far it may be trusted.
pub(super) struct Prediction {
    pub guess: State,
    /// By the tangent alone.
    pub by_tangent: State,
    pub changes: Changes,
    pub estimate: Option<PredictorEstimate>,
}

/// The state at the target inputs on the mesh of another contact: each node keeps what it has in proportion to the contact.
pub(super) fn carry(bodies: &mut Bodies, now: &State, target: &Target, contact: f64, control: Control) -> State {
    let mut guess = State { contact_half_width: contact, thickening: target.thickening, ..now.clone() };
    let system = bodies.system_of(now);
    let ratio = system.carry(&mut guess.unknowns, contact, &now.shifts);
    guess.inputs.penetration_depth *= ratio;
    if control == Control::Depth {
        system.compress(&mut guess.unknowns, target.inputs.penetration_depth - guess.inputs.penetration_depth);
    }
    guess
}

/// The state at the target inputs on the tangent, corrected by the predictor error of the last step.
pub(super) fn predict(bodies: &mut Bodies, from: &Steady, target: &Target, control: Control) -> Prediction {
    let mut guess = from.state.clone();
    let changes = changes(&guess.target(), target, control);
    let reusable = from.reusable.as_ref();
    let update = reusable.and_then(|reusable| along(bodies, &guess, &reusable.linearization, target, control).ok());
    let system = bodies.system(guess.mirrored);
    let Some((update, approach)) = update else {
        system.compress(&mut guess.unknowns, target.inputs.penetration_depth - guess.inputs.penetration_depth);
        return Prediction { by_tangent: guess.clone(), guess, changes, estimate: None };
    };
    guess.inputs.penetration_depth += approach;
    let mut estimate =
        PredictorEstimate { step: system.relative_size(&guess.unknowns, &update), ..PredictorEstimate::default() };
    system.apply(&mut guess.unknowns, &update, &guess.active);
    let by_tangent = guess.clone();
    let error = reusable.and_then(|reusable| reusable.predictor_error.as_ref());
    if let Some(mut correction) = error.and_then(|error| error.update(&changes)) {
        let approach = -correction.pop().unwrap_or_default();
        estimate.corrected = system.relative_size(&guess.unknowns, &correction);
        system.apply(&mut guess.unknowns, &correction, &guess.active);
        if control == Control::Load {
            guess.inputs.penetration_depth += approach;
        }
    }
    Prediction { guess, by_tangent, changes, estimate: Some(estimate) }
}

/// What to subtract from the unknowns for these changes of depth, speed and slide-to-roll ratio, by a tangent formed nearby; and the
/// change of the depth, which under a load follows from that.
fn along(
    bodies: &mut Bodies,
    state: &State,
    linearization: &State,
    target: &Target,
    control: Control,
) -> Result<(Vec<f64>, f64), Singular> {
    if linearization.mirrored != state.mirrored {
        return Err(Singular);
    }
    bodies.form(linearization)?;
    let mirrored = state.mirrored;
    let mut changes = changes(&state.target(), target, Control::Depth);
    if mirrored {
        // A mirrored pair does not change with the slide-to-roll ratio.
        changes[2] = 0.0;
    }
    if control == Control::Load {
        let mut wanted = target.inputs.applied_load - bodies.system_of(state).load(state);
        for input in (1..3).filter(|input| changes[*input] != 0.0) {
            wanted -= bodies.system(mirrored).slope(input)?.load * changes[input];
        }
        let most = LARGEST_APPROACH * bodies.system(mirrored).thickness();
        let stiffness = bodies.system(mirrored).slope(0)?.load;
        changes[0] = if stiffness > 0.0 { (wanted / stiffness).clamp(-most, most) } else { 0.0 };
    }
    let mut update = vec![0.0; state.unknowns.len()];
    for (input, change) in changes.into_iter().take(3).enumerate().filter(|(_, change)| *change != 0.0) {
        update.iter_mut().zip(&bodies.system(mirrored).slope(input)?.unknowns).for_each(|(u, s)| *u -= s * change);
    }
    Ok((update, changes[0]))
}
