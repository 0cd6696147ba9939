//! What case files say, and what is answered to mistakes in them.

use super::*;
use proptest::collection;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn message(text: &str) -> String {
    Case::parse("case.toml", text).unwrap_err().to_string()
}

#[test]
fn keys_are_names_of_variables() {
    let text = "penetration_depth = 12e-6\nformulation = 'consistent'\n\
                boundary_friction_loads_tissue = false\nupper.thickness = 2e-3\n[mesh]\ncolumns = 60\npressure_order = 1";
    let case = Case::parse("case.toml", text).unwrap();
    assert_eq!(case.inputs.penetration_depth, 12e-6);
    assert_eq!((case.parameters.mesh.columns, case.parameters.pressure_order), (60, 1));
    assert_eq!((case.parameters.upper.thickness, case.parameters.lower.thickness), (2e-3, 1e-3));
    assert!(!case.parameters.boundary_friction_loads_tissue);
    assert_eq!(Case::parse("empty.toml", "").unwrap(), Case::default());
}

#[test]
fn what_is_written_is_read_back() {
    let mut case = Case::default();
    case.parameters.upper.thickness = 1.0 / 3.0 * 1e-3;
    case.parameters.formulation = crate::laws::Formulation::Consistent;
    case.parameters.boundary_friction_loads_tissue = false;
    case.inputs.slide_to_roll_ratio = 0.1;
    assert_eq!(Case::parse("f", &case.fixed_part()).unwrap(), case);
}

#[test]
fn what_is_written_wins_over_the_preset_wherever_it_stands() {
    use crate::parameters::Preset;
    let mut expected = Preset::HumanFemoralCondyle.parameters();
    expected.upper.thickness = 2e-3;
    expected.mesh.rows = 8;
    // Also where it says what the default is.
    expected.viscosity = 1e-3;
    for text in [
        "preset = 'human_femoral_condyle'\nviscosity = 1e-3\nmesh.rows = 8\n[upper]\nthickness = 2e-3",
        "viscosity = 1e-3\nmesh.rows = 8\nupper.thickness = 2e-3\npreset = 'human_femoral_condyle'",
    ] {
        let case = Case::parse("f", text).unwrap();
        assert_eq!(case.parameters, expected);
        assert_eq!(Case::parse("f", &case.fixed_part()).unwrap(), case);
    }
    assert!(
        message("\npreset = 'giraffe'")
            .contains("case.toml:2: preset = \"giraffe\" is not allowed: one of \"paper\", \"human_tibial_plateau\"")
    );
}

#[test]
fn one_body_wins_over_both_wherever_it_stands() {
    let case = Case::parse("f", "[lower]\nthickness = 3e-3\n[both]\nthickness = 2e-3\nshear_modulus = 1e6").unwrap();
    assert_eq!((case.parameters.upper.thickness, case.parameters.lower.thickness), (2e-3, 3e-3));
    assert_eq!((case.parameters.upper.shear_modulus, case.parameters.lower.shear_modulus), (1e6, 1e6));
}

#[test]
fn mistakes_name_line_key_value_and_what_is_allowed() {
    for (text, expected) in [
        (
            "# first\n[upper]\nshear_modulos = 5e5",
            "case.toml:3: unknown variable `upper.shear_modulos`; did you mean `upper.shear_modulus`?",
        ),
        (
            "[both]\nshear_modulos = 5e5",
            "case.toml:2: unknown variable `both.shear_modulos`; did you mean `both.shear_modulus`?",
        ),
        (
            "width = 1\ndensity = 1000.0",
            "case.toml:2: unknown variable `density`; it acted on nothing and was taken out: leave it away; what \
             compresses the fluid is fluid_compressibility",
        ),
        ("viscosity = -1.0", "case.toml:1: viscosity = -1 is not allowed: a number from 1e-6 to 1e3 Pa.s"),
        ("viscosity = nan", "case.toml:1: viscosity = NaN is not allowed: a number from 1e-6 to 1e3 Pa.s"),
        (
            "\n\nviscosity = 'thin'",
            "case.toml:3: viscosity = \"thin\" is not allowed: a number from 1e-6 to 1e3 Pa.s (a number has to come first, \
             then its unit)",
        ),
        (
            "viscosity = '2 kPa'",
            "case.toml:1: viscosity = \"2 kPa\" is not allowed: a number from 1e-6 to 1e3 Pa.s (`kPa` is not a unit of the \
             same kind as Pa.s)",
        ),
        (
            "both.poisson_ratio = 0.5",
            "case.toml:1: both.poisson_ratio = 0.5 is not allowed: a number from -9.9e-1 to 4.99e-1",
        ),
        (
            "[lower]\naggregate_modulus = [1]",
            "case.toml:2: lower.aggregate_modulus = [...] is not allowed: a number from 1e2 to 1e10 Pa",
        ),
        ("viscosity = [1e-3]", "case.toml:1: viscosity = [...] is not allowed: a number from 1e-6 to 1e3 Pa.s"),
        (
            "viscosity = 2020-01-01",
            "case.toml:1: viscosity = 2020-01-01 is not allowed: a number from 1e-6 to 1e3 Pa.s",
        ),
        ("[viscosity]\nwater = 1", "case.toml:1: `viscosity` is a table, where one value is needed"),
        ("mesh.columns = 12.5", "case.toml:1: mesh.columns = 12.5 is not allowed: a whole number from 0 to 2000"),
        (
            "mesh.columns = 99999999999999999999",
            "case.toml:1: mesh.columns = 99999999999999999999 is not allowed: a whole number from 0 to 2000",
        ),
        (
            "formulation = 'papr'",
            "case.toml:1: formulation = \"papr\" is not allowed: one of \"paper\", \"consistent\"",
        ),
        ("load = 3.0", "case.toml:1: load = 3 is not allowed: it is a result and cannot be set"),
        (
            "[both]\nbiot_coefficient = 2",
            "case.toml:2: both.biot_coefficient = 2 is not allowed: a number from 0e0 to 1e0",
        ),
    ] {
        assert_eq!(message(text), expected);
    }
    let error = message("viscosity = 1e-3\n[upper\nthickness = 1");
    assert!(error.starts_with("case.toml:2: not valid TOML: "), "{error}");
    let error = message("viscosity = 1e-3\nviscosity = 1e-3");
    assert!(error.starts_with("case.toml:2: not valid TOML: duplicate key"), "{error}");
    let error = message("width = 1\n[both]\nthickness = 0.09");
    assert!(error.starts_with("case.toml:3: upper.thickness = 0.09 is not allowed: less than half of"), "{error}");
}

#[test]
fn texts_with_units_are_converted() {
    let case = Case::parse(
        "f",
        "penetration_depth = '12 um'\nviscosity = '1 mPa s'\nsector_half_angle = '5 deg'\n\
         [both]\nthickness = '2 mm'\nshear_modulus = '0.7 MPa'\npermeability = '1e-6 um^2'\nbiot_coefficient = '90 %'",
    )
    .unwrap();
    let (inputs, parameters, upper) = (case.inputs, case.parameters, case.parameters.upper);
    assert_eq!((inputs.penetration_depth, parameters.viscosity), (12e-6, 1e-3));
    assert!((parameters.sector_half_angle - std::f64::consts::PI / 36.0).abs() < 1e-15);
    assert_eq!((upper.thickness, upper.shear_modulus, upper.permeability), (2e-3, 0.7e6, 1e-18));
    assert_eq!((upper.biot_coefficient, upper), (0.9, parameters.lower));
}

/// E = 9 K G/(3 K + G), nu = (3 K - 2 G)/(6 K + 2 G), H_A = K + 4 G/3.
#[test]
fn other_pairs_of_moduli_and_hydraulic_permeability_stand_for_parameters() {
    let text = "both.poisson_ratio = 0.125\nlower.aggregate_modulus = '0.5 MPa'\nupper.young_modulus = '0.675 MPa'\n\
                both.hydraulic_permeability = '7.6e-15 m^4/(N s)'\nlower.poisson_ratio = 0.3";
    for text in [text.to_owned() + "\n[mesh]\nrows = 6", format!("viscosity = 2e-3\n{text}")] {
        let parameters = Case::parse("f", &text).unwrap().parameters;
        let [upper, lower] = [parameters.upper, parameters.lower].map(|body| (body.shear_modulus, body.bulk_modulus));
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
        close(9.0 * upper.1 * upper.0 / (3.0 * upper.1 + upper.0), 0.675e6);
        close((3.0 * upper.1 - 2.0 * upper.0) / (6.0 * upper.1 + 2.0 * upper.0), 0.125);
        close(lower.1 + 4.0 / 3.0 * lower.0, 0.5e6);
        close((3.0 * lower.1 - 2.0 * lower.0) / (6.0 * lower.1 + 2.0 * lower.0), 0.3);
        close(parameters.lower.permeability, 7.6e-15 * parameters.viscosity);
    }
    // They win over a preset as any other value does, and over what was said before.
    let mut case = Case::parse("f", "both.shear_modulus = 1e6\npreset = 'human_normal'").unwrap();
    case.set_all(&[("both.young_modulus", Value::Real(1e6)), ("both.poisson_ratio", Value::Integer(0))]).unwrap();
    assert_eq!((case.parameters.upper.shear_modulus, case.parameters.upper.bulk_modulus), (0.5e6, 1e6 / 3.0));
    case.set("preset", &Value::Text("osteoarthritic".into())).unwrap();
    assert_eq!(case.parameters.lower.shear_modulus, 0.5e6);
}

#[test]
fn conflicts_of_moduli_and_permeabilities_say_which() {
    for (text, line, parts) in [
        ("both.aggregate_modulus = 1e6", 1, ["upper.aggregate_modulus = 1000000", "without upper.poisson_ratio"]),
        ("\nlower.young_modulus = 1e6", 2, ["lower.young_modulus", "without lower.poisson_ratio"]),
        ("lower.poisson_ratio = 0.1", 1, ["lower.poisson_ratio = 0.1", "without lower.aggregate_modulus or"]),
        (
            "lower.poisson_ratio = 0.1\nlower.young_modulus = 1e6\nboth.aggregate_modulus = 1e6\nupper.poisson_ratio = 0",
            2,
            ["lower.young_modulus", "beside lower.aggregate_modulus; give one pair"],
        ),
        (
            "upper.shear_modulus = 1e6\nboth.poisson_ratio = 0.1\nboth.young_modulus = 1e6",
            3,
            ["upper.young_modulus", "where upper.shear_modulus or upper.bulk_modulus is given too"],
        ),
        (
            "both.permeability = 1e-18\nlower.hydraulic_permeability = 1e-15",
            2,
            ["lower.hydraulic_permeability", "beside lower.permeability"],
        ),
        (
            "lower.hydraulic_permeability = 1e-6\nviscosity = 100",
            1,
            ["lower.permeability = 0.0000999", "from 1e-24 to 1e-9 m2"],
        ),
        // A rule that ties the moduli together names the line of what they follow from.
        (
            "formulation = 'consistent'\nboth.poisson_ratio = -0.2\nboth.young_modulus = 1e6\nboth.solid_law = 'holmes_mow'",
            3,
            ["upper.bulk_modulus", "2/3 of upper.shear_modulus"],
        ),
    ] {
        let message = message(text);
        assert!(message.starts_with(&format!("case.toml:{line}: ")), "{message}");
        parts.iter().for_each(|part| assert!(message.contains(part), "{message}"));
    }
}

#[test]
fn whole_numbers_may_be_written_as_real_ones() {
    assert_eq!(Case::parse("f", "mesh.columns = 24.0").unwrap(), Case::parse("f", "mesh.columns = 24").unwrap());
    assert!(message("mesh.columns = 24e9").contains("a whole number from 0 to 2000"));
}

#[test]
fn a_file_of_any_size_is_answered_at_once() {
    let long = "k".repeat(5_000_000);
    let start = std::time::Instant::now();
    for text in [
        format!("{long} = 1"),
        format!("[{long}]\nviscosity = 1"),
        format!("formulation = '{long}'"),
        format!("viscosity = {}", "1".repeat(1_000_000)),
        (0..100_000).map(|i| format!("[k{i}]\n")).collect::<String>() + "[upper]\nwrong = 1",
    ] {
        let message = message(&text);
        assert!(message.starts_with("case.toml:") && message.len() < 3000, "{} characters", message.len());
    }
    assert!(start.elapsed().as_secs() < 100, "{:?}", start.elapsed());
}

proptest! {
    // As many as PROPTEST_CASES says.
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(15), ..ProptestConfig::default() })]
    #[test]
    fn altered_files_are_read_or_refused(edits in collection::vec((0.0..1.0, any::<u8>(), 0..5_usize), 1..9)) {
        const WORDS: [&str; 8] = ["\n[[", "\"\"\"", "= nan\n", "1e999", "\n[both]\n", "preset = 'human_normal'\n", "{a = 1}", "\u{feff}"];
        let mut bytes = format!("{}[upper]\nthickness = 1e-3\n", Case::default().fixed_part()).into_bytes();
        for (fraction, byte, kind) in edits {
            let place = (fraction * bytes.len() as f64) as usize;
            match kind {
                0 => bytes[place] = byte,
                1 => bytes[place] ^= 1 << (byte % 8),
                2 => bytes.truncate(place.max(1)),
                3 => { bytes.drain(place..bytes.len().min(place + usize::from(byte))); }
                _ => { bytes.splice(place..place, WORDS[usize::from(byte) % WORDS.len()].bytes()); }
            }
            if bytes.is_empty() { break; }
        }
        match Case::parse("f", &String::from_utf8_lossy(&bytes)) {
            Ok(case) => prop_assert!(case.parameters.validate().is_ok()),
            Err(error) => prop_assert!(error.to_string().starts_with("f:"), "{}", error),
        }
    }
}

#[test]
fn the_first_mistake_of_the_file_is_reported() {
    assert!(message("width = 1\nviscosity = -1\nfluid_compressibility = -1").starts_with("case.toml:2:"));
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let error = Case::load(Path::new("no/such/case.toml")).unwrap_err().to_string();
    assert!(error.starts_with("no/such/case.toml: could not read the case file"), "{error}");
}
