//! The command line: what it prints, what it refuses, and with which exit code.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;
use std::process::{Command, Output};

use cartilage_contact::io::case::Case;
use cartilage_contact::parameters::{Formulation, PRESETS, Parameters};
use cartilage_contact::simulation::Simulation;
use cartilage_contact::variables;

/// A small mesh, so that a solution takes no time.
const COARSE: &str = "--set=mesh.columns=24 --set=mesh.rows=3";

fn run(arguments: &str) -> Output {
    run_in(Path::new("."), arguments)
}

fn run_in(folder: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cartilage-contact"))
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .output()
        .unwrap()
}

fn out(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Standard error of a command that has to end with this exit code.
fn refused(arguments: &str, code: i32) -> String {
    let output = run(arguments);
    let message = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments}: {message}{}", out(&output));
    assert_eq!(out(&output), "", "{arguments}: nothing but the message");
    message
}

fn json(arguments: &str) -> serde_json::Map<String, serde_json::Value> {
    let output = run(&format!("solve --json {COARSE} {arguments}"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    match serde_json::from_str(&out(&output)).unwrap() {
        serde_json::Value::Object(object) => object,
        other => panic!("not an object: {other}"),
    }
}

/// A case file in a folder that goes with the returned guard.
fn case_file(text: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.toml");
    std::fs::write(&path, text).unwrap();
    (folder, path.display().to_string())
}

#[test]
fn help_teaches() {
    let text = out(&run("--help"));
    for expected in
        ["solve", "package", "penetration depth", "negative is clearance", "Examples:", "SI units", "Exit code"]
    {
        assert!(text.contains(expected), "{expected}: {text}");
    }
    let text = out(&run("solve --help"));
    for row in variables::VARIABLES.iter().filter(|row| row.is_scalar()) {
        assert!(text.contains(row.name), "{} is missing from `solve --help`", row.name);
    }
    assert!(text.contains("upper.shear_modulus = 500000: a number from 1e2 to 1e10 Pa"), "{text}");
    assert!(out(&run("--version")).starts_with("cartilage-contact "));
}

#[test]
fn json_has_the_names_of_the_variables_and_finite_numbers() {
    let object = json("--penetration-depth=-5e-6");
    for name in ["penetration_depth", "sliding_speed", "slide_to_roll_ratio"] {
        assert!(object[name].is_number(), "{name}");
    }
    for row in variables::scalar_outputs() {
        let value = &object[row.name];
        let expected = match row.name {
            "lubrication_regime" => value.is_string(),
            "well_resolved" => value.is_boolean(),
            _ => value.is_number(),
        };
        assert!(expected, "{} is {value}", row.name);
    }
    for name in ["position", "film_thickness", "fluid_pressure", "contact_pressure"] {
        let stations = object[name].as_array().unwrap();
        assert_eq!(stations.len(), 101, "{name}");
        assert!(stations.iter().all(serde_json::Value::is_number), "{name}");
    }
    assert_eq!(object.len(), 5 + variables::scalar_outputs().count() + 4 + 1);
    assert!(object["warnings"].as_array().unwrap().iter().all(serde_json::Value::is_string));
    assert_eq!(object["penetration_depth"].as_f64(), Some(-5e-6));
}

#[test]
fn flags_win_over_the_case_which_wins_over_defaults() {
    let (_folder, path) = case_file("penetration_depth = -20e-6\nsliding_speed = 0.1\n[both]\nthickness = 1.5e-3");
    let object = json("");
    assert_eq!(object["penetration_depth"].as_f64(), Some(-10e-6));
    assert_eq!(object["sliding_speed"].as_f64(), Some(0.2));
    let object = json(&format!("--case {path}"));
    assert_eq!(object["penetration_depth"].as_f64(), Some(-20e-6));
    assert_eq!(object["sliding_speed"].as_f64(), Some(0.1));
    let object = json(&format!("--case {path} --penetration-depth -15e-6 --set sliding_speed=0.3"));
    assert_eq!(object["penetration_depth"].as_f64(), Some(-15e-6));
    assert_eq!(object["sliding_speed"].as_f64(), Some(0.3));
    let object = json(&format!("--case {path} --set sliding_speed=0.3 --sliding-speed 0.4"));
    assert_eq!(object["sliding_speed"].as_f64(), Some(0.4), "the named flag wins over --set");
}

#[test]
fn a_preset_gives_way_to_the_case_and_to_flags() {
    let (_folder, path) = case_file("preset = \"osteoarthritic\"\nsliding_speed = 0.1\nboth.shear_modulus = 0.4e6");
    let load = |arguments: &str| json(arguments)["load"].as_f64().unwrap();
    let of_flags =
        |preset: &str| load(&format!("--preset {preset} --set both.shear_modulus=0.4e6 --sliding-speed 0.1"));
    assert_eq!(load(&format!("--case {path}")), of_flags("osteoarthritic"));
    assert_eq!(
        load(&format!("--case {path} --preset human_normal")),
        of_flags("human_normal"),
        "the flag's preset wins"
    );
    assert_eq!(load(&format!("--case {path} --set preset=human_normal")), of_flags("human_normal"));
    assert_ne!(of_flags("osteoarthritic"), of_flags("human_normal"));
    let message = refused("solve --preset giraffe", 2);
    assert!(message.contains("giraffe") && message.contains("human_tibial_plateau"), "{message}");
}

#[test]
fn the_page_of_the_presets_has_their_tables() {
    let page = std::fs::read_to_string("docs/presets.md").unwrap();
    let tables = out(&run("presets"));
    for row in PRESETS.iter() {
        assert_eq!(tables.matches(&format!("\n| `{}` |", row.name)).count(), 2, "{}", row.name);
    }
    for line in tables.lines() {
        assert!(page.contains(line), "docs/presets.md lacks what `cartilage-contact presets` prints: {line}");
    }
}

#[test]
fn the_table_shows_every_scalar_with_a_unit_that_people_use() {
    let output = run(&format!("solve {COARSE} --penetration-depth -5e-6"));
    assert!(output.status.success());
    let text = out(&output);
    let line = text.lines().find(|line| line.starts_with("penetration_depth ")).unwrap();
    let words: Vec<_> = line.split_whitespace().collect();
    assert_eq!(&words[..3], ["penetration_depth", "-5", "um"]);
    for row in variables::scalar_outputs() {
        assert!(text.lines().any(|line| line.starts_with(&format!("{} ", row.name))), "{}", row.name);
    }
}

/// `--check` solves what a user would, who sets the finer mesh.
#[test]
fn check_says_how_far_a_finer_mesh_is() {
    let state = "--set mesh.row_grading=2 --penetration-depth 5e-6 --sliding-speed 0.2";
    let coarse = format!("--set mesh.columns=24 --set mesh.rows=5 --set sector_half_angle=0.1 {state}");
    let checked = json(&format!("{coarse} --check"));
    // 2 sqrt(1.5) times as many columns; the sine of the angle is half as large again.
    let sector = (1.5 * 0.1_f64.sin()).asin();
    let by_hand = format!("--set mesh.columns=58 --set mesh.rows=8 --set sector_half_angle={sector:e} {state}");
    let (by_hand, finer) = (json(&by_hand), checked["finer_mesh"].as_object().unwrap());
    for name in ["load", "minimum_film_thickness", "friction_coefficient"] {
        let [coarse, finer, by_hand] = [&checked, finer, &by_hand].map(|object| object[name].as_f64().unwrap());
        assert!((finer / by_hand - 1.0).abs() < 1e-6, "{name}: {finer} {by_hand}");
        assert!((coarse / finer - 1.0).abs() > 1e-4, "{name}: {coarse} {finer}");
    }
    let [coarse_friction, friction] = [&checked, finer].map(|object| object["friction_coefficient"].as_f64().unwrap());
    let apart = 100.0 * (coarse_friction - friction) / coarse_friction.max(friction);

    let output = run(&format!("solve {coarse} --check"));
    assert!(output.status.success());
    let text = out(&output);
    assert!(text.contains("On 58 x 8 elements in place of 24 x 5, and a sector 1.5 times as wide:"), "{text}");
    let line = text.lines().rfind(|line| line.starts_with("friction_coefficient ")).unwrap();
    let shown: f64 = line.trim_end_matches(" %").split_whitespace().next_back().unwrap().parse().unwrap();
    assert!((shown / apart - 1.0).abs() < 0.06 && apart.abs() > 2.0, "{shown} {apart}");
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(errors.contains("warning: friction_coefficient is "), "{errors}");
    assert!(errors.contains("% below that on the finer mesh, 2 % and less is good"), "{errors}");
}

#[test]
fn a_check_that_cannot_be_made_loses_nothing() {
    let most = "--set mesh.columns=2000 --set mesh.rows=1 --set sector_half_angle=0.1 --set mesh.row_grading=1";
    let output = run(&format!("solve {most} --penetration-depth -5e-5 --sliding-speed 0.2 --check"));
    assert_eq!(output.status.code(), Some(1));
    assert!(out(&output).lines().any(|line| line.starts_with("load ")));
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(errors.contains("not checked, on 4898 x 1 elements: "), "{errors}");
}

#[test]
fn wrong_usage_is_explained_with_exit_code_2() {
    for (arguments, expected) in [
        (
            "solve --penetration-depth deep",
            "penetration_depth = \"deep\" is not allowed: a number from -1e-2 to 1e-2 m",
        ),
        ("solve --penetration-depth 1um --set both.young_modulus=1MPa", "without upper.poisson_ratio"),
        ("solve --penetration-depth 1", "penetration_depth = 1 is not allowed: a number from -1e-2 to 1e-2 m"),
        ("solve --sliding-speed nan", "sliding_speed = NaN is not allowed: a number from -1e1 to 1e1 m/s"),
        ("solve --set viscosity", "--set viscosity: write it as NAME=VALUE"),
        ("solve --set viscosity=thin", "viscosity = \"thin\" is not allowed: a number from 1e-6 to 1e3 Pa.s"),
        ("solve --set mesh.rows=2.5", "mesh.rows = 2.5 is not allowed: a whole number from 0 to 200"),
        ("solve --set both.thicknes=1e-3", "unknown variable `both.thicknes`; did you mean `both.thickness`?"),
        ("solve --set load=1", "load = 1 is not allowed: it is a result and cannot be set"),
        ("solve --set both.thickness=0.08", "less than half of upper.outer_radius"),
        ("solve --case no/such/case.toml", "no/such/case.toml: could not read the case file"),
        ("sovle", "unrecognized subcommand 'sovle'"),
        ("solve --depth 1e-6", "unexpected argument '--depth'"),
    ] {
        let message = refused(arguments, 2);
        assert!(message.contains(expected), "{arguments}: {message}");
    }
}

#[test]
fn mistakes_in_a_case_are_reported_with_file_line_key_and_what_is_allowed() {
    for (text, expected) in [
        (
            "viscosity = 1e-3\n[upper]\nshear_moduls = 1e6",
            "3: unknown variable `upper.shear_moduls`; did you mean `upper.shear_modulus`?",
        ),
        (
            "\nformulation = \"printed\"",
            "2: formulation = \"printed\" is not allowed: one of \"paper\", \"consistent\"",
        ),
        ("viscosity = \"thin\"", "1: viscosity = \"thin\" is not allowed: a number from 1e-6 to 1e3 Pa.s"),
        ("width = 1.0\n\nviscosity = -1.0", "3: viscosity = -1 is not allowed: a number from 1e-6 to 1e3 Pa.s"),
        ("penetration_depth = 0.5", "1: penetration_depth = 0.5 is not allowed: a number from -1e-2 to 1e-2 m"),
        ("[mesh]\ncolumns = = 3", "2: not valid TOML: "),
    ] {
        let (_folder, path) = case_file(text);
        let message = refused(&format!("solve --case {path}"), 2);
        assert!(message.starts_with(&format!("error: {path}:{expected}")), "{text:?}: {message}");
    }
}

#[test]
fn a_library_that_was_not_built_is_named_with_the_command_that_builds_it() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("x.fmu").display().to_string();
    let message = refused(&format!("package --library no/such/library.so --output {output}"), 1);
    assert!(message.contains("no/such/library.so"), "{message}");
    assert!(message.contains("cargo build --release"), "{message}");
    assert!(!Path::new(&output).exists());
}

#[test]
#[cfg(target_os = "linux")]
fn too_little_memory_is_said_with_the_number() {
    let with = |kilobytes: u32, arguments: &str| {
        let program = env!("CARGO_BIN_EXE_cartilage-contact");
        let command = format!("ulimit -v {kilobytes}; exec {program} {arguments}");
        Command::new("sh").args(["-c", &command]).output().unwrap()
    };
    let output = with(4_000_000, "solve --set mesh.columns=2000 --set mesh.rows=200");
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("mesh.rows = 200 up to 45.8 GB of memory are needed, and 4.1 GB are free"), "{message}");
    // Where it is nearly enough: an answer either way, and never an abort.
    let codes = [45_000, 60_000, 90_000, 130_000, 200_000].map(|kilobytes| {
        with(kilobytes, "solve --set mesh.columns=100 --set mesh.rows=8 --set slide_to_roll_ratio=0.1").status.code()
    });
    assert!(
        codes.iter().all(|code| matches!(code, Some(0..=2))) && codes[0] == Some(2) && codes[4] == Some(0),
        "{codes:?}"
    );
}

#[test]
fn a_solution_is_given_up_when_its_time_is_over() {
    let start = std::time::Instant::now();
    let message = refused("solve --set maximum_solve_time=0.01", 1);
    assert!(message.contains("then maximum_solve_time is over"), "{message}");
    assert!(start.elapsed().as_secs() < 10, "{:?}", start.elapsed());
}

#[test]
fn a_tissue_too_tight_for_the_mesh_is_said_without_trying_for_long() {
    let message = refused(&format!("solve {COARSE} --set both.permeability=1e-24"), 1);
    assert!(message.contains("the mesh does not resolve how the pressure falls in so tight a tissue"), "{message}");
    // As much as a solution on this mesh, some times over; it was a thousand iterations and more.
    let start = std::time::Instant::now();
    refused(&format!("solve {COARSE} --set both.permeability=1e-24 --set maximum_solve_time=5"), 1);
    assert!(start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
}

#[test]
fn what_cannot_be_solved_is_explained_with_exit_code_1() {
    // Deeper than the two layers are thick.
    let message = refused(&format!("solve {COARSE} --penetration-depth 9e-3"), 1);
    assert!(message.starts_with("error: no converged solution at penetration_depth = 9e-3 m"), "{message}");
    assert!(message.contains("reached penetration_depth ="), "{message}");
}

#[test]
fn the_examples_are_cases() {
    let mut names: Vec<_> = std::fs::read_dir("examples")
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    names.sort();
    assert_eq!(names.len(), 6, "{names:?}");
    let cases: Vec<_> = names.iter().map(|path| Case::load(path).unwrap()).collect();
    let [ankle, hip, knee, paper, paper_mesh, tissue] = &cases[..] else { panic!("six cases") };

    assert_eq!(paper.parameters, Parameters::default(), "Table 2 is the default");
    assert_eq!((paper_mesh.parameters.mesh.columns, paper_mesh.parameters.mesh.rows), (300, 30));
    assert_eq!((paper_mesh.parameters.mesh.column_grading, paper_mesh.parameters.mesh.row_grading), (0.0, 0.0));
    assert_eq!(tissue.parameters.formulation, Formulation::Consistent);
    // The closest joint first; the tibia is flat.
    let gap = |case: &Case| case.parameters.upper.curvature() + case.parameters.lower.curvature();
    assert!(gap(hip) < gap(ankle) && gap(ankle) < gap(knee) && knee.parameters.lower.curvature() == 0.0);
    assert_eq!((tissue.parameters.pressure_order, tissue.parameters.lower.permeability), (1, 1e-18));
    for case in &cases {
        Simulation::new(&case.parameters).unwrap();
    }
}

#[test]
fn without_arguments_it_builds_and_drives_the_fmu() {
    let folder = tempfile::tempdir().unwrap();
    let output = run_in(folder.path(), "");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = out(&output);
    for expected in [
        "Built target/fmu/CartilageLineContact.fmu",
        "Built target/fmu/CartilageLineContact.fmi3.fmu",
        "depth",
        "regime",
        "Wrote target/fmu/press_and_release.csv",
    ] {
        assert!(text.contains(expected), "{expected}: {text}");
    }
    let made = folder.path().join("target/fmu");
    let mut table = csv::Reader::from_path(made.join("press_and_release.csv")).unwrap();
    let header: Vec<String> = table.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(header[..4], ["time", "penetration_depth", "sliding_speed", "slide_to_roll_ratio"]);
    for row in variables::scalar_outputs() {
        assert!(header.iter().any(|name| name == row.name), "{} is not in the CSV", row.name);
    }
    let depths: Vec<f64> = table.records().map(|record| record.unwrap()[1].parse().unwrap()).collect();
    assert_eq!(depths.len(), 81);
    assert_eq!((depths[0], depths[40], depths[80]), (-10.0 * 1e-6, 30.0 * 1e-6, -10.0 * 1e-6));
    let [svg, png, pdf] = ["svg", "png", "pdf"]
        .map(|ending| std::fs::read(made.join("press_and_release").with_extension(ending)).unwrap());
    assert!(svg.starts_with(b"<svg") && png.starts_with(b"\x89PNG") && pdf.starts_with(b"%PDF"));
}

#[test]
fn package_writes_both_fmus_and_says_where() {
    let folder = tempfile::tempdir().unwrap();
    let output = run_in(folder.path(), "package --output some/folder/contact.fmu");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let made = ["some/folder/contact.fmu", "some/folder/contact.fmi3.fmu"];
    assert_eq!(out(&output).lines().collect::<Vec<_>>(), made);
    for file in made {
        assert!(std::fs::read(folder.path().join(file)).unwrap().starts_with(b"PK"), "{file}");
    }
}

#[test]
fn either_fmu_may_be_named_and_one_that_is_there_is_replaced_whole() {
    let folder = tempfile::tempdir().unwrap();
    let output = run_in(folder.path(), "package --output x.fmi3.fmu");
    assert_eq!(out(&output).lines().collect::<Vec<_>>(), ["x.fmu", "x.fmi3.fmu"]);
    let good = std::fs::read(folder.path().join("x.fmu")).unwrap();
    #[cfg(unix)]
    {
        // A disk with room for half a megabyte.
        let program = env!("CARGO_BIN_EXE_cartilage-contact");
        let command = format!("trap '' XFSZ; ulimit -f 1000; exec {program} package --output x.fmu");
        let output = Command::new("sh").args(["-c", &command]).current_dir(folder.path()).output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        assert!(String::from_utf8_lossy(&output.stderr).contains("x.fmu: could not write"));
    }
    assert_eq!(std::fs::read(folder.path().join("x.fmu")).unwrap(), good);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "nothing is left beside");
}

#[test]
fn reduce_packs_a_model_and_says_how_good_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let output = run_in(
        folder.path(),
        &format!("reduce {COARSE} --depths=-9e-6:-5e-6 --speeds 0.1:0.2 --threads 2 --output contact.fmu --picture"),
    );
    let text = out(&output);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for expected in ["reduced model of", "-9e-6 to -5e-6 m", "load 0.", "contact.fmi3.fmu"] {
        assert!(text.contains(expected), "{expected} in {text}");
    }
    let picture = std::fs::read_to_string(folder.path().join("contact_errors.svg")).unwrap();
    assert!(picture.contains("Load: 100 of 100 within"));
    assert!(std::fs::read(folder.path().join("contact_errors.png")).unwrap().starts_with(b"\x89PNG"));
    let archive = std::fs::read(folder.path().join("contact.fmu")).unwrap();
    assert!(archive.windows(27).any(|window| window == b"resources/reduced_model.bin"));
    assert!(refused("reduce --depths 1e-6", 2).contains("--depths=-20e-6:60e-6"));
    assert!(refused("reduce --depths=2e-6:1e-6", 2).contains("ascending"));
    assert!(
        refused("reduce --loads 0:1e3", 2).contains("loads = 0e0:1e3 is not allowed: two ascending numbers from 1e-3")
    );
    assert!(refused("reduce --joint hip", 2).contains("give --loads"));
    assert!(refused("sensitivity --joint hip", 2).contains("control = load is not allowed"));
    assert!(refused("solve --set fidelity=reduced", 2).contains("only an FMU"));
}

#[test]
fn gait_repeats_and_keeps_its_film_where_sliding_turns() {
    let folder = tempfile::tempdir().unwrap();
    let output = run_in(folder.path(), "gait --peak-load 25 --set mesh.columns=16 --set mesh.rows=2 --steps 40");
    let text = out(&output);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(text.contains("Periodic: cycle ") && text.contains("| largest load [N/m] | 25 | 25 |"), "{text}");
    assert!(text.contains("Errors by the mesh, estimated: load "), "{text}");
    let path = folder.path().join("target/gait/gait.csv");
    let mut reader = csv::Reader::from_path(path).unwrap();
    let head: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let place =
        |name: &str| head.iter().position(|column| column == name).unwrap_or_else(|| panic!("no column {name}"));
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let of = |integration: &str, cycle: &str| -> Vec<_> {
        rows.iter().filter(|row| &row[0] == integration && &row[1] == cycle).collect()
    };
    let number = |row: &csv::StringRecord, name: &str| row[place(name)].parse::<f64>().unwrap();
    let [first, second, steady] = [of("transient", "1"), of("transient", "2"), of("quasi_steady", "1")];
    // The state that the first cycle starts from moves at another speed.
    assert_eq!([first.len(), second.len(), steady.len()], [40, 41, 41]);
    assert_eq!(number(second[40], "time"), 2.0);
    assert_eq!(number(first[39], "penetration_depth_result"), number(second[0], "penetration_depth_result"));
    for row in &rows {
        let (given, carried) = (number(row, "applied_load"), number(row, "load"));
        assert!((carried / given - 1.0).abs() < 1e-5, "{carried} of {given}");
    }
    let slowest = |states: &[&csv::StringRecord]| {
        let speed = |row: &csv::StringRecord| number(row, "sliding_speed").abs();
        let row = states.iter().min_by(|a, b| speed(a).total_cmp(&speed(b))).unwrap();
        number(row, "fluid_load_support")
    };
    assert!(slowest(&steady) < 0.2 && slowest(&second) > 0.5, "{} {}", slowest(&steady), slowest(&second));
    let flow = |row| number(row, "net_fluid_exudation");
    let step = 1.0 / 40.0;
    let sum: f64 = second.windows(2).map(|pair| 0.5 * step * (flow(pair[0]) + flow(pair[1]))).sum();
    let exchange = number(second[40], "cumulative_net_fluid_exudation");
    assert!((exchange - sum).abs() < 1e-9 * sum.abs(), "{exchange} {sum}");
    for picture in ["gait.svg", "gait.png"] {
        assert!(folder.path().join("target/gait").join(picture).exists(), "{picture}");
    }
}

#[test]
fn gait_takes_a_history_and_says_where_it_does_not_repeat() {
    let folder = tempfile::tempdir().unwrap();
    let write = |text: &str| std::fs::write(folder.path().join("own.csv"), text).unwrap();
    write("time,force,sliding_speed\n0,5,0.1\n0.5,10,0.05\n1,5,0.1\n");
    let arguments = "gait --history own.csv --set width=0.5 --set mesh.columns=16 --set mesh.rows=2 --steps 4";
    let text = out(&run_in(folder.path(), &format!("{arguments} --cycles 2 --periodicity 1e-12")));
    assert!(text.contains("| largest load [N/m] | 20 | 20 |") && text.contains("Not periodic: cycle 2"), "{text}");
    let refused = |arguments: &str| {
        let output = run_in(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        String::from_utf8(output.stderr).unwrap()
    };
    write("time,force,sliding_speed\n0,5,0.1\n0.5,heavy,0.05\n1,5,0.1\n");
    let message = refused(arguments);
    assert!(message.contains("own.csv:3: column `force`: `heavy` is not allowed: a finite number"), "{message}");
    assert!(refused("gait --history nowhere.csv").contains("nowhere.csv: could not read the history"));
    assert!(refused("gait --peak-load=-3").contains("--peak-load = -3 is not allowed: a number above 0 N/m"));
    assert!(refused("gait --peak-load 3 --body-weight 700").contains("cannot be used with"));
}
