//! Films of a lubricant that thins where it is sheared (Carreau).
//!
//! A power law tau = K gamma^n between rolling surfaces: Q = U h/2 - (h^2/2) n/(2n + 1) (h |p'|/(2K))^(1/n) sign(p'), so that p' follows
//! from h and Q, and Q from the pressures at the ends; by quadrature. Sheared without pressure: eta(gamma) gamma on both walls.
//! With n = 1, with a vanishing and with an endless relaxation time the whole solver has the Newtonian answers.

use approx::assert_relative_eq;
use cartilage_contact::laws::fluid::{Carreau, Fluid};
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Body, FluidLaw, Formulation, Inputs, Mesh, Parameters};
use cartilage_contact::simulation::Simulation;

use crate::line::{Line, film};
use crate::strip::orders;

const U: f64 = 0.2;

/// Pressure at the ends of equal intervals of the rolling film h0 + x^2/2R on |x| < `half`, 0 at both ends, by Simpson's rule.
fn power_law_pressure(consistency: f64, index: f64, h: impl Fn(f64) -> f64, half: f64, intervals: usize) -> Vec<f64> {
    let gradient = |x: f64, flux: f64| {
        let moment: f64 = (U * h(x) - 2.0 * flux) / h(x).powi(2);
        let difference = consistency * ((2.0 * index + 1.0) / index * moment.abs()).powf(index);
        2.0 * difference.copysign(moment) / h(x)
    };
    let dx = 2.0 * half / intervals as f64;
    let pressures = |flux: f64| -> Vec<f64> {
        let mut pressures = vec![0.0];
        for i in 0..intervals {
            let x = |s: f64| -half + dx * (i as f64 + s);
            let rise = gradient(x(0.0), flux) + 4.0 * gradient(x(0.5), flux) + gradient(x(1.0), flux);
            pressures.push(pressures[i] + rise * dx / 6.0);
        }
        pressures
    };
    // The more flows the less pressure is built up.
    let (mut low, mut high) = (0.0, U * h(half));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if pressures(middle)[intervals] > 0.0 { low = middle } else { high = middle }
    }
    pressures(low)
}

/// Varied: n = 0.4, 0.7; 80 to 640 elements; order of the pressure. The film has a kink of the viscosity where p' is 0 and the last
/// digits of a rule of 16 points: 1e-3 of the largest pressure, with straight pressures of order 1.5 and more before that.
#[test]
fn a_rolling_power_law_has_its_pressure() {
    let (h0, r) = (10e-6, 0.05);
    for index in [0.4, 0.7] {
        let carreau = Carreau {
            zero_shear_viscosity: 10.0,
            infinite_shear_viscosity: 1e-9,
            relaxation_time: 1e3,
            flow_index: index,
        };
        let consistency = carreau.zero_shear_viscosity * carreau.relaxation_time.powf(index - 1.0);
        let half = 5.0 * f64::sqrt(2.0 * r * h0);
        let h = |x: f64| h0 + x * x / (2.0 * r);
        let exact = power_law_pressure(consistency, index, h, half, 16_000);
        let largest = exact.iter().fold(0.0, |m: f64, p| m.max(*p));
        for order in [1, 2] {
            let error = |columns: usize| {
                let stations = (0..=2 * columns).map(|i| half * (i as f64 / columns as f64 - 1.0)).collect();
                let mut line = Line::new(film(Fluid::Carreau(carreau), order), stations, h, U);
                line.solve();
                let nodes = (0..=columns).map(|i| (line.pressure[2 * i] - exact[i * (16_000 / columns)]).abs());
                nodes.fold(0.0, f64::max) / largest
            };
            let errors = [80, 160, 320, 640].map(error);
            let observed = orders(&errors);
            println!("n {index}, order {order}: {observed:?} of {errors:?}");
            let falls = order == 2 || errors[0] / errors[3] > 8.0;
            assert!(falls && errors[2..].iter().all(|e| *e < 1.5e-3), "{observed:?} of {errors:?}");
        }
    }
}

/// Synovial fluid, on the paper's layers.
fn synovial(formulation: Formulation) -> Parameters {
    Parameters {
        formulation,
        fluid_law: FluidLaw::Carreau,
        zero_shear_viscosity: 40.0,
        relaxation_time: 22.0,
        flow_index: 0.27,
        tolerance: 1e-10,
        mesh: Mesh { columns: 40, rows: 3, column_grading: 2.5, row_grading: 2.0 },
        ..Parameters::default()
    }
}

fn newtonian(viscosity: f64, like: &Parameters) -> Parameters {
    // Permeability over viscosity is that of the tissue.
    let body = Body { permeability: like.upper.permeability * viscosity / like.viscosity, ..like.upper };
    Parameters { fluid_law: FluidLaw::Newtonian, viscosity, upper: body, lower: body, ..*like }
}

fn solved(parameters: &Parameters, micron: f64, ratio: f64) -> Outputs {
    let mut simulation = Simulation::new(parameters).unwrap();
    let inputs = Inputs { penetration_depth: micron * 1e-6, sliding_speed: U, ..Inputs::NONE };
    simulation.solve_steady(Inputs { slide_to_roll_ratio: ratio, ..inputs }).unwrap();
    simulation.outputs().clone()
}

fn assert_same(a: &Outputs, b: &Outputs, tolerance: f64) {
    let numbers = |o: &Outputs| {
        [o.load, o.upper_friction_force, o.lower_friction_force, o.minimum_film_thickness, o.maximum_fluid_pressure]
    };
    for (a, b) in numbers(a).into_iter().zip(numbers(b)) {
        assert_relative_eq!(a, b, max_relative = tolerance);
    }
    for (p, q) in a.fluid_pressure.iter().zip(&b.fluid_pressure) {
        assert_relative_eq!(*p, *q, epsilon = tolerance * a.maximum_fluid_pressure);
    }
}

/// Smooth and rough, both formulations, film and contact, rolling and sliding: n = 1 is Newtonian with the viscosity at low rates, and so
/// is a relaxation time of next to nothing; with an endless one all of the film is thinned.
#[test]
fn newtonian_limits() {
    let rough = Parameters { surface_roughness: 0.5e-6, ..synovial(Formulation::Consistent) };
    for parameters in [synovial(Formulation::Paper), synovial(Formulation::Consistent), rough] {
        let thick = Parameters { zero_shear_viscosity: 5e-3, ..parameters };
        for (micron, ratio) in [(5.0, 0.0), (24.0, -1.5)] {
            let low = solved(&newtonian(5e-3, &parameters), micron, ratio);
            let high = solved(&newtonian(1e-3, &parameters), micron, ratio);
            assert_same(&solved(&Parameters { flow_index: 1.0, ..thick }, micron, ratio), &low, 1e-5);
            assert_same(&solved(&Parameters { relaxation_time: 1e-9, ..thick }, micron, ratio), &low, 1e-5);
            let thinned = Parameters { relaxation_time: 1e6, flow_index: 0.1, ..thick };
            assert_same(&solved(&thinned, micron, ratio), &high, 1e-5);
        }
    }
}

/// Synovial fluid in a full film carries more than a fluid of its viscosity at high rates, and rubs more.
#[test]
fn synovial_fluid_lies_between_its_viscosities() {
    let parameters = synovial(Formulation::Paper);
    for (micron, ratio) in [(-10.0, 0.0), (5.0, 0.5)] {
        let film = solved(&parameters, micron, ratio);
        let [low, high] = [1e-3, 0.1].map(|viscosity| solved(&newtonian(viscosity, &parameters), micron, ratio));
        let numbers = [&low, &film, &high].map(|o| [o.load, o.minimum_film_thickness, o.upper_friction_force]);
        for quantity in 0..3 {
            let [low, film, high] = numbers.map(|numbers| numbers[quantity]);
            assert!(low < film && film < high, "{low} {film} {high}");
        }
    }
}

/// Rigid circles that slide and hardly roll: (T_1 + T_2)/2 = int eta(D/h) D/h dx with D = U1 - U2 over the sector, and beyond it with the
/// viscosity at its end. By the midpoint rule; 1e-3 for the sector's quadrature. Varied: h0 = 10, 50 micron; n = 0.27, 0.6.
#[test]
fn sliding_surfaces_have_the_shear_of_the_flow_curve() {
    let body = Body {
        outer_radius: 0.1,
        thickness: 1e-5,
        shear_modulus: 1e10,
        bulk_modulus: 1e10,
        permeability: 1e-24,
        biot_coefficient: 0.0,
        ..Parameters::default().upper
    };
    for (h0, flow_index) in [(10e-6, 0.27), (50e-6, 0.6)] {
        let parameters = Parameters {
            upper: body,
            lower: body,
            shear_film_offset: 1e-9,
            flow_index,
            mesh: Mesh { columns: 200, rows: 1, column_grading: 3.5, row_grading: 0.0 },
            ..synovial(Formulation::Consistent)
        };
        let curve = Carreau {
            zero_shear_viscosity: parameters.zero_shear_viscosity,
            infinite_shear_viscosity: parameters.viscosity,
            relaxation_time: parameters.relaxation_time,
            flow_index,
        };
        let (speed, ratio) = (1e-4, 2000.0);
        let difference = speed * ratio;
        let mut simulation = Simulation::new(&parameters).unwrap();
        let inputs = Inputs { penetration_depth: -h0, sliding_speed: speed, ..Inputs::NONE };
        simulation.solve_steady(Inputs { slide_to_roll_ratio: ratio, ..inputs }).unwrap();
        let end = 0.1 * (std::f64::consts::PI / 36.0).sin();
        let circle = |x: f64| h0 + 2.0 * (0.1 - (0.01 - x * x).sqrt());
        let (n, mut shear) = (100_000, 0.0);
        for i in 0..n {
            let s = (f64::from(i) + 0.5) / f64::from(n);
            shear += 2.0 * end / f64::from(n) * curve.stress(difference / circle(end * s)).0;
            // Beyond, over x - end = l s/(1 - s).
            let (h_end, slope) = (circle(end), 2.0 * end / (0.01 - end * end).sqrt());
            let (length, at_end) = (h_end / slope, curve.stress(difference / h_end).0 * h_end);
            let r = length * s / (1.0 - s);
            let weight = length / (1.0 - s).powi(2) / f64::from(n);
            shear += 2.0 * weight * at_end / (h_end + slope * r + r * r / 0.1);
        }
        let o = simulation.outputs();
        let sum = 0.5 * (o.upper_friction_force + o.lower_friction_force);
        println!("h0 {h0}, n {flow_index}: {sum} {shear}");
        assert_relative_eq!(sum, shear, max_relative = 1e-3);
    }
}
