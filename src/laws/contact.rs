//! Solid on solid: complementarity of gap and contact pressure, and boundary friction.

use serde::{Deserialize, Serialize};

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

/// A slip dU on the way to a solution, and the fraction w of full friction that is taken to be mobilised there.
///
/// Newton's method for dU / sqrt(dU^2 + v^2) turns round and round where surfaces all but stick. For w sqrt(dU^2 + v^2) = dU with both w and
/// dU unknown it does not: T. F. Chan, G. H. Golub and P. Mulet, SIAM Journal on Scientific Computing 20 (1999) 1964-1977. Its tangent has
/// (1 - w dU/sqrt(dU^2 + v^2)) / sqrt(dU^2 + v^2) in place of the derivative, which is the same where w is that of the law.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Mobilised {
    /// dU \[m/s\].
    pub slip: f64,
    /// w, from -1 to 1.
    pub fraction: f64,
}

impl Mobilised {
    /// By the law, with the regularisation speed v.
    pub fn at(slip: f64, regularisation: f64) -> Self {
        Self { slip, fraction: mobilised_friction(Formulation::Consistent, [slip, 0.0], regularisation).0 }
    }

    /// After an update to another slip.
    #[must_use]
    pub fn moved(&self, slip: f64, regularisation: f64) -> Self {
        let norm = self.slip.hypot(regularisation);
        let change = (slip - self.slip) * self.slope(regularisation);
        Self { slip, fraction: (self.slip / norm + change).clamp(-1.0, 1.0) }
    }

    /// The slope of the tangent \[s/m\].
    pub fn slope(&self, regularisation: f64) -> f64 {
        let norm = self.slip.hypot(regularisation);
        (1.0 - self.fraction * self.slip / norm) / norm
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
    fn what_sticks_is_found_where_newtons_method_turns_round() {
        // A spring that pulls at what friction holds: k (x - u) = w with the slip u.
        let (stiffness, speed) = (1.0, 1e-3);
        for pull in [-3.0, -0.9, 0.3, 0.99, 1.5] {
            let mut mobilised = Mobilised::at(pull, speed);
            let residual = |slip: f64| slip / slip.hypot(speed) + stiffness * (slip - pull);
            let mut iterations = 0;
            while residual(mobilised.slip).abs() > 1e-12 && iterations < 30 {
                let slope = mobilised.slope(speed) + stiffness;
                mobilised = mobilised.moved(mobilised.slip - residual(mobilised.slip) / slope, speed);
                iterations += 1;
            }
            assert!(iterations <= 12, "{pull}: {iterations}");
            // There it is the law and its derivative.
            let solution = Mobilised::at(mobilised.slip, speed);
            assert_relative_eq!(mobilised.fraction, solution.fraction, max_relative = 1e-6);
            let by_law = mobilised_friction(Formulation::Consistent, [solution.slip, 0.0], speed).1[0];
            assert_relative_eq!(solution.slope(speed), by_law, max_relative = 1e-8);
        }
    }

    #[test]
    fn a_point_touches_where_it_presses_or_would_overlap() {
        assert!(is_active(1.0, 0.0, 1e9));
        assert!(is_active(0.0, -1e-9, 1e9));
        assert!(!is_active(0.0, 1e-9, 1e9));
        assert!(!is_active(-1.0, 0.0, 1e9));
    }
}
