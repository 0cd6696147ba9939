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

use cartilage_contact::fmi::archive::{self, Contents};
use cartilage_contact::fmi::boundary::Logger;
use cartilage_contact::fmi::fmi2::fmi2CallbackFunctions;
use cartilage_contact::fmi::fmi3::{fmi3Boolean, fmi3LogMessageCallback};
use cartilage_contact::fmi::standard::Standard;
use cartilage_contact::parameters::{Mesh, Parameters};
use cartilage_contact::reduced::{Range, ReducedModel, Tolerance};

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

/// On few elements, over a small range: what `tests/fmi/test_reduced.py` asks for.
fn reduced_model() -> ReducedModel {
    let mesh = Mesh { columns: 60, rows: 2, ..Parameters::default().mesh };
    let sector_half_angle = std::f64::consts::PI / 72.0;
    let parameters = Parameters { mesh, sector_half_angle, ..Parameters::default() };
    let range = Range { pressed: [-12e-6, 12e-6], speeds: [0.15, 0.25], slide_to_roll_ratio: 0.0 };
    let tolerance =
        Tolerance { load: 0.02, minimum_film_thickness: 0.05, friction_coefficient: 0.05, fluid_pressure: 0.1 };
    ReducedModel::build(&parameters, range, tolerance, 2, &|_| ()).unwrap()
}

#[test]
fn importers_run_the_fmus() {
    let fmu = folder("fmu").join("CartilageLineContact.fmu");
    let libraries = [archive::library_beside(Path::new(PROGRAM))];
    let [_, fmi3] = archive::outputs(&fmu);
    let reduced = reduced_model();
    let contents = Contents { reduced: Some(&reduced), slim: false };
    archive::package(&libraries, Standard::Fmi2, contents, &fmu).unwrap();
    archive::package(&libraries, Standard::Fmi3, contents, &fmi3).unwrap();
    let slim = Contents { reduced: None, slim: true };
    let narrow = [fmu.with_file_name("slim.fmu"), fmu.with_file_name("slim.fmi3.fmu")];
    archive::package(&libraries, Standard::Fmi2, slim, &narrow[0]).unwrap();
    archive::package(&libraries, Standard::Fmi3, slim, &narrow[1]).unwrap();
    run(Command::new(python())
        .args(["-m", "pytest", "--verbose", "-p", "no:cacheprovider", "--basetemp"])
        .arg(folder("pytest"))
        .arg(Path::new(ROOT).join("tests/fmi"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("FMU", &fmu)
        .env("FMU3", &fmi3)
        .env("SLIM", &narrow[0])
        .env("SLIM3", &narrow[1]));
}

/// In an environment of its own, with nothing of this repository but the built package; and the documentation site, whose notebook needs
/// it.
#[test]
fn the_python_package_installs_and_runs() {
    let built = folder("built");
    for path in [PathBuf::from(PROGRAM), archive::library_beside(Path::new(PROGRAM))] {
        fs::copy(&path, built.join(path.file_name().unwrap())).unwrap();
    }
    run(Command::new(PROGRAM).args(["package", "--output"]).arg(built.join("CartilageLineContact.fmu")));
    let environment = folder("package");
    let python = environment.join("bin/python");
    run(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&environment));
    run(Command::new(&python)
        .args(["-m", "pip", "install", "--quiet", "pytest"])
        .arg(format!("{ROOT}[tables,docs]"))
        .env("CARTILAGE_CONTACT_BUILT", &built));
    let path = format!("{}:{}", environment.join("bin").display(), std::env::var("PATH").unwrap_or_default());
    run(Command::new(&python)
        .args([
            "-m",
            "pytest",
            "--verbose",
            "-p",
            "no:cacheprovider",
            "--doctest-modules",
            "--pyargs",
            "cartilage_contact",
        ])
        .arg(Path::new(ROOT).join("python/tests"))
        .arg(Path::new(ROOT).join("docs/test_site.py"))
        .current_dir(&environment)
        .env("PATH", path)
        .env("PYTHONDONTWRITEBYTECODE", "1"));
}

/// A header of our functions, as cbindgen reads them from these sources.
fn header(name: &str, standard: &str, sources: &[&str]) -> String {
    let mut config = cbindgen::Config::from_file(Path::new(ROOT).join("cbindgen.toml")).unwrap();
    config.includes = vec![standard.to_owned()];
    let builder = sources.iter().fold(cbindgen::Builder::new().with_config(config), |builder, source| {
        builder.with_src(Path::new(ROOT).join("src/fmi").join(source))
    });
    let path = folder("header").join(name);
    builder.generate().unwrap().write_to_file(&path);
    fs::read_to_string(path).unwrap()
}

/// Whether the compiler takes this text together with the standard's headers.
fn compiles(name: &str, text: &str) -> Result<(), String> {
    static STANDARD: OnceLock<String> = OnceLock::new();
    let standard = STANDARD.get_or_init(|| {
        let script = "import fmpy, os; print(os.path.join(os.path.dirname(fmpy.__file__), 'c-code'), end='')";
        String::from_utf8(Command::new(python()).args(["-c", script]).output().unwrap().stdout).unwrap()
    });
    let source = folder("header").join(name);
    fs::write(&source, text).unwrap();
    let mut command = Command::new(std::env::var("CC").unwrap_or_else(|_| "cc".into()));
    command.args(["-std=c11", "-Wall", "-Wextra", "-Wno-enum-int-mismatch", "-Wno-strict-prototypes", "-Werror"]);
    command.args(["-fsyntax-only", "-I", standard, "-I"]).arg(folder("header")).arg(source);
    let output = command.output().unwrap();
    if output.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&output.stderr).into_owned()) }
}

/// The compiler refuses two declarations of one function that differ, and a struct with another layout.
#[test]
fn the_header_agrees_with_that_of_fmi2() {
    let functions = header("CartilageLineContact2.h", "fmi2Functions.h", &["fmi2.rs"]);
    let refused = header("CartilageLineContact2ModelExchange.h", "fmi2Functions.h", &["fmi2/model_exchange.rs"]);
    let header = functions + &refused.replace("CARTILAGE_LINE_CONTACT_H", "MODEL_EXCHANGE_H");
    assert_eq!(header.matches(");\n").count(), 44, "{header}");

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
        "#include <stddef.h>\n#include \"fmi2Functions.h\"\n{header}{layout}\
         _Static_assert(sizeof(fmi2CallbackFunctions) == {}, \"callbacks\");\n\
         _Static_assert(sizeof(fmi2CallbackLogger) == {}, \"logger\");\n\
         _Static_assert(sizeof(fmi2Status) == 4 && fmi2Fatal == 4 && fmi2Discard == 2, \"status\");\n\
         _Static_assert(fmi2CoSimulation == 1 && fmi2LastSuccessfulTime == 2 && fmi2Terminated == 3, \"kinds\");\n",
        size_of::<fmi2CallbackFunctions>(),
        size_of::<Logger>(),
    );
    compiles("agree2.c", &source).unwrap();

    // The check can fail: one type in one function makes the compiler refuse the header.
    let wrong = header.replace("double communication_step_size", "float communication_step_size");
    assert_ne!(wrong, header);
    assert!(compiles("wrong2.c", &format!("#include <stddef.h>\n#include \"fmi2Functions.h\"\n{wrong}")).is_err());
}

#[test]
fn the_header_agrees_with_that_of_fmi3() {
    let sources = ["fmi3.rs", "fmi3/other_types.rs", "fmi3/absent.rs"];
    let headers = sources.map(|source| {
        let name = source.replace('/', "_").replace(".rs", ".h");
        header(&name, "fmi3Functions.h", &[source]).replace("CARTILAGE_LINE_CONTACT_H", &name.replace('.', "_"))
    });
    let header = headers.concat();
    assert_eq!(header.matches(");\n").count(), 75, "{header}");
    let source = format!(
        "#include <stddef.h>\n#include \"fmi3Functions.h\"\n{header}\
         _Static_assert(sizeof(fmi3Boolean) == {} && sizeof(fmi3Clock) == {}, \"bool\");\n\
         _Static_assert(sizeof(fmi3LogMessageCallback) == {}, \"logger\");\n\
         _Static_assert(sizeof(fmi3Status) == 4 && fmi3Fatal == 4 && fmi3Discard == 2, \"status\");\n",
        size_of::<fmi3Boolean>(),
        size_of::<fmi3Boolean>(),
        size_of::<fmi3LogMessageCallback>(),
    );
    compiles("agree3.c", &source).unwrap();

    let wrong = source.replace("double communication_step_size", "float communication_step_size");
    assert_ne!(wrong, source);
    assert!(compiles("wrong3.c", &wrong).is_err());
}
