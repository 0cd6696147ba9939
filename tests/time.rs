//! The simulation in time and under a given load: limits, independence of the communication step, reversal and separation,
//! states, and derivatives of the discrete step.

#![allow(clippy::unwrap_used, clippy::panic)]

use approx::assert_relative_eq;
use cartilage_contact::error::Error;
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Control, Formulation, Inputs, Mesh, Parameters, Preset, TimeIntegration};
use cartilage_contact::simulation::{Drive, Input, Simulation};

const MICRON: f64 = 1e-6;

fn coarse(formulation: Formulation, control: Control) -> Parameters {
    Parameters {
        formulation,
        control,
        time_integration: TimeIntegration::Transient,
        maximum_internal_step: 1e6,
        mesh: Mesh { columns: 40, rows: 3, column_grading: 2.5, row_grading: 2.0 },
        ..Parameters::default()
    }
}

fn depth(micron: f64, sliding_speed: f64) -> Inputs {
    Inputs { penetration_depth: micron * MICRON, sliding_speed, ..Inputs::NONE }
}

fn load(applied_load: f64, sliding_speed: f64) -> Inputs {
    Inputs { applied_load, sliding_speed, ..Inputs::NONE }
}

/// Inputs that go from one to the other in this time.
fn between(from: Inputs, to: Inputs, duration: f64) -> Drive {
    Drive { inputs: from, rates: to.combined(&from, |to, from| (to - from) / duration) }
}

#[test]
fn steady_is_the_limit_of_long_times() {
    for formulation in [Formulation::Paper, Formulation::Consistent] {
        for (control, first, then) in [
            (Control::Depth, depth(-5.0, 0.2), depth(8.0, 0.2)),
            (Control::Depth, depth(5.0, 0.2), depth(20.0, 0.1)),
            (Control::Load, load(5.0, 0.2), load(100.0, 0.1)),
        ] {
            let mut simulation = Simulation::new(&coarse(formulation, control)).unwrap();
            simulation.solve_steady(then).unwrap();
            let steady = simulation.outputs().clone();
            simulation.solve_steady(first).unwrap();
            simulation.advance(between(first, then, 0.1), 0.1).unwrap();
            let early = simulation.outputs().clone();
            for _ in 0..8 {
                simulation.advance(Drive::constant(then), 1e3).unwrap();
            }
            let late = simulation.outputs();
            assert_relative_eq!(late.load, steady.load, max_relative = 1e-5);
            assert_relative_eq!(late.penetration_depth, steady.penetration_depth, max_relative = 1e-5);
            assert_relative_eq!(late.central_film_thickness, steady.central_film_thickness, max_relative = 1e-4);
            // Otherwise there was nothing to wait for.
            let change = (early.load / steady.load - 1.0).abs()
                + (early.penetration_depth / steady.penetration_depth - 1.0).abs();
            assert!(change > 1e-2, "{formulation:?} {control:?}: {change}");
        }
    }
}

/// The same motion in communication steps of different lengths; the film closes and opens on the way.
#[test]
fn results_do_not_depend_on_the_communication_step() {
    let at = |t: f64| depth(20.0 - 15.0 * (2.0 * std::f64::consts::PI * t / 0.4).cos(), 0.1);
    let run = |steps: u32, relative_tolerance: f64| {
        let parameters = Parameters { relative_tolerance, ..coarse(Formulation::Paper, Control::Depth) };
        let mut simulation = Simulation::new(&parameters).unwrap();
        simulation.solve_steady(at(0.0)).unwrap();
        // The way is made of twenty straight pieces.
        let piece = |i: u32| between(at(f64::from(i) * 0.02), at(f64::from(i + 1) * 0.02), 0.02);
        let mut loads = Vec::new();
        for i in 0..20 {
            let Drive { inputs, rates } = piece(i);
            for k in 0..steps {
                let time = 0.02 * f64::from(k) / f64::from(steps);
                let inputs = inputs.combined(&rates, |value, rate| value + time * rate);
                simulation.advance(Drive { inputs, rates }, 0.02 / f64::from(steps)).unwrap();
            }
            loads.push(simulation.outputs().load);
        }
        loads
    };
    let reference = run(1, 2e-5);
    let largest = reference.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    for steps in [1, 3, 10] {
        let worst = run(steps, 1e-3).iter().zip(&reference).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        println!("{steps} steps a piece: {:e} of the largest load", worst / largest);
        assert!(worst < 3e-3 * largest, "{steps}: {worst} of {largest}");
    }
}

/// The depth that carries a load, steady: over seven decades, in film and in contact, moving and at rest.
#[test]
fn the_depth_of_a_load_carries_that_load() {
    for formulation in [Formulation::Paper, Formulation::Consistent] {
        let mut by_load = Simulation::new(&coarse(formulation, Control::Load)).unwrap();
        let mut by_depth = Simulation::new(&coarse(formulation, Control::Depth)).unwrap();
        for (given, speed) in [(1e-3, 0.2), (50.0, 0.2), (70.0, 0.2), (2000.0, 0.2), (500.0, 0.0), (20.0, -0.1)] {
            by_load.solve_steady(load(given, speed)).unwrap();
            let found = by_load.outputs().clone();
            assert_relative_eq!(found.load, given, max_relative = 1e-6);
            by_depth.solve_steady(Inputs { penetration_depth: found.penetration_depth, ..depth(0.0, speed) }).unwrap();
            assert_relative_eq!(by_depth.outputs().load, given, max_relative = 1e-4);
            assert_relative_eq!(by_depth.outputs().contact_length, found.contact_length, epsilon = 1e-6);
        }
    }
}

/// At rest and in motion, steady and from a light touch in time.
#[test]
fn thirty_per_cent_of_compression_under_load() {
    for speed in [0.0, 0.2] {
        let wide = Parameters { sector_half_angle: 0.15, ..coarse(Formulation::Consistent, Control::Depth) };
        let mut simulation = Simulation::new(&wide).unwrap();
        simulation.solve_steady(depth(600.0, speed)).unwrap();
        let given = simulation.outputs().load;
        let mut simulation = Simulation::new(&Parameters { control: Control::Load, ..wide }).unwrap();
        simulation.solve_steady(load(given, speed)).unwrap();
        assert_relative_eq!(simulation.outputs().penetration_depth, 600.0 * MICRON, max_relative = 1e-5);
        // In time, before the tissue drains it gives way less.
        simulation.solve_steady(load(10.0, speed)).unwrap();
        assert_eq!(simulation.outputs().solid_load == 0.0, speed > 0.0);
        simulation.advance(between(load(10.0, speed), load(given, speed), 0.2), 0.2).unwrap();
        let at_once = simulation.outputs().penetration_depth;
        assert!(at_once > 100.0 * MICRON && at_once < 590.0 * MICRON, "{at_once}");
        assert!(simulation.outputs().fluid_load_support > 0.2);
        for _ in 0..6 {
            simulation.advance(Drive::constant(load(given, speed)), 1e3).unwrap();
        }
        assert_relative_eq!(simulation.outputs().penetration_depth, 600.0 * MICRON, max_relative = 1e-4);
    }
}

#[test]
fn a_load_that_no_film_carries_is_refused_with_the_least_one() {
    let mut simulation = Simulation::new(&coarse(Formulation::Paper, Control::Load)).unwrap();
    for given in [0.0, -5.0] {
        let error = simulation.solve_steady(load(given, 0.2)).unwrap_err();
        assert!(matches!(error, Error::Value { .. }) && error.to_string().contains("1e-6 N/m or more"), "{error}");
    }
    // In time no load at all lets the bodies drift apart.
    simulation.solve_steady(load(20.0, 0.2)).unwrap();
    let before = simulation.outputs().penetration_depth;
    simulation.advance(between(load(20.0, 0.2), load(0.0, 0.2), 0.01), 0.01).unwrap();
    simulation.advance(Drive::constant(load(0.0, 0.2)), 0.05).unwrap();
    assert!(simulation.outputs().load.abs() < 1e-4);
    assert!(simulation.outputs().penetration_depth < before - 1.0 * MICRON);
}

/// Results on the way from stop to stop, each at its time, in so many communication steps from one to the next.
fn through(simulation: &mut Simulation, stops: &[(f64, Inputs)], steps: u32) -> Vec<Outputs> {
    simulation.solve_steady(stops[0].1).unwrap();
    let mut course = Vec::new();
    for pair in stops.windows(2) {
        let duration = pair[1].0 - pair[0].0;
        let Drive { inputs, rates } = between(pair[0].1, pair[1].1, duration);
        for k in 0..steps {
            let time = duration * f64::from(k) / f64::from(steps);
            let inputs = inputs.combined(&rates, |value, rate| value + time * rate);
            simulation.advance(Drive { inputs, rates }, duration / f64::from(steps)).unwrap();
            course.push(simulation.outputs().clone());
        }
    }
    course
}

/// Speed through zero twice; pressed, pulled apart with suction, and pressed again.
#[test]
fn reversal_and_separation() {
    for formulation in [Formulation::Paper, Formulation::Consistent] {
        let run = |relative_tolerance: f64| {
            let parameters = Parameters { relative_tolerance, ..coarse(formulation, Control::Depth) };
            let mut simulation = Simulation::new(&parameters).unwrap();
            let stops = [
                (0.0, depth(15.0, 0.2)),
                (0.05, depth(25.0, 0.0)),
                (0.10, depth(30.0, -0.2)),
                (0.11, depth(5.0, -0.2)),
                (0.12, depth(-15.0, 0.0)),
                (0.13, depth(-15.0, 0.2)),
                (0.15, depth(20.0, 0.2)),
            ];
            through(&mut simulation, &stops, 5)
        };
        let (course, fine) = (run(1e-3), run(1e-4));
        assert!(course.iter().any(|o| o.contact_length > 0.0));
        // Pulled apart: the film pulls.
        assert!(course.iter().any(|o| o.load < -1.0 && o.minimum_fluid_pressure < -1e3));
        let largest = fine.iter().fold(0.0_f64, |a, o| a.max(o.load.abs()));
        for (o, f) in course.iter().zip(&fine) {
            assert!((o.load - f.load).abs() < 1e-2 * largest, "{formulation:?}: {} {}", o.load, f.load);
            assert!(o.friction_coefficient.is_finite() && o.minimum_film_thickness >= 0.0);
        }
        // Friction follows the speed.
        assert!(course[2].upper_friction_force > 0.0 && course[7].upper_friction_force < 0.0);
    }
}

/// Pressed, pulled apart, pressed again and set in motion with a film that may cavitate: no suction below the cavitation pressure, and in
/// the end the past is forgotten.
#[test]
fn a_torn_film_heals() {
    for formulation in [Formulation::Paper, Formulation::Consistent] {
        let stops =
            [(0.0, depth(5.0, 0.0)), (0.02, depth(-15.0, 0.0)), (0.04, depth(5.0, 0.0)), (0.06, depth(5.0, 0.1))];
        let run = |relative_tolerance: f64| {
            let parameters = Parameters {
                relative_tolerance,
                cavitation: true,
                cavitation_pressure: -300.0,
                ..coarse(formulation, Control::Depth)
            };
            let mut simulation = Simulation::new(&parameters).unwrap();
            let course = through(&mut simulation, &stops, 5);
            (simulation, course)
        };
        let ((mut simulation, course), (_, fine)) = (run(1e-3), run(1e-4));
        let largest = fine.iter().fold(0.0_f64, |a, o| a.max(o.load.abs()));
        for (o, f) in course.iter().zip(&fine) {
            assert!(o.minimum_fluid_pressure > -300.0 - 1e-6, "{formulation:?}: {}", o.minimum_fluid_pressure);
            assert!((o.load - f.load).abs() < 1e-2 * largest, "{formulation:?}: {} {}", o.load, f.load);
        }
        // Without cavitation it pulls at ten times that.
        assert!(course[2].cavitated_length > 1e-3 && course[2].load > -2.0);
        for _ in 0..4 {
            simulation.advance(Drive::constant(stops[3].1), 1e3).unwrap();
        }
        let late = simulation.outputs().clone();
        simulation.solve_steady(stops[3].1).unwrap();
        assert_relative_eq!(late.load, simulation.outputs().load, max_relative = 1e-5);
        assert_eq!(late.cavitated_length, simulation.outputs().cavitated_length);
        assert!(late.cavitated_length > 1e-4);
    }
}

/// Pressed into contact, pulled apart with suction and closed again, sliding to and fro. The second differences of the loads at
/// communication points four times as close are a sixteenth where the course is smooth and a fourth at a corner; a jump, of 1 % of
/// the largest load already, would leave them what they are.
#[test]
fn loads_do_not_jump_where_the_film_closes_opens_or_turns() {
    for formulation in [Formulation::Paper, Formulation::Consistent] {
        let parameters = Parameters {
            mesh: Mesh { columns: 20, rows: 2, column_grading: 2.5, row_grading: 2.0 },
            ..coarse(formulation, Control::Depth)
        };
        let second_differences = |steps: i32| {
            let at = |k: i32| {
                let angle = 2.0 * std::f64::consts::PI * f64::from(k) / f64::from(steps);
                depth(10.0 + 25.0 * angle.sin(), 0.2 * (1.5 * angle).cos())
            };
            let mut simulation = Simulation::new(&parameters).unwrap();
            simulation.solve_steady(at(0)).unwrap();
            let mut course = vec![simulation.outputs().clone()];
            for k in 0..steps {
                let duration = 0.2 / f64::from(steps);
                simulation.advance(between(at(k), at(k + 1), duration), duration).unwrap();
                course.push(simulation.outputs().clone());
            }
            assert!(course.iter().any(|o| o.solid_load > 10.0) && course.iter().any(|o| o.load < -1.0));
            [|o: &Outputs| o.load, |o: &Outputs| o.fluid_load, |o: &Outputs| o.solid_load].map(|get| {
                let difference = |three: &[Outputs]| get(&three[2]) - 2.0 * get(&three[1]) + get(&three[0]);
                course.windows(3).map(|three| difference(three).abs()).fold(0.0, f64::max)
            })
        };
        let (far, near) = (second_differences(50), second_differences(200));
        println!("{formulation:?}: {far:?}, four times as close {near:?}");
        assert!(far.iter().zip(near).all(|(far, near)| near < 0.4 * far), "{formulation:?}: {far:?} {near:?}");
    }
}

/// Pressed together and pulled apart without sliding, from where nothing is stored: the work put in is never given back in full, and
/// what is lost on a slow way is in proportion to its speed. A film that closed or opened with a jump would lose, or give, the
/// same at every speed.
#[test]
fn closing_and_opening_lose_work_and_less_the_slower() {
    let parameters = Parameters {
        mesh: Mesh { columns: 16, rows: 2, column_grading: 2.5, row_grading: 2.0 },
        ..coarse(Formulation::Consistent, Control::Depth)
    };
    let lost = |duration: f64| {
        let steps = 60;
        let at = |k: i32| {
            let angle = 2.0 * std::f64::consts::PI * f64::from(k) / f64::from(steps);
            depth(7.5 - 17.5 * angle.cos(), 0.0)
        };
        let mut simulation = Simulation::new(&parameters).unwrap();
        simulation.solve_steady(at(0)).unwrap();
        let (mut work, mut most, mut touched) = (0.0, 0.0_f64, false);
        for k in 0..steps {
            let before = simulation.outputs().load;
            let step = duration / f64::from(steps);
            simulation.advance(between(at(k), at(k + 1), step), step).unwrap();
            let approach = at(k + 1).penetration_depth - at(k).penetration_depth;
            work += 0.5 * (before + simulation.outputs().load) * approach;
            most = most.max(work);
            touched |= simulation.outputs().solid_load > 1.0;
            assert!(work > -1e-6 * most, "after step {k} of {duration} s: {work} J/m of {most} given back");
        }
        assert!(touched && simulation.outputs().solid_load == 0.0);
        work / most
    };
    let lost_fractions = [0.1, 20.0, 40.0, 80.0].map(lost);
    println!("lost: {lost_fractions:?}");
    assert!(lost_fractions[0] > 0.2 && lost_fractions[0] < 1.0);
    assert_relative_eq!(lost_fractions[1] / lost_fractions[2], 2.0, max_relative = 0.1);
    assert_relative_eq!(lost_fractions[2] / lost_fractions[3], 2.0, max_relative = 0.05);
}

fn course(simulation: &mut Simulation, from: i32, to: i32) -> Vec<Outputs> {
    (from..to)
        .map(|k| {
            let at = |k: i32| load(60.0 + 20.0 * (f64::from(k) * 0.7).sin(), 0.1 + 0.05 * (f64::from(k) * 0.3).cos());
            simulation.advance(between(at(k), at(k + 1), 5e-3), 5e-3).unwrap();
            simulation.outputs().clone()
        })
        .collect()
}

#[test]
fn a_state_goes_on_with_the_same_bits() {
    let parameters = coarse(Formulation::Paper, Control::Load);
    let mut simulation = Simulation::new(&parameters).unwrap();
    simulation.solve_steady(load(60.0, 0.15)).unwrap();
    course(&mut simulation, 0, 4);
    let saved = simulation.snapshot();
    let (slope, rate) =
        (simulation.derivatives(Input::AppliedLoad).unwrap().clone(), simulation.rates().unwrap().clone());
    let on = course(&mut simulation, 4, 8);
    simulation.restore(&saved).unwrap();
    assert_eq!(course(&mut simulation, 4, 8), on);
    let mut fresh = Simulation::new(&parameters).unwrap();
    fresh.restore(&saved).unwrap();
    assert_eq!(fresh.derivatives(Input::AppliedLoad).unwrap(), &slope);
    assert_eq!(fresh.rates().unwrap(), &rate);
    assert_eq!(course(&mut fresh, 4, 8), on);
    // A step that is refused leaves no trace.
    fresh.restore(&saved).unwrap();
    assert!(fresh.advance(Drive::constant(load(f64::NAN, 0.1)), 1e-3).is_err());
    assert!(fresh.advance(Drive::constant(load(60.0, 0.1)), 0.0).is_err());
    assert_eq!(fresh.snapshot(), saved);
    assert_eq!(course(&mut fresh, 4, 8), on);
}

/// Tangents are kept from step to step. What was asked for in between, saving and restoring, and the number of threads change nothing.
#[test]
fn a_quasi_steady_stream_has_the_same_bits_whatever_is_asked_of_it() {
    let quasi_steady = Parameters {
        time_integration: TimeIntegration::QuasiSteady,
        tolerance: 1e-10,
        ..coarse(Formulation::Paper, Control::Depth)
    };
    let at = |k: i32| depth(8.0 + 4.0 * (0.1 * f64::from(k)).sin(), 0.2);
    let stream = |simulation: &mut Simulation, from: i32, to: i32, ask: bool| -> Vec<Outputs> {
        let step = |k: i32| {
            simulation.advance(between(at(k), at(k + 1), 1e-3), 1e-3).unwrap();
            if ask {
                simulation.derivatives(Input::SlidingSpeed).unwrap();
                simulation.restore(&simulation.snapshot()).unwrap();
            }
            simulation.outputs().clone()
        };
        (from..to).map(step).collect()
    };
    let mut simulation = Simulation::new(&quasi_steady).unwrap();
    let plain = stream(&mut simulation, 0, 24, false);
    let mut asked = Simulation::new(&quasi_steady).unwrap();
    asked.set_threads(2);
    assert_eq!(stream(&mut asked, 0, 12, true), plain[..12]);
    let mut fresh = Simulation::new(&quasi_steady).unwrap();
    fresh.restore(&asked.snapshot()).unwrap();
    assert_eq!(stream(&mut fresh, 12, 24, false), plain[12..]);
    // And they are the states that are found from rest, to the tolerance.
    for k in [5, 17, 23] {
        let mut alone = Simulation::new(&quasi_steady).unwrap();
        alone.solve_steady(at(k + 1)).unwrap();
        for ((name, value), (_, kept)) in numbers(alone.outputs()).into_iter().zip(numbers(&plain[k as usize])) {
            let error = (value - kept).abs() / size(name, alone.outputs());
            assert!(error < 1e-6, "{name} at {k}: {value}, {kept}");
        }
    }
}

fn numbers(o: &Outputs) -> Vec<(&'static str, f64)> {
    vec![
        ("load", o.load),
        ("fluid_load", o.fluid_load),
        ("solid_load", o.solid_load),
        ("upper_friction_force", o.upper_friction_force),
        ("lower_friction_force", o.lower_friction_force),
        ("upper_force_x", o.upper_force_x),
        ("upper_moment", o.upper_moment),
        ("stored_elastic_energy", o.stored_elastic_energy),
        ("pore_flow_dissipation", o.pore_flow_dissipation),
        ("friction_coefficient", o.friction_coefficient),
        ("fluid_load_support", o.fluid_load_support),
        ("minimum_film_thickness", o.minimum_film_thickness),
        ("central_film_thickness", o.central_film_thickness),
        ("contact_length", o.contact_length),
        ("maximum_fluid_pressure", o.maximum_fluid_pressure),
        ("maximum_contact_pressure", o.maximum_contact_pressure),
        ("maximum_von_mises_stress", o.maximum_von_mises_stress),
        ("penetration_depth", o.penetration_depth),
        ("net_fluid_exudation", o.net_fluid_exudation),
        ("film_thickness[40]", o.film_thickness[40]),
        ("fluid_pressure[45]", o.fluid_pressure[45]),
    ]
}

/// Sizes below which a difference is round-off of Newton's method.
fn size(name: &str, o: &Outputs) -> f64 {
    match name {
        n if n.contains("thickness") || n.contains("length") || n == "penetration_depth" => MICRON,
        n if n.contains("pressure") || n.contains("stress") => o.maximum_fluid_pressure.abs(),
        n if n.contains("force") => o.load.abs() * o.friction_coefficient,
        "stored_elastic_energy" => o.stored_elastic_energy,
        "pore_flow_dissipation" => o.pore_flow_dissipation,
        n if n.contains("moment") => 1e-3 * o.load.abs(),
        n if n.ends_with("load") => o.load.abs(),
        n if n.contains("exudation") => o.fluid_exudation,
        _ => 1.0,
    }
}

/// Bodies that are drawn apart hang on the film's suction: ratios to a load that is none are 0, and forces and moments stay.
#[test]
fn suction_has_no_friction_coefficient() {
    for rms in [0.0, 0.5e-6] {
        let parameters = Parameters { surface_roughness: rms, ..coarse(Formulation::Consistent, Control::Depth) };
        let mut simulation = Simulation::new(&parameters).unwrap();
        let mut inputs = depth(6.0, 0.1);
        simulation.solve_steady(inputs).unwrap();
        assert!(simulation.outputs().friction_coefficient > 1e-4);
        inputs.approach_speed = -2e-3;
        let mut least = f64::INFINITY;
        for _ in 0..8 {
            simulation.advance(Drive::constant(inputs), 1e-3).unwrap();
            inputs.penetration_depth -= 2e-6;
            let o = simulation.outputs();
            least = least.min(o.load);
            println!("{} {} {}", o.load, o.friction_coefficient, o.fluid_load_support);
            let ratios =
                [o.friction_coefficient, o.fluid_friction_coefficient, o.fluid_load_support, o.sommerfeld_number];
            assert!(ratios.iter().all(|ratio| ratio.abs() < 10.0), "{ratios:?} at {} N/m", o.load);
            if o.load <= 0.0 {
                assert!(o.friction_coefficient == 0.0 && o.fluid_load_support == 0.0 && o.upper_force_y < 0.0);
            }
        }
        assert!(least < -1.0, "{least} N/m");
    }
}

/// Derivatives of the discrete step by every input against central differences: 1e-5 of the derivative plus 1e-5 of the output's size
/// over the input's. Varied: formulation, control, film, contact and cavitated film, one and several internal steps. Internal steps are bounded so
/// that they stay the same.
#[test]
fn derivatives_of_the_discrete_step() {
    let step = 2e-3;
    for (formulation, control, first, then, longest, cavitation) in [
        (Formulation::Paper, Control::Depth, depth(5.0, 0.2), depth(6.0, 0.19), 1.0, false),
        (Formulation::Consistent, Control::Depth, depth(22.0, 0.1), depth(22.5, 0.11), 1e-3, false),
        (Formulation::Paper, Control::Depth, depth(20.0, 0.1), depth(20.5, 0.11), 5e-4, false),
        (Formulation::Paper, Control::Load, load(40.0, 0.2), load(42.0, 0.19), 1e-3, false),
        (Formulation::Consistent, Control::Load, load(150.0, 0.1), load(152.0, 0.11), 5e-4, false),
        (Formulation::Paper, Control::Depth, depth(3.0, 0.2), depth(2.5, 0.19), 1e-3, true),
        (Formulation::Consistent, Control::Load, load(40.0, 0.2), load(42.0, 0.19), 1e-3, true),
    ] {
        let parameters = Parameters {
            tolerance: 1e-11,
            relative_tolerance: 0.1,
            maximum_internal_step: longest,
            cavitation,
            cavitation_pressure: -1e3,
            ..coarse(formulation, control)
        };
        let mut simulation = Simulation::new(&parameters).unwrap();
        let first = Inputs { slide_to_roll_ratio: 0.3, ..first };
        let then = Inputs { slide_to_roll_ratio: 0.3, ..then };
        simulation.solve_steady(first).unwrap();
        simulation.advance(between(first, then, step), step).unwrap();
        let start = simulation.snapshot();
        let drive = Drive {
            inputs: Inputs { approach_speed: 1e-4, ..then },
            rates: Inputs { sliding_speed: 2.0, ..Inputs::NONE },
        };
        simulation.advance(drive, step).unwrap();
        let value = simulation.outputs().clone();
        let touching = value.contact_length > 0.0;
        assert_eq!(value.cavitated_length > 0.0, cavitation);
        for (input, scale) in Input::ALL.into_iter().zip([1e-5, 0.2, 1.0, 1e-2, 50.0]) {
            let exact = simulation.derivatives(input).unwrap().clone();
            let h = scale * if touching { 1e-6 } else { 1e-4 };
            let moved = |s: f64| {
                let mut other = Simulation::new(&parameters).unwrap();
                other.restore(&start).unwrap();
                let mut inputs = drive.inputs;
                match input {
                    Input::PenetrationDepth => inputs.penetration_depth += s,
                    Input::SlidingSpeed => inputs.sliding_speed += s,
                    Input::SlideToRollRatio => inputs.slide_to_roll_ratio += s,
                    Input::ApproachSpeed => inputs.approach_speed += s,
                    Input::AppliedLoad => inputs.applied_load += s,
                }
                other.advance(Drive { inputs, ..drive }, step).unwrap();
                numbers(other.outputs())
            };
            let (plus, minus) = (moved(h), moved(-h));
            for (i, (name, exact)) in numbers(&exact).into_iter().enumerate() {
                let difference = (plus[i].1 - minus[i].1) / (2.0 * h);
                let error = (difference - exact).abs() / (exact.abs() + size(name, &value) / scale);
                assert!(
                    error < 1e-5,
                    "{formulation:?} {control:?} {input:?} {name}: {exact:e}, by differences {difference:e} ({error:e})"
                );
            }
        }
    }
}

/// A cycle of load and speed, with a reversal: what the bones put in is what film, pores and friction lose, what is stored and what leaves
/// the sector, in sum over the cycle and at every instant. The load's power and the storage's rate are the derivatives with respect to time.
#[test]
fn the_work_of_a_cycle_is_accounted_for() {
    for ratio in [0.0, 0.4] {
        let parameters = Parameters {
            mesh: Mesh { columns: 60, rows: 5, column_grading: 2.5, row_grading: 2.0 },
            ..coarse(Formulation::Consistent, Control::Load)
        };
        let (period, steps) = (0.8, 24);
        let at = |step: u32| {
            let phase = 2.0 * std::f64::consts::PI * f64::from(step) / f64::from(steps);
            let load = load(30.0 - 15.0 * phase.cos() - 5.0 * (2.0 * phase).cos(), 0.06 + 0.14 * phase.cos());
            Inputs { slide_to_roll_ratio: ratio, ..load }
        };
        let mut simulation = Simulation::new(&parameters).unwrap();
        simulation.solve_steady(at(0)).unwrap();
        let step = period / f64::from(steps);
        // Put in by rotation and by the load; lost in film, pores and friction; carried off; stored.
        let mut work = [0.0; 7];
        let mut worst = (0.0_f64, 0.0_f64);
        for i in 0..steps {
            simulation.advance(between(at(i), at(i + 1), step), step).unwrap();
            let (o, rates) = (simulation.outputs().clone(), simulation.rates().unwrap());
            let powers = [
                o.rotation_power,
                o.normal_force * rates.penetration_depth,
                o.film_dissipation,
                o.pore_flow_dissipation,
                o.boundary_friction_dissipation,
                o.carried_power,
                rates.stored_elastic_energy,
            ];
            let missing = powers[0] + powers[1] - powers[2..].iter().sum::<f64>();
            worst = (worst.0.max(missing.abs()), worst.1.max(powers[0].abs() + powers[1].abs()));
            work.iter_mut().zip(powers).for_each(|(sum, power)| *sum += power * step);
        }
        let missing = work[0] + work[1] - work[2..].iter().sum::<f64>();
        println!("{ratio}: {work:?} J/m, missing {missing}; at an instant {:?} W/m", worst);
        assert!(missing.abs() < 0.01 * (work[2] + work[3] + work[4]), "{work:?}");
    }
}

/// The contact stiffness in time against central differences of the step, 1e-4; from a tolerance to the next it changes by what the
/// step itself does.
#[test]
fn contact_stiffness_is_that_of_the_step() {
    let mut found = Vec::new();
    for control in [Control::Depth, Control::Load] {
        for relative_tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
            let parameters = Parameters {
                tolerance: 1e-11,
                relative_tolerance,
                width: 0.5,
                ..coarse(Formulation::Consistent, control)
            };
            let mut simulation = Simulation::new(&parameters).unwrap();
            let (first, then) =
                (Inputs { applied_load: 40.0, ..depth(8.0, 0.2) }, Inputs { applied_load: 45.0, ..depth(9.0, 0.2) });
            simulation.solve_steady(first).unwrap();
            simulation.advance(between(first, then, 5e-3), 5e-3).unwrap();
            let start = simulation.snapshot();
            let mut ahead = |s: f64| {
                simulation.restore(&start).unwrap();
                let more = match control {
                    Control::Depth => Inputs { penetration_depth: s * 1e-9, ..Inputs::NONE },
                    Control::Load => Inputs { applied_load: s * 1e-2, ..Inputs::NONE },
                };
                let from = then.combined(&more, |a, b| a + b);
                simulation
                    .advance(Drive { inputs: from, rates: Inputs { penetration_depth: 1e-4, ..Inputs::NONE } }, 5e-3)
                    .unwrap();
                (simulation.outputs().clone(), simulation.contact_stiffness().unwrap())
            };
            let (plus, minus, (_, stiffness)) = (ahead(1.0).0, ahead(-1.0).0, ahead(0.0));
            let difference =
                (plus.normal_force - minus.normal_force) / (plus.penetration_depth - minus.penetration_depth);
            println!("{control:?}, tolerance {relative_tolerance}: {stiffness:e} N/m, by differences {difference:e}");
            assert!((stiffness / difference - 1.0).abs() < 1e-4, "{stiffness:e} {difference:e}");
            found.push(stiffness);
        }
    }
    for of_control in found.chunks_exact(4) {
        assert!((of_control[2] / of_control[3] - 1.0).abs() < 0.02, "{of_control:?}");
    }
}

/// d/dt at the end of a step against differences over short steps that go on in the same way.
#[test]
fn derivatives_by_time() {
    for (control, first, then) in
        [(Control::Depth, depth(5.0, 0.2), depth(9.0, 0.15)), (Control::Load, load(40.0, 0.2), load(60.0, 0.15))]
    {
        let parameters = Parameters { tolerance: 1e-10, ..coarse(Formulation::Consistent, control) };
        let mut simulation = Simulation::new(&parameters).unwrap();
        simulation.solve_steady(first).unwrap();
        let drive = between(first, then, 0.1);
        simulation.advance(drive, 0.1).unwrap();
        let rates = simulation.rates().unwrap().clone();
        let values = simulation.outputs().clone();
        let short = 2e-5;
        let mut ahead = |steps: f64| {
            let inputs =
                drive.inputs.combined(&drive.rates, |value, rate| value + (0.1 + (steps - 1.0) * short) * rate);
            simulation.advance(Drive { inputs, ..drive }, short).unwrap();
            numbers(simulation.outputs())
        };
        let (one, two) = (ahead(1.0), ahead(2.0));
        for (i, (name, rate)) in numbers(&rates).into_iter().enumerate() {
            if name == "net_fluid_exudation" {
                continue;
            }
            let now = numbers(&values)[i].1;
            let difference = (4.0 * one[i].1 - 3.0 * now - two[i].1) / (2.0 * short);
            let error = (difference - rate).abs() / (rate.abs() + size(name, &values) / 0.1);
            assert!(error < 1e-2, "{control:?} {name}: {rate:e}, by differences {difference:e} ({error:e})");
        }
    }
}

/// Other parameters during a run: twice as viscous a fluid leaves a film under the same load half as fast, from where it was.
#[test]
fn other_parameters_go_on_from_what_film_and_tissue_hold() {
    for formulation in [Formulation::Paper, Formulation::Consistent] {
        let first = coarse(formulation, Control::Load);
        let mut simulation = Simulation::new(&first).unwrap();
        simulation.solve_steady(load(20.0, 0.2)).unwrap();
        let still = Drive::constant(load(20.0, 0.0));
        let short = 1e-5;
        let step = |simulation: &mut Simulation| {
            let before = simulation.outputs().penetration_depth;
            simulation.advance(still, short).unwrap();
            (simulation.outputs().penetration_depth - before) / short
        };
        simulation.advance(still, 1e-3).unwrap();
        let as_it_was = step(&mut simulation);
        // Twice the permeability too: tissue then drains as before.
        let mut viscous = first;
        viscous.viscosity *= 2.0;
        viscous.upper.permeability *= 2.0;
        viscous.lower.permeability *= 2.0;
        let results = simulation.outputs().clone();
        let mut simulation = simulation.with_parameters(&viscous).unwrap();
        assert_eq!(*simulation.outputs(), results);
        let halved = step(&mut simulation);
        assert!(as_it_was > 3e-5, "{as_it_was} m/s");
        assert_relative_eq!(halved, 0.5 * as_it_was, max_relative = 0.05);
    }
}

/// Where rows follow the permeability, fields go over to the new ones; where only one body changes, there are two from then on.
#[test]
fn other_parameters_are_reached_on_other_rows_and_with_one_body_changed() {
    let preset = Parameters {
        mesh: Mesh { columns: 64, rows: 6, ..Preset::HumanNormal.parameters().mesh },
        ..Preset::HumanNormal.parameters()
    };
    let mut simulation = Simulation::new(&preset).unwrap();
    simulation.solve_steady(depth(10.0, 0.1)).unwrap();
    let before = simulation.outputs().load;
    let mut changed = preset;
    changed.upper.permeability *= 20.0;
    let mut simulation = simulation.with_parameters(&changed).unwrap();
    assert_eq!(simulation.outputs().load, before);
    simulation.solve_steady(depth(10.0, 0.1)).unwrap();
    let mut fresh = Simulation::new(&changed).unwrap();
    fresh.solve_steady(depth(10.0, 0.1)).unwrap();
    assert_relative_eq!(simulation.outputs().load, fresh.outputs().load, max_relative = 1e-6);
    assert!((before / fresh.outputs().load - 1.0).abs() > 1e-3, "the permeability plays a part");

    let finer = Parameters { mesh: Mesh { rows: 7, ..changed.mesh }, ..changed };
    assert!(matches!(simulation.with_parameters(&finer), Err(Error::State(_))));
}
