//! Files that are made from the sources and committed: they must be what the sources say now.
//!
//! To make them again: `REGENERATE=1 cargo test --release --test package_files`, then look at the difference and commit.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use cartilage_contact::fmi::archive::Contents;
use cartilage_contact::fmi::instance::Instance;
use cartilage_contact::fmi::log::Log;
use cartilage_contact::fmi::standard::Standard;
use cartilage_contact::fmi::{archive, description, documentation};
use cartilage_contact::variables::{Type, VARIABLES, scalar_outputs};

const HOW: &str = "REGENERATE=1 cargo test --release --test package_files";

fn committed(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("modelDescription").join(path)
}

/// The committed text; made anew first, if that was asked for.
fn read_or_write(path: &str, made: &str) -> String {
    let path = committed(path);
    if std::env::var_os("REGENERATE").is_some() {
        std::fs::write(&path, made).unwrap();
    }
    std::fs::read_to_string(&path).unwrap_or_default()
}

#[test]
fn the_model_description_is_that_of_the_table() {
    for (name, made) in [
        ("fmi2.xml", description::fmi2::xml()),
        ("fmi3.xml", description::fmi3::xml()),
        ("terminalsAndIcons.xml", description::fmi3::terminals()),
    ] {
        assert!(read_or_write(name, &made) == made, "modelDescription/{name} is out of date: {HOW}");
    }
}

#[test]
fn equal_input_gives_the_same_bytes() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("same bytes");
    let library = archive::library_beside(Path::new(env!("CARGO_BIN_EXE_cartilage-contact")));
    for standard in [Standard::Fmi2, Standard::Fmi3] {
        let made = ["one", "two"].map(|name| {
            let path = folder.join(name).join("CartilageLineContact.fmu");
            archive::package(std::slice::from_ref(&library), standard, Contents::default(), &path).unwrap();
            std::fs::read(path).unwrap()
        });
        assert!(made[0] == made[1], "{standard:?}");
    }
}

#[test]
fn a_missing_or_foreign_library_is_named_with_what_to_run() {
    let output = Path::new(env!("CARGO_TARGET_TMPDIR")).join("no.fmu");
    for library in ["nowhere/libcartilage_contact.so", "Cargo.toml"] {
        let library = Path::new(env!("CARGO_MANIFEST_DIR")).join(library);
        let message = archive::package(std::slice::from_ref(&library), Standard::Fmi2, Contents::default(), &output)
            .unwrap_err()
            .to_string();
        assert!(
            message.contains(&library.display().to_string()) && message.contains("cargo build --release"),
            "{message}"
        );
        assert!(!output.exists());
    }
}

#[test]
fn every_table_of_the_documentation_is_filled_in() {
    let page = documentation::html();
    assert!(!page.contains("{{"));
    for variable in VARIABLES.iter().filter(|variable| variable.is_scalar()) {
        assert!(page.contains(&format!("<code>{}</code>", variable.name)), "{} is not documented", variable.name);
    }
}

const STEPS: i32 = 10;

fn time(step: i32) -> f64 {
    let (start, stop, _) = description::DEFAULT_EXPERIMENT;
    start + (stop - start) * f64::from(step) / f64::from(STEPS)
}

/// The input of the reference experiment during each step: from 10 micron of clearance to 20 micron of penetration, and back.
const DEPTHS: [f64; STEPS as usize] = [-10e-6, -2.5e-6, 5e-6, 12.5e-6, 20e-6, 20e-6, 12.5e-6, 5e-6, -2.5e-6, -10e-6];

#[test]
fn the_reference_result_is_what_the_fmu_returns() {
    let reference = |name: &str| VARIABLES.iter().find(|variable| variable.name == name).unwrap().reference;
    let outputs: Vec<_> = scalar_outputs().collect();
    let mut instance = Instance::new(Standard::Fmi2, Log::new(false));
    instance.enter_initialization_mode().unwrap();
    let mut input = "time,penetration_depth\n".to_owned();
    let names: Vec<_> = outputs.iter().map(|variable| variable.name).collect();
    let mut result = format!("time,{}\n", names.join(","));
    for step in 0..=STEPS {
        // The input of a row holds during the step that begins there, as FMPy has it.
        if step == 0 {
            instance.set_real(&[reference("penetration_depth")], &[DEPTHS[0]]).unwrap();
            instance.exit_initialization_mode().unwrap();
        } else {
            let depth = DEPTHS[step as usize - 1];
            instance.set_real(&[reference("penetration_depth")], &[depth]).unwrap();
            instance.do_step(time(step - 1), time(step) - time(step - 1)).unwrap();
            writeln!(input, "{:?},{depth:?}", time(step - 1)).unwrap();
        }
        write!(result, "{:?}", time(step)).unwrap();
        for variable in &outputs {
            let reference = [reference(variable.name)];
            match variable.data_type() {
                Type::Real => {
                    let mut value = [f64::NAN];
                    instance.get_real(&reference, &mut value).unwrap();
                    write!(result, ",{:.9e}", value[0]).unwrap();
                }
                Type::Boolean => {
                    let mut value = [false];
                    instance.get_boolean(&reference, &mut value).unwrap();
                    write!(result, ",{}", u8::from(value[0])).unwrap();
                }
                Type::Integer | Type::Enumeration(_) => {
                    let mut value = [0];
                    instance.get_integer(&reference, &mut value).unwrap();
                    write!(result, ",{}", value[0]).unwrap();
                }
            }
        }
        result.push('\n');
    }
    assert!(read_or_write("reference/input.csv", &input) == input, "reference/input.csv is out of date: {HOW}");
    let kept = read_or_write("reference/result.csv", &result);
    assert_eq!(kept.lines().next(), result.lines().next(), "reference/result.csv has other columns: {HOW}");
    assert_eq!(kept.lines().count(), result.lines().count());
    let columns = |text: &str| -> Vec<Vec<f64>> {
        let rows =
            text.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect::<Vec<_>>());
        let rows: Vec<Vec<f64>> = rows.collect();
        (0..rows[0].len()).map(|column| rows.iter().map(|row| row[column]).collect()).collect()
    };
    for (index, (old, new)) in columns(&kept).iter().zip(columns(&result)).enumerate().skip(1) {
        let name = &outputs[index - 1].name;
        // Iterations depend on the rounding of the machine; results do so at the level of Newton's tolerance.
        let largest = old.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let allowed = if *name == "newton_iterations" { 50.0 } else { 1e-4 * largest };
        for (old, new) in old.iter().zip(new) {
            assert!((old - new).abs() <= allowed, "{name} was {old}, is {new}: if that is right, {HOW}");
        }
    }
}

/// Crates in the library, from `cargo metadata`: name and version, licence, where it comes from, folder.
struct Crate {
    name: String,
    license: String,
    repository: String,
    authors: String,
    folder: PathBuf,
}

fn linked_crates() -> Vec<Crate> {
    let cargo = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO"))
            .args(arguments)
            .args(["--offline", "--locked", "--manifest-path"])
            .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml"))
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let target = "x86_64-unknown-linux-gnu";
    let tree = cargo(&[
        "tree",
        "--no-default-features",
        "-e",
        "normal,no-proc-macro",
        "--target",
        target,
        "--prefix",
        "none",
        "--format",
        "{p}",
    ]);
    let mut linked: Vec<String> = tree.lines().map(|line| line.trim_end_matches(" (*)").replace(" v", " ")).collect();
    linked.sort();
    linked.dedup();
    let metadata: serde_json::Value =
        serde_json::from_str(&cargo(&["metadata", "--format-version", "1", "--filter-platform", target])).unwrap();
    let text = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_owned();
    let mut crates = Vec::new();
    for package in metadata["packages"].as_array().unwrap() {
        let name = format!("{} {}", text(&package["name"]), text(&package["version"]));
        if linked.contains(&name) && !package["source"].is_null() {
            let authors: Vec<_> = package["authors"].as_array().unwrap().iter().map(text).collect();
            crates.push(Crate {
                name,
                license: text(&package["license"]),
                repository: text(&package["repository"]),
                authors: authors.join(", "),
                folder: Path::new(&text(&package["manifest_path"])).parent().unwrap().to_owned(),
            });
        }
    }
    crates.sort_by(|a, b| a.name.cmp(&b.name));
    crates
}

/// The licence texts that come with a crate; of several that may be chosen, MIT's.
fn license_texts(folder: &Path) -> Vec<String> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    let named = |path: &Path, part: &str| path.file_name().unwrap().to_string_lossy().to_uppercase().contains(part);
    files
        .retain(|path| path.is_file() && ["LICENSE", "LICENCE", "COPYING", "OFL"].iter().any(|part| named(path, part)));
    if files.iter().any(|path| named(path, "MIT")) {
        files.retain(|path| named(path, "MIT"));
    }
    files.sort();
    files
        .iter()
        .map(|path| String::from_utf8_lossy(&std::fs::read(path).unwrap()).replace('\r', "").trim().to_owned())
        .collect()
}

#[test]
fn every_crate_in_the_library_is_listed_with_its_licence() {
    let crates = linked_crates();
    let mut list = "Free software of others that the library is built from\n\n".to_owned();
    let mut texts: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for entry in &crates {
        let Crate { name, license, repository, authors, folder } = entry;
        writeln!(list, "{name}\n  licence: {license}\n  source:  {repository}").unwrap();
        if !authors.is_empty() {
            writeln!(list, "  authors: {authors}").unwrap();
        }
        let found = license_texts(folder);
        if found.is_empty() {
            writeln!(list, "  (comes without a text of its licence)").unwrap();
        }
        for text in found {
            texts.entry(text).or_default().push(name);
        }
    }
    for (text, names) in &texts {
        let line = "=".repeat(80);
        writeln!(list, "\n{line}\nLicence of {}\n{line}\n\n{text}", names.join(", ")).unwrap();
    }
    let kept = read_or_write("documentation/licenses/third-party.txt", &list);
    let missing: Vec<_> = crates.iter().filter(|entry| !kept.contains(&format!("\n{}\n", entry.name))).collect();
    let missing: Vec<_> = missing.iter().map(|entry| &entry.name).collect();
    assert!(missing.is_empty(), "third-party.txt lacks {missing:?}: {HOW}");
}
