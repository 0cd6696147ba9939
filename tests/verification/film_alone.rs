//! The film alone, between rigid impermeable bodies.
//!
//! Full Sommerfeld condition, h = h0 + x^2/2R (Martin 1916): h* = (4/3) h0, p = -2 eta U x/h^2, no load,
//! p_max = (9/8) sqrt(2/3) eta U sqrt(R) h0^(-3/2) at x = -sqrt(2 R h0/3), and friction sqrt2 pi eta U sqrt(R/h0).
//! Squeezed, U = 0: p = -6 eta R (dh0/dt)/h^2, W = 3 sqrt2 pi eta (R/h0)^(3/2) |dh0/dt|; under a constant load
//! h0^(-1/2)(t) = h0^(-1/2)(0) + W t/(6 sqrt2 pi eta R^(3/2)).
//! Between circles that run on as parabolas beyond x = +-8.7156 mm, with p = 0 at infinity: p = 6 eta U int (h - h*)/h^3, by
//! quadrature.

use std::f64::consts::{PI, SQRT_2};

use approx::assert_relative_eq;
use cartilage_contact::equations::film::MassRate;
use cartilage_contact::laws::fluid::Fluid;
use cartilage_contact::parameters::{Body, Formulation, Inputs, Mesh, Parameters};
use cartilage_contact::simulation::Simulation;

use crate::line::Line;
use crate::strip::orders;

const R: f64 = 0.05;
const ETA: f64 = 1e-3;
const U: f64 = 0.2;

/// A film under a parabola on |x| <= `reach` sqrt(2 R h0), uniformly meshed.
fn parabola(h0: f64, reach: f64, columns: usize, order: i32, sliding_speed: f64) -> Line {
    let film = crate::line::film(Fluid::Newtonian(ETA), order);
    let half = reach * (2.0 * R * h0).sqrt();
    let stations: Vec<f64> = (0..=2 * columns).map(|i| half * (i as f64 / columns as f64 - 1.0)).collect();
    Line::new(film, stations, |x| h0 + x * x / (2.0 * R), sliding_speed)
}

/// The exact pressure at the ends makes a finite film as good as an infinite one.
fn with_ends(mut line: Line, exact: impl Fn(f64) -> f64) -> Line {
    let last = line.stations.len() - 1;
    for end in [0, last] {
        line.pressure[end] = exact(line.stations[end]);
    }
    line
}

/// Varied: h0 = 1, 10, 50 micron. Peak pressure and its place to 1e-4 on 200 elements (nodal values, peak between nodes 1e-4).
#[test]
fn rolling_parabola_has_martins_pressure() {
    for (h0, p_max, x_max) in
        [(1e-6, 41079.19, 182.574e-6), (10e-6, 1299.0381, 577.350e-6), (50e-6, 116.18950, 1290.994e-6)]
    {
        let exact = |x: f64| -2.0 * ETA * U * x / (h0 + x * x / (2.0 * R)).powi(2);
        let mut line = with_ends(parabola(h0, 10.0, 200, 2, U), exact);
        line.solve();
        let top = (0..line.stations.len()).max_by(|a, b| line.pressure[*a].total_cmp(&line.pressure[*b])).unwrap();
        assert_relative_eq!(line.pressure[top], p_max, max_relative = 2e-3);
        assert!((line.stations[top] + x_max).abs() < line.stations[1] - line.stations[0]);
        for (x, p) in line.stations.iter().zip(&line.pressure) {
            assert!((p - exact(*x)).abs() < 1e-4 * p_max, "h0 {h0}: p({x}) = {p}, exact {}", exact(*x));
        }
        assert!(line.load().abs() < 1e-9 * p_max * line.stations[400]);
    }
}

/// Varied: 20 to 160 elements. Nodal values are superconvergent: order 4 with quadratic pressure, 2 with linear pressure.
#[test]
fn rolling_parabola_converges_with_the_expected_order() {
    let h0 = 10e-6;
    let exact = |x: f64| -2.0 * ETA * U * x / (h0 + x * x / (2.0 * R)).powi(2);
    for (order, expected) in [(2, 4.0), (1, 2.0)] {
        let error = |columns: usize| {
            let mut line = with_ends(parabola(h0, 5.0, columns, order, U), exact);
            line.solve();
            let at_ends = (0..line.stations.len()).step_by(2);
            at_ends.map(|i| (line.pressure[i] - exact(line.stations[i])).abs()).fold(0.0, f64::max)
        };
        let errors = [40, 80, 160, 320].map(error);
        let observed = orders(&errors);
        assert!((observed[2] - expected).abs() < 0.25, "order {order}: {observed:?} of {errors:?}");
    }
}

/// h0 = 10 micron closing at 0.1 mm/s: W = 0.4712389 N/m.
#[test]
fn squeezed_parabola_carries_its_load() {
    let (h0, rate) = (10e-6, -1e-4);
    let exact = |x: f64| -6.0 * ETA * R * rate / (h0 + x * x / (2.0 * R)).powi(2);
    let mut line = with_ends(parabola(h0, 30.0, 600, 2, 0.0), exact);
    let lengths = line.stations.windows(3).step_by(2).map(|ends| ends[2] - ends[0]);
    line.rates = lengths.map(|length| MassRate { history: [rate * length; 3], ..MassRate::default() }).collect();
    line.solve();
    for (x, p) in line.stations.iter().zip(&line.pressure) {
        assert!((p - exact(*x)).abs() < 1e-4 * exact(0.0));
    }
    // The tail beyond |X| = 30 carries 4/(3 pi 30^3) of the load.
    assert_relative_eq!(line.load(), 0.471_238_9, max_relative = 5e-5);
    assert_relative_eq!(3.0 * SQRT_2 * PI * ETA * (R / h0).powf(1.5) * 1e-4, 0.471_238_9, max_relative = 1e-7);
}

/// From 20 to 10 micron under 0.5 N/m: BDF2 in the element's rate and history, of order two. Varied: number of steps.
#[test]
fn squeezed_parabola_sinks_under_a_constant_load() {
    let (initial, load) = (20e-6, 0.5);
    let speed = load / (6.0 * SQRT_2 * PI * ETA * R.powf(1.5));
    let exact = |t: f64| (f64::powf(initial, -0.5) + speed * t).powi(-2);
    let duration = (f64::powf(10e-6, -0.5) - f64::powf(initial, -0.5)) / speed;
    let error = |steps: usize| {
        let dt = duration / steps as f64;
        let mut past = [exact(-dt), initial];
        for _ in 0..steps {
            // The load at a trial thickness; the gap moves as a whole.
            let carried = |h0: f64| {
                let drop = (1.5 * h0 - 2.0 * past[1] + 0.5 * past[0]) / dt;
                let mut line = with_ends(parabola(h0, 20.0, 400, 2, 0.0), |x| {
                    -6.0 * ETA * R * drop / (h0 + x * x / (2.0 * R)).powi(2)
                });
                for (e, rate) in line.rates.iter_mut().enumerate() {
                    let x = |s: f64| 0.5 * ((1.0 - s) * line.stations[2 * e] + (1.0 + s) * line.stations[2 * e + 2]);
                    let length = line.stations[2 * e + 2] - line.stations[2 * e];
                    let history = |s: f64| {
                        let shape = x(s).powi(2) / (2.0 * R);
                        length * (-2.0 * (past[1] + shape) + 0.5 * (past[0] + shape)) / dt
                    };
                    let history = cartilage_contact::fem::element::GAUSS.map(history);
                    *rate = MassRate { rate: 1.5 / dt, history, ..MassRate::default() };
                }
                line.solve();
                // Beyond the mesh: int 2 p dx = -12 eta R drop int h^-2 dx, with h ~ x^2/2R.
                let end = 20.0 * (2.0 * R * h0).sqrt();
                line.load() - 12.0 * ETA * R * drop * 4.0 * R * R / (3.0 * end.powi(3))
            };
            let (mut a, mut b) = (past[1] * 0.9, past[1] * 0.95);
            let (mut fa, mut fb) = (carried(a) - load, carried(b) - load);
            while (b - a).abs() > 1e-9 * b && fa != fb {
                (a, fa, b) = (b, fb, b - fb * (b - a) / (fb - fa));
                fb = carried(b) - load;
            }
            past = [past[1], b];
        }
        (past[1] - exact(duration)).abs() / exact(duration)
    };
    let errors = [8, 16, 32].map(error);
    let observed = orders(&errors);
    assert!((observed[1] - 2.0).abs() < 0.3 && errors[2] < 1e-3, "{observed:?} of {errors:?}");
}

/// Largest pressure of the film of circles up to `half_width` and of parabolas with their slope and curvature beyond, by the midpoint
/// rule on 200 000 intervals; beyond over t = s/(l + s).
fn circular_peak(h0: f64, radius: f64, half_width: f64) -> f64 {
    let n = 200_000;
    let dx = 2.0 * half_width / n as f64;
    let circle = |x: f64| h0 + 2.0 * (radius - (radius * radius - x * x).sqrt());
    let h = |i: usize| circle((i as f64 + 0.5) * dx - half_width);
    let (end, slope) = (circle(half_width), 2.0 * half_width / (radius * radius - half_width * half_width).sqrt());
    let length = end / slope;
    let beyond = |power: i32| -> f64 {
        (0..n)
            .map(|i| (i as f64 + 0.5) / n as f64)
            .map(|t| {
                let s = length * t / (1.0 - t);
                length / (1.0 - t).powi(2) / n as f64 / (end + slope * s + s * s / radius).powi(power)
            })
            .sum()
    };
    let (two, three) = (beyond(2), beyond(3));
    let all = |power: i32, far: f64| (0..n).map(|i| h(i).powi(-power) * dx).sum::<f64>() + 2.0 * far;
    let mean = all(2, two) / all(3, three);
    let mut p = 6.0 * ETA * U * (two - mean * three);
    (0..n).fold(0.0, |peak: f64, i| {
        p += 6.0 * ETA * U * (h(i) - mean) / h(i).powi(3) * dx;
        peak.max(p)
    })
}

/// The whole solver with bodies of 10 GPa that are 10 micron thick and let nothing through. Varied: h0 = 10 and 50 micron. The
/// parabola has 1299.0381 and 116.18950 Pa (Martin); circles differ from it by up to 2e-3 in h at the ends, hence 1e-3.
#[test]
fn rigid_circular_bodies_have_the_pressure_of_the_whole_film() {
    let rigid = Body {
        outer_radius: 0.1,
        thickness: 1e-5,
        shear_modulus: 1e10,
        bulk_modulus: 1e10,
        permeability: 1e-24,
        biot_coefficient: 0.0,
        ..Parameters::default().upper
    };
    let parameters = Parameters {
        upper: rigid,
        lower: rigid,
        formulation: Formulation::Consistent,
        mesh: Mesh { columns: 200, rows: 1, column_grading: 3.0, row_grading: 0.0 },
        ..Parameters::default()
    };
    let mut simulation = Simulation::new(&parameters).unwrap();
    for (h0, parabola) in [(50e-6, 116.18950), (10e-6, 1299.0381)] {
        simulation
            .solve_steady(Inputs { penetration_depth: -h0, sliding_speed: U, slide_to_roll_ratio: 0.0, ..Inputs::NONE })
            .unwrap();
        let outputs = simulation.outputs();
        let circle = circular_peak(h0, 0.1, 0.1 * (PI / 36.0).sin());
        assert_relative_eq!(outputs.maximum_fluid_pressure, circle, max_relative = 2e-4);
        assert_relative_eq!(outputs.minimum_fluid_pressure, -circle, max_relative = 2e-4);
        assert_relative_eq!(outputs.maximum_fluid_pressure, parabola, max_relative = 1e-3);
        assert_relative_eq!(outputs.minimum_film_thickness, h0, max_relative = 1e-4);
    }
}

/// Friction of the rolling film to infinity (Martin), sqrt2 pi eta sqrt(R/h0) (+-U + U1 - U2). Varied: h0 = 10, 50 micron;
/// slide-to-roll ratio 0, 0.5, -1. The sector alone would miss up to a sixth of it. 1e-3: circles are not parabolas.
#[test]
fn rigid_circular_bodies_have_the_friction_of_rolling_and_sliding() {
    let rigid = Body {
        outer_radius: 0.1,
        thickness: 1e-5,
        shear_modulus: 1e10,
        bulk_modulus: 1e10,
        permeability: 1e-24,
        biot_coefficient: 0.0,
        ..Parameters::default().upper
    };
    let parameters = Parameters {
        upper: rigid,
        lower: rigid,
        formulation: Formulation::Consistent,
        shear_film_offset: 1e-9,
        mesh: Mesh { columns: 200, rows: 1, column_grading: 3.5, row_grading: 0.0 },
        ..Parameters::default()
    };
    let mut simulation = Simulation::new(&parameters).unwrap();
    for (h0, ratio) in [10e-6, 50e-6].into_iter().flat_map(|h0| [0.0, 0.5, -1.0].map(|ratio| (h0, ratio))) {
        let inputs = Inputs { penetration_depth: -h0, sliding_speed: U, ..Inputs::NONE };
        simulation.solve_steady(Inputs { slide_to_roll_ratio: ratio, ..inputs }).unwrap();
        let rolling = SQRT_2 * PI * ETA * U * (R / h0).sqrt();
        let sliding = ratio * rolling;
        let outputs = simulation.outputs();
        let size = 1e-3 * rolling;
        assert_relative_eq!(outputs.upper_friction_force, rolling + sliding, epsilon = size, max_relative = 1e-3);
        assert_relative_eq!(outputs.lower_friction_force, -rolling + sliding, epsilon = size, max_relative = 1e-3);
    }
}
