//! Squeeze films of the whole program in time: two layers so stiff that they are rigid, whose pores take no part.
//!
//! The closed forms are those of the parabola h = h0 + x^2/2R out to p = 0 at infinity: p = 6 eta R v / h^2, v the approach, and the
//! load is its integral. The film beyond the sector stores nothing in the model (the flux through an end is that of the sector), so the
//! sector has to be wide: at +-24.7 mm, 25 sqrt(2 R h0) and more, that changes the load by less than 1e-4.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use cartilage_contact::parameters::{Body, Control, Formulation, Inputs, Mesh, Parameters, TimeIntegration};
use cartilage_contact::simulation::{Drive, Simulation};

use crate::strip::orders;

const ETA: f64 = 1e-3;
const R: f64 = 0.05;

/// Two bodies that hardly deform.
pub fn rigid_bodies() -> Parameters {
    // Without Biot's coefficient the pores take no part.
    let body = Body {
        shear_modulus: 1e9,
        bulk_modulus: 1e9,
        permeability: 1e-24,
        biot_coefficient: 0.0,
        ..Parameters::default().upper
    };
    Parameters {
        upper: body,
        lower: body,
        formulation: Formulation::Consistent,
        time_integration: TimeIntegration::Transient,
        mesh: Mesh { columns: 60, rows: 1, column_grading: 2.5, row_grading: 0.0 },
        tolerance: 1e-7,
        ..Parameters::default()
    }
}

fn rigid(control: Control, relative_tolerance: f64, longest: f64) -> Simulation {
    let parameters = Parameters {
        control,
        relative_tolerance,
        maximum_internal_step: longest,
        sector_half_angle: ANGLE,
        mesh: Mesh { columns: 60, rows: 1, column_grading: 3.5, row_grading: 0.0 },
        ..rigid_bodies()
    };
    Simulation::new(&parameters).unwrap()
}

/// Half the angle of the sector.
const ANGLE: f64 = 0.25;

/// Load on the sector per approach speed of circular bodies, by the midpoint rule; the pressure at the ends is that of a parabola with
/// their gap and slope, 6 eta v / (h^2 h'/x).
fn resistance(h0: f64) -> f64 {
    let half_width = 0.1 * ANGLE.sin();
    let gap = |x: f64| h0 + 2.0 * (0.1 - (0.01 - x * x).sqrt());
    let n = 12_000;
    // p' = -12 eta v x / h^3, so that p = int from x to infinity of 12 eta v s / h(s)^3 ds.
    let step = half_width / f64::from(n);
    let slope = 2.0 * half_width / (0.01 - half_width * half_width).sqrt();
    let (mut pressure, mut load) = (6.0 * ETA * half_width / slope / gap(half_width).powi(2), 0.0);
    for i in (0..n).rev() {
        let x = (f64::from(i) + 0.5) * step;
        let rise = 12.0 * ETA * x / gap(x).powi(3) * step;
        load += 2.0 * (pressure + 0.5 * rise) * step;
        pressure += rise;
    }
    load
}

#[test]
fn the_resistance_of_circles_is_near_that_of_the_parabola() {
    let whole = 3.0 * 2.0_f64.sqrt() * PI * ETA * (R / 10e-6).powf(1.5);
    assert_relative_eq!(whole * 1e-4, 0.471_238_9, max_relative = 1e-6);
    assert_relative_eq!(resistance(10e-6), whole, max_relative = 1e-3);
}

/// The depth by its speed or by interpolation; the load follows at once.
#[test]
fn two_rigid_bodies_that_approach_carry_the_load_of_the_squeezed_film() {
    for interpolated in [false, true] {
        let mut simulation = rigid(Control::Depth, 1e-4, 1.0);
        let still = Inputs { penetration_depth: -12e-6, ..Inputs::NONE };
        simulation.solve_steady(still).unwrap();
        assert!(simulation.outputs().load.abs() < 1e-9);
        let drive = if interpolated {
            Drive { inputs: still, rates: Inputs { penetration_depth: 1e-4, ..Inputs::NONE } }
        } else {
            Drive::constant(Inputs { approach_speed: 1e-4, ..still })
        };
        simulation.advance(drive, 0.02).unwrap();
        assert_relative_eq!(simulation.outputs().penetration_depth, -10e-6, max_relative = 1e-12);
        assert_relative_eq!(simulation.outputs().load, 1e-4 * resistance(10e-6), max_relative = 2e-3);
    }
}

/// dh0/dt = -W / resistance(h0), integrated by Runge-Kutta of order four in small steps.
fn sunk(initial: f64, load: f64, duration: f64) -> f64 {
    let n = 200;
    let step = duration / f64::from(n);
    let slope = |h: f64| -load / resistance(h);
    (0..n).fold(initial, |h, _| {
        let a = slope(h);
        let b = slope(h + 0.5 * step * a);
        let c = slope(h + 0.5 * step * b);
        let d = slope(h + step * c);
        h + step / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    })
}

/// From 20 to 10 micron under 0.5 N/m: h0^(-1/2) grows in proportion to time (on the parabola without ends). Equal internal steps:
/// of order two. Steps of its own choice: as accurate as asked for, whatever the communication step.
#[test]
fn two_rigid_bodies_sink_under_a_constant_load() {
    let load = 0.5;
    let speed = load / (6.0 * 2.0_f64.sqrt() * PI * ETA * R.powf(1.5));
    let duration = (f64::powf(10e-6, -0.5) - f64::powf(20e-6, -0.5)) / speed;
    let sink = |relative_tolerance: f64, longest: f64, steps: u32| {
        // Held still at first: the load is then put on at once.
        let mut simulation = rigid(Control::Load, relative_tolerance, longest);
        let rolling = at_clearance(&mut simulation, 20e-6);
        let initial = -simulation.outputs().penetration_depth;
        let drive = Drive::constant(Inputs { applied_load: load, sliding_speed: 0.0, ..rolling });
        for _ in 0..steps {
            simulation.advance(drive, duration / f64::from(steps)).unwrap();
        }
        assert_relative_eq!(simulation.outputs().load, load, max_relative = 1e-6);
        (initial, -simulation.outputs().penetration_depth)
    };
    let (initial, fine) = sink(1e-6, 1.0, 1);
    let exact = sunk(initial, load, duration);
    assert_relative_eq!(fine, exact, max_relative = 1e-3);
    assert_relative_eq!(exact, 10e-6, max_relative = 1e-2);
    let errors = [8.0, 16.0, 32.0].map(|n| (sink(0.1, duration / n, 1).1 / fine - 1.0).abs());
    let observed = orders(&errors);
    println!("exact {exact}, fine {fine}, errors {errors:?}, orders {observed:?}");
    assert!((observed[1] - 2.0).abs() < 0.3, "{observed:?} of {errors:?}");
    for steps in [1, 7, 50] {
        // The errors of some ten internal steps add up.
        assert_relative_eq!(sink(1e-3, 1.0, steps).1, fine, max_relative = 3e-3);
    }
}

/// Brings the bodies to this clearance: by the load that the film of rolling bodies carries there.
fn at_clearance(simulation: &mut Simulation, clearance: f64) -> Inputs {
    let mut depth = rigid(Control::Depth, 1e-3, 1.0);
    let inputs = Inputs { penetration_depth: -clearance, sliding_speed: 0.2, ..Inputs::NONE };
    depth.solve_steady(inputs).unwrap();
    let rolling = Inputs { applied_load: depth.outputs().load, ..inputs };
    simulation.solve_steady(rolling).unwrap();
    assert_relative_eq!(simulation.outputs().penetration_depth, -clearance, max_relative = 1e-2);
    rolling
}
