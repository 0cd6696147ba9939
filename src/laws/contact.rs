//! Solid on solid: complementarity of gap and contact pressure, and boundary friction.

use super::Formulation;

/// Whether a point is in contact, from its contact pressure \[Pa\] and gap \[m\]: the primal-dual active set keeps the points with
/// p_c - c g > 0. At a solution one of the two is zero and the other decides; c \[Pa/m\] only weighs them on the way.
pub fn is_active(contact_pressure: f64, gap: f64, stiffness: f64) -> bool {
    contact_pressure - stiffness * gap > 0.0
}

/// Fraction of full Coulomb friction that is mobilised, from -1 to 1, with its derivatives with respect to the two surface speeds.
///
/// At equal surface speeds Coulomb friction is not determined. The paper charges it in full, in the direction of U = U1 + U2;
/// here its jump at U = 0 is smoothed by tanh(U / v), which is 1 to round-off beyond 20 v. The consistent formulation has
/// dU / sqrt(dU^2 + v^2), dU = U1 - U2.
pub fn mobilised_friction(formulation: Formulation, speeds: [f64; 2], regularisation: f64) -> (f64, [f64; 2]) {
    match formulation {
        Formulation::Paper => {
            let m = ((speeds[0] + speeds[1]) / regularisation).tanh();
            let slope = (1.0 - m * m) / regularisation;
            (m, [slope, slope])
        }
        Formulation::Consistent => {
            let difference = speeds[0] - speeds[1];
            let norm = difference.hypot(regularisation);
            let slope = regularisation.powi(2) / norm.powi(3);
            (difference / norm, [slope, -slope])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn friction_follows_the_speeds() {
        for formulation in [Formulation::Paper, Formulation::Consistent] {
            for speeds in [[3e-4, -1e-4], [0.1, 0.02], [-2e-4, 5e-5]] {
                let (_, slopes) = mobilised_friction(formulation, speeds, 1e-3);
                for k in 0..2 {
                    let (mut plus, mut minus) = (speeds, speeds);
                    plus[k] += 1e-8;
                    minus[k] -= 1e-8;
                    let difference = (mobilised_friction(formulation, plus, 1e-3).0
                        - mobilised_friction(formulation, minus, 1e-3).0)
                        / 2e-8;
                    assert_relative_eq!(slopes[k], difference, max_relative = 1e-6, epsilon = 1e-6);
                }
            }
        }
        assert_eq!(mobilised_friction(Formulation::Paper, [0.1, 0.1], 1e-3).0, 1.0);
        assert_eq!(mobilised_friction(Formulation::Paper, [-0.1, -0.1], 1e-3).0, -1.0);
        assert_eq!(mobilised_friction(Formulation::Consistent, [0.1, 0.1], 1e-3).0, 0.0);
    }

    #[test]
    fn a_point_touches_where_it_presses_or_would_overlap() {
        assert!(is_active(1.0, 0.0, 1e9));
        assert!(is_active(0.0, -1e-9, 1e9));
        assert!(!is_active(0.0, 1e-9, 1e9));
        assert!(!is_active(-1.0, 0.0, 1e9));
    }
}
