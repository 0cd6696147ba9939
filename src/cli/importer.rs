//! The FMU as any other tool sees it: unpacked from its file and called through FMI's C interface.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Mutex;

use fmu_runner::model_description::ScalarVariable;
use fmu_runner::{Fmu, FmuInstance, FmuLibrary, fmi2Type};

/// What the FMU wrote to its log. The importing library hands it on through the `log` crate.
struct Journal(Mutex<Vec<String>>);

static JOURNAL: Journal = Journal(Mutex::new(Vec::new()));

impl log::Log for Journal {
    fn enabled(&self, _: &log::Metadata) -> bool {
        true
    }

    fn log(&self, record: &log::Record) {
        if let Ok(mut lines) = self.0.lock() {
            lines.push(record.args().to_string());
        }
    }

    fn flush(&self) {}
}

/// An FMU that is being simulated.
pub struct Importer {
    instance: FmuInstance<FmuLibrary>,
}

impl Importer {
    /// Unpacks the FMU and makes an instance of it.
    pub fn open(path: &Path) -> Result<Self, String> {
        // A logger that is there already keeps the lines; messages are then shorter.
        let _ = log::set_logger(&JOURNAL);
        let fmu = Fmu::unpack(path).map_err(|error| with_causes(&error))?;
        let library = fmu.load(fmi2Type::fmi2CoSimulation).map_err(|error| with_causes(&error))?;
        let instance = FmuInstance::instantiate(library, false).map_err(|error| explained(&error))?;
        Ok(Self { instance })
    }

    /// Initialises at time 0 with these inputs.
    pub fn start(&self, stop_time: f64, inputs: &[(&str, f64)]) -> Result<(), String> {
        let run = || {
            self.instance.setup_experiment(0.0, Some(stop_time), None)?;
            self.instance.enter_initialization_mode()
        };
        run().map_err(|error| explained(&error))?;
        self.set(inputs)?;
        self.instance.exit_initialization_mode().map_err(|error| explained(&error))
    }

    /// Sets inputs by name.
    pub fn set(&self, inputs: &[(&str, f64)]) -> Result<(), String> {
        let mut values = HashMap::new();
        for (name, value) in inputs {
            values.insert(self.variable(name)?, *value);
        }
        self.instance.set_reals(&values).map_err(|error| explained(&error))
    }

    /// One communication step.
    pub fn step(&self, time: f64, step: f64) -> Result<(), String> {
        self.instance.do_step(time, step, true).map_err(|error| explained(&error))
    }

    /// Values of real variables by name.
    pub fn reals<S: AsRef<str>>(&self, names: &[S]) -> Result<Vec<f64>, String> {
        let variables = self.variables(names)?;
        let values = self.instance.get_reals(&variables).map_err(|error| explained(&error))?;
        Ok(variables.iter().map(|variable| values[variable]).collect())
    }

    /// Value of an integer or an enumeration.
    pub fn integer(&self, name: &str) -> Result<i32, String> {
        let variable = self.variable(name)?;
        let values = self.instance.get_integers(&[variable]).map_err(|error| explained(&error))?;
        Ok(values[variable])
    }

    fn variable(&self, name: &str) -> Result<&ScalarVariable, String> {
        let variables = self.instance.lib.variables();
        variables.get(name).ok_or_else(|| format!("the FMU's model description has no variable `{name}`"))
    }

    fn variables<S: AsRef<str>>(&self, names: &[S]) -> Result<Vec<&ScalarVariable>, String> {
        names.iter().map(|name| self.variable(name.as_ref())).collect()
    }
}

/// An error of a call, with what the FMU logged about it.
fn explained(error: &dyn std::error::Error) -> String {
    let lines = JOURNAL.0.lock().map(|mut lines| std::mem::take(&mut *lines)).unwrap_or_default();
    if lines.is_empty() { with_causes(error) } else { format!("{}: {}", with_causes(error), lines.join("; ")) }
}

fn with_causes(error: &dyn std::error::Error) -> String {
    match error.source() {
        Some(cause) => format!("{error}: {}", with_causes(cause)),
        None => error.to_string(),
    }
}
