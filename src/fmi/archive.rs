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
use crate::fmi::{MODEL_IDENTIFIER, description, documentation, slim};
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

/// What a library is for: how its bytes begin, the folders of FMI 2 and FMI 3 that are its own, one of FMI 2 that it takes where no
/// other library needs it, and the ending of its file.
///
/// FMI 2 has names for x86 only; version 2.0.5 takes those of FMI 3 for other processors, and importers such as FMPy look under the
/// old name on any processor.
type Platform =
    (fn(&[u8]) -> bool, &'static [&'static str], &'static [&'static str], Option<&'static str>, &'static str);

const PLATFORMS: [Platform; 6] = [
    (|bytes| is_elf(bytes, 0x3e), &["linux64"], &["x86_64-linux"], None, "so"),
    (|bytes| is_elf(bytes, 0xb7), &["aarch64-linux"], &["aarch64-linux"], Some("linux64"), "so"),
    (|bytes| bytes.starts_with(b"MZ"), &["win64"], &["x86_64-windows"], None, "dll"),
    (|bytes| is_mach(bytes, 0x07), &["darwin64"], &["x86_64-darwin"], None, "dylib"),
    (|bytes| is_mach(bytes, 0x0c), &["aarch64-darwin"], &["aarch64-darwin"], Some("darwin64"), "dylib"),
    // Both in one file.
    (
        |bytes| bytes.starts_with(b"\xca\xfe\xba\xbe"),
        &["darwin64", "aarch64-darwin"],
        &["x86_64-darwin", "aarch64-darwin"],
        None,
        "dylib",
    ),
];

fn is_elf(bytes: &[u8], machine: u8) -> bool {
    bytes.starts_with(b"\x7fELF\x02") && bytes.get(18) == Some(&machine)
}

fn is_mach(bytes: &[u8], processor: u8) -> bool {
    bytes.starts_with(&[0xcf, 0xfa, 0xed, 0xfe, processor, 0, 0, 1])
}

/// Name of the entry with the library for this machine, in the FMU of FMI 3.
pub fn binary_of_this_machine() -> String {
    let system = if cfg!(target_os = "macos") { "darwin" } else { std::env::consts::OS };
    let (processor, ending) = (std::env::consts::ARCH, std::env::consts::DLL_EXTENSION);
    format!("binaries/{processor}-{system}/{MODEL_IDENTIFIER}.{ending}")
}

/// What an FMU may have or lack.
#[derive(Default, Clone, Copy)]
pub struct Contents<'a> {
    /// The real-time model.
    pub reduced: Option<&'a ReducedModel>,
    /// Outputs are real scalars only: for importers that know a part of the standard.
    pub slim: bool,
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
    let mut vacant = Vec::new();
    for library in libraries {
        let path = library.display().to_string();
        let bytes = std::fs::read(library).map_err(|error| Error::File {
            path: path.clone(),
            message: format!("the FMU's library is missing ({error}); build it with `cargo build --release`"),
        })?;
        let platform = PLATFORMS.iter().find(|(fits, ..)| fits(&bytes));
        let ours = bytes.windows(10).any(|window| window == b"fmi2DoStep");
        let Some((_, fmi2, fmi3, also, ending)) = platform.filter(|_| ours) else {
            let message = "not a 64-bit library of this FMU; build it with `cargo build --release`".into();
            return Err(Error::File { path, message });
        };
        let entry = |folder: &&str| (format!("binaries/{folder}/{MODEL_IDENTIFIER}.{ending}"), bytes.clone());
        match standard {
            Standard::Fmi2 => {
                binaries.extend(fmi2.iter().map(entry));
                vacant.extend(also.iter().map(entry));
            }
            Standard::Fmi3 => binaries.extend(fmi3.iter().map(entry)),
        }
    }
    vacant.retain(|(name, _)| binaries.iter().all(|(taken, _)| taken != name));
    binaries.extend(vacant);
    Ok(binaries)
}

/// Writes an FMU with these libraries in it, one a platform, with these contents, and the folder that `output` is
/// in. An FMU that is there already is replaced once the new one is whole.
///
/// # Errors
/// [`Error::File`] saying which file is missing or cannot be written, and what to do.
pub fn package(libraries: &[PathBuf], standard: Standard, contents: Contents<'_>, output: &Path) -> Result<(), Error> {
    let binaries = binaries(libraries, standard)?;
    let reduced = contents.reduced.map(ReducedModel::to_bytes).transpose()?;
    let archive = archive(&binaries, standard, reduced.as_deref(), contents.slim)
        .map_err(|error| files::unwritten(output, error))?;
    files::prepare(output)?;
    files::replace(output, &archive)
}

fn archive(
    binaries: &[(String, Vec<u8>)],
    standard: Standard,
    reduced: Option<&[u8]>,
    narrow: bool,
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
    let description = if narrow { slim::slim(standard, &description) } else { description };
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

    /// The entries for libraries of which there are only the first bytes and a name that says whose they are.
    fn binaries(standard: Standard, heads: &[&[u8]]) -> Vec<String> {
        let folder = tempfile::tempdir().unwrap();
        let write = |(index, head): (usize, &&[u8])| {
            let path = folder.path().join(index.to_string());
            std::fs::write(&path, [head, &[0; 32][head.len()..], b"fmi2DoStep"].concat()).unwrap();
            path
        };
        let libraries: Vec<_> = heads.iter().enumerate().map(write).collect();
        let output = folder.path().join("x.fmu");
        package(&libraries, standard, Contents::default(), &output).unwrap();
        let archive = zip::ZipArchive::new(std::fs::File::open(output).unwrap()).unwrap();
        let folders = archive.file_names().map(|name| name.unwrap().into_owned());
        let folders = folders.filter_map(|name| name.strip_prefix("binaries/").map(str::to_owned));
        let mut folders: Vec<_> = folders.map(|name| name.replace("/CartilageLineContact", "")).collect();
        folders.sort();
        folders
    }

    #[test]
    fn every_library_is_where_the_versions_of_fmi_look() {
        const INTEL: &[u8] = b"\x7fELF\x02\x01\x01\0\0\0\0\0\0\0\0\0\x03\0\x3e\0";
        const ARM: &[u8] = b"\x7fELF\x02\x01\x01\0\0\0\0\0\0\0\0\0\x03\0\xb7\0";
        const WINDOWS: &[u8] = b"MZ";
        const UNIVERSAL: &[u8] = b"\xca\xfe\xba\xbe";
        const APPLE_ARM: &[u8] = b"\xcf\xfa\xed\xfe\x0c\0\0\x01";
        let all = [ARM, INTEL, WINDOWS, UNIVERSAL];
        assert_eq!(
            binaries(Standard::Fmi2, &all),
            ["aarch64-darwin.dylib", "aarch64-linux.so", "darwin64.dylib", "linux64.so", "win64.dll"]
        );
        assert_eq!(
            binaries(Standard::Fmi3, &all),
            [
                "aarch64-darwin.dylib",
                "aarch64-linux.so",
                "x86_64-darwin.dylib",
                "x86_64-linux.so",
                "x86_64-windows.dll"
            ]
        );
        assert_eq!(binaries(Standard::Fmi2, &[ARM]), ["aarch64-linux.so", "linux64.so"]);
        assert_eq!(binaries(Standard::Fmi2, &[APPLE_ARM]), ["aarch64-darwin.dylib", "darwin64.dylib"]);
    }
}
