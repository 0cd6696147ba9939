//! Sweeps, their tables, fields, sensitivities and studies, on small meshes.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;
use std::process::{Command, Output};

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
    assert!(header[3..].iter().eq(variables::scalar_outputs().map(|row| &row.name)));
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
    for ending in ["svg", "png"] {
        assert!(folder.path().join("stribeck").with_extension(ending).exists());
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
}

#[test]
fn one_speed_draws_figure_3_with_its_regimes() {
    let folder = tempfile::tempdir().unwrap();
    done(&format!("stribeck {COARSE} --depths -10e-6:40e-6:10e-6 --output {}", folder.path().display()));
    let svg = std::fs::read_to_string(folder.path().join("stribeck.svg")).unwrap();
    for expected in
        ["thin film flow", "low friction", "high friction", "Sommerfeld number", "[kPa]", "[N/m]", "contact length"]
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
    // A faster film is thicker; a steady one does not feel the density; friction of solids is felt where they touch.
    assert!(of("sliding_speed", true, 0.0)[2].unwrap() > 0.0);
    assert_eq!(of("density", true, 0.0), [Some(0.0); 3]);
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
        ("sensitivity --change 20", "--change = 20 is not allowed: a share from 1e-6 to 0.9"),
        ("validate everything", "invalid value 'everything'"),
    ] {
        let message = refused(arguments, 2);
        assert!(message.contains(expected), "{arguments}: {message}");
    }
}
