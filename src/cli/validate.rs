//! `cartilage-contact validate`: the studies whose results stand in docs/validation.md, as Markdown tables.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use cartilage_contact::laws::Formulation;
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Inputs, Parameters};
use cartilage_contact::sweep;
use cartilage_contact::units::Unit;

use super::case::{CaseArguments, numbers};
use super::stribeck::progress;
use super::{Failure, experiments, format, print};

const EXAMPLES: &str = "\
Examples:
  cartilage-contact validate published
  cartilage-contact validate experiments
  cartilage-contact validate convergence --meshes 3
  cartilage-contact validate variants --depths 0,13e-6,50e-6";

/// Mesh convergence, variants of the model, and what the paper prints, as Markdown tables.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Which study
    #[arg(value_enum)]
    study: Study,

    #[command(flatten)]
    case: CaseArguments,

    /// Penetration depths \[m\] of the convergence study and of the variants: a list, or from:to:step
    #[arg(long, value_name = "LIST", allow_hyphen_values = true, default_value = "0,10e-6,13e-6,24e-6,50e-6")]
    depths: String,

    /// Meshes of the convergence study: a quarter of the case's, half of it, the case's, twice that and so on
    #[arg(long, value_name = "COUNT", default_value_t = 4, value_parser = clap::value_parser!(u32).range(3..=6))]
    meshes: u32,

    /// Folder for the pictures of the experiments
    #[arg(long, value_name = "FOLDER", default_value = "target/experiments")]
    output: PathBuf,

    /// Only this row of the experiments, such as hip
    #[arg(long, value_name = "NAME")]
    row: Option<String>,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Study {
    /// What the text of the paper says, and what its equations give
    Published,
    /// The same state on ever finer meshes, with observed orders
    Convergence,
    /// What others measured or computed, with a picture each; the case is the study's own
    Experiments,
    /// Order of the pressure, formulation, friction on the tissue, the paper's mesh
    Variants,
}

/// A quantity of the tables: name, unit, factor from SI, access.
type Quantity = (&'static str, &'static str, f64, fn(&Outputs) -> f64);

const QUANTITIES: [Quantity; 6] = [
    ("load", "N/m", 1.0, |o| o.load),
    ("solid load", "N/m", 1.0, |o| o.solid_load),
    ("thinnest film", "um", 1e6, |o| o.minimum_film_thickness),
    ("contact length", "mm", 1e3, |o| o.contact_length),
    ("largest fluid pressure", "kPa", 1e-3, |o| o.maximum_fluid_pressure),
    ("friction coefficient", "1", 1.0, |o| o.friction_coefficient),
];

/// Runs a study and prints its table.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let case = arguments.case.load()?;
    let depths = numbers("--depths", Unit::Metre, &arguments.depths)?;
    let (parameters, inputs) = (&case.parameters, &case.inputs);
    print(&match arguments.study {
        Study::Published => published(parameters, inputs)?,
        Study::Convergence => convergence(parameters, inputs, &depths, arguments.meshes)?,
        Study::Experiments => experiments::run(&arguments.output, arguments.row.as_deref())?,
        Study::Variants => variants(parameters, inputs, &depths)?,
    })
}

/// Results at ascending depths; `None` where there is no solution.
fn solve(
    parameters: &Parameters,
    inputs: &Inputs,
    depths: &[f64],
    what: &str,
) -> Result<Vec<Option<Outputs>>, Failure> {
    let points: Vec<Inputs> = depths.iter().map(|d| Inputs { penetration_depth: *d, ..*inputs }).collect();
    let results = Mutex::new(vec![None; depths.len()]);
    let bar = progress(depths.len());
    bar.set_message(what.to_owned());
    sweep::solve(parameters, &points, 1, &|index, result| {
        match result {
            Ok(simulation) => {
                results.lock().unwrap_or_else(PoisonError::into_inner)[index] = Some(simulation.outputs().clone());
            }
            Err(error) => bar.suspend(|| eprintln!("{what}: {error}")),
        }
        bar.inc(1);
        ControlFlow::Continue(())
    })?;
    bar.finish_and_clear();
    Ok(results.into_inner().unwrap_or_else(PoisonError::into_inner))
}

fn mesh_name(parameters: &Parameters) -> String {
    format!("{} x {}", parameters.mesh.columns, parameters.mesh.rows)
}

/// Order and limit of three values on meshes of ratio two, the finest last; no order where they do not approach a limit.
fn richardson([coarse, middle, fine]: [f64; 3]) -> (Option<f64>, f64) {
    let ratio = (middle - coarse) / (fine - middle);
    let order = ratio.log2();
    if !(0.5..=6.0).contains(&order) {
        return (None, fine);
    }
    (Some(order), fine + (fine - middle) / (ratio - 1.0))
}

fn convergence(parameters: &Parameters, inputs: &Inputs, depths: &[f64], meshes: u32) -> Result<String, Failure> {
    let mut names = Vec::new();
    let mut results = Vec::new();
    for level in 0..meshes {
        let mut refined = *parameters;
        let scale = |count: i32| (count << level) / 4;
        (refined.mesh.columns, refined.mesh.rows) = (scale(parameters.mesh.columns), scale(parameters.mesh.rows));
        names.push(mesh_name(&refined));
        results.push(solve(&refined, inputs, depths, &mesh_name(&refined))?);
    }
    let mut text = format!(
        "| d [um] | quantity | {} | order | limit | error of {} |\n|---|---|{}---|---|---|\n",
        names.join(" | "),
        names[2],
        "---|".repeat(names.len())
    );
    for (index, depth) in depths.iter().enumerate() {
        for (name, unit, factor, get) in QUANTITIES {
            let all: Option<Vec<f64>> =
                results.iter().map(|mesh| mesh[index].as_ref().map(|o| factor * get(o))).collect();
            let Some(values) = all else {
                text += &format!("| {} | {name} | not solved |\n", format::number(1e6 * depth, 4));
                continue;
            };
            if values.iter().all(|value| *value == 0.0) {
                continue;
            }
            let [.., a, b, c] = values[..] else { continue };
            let (order, limit) = richardson([a, b, c]);
            let cells: Vec<_> = values.iter().map(|value| format::number(*value, 5)).collect();
            text += &format!(
                "| {} | {name} [{unit}] | {} | {} | {} | {} % |\n",
                format::number(1e6 * depth, 4),
                cells.join(" | "),
                order.map_or("none".into(), |order| format!("{order:.1}")),
                format::number(limit, 5),
                format::number(100.0 * (values[2] / limit - 1.0).abs(), 2)
            );
        }
    }
    Ok(text)
}

fn variants(parameters: &Parameters, inputs: &Inputs, depths: &[f64]) -> Result<String, Failure> {
    let changed = |change: &dyn Fn(&mut Parameters)| {
        let mut variant = *parameters;
        change(&mut variant);
        variant
    };
    let variants = [
        ("as it is", *parameters),
        ("pressure of order 1", changed(&|p| p.pressure_order = 1)),
        ("friction does not load the tissue", changed(&|p| p.boundary_friction_loads_tissue = false)),
        ("`consistent`", changed(&|p| p.formulation = Formulation::Consistent)),
        (
            "the paper's mesh, 300 x 30 equal elements",
            changed(&|p| {
                (p.mesh.columns, p.mesh.rows) = (300, 30);
                (p.mesh.column_grading, p.mesh.row_grading) = (0.0, 0.0);
            }),
        ),
    ];
    let mut results = Vec::new();
    for (name, variant) in &variants {
        results.push(solve(variant, inputs, depths, name)?);
    }
    let heads: Vec<_> = QUANTITIES.iter().map(|(name, unit, ..)| format!("{name} [{unit}]")).collect();
    let mut text = format!("| d [um] | variant | {} |\n|---|---|{}\n", heads.join(" | "), "---|".repeat(heads.len()));
    for (index, depth) in depths.iter().enumerate() {
        for ((name, _), results) in variants.iter().zip(&results) {
            let cell = |(_, _, factor, get): &Quantity| match &results[index] {
                Some(outputs) => format::number(factor * get(outputs), 4),
                None => "not solved".into(),
            };
            let cells: Vec<_> = QUANTITIES.iter().map(cell).collect();
            text += &format!("| {} | {name} | {} |\n", format::number(1e6 * depth, 4), cells.join(" | "));
        }
    }
    Ok(text)
}

/// Depth at which the film vanishes, to a hundredth of a micron, between two whole microns.
fn onset(parameters: &Parameters, inputs: &Inputs) -> Result<String, Failure> {
    let mut step = 1e-6;
    let mut range = (0.0, 40e-6);
    while step > 0.9e-8 {
        let count = ((range.1 - range.0) / step + 0.5) as usize;
        let depths: Vec<f64> = (0..=count).map(|i| range.0 + i as f64 * step).collect();
        let results = solve(parameters, inputs, &depths, "onset")?;
        let touching = results.iter().position(|o| o.as_ref().is_some_and(|o| o.contact_length > 0.0));
        let Some(first) = touching.filter(|first| *first > 0) else { return Ok("not found".into()) };
        range = (depths[first - 1], depths[first]);
        step *= 0.1;
    }
    Ok(format!("{:.2} um", 0.5e6 * (range.0 + range.1)))
}

/// Section 3 of the paper against the states it describes.
fn published(parameters: &Parameters, inputs: &Inputs) -> Result<String, Failure> {
    let micron = |d: f64| d * 1e-6;
    let depths: Vec<f64> = [-1.0, 0.0]
        .into_iter()
        .chain((8..=15).map(f64::from))
        .chain([19.0, 24.0, 48.0, 50.0, 100.0])
        .map(micron)
        .collect();
    let results = solve(parameters, inputs, &depths, "published")?;
    let at = |d: f64, factor: f64, unit: &str, get: fn(&Outputs) -> f64| {
        let index = depths.iter().position(|depth| *depth == micron(d));
        match index.and_then(|i| results[i].as_ref()) {
            Some(outputs) => format!("{} {unit}", format::number(factor * get(outputs), 3)),
            None => "not solved".into(),
        }
    };
    let stresses = |d: f64| {
        [
            at(d, 1e-3, "kPa", |o| o.maximum_fluid_pressure),
            at(d, 1e-3, "kPa", |o| o.maximum_von_mises_stress),
            at(d, 1e-3, "kPa", |o| o.maximum_contact_pressure),
        ]
        .join(", ")
    };
    let solved = || depths.iter().zip(&results).filter_map(|(d, o)| o.as_ref().map(|o| (d, o)));
    let least = solved().min_by(|a, b| a.1.friction_coefficient.total_cmp(&b.1.friction_coefficient));
    let least = least.map_or("not solved".into(), |(d, o)| {
        format!("{} at d = {} um", format::number(o.friction_coefficient, 3), format::number(1e6 * d, 3))
    });
    let friction = |d| at(d, 1.0, "", |o| o.friction_coefficient);
    let rows = [
        ("contact begins at 13 um, in steps of 1 um", format!("film vanishes at {}", onset(parameters, inputs)?)),
        (
            "h_min = 4 um at d = 0",
            format!(
                "h_min = {}, h(x = 0) = {}",
                at(0.0, 1e6, "um", |o| o.minimum_film_thickness),
                at(0.0, 1e6, "um", |o| o.central_film_thickness)
            ),
        ),
        ("least friction coefficient 0.0053, just before contact", least),
        (
            "friction coefficient 0.1 to 0.15 when pressed hard",
            format!("{} at 50 um, {} at 100 um", friction(50.0).trim(), friction(100.0).trim()),
        ),
        ("Figure 4 (d = -1 um): p and Mises 0.5 to 1 kPa", stresses(-1.0)),
        ("Figure 6 (d = 19 um): p and Mises 10 to 20 kPa, full film", stresses(19.0)),
        ("Figure 8 (d = 48 um): p, Mises 50 kPa, S_n 10 kPa", stresses(48.0)),
        ("Figure 10 (d = 100 um): p 60, Mises 85, S_n 40 kPa", stresses(100.0)),
        ("for comparison: d = 24 um", stresses(24.0)),
        ("for comparison: d = 50 um", stresses(50.0)),
        (
            "pressure below ambient after the constriction (d = 19 um)",
            at(19.0, 1e-3, "kPa", |o| o.minimum_fluid_pressure),
        ),
    ];
    let mut text =
        String::from("| the paper's text | its equations: p, Mises, S_n are the largest ones |\n|---|---|\n");
    rows.iter().for_each(|(said, found)| text += &format!("| {said} | {found} |\n"));
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_and_limit_of_a_known_sequence() {
        let value = |h: f64| 3.0 - 0.5 * h.powi(3);
        let (order, limit) = richardson([value(0.4), value(0.2), value(0.1)]);
        assert!((order.unwrap() - 3.0).abs() < 1e-9 && (limit - 3.0).abs() < 1e-12);
        assert_eq!(richardson([1.0, 2.0, 1.5]), (None, 1.5));
        assert_eq!(richardson([1.0, 1.0, 1.0]).0, None);
    }
}
