//! A full film on thin compressible layers, which yield like Winkler's foundation: u = p t/M (Skotheim & Mahadevan 2004).
//!
//! X = x/sqrt(2 R h0), P = p h0^(3/2)/(eta U sqrt(2R)), N = eta U t sqrt(2R)/(M h0^(5/2)): (H^3 P')' = 6 H', H = 1 + X^2 + N P,
//! on |X| <= 40; load W = Lhat eta U 2R/h0; for small N Lhat = (3 pi/8) N. Varied: N = 0.1, 1, 10.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use cartilage_contact::laws::fluid::Fluid;
use cartilage_contact::parameters::{Body, Formulation, Inputs, Mesh, Parameters};
use cartilage_contact::simulation::Simulation;

use crate::line::{Line, film};

const ETA: f64 = 1e-3;
const U: f64 = 0.02;
const H0: f64 = 1e-6;
const R: f64 = 500.0;

/// N, h*/h0, Lhat, P_max, P_min, H_min.
const TABLE: [[f64; 6]; 3] = [
    [0.1, 1.34295, 0.114485, 0.66064, -0.62391, 1.00772],
    [1.0, 1.67395, 0.485925, 0.52546, -0.38898, 1.27225],
    [10.0, 3.23813, 0.424168, 0.20927, -0.12662, 2.51063],
];

/// The film's elements on a true Winkler foundation, 4000 equal ones: 1e-4, the largest and smallest pressures being taken at nodes.
#[test]
fn film_elements_on_a_winkler_foundation() {
    let length = (2.0 * R * H0).sqrt();
    let pressure = ETA * U * (2.0 * R).sqrt() / H0.powf(1.5);
    let film = film(Fluid::Newtonian(ETA), 2);
    let stations: Vec<f64> = (0..=8000).map(|i| 40.0 * length * (f64::from(i) / 4000.0 - 1.0)).collect();
    let mut line = Line::new(film, stations, |x| H0 + x * x / (2.0 * R), U);
    for [n, h_star, load, p_max, p_min, h_min] in TABLE {
        for step in [0.25, 0.5, 1.0] {
            line.compliance = step * n * H0 / pressure;
            line.solve();
        }
        let extreme = |sign: f64| line.pressure.iter().fold(0.0, |m: f64, p| m.max(sign * p)) / pressure;
        let thinnest = (0..line.stations.len()).map(|i| line.thickness(i) / H0).fold(f64::INFINITY, f64::min);
        // The flux U h*/2 in the middle of the mesh.
        let middle = line.stations.len() / 2 + 1;
        let gradient = (line.pressure[middle + 1] - line.pressure[middle - 1])
            / (line.stations[middle + 1] - line.stations[middle - 1]);
        let h = line.thickness(middle);
        let measured = [
            (h - h.powi(3) * gradient / (6.0 * ETA * U)) / H0,
            line.load() * H0 / (ETA * U * 2.0 * R),
            extreme(1.0),
            -extreme(-1.0),
            thinnest,
        ];
        println!("N {n}: {measured:?}");
        for (measured, expected) in measured.into_iter().zip([h_star, load, p_max, p_min, h_min]) {
            assert_relative_eq!(measured, expected, max_relative = 1e-4);
        }
    }
    line.compliance = 1e-3 * H0 / pressure;
    line.solve();
    assert_relative_eq!(line.load() * H0 / (ETA * U * 2.0 * R), 3.0 * PI / 8.0 * 1e-3, max_relative = 1e-3);
}

/// The whole solver: two drained layers with Poisson's ratio 0, a thirtieth of the film's length thick. They spread pressure over
/// (t/L)^2 = 1e-3 and are compressed by 1e-3: 0.5 %.
#[test]
fn layers_that_are_thin_and_compressible() {
    let thickness = 1e-3;
    for [n, _, load, p_max, p_min, h_min] in TABLE {
        let modulus = ETA * U * 2.0 * thickness * (2.0 * R).sqrt() / (n * H0.powf(2.5));
        let body = Body {
            outer_radius: 2.0 * R,
            thickness,
            shear_modulus: modulus / 2.0,
            bulk_modulus: modulus / 3.0,
            permeability: 1e-24,
            biot_coefficient: 0.0,
            ..Parameters::default().upper
        };
        let length = (2.0 * R * H0).sqrt();
        let parameters = Parameters {
            upper: body,
            lower: body,
            sector_half_angle: 40.0 * length / (2.0 * R),
            viscosity: ETA,
            formulation: Formulation::Consistent,
            mesh: Mesh { columns: 240, rows: 2, column_grading: 4.0, row_grading: 0.0 },
            ..Parameters::default()
        };
        let mut simulation = Simulation::new(&parameters).unwrap();
        simulation
            .solve_steady(Inputs { penetration_depth: -H0, sliding_speed: U, slide_to_roll_ratio: 0.0, ..Inputs::NONE })
            .unwrap();
        let outputs = simulation.outputs();
        let pressure = ETA * U * (2.0 * R).sqrt() / H0.powf(1.5);
        let measured = [
            outputs.load * H0 / (ETA * U * 2.0 * R),
            outputs.maximum_fluid_pressure / pressure,
            outputs.minimum_fluid_pressure / pressure,
            outputs.minimum_film_thickness / H0,
        ];
        println!("N {n}: {measured:?}");
        for (measured, expected) in measured.into_iter().zip([load, p_max, p_min, h_min]) {
            assert_relative_eq!(measured, expected, max_relative = 5e-3);
        }
    }
}
