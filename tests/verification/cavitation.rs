//! Films that cavitate, between layers so stiff that they are rigid, whose pores take no part: rupture and reformation as in the theory of
//! Jakobsson, Floberg and Olsson (see Elrod 1981, J. Lubr. Technol. 103), against quadratures.
//!
//! The gap is that of the two circles, on |x| <= L where p = 0; the film is cavitated at the cavitation pressure p_c.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Inputs, Parameters, TimeIntegration};
use cartilage_contact::simulation::{Drive, Simulation};

use crate::squeeze::rigid_bodies;
use crate::strip::orders;

const ETA: f64 = 1e-3;
const U: f64 = 0.2;
const R: f64 = 0.05;

fn half_width() -> f64 {
    0.1 * (PI / 36.0).sin()
}

fn gap(clearance: f64, x: f64) -> f64 {
    clearance + 2.0 * (0.1 - (0.01 - x * x).sqrt())
}

/// Integral of f from a to b by the midpoint rule.
fn integral(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let n = 20_000;
    let step = (b - a) / f64::from(n);
    (0..n).map(|i| f(a + (f64::from(i) + 0.5) * step) * step).sum()
}

/// Where a falling function of x is zero.
fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        *(if f(middle) > 0.0 { &mut low } else { &mut high }) = middle;
    }
    0.5 * (low + high)
}

fn cavitating(columns: i32, cavitation_pressure: f64) -> Parameters {
    let mut parameters = Parameters { cavitation: true, cavitation_pressure, ..rigid_bodies() };
    parameters.mesh.columns = columns;
    parameters
}

/// A rolling pair. Where the film is cavitated the flux is U h_r/2, h_r the gap at rupture, where p = p_c and p' = 0; it forms again where
/// p rises from p_c to 0 at the end.
struct Rolling {
    rupture: f64,
    reformation: f64,
    load: f64,
}

fn rolling(h: impl Fn(f64) -> f64, end: f64, cavitation_pressure: f64) -> Rolling {
    let slope = |x: f64, rupture: f64| 6.0 * ETA * U * (h(x) - h(rupture)) / h(x).powi(3);
    let rupture = root(0.0, (2.0 * R * h(0.0)).sqrt(), |rupture| {
        integral(-end, rupture, |x| slope(x, rupture)) - cavitation_pressure
    });
    let reformation = match cavitation_pressure < 0.0 {
        true => root(rupture, end, |from| integral(from, end, |x| slope(x, rupture)) + cavitation_pressure),
        false => end,
    };
    // By parts: the integral of p from a, where it is p_a, to b is p_a (b - a) + integral of (b - x) p'.
    let load = integral(-end, rupture, |x| (rupture - x) * slope(x, rupture))
        + cavitation_pressure * (end - rupture)
        + integral(reformation, end, |x| (end - x) * slope(x, rupture));
    Rolling { rupture, reformation, load }
}

fn rolled(columns: i32, clearance: f64, cavitation_pressure: f64, speed: f64) -> (Simulation, Outputs) {
    let steady = TimeIntegration::QuasiSteady;
    let parameters = Parameters { time_integration: steady, ..cavitating(columns, cavitation_pressure) };
    let mut simulation = Simulation::new(&parameters).unwrap();
    let inputs = Inputs { penetration_depth: -clearance, sliding_speed: speed, ..Inputs::NONE };
    simulation.solve_steady(inputs).unwrap();
    let outputs = simulation.outputs().clone();
    (simulation, outputs)
}

/// On an unbounded parabola cavitated at ambient pressure: W = 2.4478 eta U R/h0, cavitated from x = 0.4754 sqrt(2 R h0) on (Martin 1916).
#[test]
fn the_quadrature_agrees_with_the_closed_form() {
    let exact = rolling(|x| 10e-6 + 0.5 * x * x / R, 0.1, 0.0);
    assert_relative_eq!(exact.load, 2.4478 * ETA * U * R / 10e-6, max_relative = 1e-3);
    assert_relative_eq!(exact.rupture, 0.4754 * (2.0 * R * 10e-6).sqrt(), max_relative = 1e-3);
}

/// Varied: clearance, cavitation pressure, direction. Load to 5e-3 on 120 elements; the ends of the cavitated film to one element; flux to
/// 5e-3; no pressure at a node below that of cavitation by more than round-off.
#[test]
fn a_rolling_film_tears_and_forms_again() {
    for (clearance, cavitation_pressure) in [(10e-6, 0.0), (10e-6, -100.0), (10e-6, -800.0), (3e-6, -500.0)] {
        let exact = rolling(|x| gap(clearance, x), half_width(), cavitation_pressure);
        for direction in [1.0, -1.0] {
            let (simulation, outputs) = rolled(120, clearance, cavitation_pressure, direction * U);
            assert_relative_eq!(outputs.load, exact.load, max_relative = 5e-3);
            assert!(outputs.minimum_fluid_pressure > cavitation_pressure - 1e-6, "{}", outputs.minimum_fluid_pressure);
            let fields = simulation.fields().unwrap().interface;
            let last = fields.position.len() - 1;
            let cavitated: Vec<usize> = (0..=last).filter(|i| fields.void_thickness[*i] > 1e-15).collect();
            let (first, final_) = (cavitated[0], cavitated[cavitated.len() - 1]);
            let ends = [exact.rupture, exact.reformation].map(|x| direction * x);
            let [from, to] = if direction > 0.0 { ends } else { [ends[1], ends[0]] };
            for (i, x) in [(first, from), (final_, to)] {
                let element = fields.position[(i + 2).min(last)] - fields.position[i.saturating_sub(2)];
                assert!((fields.position[i] - x).abs() < 0.5 * element, "{} {x}", fields.position[i]);
            }
            assert_relative_eq!(outputs.cavitated_length, to - from, max_relative = 0.05);
            // Half an element off the ends, where the pressure drives no flow.
            let flux = 0.5 * direction * U * gap(clearance, exact.rupture);
            for i in cavitated[2..cavitated.len() - 2].iter().copied() {
                let full = 1.0 - fields.void_thickness[i] / fields.film_thickness[i];
                assert!((0.0..=1.0).contains(&full));
                // From node to node the mean gap between them carries it.
                let (a, b) = if direction > 0.0 { (i, i + 1) } else { (i, i - 1) };
                let (a, b) = (fields.position[a], fields.position[b]);
                let mean = [a, 0.5 * (a + b), b].map(|x| gap(clearance, x));
                let mean = (mean[0] + 4.0 * mean[1] + mean[2]) / 6.0;
                assert_relative_eq!(0.5 * direction * U * full * mean, flux, max_relative = 5e-3);
            }
        }
    }
}

/// The error of the load falls with the square of the element's size in full film, and between that and linearly where the film
/// ends between two nodes.
#[test]
fn a_rolling_film_converges() {
    let exact = rolling(|x| gap(10e-6, x), half_width(), -100.0).load;
    let errors = [30, 60, 120, 240].map(|columns| (rolled(columns, 10e-6, -100.0, U).1.load / exact - 1.0).abs());
    let observed = orders(&errors);
    println!("errors {errors:?}, orders {observed:?}");
    assert!(errors[3] < 2e-3 && observed.iter().sum::<f64>() / 3.0 > 1.0, "{errors:?} {observed:?}");
}

/// Two bodies that part at a speed w. The middle, |x| < a, cavitates at once to where the film outside can still fill up:
/// int_a^L 12 eta w (x - a)/h^3 dx = -p_c. The gap of the void grows by w, and the flow q into it from outside, with
/// p' = 12 eta (w (x - a) + q)/h^3, closes it: da/dt = -q/(w t). Varied: time. The edge to one element, the load to 2 %.
#[test]
fn a_film_pulled_apart_tears_and_heals() {
    let (speed, clearance, cavitation_pressure) = (1e-4, 10e-6, -100.0);
    let end = half_width();
    let cubes = |a: f64, t: f64| {
        let h = |x: f64| gap(clearance + speed * t, x).powi(3);
        let pulled = integral(a, end, |x| 12.0 * ETA * speed * (x - a) / h(x));
        (pulled, integral(a, end, |x| 12.0 * ETA / h(x)))
    };
    let inflow = |a: f64, t: f64| {
        let (pulled, drawn) = cubes(a, t);
        (-cavitation_pressure - pulled) / drawn
    };
    let mut parameters = Parameters { relative_tolerance: 1e-4, ..cavitating(240, cavitation_pressure) };
    parameters.maximum_internal_step = 1e-3;
    let mut simulation = Simulation::new(&parameters).unwrap();
    let still = Inputs { penetration_depth: -clearance, ..Inputs::NONE };
    simulation.solve_steady(still).unwrap();
    let mut edge = root(0.0, end, |a| cubes(a, 0.0).0 + cavitation_pressure);
    let (mut time, step) = (0.0, 1e-4);
    let mut seen = 0;
    for _ in 0..10 {
        let inputs = Inputs { penetration_depth: -clearance - speed * time, approach_speed: -speed, ..still };
        simulation.advance(Drive::constant(inputs), 50.0 * step).unwrap();
        for _ in 0..50 {
            // At the middle of the step: at its beginning the first void has no gap yet.
            let middle = time + 0.5 * step;
            let half = edge - 0.5 * step * inflow(edge, middle) / (speed * middle);
            edge = (edge - step * inflow(half.max(0.0), middle) / (speed * middle)).max(0.0);
            time += step;
        }
        let outputs = simulation.outputs();
        println!("t {time}: cavitated {} and {}, load {}", outputs.cavitated_length, 2.0 * edge, outputs.load);
        if edge == 0.0 {
            continue;
        }
        seen += 1;
        assert!((outputs.cavitated_length - 2.0 * edge).abs() < 2.0 * 60e-6, "{} {edge}", outputs.cavitated_length);
        let h = |x: f64| gap(clearance + speed * time, x).powi(3);
        let q = inflow(edge, time);
        let load = 2.0 * cavitation_pressure * end
            + 2.0 * integral(edge, end, |x| (end - x) * 12.0 * ETA * (speed * (x - edge) + q) / h(x));
        assert_relative_eq!(outputs.load, load, max_relative = 2e-2);
    }
    assert!(seen > 2);
}
