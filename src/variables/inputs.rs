//! The inputs: what the bones are made to do.

use crate::parameters::Inputs;
use crate::simulation::Input;
use crate::units::Unit;

/// An input: the sign conventions are in its description.
pub struct InputRow {
    pub(super) name: &'static str,
    pub(super) reference: u32,
    pub(super) unit: Unit,
    pub(super) nominal: f64,
    pub(super) description: &'static str,
    /// Which one.
    pub input: Input,
    /// Smallest allowed value. Zero is allowed for every input: some importers write it to what is not connected.
    pub minimum: f64,
    /// Largest allowed value.
    pub maximum: f64,
    access: fn(&mut Inputs) -> &mut f64,
}

impl InputRow {
    /// The present value.
    pub fn get(&self, inputs: &Inputs) -> f64 {
        let mut copy = *inputs;
        *(self.access)(&mut copy)
    }

    /// Sets the value, or as a rate its rate.
    pub fn put(&self, inputs: &mut Inputs, value: f64) {
        *(self.access)(inputs) = value;
    }
}

/// All of them, in the order in which they are listed.
pub(super) static INPUTS: [InputRow; 5] = [
    InputRow {
        name: "penetration_depth",
        reference: 0,
        unit: Unit::Metre,
        nominal: 1e-5,
        description: "Approach of the two bones past first touch of the undeformed surfaces; negative is clearance, positive presses",
        input: Input::PenetrationDepth,
        minimum: -1e-2,
        maximum: 1e-2,
        access: |i| &mut i.penetration_depth,
    },
    InputRow {
        name: "sliding_speed",
        reference: 1,
        unit: Unit::MetrePerSecond,
        nominal: 1.0,
        description: "Sum of the two surface speeds U1 + U2 (upper + lower), both positive along +x: twice the mean entrainment speed",
        input: Input::SlidingSpeed,
        minimum: -10.0,
        maximum: 10.0,
        access: |i| &mut i.sliding_speed,
    },
    // 0: equal speeds. +1 or -1: one surface at rest. Beyond: surfaces that move in opposite directions.
    InputRow {
        name: "slide_to_roll_ratio",
        reference: 2,
        unit: Unit::One,
        nominal: 1.0,
        description: "(U1 - U2)/(U1 + U2): 0 where both surfaces move at the same speed, 1 where only the upper one moves",
        input: Input::SlideToRollRatio,
        minimum: -10.0,
        maximum: 10.0,
        access: |i| &mut i.slide_to_roll_ratio,
    },
    InputRow {
        name: "approach_speed",
        reference: 3,
        unit: Unit::MetrePerSecond,
        nominal: 1e-4,
        description: "Rate of penetration_depth during a step, unless that input has a derivative of its own; positive closes",
        input: Input::ApproachSpeed,
        minimum: -10.0,
        maximum: 10.0,
        access: |i| &mut i.approach_speed,
    },
    InputRow {
        name: "applied_load",
        reference: 4,
        unit: Unit::NewtonPerMetre,
        nominal: 1e3,
        description: "Load per unit depth that presses the bodies together; used where control is load",
        input: Input::AppliedLoad,
        minimum: -1e9,
        maximum: 1e9,
        access: |i| &mut i.applied_load,
    },
];
