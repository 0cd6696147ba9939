//! `cartilage-contact solve`: one steady state.

use std::fmt::Write;

use cartilage_contact::io::case::Case;
use cartilage_contact::io::measured::MEASURED;
use cartilage_contact::parameters::{Control, Value};
use cartilage_contact::simulation::Simulation;
use cartilage_contact::variables::{self, VARIABLES, Variable, View};

use super::case::{CaseArguments, value_of};
use super::{Failure, format, print};

const EXAMPLES: &str = "\
Defaults are the case of de Boer et al. (2020), Table 2, with 10 um of clearance. A preset replaces the defaults of all \
parameters, a case file replaces what the preset says, and flags replace what the case file says.

Examples:
  cartilage-contact solve --penetration-depth 12e-6 --sliding-speed 0.2
  cartilage-contact solve --case examples/paper.toml --penetration-depth=-5e-6
  cartilage-contact solve --preset human_femoral_condyle --penetration-depth 20e-6
  cartilage-contact solve --set both.permeability=1e-16 --set formulation=consistent --json
  cartilage-contact solve --preset human_femoral_condyle --applied-load 10e3 --sliding-speed 0.1 --check
  cartilage-contact solve --set both.aggregate_modulus=\"0.7 MPa\" --set both.poisson_ratio=0.1 --set formulation=consistent";

/// Less between two meshes is shown as none \[%\].
const LEAST_SHOWN: f64 = 1e-3;

/// Solve one steady state and print its loads, friction, film and regime.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = variables_help())]
pub struct Arguments {
    #[command(flatten)]
    case: CaseArguments,

    /// Approach of the bones past first touch of the undeformed surfaces \[m\], or with a unit, "12 um"; negative is clearance
    #[arg(long, value_name = "METRES", allow_hyphen_values = true)]
    penetration_depth: Option<String>,

    /// Sum of the two surface speeds, both positive along +x \[m/s\]
    #[arg(long, value_name = "METRES_PER_SECOND", allow_hyphen_values = true)]
    sliding_speed: Option<String>,

    /// (Upper - lower surface speed) / sliding speed \[1\]
    #[arg(long, value_name = "RATIO", allow_hyphen_values = true)]
    slide_to_roll_ratio: Option<String>,

    /// Load per unit depth \[N/m\]: finds the depth that carries it
    #[arg(long, value_name = "NEWTONS_PER_METRE", conflicts_with = "penetration_depth")]
    applied_load: Option<String>,

    /// Print one JSON object: SI values under the names of the FMU's variables, profiles as arrays
    #[arg(long)]
    json: bool,

    /// Solve again on twice the columns, 1.6 times the rows and half more of a sector, and print how far the first answer is from that; takes several times as long
    #[arg(long)]
    check: bool,
}

/// Solves and prints.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let case = case(arguments)?;
    let mut simulation = Simulation::new(&case.parameters)?;
    simulation.solve_steady(case.inputs)?;
    for warning in simulation.warnings() {
        eprintln!("warning: {warning}");
    }
    let mut finer = arguments.check.then(|| finer(&simulation)).transpose();
    // Whatever comes of the check, the first answer is printed.
    if arguments.json {
        let mut object = json(&mut simulation)?;
        if let Ok(Some(finer)) = &mut finer {
            object.insert("finer_mesh".into(), json(finer)?.into());
        }
        let text = serde_json::to_string(&object).map_err(|error| Failure::Failed(error.to_string()))?;
        print(&format!("{text}\n"))?;
    } else {
        print(&table(&mut simulation)?)?;
        if let Ok(Some(finer)) = &mut finer {
            print(&comparison(&mut simulation, finer)?)?;
        }
    }
    finer.map(drop)
}

/// The same state on a finer mesh.
fn finer(simulation: &Simulation) -> Result<Simulation, Failure> {
    let parameters = simulation.outputs().on_finer_mesh(simulation.parameters());
    let [columns, rows] = parameters.elements();
    let failed = |error| Failure::Failed(format!("not checked, on {columns} x {rows} elements: {error}"));
    let mut finer = Simulation::new(&parameters).map_err(failed)?;
    finer.solve_steady(*simulation.inputs()).map_err(failed)?;
    for warning in finer.warnings() {
        eprintln!("warning on the finer mesh: {warning}");
    }
    let [here, there] = [simulation.outputs(), finer.outputs()];
    let followed = match parameters.control {
        Control::Depth => ("load", here.load, there.load),
        Control::Load => ("penetration_depth", here.penetration_depth, there.penetration_depth),
    };
    let film = ("minimum_film_thickness", here.minimum_film_thickness, there.minimum_film_thickness);
    let friction = ("friction_coefficient", here.friction_coefficient, there.friction_coefficient);
    for ((name, here, there), good) in [(followed, 1.0), (film, 2.0), (friction, 2.0)] {
        let apart = apart(here, there);
        if apart.abs() > good {
            let direction = if apart > 0.0 { "above" } else { "below" };
            let apart = format::number(apart.abs(), 2);
            eprintln!(
                "warning: {name} is {apart} % {direction} that on the finer mesh, {good} % and less is good: more mesh.columns and mesh.rows"
            );
        }
    }
    Ok(finer)
}

/// By how much a result is above that on another mesh \[% of the larger one\].
fn apart(here: f64, there: f64) -> f64 {
    let largest = here.abs().max(there.abs());
    if largest > 0.0 { 100.0 * (here - there) / largest } else { 0.0 }
}

/// Every real result on a finer mesh, and how far the first one is from it.
fn comparison(simulation: &mut Simulation, finer: &mut Simulation) -> Result<String, Failure> {
    let [here, there] = [simulation.outputs(), finer.outputs()];
    let [coarse, fine] = [here, there].map(|outputs| format!("{} x {}", outputs.mesh_columns, outputs.mesh_rows));
    let mut text = format!("\nOn {fine} elements in place of {coarse}, and ");
    let _ = match there.mesh_half_width / here.mesh_half_width {
        wider if wider > 1.001 => writeln!(text, "a sector {} times as wide:\n", format::number(wider, 2)),
        _ => writeln!(text, "the same sector, which is as wide as there is one:\n"),
    };
    let (here, there) = (View::new(simulation)?, View::new(finer)?);
    for variable in variables::scalar_outputs().filter(|row| !is_about_the_mesh(row)) {
        let (first, second) = (variable.get(&here), variable.get(&there));
        let (Value::Real(here), Value::Real(there)) = (&first, &second) else { continue };
        let apart = apart(*here, *there);
        let apart = if apart.abs() < LEAST_SHOWN { "0".into() } else { format::number(apart, 2) };
        let (value, unit) = format::shown(variable, &second);
        let _ = writeln!(text, "{:28}{value:>16} {unit:6} {apart:>7} %", variable.name);
    }
    text += "\nThe last column is by how much the first result is above this one, in per cent of the larger one.\n";
    Ok(text)
}

/// Whether a result says how well the others are known.
fn is_about_the_mesh(variable: &Variable) -> bool {
    variable.name.starts_with("estimated_") || variable.name.starts_with("mesh_")
}

/// The case, then the flags of this command.
fn case(arguments: &Arguments) -> Result<Case, Failure> {
    let mut case = arguments.case.load()?;
    for (name, value) in [
        ("penetration_depth", &arguments.penetration_depth),
        ("sliding_speed", &arguments.sliding_speed),
        ("slide_to_roll_ratio", &arguments.slide_to_roll_ratio),
        ("applied_load", &arguments.applied_load),
    ] {
        if let Some(value) = value {
            case.set(name, &value_of(value))?;
        }
    }
    if arguments.applied_load.is_some() {
        case.parameters.control = Control::Load;
    }
    Ok(case)
}

/// The variables that `solve` prints beside the profiles.
fn printed() -> impl Iterator<Item = &'static Variable> {
    let inputs = VARIABLES.iter().filter(|row| matches!(row.source, variables::Source::Input(_)));
    inputs.chain(variables::scalar_outputs())
}

fn json(simulation: &mut Simulation) -> Result<serde_json::Map<String, serde_json::Value>, Failure> {
    let view = View::new(simulation)?;
    let mut object = serde_json::Map::new();
    for variable in printed() {
        object.insert(variable.name.into(), json_value(variable.get(&view)));
    }
    for variable in VARIABLES.iter().filter(|row| !row.is_scalar()) {
        let name = variable.name.split('[').next().unwrap_or_default();
        let stations = object.entry(name).or_insert_with(|| serde_json::Value::Array(Vec::new()));
        if let serde_json::Value::Array(stations) = stations {
            stations.push(json_value(variable.get(&view)));
        }
    }
    object.insert("warnings".into(), simulation.warnings().into());
    Ok(object)
}

fn json_value(value: Value) -> serde_json::Value {
    match value {
        Value::Real(value) => value.into(),
        Value::Integer(value) => value.into(),
        Value::Boolean(value) => value.into(),
        Value::Text(value) => value.into(),
    }
}

fn table(simulation: &mut Simulation) -> Result<String, Failure> {
    let view = View::new(simulation)?;
    let mut text = String::new();
    for variable in printed() {
        let (value, unit) = format::shown(variable, &variable.get(&view));
        let line = format!("{:28}{value:>16} {unit:6} {}", variable.name, variable.description);
        let _ = writeln!(text, "{}", line.trim_end());
    }
    Ok(text)
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
    let _ = writeln!(text, "\nIn place of parameters, for upper., lower. or both.:");
    for row in &MEASURED {
        let _ = writeln!(text, "  {}: {}\n      {}", row.name, row.allowed(), row.description);
    }
    let _ = write!(text, "\nResults:");
    for variable in variables::scalar_outputs() {
        let unit = variable.unit.name();
        let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
        let _ = write!(text, "\n  {}{unit}\n      {}", variable.name, variable.description);
    }
    text
}
