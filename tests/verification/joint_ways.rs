//! Ways through the states of a joint: from rest, and from state to state as a host's inputs lead.

use cartilage_contact::equations::grid::Expected;
use cartilage_contact::io::case::Case;
use cartilage_contact::parameters::{Control, Inputs, Parameters, Preset};
use cartilage_contact::simulation::Simulation;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// Surfaces that all but conform: a fluid a thousand times as thick, as on the way of other joints, would float them apart and hold them
/// together beyond the contact. The depth is that of thin bonded layers (Meijers 1968; Jaffar 1989), pressed across surfaces that are up to 40
/// degrees steep.
#[test]
fn a_hip_is_loaded_from_rest_at_any_speed() {
    let case = Case::load("examples/hip.toml".as_ref()).unwrap();
    for (applied_load, sliding_speed) in [(10e3, 0.15), (30e3, 0.6), (60e3, 0.02), (60e3, 0.05)] {
        let mut hip = Simulation::new(&case.parameters).unwrap();
        hip.solve_steady(Inputs { applied_load, sliding_speed, ..case.inputs }).unwrap();
        let iterations = hip.outputs().newton_iterations;
        // Surfaces are pressed across: with points paired along y a hip is 16 to 30 % deeper.
        let theory = Expected::new(&case.parameters, hip.inputs(), Control::Load).depth;
        let depth = hip.outputs().penetration_depth;
        println!(
            "{applied_load} N/m at {sliding_speed} m/s: {depth:e} m, {theory:e} m of thin layers, {iterations} iterations"
        );
        assert!((depth / theory - 1.0).abs() < 0.1, "{applied_load} N/m: {depth} m, {theory} m");
        assert!(iterations < 320, "{applied_load} N/m at {sliding_speed} m/s: {iterations}");
    }
}

/// A fifth of the load more or less is so many iterations at most away, up and down and turning round.
#[test]
fn a_fifth_of_the_load_is_near() {
    for (preset, load, most) in [
        (Preset::HumanFemoralCondyle, 10e3, 12),
        (Preset::HumanFemoralCondyle, 50e3, 10),
        // Its film jumps at the inlet between 36 and 43 kN/m.
        (Preset::HumanTibialPlateau, 30e3, 30),
    ] {
        let parameters = Parameters { control: Control::Load, ..preset.parameters() };
        let mut joint = Simulation::new(&parameters).unwrap();
        let mut go = |applied_load| {
            joint.solve_steady(Inputs { applied_load, sliding_speed: 0.2, ..Inputs::NONE }).unwrap();
            joint.outputs().newton_iterations
        };
        go(load);
        let iterations = [1, 2, 1, 0, 1, 2, 1].map(|steps| go(load * 1.2_f64.powi(steps)));
        println!("{preset:?} {load} N/m: {iterations:?}");
        assert!(iterations.iter().all(|count| *count <= most), "{preset:?} {load} N/m: {iterations:?}");
    }
}

/// Walks at random in load (0.5 to 60 kN/m, up to a fifth a step), speed (-0.3 to 0.3 m/s) and slide-to-roll ratio (-0.99 to 0.99: a surface at
/// rest has drained), from this load and speed: every state is found. Returns the iterations of every step.
fn walk(preset: Preset, [mut load, mut speed]: [f64; 2], steps: usize) -> Vec<i32> {
    let parameters = Parameters { control: Control::Load, ..preset.parameters() };
    let mut joint = Simulation::new(&parameters).unwrap();
    let step = || -1.0..1.0_f64;
    let mut runner = TestRunner::deterministic();
    let changes = prop::collection::vec((step(), step(), step()), steps).new_tree(&mut runner).unwrap().current();
    let mut ratio: f64 = 0.0;
    let step = |(by_load, by_speed, by_ratio): (f64, f64, f64)| {
        load = (load * (0.2 * by_load).exp()).clamp(500.0, 60e3);
        speed = (speed + 0.03 * by_speed).clamp(-0.3, 0.3);
        ratio = (ratio + 0.1 * by_ratio).clamp(-0.99, 0.99);
        let inputs = Inputs { applied_load: load, sliding_speed: speed, slide_to_roll_ratio: ratio, ..Inputs::NONE };
        joint.solve_steady(inputs).unwrap();
        println!("{load:.4e} N/m, {speed:.4} m/s, ratio {ratio:.3}: {} iterations", joint.outputs().newton_iterations);
        joint.outputs().newton_iterations
    };
    changes.into_iter().map(step).collect()
}

fn median(mut values: Vec<i32>) -> i32 {
    values.sort_unstable();
    values[values.len() / 2]
}

/// The speed turns round on the way.
#[test]
fn a_random_walk_finds_every_state() {
    let iterations = walk(Preset::HumanFemoralCondyle, [5e3, 0.02], 25);
    assert!(median(iterations) < 30);
}

#[test]
#[ignore = "ten minutes"]
fn long_random_walks_find_every_state() {
    for preset in
        [Preset::HumanFemoralCondyle, Preset::HumanTibialPlateau, Preset::HumanNormal, Preset::BovineHumeralHead]
    {
        println!("{preset:?}");
        let iterations = walk(preset, [5e3, 0.2], 300);
        assert!(median(iterations) < 30, "{preset:?}");
    }
}
