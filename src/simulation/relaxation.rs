//! A steady state as the end of a motion in time.

use super::bodies::{Bodies, State, Task};
use super::predictor::{Target, carry};
use super::steady::{Steady, between, settle};
use crate::equations::system::Rates;
use crate::parameters::Control;
use crate::solver::newton;

/// Most Newton iterations of one step in time on the way to a steady state, and of all of them.
const RELAXING_ITERATIONS: usize = 12;
const LONGEST_RELAXATION: usize = 2000;
/// The first of these steps \[s\].
const FIRST_STEP: f64 = 2e-5;
/// After a step of this length time plays no part \[s\].
const LONGEST_STEP: f64 = 1e6;
/// How far the bones approach in one such step of a millisecond or more, as a fraction of the layers' thickness; in proportion less
/// in shorter ones.
const RELAXING_APPROACH: f64 = 0.02;

/// Steady state as the end of a motion in time: squeeze and drainage damp what Newton's method alone would overshoot. The bones
/// approach bit by bit; the steps of backward Euler grow as they succeed, until time plays no part.
pub(super) fn relax(
    bodies: &mut Bodies,
    from: &Steady,
    to: &Target,
    control: Control,
) -> (Result<Steady, String>, usize) {
    let start = from.state.target();
    let mirrored = from.state.mirrored && bodies.may_mirror(&to.inputs);
    let mut state = bodies.converted(from.state.clone(), mirrored);
    // On the mesh of the target all the way.
    let contact = bodies.contact_half_width(&to.inputs, control);
    if contact != state.contact_half_width {
        state = carry(bodies, &Steady { state, reusable: None, before: None }, &start, contact, control);
    }
    state.thickening = to.thickening;
    let mut before = bodies.system_of(&state).stored_volumes(&state);
    let approach = match control {
        Control::Depth => (to.inputs.penetration_depth - start.inputs.penetration_depth).abs(),
        Control::Load => 0.0,
    };
    let thickness = bodies.parameters.upper.thickness.min(bodies.parameters.lower.thickness);
    let increment = |step: f64| RELAXING_APPROACH * thickness / approach * (step / 1e-3).min(1.0);
    let settings = newton::Settings {
        tolerance: 1e-2,
        maximum_iterations: RELAXING_ITERATIONS,
        patience: 0.0,
        most_large: RELAXING_ITERATIONS,
        deadline: bodies.deadline,
    };
    let (mut step, mut done, mut patience, mut quick, mut spent) = (FIRST_STEP, 0.0, 0, 0, 0);
    loop {
        if quick >= 3 {
            let (result, iterations) = settle(bodies, state.clone(), &to.inputs, control, None);
            spent += iterations;
            if result.is_ok() || step > LONGEST_STEP {
                return (result, spent);
            }
            quick = 0;
        }
        let next = f64::min(done + increment(step), 1.0);
        let given = between(&start, to, next, control, false).inputs;
        let rates = Some(Rates::backward_euler(step, &before));
        let mut guess = State { rates, ..state.clone().guess_for(&given, control) };
        if control == Control::Depth {
            let approach = given.penetration_depth - state.inputs.penetration_depth;
            bodies.system(mirrored).compress(&mut guess.unknowns, approach);
        }
        let (result, iterations) = bodies.settle(guess, &Task { control, settings, reusable: None });
        spent += iterations;
        match result {
            Ok(solved) => {
                state = solved;
                before = bodies.system_of(&state).stored_volumes(&state);
                patience -= 1;
                if patience < 0 {
                    step *= if iterations < 6 { 2.5 } else { 1.4 };
                }
                quick = if done == 1.0 && iterations < 3 { quick + 1 } else { 0 };
                done = next;
            }
            Err(reason) if step < 1e-10 || spent > LONGEST_RELAXATION => return (Err(reason), spent),
            Err(_) => {
                step /= 4.0;
                patience = 1;
            }
        }
    }
}
