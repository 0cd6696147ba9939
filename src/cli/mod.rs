//! What a person types: one file a subcommand.

mod case;
mod experiments;
mod figures;
mod format;
mod gait;
mod package;
#[cfg(feature = "parquet")]
mod parquet;
mod presets;
mod press_and_release;
mod reduce;
mod sensitivity;
mod solve;
mod stribeck;
mod table;
mod validate;

use std::io::Write;
use std::process::ExitCode;

use cartilage_contact::error::Error;
use clap::{Parser, Subcommand};

const EXAMPLES: &str = "\
Without a command: builds the FMUs (FMI 2.0 and 3.0) into target/fmu, loads one back, presses two layers together from 10 um of clearance to \
30 um past first touch and releases them at 0.2 m/s, and leaves a table (CSV) and a picture (SVG, PNG) beside the FMU.

Signs and units: everything is in SI units. The penetration depth is the approach of the two bones past first touch of \
the undeformed surfaces: negative is clearance, positive presses the layers together. The sliding speed is the sum of \
the two surface speeds, both positive along +x.

Examples:
  cartilage-contact
  cartilage-contact solve --penetration-depth 12e-6 --sliding-speed 0.2
  cartilage-contact solve --case examples/tissue.toml --json
  cartilage-contact solve --set both.shear_modulus=1e6 --set mesh.columns=200
  cartilage-contact solve --preset human_femoral_condyle --penetration-depth 20e-6
  cartilage-contact stribeck --fields=-1e-6,19e-6,48e-6,100e-6
  cartilage-contact sensitivity --depths 0,10e-6,50e-6
  cartilage-contact gait --peak-load 100
  cartilage-contact package --output CartilageLineContact.fmu
  cartilage-contact reduce --depths=-20e-6:60e-6 --speeds 0:0.5 --picture
  cartilage-contact reduce --joint hip --loads 5e3:62e3 --speeds 0.003:0.06
  cartilage-contact solve --help    (every variable with its unit, default and range)

Exit code: 0 done, 1 failed, 2 wrong usage or a mistake in a case.";

#[derive(Parser)]
#[command(name = "cartilage-contact", version, about = "Lubrication of cartilage on cartilage", after_help = EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Solve one steady state and print its loads, friction, film and regime
    Solve(solve::Arguments),
    /// Sweep penetration depth and speed: the Stribeck curve of the paper, its fields, as tables and figures
    Stribeck(stribeck::Arguments),
    /// How load, friction and film answer to changes of each parameter
    Sensitivity(sensitivity::Arguments),
    /// A walking cycle under load control: in time until it repeats, beside quasi-steady
    Gait(gait::Arguments),
    /// Mesh convergence, variants of the model, and what the paper prints, as Markdown tables
    Validate(validate::Arguments),
    /// The presets: their values, sources, and what is uncertain about them, as Markdown
    Presets,
    /// Write the co-simulation FMU, for FMI 2.0 and for FMI 3.0
    Package(package::Arguments),
    /// Make the real-time model of a case, and FMUs that have it
    Reduce(reduce::Arguments),
}

/// Why a command stopped: a mistake of whoever typed it, or something that went wrong.
enum Failure {
    Usage(String),
    Failed(String),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match error {
            Error::Value { .. } | Error::UnknownName { .. } | Error::Case { .. } => Self::Usage(error.to_string()),
            _ => Self::Failed(error.to_string()),
        }
    }
}

/// Does what the arguments of the process say.
pub fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(message) => {
            let _ = message.print();
            return ExitCode::from(message.exit_code() as u8);
        }
    };
    let result = match arguments.command {
        None => press_and_release::run(),
        Some(Command::Solve(arguments)) => solve::run(&arguments),
        Some(Command::Stribeck(arguments)) => stribeck::run(&arguments),
        Some(Command::Sensitivity(arguments)) => sensitivity::run(&arguments),
        Some(Command::Gait(arguments)) => gait::run(&arguments),
        Some(Command::Validate(arguments)) => validate::run(&arguments),
        Some(Command::Presets) => presets::run(),
        Some(Command::Package(arguments)) => package::run(&arguments),
        Some(Command::Reduce(arguments)) => reduce::run(&arguments),
    };
    let (code, message) = match result {
        Ok(()) => return ExitCode::SUCCESS,
        Err(Failure::Failed(message)) => (1, message),
        Err(Failure::Usage(message)) => (2, message),
    };
    eprintln!("error: {message}");
    ExitCode::from(code)
}

/// Prints to standard output; a reader that stops early, such as `head`, is no failure.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::Failed(format!("could not print the result: {error}")))
        }
        _ => Ok(()),
    }
}
