//! `cartilage-contact sensitivity`: how load, friction and film answer to changes of each parameter.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use cartilage_contact::error::Error;
use cartilage_contact::files::{self, OutputFolder, unwritten};
use cartilage_contact::io::case::Case;
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Inputs, Value};
use cartilage_contact::units::Unit;
use cartilage_contact::{sweep, variables};

use super::case::{CaseArguments, numbers};
use super::figures::tornado::{RESULTS, Response};
use super::stribeck::progress;
use super::{Failure, figures, format, print};

const EXAMPLES: &str = "\
Each parameter is changed alone (of both bodies together), down and up by the same fraction, as far as its range allows. \
The folder gets sensitivity.csv, one row a change and depth, and a tornado plot.

Examples:
  cartilage-contact sensitivity
  cartilage-contact sensitivity --change 0.05 --depths 0,5e-6,20e-6 --case examples/tissue.toml";

/// How load, friction and film answer to changes of each parameter.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    case: CaseArguments,

    /// Penetration depths \[m\]: a list, or from:to:step
    #[arg(long, value_name = "LIST", allow_hyphen_values = true, default_value = "0,10e-6,50e-6")]
    depths: String,

    /// Relative change of each parameter
    #[arg(long, value_name = "FRACTION", default_value_t = 0.2)]
    change: f64,

    /// Folder for everything that is written
    #[arg(long, value_name = "FOLDER", default_value = "target/sensitivity")]
    output: PathBuf,

    /// Threads; by default one a processor
    #[arg(long, value_name = "COUNT")]
    threads: Option<usize>,
}

/// What is varied: the name in a case, and what people call it.
const VARIED: [(&str, &str); 11] = [
    ("both.outer_radius", "radius"),
    ("both.thickness", "thickness"),
    ("both.shear_modulus", "shear modulus"),
    ("both.bulk_modulus", "bulk modulus"),
    ("both.permeability", "permeability"),
    ("both.biot_coefficient", "Biot coefficient"),
    ("sliding_speed", "sliding speed"),
    ("viscosity", "viscosity"),
    ("fluid_compressibility", "compressibility"),
    ("boundary_friction_coefficient", "boundary friction"),
    ("sector_half_angle", "sector angle"),
];

fn results(outputs: &Outputs) -> [f64; 3] {
    [outputs.load, outputs.friction_coefficient, outputs.minimum_film_thickness]
}

/// Solves every change, writes table and plot, prints the table.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let case = arguments.case.load_by_depth()?;
    let mut depths = numbers("--depths", Unit::Metre, &arguments.depths)?;
    depths.sort_by(f64::total_cmp);
    let change = arguments.change;
    if !(1e-6..=0.9).contains(&change) {
        return Err(Error::value("--change", change, "a fraction from 1e-6 to 0.9, such as 0.2 for 20 %").into());
    }
    let threads = arguments.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    let folder = OutputFolder::open(&arguments.output)?;
    let responses = responses(&case, &depths, change, threads)?;

    let csv = folder.path().join("sensitivity.csv");
    let text = to_csv(&depths, &responses).map_err(|error| unwritten(&csv, error))?;
    files::replace(&csv, &text)?;
    let [svg, png, pdf] = figures::tornado::save(&folder.path().join("sensitivity"), &depths, &responses)?;
    print(&table(&depths, &responses))?;
    print(&format!("\nWrote {}, {}, {} and {}\n", csv.display(), svg.display(), png.display(), pdf.display()))
}

/// The case with one parameter multiplied by 1 + change, or as much as is allowed, and by what it was multiplied; `None` where
/// nothing changes.
fn changed(case: &Case, name: &str, change: f64) -> Result<Option<(Case, f64)>, Failure> {
    let variable = variables::find(&name.replace("both.", "upper."))?;
    let Value::Real(value) = variable.given(&case.parameters, &case.inputs) else { return Ok(None) };
    let (least, most) = variable.range().unwrap_or((f64::MIN, f64::MAX));
    let target = (value * (1.0 + change)).clamp(least, most);
    if target == value {
        return Ok(None);
    }
    let mut result = *case;
    result.set(name, &Value::Real(target))?;
    Ok(Some((result, target / value - 1.0)))
}

fn responses(case: &Case, depths: &[f64], change: f64, threads: usize) -> Result<Vec<Response>, Failure> {
    let mut cases = vec![("", "", 0.0, *case)];
    for (name, label) in VARIED {
        for change in [-change, change] {
            if let Some((varied, change)) = changed(case, name, change)? {
                cases.push((name, label, change, varied));
            }
        }
    }
    let bar = progress(cases.len() * depths.len());
    let solved = Mutex::new(vec![vec![[f64::NAN; 3]; depths.len()]; cases.len()]);
    let next = Mutex::new(0..cases.len());
    let trouble: Mutex<Option<Error>> = Mutex::new(None);
    let work = || {
        loop {
            // Not in a `while let`, which would hold the lock while the case is solved.
            let index = next.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some(index) = index else { break };
            let (_, label, change, case) = &cases[index];
            let points: Vec<_> = depths.iter().map(|d| Inputs { penetration_depth: *d, ..case.inputs }).collect();
            let result = sweep::solve(&case.parameters, &points, 1, &|point, result| {
                match result {
                    Ok(simulation) => {
                        let mut solved = solved.lock().unwrap_or_else(PoisonError::into_inner);
                        solved[index][point] = results(simulation.outputs());
                    }
                    Err(error) => bar.suspend(|| eprintln!("failed: {label} {}: {error}", percent(*change))),
                }
                bar.inc(1);
                ControlFlow::Continue(())
            });
            if let Err(error) = result {
                *trouble.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
            }
        }
    };
    std::thread::scope(|scope| {
        // Where the system refuses a thread, the others do its work.
        for _ in 1..threads {
            drop(sweep::spawn(scope, work));
        }
        work();
    });
    bar.finish_and_clear();
    if let Some(error) = trouble.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error.into());
    }
    let solved = solved.into_inner().unwrap_or_else(PoisonError::into_inner);
    let relative = |new: f64, old: f64| if old == 0.0 { f64::NAN } else { new / old - 1.0 };
    let of = |index: usize| -> Vec<[f64; 3]> {
        let pairs = solved[index].iter().zip(&solved[0]);
        pairs.map(|(new, old)| std::array::from_fn(|k| relative(new[k], old[k]))).collect()
    };
    Ok((1..cases.len())
        .map(|index| {
            let (parameter, label, change, _) = cases[index];
            Response { parameter, label, change, results: of(index) }
        })
        .collect())
}

fn percent(fraction: f64) -> String {
    if fraction.is_nan() { "-".into() } else { format!("{:+.1} %", 100.0 * fraction) }
}

fn to_csv(depths: &[f64], responses: &[Response]) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let names = RESULTS.map(|(name, _)| format!("{name}_relative_change"));
    let head = ["parameter", "relative_change", "penetration_depth"].map(str::to_owned);
    writer.write_record(head.iter().chain(&names))?;
    for response in responses {
        for (depth, results) in depths.iter().zip(&response.results) {
            let numbers = [format!("{:.6}", response.change), format!("{depth:e}")];
            // A result that has no relative change has an empty cell.
            let cells = results.map(|r| if r.is_nan() { String::new() } else { format!("{r:.9}") });
            writer.write_record([response.parameter.to_owned()].iter().chain(&numbers).chain(&cells))?;
        }
    }
    writer.into_inner().map_err(|error| error.into_error().into())
}

/// The table as Markdown.
fn table(depths: &[f64], responses: &[Response]) -> String {
    let heads: Vec<_> = RESULTS
        .iter()
        .flat_map(|(_, label)| depths.iter().map(move |d| format!("{label}, {} um", format::number(1e6 * d, 4))))
        .collect();
    let mut text = format!("| parameter | change | {} |\n|---|---|{}\n", heads.join(" | "), "---|".repeat(heads.len()));
    for response in responses {
        let cells: Vec<_> =
            (0..RESULTS.len()).flat_map(|k| response.results.iter().map(move |r| percent(r[k]))).collect();
        text += &format!("| {} | {} | {} |\n", response.label, percent(response.change), cells.join(" | "));
    }
    text
}
