//! `cartilage-contact package`: the FMU as a file.

use std::path::{Path, PathBuf};

use cartilage_contact::fmi::archive;

use super::{Failure, print};

/// Where the FMU is written if nothing else is asked for.
pub const DEFAULT_OUTPUT: &str = "target/fmu/CartilageLineContact.fmu";

/// Write the co-simulation FMU (FMI 2.0).
#[derive(clap::Args)]
pub struct Arguments {
    /// The shared library to put in; by default the one that was built together with this program
    #[arg(long, value_name = "PATH")]
    library: Option<PathBuf>,

    /// Where to write the FMU
    #[arg(long, value_name = "PATH", default_value = DEFAULT_OUTPUT)]
    output: PathBuf,
}

/// Packs and prints where the FMU is.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    package(arguments.library.as_deref(), &arguments.output)?;
    print(&format!("{}\n", arguments.output.display()))
}

/// Writes the FMU, and the folder it goes into if that is missing.
pub fn package(library: Option<&Path>, output: &Path) -> Result<(), Failure> {
    let library = match library {
        Some(path) => path.to_owned(),
        None => archive::library_beside(&std::env::current_exe().map_err(|error| {
            Failure::Failed(format!(
                "could not find out where this program is: {error}; name the library with --library"
            ))
        })?),
    };
    Ok(archive::package(&library, output)?)
}
