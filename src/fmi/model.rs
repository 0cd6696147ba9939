//! What an instance asks for outputs: the full model, or the real-time one.

use crate::equations::system::Direction;
use crate::error::Error;
use crate::fmi::resources;
use crate::outputs::Outputs;
use crate::parameters::{Control, Fidelity, Inputs, Parameters, TimeIntegration};
use crate::reduced::ReducedModel;
use crate::simulation::{Drive, Input, Simulation, Snapshot};
use crate::variables::{Variable, View};

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
    /// What the inputs did in the last step, and how long that was \[s\].
    drive: Drive,
    duration: f64,
    inputs: Inputs,
    outputs: Outputs,
    derivatives: [Outputs; 3],
    position: Vec<f64>,
    warnings: Vec<String>,
}

/// What is needed to go on from a state.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum ModelState {
    /// The full model's state.
    Full(Box<Snapshot>),
    /// The last step: the table has no other memory.
    Reduced(Drive, f64),
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
        if parameters.time_integration != TimeIntegration::QuasiSteady {
            return Err(Error::value("time_integration", "transient", "quasi_steady where fidelity is reduced"));
        }
        let model = resources::reduced_model(resource_location, parameters)?;
        let (inputs, derivatives) = (Inputs::default(), std::array::from_fn(|_| Outputs::default()));
        let (drive, outputs) = (Drive::constant(inputs), Outputs::default());
        let (parameters, position, warnings) = (*parameters, model.position(&inputs), Vec::new());
        let table = Table { parameters, model, drive, duration: 0.0, inputs, outputs, derivatives, position, warnings };
        Ok(Self::Reduced(Box::new(table)))
    }

    /// The present state under other parameters, see [`Simulation::with_parameters`].
    ///
    /// # Errors
    /// Those of it; for the real-time model, that it has none but its own.
    pub fn with_parameters(&mut self, parameters: &Parameters) -> Result<Self, Error> {
        match self {
            Self::Full(simulation) => Ok(Self::Full(Box::new(simulation.with_parameters(parameters)?))),
            Self::Reduced(_) => Err(Error::State("the real-time model keeps its parameters during a run".into())),
        }
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
            Self::Reduced(table) => table.look_up(Drive::constant(inputs), 0.0),
        }
    }

    /// The state after a step.
    ///
    /// # Errors
    /// Why there is none; the last solution is then kept.
    pub fn advance(&mut self, drive: Drive, duration: f64) -> Result<(), Error> {
        match self {
            Self::Full(simulation) => simulation.advance(drive, duration),
            Self::Reduced(table) => table.look_up(drive, duration),
        }
    }

    /// Derivative of a variable with respect to an input, where it has one.
    ///
    /// # Errors
    /// [`Error::State`] where there is no state yet.
    pub fn derivative(&mut self, variable: &Variable, input: Input) -> Result<Option<f64>, Error> {
        match self {
            Self::Full(simulation) => Ok(variable.derivative(simulation.derivatives(input)?)),
            Self::Reduced(table) => {
                let (direction, load) = table.drive.change(input, table.duration);
                Ok(table.along(variable, direction, load))
            }
        }
    }

    /// Derivative of a variable with respect to time at the end of the last step, where it has one.
    ///
    /// # Errors
    /// [`Error::State`] where there is no state yet.
    pub fn rate(&mut self, variable: &Variable) -> Result<Option<f64>, Error> {
        match self {
            Self::Full(simulation) => Ok(variable.derivative(simulation.rates()?)),
            Self::Reduced(table) => {
                let Drive { rates, .. } = table.drive;
                Ok(table.along(variable, table.drive.rates_at(table.duration), rates.applied_load))
            }
        }
    }

    /// Rate of change of the normal force with the penetration depth \[N/m\].
    ///
    /// # Errors
    /// [`Error::State`] where there is no state yet.
    pub fn contact_stiffness(&mut self) -> Result<f64, Error> {
        match self {
            Self::Full(simulation) => simulation.contact_stiffness(),
            Self::Reduced(table) => Ok(match table.parameters.control {
                Control::Depth => table.derivatives[0].normal_force,
                Control::Load => table.parameters.width / table.derivatives[0].penetration_depth,
            }),
        }
    }

    /// What variables are read from, but for the contact stiffness.
    pub fn view(&self) -> View<'_> {
        match self {
            Self::Full(simulation) => View::without_stiffness(simulation),
            Self::Reduced(table) => View {
                parameters: &table.parameters,
                inputs: &table.inputs,
                outputs: &table.outputs,
                contact_stiffness: 0.0,
                position: &table.position,
            },
        }
    }

    /// A line for the log: what the last solution found, and what it took.
    pub fn report(&self) -> String {
        let View { inputs, outputs, .. } = self.view();
        let how = match self {
            Self::Full(_) => format!("in {} Newton iterations", outputs.newton_iterations),
            Self::Reduced(_) => "by the real-time model".into(),
        };
        let Inputs { sliding_speed, slide_to_roll_ratio, .. } = inputs;
        format!(
            "solved {how}: penetration depth {:.6} um, sliding speed {sliding_speed} m/s, slide-to-roll ratio \
             {slide_to_roll_ratio}; load {:.6} N/m, friction coefficient {:.4}, least film thickness {:.4} um",
            1e6 * outputs.penetration_depth,
            outputs.load,
            outputs.friction_coefficient,
            1e6 * outputs.minimum_film_thickness
        )
    }

    /// What mesh and sector do not resolve of the last solution.
    pub fn warnings(&self) -> &[String] {
        match self {
            Self::Full(simulation) => simulation.warnings(),
            Self::Reduced(table) => &table.warnings,
        }
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
            Self::Full(simulation) => ModelState::Full(Box::new(simulation.snapshot())),
            Self::Reduced(table) => ModelState::Reduced(table.drive, table.duration),
        }
    }

    /// Returns to a copied state.
    ///
    /// # Errors
    /// [`Error::State`] where it does not fit.
    pub fn restore(&mut self, state: &ModelState) -> Result<(), Error> {
        match (self, state) {
            (Self::Full(simulation), ModelState::Full(snapshot)) => simulation.restore(snapshot),
            (Self::Reduced(table), ModelState::Reduced(drive, duration)) => table.look_up(*drive, *duration),
            _ => Err(Error::State("it is of the other fidelity".into())),
        }
    }
}

impl Table {
    fn look_up(&mut self, drive: Drive, duration: f64) -> Result<(), Error> {
        let inputs = drive.at(duration);
        (self.outputs, self.derivatives) = self.model.evaluate(&inputs)?;
        self.position = self.model.position(&inputs);
        self.warnings = if self.outputs.well_resolved { Vec::new() } else { self.model.warnings(&inputs) };
        (self.inputs, self.drive, self.duration) = (inputs, drive, duration);
        Ok(())
    }

    /// Derivative of a variable along a change of the inputs and of the load.
    fn along(&self, variable: &Variable, direction: Direction, load: f64) -> Option<f64> {
        let pressing = match self.parameters.control {
            Control::Depth => direction.penetration_depth,
            Control::Load => load,
        };
        let changes = [pressing, direction.sliding_speed, direction.slide_to_roll_ratio];
        let slopes = self.derivatives.iter().zip(changes);
        slopes.map(|(derivatives, change)| Some(change * variable.derivative(derivatives)?)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::{Mesh, Preset};
    use crate::reduced::{Range, Tolerance};
    use crate::variables::VARIABLES;

    /// The smallest table under a load.
    #[test]
    fn a_table_under_a_load_has_its_derivatives_its_stiffness_and_its_warning() {
        let base = Preset::HumanNormal.parameters();
        let mesh = Mesh { columns: 24, rows: 3, ..base.mesh };
        let full = Parameters { control: Control::Load, mesh, ..base };
        let range = Range { pressed: [500.0, 600.0], speeds: [0.1, 0.12], slide_to_roll_ratio: 0.0 };
        let any = 1.0;
        let tolerance =
            Tolerance { load: any, minimum_film_thickness: any, friction_coefficient: any, fluid_pressure: any };
        let table = ReducedModel::build(&full, range, tolerance, 1, &|_| ()).unwrap();
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(resources::REDUCED_MODEL), table.to_bytes().unwrap()).unwrap();
        let resources = folder.path().to_str();
        let parameters = Parameters { fidelity: Fidelity::Reduced, ..full };
        assert!(Model::new(&Parameters { control: Control::Depth, ..parameters }, resources).is_err());
        let mut model = Model::new(&parameters, resources).unwrap();
        let at = |applied_load: f64| Inputs { applied_load, sliding_speed: 0.11, ..Inputs::NONE };
        let variable = VARIABLES.iter().find(|row| row.name == "penetration_depth_result").unwrap();
        let depth = |model: &mut Model, load: f64| {
            model.solve_steady(at(load)).unwrap();
            model.view().outputs.penetration_depth
        };
        let slope = (depth(&mut model, 551.0) - depth(&mut model, 549.0)) / 2.0;
        // The stations of the profiles go with the contact, as those of the full model.
        let mut simulation = Simulation::new(&full).unwrap();
        for load in [510.0, 590.0] {
            simulation.solve_steady(at(load)).unwrap();
            model.solve_steady(at(load)).unwrap();
            let last = [simulation.position(), model.view().position].map(|position| position[position.len() - 1]);
            assert!((last[0] / last[1] - 1.0).abs() < 1e-12, "{last:?}");
        }
        // The load grows as the step goes on.
        let rates = Inputs { applied_load: 100.0, ..Inputs { sliding_speed: 0.0, ..Inputs::NONE } };
        model.advance(Drive { inputs: at(540.0), rates }, 0.1).unwrap();
        let by_load = model.derivative(variable, Input::AppliedLoad).unwrap().unwrap();
        assert!((by_load / slope - 1.0).abs() < 1e-3, "{by_load} {slope}");
        assert_eq!(model.derivative(variable, Input::PenetrationDepth).unwrap(), Some(0.0));
        assert!((model.rate(variable).unwrap().unwrap() / (100.0 * by_load) - 1.0).abs() < 1e-12);
        assert!((model.contact_stiffness().unwrap() * by_load / full.width - 1.0).abs() < 1e-12);
        // On so few elements it is not resolved; it is not held either.
        let held = |model: &Model| model.warnings().iter().any(|warning| warning.contains("below 0.1 m/s"));
        assert!(!held(&model) && model.warnings()[0].contains("do not resolve") && !model.view().outputs.well_resolved);
        let saved = model.save();
        let before = model.view().outputs.clone();
        model.solve_steady(Inputs { sliding_speed: -0.05, ..at(550.0) }).unwrap();
        assert!(held(&model), "{:?}", model.warnings());
        // What is beyond the loads is refused, and the state is kept.
        assert!(model.solve_steady(at(601.0)).unwrap_err().to_string().contains("applied_load = 601"));
        model.restore(&saved).unwrap();
        assert!(model.view().outputs == &before && !held(&model));
    }
}
