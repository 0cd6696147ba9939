//! What an instance asks for outputs: the full model, or the real-time one.

use crate::error::Error;
use crate::fmi::resources;
use crate::outputs::Outputs;
use crate::parameters::{Fidelity, Inputs, Parameters};
use crate::reduced::ReducedModel;
use crate::simulation::{Input, Simulation, Snapshot};
use crate::variables::View;

/// Either of them, with its last solution.
pub enum Model {
    /// Solves the equations.
    Full(Box<Simulation>),
    /// Evaluates a table.
    Reduced(Box<Table>),
}

/// The real-time model at its present inputs.
pub struct Table {
    parameters: Parameters,
    model: ReducedModel,
    inputs: Inputs,
    outputs: Outputs,
    derivatives: [Outputs; 3],
}

/// What is needed to go on from a state.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum ModelState {
    /// The full model's state.
    Full(Snapshot),
    /// The inputs: the table has no other memory.
    Reduced(Inputs),
}

impl Model {
    /// As the parameters ask for; the real-time model is read from the folder of resources.
    ///
    /// # Errors
    /// [`Error::Value`] for a parameter out of range; for the real-time model those of [`resources::reduced_model`].
    pub fn new(parameters: &Parameters, resource_location: Option<&str>) -> Result<Self, Error> {
        parameters.validate()?;
        if parameters.fidelity == Fidelity::Full {
            return Ok(Self::Full(Box::new(Simulation::new(parameters)?)));
        }
        let model = resources::reduced_model(resource_location, parameters)?;
        let (inputs, derivatives) = (Inputs::default(), std::array::from_fn(|_| Outputs::default()));
        let table = Table { parameters: *parameters, model, inputs, outputs: Outputs::default(), derivatives };
        Ok(Self::Reduced(Box::new(table)))
    }

    /// The parameters it was made with.
    pub fn parameters(&self) -> &Parameters {
        match self {
            Self::Full(simulation) => simulation.parameters(),
            Self::Reduced(table) => &table.parameters,
        }
    }

    /// The steady state for these inputs.
    ///
    /// # Errors
    /// Why there is none; the last solution is then kept.
    pub fn solve_steady(&mut self, inputs: Inputs) -> Result<(), Error> {
        match self {
            Self::Full(simulation) => simulation.solve_steady(inputs),
            Self::Reduced(table) => {
                (table.outputs, table.derivatives) = table.model.evaluate(&inputs)?;
                table.inputs = inputs;
                Ok(())
            }
        }
    }

    /// Results of the last solution.
    pub fn outputs(&self) -> &Outputs {
        match self {
            Self::Full(simulation) => simulation.outputs(),
            Self::Reduced(table) => &table.outputs,
        }
    }

    /// Their derivatives by one input.
    pub fn derivatives(&self, input: Input) -> &Outputs {
        match self {
            Self::Full(simulation) => simulation.derivatives(input),
            Self::Reduced(table) => &table.derivatives[input as usize],
        }
    }

    /// What variables are read from.
    pub fn view(&self) -> View<'_> {
        match self {
            Self::Full(simulation) => View::from(&**simulation),
            Self::Reduced(table) => View {
                parameters: &table.parameters,
                inputs: &table.inputs,
                outputs: &table.outputs,
                position: table.model.position(),
            },
        }
    }

    /// A line for the log: what the last solution took.
    pub fn report(&self) -> String {
        let outputs = self.outputs();
        let how = match self {
            Self::Full(_) => format!("{} Newton iterations", outputs.newton_iterations),
            Self::Reduced(_) => "reduced model".into(),
        };
        format!("solved {:?}: {how}, {:.6e} N/m", self.view().inputs, outputs.load)
    }

    /// A line for the log when the real-time model was read: what it covers and its measured error.
    pub fn introduction(&self) -> Option<String> {
        match self {
            Self::Full(_) => None,
            Self::Reduced(table) => Some(table.model.to_string()),
        }
    }

    /// A copy of the state.
    pub fn save(&self) -> ModelState {
        match self {
            Self::Full(simulation) => ModelState::Full(simulation.snapshot()),
            Self::Reduced(table) => ModelState::Reduced(table.inputs),
        }
    }

    /// Returns to a copied state.
    ///
    /// # Errors
    /// [`Error::State`] where it does not fit.
    pub fn restore(&mut self, state: &ModelState) -> Result<(), Error> {
        match (self, state) {
            (Self::Full(simulation), ModelState::Full(snapshot)) => simulation.restore(snapshot),
            (table @ Self::Reduced(_), ModelState::Reduced(inputs)) => table.solve_steady(*inputs),
            _ => Err(Error::State("it is of the other fidelity".into())),
        }
    }
}
