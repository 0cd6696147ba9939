//! `cartilage-contact package`: the FMU as a file.

use std::path::{Path, PathBuf};

use super::{Failure, print};

/// Where the FMU is written if nothing else is asked for.
pub const DEFAULT_OUTPUT: &str = "target/fmu/CartilageLineContact.fmu";

/// Write the co-simulation FMU (FMI 2.0).
#[derive(clap::Args)]
pub struct Arguments {
    /// The shared library to put in; by default the one beside this program
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
        None => library_beside_program()?,
    };
    if !library.is_file() {
        let message = format!(
            "the FMU's library is not there: {}. Build it with `cargo build --release`, or name it with --library PATH",
            library.display()
        );
        return Err(Failure::Failed(message));
    }
    if let Some(folder) = output.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder)
            .map_err(|error| Failure::Failed(format!("could not make the folder {}: {error}", folder.display())))?;
    }
    Err(Failure::Failed("no archive".into()))
}

/// Where `cargo build` leaves the shared library: next to the executable.
fn library_beside_program() -> Result<PathBuf, Failure> {
    let program = std::env::current_exe()
        .map_err(|error| Failure::Failed(format!("could not find out where this program is: {error}")))?;
    let name = format!("{}cartilage_contact{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    Ok(program.with_file_name(name))
}
