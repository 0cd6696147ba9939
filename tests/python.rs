//! What needs Python: the importers of `tests/fmi`, and the standard's own C headers, which come with FMPy.
//!
//! The packages of `tests/fmi/requirements.txt` are installed below `target/`, once for each version of that file.
//! To run one test: `cargo test --release --test python -- importers`; or, for one of pytest's, put its name in the
//! variable `PYTEST_ADDOPTS="-k name"`.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use cartilage_contact::fmi::archive;
use cartilage_contact::fmi::boundary::Logger;
use cartilage_contact::fmi::fmi2::fmi2CallbackFunctions;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");
const PROGRAM: &str = env!("CARGO_BIN_EXE_cartilage-contact");

/// Where these tests keep their files: below Cargo's own folder.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn run(command: &mut Command) {
    let status = command.stdin(Stdio::null()).status().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    assert!(status.success(), "{command:?} ended with {status}");
}

/// The virtual environment's Python.
fn python() -> &'static Path {
    static PYTHON: OnceLock<PathBuf> = OnceLock::new();
    PYTHON.get_or_init(|| {
        let requirements = Path::new(ROOT).join("tests/fmi/requirements.txt");
        let wanted = fs::read_to_string(&requirements).unwrap();
        let environment = folder("python");
        let (python, installed) = (environment.join("bin/python"), environment.join("installed.txt"));
        if fs::read_to_string(&installed).unwrap_or_default() != wanted {
            run(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&environment));
            run(Command::new(&python).args(["-m", "pip", "install", "--quiet", "--requirement"]).arg(&requirements));
            fs::write(&installed, wanted).unwrap();
        }
        python
    })
}

#[test]
fn importers_run_the_fmu() {
    let fmu = folder("fmu").join("CartilageLineContact.fmu");
    archive::package(&archive::library_beside(Path::new(PROGRAM)), &fmu).unwrap();
    run(Command::new(python())
        .args(["-m", "pytest", "--verbose", "-p", "no:cacheprovider", "--basetemp"])
        .arg(folder("pytest"))
        .arg(Path::new(ROOT).join("tests/fmi"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("FMU", &fmu));
}

/// The compiler refuses two declarations of one function that differ, and a struct with another layout.
#[test]
fn the_header_agrees_with_that_of_the_standard() {
    let folder = folder("header");
    let config = cbindgen::Config::from_file(Path::new(ROOT).join("cbindgen.toml")).unwrap();
    let bindings = cbindgen::Builder::new()
        .with_config(config)
        .with_src(Path::new(ROOT).join("src/fmi/fmi2.rs"))
        .generate()
        .unwrap();
    bindings.write_to_file(folder.join("CartilageLineContact.h"));
    let header = fs::read_to_string(folder.join("CartilageLineContact.h")).unwrap();
    assert_eq!(header.matches(");\n").count(), 34, "{header}");

    let offsets = [
        ("logger", std::mem::offset_of!(fmi2CallbackFunctions, logger)),
        ("allocateMemory", std::mem::offset_of!(fmi2CallbackFunctions, allocate_memory)),
        ("freeMemory", std::mem::offset_of!(fmi2CallbackFunctions, free_memory)),
        ("stepFinished", std::mem::offset_of!(fmi2CallbackFunctions, step_finished)),
        ("componentEnvironment", std::mem::offset_of!(fmi2CallbackFunctions, component_environment)),
    ];
    let layout: String = offsets
        .iter()
        .map(|(name, offset)| {
            format!("_Static_assert(offsetof(fmi2CallbackFunctions, {name}) == {offset}, \"{name}\");\n")
        })
        .collect();
    let source = format!(
        "#include <stddef.h>\n#include \"fmi2Functions.h\"\n#include \"CartilageLineContact.h\"\n{layout}\
         _Static_assert(sizeof(fmi2CallbackFunctions) == {}, \"callbacks\");\n\
         _Static_assert(sizeof(fmi2CallbackLogger) == {}, \"logger\");\n\
         _Static_assert(sizeof(fmi2Status) == 4 && fmi2Fatal == 4 && fmi2Discard == 2, \"status\");\n\
         _Static_assert(fmi2CoSimulation == 1 && fmi2LastSuccessfulTime == 2 && fmi2Terminated == 3, \"kinds\");\n",
        size_of::<fmi2CallbackFunctions>(),
        size_of::<Logger>(),
    );
    fs::write(folder.join("agree.c"), source).unwrap();
    let standard = Command::new(python())
        .args(["-c", "import fmpy, os; print(os.path.join(os.path.dirname(fmpy.__file__), 'c-code'), end='')"])
        .output()
        .unwrap();
    let standard = String::from_utf8(standard.stdout).unwrap();
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    let compile = |source: &Path| {
        let mut command = Command::new(&compiler);
        command.args(["-std=c11", "-Wall", "-Wextra", "-Wno-enum-int-mismatch", "-Werror", "-fsyntax-only", "-I"]);
        command.arg(&standard).arg("-I").arg(&folder).arg(source).output().unwrap()
    };
    let checked = compile(&folder.join("agree.c"));
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr));

    // The check can fail: one type in one function makes the compiler refuse the header.
    let wrong = header.replace("double communication_step_size", "float communication_step_size");
    assert_ne!(wrong, header);
    fs::write(folder.join("wrong.c"), format!("#include <stddef.h>\n#include \"fmi2Functions.h\"\n{wrong}")).unwrap();
    assert!(!compile(&folder.join("wrong.c")).status.success());
}
