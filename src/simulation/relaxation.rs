//! A steady state as the end of a motion in time.

use super::bodies::{Bodies, State, Task};
use super::predictor::{Target, carry};
use super::steady::{Steady, between, settle};
use crate::equations::system::Rates;
use crate::parameters::Control;
use crate::solver::newton;

/// Most Newton iterations of one step in time on the way to a steady state, and of all of them.
const RELAXING_ITERATIONS: usize = 10;
const LONGEST_RELAXATION: usize = 2000;
/// The first of these steps \[s\].
const FIRST_STEP: f64 = 2e-4;
/// After a step of this length time plays no part \[s\].
const LONGEST_STEP: f64 = 1e6;
/// How much of the way is gone in the first of them, and by how much that grows at most.
const PORTION: (f64, f64) = (0.1, 1.5);
/// Up to this change of its logarithm a load may change at once.
const FAR: f64 = 0.5;
/// Only after steps this long is it worth trying whether time plays no part any more \[s\].
const STEADY: f64 = 3e-4;

/// Steady state as the end of a motion in time: squeeze and drainage damp what Newton's method alone would overshoot. Bit by bit the bones
/// approach and the fluid becomes what it is; then the steps of backward Euler grow as they succeed, until time plays no part.
pub(super) fn relax(
    bodies: &mut Bodies,
    from: &Steady,
    to: &Target,
    control: Control,
) -> (Result<Steady, String>, usize) {
    let mut start = from.state.target();
    if control == Control::Load {
        // What is carried by now, which may have been found at a given depth.
        start.inputs.applied_load = bodies.system_of(&from.state).load(&from.state);
    }
    let mirrored = from.state.mirrored && bodies.may_mirror(&to.inputs);
    let mut state = bodies.converted(from.state.clone(), mirrored);
    // On the mesh of the target all the way.
    let contact = bodies.contact_half_width(&to.inputs, control);
    if contact != state.contact_half_width {
        state = carry(bodies, &Steady { state, reusable: None, before: None }, &start, contact, control);
    }
    let mut before = bodies.system_of(&state).stored_volumes(&state);
    let settings = newton::Settings {
        tolerance: 1e-2,
        maximum_iterations: RELAXING_ITERATIONS,
        patience: 0.0,
        most_large: RELAXING_ITERATIONS,
        deadline: bodies.deadline,
    };
    let there = start.thickening == to.thickening
        && match control {
            Control::Load => (start.inputs.applied_load / to.inputs.applied_load).ln().abs() < FAR,
            Control::Depth => start.inputs.penetration_depth == to.inputs.penetration_depth,
        };
    let (mut step, mut done, mut portion) = (FIRST_STEP, 0.0, if there { 1.0 } else { PORTION.0 });
    let (mut patience, mut quick, mut spent) = (0, 0, 0);
    loop {
        if quick >= 3 {
            let (result, iterations) = settle(bodies, state.clone(), &to.inputs, control, None);
            spent += iterations;
            if result.is_ok() || step > LONGEST_STEP {
                return (result, spent);
            }
            quick = 0;
        }
        let next = f64::min(done + portion, 1.0);
        let given = between(&start, to, next, control, false);
        let rates = Some(Rates::backward_euler(step, &before));
        let guess = state.clone().guess_for(&given.inputs, control);
        let mut guess = State { rates, thickening: given.thickening, ..guess };
        if control == Control::Depth {
            let approach = given.inputs.penetration_depth - state.inputs.penetration_depth;
            bodies.system(mirrored).compress(&mut guess.unknowns, approach);
        }
        let (result, iterations) = bodies.settle(guess, &Task { control, settings, reusable: None });
        spent += iterations;
        match result {
            Ok(solved) => {
                state = solved;
                before = bodies.system_of(&state).stored_volumes(&state);
                patience -= 1;
                if next < 1.0 {
                    portion *= (5.0 / iterations as f64).clamp(0.5, PORTION.1);
                } else if patience < 0 {
                    step *= [4.0, 2.5, 1.4][usize::from(iterations > 3) + usize::from(iterations > 5)];
                }
                quick = if next == 1.0 && iterations < 4 && step > STEADY { quick + 1 } else { 0 };
                done = next;
            }
            Err(reason) if step < 1e-10 || spent > LONGEST_RELAXATION => return (Err(reason), spent),
            Err(_) if done < 1.0 => {
                portion /= 2.0;
                step /= 2.0;
            }
            Err(_) => {
                step /= 4.0;
                patience = 1;
            }
        }
    }
}
