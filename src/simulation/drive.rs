//! What the inputs do during a step.

use serde::{Deserialize, Serialize};

use super::Input;
use crate::equations::system::Direction;
use crate::parameters::Inputs;

/// Inputs that change at constant rates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// At the start.
    pub inputs: Inputs,
    /// Per second. A rate of the penetration depth other than zero stands in for the approach speed.
    pub rates: Inputs,
}

impl Drive {
    /// Inputs that stay as they are, but for the depth, which goes with the approach speed.
    pub fn constant(inputs: Inputs) -> Self {
        Self { inputs, rates: Inputs::NONE }
    }

    fn interpolated(&self) -> bool {
        self.rates.penetration_depth != 0.0
    }

    /// Inputs some time after the start.
    pub fn at(&self, time: f64) -> Inputs {
        let mut inputs = self.inputs.combined(&self.rates, |value, rate| value + time * rate);
        if !self.interpolated() {
            inputs.penetration_depth += time * 0.5 * (self.inputs.approach_speed + inputs.approach_speed);
        }
        inputs
    }

    /// Rates of depth, speed and slide-to-roll ratio some time after the start.
    pub fn rates_at(&self, time: f64) -> Direction {
        let approach = if self.interpolated() { self.rates.penetration_depth } else { self.at(time).approach_speed };
        Direction {
            penetration_depth: approach,
            sliding_speed: self.rates.sliding_speed,
            slide_to_roll_ratio: self.rates.slide_to_roll_ratio,
        }
    }

    /// What depth, speed, slide-to-roll ratio and load do some time after the start where one input differs by one unit.
    pub fn change(&self, input: Input, time: f64) -> (Direction, f64) {
        let depth = |change| (Direction { penetration_depth: change, ..Direction::default() }, 0.0);
        match input {
            Input::PenetrationDepth => depth(1.0),
            Input::ApproachSpeed if self.interpolated() => depth(0.0),
            Input::ApproachSpeed => depth(time),
            Input::SlidingSpeed => (Direction::UNIT[1], 0.0),
            Input::SlideToRollRatio => (Direction::UNIT[2], 0.0),
            Input::AppliedLoad => (Direction::default(), 1.0),
        }
    }
}
