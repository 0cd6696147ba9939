//! The `.fmu` file: a ZIP archive of the description, the library and what goes with them.
//!
//! Equal input gives equal bytes: the order is fixed, and every entry has the same date.

use std::fs::File;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::error::Error;
use crate::fmi::{MODEL_IDENTIFIER, description, documentation};

const ICON: &[u8] = include_bytes!("../../modelDescription/model.png");
const LICENSE: &str = include_str!("../../LICENSE");
const THIRD_PARTY: &str = include_str!("../../modelDescription/documentation/licenses/third-party.txt");
const REFERENCE_INPUT: &str = include_str!("../../modelDescription/reference/input.csv");
const REFERENCE_RESULT: &str = include_str!("../../modelDescription/reference/result.csv");
const REFERENCE_MANIFEST: &str = include_str!("../../modelDescription/reference/fmi-ls-manifest.xml");
const RESOURCES: &str = "The FMU needs no files beside its library.\n";

/// The shared library that Cargo built together with a program: in the program's folder or in `deps` below it, whichever is
/// newer, because Cargo does not always copy it from there.
pub fn library_beside(program: &Path) -> PathBuf {
    let name = format!("{}cartilage_contact{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let folder = program.parent().unwrap_or(Path::new(""));
    let (beside, below) = (folder.join(&name), folder.join("deps").join(&name));
    let built = |path: &Path| path.metadata().and_then(|data| data.modified()).ok();
    if built(&below) > built(&beside) { below } else { beside }
}

/// Writes the FMU with this library in it, and the folder that `output` is in.
///
/// # Errors
/// [`Error::File`] saying which file is missing or cannot be written, and what to do.
pub fn package(library: &Path, output: &Path) -> Result<(), Error> {
    let bytes = std::fs::read(library).map_err(|error| Error::File {
        path: library.display().to_string(),
        message: format!("the FMU's library is missing ({error}); build it with `cargo build --release`"),
    })?;
    let is_fmu_library = bytes.starts_with(b"\x7fELF\x02") && bytes.windows(10).any(|window| window == b"fmi2DoStep");
    if !is_fmu_library {
        return Err(Error::File {
            path: library.display().to_string(),
            message: "not this FMU's 64-bit Linux library; build it with `cargo build --release`".into(),
        });
    }
    let failed = |error: &dyn std::fmt::Display| Error::File {
        path: output.display().to_string(),
        message: format!("cannot write the FMU: {error}"),
    };
    let archive = archive(&bytes).map_err(|error| failed(&error))?;
    if let Some(folder) = output.parent() {
        std::fs::create_dir_all(folder).map_err(|error| failed(&error))?;
    }
    File::create(output).and_then(|mut file| file.write_all(&archive)).map_err(|error| failed(&error))
}

fn archive(library: &[u8]) -> zip::result::ZipResult<Vec<u8>> {
    let page = documentation::html();
    let reference = "extra/org.fmi-standard.fmi-ls-ref";
    let entries: [(String, &[u8]); 11] = [
        ("modelDescription.xml".into(), description::xml().as_bytes()),
        ("model.png".into(), ICON),
        (format!("binaries/linux64/{MODEL_IDENTIFIER}.so"), library),
        ("documentation/index.html".into(), page.as_bytes()),
        ("documentation/model.png".into(), ICON),
        ("documentation/licenses/license.txt".into(), LICENSE.as_bytes()),
        ("documentation/licenses/third-party.txt".into(), THIRD_PARTY.as_bytes()),
        (format!("{reference}/fmi-ls-manifest.xml"), REFERENCE_MANIFEST.as_bytes()),
        (format!("{reference}/input.csv"), REFERENCE_INPUT.as_bytes()),
        (format!("{reference}/result.csv"), REFERENCE_RESULT.as_bytes()),
        ("resources/README.txt".into(), RESOURCES.as_bytes()),
    ];
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in entries {
        let permissions = if name.ends_with(".so") { 0o755 } else { 0o644 };
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default())
            .unix_permissions(permissions);
        zip.start_file(name, options)?;
        zip.write_all(content)?;
    }
    Ok(zip.finish()?.into_inner())
}
