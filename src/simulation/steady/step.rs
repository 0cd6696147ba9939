//! One step to a steady state nearby: a guess by the tangent or on the mesh of another contact, and Newton's method from there.

use super::path::Target;
use super::{ITERATIONS, PATIENCE, Way};
use crate::equations::grid;
use crate::parameters::Control;
use crate::simulation::bodies::{Bodies, PredictorEstimate, ReusableTangent, State, Task};
use crate::solver::newton;
use crate::solver::predictor::PredictorError;

/// How often surface nodes are paired anew in a steady state at most, see [`Bodies::paired_anew`].
const PAIRINGS: usize = 10;
/// And by what part of the way at least, where all of it at once is too far.
const SMALLEST_PART: f64 = 0.2;
/// Most Newton iterations with an update larger than the unknowns, where the edges of the contact move with the mesh.
const LARGE_UPDATES: usize = 4;

/// A guess of a state, from what it was predicted, and how far it may be trusted.
struct Prediction {
    guess: State,
    /// By the tangent alone.
    by_tangent: State,
    changes: [f64; 4],
    estimate: Option<PredictorEstimate>,
}

/// A guess of the state at the target, on the mesh of the contact there.
pub(super) fn carry(bodies: &mut Bodies, now: &State, target: &Target, contact: f64) -> State {
    let carried = bodies.carried(now, contact, now.shifts.clone());
    let mut guess = State { thickening: target.thickening, ..carried };
    if target.control == Control::Depth {
        let approach = target.inputs.penetration_depth - guess.inputs.penetration_depth;
        bodies.system(guess.mirrored).compress(&mut guess.unknowns, approach);
    }
    guess
}

impl Way<'_> {
    /// Goes to the target at once, or says why not.
    pub(super) fn step(&mut self, target: &Target) -> Result<(), String> {
        let may_mirror = self.bodies.may_mirror(&target.inputs);
        let mirrored = self.state.mirrored && may_mirror;
        let contact = self.bodies.contact_half_width(&target.inputs, target.control);
        if contact != self.state.contact_half_width || target.thickening != self.state.thickening {
            let guess = carry(self.bodies, &self.state, target, contact);
            let guess = self.bodies.converted(guess, mirrored);
            let state = self.settle(guess, target, Some(PredictorEstimate::default()))?;
            self.accept(state);
            return Ok(());
        }
        let Prediction { guess, by_tangent, changes, estimate } = self.predict(target);
        let guess = self.bodies.converted(guess, mirrored);
        let state = self.settle(guess, target, estimate)?;
        // Boundary friction pulls the two bodies apart sideways; without it they are mirror images again.
        let drags = self.bodies.drags(&state);
        if state.mirrored && drags {
            let guess = self.bodies.converted(state, false);
            let state = self.settle(guess, target, None)?;
            self.accept(state);
            return Ok(());
        }
        let before = self.accept(state);
        if !self.state.mirrored && !drags && may_mirror {
            self.state = self.bodies.converted(self.state.clone(), true);
            self.reusable = self.reusable.take().map(|reusable| {
                let linearization = self.bodies.converted(reusable.linearization, true);
                Box::new(ReusableTangent { linearization, predictor_error: None, remainder: None })
            });
        } else if let (Some(now), Some(before)) = (&mut self.reusable, before)
            && now.linearization == before.linearization
            && self.state.mirrored == by_tangent.mirrored
        {
            let [solved, predicted] = [&self.state, &by_tangent].map(State::unknowns_and_depth);
            let error = PredictorError::new(before.predictor_error.as_ref(), &changes, &solved, &predicted);
            now.predictor_error = Some(error);
        }
        Ok(())
    }

    /// The state at the target on the tangent, corrected by the predictor error of the last step.
    fn predict(&mut self, target: &Target) -> Prediction {
        let mut guess = self.state.clone();
        let now = Target::of(&guess, target.control);
        let changes = now.changes(target);
        let approach = target.inputs.penetration_depth - now.inputs.penetration_depth;
        let load = (target.control == Control::Load).then_some(target.inputs.applied_load);
        let reusable = self.reusable.as_ref();
        let system = self.bodies.system(guess.mirrored);
        let update = reusable.and_then(|reusable| {
            let changes = [approach, changes[1], changes[2]];
            system.predict(&guess, &reusable.linearization, changes, load).ok()
        });
        let Some((update, approach)) = update else {
            system.compress(&mut guess.unknowns, approach);
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
            if load.is_some() {
                guess.inputs.penetration_depth += approach;
            }
        }
        Prediction { guess, by_tangent, changes, estimate: Some(estimate) }
    }

    /// Newton's method from a guess to a steady state, with the reusable tangent where it was estimated what that is good for.
    pub(super) fn settle(
        &mut self,
        guess: State,
        target: &Target,
        estimate: Option<PredictorEstimate>,
    ) -> Result<State, String> {
        let Self { bodies, iterations, .. } = self;
        let mut settle = |bodies: &mut Bodies, guess, settings, reusable| {
            let task = Task { control: target.control, settings, distance_counts: true, reusable };
            let (result, spent) = bodies.settle(guess, &task);
            *iterations += spent;
            result
        };
        let guess = State { rates: None, ..guess.guess_for(&target.inputs, target.control) };
        let thickening = guess.thickening;
        let reusable = self.reusable.as_ref().map(|reusable| &reusable.linearization).zip(estimate);
        let most_large = if grid::moves(&bodies.parameters) { LARGE_UPDATES } else { ITERATIONS };
        let mut result = settle(bodies, guess, newton::Settings { most_large, ..settings(bodies) }, reusable);
        let mut part = 1.0;
        for _ in 0..PAIRINGS {
            let Some(guess) = result.as_ref().ok().and_then(|state| bodies.paired_anew(state, part)) else { break };
            // Not from nearby: the edges of the contact move on the surfaces.
            let again = settle(bodies, guess, settings(bodies), None);
            match again {
                Ok(_) => (result, part) = (again, (2.0 * part).min(1.0)),
                Err(_) if part > SMALLEST_PART => part *= 0.5,
                // On the way they may stay apart.
                Err(_) if thickening != 1.0 => break,
                Err(_) => result = again,
            }
        }
        result
    }

    /// Makes the state that was solved last the one that is reached; returns the reusable tangent before.
    pub(super) fn accept(&mut self, state: State) -> Option<Box<ReusableTangent>> {
        let reusable = self.bodies.system(state.mirrored).reusable_tangent().map(Box::new);
        self.state = state;
        std::mem::replace(&mut self.reusable, reusable)
    }
}

/// Of Newton's method from a guess that is not nearby.
pub(super) fn settings(bodies: &Bodies) -> newton::Settings {
    newton::Settings {
        tolerance: bodies.parameters.tolerance,
        maximum_iterations: ITERATIONS,
        patience: PATIENCE,
        most_large: ITERATIONS,
        deadline: bodies.deadline,
    }
}
