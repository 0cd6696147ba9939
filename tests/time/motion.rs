//! Motion: limits, independence of the communication step, reversal, separation, and the work of a cycle.

use approx::assert_relative_eq;
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Control, Formulation, Inputs, Mesh, Parameters};
use cartilage_contact::simulation::{Drive, Simulation};

use crate::{between, coarse, depth, load, unlike};

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
fn a_cavitated_film_heals() {
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

/// A cycle of load and speed, with a reversal: what the bones put in is what film, pores and friction lose, what is stored and what leaves
/// the sector, in sum over the cycle and at every instant; of like bodies whose film parts them and of unlike ones that rub. The load's power and the storage's rate are the derivatives with respect to time.
#[test]
fn the_work_of_a_cycle_is_accounted_for() {
    for (ratio, rubs) in [(0.0, false), (0.4, false), (0.0, true), (0.4, true)] {
        let parameters = Parameters {
            mesh: Mesh { columns: 60, rows: 5, column_grading: 2.5, row_grading: 2.0 },
            ..coarse(Formulation::Consistent, Control::Load)
        };
        let parameters = if rubs { unlike(parameters) } else { parameters };
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
        // At every instant: where the solids rub in rolling, little is all there is.
        let bound = if ratio == 0.0 { 0.02 } else { 0.003 };
        assert!(worst.0 < bound * worst.1, "{worst:?}");
    }
}
