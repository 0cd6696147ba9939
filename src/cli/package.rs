//! `cartilage-contact package`: the FMU as files, one a version of FMI.

use std::path::{Path, PathBuf};

use cartilage_contact::files;
use cartilage_contact::fmi::archive::{self, Contents};
use cartilage_contact::fmi::standard::Standard;
use cartilage_contact::reduced::ReducedModel;

use super::{Failure, print};

/// Where the FMU of FMI 2.0 is written if nothing else is asked for.
pub const DEFAULT_OUTPUT: &str = "target/fmu/CartilageLineContact.fmu";

/// Write the co-simulation FMU for FMI 2.0, and beside it that for FMI 3.0 (.fmi3.fmu).
#[derive(clap::Args)]
pub struct Arguments {
    /// A shared library to put in, one a platform; by default the one that was built together with this program
    #[arg(long, value_name = "PATH")]
    library: Vec<PathBuf>,

    /// Where to write the FMU of FMI 2.0
    #[arg(long, value_name = "PATH", default_value = DEFAULT_OUTPUT)]
    output: PathBuf,

    /// Outputs are real scalars only: for tools that read no arrays, integers and choices
    #[arg(long)]
    slim: bool,
}

/// Packs and prints where the FMUs are.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let contents = Contents { slim: arguments.slim, ..Contents::default() };
    let [fmi2, fmi3] = write(&arguments.library, contents, &arguments.output)?;
    print(&format!("{}\n{}\n", fmi2.display(), fmi3.display()))
}

/// The libraries to pack: those that were named, or the one beside this program.
fn packed(libraries: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    if !libraries.is_empty() {
        return Ok(libraries.to_vec());
    }
    let program = std::env::current_exe().map_err(|error| {
        Failure::Failed(format!("could not find out where this program is: {error}; name the library with --library"))
    })?;
    Ok(vec![archive::library_beside(&program)])
}

/// Sees that both FMUs can be packed and written, before anything is computed for them.
pub fn prepare(libraries: &[PathBuf], output: &Path) -> Result<(), Failure> {
    archive::binaries(&packed(libraries)?, Standard::Fmi2)?;
    Ok(archive::outputs(output).iter().try_for_each(|output| files::prepare(output))?)
}

/// Writes both FMUs, and the folder they go into if that is missing; returns where they are.
pub fn package(libraries: &[PathBuf], reduced: Option<&ReducedModel>, output: &Path) -> Result<[PathBuf; 2], Failure> {
    write(libraries, Contents { reduced, ..Contents::default() }, output)
}

fn write(libraries: &[PathBuf], contents: Contents, output: &Path) -> Result<[PathBuf; 2], Failure> {
    let libraries = packed(libraries)?;
    let outputs = archive::outputs(output);
    archive::package(&libraries, Standard::Fmi2, contents, &outputs[0])?;
    archive::package(&libraries, Standard::Fmi3, contents, &outputs[1])?;
    Ok(outputs)
}
