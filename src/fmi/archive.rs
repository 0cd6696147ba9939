//! The `.fmu` files, one a version of FMI: each a ZIP archive of the description, the library and what goes with them.
//!
//! Equal input gives equal bytes: the order is fixed, and every entry has the same date.

use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::error::Error;
use crate::files;
use crate::fmi::resources::REDUCED_MODEL;
use crate::fmi::standard::Standard;
use crate::fmi::{MODEL_IDENTIFIER, description, documentation};
use crate::reduced::ReducedModel;

const ICON: &[u8] = include_bytes!("../../modelDescription/model.png");
const LICENSE: &str = include_str!("../../LICENSE");
const THIRD_PARTY: &str = include_str!("../../modelDescription/documentation/licenses/third-party.txt");
const REFERENCE_INPUT: &str = include_str!("../../modelDescription/reference/input.csv");
const REFERENCE_RESULT: &str = include_str!("../../modelDescription/reference/result.csv");
const REFERENCE_MANIFEST: &str = include_str!("../../modelDescription/reference/fmi-ls-manifest.xml");
const RESOURCES: &str =
    "reduced_model.bin, where it is here, is the table for fidelity = reduced. Nothing else is needed.\n";

/// The shared library that Cargo built together with a program: in the program's folder or in `deps` below it, whichever is
/// newer, because Cargo does not always copy it from there.
pub fn library_beside(program: &Path) -> PathBuf {
    let name = format!("{}cartilage_contact{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let folder = program.parent().unwrap_or(Path::new(""));
    let (beside, below) = (folder.join(&name), folder.join("deps").join(&name));
    let built = |path: &Path| path.metadata().and_then(|data| data.modified()).ok();
    if built(&below) > built(&beside) { below } else { beside }
}

/// What a library is for: how its bytes begin, the folders that FMI 2 and FMI 3 have for it, and the ending of its file.
type Platform = (fn(&[u8]) -> bool, Option<&'static str>, &'static str, &'static str);

const PLATFORMS: [Platform; 3] = [
    (|bytes| is_elf(bytes, 0x3e), Some("linux64"), "x86_64-linux", "so"),
    // FMI 2 has no name for this one.
    (|bytes| is_elf(bytes, 0xb7), None, "aarch64-linux", "so"),
    (|bytes| bytes.starts_with(b"MZ"), Some("win64"), "x86_64-windows", "dll"),
];

fn is_elf(bytes: &[u8], machine: u8) -> bool {
    bytes.starts_with(b"\x7fELF\x02") && bytes.get(18) == Some(&machine)
}

/// Where the FMUs of FMI 2 and FMI 3 go, beside each other because a file can have only one `modelDescription.xml`; either may be
/// named.
pub fn outputs(output: &Path) -> [PathBuf; 2] {
    const FMI3: &str = "fmi3.fmu";
    let name = output.file_name().unwrap_or_default().to_string_lossy();
    let fmi2 = match name.strip_suffix(FMI3) {
        Some(stem) if stem.len() > 1 && stem.ends_with('.') => output.with_file_name(format!("{stem}fmu")),
        _ => output.to_owned(),
    };
    let fmi3 = fmi2.with_extension(FMI3);
    [fmi2, fmi3]
}

/// The libraries under their names in the archive.
///
/// # Errors
/// [`Error::File`] saying which is missing or none of this FMU, and what to do.
pub fn binaries(libraries: &[PathBuf], standard: Standard) -> Result<Vec<(String, Vec<u8>)>, Error> {
    let mut binaries = Vec::new();
    for library in libraries {
        let path = library.display().to_string();
        let bytes = std::fs::read(library).map_err(|error| Error::File {
            path: path.clone(),
            message: format!("the FMU's library is missing ({error}); build it with `cargo build --release`"),
        })?;
        let platform = PLATFORMS.iter().find(|(fits, ..)| fits(&bytes));
        let ours = bytes.windows(10).any(|window| window == b"fmi2DoStep");
        let Some((_, fmi2, fmi3, ending)) = platform.filter(|_| ours) else {
            let message = "not a 64-bit library of this FMU; build it with `cargo build --release`".into();
            return Err(Error::File { path, message });
        };
        let folder = if standard == Standard::Fmi2 { *fmi2 } else { Some(*fmi3) };
        if let Some(folder) = folder {
            binaries.push((format!("binaries/{folder}/{MODEL_IDENTIFIER}.{ending}"), bytes));
        }
    }
    Ok(binaries)
}

/// Writes an FMU with these libraries in it, one a platform, with the real-time model where there is one, and the folder that `output` is
/// in. An FMU that is there already is replaced once the new one is whole.
///
/// # Errors
/// [`Error::File`] saying which file is missing or cannot be written, and what to do.
pub fn package(
    libraries: &[PathBuf],
    standard: Standard,
    reduced: Option<&ReducedModel>,
    output: &Path,
) -> Result<(), Error> {
    let binaries = binaries(libraries, standard)?;
    let reduced = reduced.map(ReducedModel::to_bytes).transpose()?;
    let archive = archive(&binaries, standard, reduced.as_deref()).map_err(|error| files::unwritten(output, error))?;
    files::prepare(output)?;
    files::replace(output, &archive)
}

fn archive(
    binaries: &[(String, Vec<u8>)],
    standard: Standard,
    reduced: Option<&[u8]>,
) -> zip::result::ZipResult<Vec<u8>> {
    let page = documentation::html();
    let terminals = description::fmi3::terminals();
    let reference = "extra/org.fmi-standard.fmi-ls-ref";
    let (description, icons) = match standard {
        Standard::Fmi2 => (description::fmi2::xml(), vec![("model.png", ICON)]),
        Standard::Fmi3 => {
            let folder = [("terminalsAndIcons/terminalsAndIcons.xml", terminals.as_bytes())];
            (description::fmi3::xml(), [&folder[..], &[("terminalsAndIcons/icon.png", ICON)]].concat())
        }
    };
    let mut entries: Vec<(String, &[u8])> = vec![("modelDescription.xml".into(), description.as_bytes())];
    entries.extend(icons.into_iter().map(|(name, content)| (name.to_owned(), content)));
    entries.extend(binaries.iter().map(|(name, content)| (name.clone(), content.as_slice())));
    entries.extend([
        ("documentation/index.html".into(), page.as_bytes()),
        ("documentation/model.png".into(), ICON),
        ("documentation/licenses/license.txt".into(), LICENSE.as_bytes()),
        ("documentation/licenses/third-party.txt".into(), THIRD_PARTY.as_bytes()),
        (format!("{reference}/fmi-ls-manifest.xml"), REFERENCE_MANIFEST.as_bytes()),
        (format!("{reference}/input.csv"), REFERENCE_INPUT.as_bytes()),
        (format!("{reference}/result.csv"), REFERENCE_RESULT.as_bytes()),
        ("resources/README.txt".into(), RESOURCES.as_bytes()),
    ]);
    entries.extend(reduced.map(|bytes| (format!("resources/{REDUCED_MODEL}"), bytes)));
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in entries {
        let permissions = if name.starts_with("binaries/") { 0o755 } else { 0o644 };
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default())
            .unix_permissions(permissions);
        zip.start_file(name, options)?;
        zip.write_all(content)?;
    }
    Ok(zip.finish()?.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_fmu_may_be_named() {
        for name in ["a.b/x.fmu", "a.b/x.fmi3.fmu"] {
            assert_eq!(outputs(Path::new(name)), ["a.b/x.fmu", "a.b/x.fmi3.fmu"].map(PathBuf::from));
        }
        assert_eq!(outputs(Path::new("fmi3.fmu")), ["fmi3.fmu", "fmi3.fmi3.fmu"].map(PathBuf::from));
    }
}
