//! `cartilage-contact solve`: one steady state.

use std::fmt::Write;
use std::path::PathBuf;

use cartilage_contact::io::case::Case;
use cartilage_contact::parameters::Value;
use cartilage_contact::simulation::Simulation;
use cartilage_contact::variables::{self, VARIABLES, Variable, View};

use super::{Failure, format, print};

const EXAMPLES: &str = "\
Defaults are the case of de Boer et al. (2020), Table 2, with 10 um of clearance. A case file \
replaces defaults, and flags replace what the case file says.

Examples:
  cartilage-contact solve --penetration-depth 12e-6 --sliding-speed 0.2
  cartilage-contact solve --case examples/paper.toml --penetration-depth=-5e-6
  cartilage-contact solve --set both.permeability=1e-16 --set formulation=consistent --json";

/// Solve one steady state and print its loads, friction, film and regime.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = variables_help())]
pub struct Arguments {
    /// Case file (TOML): keys are the names of the variables
    #[arg(long, value_name = "FILE.toml")]
    case: Option<PathBuf>,

    /// Approach of the bones past first touch of the undeformed surfaces [m]; negative is clearance
    #[arg(long, value_name = "METRES", allow_hyphen_values = true)]
    penetration_depth: Option<f64>,

    /// Sum of the two surface speeds, both positive along +x [m/s]
    #[arg(long, value_name = "METRES_PER_SECOND", allow_hyphen_values = true)]
    sliding_speed: Option<f64>,

    /// (Upper - lower surface speed) / sliding speed [1]
    #[arg(long, value_name = "RATIO", allow_hyphen_values = true)]
    slide_to_roll_ratio: Option<f64>,

    /// Set any input or parameter by its name; `both.` sets both bodies; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,

    /// Print one JSON object: SI values under the names of the FMU's variables, profiles as arrays
    #[arg(long)]
    json: bool,
}

/// Solves and prints.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let case = case(arguments)?;
    let mut simulation = Simulation::new(&case.parameters)?;
    simulation.solve_steady(case.inputs)?;
    print(&if arguments.json { json(&simulation)? } else { table(&simulation) })
}

/// Defaults, then the case file, then the flags.
fn case(arguments: &Arguments) -> Result<Case, Failure> {
    let mut case = match &arguments.case {
        // A file that is not there is a mistake of whoever named it.
        Some(path) => Case::load(path).map_err(|error| Failure::Usage(error.to_string()))?,
        None => Case::default(),
    };
    for assignment in &arguments.set {
        let Some((name, value)) = assignment.split_once('=') else {
            let message = format!("--set {assignment}: write it as NAME=VALUE, such as --set viscosity=2e-3");
            return Err(Failure::Usage(message));
        };
        case.set(name.trim(), &value_of(value.trim()))?;
    }
    for (name, value) in [
        ("penetration_depth", arguments.penetration_depth),
        ("sliding_speed", arguments.sliding_speed),
        ("slide_to_roll_ratio", arguments.slide_to_roll_ratio),
    ] {
        if let Some(value) = value {
            case.set(name, &Value::Real(value))?;
        }
    }
    Ok(case)
}

/// What a word on the command line means.
fn value_of(text: &str) -> Value {
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

/// The variables that `solve` prints beside the profiles.
fn printed() -> impl Iterator<Item = &'static Variable> {
    let inputs = VARIABLES.iter().filter(|row| matches!(row.source, variables::Source::Input(_)));
    inputs.chain(variables::scalar_outputs())
}

fn json(simulation: &Simulation) -> Result<String, Failure> {
    let view = View::from(simulation);
    let mut object = serde_json::Map::new();
    for variable in printed() {
        object.insert(variable.name.clone(), json_value(variable.get(&view)));
    }
    for variable in VARIABLES.iter().filter(|row| !row.is_scalar()) {
        let name = variable.name.split('[').next().unwrap_or_default();
        let stations = object.entry(name).or_insert_with(|| serde_json::Value::Array(Vec::new()));
        if let serde_json::Value::Array(stations) = stations {
            stations.push(json_value(variable.get(&view)));
        }
    }
    let mut text = serde_json::to_string(&object).map_err(|error| Failure::Failed(error.to_string()))?;
    text.push('\n');
    Ok(text)
}

fn json_value(value: Value) -> serde_json::Value {
    match value {
        Value::Real(value) => value.into(),
        Value::Integer(value) => value.into(),
        Value::Boolean(value) => value.into(),
        Value::Text(value) => value.into(),
    }
}

fn table(simulation: &Simulation) -> String {
    let view = View::from(simulation);
    let mut text = String::new();
    for variable in printed() {
        let (value, unit) = format::shown(variable, &variable.get(&view));
        let line = format!("{:28}{value:>16} {unit:6} {}", variable.name, variable.description);
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// Every variable that can be set, with unit, default and range.
fn variables_help() -> String {
    let mut text = format!("{EXAMPLES}\n\nInputs and parameters (name = default: allowed; what it is):\n");
    for variable in VARIABLES.iter().filter(|row| !row.is_output()) {
        let default = match variable.start() {
            Some(Value::Real(value)) => format::number(value, 6),
            Some(value) => value.to_string(),
            None => continue,
        };
        let _ = writeln!(text, "  {} = {default}: {}", variable.name, variable.allowed());
        let _ = writeln!(text, "      {}", variable.description);
    }
    let _ = write!(text, "\nResults:");
    for variable in variables::scalar_outputs() {
        let unit = variable.unit.name();
        let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
        let _ = write!(text, "\n  {}{unit}\n      {}", variable.name, variable.description);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_the_command_line_become_values() {
        assert_eq!(value_of("120"), Value::Integer(120));
        assert_eq!(value_of("-1e-5"), Value::Real(-1e-5));
        assert_eq!(value_of("false"), Value::Boolean(false));
        assert_eq!(value_of("'consistent'"), Value::Text("consistent".into()));
    }
}
