//! What is given on the way from one steady state to another.

use crate::parameters::{Control, Inputs};
use crate::simulation::bodies::State;

/// What a state is the solution for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Target {
    /// Which of depth and load is given.
    pub control: Control,
    pub inputs: Inputs,
    /// See [`State::thickening`].
    pub thickening: f64,
}

impl Target {
    /// The inputs, and the fluid as it is.
    pub fn new(control: Control, inputs: &Inputs) -> Self {
        Self { control, inputs: *inputs, thickening: 1.0 }
    }

    /// What a state is the solution for.
    pub fn of(state: &State, control: Control) -> Self {
        Self { control, inputs: state.inputs, thickening: state.thickening }
    }

    /// Changes of what is given up to another target: depth or load, speed, slide-to-roll ratio, and the logarithm of the viscosity.
    pub fn changes(&self, to: &Self) -> [f64; 4] {
        let [before, after] = [self.inputs, to.inputs];
        let first = match to.control {
            Control::Depth => after.penetration_depth - before.penetration_depth,
            Control::Load => after.applied_load - before.applied_load,
        };
        let speed = after.sliding_speed - before.sliding_speed;
        let ratio = after.slide_to_roll_ratio - before.slide_to_roll_ratio;
        [first, speed, ratio, (to.thickening / self.thickening).ln()]
    }

    /// What is given at a fraction of the way to another target: viscosities, loads and, where the mesh goes with the contact, depths and
    /// speeds grow by the same factor in equal fractions, the rest evenly.
    pub fn between(&self, to: &Self, fraction: f64, moves: bool) -> Self {
        // To the last digit.
        if fraction == 1.0 {
            return *to;
        }
        let mix = |a: f64, b: f64| a + fraction * (b - a);
        let grow = |a: f64, b: f64| if a > 0.0 && b > 0.0 { a * (b / a).powf(fraction) } else { mix(a, b) };
        let mut inputs = self.inputs.combined(&to.inputs, mix);
        if to.control == Control::Load {
            inputs.applied_load = grow(self.inputs.applied_load, to.inputs.applied_load);
        } else if moves {
            let [a, b] = [self, to].map(|target| target.inputs.penetration_depth + CLEARANCE);
            inputs.penetration_depth = grow(a, b) - CLEARANCE;
        }
        let [a, b] = [self, to].map(|target| target.inputs.sliding_speed);
        if moves && a * b > 0.0 {
            inputs.sliding_speed = grow(a.abs(), b.abs()).copysign(a);
        }
        Self { inputs, thickening: grow(self.thickening, to.thickening), ..*to }
    }

    /// The first step to try on that way, where the mesh goes with the contact.
    pub fn first_step(&self, to: &Self) -> f64 {
        let growth = |a: f64, b: f64| (b / a).ln().abs();
        let size = match to.control {
            Control::Depth => {
                let [a, b] =
                    [self, to].map(|target| (target.inputs.penetration_depth + CLEARANCE).max(0.1 * CLEARANCE));
                growth(a, b) / 0.25
            }
            Control::Load => growth(self.inputs.applied_load, to.inputs.applied_load) / 0.5,
        };
        let [a, b] = [self, to].map(|target| target.inputs.sliding_speed);
        let faster = if a * b > 0.0 { growth(a.abs(), b.abs()) / 1.2 } else { 0.0 };
        (1.0 / size.max(growth(self.thickening, to.thickening)).max(faster)).min(1.0)
    }
}

/// Depths of contacts grow by the same factor in equal fractions of the way, counted from this much clearance \[m\].
const CLEARANCE: f64 = 20e-6;
