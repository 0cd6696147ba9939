//! Random steady states of tissue as it differs between joints, each held against twice the columns, 1.6 times the rows and half more of a
//! sector: what is off carries a warning.
//!
//! Drawn at random, by a seed: formulation, radii (equal, unlike, socket, flat, rigid counterface), thickness, moduli, permeability, viscosity,
//! roughness from 0 to 1 micron, speed, slide-to-roll ratio, and how far the bodies are pressed: 0.2 to 30 % of a layer's thickness, or the load that
//! a bonded layer carries there. One case in five has a mesh and a sector of its own, as users set them.
//!
//! Without a warning at most one case in a hundred may be more than 5 % off in load, least film (5 % too) or friction; nine in ten of all that come
//! with no warning are within 1 % of the load and 2 % of the others. A case that is given up is an answer: an error.

use std::time::Instant;

use cartilage_contact::laws::Formulation;
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Body, Control, Inputs, Mesh, MeshDistribution, Parameters, Preset};
use cartilage_contact::simulation::Simulation;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// A value of any order of magnitude between the two.
fn magnitude(least: f64, most: f64) -> impl Strategy<Value = f64> {
    (least.ln()..most.ln()).prop_map(f64::exp)
}

/// Radius, thickness, shear modulus, drained bulk modulus over it, permeability.
fn body() -> impl Strategy<Value = Body> {
    let values = (magnitude(0.02, 0.3), 0.8e-3..4e-3, magnitude(1e5, 1e6), 0.6..2.0, magnitude(1e-19, 3e-16));
    values.prop_map(|(outer_radius, thickness, shear_modulus, ratio, permeability)| Body {
        outer_radius,
        thickness,
        shear_modulus,
        bulk_modulus: ratio * shear_modulus,
        permeability,
        ..Preset::HumanFemoralCondyle.parameters().upper
    })
}

/// Which pair the bodies are: equal in half of the cases.
#[derive(Debug, Clone, Copy)]
enum Pairing {
    Equal,
    Unlike,
    Socket,
    Flat,
    Rigid,
}

fn pairing() -> impl Strategy<Value = Pairing> {
    prop_oneof![
        4 => Just(Pairing::Equal),
        1 => Just(Pairing::Unlike),
        1 => Just(Pairing::Socket),
        1 => Just(Pairing::Flat),
        1 => Just(Pairing::Rigid),
    ]
}

/// Mesh and sector: those of the program, or columns, rows and half the angle.
fn mesh() -> impl Strategy<Value = Option<(i32, i32, f64)>> {
    prop_oneof![4 => Just(None), 1 => (24..140, 4..14, 0.05..0.5).prop_map(Some)]
}

fn case() -> impl Strategy<Value = (Parameters, Inputs)> {
    let surfaces = (
        prop_oneof![1 => Just(0.0), 2 => magnitude(0.1e-6, 1e-6)],
        magnitude(1e-3, 0.1),
        prop_oneof![4 => Just(Formulation::Consistent), 1 => Just(Formulation::Paper)],
    );
    let motion = (
        magnitude(5e-3, 0.5),
        prop_oneof![Just(1.0), Just(-1.0)],
        prop_oneof![2 => Just(0.0), 1 => -0.9..0.9],
        magnitude(2e-3, 0.3),
        any::<bool>(),
    );
    (pairing(), body(), body(), surfaces, motion, mesh()).prop_map(
        |(
            pairing,
            upper,
            other,
            (roughness, viscosity, formulation),
            (speed, sense, ratio, compression, loaded),
            mesh,
        )| {
            let lower = match pairing {
                Pairing::Equal | Pairing::Rigid => upper,
                Pairing::Unlike => other,
                Pairing::Socket => Body { outer_radius: -1.1 * upper.outer_radius, ..other },
                Pairing::Flat => Body { outer_radius: 0.0, ..other },
            };
            let paper = formulation == Formulation::Paper;
            let base = Preset::HumanFemoralCondyle.parameters();
            let parameters = Parameters {
                upper,
                lower,
                rigid_lower: matches!(pairing, Pairing::Rigid),
                viscosity,
                formulation,
                surface_roughness: if paper { 0.0 } else { roughness },
                control: if loaded { Control::Load } else { Control::Depth },
                maximum_solve_time: limit(),
                ..base
            };
            let parameters = match mesh {
                None => parameters,
                Some((columns, rows, sector_half_angle)) => Parameters {
                    mesh: Mesh { columns, rows, column_grading: 2.5, row_grading: 4.0 },
                    mesh_distribution: MeshDistribution::Graded,
                    sector_half_angle,
                    ..parameters
                },
            };
            let depth = compression * 2.0 * upper.thickness.min(lower.thickness);
            let inputs = Inputs {
                penetration_depth: depth,
                applied_load: bonded_layer(&parameters, depth),
                sliding_speed: sense * speed,
                slide_to_roll_ratio: if paper { 0.0 } else { ratio },
                ..Inputs::NONE
            };
            (parameters, inputs)
        },
    )
}

/// About the load per unit depth under which a bonded layer is pressed in so far \[N/m\].
fn bonded_layer(parameters: &Parameters, depth: f64) -> f64 {
    let curvature = |body: &Body| if body.outer_radius == 0.0 { 0.0 } else { 1.0 / body.outer_radius };
    let sum = curvature(&parameters.upper) + if parameters.rigid_lower { 0.0 } else { curvature(&parameters.lower) };
    let a = (4.0 * depth / sum).sqrt();
    let ratio = a / parameters.upper.thickness;
    0.5 * sum * a * a * parameters.upper.shear_modulus * (4.68 * ratio.powf(0.8) + 0.714 * ratio.powf(2.5))
}

/// Seeds of cases that are quickly solved; the pressure of one is three times off and the friction of another, smooth surfaces in contact that roll, by
/// 5 %, which their warnings say.
const QUICK: [u64; 9] = [35, 42, 47, 52, 54, 55, 61, 72, 108];

/// One whose smooth surfaces touch and slide in tissue that hardly drains, with 50 columns.
const SLIDING: u64 = 148;

/// Thin films of 0.5, 1.3 and 2.1 microns between smooth and rough surfaces, on tissue that does not drain: pressures in straight lines let the surfaces bulge into them in the
/// middle of every column, by 3 to 34 % of the least film with 96 columns.
const BULGING: [u64; 3] = [1030, 1043, 1057];

/// Seconds after which a case is given up.
fn limit() -> f64 {
    std::env::var("RANDOM_CASE_SECONDS").map_or(60.0, |text| text.parse().unwrap())
}

fn solved(parameters: &Parameters, inputs: Inputs) -> Result<(Outputs, Vec<String>), String> {
    let mut simulation = Simulation::new(parameters).map_err(|e| e.to_string())?;
    simulation.solve_steady(inputs).map_err(|e| e.to_string())?;
    Ok((simulation.outputs().clone(), simulation.warnings().to_vec()))
}

/// Largest magnitudes of what is off: load (or depth, whichever follows), least film, friction.
fn off(parameters: &Parameters, coarse: &Outputs, fine: &Outputs) -> [f64; 3] {
    let relative = |a: f64, b: f64, scale: f64| ((a - b) / scale.abs().max(b.abs())).abs();
    let followed = match parameters.control {
        Control::Depth => relative(coarse.load, fine.load, 0.0),
        Control::Load => relative(coarse.penetration_depth, fine.penetration_depth, 0.0),
    };
    // Films below a tenth of the roughness, or below the offset of smooth ones, are closed ones; friction below 1e-5 of the load is none,
    // and that of one body is measured by the larger of both: its rolling and its sliding part may cancel.
    let film = (0.1 * parameters.surface_roughness).max(1e-8);
    let friction = (1e-5 * fine.normal_force).max(fine.lower_friction_force.abs());
    [
        followed,
        relative(coarse.minimum_film_thickness, fine.minimum_film_thickness, film),
        relative(coarse.upper_friction_force, fine.upper_friction_force, friction),
    ]
}

fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| text.parse().unwrap())
}

/// The case of a seed.
fn drawn(seed: u64) -> (Parameters, Inputs) {
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    case().new_tree(&mut runner).unwrap().current()
}

/// Solves the cases of these seeds; returns what is off in those without a warning.
fn random_cases(seeds: impl Iterator<Item = u64>) -> Vec<[f64; 3]> {
    let (mut count, mut given_up, mut unverified, mut warned, mut silent) = (0, 0, 0, 0, Vec::new());
    for seed in seeds {
        count += 1;
        let (parameters, inputs) = drawn(seed);
        let p = &parameters;
        println!(
            "{seed}: {:?} {:?} rms {:.2e} R {:.3}/{:.3}{} t {:.2e}/{:.2e} G {:.2e}/{:.2e} k {:.1e}/{:.1e} eta {:.1e} {inputs} W {:.3e} {:?}",
            p.formulation,
            p.control,
            p.surface_roughness,
            p.upper.outer_radius,
            p.lower.outer_radius,
            if p.rigid_lower { " rigid" } else { "" },
            p.upper.thickness,
            p.lower.thickness,
            p.upper.shear_modulus,
            p.lower.shear_modulus,
            p.upper.permeability,
            p.lower.permeability,
            p.viscosity,
            inputs.applied_load,
            (p.mesh.columns, p.mesh.rows, p.sector_half_angle),
        );
        let start = Instant::now();
        let coarse = solved(p, inputs);
        let taken = start.elapsed().as_secs_f64();
        let (coarse, warnings) = match coarse {
            Ok(solved) => solved,
            Err(error) => {
                given_up += 1;
                println!("    given up after {taken:.0} s: {error}");
                continue;
            }
        };
        println!(
            "    {} iterations, {taken:.0} s: L {:.4e} d {:.4e} h {:.3e} T {:.3e} support {:.3} estimates {:.4} {:.4} {:.4}; {warnings:?}",
            coarse.newton_iterations,
            coarse.load,
            coarse.penetration_depth,
            coarse.minimum_film_thickness,
            coarse.upper_friction_force,
            coarse.fluid_load_support,
            coarse.estimated_load_error,
            coarse.estimated_film_error,
            coarse.estimated_friction_error
        );
        match solved(&coarse.on_finer_mesh(p), inputs) {
            Err(error) => {
                unverified += 1;
                println!("    reference: {error}");
            }
            Ok((fine, _)) => {
                let off = off(p, &coarse, &fine);
                println!(
                    "    off {:.4} {:.4} {:.4} (h {:.3e} T {:.3e})",
                    off[0], off[1], off[2], fine.minimum_film_thickness, fine.upper_friction_force
                );
                if warnings.is_empty() { silent.push((seed, off)) } else { warned += 1 }
            }
        }
    }
    let found: Vec<[f64; 3]> = silent.iter().map(|(_, off)| *off).collect();
    println!(
        "{count} cases: {given_up} given up, {unverified} without a reference, {warned} with a warning, {} silent: {} within 1 and 2 %, \
         {} within 5 %; the others: {:?}",
        found.len(),
        within(&found, FINE),
        within(&found, FAIR),
        silent.iter().filter(|(_, off)| within(&[*off], FAIR) == 0).collect::<Vec<_>>()
    );
    found
}

/// What load, least film and friction of a result without a warning may be off, and what is wrong.
const FINE: [f64; 3] = [0.01, 0.02, 0.02];
const FAIR: [f64; 3] = [0.05; 3];

/// How many are within these limits.
fn within(found: &[[f64; 3]], limits: [f64; 3]) -> usize {
    found.iter().filter(|off| off.iter().zip(limits).all(|(off, limit)| *off <= limit)).count()
}

#[test]
#[ignore = "hours: RANDOM_CASES of them from RANDOM_FIRST on"]
fn random_cases_are_right_or_carry_a_warning() {
    let (first, count) = (number("RANDOM_FIRST", 0), number("RANDOM_CASES", 300));
    let found = random_cases(first..first + count);
    assert!(found.len() - within(&found, FAIR) <= count as usize / 100, "wrong without a word");
    assert!(within(&found, FINE) * 10 >= found.len() * 9, "less than nine in ten are within 1 and 2 %");
}

/// Those that take some seconds.
#[test]
fn quick_random_cases_are_right_or_carry_a_warning() {
    let found = random_cases(QUICK.into_iter());
    assert_eq!((found.len(), within(&found, FAIR)), (QUICK.len() - 2, QUICK.len() - 2));
}

/// Where the film closes within a column, what fluid the tissue loses there moves boundary friction by a third: a warning says so, the estimate is between
/// a third and three times the difference from twice the columns, and small on these.
#[test]
fn boundary_friction_of_smooth_surfaces_is_off_as_estimated() {
    let (parameters, inputs) = drawn(SLIDING);
    let (coarse, warnings) = solved(&parameters, inputs).unwrap();
    let (fine, none) = solved(&coarse.on_finer_mesh(&parameters), inputs).unwrap();
    let [_, _, off] = off(&parameters, &coarse, &fine);
    let estimates = [&coarse, &fine].map(|outputs| outputs.estimated_friction_error);
    println!("off {off:.4}, estimated {estimates:.4?}");
    assert!(off > 0.2 && (off / 3.0..3.0 * off).contains(&estimates[0]) && estimates[1] < 0.03);
    assert!(
        warnings.iter().any(|warning| warning.contains("begin to touch")) && none.is_empty(),
        "{warnings:?} {none:?}"
    );
}

/// The least film is that which the walls carry, within 1.5 % of that on twice the columns.
#[test]
fn the_least_film_does_not_see_that_surfaces_bulge_within_a_column() {
    for seed in BULGING {
        let (parameters, inputs) = drawn(seed);
        let (coarse, _) = solved(&parameters, inputs).unwrap();
        let mesh = Mesh { columns: 2 * coarse.mesh_columns, rows: coarse.mesh_rows, ..parameters.mesh };
        let (fine, _) = solved(&Parameters { mesh, ..parameters }, inputs).unwrap();
        let [coarse, fine] = [coarse, fine].map(|outputs| outputs.minimum_film_thickness);
        println!("{seed}: {coarse:.4e} m, {fine:.4e} m");
        assert!((coarse / fine - 1.0).abs() < 0.015, "{seed}: {coarse:.4e} m, {fine:.4e} m");
    }
}
