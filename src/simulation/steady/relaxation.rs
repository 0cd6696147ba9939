//! A steady state as the end of a motion in time: squeeze and drainage damp what Newton's method alone would overshoot.

use super::path::Target;
use super::step::carry;
use super::{Stuck, Way};
use crate::equations::system::{Rates, StoredVolumes};
use crate::parameters::Control;
use crate::simulation::bodies::{State, Task};
use crate::solver::newton;
use crate::solver::pseudo_transient::{self, Lengths, Motion};

/// Most Newton iterations of one step in time on the way to a steady state.
const ITERATIONS: usize = 10;
/// Lengths of these steps.
const LENGTHS: Lengths = Lengths { first: 2e-4, steady: 3e-4, longest: 1e6 };
/// How much of the way is gone in the first of them.
const PORTION: f64 = 0.1;
/// Up to this change of its logarithm a load may change at once.
const FAR: f64 = 0.5;

/// A motion in time by backward Euler, while the bones approach and the fluid becomes what it is.
struct Relaxation<'a, 'b> {
    way: &'a mut Way<'b>,
    start: Target,
    to: &'a Target,
    settings: newton::Settings,
    state: State,
    stored_volumes: StoredVolumes,
}

impl Motion for Relaxation<'_, '_> {
    type Reason = String;

    fn advance(&mut self, step: f64, fraction: f64) -> (Result<(), String>, usize) {
        let Self { way: Way { bodies, .. }, state, .. } = self;
        let given = self.start.between(self.to, fraction, false);
        let rates = Some(Rates::backward_euler(step, &self.stored_volumes));
        let guess = state.clone().guess_for(&given.inputs, given.control);
        let mut guess = State { rates, thickening: given.thickening, ..guess };
        if given.control == Control::Depth {
            let approach = given.inputs.penetration_depth - state.inputs.penetration_depth;
            bodies.system(state.mirrored).compress(&mut guess.unknowns, approach);
        }
        let task = Task { control: given.control, settings: self.settings, distance_counts: false, reusable: None };
        let (result, iterations) = bodies.settle(guess, &task);
        let moved = result.map(|solved| {
            self.state = bodies.paired_anew(&solved, 1.0).unwrap_or(solved);
            self.stored_volumes = bodies.system_of(&self.state).stored_volumes(&self.state);
        });
        (moved, iterations)
    }

    fn settle(&mut self) -> (Result<(), String>, usize) {
        let before = self.way.iterations;
        let result = self.way.settle(self.state.clone(), self.to, None);
        (result.map(|state| drop(self.way.accept(state))), self.way.iterations - before)
    }
}

impl Way<'_> {
    /// Goes to the steady state at the target as the end of a motion.
    pub(super) fn relax(&mut self, to: &Target) -> Result<(), Stuck> {
        let Self { bodies, state, iterations, .. } = self;
        let (control, before) = (to.control, *iterations);
        let mut start = Target::of(state, control);
        if control == Control::Load {
            // What is carried by now, which may have been found at a given depth.
            start.inputs.applied_load = bodies.system_of(state).load(state);
        }
        let mirrored = state.mirrored && bodies.may_mirror(&to.inputs);
        let mut state = bodies.converted(state.clone(), mirrored);
        // On the mesh of the target all the way.
        let contact = bodies.contact_half_width(&to.inputs, control);
        if contact != state.contact_half_width {
            state = carry(bodies, &state, &start, contact);
        }
        let there = start.thickening == to.thickening
            && match control {
                Control::Load => (start.inputs.applied_load / to.inputs.applied_load).ln().abs() < FAR,
                Control::Depth => start.inputs.penetration_depth == to.inputs.penetration_depth,
            };
        let settings = newton::Settings {
            tolerance: 1e-2,
            maximum_iterations: ITERATIONS,
            patience: 0.0,
            most_large: ITERATIONS,
            deadline: bodies.deadline,
        };
        let stored_volumes = bodies.system_of(&state).stored_volumes(&state);
        let mut motion = Relaxation { way: self, start, to, settings, state, stored_volumes };
        let (result, spent) = pseudo_transient::relax(&mut motion, &LENGTHS, if there { 1.0 } else { PORTION });
        self.iterations = before + spent;
        result.map_err(|reason| self.stuck(0.0, reason))
    }
}
