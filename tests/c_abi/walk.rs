//! A random walk over admissible parameters and inputs: every solution ends within its time, as solved, or given up with where it got
//! to and the last solution kept.

use std::ops::Range;
use std::sync::LazyLock;
use std::time::Instant;

use cartilage_contact::fmi::fmi3::*;
use cartilage_contact::fmi::standard::Standard;
use cartilage_contact::parameters::{Kind, PRESETS};
use cartilage_contact::variables::{Source, VARIABLES, Variable};

use crate::importer::*;
use crate::random::Random;

/// Longer than `maximum_solve_time` a call may take [s]: the iteration that is under way, and what is made once.
const BESIDE: f64 = 2.0;

/// Seconds that this thread has worked, whatever else the machine does; the time of day where the system does not say.
fn worked() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let text = std::fs::read_to_string("/proc/thread-self/schedstat");
    let worked = text.ok().and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    worked.map_or_else(|| START.elapsed().as_secs_f64(), |nanoseconds| 1e-9 * nanoseconds)
}

#[derive(Debug, Default)]
struct Counts {
    cases: usize,
    refused: usize,
    solved: usize,
    given_up: usize,
    /// Seeds of the cases that had no time left.
    over: Vec<u64>,
    /// Seconds of work of the longest call, and of the longest that found what it looked for.
    longest: f64,
    longest_solved: f64,
}

/// A value within the range, over orders of magnitude where it has them.
fn number(random: &mut Random, least: f64, most: f64) -> f64 {
    if least > 0.0 {
        least * (most / least).powf(random.fraction())
    } else {
        (least + (most - least) * random.fraction()) * 10_f64.powf(-6.0 * random.fraction())
    }
}

fn set_parameter(random: &mut Random, fmu: &Fmu, variable: &Variable, kind: &Kind) {
    match kind {
        Kind::Choice { items, .. } => fmu.set_choice(variable.name, 1 + random.below(items.len()) as i32),
        Kind::Boolean { .. } => unsafe {
            let value = random.below(2) as u8;
            fmi3SetBoolean(fmu.handle, &variable.reference, 1, &value, 1)
        },
        Kind::Integer { minimum, maximum, .. } => {
            fmu.set_integer(variable.name, minimum + random.below((maximum - minimum + 1) as usize) as i32)
        }
        Kind::Real { minimum, maximum, .. } => fmu.set_real(variable.name, number(random, *minimum, *maximum)),
    };
}

/// One case, with some parameters away from their defaults, and some steps from it.
fn walk(seed: u64, limit: f64, counts: &mut Counts) {
    let mut random = Random(seed);
    let fmu = Fmu::fresh(Standard::Fmi3);
    for variable in VARIABLES.iter() {
        let Source::Parameter(row) = variable.source else { continue };
        // The real-time model has its own limits, and what a large mesh takes is known.
        let left =
            ["fidelity", "preset", "maximum_solve_time"].contains(&variable.name) || variable.name.starts_with("mesh.");
        if !left && random.below(6) == 0 {
            set_parameter(&mut random, &fmu, variable, &row.kind);
        }
    }
    fmu.set_integer("mesh.columns", 16 + random.below(25) as i32);
    fmu.set_integer("mesh.rows", 2 + random.below(3) as i32);
    let set_inputs = |random: &mut Random| {
        let depth = [1e-5, 1e-4, 1e-3][random.below(3)] * (2.0 * random.fraction() - 1.0);
        fmu.set_real("penetration_depth", depth);
        fmu.set_real("sliding_speed", number(random, -10.0, 10.0));
        fmu.set_real("slide_to_roll_ratio", if random.below(2) == 0 { 0.0 } else { number(random, -10.0, 10.0) });
        fmu.set_real("applied_load", number(random, 1e-3, 1e5));
    };
    drive(seed, random, &fmu, limit, -4.0..2.0, set_inputs, counts);
}

/// A joint: a preset with rough surfaces on the mesh that the program chooses, a third of its parameters changed within what
/// tissues differ by, under loads from hardly any to body weight.
fn walk_of_a_joint(seed: u64, limit: f64, counts: &mut Counts) {
    let mut random = Random(seed);
    let fmu = Fmu::fresh(Standard::Fmi3);
    fmu.set_choice("preset", 2 + random.below(PRESETS.len() - 1) as i32);
    fmu.set_choice("control", 2);
    fmu.set_choice("time_integration", 1 + random.below(2) as i32);
    let both = ["shear_modulus", "bulk_modulus", "permeability", "thickness", "outer_radius"];
    for (name, least, most) in [
        ("shear_modulus", 1.5e5, 1.5e6),
        ("bulk_modulus", 1e5, 1e6),
        ("permeability", 1e-19, 1e-16),
        ("thickness", 1e-3, 4e-3),
        ("outer_radius", 0.01, 0.1),
        ("surface_roughness", 0.05e-6, 3e-6),
        ("viscosity", 5e-4, 1.0),
        ("boundary_friction_coefficient", 0.01, 0.5),
        ("solid_fraction", 1e-3, 1.0),
    ] {
        if random.below(3) > 0 {
            continue;
        }
        let value = number(&mut random, least, most);
        // Of both bodies, or of one alone.
        let bodies = [["upper.", "lower."].as_slice(), &["upper."]][random.below(2)];
        let prefixes = if both.contains(&name) { bodies } else { &[""] };
        for prefix in prefixes {
            assert_eq!(
                fmu.set_real(&format!("{prefix}{name}"), value),
                OK,
                "{name} = {value}: {:?}",
                fmu.take_messages()
            );
        }
    }
    let set_inputs = |random: &mut Random| {
        let sign = [1.0, 1.0, 0.0, -1.0][random.below(4)];
        fmu.set_real("sliding_speed", sign * number(random, 1e-3, 1.0));
        fmu.set_real("slide_to_roll_ratio", [0.0, 0.5, 2.0, -2.0][random.below(4)]);
        fmu.set_real("applied_load", number(random, 10.0, 1e5));
    };
    drive(seed, random, &fmu, limit, -3.0..0.0, set_inputs, counts);
}

/// Solves a case, and three more by steps of these orders of magnitude.
fn drive(
    seed: u64,
    mut random: Random,
    fmu: &Fmu,
    limit: f64,
    sizes: Range<f64>,
    set_inputs: impl Fn(&mut Random),
    counts: &mut Counts,
) {
    counts.cases += 1;
    fmu.set_real("maximum_solve_time", limit);
    set_inputs(&mut random);
    let timed = |counts: &mut Counts, call: &dyn Fn() -> std::ffi::c_uint| {
        let start = worked();
        let status = call();
        let taken = worked() - start;
        assert!(taken < limit + BESIDE, "seed {seed}: {taken} s, {:?}", fmu.take_messages());
        counts.longest = counts.longest.max(taken);
        if status == OK {
            counts.longest_solved = counts.longest_solved.max(taken);
        }
        status
    };
    fmu.take_messages();
    if timed(counts, &|| fmu.enter_initialization(1e9)) != OK {
        counts.refused += 1;
        return;
    }
    let mut time = 0.0;
    let mut status = timed(counts, &|| fmu.exit_initialization());
    for _ in 0..3 {
        let messages = fmu.take_messages();
        let told = messages.iter().map(|(_, _, text)| text.as_str()).collect::<String>();
        assert!([OK, DISCARD, ERROR].contains(&status), "seed {seed}: {status} {told}");
        if status == OK {
            counts.solved += 1;
        } else if told.contains("reached") || told.contains("steady film") || told.contains("no converged solution") {
            counts.given_up += 1;
            if told.contains("maximum_solve_time is over") && counts.over.last() != Some(&seed) {
                counts.over.push(seed);
            }
        } else {
            assert!(told.contains("is not allowed"), "seed {seed}: refused with no reason known: {told}");
            counts.refused += 1;
        }
        if status == ERROR {
            return;
        }
        let before = fmu.get_real("load");
        set_inputs(&mut random);
        let size = 10_f64.powf(sizes.start + (sizes.end - sizes.start) * random.fraction());
        status = timed(counts, &|| fmu.step(time, size));
        if status == OK {
            time += size;
        } else {
            assert_eq!(fmu.get_real("load").to_bits(), before.to_bits(), "seed {seed}: the last solution is kept");
        }
    }
}

#[test]
fn every_solution_ends_in_its_time() {
    let mut counts = Counts::default();
    (0..30).for_each(|seed| walk(seed, 0.3, &mut counts));
    println!("{counts:?}");
    assert!(counts.solved > 10 && counts.given_up > 0, "{counts:?}");
}

#[test]
#[ignore = "ten minutes"]
fn every_solution_of_a_long_walk_ends_in_its_time() {
    let (mut counts, start) = (Counts::default(), Instant::now());
    (1000..).take_while(|_| start.elapsed().as_secs() < 600).for_each(|seed| walk(seed, 2.0, &mut counts));
    println!("{counts:?}");
}

#[test]
#[ignore = "ten minutes or more, or WALK_CASES"]
fn every_joint_is_solved_or_given_up_within_a_minute() {
    let cases = std::env::var("WALK_CASES").map_or(100, |text| text.parse().unwrap());
    let first = std::env::var("WALK_FIRST").map_or(0, |text| text.parse().unwrap());
    let mut counts = Counts::default();
    for seed in first..first + cases {
        let (start, solved) = (worked(), counts.solved);
        walk_of_a_joint(seed, 60.0, &mut counts);
        println!("seed {seed}: {} states solved, {:.1} s", counts.solved - solved, worked() - start);
    }
    println!("{counts:?}");
}

/// Cases of the walks, by their seeds, with a minute in place of what they had there.
#[test]
#[ignore = "some minutes"]
fn chosen_cases_are_given_up_after_a_minute() {
    let seeds = std::env::var("WALK_SEEDS").unwrap_or_else(|_| "8,13".into());
    for seed in seeds.split(',').map(|seed| seed.parse().unwrap()) {
        let (mut counts, start) = (Counts::default(), Instant::now());
        walk(seed, 60.0, &mut counts);
        println!("seed {seed}, {:.0} s in all: {counts:?}", start.elapsed().as_secs_f64());
    }
}
