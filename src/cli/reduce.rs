//! `cartilage-contact reduce`: FMUs with the real-time model of a case.

use std::path::{Path, PathBuf};

use cartilage_contact::parameters::Control;
use cartilage_contact::reduced::{Progress, Range, ReducedModel, Tolerance};

use super::case::CaseArguments;
use super::figures::reduced;
use super::package::{DEFAULT_OUTPUT, package, prepare};
use super::stribeck::progress;
use super::{Failure, print};

const ABOUT: &str = "\
The real-time model is a table of solved steady states over penetration depth and sliding speed, or over load and sliding speed with --loads, at \
the slide-to-roll ratio of the case. It is refined until it meets other states of the full model: load (with --loads the depth) within 1 %, least \
film thickness and (away from first touch) friction within 2 %, pressure profile within 3 %. What is reached is printed, and the FMU logs it. Set \
`fidelity` = reduced in the FMU to use it; the other parameters have to be those of the case.

  cartilage-contact reduce --depths=-20e-6:60e-6 --speeds 0:0.5 --picture
  cartilage-contact reduce --joint hip --loads 5e3:62e3 --speeds 0.003:0.06";

/// Make the real-time model of a case, and FMUs that have it.
#[derive(clap::Args)]
#[command(after_help = ABOUT)]
pub struct Arguments {
    #[command(flatten)]
    case: CaseArguments,

    /// Least and largest penetration depth \[m\]
    #[arg(long, value_name = "LEAST:MOST", allow_hyphen_values = true, default_value = "-20e-6:60e-6")]
    depths: String,

    /// Least and largest applied load \[N/m\]: the load is given then, and not the depth
    #[arg(long, value_name = "LEAST:MOST", conflicts_with = "depths")]
    loads: Option<String>,

    /// Slowest and fastest sliding speed in either direction \[m/s\]; 0 for rest; below a slowest speed above 0 its state is held
    #[arg(long, value_name = "SLOWEST:FASTEST", default_value = "0:0.5")]
    speeds: String,

    /// Threads; by default one a processor
    #[arg(long, value_name = "COUNT")]
    threads: Option<usize>,

    /// A shared library to put in, one a platform; by default the one that was built together with this program
    #[arg(long, value_name = "PATH")]
    library: Vec<PathBuf>,

    /// Where to write the FMU of FMI 2.0; that of FMI 3.0 goes beside it (.fmi3.fmu)
    #[arg(long, value_name = "PATH", default_value = DEFAULT_OUTPUT)]
    output: PathBuf,

    /// Draw the errors: how many states are how far off, and where they are; beside the FMU (_errors.svg, _errors.png)
    #[arg(long)]
    picture: bool,
}

/// Makes the table, says how good it is, and packs it.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut case = arguments.case.load()?;
    let pressed = match (&arguments.loads, case.parameters.control) {
        (Some(loads), _) => pair("--loads", loads)?,
        (None, Control::Depth) => pair("--depths", &arguments.depths)?,
        (None, Control::Load) => {
            let message = "control = load: give --loads, such as --loads 5e3:60e3, or --set control=depth";
            return Err(Failure::Usage(message.into()));
        }
    };
    if arguments.loads.is_some() {
        case.parameters.control = Control::Load;
    }
    let range = Range {
        pressed,
        speeds: pair("--speeds", &arguments.speeds)?,
        slide_to_roll_ratio: case.inputs.slide_to_roll_ratio,
    };
    let threads = arguments.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    prepare(&arguments.library, &arguments.output)?;
    let bar = progress(0);
    let tolerance = Tolerance::default();
    let model = ReducedModel::build(&case.parameters, range, tolerance, threads, &|Progress { solved, planned }| {
        bar.set_length(planned as u64);
        bar.set_position(solved as u64);
    });
    bar.finish_and_clear();
    let model = model?;
    let missed = match (model.keeps(&tolerance), case.parameters.surface_roughness > 0.0) {
        (true, _) => "",
        (false, false) => {
            "It misses what is asked of it (see --help): on a mesh as coarse as this the film closes element by element.\n"
        }
        (false, true) => {
            "It misses what is asked of it (see --help), as --picture shows: where a film lifts rough surfaces apart all changes within a few per cent of \
             the speed.\n"
        }
    };
    let mut written = package(&arguments.library, Some(&model), &arguments.output)?.to_vec();
    if arguments.picture {
        written.extend(reduced::save(&beside(&written[0]), &model, &tolerance)?);
    }
    let written: String = written.iter().map(|path| format!("  {}\n", path.display())).collect();
    print(&format!("{model}\n{missed}\nWrote\n{written}"))
}

/// Where the picture goes, without an extension.
fn beside(output: &Path) -> PathBuf {
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    output.with_file_name(format!("{stem}_errors"))
}

fn pair(flag: &str, text: &str) -> Result<[f64; 2], Failure> {
    let numbers: Option<Vec<f64>> = text.split(':').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some([first, last]) => Ok([*first, *last]),
        _ => Err(Failure::Usage(format!("{flag} {text}: give two numbers, such as {flag}=-20e-6:60e-6"))),
    }
}
