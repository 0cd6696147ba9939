//! `cartilage-contact stribeck`: the states of a case over penetration depth and speed, as a table and as figures.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use cartilage_contact::error::Error;
use cartilage_contact::fields::Fields;
use cartilage_contact::files;
use cartilage_contact::io::case::Case;
use cartilage_contact::io::vtu;
use cartilage_contact::parameters::{Inputs, Value};
use cartilage_contact::sweep;
use cartilage_contact::units::Unit;
use indicatif::{ProgressBar, ProgressStyle};

use super::case::{CaseArguments, numbers};
use super::figures::fields::Picture;
use super::table::Table;
use super::{Failure, figures, format, print};

/// The depths of the paper's Table 2.
const PAPER_DEPTHS: &str = "-10e-6:100e-6:1e-6";

const EXAMPLES: &str = "\
Lists are SI numbers: 0,12e-6,50e-6 or from:to:step, ends included, or both: -10e-6:20e-6:1e-6,30e-6. Everything goes into \
one folder: case.toml (what was solved), stribeck.csv (one row a state, columns named as the FMU's variables; also stribeck.parquet where the program was built with --features parquet), the \
Stribeck figure, and for --fields two figures and two VTU files (for ParaView) a state. A run that was stopped goes on from the table \
in the folder; a folder with another case, or one that another run is writing to, is refused.

Examples:
  cartilage-contact stribeck                                      (Table 2 and Figure 3 of de Boer et al., 2020)
  cartilage-contact stribeck --fields=-1e-6,19e-6,48e-6,100e-6    (and Figures 4 to 11)
  cartilage-contact stribeck --speeds 0.02,0.05,0.1,0.2 --depths 0:40e-6:2e-6 --output target/speeds
  cartilage-contact stribeck --case examples/tissue.toml --output target/tissue";

/// Sweep penetration depth and speed: the Stribeck curve of the paper, its fields, as tables and figures.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    case: CaseArguments,

    /// Penetration depths \[m\]
    #[arg(long, value_name = "LIST", allow_hyphen_values = true, default_value = PAPER_DEPTHS)]
    depths: String,

    /// Sliding speeds \[m/s\]; by default the one of the case
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    speeds: Option<String>,

    /// Penetration depths \[m\] whose fields are drawn and written for ParaView
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    fields: Option<String>,

    /// Folder for everything that is written
    #[arg(long, value_name = "FOLDER", default_value = "target/stribeck")]
    output: PathBuf,

    /// Threads; by default one a processor
    #[arg(long, value_name = "COUNT")]
    threads: Option<usize>,

    /// Solve everything anew, whatever is in the folder
    #[arg(long)]
    fresh: bool,
}

/// Solves what the table does not hold yet, then draws.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let case = arguments.case.load_by_depth()?;
    let depths = numbers("--depths", Unit::Metre, &arguments.depths)?;
    let drawn = arguments.fields.as_deref().map_or(Ok(Vec::new()), |text| numbers("--fields", Unit::Metre, text))?;
    let speeds = match &arguments.speeds {
        Some(text) => numbers("--speeds", Unit::MetrePerSecond, text)?,
        None => vec![case.inputs.sliding_speed],
    };
    let wanted = points(&case, &speeds, depths.iter().chain(&drawn))?;
    let with_fields = |inputs: &Inputs| drawn.contains(&inputs.penetration_depth);

    let table = Table::open(&arguments.output, &case, arguments.fresh)?;
    let missing: Vec<Inputs> = wanted.iter().filter(|p| with_fields(p) || !table.holds(p)).copied().collect();
    let known = wanted.len() - wanted.iter().filter(|p| !table.holds(p)).count();
    if known > 0 {
        print(&format!("{known} of {} states are in {} already.\n", wanted.len(), table.path().display()))?;
    }
    let threads = arguments.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    let solved = solve(&case, &missing, threads, table, &with_fields)?;

    let mut files = vec![solved.table.path().to_owned()];
    files.extend(figures::stribeck::save(
        &arguments.output.join("stribeck"),
        &solved.table,
        2.0 / (case.parameters.upper.curvature() + case.parameters.lower.curvature()),
    )?);
    for fields in &solved.fields {
        files.extend(write_fields(&arguments.output, fields, speeds.len() > 1)?);
    }
    print(&solved.table.summary())?;
    let names: Vec<_> = files.iter().map(|path| format!("  {}\n", path.display())).collect();
    print(&format!("\nWrote\n{}", names.concat()))?;
    match &solved.failures[..] {
        [] => Ok(()),
        failures => Err(Failure::Failed(format!(
            "{} of {} states could not be solved; the others are in the table:\n  {}",
            failures.len(),
            wanted.len(),
            failures.join("\n  ")
        ))),
    }
}

/// All combinations, each once, speed by speed and from apart to pressed.
fn points<'a>(case: &Case, speeds: &[f64], depths: impl Iterator<Item = &'a f64>) -> Result<Vec<Inputs>, Failure> {
    let ascending = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    };
    let depths = ascending(depths.copied().collect());
    let mut points = Vec::new();
    for speed in ascending(speeds.to_vec()) {
        for depth in &depths {
            let mut point = *case;
            point.set("sliding_speed", &Value::Real(speed))?;
            point.set("penetration_depth", &Value::Real(*depth))?;
            points.push(point.inputs);
        }
    }
    Ok(points)
}

/// What came out of a sweep.
struct Solved {
    table: Table,
    fields: Vec<Fields>,
    failures: Vec<String>,
}

fn solve(
    case: &Case,
    points: &[Inputs],
    threads: usize,
    table: Table,
    with_fields: &(dyn Fn(&Inputs) -> bool + Sync),
) -> Result<Solved, Failure> {
    let bar = progress(points.len());
    let solved = Mutex::new(Solved { table, fields: Vec::new(), failures: Vec::new() });
    let unwritten: Mutex<Option<Error>> = Mutex::new(None);
    sweep::solve(&case.parameters, points, threads, &|index, result| {
        let point = &points[index];
        let mut solved = solved.lock().unwrap_or_else(PoisonError::into_inner);
        match result {
            Ok(simulation) => {
                if let Err(error) = solved.table.add(simulation) {
                    *unwritten.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                    return ControlFlow::Break(());
                }
                if with_fields(point) {
                    solved.fields.extend(simulation.fields());
                }
            }
            Err(error) => {
                bar.suspend(|| eprintln!("failed: {error}"));
                solved.failures.push(error.to_string());
            }
        }
        bar.set_message(format!("d = {} um", format::number(1e6 * point.penetration_depth, 4)));
        bar.inc(1);
        ControlFlow::Continue(())
    })?;
    bar.finish_and_clear();
    if let Some(error) = unwritten.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error.into());
    }
    let mut solved = solved.into_inner().unwrap_or_else(PoisonError::into_inner);
    solved.table.finish()?;
    let key = |fields: &Fields| (fields.inputs.sliding_speed, fields.inputs.penetration_depth);
    solved.fields.sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal));
    Ok(solved)
}

/// A bar with rate and time left.
pub fn progress(count: usize) -> ProgressBar {
    let bar = ProgressBar::new(count as u64);
    if let Ok(style) = ProgressStyle::with_template("{msg:14} {bar:40} {pos}/{len} states, {per_sec}, {eta} left") {
        bar.set_style(style);
    }
    // Drawn again with every state: a clock of its own would be a thread, and the program ends where the system refuses one.
    bar.tick();
    bar
}

/// Pictures and VTU files of one state.
fn write_fields(folder: &Path, fields: &Fields, several_speeds: bool) -> Result<Vec<PathBuf>, Error> {
    let mut state = format!("{}um", format::number(1e6 * fields.inputs.penetration_depth, 6));
    if several_speeds {
        state += &format!("_{}m_s", format::number(fields.inputs.sliding_speed, 6));
    }
    let mut files = Vec::new();
    for (name, picture) in [("bodies", Picture::Bodies), ("interface", Picture::Interface)] {
        files.extend(figures::fields::save(&folder.join(format!("{name}_{state}")), fields, picture)?);
    }
    for (name, text) in [("bodies", vtu::bodies(fields)), ("interface", vtu::interface(&fields.interface))] {
        let path = folder.join(format!("{name}_{state}.vtu"));
        files::replace(&path, text.as_bytes())?;
        files.push(path);
    }
    Ok(files)
}
