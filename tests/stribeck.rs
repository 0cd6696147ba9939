//! Sweeps, their tables, fields, sensitivities and studies, on small meshes.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use cartilage_contact::variables;

/// A small mesh, so that a state takes no time.
const COARSE: &str = "--set=mesh.columns=24 --set=mesh.rows=3";

fn run(arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cartilage-contact")).args(arguments.split_whitespace()).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Standard output of a command that has to succeed.
fn done(arguments: &str) -> String {
    let output = run(arguments);
    assert!(output.status.success(), "{arguments}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// Standard error of a command that has to end with this exit code.
fn refused(arguments: &str, code: i32) -> String {
    let output = run(arguments);
    assert_eq!(output.status.code(), Some(code), "{arguments}: {}", text(&output.stderr));
    text(&output.stderr)
}

/// Header and rows of a CSV.
fn table(path: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let words = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
    let header = words(reader.headers().unwrap());
    (header, reader.records().map(|record| words(&record.unwrap())).collect())
}

fn column(path: &Path, name: &str) -> Vec<f64> {
    let (header, rows) = table(path);
    let index = header.iter().position(|word| word == name).unwrap();
    rows.iter().map(|row| row[index].parse().unwrap()).collect()
}

#[test]
fn the_table_has_the_names_of_the_variables_and_is_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().display();
    let said =
        done(&format!("stribeck {COARSE} --depths -10e-6:20e-6:5e-6 --speeds 0.2,0.1 --threads 2 --output {output}"));
    let csv = folder.path().join("stribeck.csv");
    let (header, rows) = table(&csv);
    assert_eq!(header[..3], ["penetration_depth", "sliding_speed", "slide_to_roll_ratio"]);
    let (case, results) = header[3..].split_last().unwrap();
    assert!(results.iter().eq(variables::scalar_outputs().map(|row| row.name)));
    assert_eq!(case, "case");
    assert!(rows.iter().all(|row| row.last() == rows[0].last() && row.last().unwrap().len() == 32));
    assert_eq!(rows.len(), 14);
    assert_eq!(column(&csv, "sliding_speed"), [[0.1; 7], [0.2; 7]].concat());
    let depths = [-10e-6, -5e-6, 0.0, 5e-6, 10e-6, 15e-6, 20e-6];
    assert_eq!(column(&csv, "penetration_depth"), [depths, depths].concat());
    let load = column(&csv, "load");
    #[cfg(feature = "parquet")]
    the_parquet_file_agrees(&csv, &header, &load);
    assert!(load[..7].windows(2).all(|pair| pair[1] > pair[0]), "{load:?}");
    assert!(said.contains("7 states at 0.2 m/s. Least friction coefficient 0.0"), "{said}");
    assert!(said.contains("The solids first touch between 10 and 15 um."), "{said}");
    for ending in ["svg", "png", "pdf"] {
        assert!(folder.path().join("stribeck").with_extension(ending).exists());
    }
    let units = std::fs::read_to_string(folder.path().join("stribeck.units.csv")).unwrap();
    assert_eq!(units.lines().count(), 1 + header.len());
    for expected in ["\nload,N/m,", "\nsliding_speed,m/s,", "\nfriction_coefficient,1,", "\ncase,1,"] {
        assert!(units.contains(expected), "{expected}: {units}");
    }
}

/// The same columns in the same order.
#[cfg(feature = "parquet")]
fn the_parquet_file_agrees(csv: &Path, header: &[String], load: &[f64]) {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;

    let parquet = SerializedFileReader::new(std::fs::File::open(csv.with_extension("parquet")).unwrap()).unwrap();
    let fields = parquet.metadata().file_metadata().schema().get_fields().to_vec();
    let names: Vec<_> = fields.iter().map(|field| field.name()).collect();
    assert_eq!(names, header);
    let stored: Vec<f64> = parquet.get_row_iter(None).unwrap().map(|row| row.unwrap().get_double(3).unwrap()).collect();
    assert_eq!((names[3], stored.as_slice()), ("load", load));
    let metadata = parquet.metadata().file_metadata().key_value_metadata().unwrap();
    let units = metadata.iter().find(|entry| entry.key == "units").and_then(|entry| entry.value.as_ref()).unwrap();
    let units: serde_json::Value = serde_json::from_str(units).unwrap();
    assert_eq!((&units["load"], &units["well_resolved"]), (&"N/m".into(), &"1".into()));
}

#[test]
fn one_speed_draws_figure_3_with_its_regimes() {
    let folder = tempfile::tempdir().unwrap();
    done(&format!("stribeck {COARSE} --depths -10e-6:40e-6:10e-6 --output {}", folder.path().display()));
    let svg = std::fs::read_to_string(folder.path().join("stribeck.svg")).unwrap();
    for expected in
        ["thin film flow", "low friction", "high friction", "Sommerfeld number", "[kPa]", "[N/m]", "von Mises"]
    {
        assert!(svg.contains(expected), "{expected}");
    }
}

#[test]
fn a_stopped_run_goes_on_and_another_case_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let csv = folder.path().join("stribeck.csv");
    let sweep = format!("stribeck {COARSE} --depths -10e-6:5e-6:5e-6 --output {}", folder.path().display());
    done(&sweep);
    let whole = std::fs::read_to_string(&csv).unwrap();

    // Stopped while it wrote the third row. The first rows are marked, to see that they are kept.
    let lines: Vec<&str> = whole.lines().collect();
    let kept = lines[1].replacen("-1e-5,0.2,0,", "-1e-5,0.2,0,7", 1);
    assert_ne!(kept, lines[1]);
    std::fs::write(&csv, format!("{}\n{kept}\n{}\n{}", lines[0], lines[2], &lines[3][..lines[3].len() / 2])).unwrap();
    let said = done(&sweep);
    assert!(said.contains("2 of 4 states are in"), "{said}");
    let after: Vec<String> = std::fs::read_to_string(&csv).unwrap().lines().map(str::to_owned).collect();
    assert_eq!(after.len(), 5);
    assert_eq!((after[1].as_str(), after[2].as_str()), (kept.as_str(), lines[2]));

    let message = refused(&format!("{sweep} --set viscosity=2e-3"), 1);
    for expected in ["viscosity is 0.001 there and 0.002 here", "--output", "--fresh"] {
        assert!(message.contains(expected), "{expected}: {message}");
    }
    assert_eq!(std::fs::read_to_string(&csv).unwrap().lines().count(), 5, "a refused run leaves the table alone");
    done(&format!("{sweep} --set viscosity=2e-3 --fresh"));
    assert!(!std::fs::read_to_string(&csv).unwrap().contains(&kept));
    assert!(std::fs::read_to_string(folder.path().join("case.toml")).unwrap().contains("viscosity = 2e-3"));
}

#[test]
fn rows_and_case_are_never_mistaken_for_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let (csv, case) = (folder.path().join("stribeck.csv"), folder.path().join("case.toml"));
    let sweep = format!("stribeck {COARSE} --depths -10e-6:-5e-6:5e-6 --output {}", folder.path().display());
    done(&sweep);
    let (rows, old) = (std::fs::read(&csv).unwrap(), std::fs::read_to_string(&case).unwrap());

    // A new case beside old rows, as a run leaves them that was stopped at a bad moment.
    std::fs::write(&case, old.replace("viscosity = 1e-3", "viscosity = 2e-3")).unwrap();
    let message = refused(&format!("{sweep} --set viscosity=2e-3"), 1);
    assert!(message.contains("rows carry another hash"), "{message}");
    assert_eq!(std::fs::read(&csv).unwrap(), rows);
    std::fs::remove_file(&case).unwrap();
    assert!(done(&sweep).contains("2 of 2 states are in"), "the rows say whose they are");
    assert_eq!(std::fs::read_to_string(&case).unwrap(), old);

    // A fresh run that cannot replace the table leaves the case alone.
    std::fs::remove_file(&csv).unwrap();
    std::fs::create_dir(&csv).unwrap();
    let message = refused(&format!("{sweep} --set viscosity=2e-3 --fresh"), 1);
    assert!(message.contains("stribeck.csv: could not write"), "{message}");
    assert_eq!(std::fs::read_to_string(&case).unwrap(), old);
}

fn spawn(arguments: &str) -> std::process::Child {
    let quiet = std::process::Stdio::null;
    let mut command = Command::new(env!("CARGO_BIN_EXE_cartilage-contact"));
    command.args(arguments.split_whitespace()).stdout(quiet()).stderr(quiet()).spawn().unwrap()
}

#[test]
fn one_run_writes_to_a_folder_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().display();
    let mut first = spawn(&format!("stribeck --depths 0:100e-6:1e-6 --output {output}"));
    while !folder.path().join("case.toml").exists() {
        std::thread::sleep(Duration::from_millis(10));
    }
    for other in [
        format!("stribeck {COARSE} --depths 0 --fresh --output {output}"),
        format!("gait --peak-load 25 {COARSE} --steps 4 --output {output}"),
        format!("sensitivity {COARSE} --output {output}"),
    ] {
        assert!(refused(&other, 1).contains("another process is writing to this folder"), "{other}");
    }
    // A killed process leaves no lock behind.
    first.kill().unwrap();
    first.wait().unwrap();
    done(&format!("stribeck {COARSE} --depths 0 --fresh --output {output}"));
}

/// Kills sweeps at random moments, and lets the last one finish: every state is there once, and is that of an undisturbed sweep.
fn kill_sweeps(times: u64) {
    // Full films: in solid contact on so few elements there are depths with two solutions, of more and of fewer stations in contact.
    let (disturbed, whole) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let sweep = |folder: &Path| {
        format!("stribeck {COARSE} --depths -40e-6:5e-6:0.5e-6 --threads 2 --output {}", folder.display())
    };
    let mut random = 20_240_229_u64;
    for round in 0..times {
        let mut child = spawn(&sweep(disturbed.path()));
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        std::thread::sleep(Duration::from_millis((random >> 33) % 300));
        child.kill().unwrap();
        child.wait().unwrap();
        if round % 5 == 4 {
            // Another case is refused, or solved where there is no row yet; its rows would then be refused in turn.
            let folder = disturbed.path();
            let other =
                run(&format!("stribeck {COARSE} --set viscosity=2e-3 --depths 0 --output {}", folder.display()));
            if other.status.success() {
                std::fs::remove_file(folder.join("stribeck.csv")).unwrap();
            } else {
                assert!(text(&other.stderr).contains("of another case"), "{}", text(&other.stderr));
            }
        }
    }
    done(&sweep(disturbed.path()));
    done(&sweep(whole.path()));
    let [disturbed, whole] = [&disturbed, &whole].map(|folder| folder.path().join("stribeck.csv"));
    for name in ["penetration_depth", "load", "minimum_film_thickness"] {
        let (found, expected) = (column(&disturbed, name), column(&whole, name));
        assert_eq!(found.len(), 91);
        let largest = expected.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let off = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-5 * largest, "{name}: {off} of {largest}");
    }
    let (_, rows) = table(&disturbed);
    assert!(rows.iter().all(|row| row.last() == table(&whole).1[0].last()));
}

#[test]
fn killed_sweeps_go_on() {
    kill_sweeps(10);
}

#[test]
#[ignore = "some minutes"]
fn sweeps_that_are_killed_many_times_go_on() {
    kill_sweeps(200);
}

/// A disk that is full after so many kilobytes, as far as one file can tell: the limit on the size of files.
#[cfg(unix)]
fn with_little_room(kilobytes: usize, arguments: &str) -> Output {
    let program = env!("CARGO_BIN_EXE_cartilage-contact");
    let command = format!("trap '' XFSZ; ulimit -f {}; exec {program} {arguments}", 2 * kilobytes);
    Command::new("sh").args(["-c", &command]).output().unwrap()
}

#[test]
#[cfg(unix)]
fn a_full_disk_is_said_at_the_first_row_that_does_not_fit() {
    let folder = tempfile::tempdir().unwrap();
    let csv = folder.path().join("stribeck.csv");
    let sweep =
        format!("stribeck {COARSE} --depths -40e-6:-20e-6:0.1e-6 --threads 1 --output {}", folder.path().display());
    let output = with_little_room(8, &sweep);
    assert_eq!(output.status.code(), Some(1));
    let message = text(&output.stderr);
    assert!(message.contains("stribeck.csv: could not write"), "{message}");
    assert!(!folder.path().join("stribeck.parquet").exists(), "the sweep ends there");
    let rows = std::fs::read_to_string(&csv).unwrap().lines().count();
    assert!((5..60).contains(&rows), "{rows} lines fit");
    // With room again it goes on from what fits.
    assert!(done(&sweep).contains("of 201 states are in"));
    assert_eq!(column(&csv, "load").len(), 201);

    // What is replaced whole stays as it was.
    let gait = format!(
        "gait --peak-load 25 --set=mesh.columns=8 --set=mesh.rows=1 --steps 16 --cycles 1 --output {}",
        folder.path().display()
    );
    done(&gait);
    let old = std::fs::read(folder.path().join("gait.csv")).unwrap();
    let output = with_little_room(2, &gait);
    assert!(text(&output.stderr).contains("gait.csv: could not write"), "{}", text(&output.stderr));
    assert_eq!(std::fs::read(folder.path().join("gait.csv")).unwrap(), old);
}

#[test]
fn a_folder_that_cannot_be_written_is_said_before_anything_is_computed() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let start = Instant::now();
    for command in ["stribeck", "sensitivity", "gait", "reduce"] {
        let message = refused(&format!("{command} --output {}/below", file.display()), 1);
        assert!(message.contains("could not write"), "{command}: {message}");
    }
    assert!(start.elapsed().as_secs() < 10, "{:?}", start.elapsed());
}

#[test]
fn a_state_that_fails_is_reported_and_the_others_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    // 9 mm is deeper than the two layers are thick.
    let message = refused(&format!("stribeck {COARSE} --depths -5e-6,0,9e-3 --output {}", folder.path().display()), 1);
    assert!(message.contains("1 of 3 states could not be solved"), "{message}");
    assert!(message.contains("no converged solution at penetration_depth = 9e-3 m"), "{message}");
    assert_eq!(column(&folder.path().join("stribeck.csv"), "penetration_depth"), [-5e-6, 0.0]);
    assert!(folder.path().join("stribeck.png").exists());
}

#[test]
fn fields_are_drawn_and_written_for_paraview() {
    let folder = tempfile::tempdir().unwrap();
    done(&format!("stribeck {COARSE} --depths 0 --fields 0,20e-6 --output {}", folder.path().display()));
    for state in ["0um", "20um"] {
        for name in ["bodies", "interface"] {
            for ending in ["svg", "png", "vtu"] {
                let path = folder.path().join(format!("{name}_{state}.{ending}"));
                assert!(path.exists(), "{} is missing", path.display());
            }
        }
        let vtu = std::fs::read_to_string(folder.path().join(format!("bodies_{state}.vtu"))).unwrap();
        // Two bodies of 24 x 3 elements.
        assert!(vtu.contains("NumberOfPoints=\"686\" NumberOfCells=\"144\""), "{}", &vtu[..300]);
        for (name, count) in [
            ("position", 3 * 686),
            ("displacement [m]", 3 * 686),
            ("fluid pressure [Pa]", 686),
            ("von Mises stress [Pa]", 686),
            ("Darcy flux [m/s]", 3 * 686),
            ("connectivity", 9 * 144),
            ("offsets", 144),
            ("types", 144),
            ("volume ratio", 144),
            ("body", 144),
        ] {
            let start = vtu.find(&format!("Name=\"{name}\"")).unwrap_or_else(|| panic!("{name}"));
            let values = vtu[start..].split_once('>').unwrap().1.split_once('<').unwrap().0;
            let values: Vec<f64> = values.split_whitespace().map(|word| word.parse().unwrap()).collect();
            assert_eq!(values.len(), count, "{name}");
            assert!(values.iter().all(|value| value.is_finite()), "{name}");
        }
        for tag in ["VTKFile", "UnstructuredGrid", "Piece", "Points", "Cells", "PointData", "CellData", "DataArray"] {
            let count = |text: String| vtu.matches(&text).count();
            let opened = count(format!("<{tag} ")) + count(format!("<{tag}>"));
            assert_eq!(opened, count(format!("</{tag}>")), "{tag}");
        }
    }
}

#[test]
fn sensitivities_have_the_right_sign() {
    let folder = tempfile::tempdir().unwrap();
    let said = done(&format!("sensitivity {COARSE} --depths 0,20e-6 --output {}", folder.path().display()));
    let (header, rows) = table(&folder.path().join("sensitivity.csv"));
    assert_eq!(header[..3], ["parameter", "relative_change", "penetration_depth"]);
    assert_eq!(header[3], "load_relative_change");
    let of = |parameter: &str, more: bool, depth: f64| -> [Option<f64>; 3] {
        let row = rows.iter().find(|row| {
            row[0] == parameter
                && (row[1].parse::<f64>().unwrap() > 0.0) == more
                && (row[2].parse::<f64>().unwrap() - depth).abs() < 1e-9
        });
        let row = row.unwrap_or_else(|| panic!("{parameter}"));
        std::array::from_fn(|k| row[3 + k].parse().ok())
    };
    for (parameter, depth, load) in [
        ("sliding_speed", 0.0, 1.0),
        ("viscosity", 0.0, 1.0),
        ("both.outer_radius", 0.0, 1.0),
        ("both.permeability", 0.0, -1.0),
        ("both.shear_modulus", 20e-6, 1.0),
        ("both.thickness", 20e-6, -1.0),
    ] {
        let (more, less) = (of(parameter, true, depth)[0].unwrap(), of(parameter, false, depth)[0].unwrap());
        assert!(load * more > 1e-4 && load * less < -1e-4, "{parameter}: {more} {less}");
    }
    // A faster film is thicker; friction of solids is felt where they touch.
    assert!(of("sliding_speed", true, 0.0)[2].unwrap() > 0.0);
    assert!(of("boundary_friction_coefficient", true, 0.0)[1].unwrap().abs() < 1e-9);
    assert!((of("boundary_friction_coefficient", true, 20e-6)[1].unwrap() - 0.2).abs() < 0.02);
    // Where the film is gone its thickness has no relative change, and no parameter leaves its range.
    assert_eq!(of("both.thickness", true, 20e-6)[2], None);
    assert!(rows.iter().any(|row| row[0] == "both.biot_coefficient" && row[1] == "0.111111"));
    assert!(said.contains("| sliding speed | +20.0 % |"), "{said}");
    assert!(folder.path().join("sensitivity.png").exists());
}

#[test]
fn studies_print_markdown() {
    let said = done("validate convergence --set mesh.columns=48 --set mesh.rows=8 --meshes 3 --depths 0,20e-6");
    assert!(
        said.starts_with("| d [um] | quantity | 12 x 2 | 24 x 4 | 48 x 8 | order | limit | error of 48 x 8 |\n"),
        "{said}"
    );
    assert!(said.contains("| 0 | load [N/m] | ") && said.contains("| 20 | contact length [mm] | "), "{said}");
    let said = done(&format!("validate published {COARSE}"));
    assert!(said.contains("| h_min = 4 um at d = 0 | h_min = "), "{said}");
    assert!(!said.contains("not solved"), "{said}");
}

#[test]
fn wrong_usage_is_explained() {
    for (arguments, expected) in [
        ("stribeck --depths deep", "--depths: `deep` is not a number; give SI numbers as a list"),
        ("stribeck --depths 0:1e-6:0", "is no range"),
        ("stribeck --depths 1", "penetration_depth = 1 is not allowed: a number from -1e-2 to 1e-2 m"),
        ("stribeck --speeds 50", "sliding_speed = 50 is not allowed: a number from -1e1 to 1e1 m/s"),
        ("sensitivity --change 20", "--change = 20 is not allowed: a fraction from 1e-6 to 0.9"),
        ("validate everything", "invalid value 'everything'"),
    ] {
        let message = refused(arguments, 2);
        assert!(message.contains(expected), "{arguments}: {message}");
    }
}

/// The files below a folder that are for users, with their content.
fn files(folder: &Path) -> Vec<(std::path::PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if !path.file_name().unwrap().to_string_lossy().starts_with('.') {
            let content = std::fs::read(&path).unwrap();
            found.push((path, content));
        }
    }
    found.sort();
    found
}

/// Begins something that takes so long undisturbed and kills it: at any moment, and every other time towards the end, where files are
/// written. Says whether it was still there.
fn kill_once(arguments: &str, duration: Duration, round: u32) -> bool {
    let random = f64::from(round.wrapping_mul(2_654_435_769)) / 2_f64.powi(32);
    let least = if round.is_multiple_of(2) { 0.0 } else { 0.8 };
    let mut child = spawn(arguments);
    std::thread::sleep(duration.mul_f64(least + (1.1 - least) * random));
    let there = child.try_wait().unwrap().is_none();
    child.kill().unwrap();
    child.wait().unwrap();
    there
}

/// Kills a command many times: every file is whole, that of before or the new one, and the next run is not hindered.
fn kill(command: &str, times: u32) {
    let folder = tempfile::tempdir().unwrap();
    let run_with =
        |viscosity: &str| format!("{command} --set viscosity={viscosity} --output {}", target(command, folder.path()));
    done(&run_with("1e-3"));
    let old = files(folder.path());
    let start = Instant::now();
    done(&run_with("2e-3"));
    let (new, duration) = (files(folder.path()), start.elapsed());
    assert_eq!(old.len(), new.len());
    assert!(!old.is_empty());
    let mut disturbed = 0;
    for round in 0..times {
        let viscosity = if round % 4 < 2 { "1e-3" } else { "2e-3" };
        disturbed += u32::from(kill_once(&run_with(viscosity), duration, round));
        let now = files(folder.path());
        assert_eq!(now.len(), old.len(), "{command}, round {round}");
        for ((path, now), ((_, old), (_, new))) in now.iter().zip(old.iter().zip(&new)) {
            assert!(now == old || now == new, "{command}, round {round}: {} is half written", path.display());
        }
    }
    println!("{command}: {disturbed} of {times} runs were killed");
    done(&run_with("1e-3"));
    assert_eq!(files(folder.path()), old, "{command}");
}

/// What is behind --output: a file for the commands that write FMUs.
fn target(command: &str, folder: &Path) -> String {
    let file = if command.starts_with("reduce") { "contact.fmu" } else { "" };
    folder.join(file).display().to_string()
}

const SMALL: &str = "--set=mesh.columns=12 --set=mesh.rows=1";

/// The other commands that write.
fn kill_others(times: u32) {
    kill(&format!("gait --peak-load 25 {SMALL} --steps 16 --cycles 1"), times);
    kill(&format!("sensitivity {SMALL}"), times);
    kill(&format!("reduce {SMALL} --depths=-9e-6:-8e-6 --speeds 0.1:0.2 --threads 1"), times);
    kill_package(4 * times);
}

#[test]
fn killed_commands_leave_whole_files() {
    kill_others(3);
}

#[test]
#[ignore = "some minutes"]
fn commands_that_are_killed_many_times_leave_whole_files() {
    kill_others(100);
}

/// A command without parameters of its own, that writes two files.
fn kill_package(times: u32) {
    let folder = tempfile::tempdir().unwrap();
    let package = format!("package --output {}", folder.path().join("x.fmu").display());
    let start = Instant::now();
    done(&package);
    let (whole, duration) = (files(folder.path()), start.elapsed());
    assert_eq!(whole.len(), 2);
    let mut disturbed = 0;
    for round in 0..times {
        disturbed += u32::from(kill_once(&package, duration, round));
        assert!(files(folder.path()) == whole, "round {round}");
    }
    println!("package: {disturbed} of {times} runs were killed");
}

/// On a disk of its own, where this user may have one; elsewhere the limit on the size of files stands in for it, see above.
#[test]
#[cfg(target_os = "linux")]
fn a_disk_that_is_full_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let (disk, kept) = (folder.path().join("disk"), folder.path().join("kept.csv"));
    std::fs::create_dir(&disk).unwrap();
    let program = env!("CARGO_BIN_EXE_cartilage-contact");
    let script = format!(
        "mount -t tmpfs -o size=32k none {0} || exit 77\n\
         {program} stribeck {COARSE} --depths -40e-6:-20e-6:0.1e-6 --threads 1 --output {0}\n\
         code=$?; cp {0}/stribeck.csv {1}; exit $code",
        disk.display(),
        kept.display()
    );
    let Ok(output) = Command::new("unshare").args(["--mount", "sh", "-c", &script]).output() else { return };
    if output.status.code() != Some(1) {
        println!("no disk of its own: {}", text(&output.stderr));
        assert!(!kept.exists());
        return;
    }
    let message = text(&output.stderr);
    if !kept.exists() {
        println!("no disk of its own: {message}");
        return;
    }
    assert!(message.contains("stribeck.csv: could not write") && message.contains("No space left"), "{message}");
    let rows = std::fs::read_to_string(&kept).unwrap().lines().count();
    assert!((5..100).contains(&rows), "{rows} lines fit");
}
