//! Case files: TOML whose keys are the names of the variables.
//!
//! ```toml
//! penetration_depth = 12e-6     # m
//! viscosity = 1e-3              # Pa s
//! [both]                        # upper and lower together
//! shear_modulus = 0.5e6         # Pa
//! [upper]                       # wins over [both]
//! thickness = 1.2e-3            # m
//! [mesh]
//! columns = 120
//! ```
//!
//! Numbers are SI; a text with a unit, `thickness = "1.2 mm"`, is converted. What a file does not mention keeps its default, or the
//! value of the `preset` that the file names (on any line). The quantities of [`measured`](super::measured) stand for parameters. A
//! mistake is reported with its line, the key, the value and what would have been allowed.

use std::ops::Range;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::measured::{Given, Measured};
use crate::error::Error;
use crate::parameters::{Inputs, PARAMETERS, Parameters, Value};
use crate::variables::{self, Type, VARIABLES, Variable};

/// Parameters and inputs that belong together.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Case {
    /// Bodies, lubricant, contact and numerics.
    pub parameters: Parameters,
    /// What the layers are made to do.
    pub inputs: Inputs,
}

impl Case {
    /// Reads a case file.
    ///
    /// # Errors
    /// [`Error::File`] where it cannot be read, [`Error::Case`] where it has a mistake.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let file = path.display().to_string();
        match std::fs::read_to_string(path) {
            Ok(text) => Self::parse(&file, &text),
            Err(error) => Err(Error::File { path: file, message: format!("could not read the case file: {error}") }),
        }
    }

    /// Reads the text of a case file; `file` is what errors call it.
    ///
    /// # Errors
    /// [`Error::Case`] with the line of the first mistake.
    pub fn parse(file: &str, text: &str) -> Result<Self, Error> {
        let line_of = |offset: usize| text.bytes().take(offset).filter(|&byte| byte == b'\n').count() + 1;
        let mistake = |offset: usize, mut message: String| {
            if let Some((end, _)) = message.char_indices().nth(LONGEST_MESSAGE) {
                message.replace_range(end.., "...");
            }
            Error::Case { file: file.into(), line: line_of(offset), message }
        };
        let table = DeTable::parse(text).map_err(|error| {
            mistake(error.span().map_or(0, |span| span.start), format!("not valid TOML: {}", error.message()))
        })?;

        let mut entries = Vec::new();
        flatten("", table.get_ref(), &mut entries);
        // In the order of the file, but what is said of both bodies first.
        entries.sort_by_key(|entry| (!entry.name.starts_with(BOTH), entry.key.start));

        let mut assignments = Vec::new();
        for entry in &entries {
            let value = entry.value.map_err(|what| {
                mistake(entry.key.start, format!("`{}` is {what}, where one value is needed", entry.name))
            });
            let value = read(value?).map_err(|given| {
                mistake(entry.key.start, format!("{} = {given} is not allowed: {}", entry.name, allowed(&entry.name)))
            })?;
            assignments.push((entry.name.as_str(), value));
        }
        let mut case = Self::default();
        case.set_all(&assignments).map_err(|(place, error)| mistake(entries[place].key.start, error.to_string()))?;
        case.parameters.validate().map_err(|error| {
            // A rule that ties two values together: the line of the one that it names.
            let named = |entry: &&Entry| match &error {
                Error::Value { name, .. } => {
                    bodies(&entry.name).iter().any(|full| full == name || Measured::decides(full, name))
                }
                _ => false,
            };
            let entry = entries.iter().rev().find(named);
            mistake(entry.map_or(0, |entry| entry.key.start), error.to_string())
        })?;
        Ok(case)
    }

    /// The text of a case file with every parameter and the slide-to-roll ratio: what a sweep over depth and speed keeps fixed.
    pub fn fixed_part(&self) -> String {
        let written = |value: Value| match value {
            // Exponents keep small numbers short, and are read back to the same bits.
            Value::Real(value) => format!("{value:e}"),
            other => other.to_string(),
        };
        let inputs = std::iter::once(("slide_to_roll_ratio", Value::Real(self.inputs.slide_to_roll_ratio)));
        let parameters = PARAMETERS.iter().map(|row| (row.name, row.get(&self.parameters)));
        inputs.chain(parameters).map(|(name, value)| format!("{name} = {}\n", written(value))).collect()
    }

    /// Sets a variable by its name; `both.thickness` and the like set the two bodies. On an error nothing changes.
    ///
    /// # Errors
    /// [`Error::UnknownName`], or [`Error::Value`] with what is allowed.
    pub fn set(&mut self, name: &str, value: &Value) -> Result<(), Error> {
        self.set_all(&[(name, value.clone())]).map_err(|(_, error)| error)
    }

    /// Sets all that one source says, a file or the flags, in this order. On an error nothing changes.
    ///
    /// # Errors
    /// Those of [`Self::set`], with the place of the assignment that is wrong.
    pub fn set_all(&mut self, assignments: &[(&str, Value)]) -> Result<(), (usize, Error)> {
        let mut changed = *self;
        let mut given = Given::default();
        for (place, (name, value)) in assignments.iter().enumerate() {
            changed.assign(name, value, place, &mut given).map_err(|error| (place, error))?;
        }
        let Self { parameters, inputs } = &mut changed;
        given.resolve(parameters, |parameters, full, value| {
            variables::set(parameters, inputs, full, &Value::Real(value))
        })?;
        *self = changed;
        Ok(())
    }

    fn assign(&mut self, name: &str, value: &Value, place: usize, given: &mut Given) -> Result<(), Error> {
        for full in bodies(name) {
            let value = converted(name, &full, value)?;
            if !given.note(&full, &value, place).map_err(|error| named_as_given(error, name, &full))? {
                variables::set(&mut self.parameters, &mut self.inputs, &full, &value)
                    .map_err(|error| named_as_given(error, name, &full))?;
            }
        }
        Ok(())
    }
}

/// The value in the type and the unit of its variable: 24.0 columns are 24, and `"2 mm"` is 2e-3.
fn converted(name: &str, full: &str, value: &Value) -> Result<Value, Error> {
    let variable = variables::find(full).ok();
    let unit = match (&variable, Measured::find(full)) {
        (_, Some(measured)) => Some(measured.unit),
        (Some(variable), _) if variable.data_type() == Type::Real => Some(variable.unit),
        _ => None,
    };
    match (value, unit) {
        (Value::Real(v), _) if v.fract() == 0.0 && v.abs() < 1e9 => match variable.map(Variable::data_type) {
            Some(Type::Integer) => Ok(Value::Integer(*v as i64)),
            _ => Ok(value.clone()),
        },
        (Value::Text(text), Some(unit)) if !variable.is_some_and(Variable::is_output) => {
            let refused = |why: String| Error::value(name, value, format!("{} ({why})", allowed(name)));
            unit.read(text).map(Value::Real).map_err(refused)
        }
        _ => Ok(value.clone()),
    }
}

const BOTH: &str = "both.";

/// Characters of a message: a file may have a value or a key of any length.
const LONGEST_MESSAGE: usize = 2000;

/// The variables that a name in a case stands for.
fn bodies(name: &str) -> Vec<String> {
    match name.strip_prefix(BOTH) {
        Some(rest) => vec![format!("upper.{rest}"), format!("lower.{rest}")],
        None => vec![name.into()],
    }
}

/// Says `both.` where that is what was written.
fn named_as_given(error: Error, given: &str, full: &str) -> Error {
    match error {
        Error::Value { value, allowed, .. } => Error::Value { name: given.into(), value, allowed },
        Error::UnknownName { hint, .. } if given != full => {
            Error::UnknownName { name: given.into(), hint: hint.replace("`upper.", "`both.") }
        }
        other => other,
    }
}

fn allowed(name: &str) -> String {
    let full = bodies(name).remove(0);
    if let Some(measured) = Measured::find(&full) {
        return measured.allowed();
    }
    match variables::find(&full) {
        Ok(variable) => variable.allowed(),
        Err(error) => named_as_given(error, name, &full).to_string(),
    }
}

struct Entry<'a> {
    /// Full name, such as `mesh.columns`.
    name: String,
    /// Where the key is.
    key: Range<usize>,
    /// The value, or what is there instead of one.
    value: Result<&'a DeValue<'a>, &'static str>,
}

fn flatten<'a>(prefix: &str, table: &'a DeTable<'a>, entries: &mut Vec<Entry<'a>>) {
    let row = |(key, value): (&'a Spanned<DeString<'a>>, &'a Spanned<DeValue<'a>>)| {
        (format!("{prefix}{}", key.get_ref()), key.span(), value.get_ref())
    };
    for (name, key, value) in table.iter().map(row) {
        match value {
            DeValue::Table(inner) if VARIABLES.iter().all(|row| row.name != name) => {
                flatten(&format!("{name}."), inner, entries)
            }
            DeValue::Table(_) => entries.push(Entry { name, key, value: Err("a table") }),
            _ => entries.push(Entry { name, key, value: Ok(value) }),
        }
    }
}

/// A value, or how it was written where it is of a type that no variable has.
fn read(value: &DeValue) -> Result<Value, String> {
    match value {
        DeValue::String(text) => Ok(Value::Text(text.to_string())),
        DeValue::Boolean(value) => Ok(Value::Boolean(*value)),
        DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix())
            .map(Value::Integer)
            .map_err(|_| number.as_str().to_owned()),
        DeValue::Float(number) => number.as_str().parse().map(Value::Real).map_err(|_| number.as_str().to_owned()),
        DeValue::Datetime(date) => Err(date.to_string()),
        DeValue::Array(_) => Err("[...]".into()),
        DeValue::Table(_) => Err("{...}".into()),
    }
}

#[cfg(test)]
mod tests;
