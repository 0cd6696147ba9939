//! The real-time model against the full one, and against what an interpolant has to be: smooth, with its own derivatives.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::HashMap;
use std::sync::OnceLock;

use cartilage_contact::io::case::Case;
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Inputs, Mesh, Parameters};
use cartilage_contact::reduced::{Check, Range, ReducedModel, Tolerance};
use cartilage_contact::simulation::Simulation;
use cartilage_contact::variables::{Source, VARIABLES};

const RANGE: Range = Range { pressed: [-6e-6, 20e-6], speeds: [0.15, 0.4], slide_to_roll_ratio: 0.0 };

/// A range with rest in it.
const RESTING: Range = Range { pressed: [-3e-6, 10e-6], speeds: [0.0, 0.05], slide_to_roll_ratio: 0.0 };

const TOLERANCE: Tolerance =
    Tolerance { load: 0.01, minimum_film_thickness: 0.02, friction_coefficient: 0.02, fluid_pressure: 0.03 };

/// Few elements, but where the film closes: on coarser ones it does so in steps, and no table follows those.
fn parameters() -> Parameters {
    Parameters {
        mesh: Mesh { columns: 60, rows: 2, ..Parameters::default().mesh },
        sector_half_angle: std::f64::consts::PI / 72.0,
        ..Parameters::default()
    }
}

fn model() -> &'static ReducedModel {
    static MODEL: OnceLock<ReducedModel> = OnceLock::new();
    MODEL.get_or_init(|| ReducedModel::build(&parameters(), RANGE, TOLERANCE, 2, &|_| ()).unwrap())
}

fn resting() -> &'static ReducedModel {
    static MODEL: OnceLock<ReducedModel> = OnceLock::new();
    MODEL.get_or_init(|| ReducedModel::build(&parameters(), RESTING, TOLERANCE, 2, &|_| ()).unwrap())
}

fn inputs(micron: f64, sliding_speed: f64) -> Inputs {
    Inputs { penetration_depth: micron * 1e-6, sliding_speed, slide_to_roll_ratio: 0.0, ..Inputs::NONE }
}

/// All smooth outputs by name, the profiles among them.
fn numbers(outputs: &Outputs) -> Vec<(&'static str, f64)> {
    let number = |source: &Source| match source {
        Source::Result(get) => Some(get(outputs)),
        Source::Profile(get, station) => Some(get(outputs)[*station]),
        _ => None,
    };
    VARIABLES.iter().filter_map(|row| Some((row.name, number(&row.source)?))).collect()
}

/// Largest value of each output over the range, for scale; of a profile, that of all its stations.
fn scales(model: &ReducedModel) -> Vec<f64> {
    let mut largest: HashMap<&str, f64> = HashMap::new();
    let whole = |name: &'static str| name.split('[').next().unwrap();
    let Range { pressed: [least, most], speeds, .. } = *model.range();
    for depth in 0..=20 {
        for sliding_speed in [speeds[0], model.slowest_line(), speeds[1]] {
            let at = Inputs {
                penetration_depth: least + (most - least) * f64::from(depth) / 20.0,
                sliding_speed,
                ..inputs(0.0, 0.0)
            };
            for (name, value) in numbers(&model.evaluate(&at).unwrap().0) {
                let scale = largest.entry(whole(name)).or_default();
                *scale = scale.max(value.abs());
            }
        }
    }
    numbers(&model.evaluate(&inputs(0.0, speeds[1])).unwrap().0).iter().map(|(name, _)| largest[whole(name)]).collect()
}

#[test]
fn it_meets_the_full_model_within_its_tolerance() {
    assert!(model().keeps(&TOLERANCE), "{:#?}", model().accuracy());
    let mut full = Simulation::new(&parameters()).unwrap();
    for (micron, speed) in [(-5.3, 0.16), (-1.1, 0.31), (3.7, 0.23), (16.1, 0.17), (17.3, -0.29), (19.7, 0.21)] {
        full.solve_steady(inputs(micron, speed)).unwrap();
        let (table, full) = (model().evaluate(&inputs(micron, speed)).unwrap().0, full.outputs());
        let off = |of: fn(&Outputs) -> f64| (of(&table) / of(full) - 1.0).abs();
        let place = format!("{micron} micron, {speed} m/s");
        assert!(off(|o| o.load) < TOLERANCE.load, "{place}: {} for {}", table.load, full.load);
        assert!(
            off(|o| o.friction_coefficient) < TOLERANCE.friction_coefficient,
            "{place}: {} for {}",
            table.friction_coefficient,
            full.friction_coefficient
        );
        assert!(off(|o| o.upper_friction_force) < 0.03 && off(|o| o.lower_friction_force) < 0.03, "{place}");
        assert_eq!(table.lubrication_regime, full.lubrication_regime, "{place}");
        // Where pressure falls steeply in the constriction, single stations are farther off.
        let squares = table.fluid_pressure.iter().zip(&full.fluid_pressure).map(|(a, b)| (a - b).powi(2));
        let mean = (squares.sum::<f64>() / 101.0).sqrt();
        assert!(
            mean < TOLERANCE.fluid_pressure * full.maximum_fluid_pressure,
            "{place}: {mean} Pa of {}",
            full.maximum_fluid_pressure
        );
    }
}

#[test]
fn at_rest_and_where_sliding_turns_it_meets_the_full_model() {
    assert!(resting().keeps(&TOLERANCE), "{:#?}", resting().accuracy());
    let slow = |check: &&Check| check.sliding_speed < resting().slowest_line();
    assert!(resting().checks().iter().filter(slow).count() >= 40);
    let mut full = Simulation::new(&parameters()).unwrap();
    let slowest = resting().slowest_line();
    for (micron, speed) in [(-2.1, 0.3 * slowest), (3.1, 0.0), (3.1, -0.6 * slowest), (7.7, 0.9 * slowest), (9.1, 0.0)]
    {
        full.solve_steady(inputs(micron, speed)).unwrap();
        let (table, full) = (resting().evaluate(&inputs(micron, speed)).unwrap().0, full.outputs());
        let off = |of: fn(&Outputs) -> f64, scale: f64| (of(&table) - of(full)).abs() / of(full).abs().max(scale);
        let place = format!("{micron} micron, {speed} m/s");
        assert!(off(|o| o.load, 0.0) < TOLERANCE.load, "{place}: {} for {}", table.load, full.load);
        assert!(
            off(|o| o.fluid_load, 1e-6 * full.load) < 0.02,
            "{place}: {} for {}",
            table.fluid_load,
            full.fluid_load
        );
        assert!(off(|o| o.upper_friction_force, 1e-12) < TOLERANCE.friction_coefficient, "{place}");
        assert_eq!(table.lubrication_regime, full.lubrication_regime, "{place}");
    }
    // Not moved, what does not touch carries nothing, and nothing drags.
    let still = resting().evaluate(&inputs(-1.0, 0.0)).unwrap().0;
    assert_eq!([still.load, still.upper_friction_force, still.fluid_exudation], [0.0; 3]);
    assert!((still.minimum_film_thickness - 1e-6).abs() < 1e-10);
}

#[test]
fn derivatives_are_those_of_the_interpolant() {
    let slowest = resting().slowest_line();
    // Film, contact, reversed.
    let moving = [(-3.3, 0.2), (18.2, 0.33), (17.1, -0.17)];
    let slow = [(-1.3, 0.6 * slowest), (1.2, 0.7 * slowest), (8.0, -0.3 * slowest), (9.0, 0.02)];
    let places = moving.map(|place| (model(), place)).into_iter().chain(slow.map(|place| (resting(), place)));
    for (model, (micron, speed)) in places {
        let scales = scales(model);
        let at = inputs(micron, speed);
        let derivatives = model.evaluate(&at).unwrap().1;
        let value = |at: Inputs| numbers(&model.evaluate(&at).unwrap().0);
        let faster = if speed.abs() < slowest { 1e-4 * slowest } else { 1e-6 };
        for (k, (by_depth, by_speed)) in [(1e-10, 0.0), (0.0, faster)].into_iter().enumerate() {
            let moved = |sign: f64| {
                value(Inputs {
                    penetration_depth: at.penetration_depth + sign * by_depth,
                    sliding_speed: at.sliding_speed + sign * by_speed,
                    ..at
                })
            };
            let step = by_depth + by_speed;
            let (plus, minus) = (moved(1.0), moved(-1.0));
            for (i, (name, slope)) in numbers(&derivatives[k]).into_iter().enumerate() {
                let difference = (plus[i].1 - minus[i].1) / (2.0 * step);
                let allowed = 1e-4 * difference.abs() + 1e-9 * scales[i] / step;
                assert!((slope - difference).abs() <= allowed, "{name} at {at}: {slope} for {difference}");
            }
        }
    }
}

#[test]
fn reversing_the_speed_mirrors_the_outputs() {
    for (model, micron, speed) in
        [(model(), -3.3, 0.2), (model(), 18.2, 0.33), (resting(), 2.0, 1e-4), (resting(), 9.0, 0.0)]
    {
        let [there, back] = [speed, -speed].map(|speed| model.evaluate(&inputs(micron, speed)).unwrap());
        assert_eq!(there.0.load, back.0.load);
        assert_eq!(there.0.upper_friction_force, -back.0.upper_friction_force);
        // In contact it is the first place that touches, seen from the left.
        let last = there.0.minimum_film_position + there.0.contact_length;
        assert!((last + back.0.minimum_film_position).abs() < 1e-15);
        let mut reversed = back.0.fluid_pressure.clone();
        reversed.reverse();
        assert_eq!(there.0.fluid_pressure, reversed);
        assert_eq!(there.1[1].load, -back.1[1].load);
        assert_eq!(there.1[1].upper_friction_force, back.1[1].upper_friction_force);
    }
}

#[test]
fn nothing_jumps_at_first_touch_at_the_slowest_speed_or_at_rest() {
    let close = |model: &ReducedModel, a: Inputs, b: Inputs| {
        let scales = scales(model);
        let [a_outputs, b_outputs] = [a, b].map(|at| numbers(&model.evaluate(&at).unwrap().0));
        for (i, ((name, a_value), (_, b_value))) in a_outputs.into_iter().zip(b_outputs).enumerate() {
            assert!((a_value - b_value).abs() <= 2e-6 * scales[i], "{name}: {a_value} at {a}, {b_value} at {b}");
        }
    };
    for speed in [0.15, 0.2, 0.3] {
        let touch = 1e6 * model().first_touch(speed).unwrap();
        close(model(), inputs(touch - 1e-6, speed), inputs(touch + 1e-6, speed));
    }
    let slowest = resting().slowest_line();
    for speed in [0.0, 0.5 * slowest, 0.01] {
        let touch = 1e6 * resting().first_touch(speed).unwrap();
        // Towards rest the load at first touch vanishes, and ratios to it are steep.
        close(resting(), inputs(touch - 1e-11, speed), inputs(touch + 1e-11, speed));
    }
    for micron in [-2.0, 8.0] {
        for speed in [slowest, 0.0, -slowest] {
            close(resting(), inputs(micron, speed - 1e-15), inputs(micron, speed + 1e-15));
        }
    }
}

#[test]
fn what_it_does_not_cover_is_refused_with_what_it_covers() {
    for (at, expected) in [
        (inputs(20.1, 0.2), "penetration_depth = 0.0000201 is not allowed: a number from -6e-6 to 2e-5 m"),
        (inputs(f64::NAN, 0.2), "penetration_depth = NaN is not allowed"),
        (inputs(0.0, -0.41), "sliding_speed = -0.41 is not allowed: a number from -0.4 to 0.4 m/s"),
        (
            Inputs { slide_to_roll_ratio: 0.1, ..inputs(0.0, 0.2) },
            "slide_to_roll_ratio = 0.1 is not allowed: 0, the one",
        ),
    ] {
        let message = model().evaluate(&at).unwrap_err().to_string();
        assert!(message.starts_with(expected) && message.contains("reduced model"), "{message}");
    }
    for range in [Range { pressed: [1e-6, 0.0], ..RANGE }, Range { speeds: [-0.1, 0.1], ..RANGE }] {
        assert!(ReducedModel::build(&parameters(), range, TOLERANCE, 1, &|_| ()).is_err());
    }
}

#[test]
fn bytes_give_the_same_model_back_and_altered_ones_are_refused() {
    let mut bytes = model().to_bytes().unwrap();
    assert_eq!(&ReducedModel::from_bytes(&bytes).unwrap(), model());
    assert!(ReducedModel::from_bytes(&bytes[..bytes.len() / 2]).is_err());
    assert!(ReducedModel::from_bytes(b"").is_err());
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    assert!(ReducedModel::from_bytes(&bytes).unwrap_err().to_string().contains("cut or altered"));
}

/// Loads of a hip: rough surfaces of two bodies, on a mesh that goes with the contact.
const LOADS: Range = Range { pressed: [4e3, 8e3], speeds: [0.06, 0.1], slide_to_roll_ratio: 0.3 };

fn joint() -> Parameters {
    let hip = Case::parse("hip", include_str!("../examples/hip.toml")).unwrap().parameters;
    Parameters { mesh: Mesh { columns: 48, rows: 6, ..hip.mesh }, ..hip }
}

fn loaded() -> &'static ReducedModel {
    static MODEL: OnceLock<ReducedModel> = OnceLock::new();
    MODEL.get_or_init(|| ReducedModel::build(&joint(), LOADS, TOLERANCE, 2, &|_| ()).unwrap())
}

fn under(applied_load: f64, sliding_speed: f64) -> Inputs {
    Inputs { applied_load, sliding_speed, slide_to_roll_ratio: 0.3, ..Inputs::NONE }
}

#[test]
fn rough_surfaces_under_a_load_are_met_within_the_tolerance() {
    assert!(loaded().keeps(&TOLERANCE), "{:#?}", loaded().accuracy());
    // The film lifts them apart inside.
    let touch = loaded().first_touch(0.07).unwrap();
    assert!((5e3..8e3).contains(&touch), "{touch}");
    let mut full = Simulation::new(&joint()).unwrap();
    for (load, speed) in [(4.3e3, 0.065), (0.95 * touch, 0.07), (1.05 * touch, 0.07), (5.7e3, -0.097), (7.9e3, 0.07)] {
        full.solve_steady(under(load, speed)).unwrap();
        let (position, full) = (full.position().to_vec(), full.outputs());
        let table = loaded().evaluate(&under(load, speed)).unwrap().0;
        let off = |of: fn(&Outputs) -> f64, scale: f64| (of(&table) - of(full)).abs() / of(full).abs().max(scale);
        let place = format!("{load} N/m, {speed} m/s");
        assert!((table.load / load - 1.0).abs() < 1e-15 && off(|o| o.normal_force, 0.0) < 1e-5, "{place}");
        assert!(off(|o| o.penetration_depth, 0.0) < TOLERANCE.load, "{place}");
        assert!(off(|o| o.minimum_film_thickness, 0.1 * joint().surface_roughness) < 0.02, "{place}");
        assert!(off(|o| o.friction_coefficient, 1e-3) < TOLERANCE.friction_coefficient, "{place}");
        assert!(off(|o| o.fluid_load_support, 0.0) < 1e-3, "{place}");
        assert_eq!(table.lubrication_regime, full.lubrication_regime, "{place}");
        // The stations go with the contact.
        let places = loaded().position(&under(load, speed));
        assert!(places.iter().zip(&position).all(|(a, b)| (a - b).abs() < 1e-12), "{place}");
    }
}

#[test]
fn derivatives_by_the_load_are_those_of_the_interpolant() {
    let (at, step) = (under(5.3e3, -0.09), 1e-2);
    let slopes = loaded().evaluate(&at).unwrap().1;
    let value = |load: f64| numbers(&loaded().evaluate(&under(load, at.sliding_speed)).unwrap().0);
    let (plus, minus) = (value(at.applied_load + step), value(at.applied_load - step));
    let scales = value(at.applied_load);
    for (i, (name, slope)) in numbers(&slopes[0]).into_iter().enumerate() {
        let difference = (plus[i].1 - minus[i].1) / (2.0 * step);
        let allowed = 1e-4 * difference.abs() + 1e-9 * scales[i].1.abs().max(1e-9) / step;
        assert!((slope - difference).abs() <= allowed, "{name}: {slope} for {difference}");
    }
    assert!((slopes[0].load - 1.0).abs() < 1e-12 && slopes[0].penetration_depth > 0.0, "{}", slopes[0].load);
}

#[test]
fn below_the_slowest_speed_its_state_is_held_with_a_word() {
    let slowest = LOADS.speeds[0];
    let at = |speed: f64| loaded().evaluate(&under(5e3, speed)).unwrap();
    let [line, half, back, rest] = [slowest, 0.5 * slowest, -0.5 * slowest, 0.0].map(at);
    for (outputs, _) in [&half, &back, &rest] {
        assert_eq!(outputs.minimum_film_thickness, line.0.minimum_film_thickness);
        assert_eq!(outputs.penetration_depth, line.0.penetration_depth);
    }
    // What turns with the motion goes through zero, evenly.
    assert!((half.0.tangential_load / line.0.tangential_load - 0.5).abs() < 1e-9);
    assert_eq!(back.0.tangential_load, -half.0.tangential_load);
    assert_eq!([rest.0.tangential_load, rest.0.upper_friction_force], [0.0; 2]);
    let slope = (half.0.tangential_load - back.0.tangential_load) / slowest;
    assert!((half.1[1].tangential_load / slope - 1.0).abs() < 1e-9);
    assert_eq!(half.1[1].penetration_depth, 0.0);
    // Nothing jumps where it begins.
    let [below, above] = [1.0 - 1e-9, 1.0 + 1e-9].map(|factor| numbers(&at(factor * slowest).0));
    let mut largest: HashMap<&str, f64> = HashMap::new();
    let whole = |name: &'static str| name.split('[').next().unwrap();
    for (name, value) in &above {
        let scale = largest.entry(whole(name)).or_default();
        *scale = scale.max(value.abs());
    }
    for ((name, a), (_, b)) in below.into_iter().zip(above) {
        assert!((a - b).abs() <= 1e-6 * largest[whole(name)], "{name}: {a} {b}");
    }
    let held = |at: Inputs| loaded().warnings(&at).iter().any(|warning| warning.contains("below 0.06 m/s"));
    assert!(!held(under(5e3, slowest)) && held(under(5e3, -0.02)) && !half.0.well_resolved);
}
