//! A film between rigid porous bodies on impermeable backing (Morgan & Cameron 1957): layers that are thin against the film's
//! length add 12 sum kappa_i t_i to h^3. With Phi = 24 kappa t/h0^3 for two equal layers, ((H^3 + Phi) P')' = 6 H', H = 1 + X^2.
//!
//! Varied: Phi = 0.1, 10. The layers are a thirtieth of the film's length thick: (t/L)^2/3 = 3e-4; tolerance 2e-3.

use approx::assert_relative_eq;
use cartilage_contact::parameters::{Body, Formulation, Inputs, Mesh, Parameters};

use crate::pair::Pair;

#[test]
fn rigid_porous_layers_relieve_the_film() {
    let (h0, radius, eta, u, thickness): (f64, f64, f64, f64, f64) = (1e-6, 0.05, 1e-3, 0.2, 1e-5);
    let length = (2.0 * radius * h0).sqrt();
    let scale = eta * u * (2.0 * radius).sqrt() / h0.powf(1.5);
    for (phi, p_max, place) in [(0.1, 0.632460, -0.58901), (10.0, 0.293603, -0.95252)] {
        let body = Body {
            outer_radius: 2.0 * radius,
            thickness,
            shear_modulus: 1e10,
            bulk_modulus: 1e10,
            permeability: phi * h0.powi(3) / (24.0 * thickness),
            biot_coefficient: 0.0,
            ..Parameters::default().upper
        };
        let parameters = Parameters {
            upper: body,
            lower: body,
            sector_half_angle: (40.0 * length / (2.0 * radius)).asin(),
            viscosity: eta,
            formulation: Formulation::Consistent,
            mesh: Mesh { columns: 400, rows: 2, column_grading: 4.0, row_grading: 0.0 },
            ..Parameters::default()
        };
        let mut pair = Pair::new(&parameters, true);
        pair.rest_at(-h0);
        pair.go(Inputs { penetration_depth: -h0, sliding_speed: u, slide_to_roll_ratio: 0.0, ..Inputs::NONE });
        let places = pair.interface_points();
        let peak = places.iter().max_by(|a, b| a.pressure.total_cmp(&b.pressure)).unwrap();
        println!("Phi {phi}: P_max {} at {}", peak.pressure / scale, peak.x / length);
        assert_relative_eq!(peak.pressure / scale, p_max, max_relative = 2e-3);
        assert_relative_eq!(peak.x / length, place, epsilon = 0.03);
    }
}
