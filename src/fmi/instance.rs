//! One instance of the FMU, in safe Rust: what every call does once pointers have become slices.
//!
//! A call that is refused changes nothing. That is why arrays are set on copies first.

use crate::error::Error;
use crate::fmi::answer::{Answer, Refusal, refuse};
use crate::fmi::log::{Category, Log, Status};
use crate::fmi::model::Model;
use crate::fmi::phase::{Call, Phase};
use crate::fmi::standard::{Element, Standard};
use crate::fmi::state::{SavedState, Settings};
use crate::memory;
use crate::parameters::{Inputs, Value};
use crate::simulation::Drive;
use crate::variables::{Source, Type, VARIABLES, Variable};

/// One instance: settings, and the model once it is needed.
pub struct Instance {
    /// The version of FMI that its importer speaks.
    pub standard: Standard,
    /// What the importer is told.
    pub log: Log,
    pub(super) settings: Settings,
    pub(super) model: Option<Model>,
    /// Where the importer unpacked the FMU's resources.
    resources: Option<String>,
    /// Kinds of warnings that the importer was told.
    told: Vec<String>,
}

/// Masters add up step sizes; this much of a time or a step is taken for rounding.
const TIME_ROUNDING: f64 = 1e-9;

fn later(a: f64, b: f64, step: f64) -> bool {
    a - b > TIME_ROUNDING * a.abs().max(b.abs()).max(step)
}

impl Instance {
    /// A fresh instance with the start values of the table.
    pub fn new(standard: Standard, log: Log) -> Self {
        Self { standard, log, settings: Settings::default(), model: None, resources: None, told: Vec::new() }
    }

    /// The same with the URI (FMI 2) or path (FMI 3) of the folder of resources.
    pub fn with_resources(self, location: Option<String>) -> Self {
        Self { resources: location, ..self }
    }

    /// Where it is in its life.
    pub fn phase(&self) -> Phase {
        self.settings.phase
    }

    /// Refuses a call that the standard does not allow now.
    pub fn check(&self, call: Call) -> Answer<()> {
        let phases = call.phases(self.standard);
        if phases.contains(&self.settings.phase) {
            return Ok(());
        }
        let allowed: Vec<_> = phases.iter().map(Phase::to_string).collect();
        if allowed.is_empty() {
            return refuse("no step is pending: steps of this FMU are never asynchronous");
        }
        refuse(format!("not allowed {}; allowed {}", self.settings.phase, allowed.join(", ")))
    }

    /// fmi2SetupExperiment, and the start of fmi3EnterInitializationMode. The tolerance is not used: that of the solver is the parameter `tolerance`.
    pub fn setup_experiment(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Answer<()> {
        self.check(Call::SetupExperiment)?;
        if let Some(value) = tolerance.filter(|value| !(value.is_finite() && *value > 0.0)) {
            return refuse(format!("tolerance = {value} is not allowed: a positive number"));
        }
        if !start.is_finite() {
            return refuse(format!("startTime = {start} is not allowed: a finite number"));
        }
        if let Some(stop) = stop.filter(|stop| !stop.is_finite() || *stop < start) {
            return refuse(format!("stopTime = {stop} is not allowed: a finite number, startTime = {start} or later"));
        }
        self.settings.time = start;
        self.settings.stop_time = stop;
        Ok(())
    }

    /// Enters initialization mode.
    pub fn enter_initialization_mode(&mut self) -> Answer<()> {
        self.check(Call::EnterInitializationMode)?;
        self.settings.parameters.validate()?;
        self.settings.phase = Phase::Initialization;
        Ok(())
    }

    /// Ends initialization mode: from here the parameters are fixed.
    pub fn exit_initialization_mode(&mut self) -> Answer<()> {
        self.check(Call::ExitInitializationMode)?;
        // Discard is not among the answers that FMI 2 allows here.
        self.solve_if_needed().map_err(|refusal| Refusal { status: Status::Error, ..refusal })?;
        self.settings.phase = Phase::StepComplete;
        Ok(())
    }

    /// Ends the run.
    pub fn terminate(&mut self) -> Answer<()> {
        self.check(Call::Terminate)?;
        self.settings.phase = Phase::Terminated;
        Ok(())
    }

    /// As freshly instantiated.
    pub fn reset(&mut self) -> Answer<()> {
        self.settings = Settings::default();
        self.model = None;
        Ok(())
    }

    /// fmi2GetReal, fmi3GetFloat64.
    pub fn get_real(&mut self, references: &[u32], values: &mut [f64]) -> Answer<()> {
        self.get(references, values, Type::Real, |_, value| match value {
            Value::Real(v) => Some(v),
            _ => None,
        })
    }

    /// fmi2GetInteger, where enumerations count from 1; fmi3GetInt32, which has none.
    pub fn get_integer(&mut self, references: &[u32], values: &mut [i32]) -> Answer<()> {
        let standard = self.standard;
        self.get(references, values, Type::Integer, move |data_type, value| match value {
            Value::Integer(v) => i32::try_from(v).ok(),
            word if standard == Standard::Fmi2 => number_of(data_type, &word).and_then(|v| i32::try_from(v).ok()),
            _ => None,
        })
    }

    /// fmi3GetInt64: enumerations, counted from 1.
    pub fn get_enumeration(&mut self, references: &[u32], values: &mut [i64]) -> Answer<()> {
        self.get(references, values, Type::Enumeration(&[]), |data_type, value| number_of(data_type, &value))
    }

    /// fmi2GetBoolean, fmi3GetBoolean.
    pub fn get_boolean<T: From<bool>>(&mut self, references: &[u32], values: &mut [T]) -> Answer<()> {
        self.get(references, values, Type::Boolean, |_, value| match value {
            Value::Boolean(v) => Some(v.into()),
            _ => None,
        })
    }

    /// The functions for types that no variable has.
    pub fn none_of_type(&self, call: Call, wanted: &str, references: &[u32]) -> Answer<()> {
        self.check(call)?;
        match self.standard.elements(references)?.first() {
            Some(element) => refuse(self.standard.wrong_type(*element, wanted)),
            None => Ok(()),
        }
    }

    /// What a value reference stands for, if there is room for all of it.
    fn elements(&self, references: &[u32], room: usize) -> Answer<Vec<Element>> {
        let elements = self.standard.elements(references)?;
        if elements.len() != room {
            return refuse(format!("nValues = {room} is not allowed: these variables have {} values", elements.len()));
        }
        Ok(elements)
    }

    fn get<T>(
        &mut self,
        references: &[u32],
        values: &mut [T],
        wanted: Type,
        convert: impl Fn(Type, Value) -> Option<T>,
    ) -> Answer<()> {
        self.check(Call::Get)?;
        let elements = self.elements(references, values.len())?;
        let result = elements.iter().find(|element| matches!(element, Element::Row(variable) if variable.is_output()));
        match result {
            Some(element) if self.settings.phase == Phase::Instantiated => {
                return refuse(format!("{} has no value before initialization mode", element.name()));
            }
            Some(_) => self.solve_if_needed()?,
            None => {}
        }
        let mut found = Vec::with_capacity(values.len());
        for element in elements {
            match convert(element.data_type(), self.value(element)?) {
                Some(value) => found.push(value),
                None => return refuse(self.standard.wrong_type(element, self.standard.functions(wanted))),
            }
        }
        for (value, found) in values.iter_mut().zip(found) {
            *value = found;
        }
        Ok(())
    }

    fn value(&mut self, element: Element) -> Answer<Value> {
        let Element::Row(variable) = element else { return Ok(Value::Real(self.settings.time)) };
        let given = matches!(variable.source, Source::Input(_) | Source::Parameter(_));
        let value = match &mut self.model {
            _ if given => variable.given(&self.settings.parameters, &self.settings.inputs),
            Some(model) if matches!(variable.source, Source::Stiffness) => Value::Real(model.contact_stiffness()?),
            Some(model) => variable.get(&model.view()),
            None => return refuse(format!("{} has no value yet: nothing has been solved", variable.name)),
        };
        match value {
            Value::Real(v) if !v.is_finite() => refuse(format!("{} has no finite value: {v}", variable.name)),
            value => Ok(value),
        }
    }

    /// fmi2SetReal, fmi3SetFloat64.
    pub fn set_real(&mut self, references: &[u32], values: &[f64]) -> Answer<()> {
        self.set(references, values, Type::Real, |data_type, value| {
            (data_type == Type::Real).then_some(Value::Real(value))
        })
    }

    /// fmi2SetInteger, where enumerations count from 1; fmi3SetInt32, which has none.
    pub fn set_integer(&mut self, references: &[u32], values: &[i32]) -> Answer<()> {
        let standard = self.standard;
        self.set(references, values, Type::Integer, move |data_type, value| match data_type {
            Type::Integer => Some(Value::Integer(value.into())),
            _ if standard == Standard::Fmi2 => word_of(data_type, value.into()),
            _ => None,
        })
    }

    /// fmi3SetInt64: enumerations, counted from 1.
    pub fn set_enumeration(&mut self, references: &[u32], values: &[i64]) -> Answer<()> {
        self.set(references, values, Type::Enumeration(&[]), word_of)
    }

    /// fmi2SetBoolean, fmi3SetBoolean: everything but 0 is true.
    pub fn set_boolean<T: Copy + Default + PartialEq>(&mut self, references: &[u32], values: &[T]) -> Answer<()> {
        self.set(references, values, Type::Boolean, |data_type, value| {
            (data_type == Type::Boolean).then_some(Value::Boolean(value != T::default()))
        })
    }

    fn set<T: Copy>(
        &mut self,
        references: &[u32],
        values: &[T],
        wanted: Type,
        convert: impl Fn(Type, T) -> Option<Value>,
    ) -> Answer<()> {
        self.check(Call::Set)?;
        let (mut parameters, mut inputs) = (self.settings.parameters, self.settings.inputs);
        for (element, value) in self.elements(references, values.len())?.into_iter().zip(values) {
            let variable = element.row()?;
            let Some(value) = convert(variable.data_type(), *value) else {
                return refuse(self.standard.wrong_type(element, self.standard.functions(wanted)));
            };
            if let Source::Parameter(row) = variable.source
                && self.settings.phase == Phase::StepComplete
            {
                if !row.is_tunable() {
                    return refuse(format!(
                        "{} = {value} comes too late: it is a fixed parameter, to be set before initialization ends",
                        variable.name
                    ));
                }
                if row.get(&parameters) == value {
                    continue;
                }
            }
            variable.set(&mut parameters, &mut inputs, &value).map_err(|error| counted(variable, error))?;
        }
        if self.settings.phase == Phase::StepComplete {
            // The next step takes them; until then the results are those of the step before.
            parameters.validate()?;
        } else {
            self.settings.solved &= inputs == self.settings.inputs && parameters == self.settings.parameters;
            if parameters != self.settings.parameters {
                self.model = None;
            }
        }
        (self.settings.parameters, self.settings.inputs) = (parameters, inputs);
        Ok(())
    }

    /// The function DoStep.
    pub fn do_step(&mut self, from: f64, step: f64) -> Answer<()> {
        self.check(Call::DoStep)?;
        let Settings { time, stop_time, inputs, input_rates, .. } = self.settings;
        if !(step.is_finite() && step > 0.0) {
            return refuse(format!("communicationStepSize = {step} is not allowed: a positive number"));
        }
        if !from.is_finite() || later(from, time, step) || later(time, from, step) {
            return refuse(format!("currentCommunicationPoint = {from} is not allowed: the instance is at {time}"));
        }
        let end = from + step;
        if let Some(stop) = stop_time.filter(|stop| later(end, *stop, step)) {
            return refuse(format!("a step of {step} from {from} is not allowed: stopTime is {stop}"));
        }
        if end <= from {
            return refuse(format!("communicationStepSize = {step} is not allowed: too small to move on from {from}"));
        }
        let drive = Drive { inputs, rates: input_rates };
        let mut parameters = self.settings.parameters;
        let mut target = drive.at(step);
        for variable in VARIABLES.iter() {
            let Source::Input(row) = variable.source else { continue };
            let value = row.get(&target);
            if value != row.get(&inputs) {
                variable.set(&mut parameters, &mut target, &Value::Real(value))?;
            }
        }
        let mut before = None;
        if let Some(model) = &mut self.model
            && *model.parameters() != self.settings.parameters
        {
            let tuned = model.with_parameters(&self.settings.parameters)?;
            before = self.model.replace(tuned);
        }
        if let Err(refusal) = self.solve(|model| model.advance(drive, step)) {
            if before.is_some() {
                self.model = before;
            }
            // FMI 3 has no state for this: the instance is where it was, and a smaller step may follow.
            if refusal.status == Status::Discard && self.standard == Standard::Fmi2 {
                self.settings.phase = Phase::StepFailed;
            }
            return Err(refusal);
        }
        self.settings.inputs = target;
        self.settings.input_rates = Inputs::NONE;
        self.settings.time = end;
        Ok(())
    }

    /// The communication point.
    pub fn time(&self) -> f64 {
        self.settings.time
    }

    /// fmi2GetRealStatus(fmi2LastSuccessfulTime).
    pub fn last_successful_time(&self) -> Answer<f64> {
        self.check(Call::GetStatus)?;
        Ok(self.settings.time)
    }

    /// Copies the state.
    pub fn save(&self) -> Answer<SavedState> {
        memory::reserve_little()?;
        Ok(SavedState::new(&self.settings, self.model.as_ref()))
    }

    /// Returns to a copied state. On an error nothing changes.
    pub fn restore(&mut self, saved: &SavedState) -> Answer<()> {
        match (&saved.model, &mut self.model) {
            (None, slot) => *slot = None,
            (Some((parameters, state)), Some(model)) if model.parameters() == parameters => model.restore(state)?,
            (Some((parameters, state)), slot) => {
                let mut model = Model::new(parameters, self.resources.as_deref())?;
                model.restore(state)?;
                *slot = Some(model);
            }
        }
        self.settings = saved.settings.clone();
        if self.settings.phase == Phase::StepFailed && self.standard == Standard::Fmi3 {
            // An FMI 2 instance wrote it. FMI 3 goes on at once from where the failed step began.
            self.settings.phase = Phase::StepComplete;
        }
        Ok(())
    }

    pub(super) fn solve_if_needed(&mut self) -> Answer<()> {
        if self.settings.solved {
            return Ok(());
        }
        let inputs = self.settings.inputs;
        self.solve(|model| model.solve_steady(inputs))
    }

    fn solve(&mut self, solve: impl FnOnce(&mut Model) -> Result<(), Error>) -> Answer<()> {
        let model = match &mut self.model {
            Some(model) => model,
            slot => {
                let model = Model::new(&self.settings.parameters, self.resources.as_deref())?;
                if let Some(line) = model.introduction() {
                    self.log.add(Status::Ok, Category::Solver, line);
                }
                slot.insert(model)
            }
        };
        solve(model)?;
        self.settings.solved = true;
        self.log.add(Status::Ok, Category::Solver, model.report());
        for warning in model.warnings() {
            // Each kind is told once: a run of many steps would repeat it with other numbers.
            let kind = warning.split(|c: char| c.is_ascii_digit()).next().unwrap_or_default();
            if !self.told.iter().any(|told| told == kind) {
                self.told.push(kind.into());
                self.log.add(Status::Warning, Category::Warning, format!("time {}: {warning}", self.settings.time));
            }
        }
        Ok(())
    }
}

/// The number of an enumeration's item, from 1.
fn number_of(data_type: Type, word: &Value) -> Option<i64> {
    let (Type::Enumeration(items), Value::Text(word)) = (data_type, word) else { return None };
    items.iter().zip(1..).find(|((item, _), _)| item == word).map(|(_, number)| number)
}

/// The item of an enumeration with this number; the number itself, to be refused by name, where there is none.
fn word_of(data_type: Type, number: i64) -> Option<Value> {
    let Type::Enumeration(items) = data_type else { return None };
    let item = number.checked_sub(1).and_then(|index| items.get(usize::try_from(index).ok()?));
    Some(item.map_or(Value::Integer(number), |(word, _)| Value::Text((*word).into())))
}

/// Tells an importer, which knows the items of an enumeration as numbers, those numbers.
fn counted(variable: &Variable, error: Error) -> Error {
    match (variable.data_type(), error) {
        (Type::Enumeration(items), Error::Value { name, value, .. }) => {
            let items: Vec<_> = items.iter().zip(1..).map(|((word, _), number)| format!("{number} ({word})")).collect();
            Error::Value { name, value, allowed: items.join(", ") }
        }
        (_, error) => error,
    }
}
