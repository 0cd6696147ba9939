//! The flags that say which case: shared by the subcommands that solve one.

use std::path::PathBuf;

use cartilage_contact::error::Error;
use cartilage_contact::io::case::Case;
use cartilage_contact::parameters::{Control, PRESETS, Value};
use cartilage_contact::units::Unit;
use clap::builder::{PossibleValue, PossibleValuesParser};

use super::Failure;

/// Joints by name, with their case files.
const JOINTS: [(&str, &str); 3] = [
    ("ankle", include_str!("../../examples/ankle.toml")),
    ("hip", include_str!("../../examples/hip.toml")),
    ("knee", include_str!("../../examples/knee.toml")),
];

/// Where the case comes from.
#[derive(Clone, clap::Args)]
pub struct CaseArguments {
    /// Parameters of a tissue to start from; `cartilage-contact presets` lists their values and sources
    #[arg(long, value_name = "NAME", value_parser = preset_names())]
    preset: Option<String>,

    /// Shapes, tissue and fluid of a joint to start from: the case file of that name in `examples`
    #[arg(long, value_name = "NAME", conflicts_with = "case", value_parser = JOINTS.map(|(name, _)| name))]
    joint: Option<String>,

    /// Case file (TOML): keys are the names of the variables
    #[arg(long, value_name = "FILE.toml")]
    case: Option<PathBuf>,

    /// Set any input or parameter by its name; `both.` sets both bodies; SI numbers, or with a unit as in
    /// `--set both.thickness="2 mm"`; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,
}

impl CaseArguments {
    /// With this joint where nothing says which tissue or joint.
    pub fn or_joint(&self, name: &str) -> Self {
        let open = self.preset.is_none() && self.joint.is_none() && self.case.is_none();
        Self { joint: if open { Some(name.into()) } else { self.joint.clone() }, ..self.clone() }
    }

    /// The joint that was named.
    pub fn joint(&self) -> Option<&str> {
        self.joint.as_deref()
    }

    /// The case, in which depths have to be what is given.
    pub fn load_by_depth(&self) -> Result<Case, Failure> {
        let case = self.load()?;
        match case.parameters.control {
            Control::Depth => Ok(case),
            Control::Load => Err(Error::value("control", "load", "\"depth\": the depths are given here").into()),
        }
    }

    /// The preset, then the joint or the case file, then what was set.
    pub fn load(&self) -> Result<Case, Failure> {
        let joint = JOINTS.into_iter().find(|(name, _)| self.joint.as_deref() == Some(*name));
        let mut case = match (&self.case, joint) {
            (None, Some((name, text))) => Case::parse(name, text)?,
            // A file that is not there is a mistake of whoever named it.
            (Some(path), _) => Case::load(path).map_err(|error| Failure::Usage(error.to_string()))?,
            (None, None) => Case::default(),
        };
        if let Some(name) = &self.preset {
            // In place of the file's own preset; what the file sets by name stays.
            case.set("preset", &Value::Text(name.clone()))?;
        }
        let mut assignments = Vec::new();
        for assignment in &self.set {
            let Some((name, value)) = assignment.split_once('=') else {
                let message = format!("--set {assignment}: write it as NAME=VALUE, such as --set viscosity=2e-3");
                return Err(Failure::Usage(message));
            };
            assignments.push((name.trim(), value_of(value.trim())));
        }
        case.set_all(&assignments).map_err(|(_, error)| error)?;
        Ok(case)
    }
}

fn preset_names() -> PossibleValuesParser {
    PRESETS.iter().map(|row| PossibleValue::new(row.name).help(row.description)).collect::<Vec<_>>().into()
}

/// What a word on the command line means.
pub fn value_of(text: &str) -> Value {
    if let Ok(value) = text.parse() {
        Value::Boolean(value)
    } else if let Ok(value) = text.parse() {
        Value::Integer(value)
    } else if let Ok(value) = text.parse() {
        Value::Real(value)
    } else {
        Value::Text(text.trim_matches(['"', '\'']).into())
    }
}

/// Numbers as a list: each item of `text` between commas is a number or a range `from:to:step`, ends included; SI, or with units.
pub fn numbers(flag: &str, unit: Unit, text: &str) -> Result<Vec<f64>, Failure> {
    const MOST: f64 = 1e5;
    let mut all = Vec::new();
    for item in text.split(',') {
        let refuse = |why: &str| {
            Err(Failure::Usage(format!(
                "{flag}: `{item}` {why}; give SI numbers as a list 0,12e-6,50e-6 or as from:to:step, such as -10e-6:100e-6:1e-6"
            )))
        };
        let read = |number: &str| number.trim().parse::<f64>().or_else(|_| unit.read(number));
        let parsed: Result<Vec<f64>, _> = item.split(':').map(read).collect();
        match parsed.as_deref() {
            Ok([value]) if value.is_finite() => all.push(*value),
            Ok([from, to, step]) => {
                let count = ((to - from) / step * (1.0 + 1e-9)).floor();
                if !(0.0..MOST).contains(&count) || !count.is_finite() {
                    return refuse("is no range: the step has to lead from the first number to the last");
                }
                // The same numbers as if they were written out, without the round-off of adding steps.
                let tidy = |value: f64| format!("{value:.11e}").parse().unwrap_or(value);
                all.extend((0..=count as u32).map(|i| tidy(from + f64::from(i) * step) + 0.0));
            }
            _ => return refuse("is not a number"),
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_joints_are_cases_with_a_gap_beside_the_contact() {
        for (name, text) in JOINTS {
            let case = Case::parse(name, text).unwrap();
            case.parameters.validate().unwrap();
            assert!(case.parameters.pore_viscosity > 0.0 && case.inputs.applied_load > 0.0, "{name}");
        }
    }

    #[test]
    fn words_of_the_command_line_become_values() {
        assert_eq!(value_of("120"), Value::Integer(120));
        assert_eq!(value_of("-1e-5"), Value::Real(-1e-5));
        assert_eq!(value_of("false"), Value::Boolean(false));
        assert_eq!(value_of("'consistent'"), Value::Text("consistent".into()));
    }

    #[test]
    fn lists_and_ranges_become_numbers() {
        let read = |text| numbers("--depths", Unit::Metre, text).ok().unwrap();
        assert_eq!(read("-1e-5, 0,2"), [-1e-5, 0.0, 2.0]);
        assert_eq!(read("-3e-6:3e-6:1e-6"), [-3e-6, -2e-6, -1e-6, 0.0, 1e-6, 2e-6, 3e-6]);
        assert_eq!(read("-10e-6:100e-6:1e-6").len(), 111);
        assert_eq!(read("0.3:0.1:-0.1,1"), [0.3, 0.2, 0.1, 1.0]);
        assert_eq!(read("-1e-6:1 um:0.001mm, 2 mm"), [-1e-6, 0.0, 1e-6, 2e-3]);
        for wrong in ["", "deep", "1:2", "1:2:0", "1:2:-1", "1:2:1e-9", "1 Pa", "nan", "1:2:3:4"] {
            let Err(Failure::Usage(message)) = numbers("--depths", Unit::Metre, wrong) else { panic!("{wrong}") };
            assert!(message.contains("--depths") && message.contains("from:to:step"), "{message}");
        }
    }
}
