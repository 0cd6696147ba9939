//! Darcy's law: how much fluid a pressure gradient drives through the pores.

use nalgebra::{Matrix2, Vector2, Vector4};

use super::kinematics::{COFACTOR_DERIVATIVE, Strain, flatten};

/// Permeability that falls as the tissue is compressed, isotropic in the deformed tissue (Holmes and Mow, Journal of
/// Biomechanics 23 (11), 1145-1156, 1990):
///
/// k / k0 = [(J - s) / (1 - s)]^L exp(M (J^2 - 1) / 2)
///
/// with the volume ratio J and the volume fraction s of the solid at J = 1. The bracket is the pore volume over that at J = 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HolmesMow {
    /// Volume fraction s of the solid in the undeformed tissue [1].
    pub solid_volume_fraction: f64,
    /// Exponent L of the pore volume [1].
    pub exponent: f64,
    /// Coefficient M of the exponential [1].
    pub strain_coefficient: f64,
}

/// The pores never count as smaller than this share of their undeformed volume. The law ends at J = s, where no fluid is left; it
/// would close the pores there, and is no number below, where a finite modulus cannot keep the solid from being pressed.
pub const LEAST_PORE_VOLUME: f64 = 0.01;

impl HolmesMow {
    /// k / k0 and its derivative by J, at J = 1 + `volume_change`.
    pub fn relative_permeability(&self, volume_change: f64) -> (f64, f64) {
        let Self { solid_volume_fraction, exponent, strain_coefficient } = *self;
        let e = volume_change;
        let pores = 1.0 + e / (1.0 - solid_volume_fraction);
        let (pores, opening) = match pores > LEAST_PORE_VOLUME {
            true => (pores, exponent / (pores * (1.0 - solid_volume_fraction))),
            false => (LEAST_PORE_VOLUME, 0.0),
        };
        let value = pores.powf(exponent) * (0.5 * strain_coefficient * e * (2.0 + e)).exp();
        (value, value * (opening + strain_coefficient * (1.0 + e)))
    }
}

/// Conductance tensor of the reference configuration, K with Q = -K grad p, and its derivative.
///
/// `mobility` is the hydraulic permeability kappa/eta [m^4/(N s)]. Pulled back from the deformed tissue
/// K = (kappa/eta) J F^-1 F^-T; in the paper's literal reading K = kappa/eta, whatever the strain.
pub fn conductance(mobility: f64, strain: &Strain, pulled_back: bool) -> Matrix2<f64> {
    if pulled_back {
        strain.cofactor.tr_mul(&strain.cofactor) * (mobility / strain.volume_ratio())
    } else {
        Matrix2::identity() * mobility
    }
}

/// Derivative of `conductance * gradient` with respect to the four entries of F, one column each.
pub fn conductance_derivative(mobility: f64, strain: &Strain, gradient: &Vector2<f64>) -> nalgebra::Matrix2x4<f64> {
    let j = strain.volume_ratio();
    let c = &strain.cofactor;
    let flux = c.tr_mul(&(c * gradient)) / j;
    let cofactor: Vector4<f64> = flatten(c);
    nalgebra::Matrix2x4::from_fn(|row, column| {
        let derivative = |i: usize, k: usize| COFACTOR_DERIVATIVE[2 * i + k][column];
        let dc = Matrix2::new(derivative(0, 0), derivative(0, 1), derivative(1, 0), derivative(1, 1));
        let change = dc.tr_mul(&(c * gradient)) + c.tr_mul(&(dc * gradient));
        mobility * (change[row] - flux[row] * cofactor[column]) / j
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn derivative_matches_finite_differences(h in prop::array::uniform4(-0.3..0.3f64), g in prop::array::uniform2(-1.0..1.0f64)) {
            let gradient = Vector2::new(g[0], g[1]);
            let at = |h: [f64; 4]| conductance(1.0, &Strain::new(Matrix2::new(h[0], h[1], h[2], h[3])), true) * gradient;
            let strain = Strain::new(Matrix2::new(h[0], h[1], h[2], h[3]));
            let derivative = conductance_derivative(1.0, &strain, &gradient);
            for k in 0..4 {
                let (mut plus, mut minus) = (h, h);
                plus[k] += 1e-6;
                minus[k] -= 1e-6;
                let difference = (at(plus) - at(minus)) / 2e-6;
                prop_assert!((derivative.column(k) - difference).amax() < 1e-7);
            }
        }
    }

    /// The default of the parameters, the fit quoted from Holmes and Mow, and no dependence at all.
    const LAWS: [HolmesMow; 3] = [
        HolmesMow { solid_volume_fraction: 0.2, exponent: 2.0, strain_coefficient: 2.2 },
        HolmesMow { solid_volume_fraction: 0.2, exponent: 0.0848, strain_coefficient: 4.638 },
        HolmesMow { solid_volume_fraction: 0.2, exponent: 0.0, strain_coefficient: 0.0 },
    ];

    #[test]
    fn undeformed_tissue_has_the_reference_permeability_and_without_coefficients_so_has_any() {
        for law in LAWS {
            assert_eq!(law.relative_permeability(0.0).0, 1.0);
        }
        for e in [-0.999, -0.5, 0.0, 0.3] {
            assert_eq!(LAWS[2].relative_permeability(e), (1.0, 0.0));
        }
        // 0.75^2 exp(-0.396): a fifth of the volume is gone, and with it a quarter of the pores.
        let (value, _) = LAWS[0].relative_permeability(-0.2);
        assert!((value - 0.378_566_3).abs() < 1e-7, "{value}");
    }

    #[test]
    fn its_derivative_matches_finite_differences() {
        for law in LAWS {
            for e in [-0.97, -0.79, -0.7, -0.3, -1e-3, 0.0, 0.2, 1.0] {
                let at = |e: f64| law.relative_permeability(e).0;
                let difference = (at(e + 1e-6) - at(e - 1e-6)) / 2e-6;
                let (value, derivative) = law.relative_permeability(e);
                assert!(
                    (difference - derivative).abs() < 1e-6 * (1.0 + value),
                    "{law:?} {e}: {difference} {derivative}"
                );
            }
        }
    }

    #[test]
    fn pores_that_are_pressed_shut_keep_a_little_permeability() {
        for law in LAWS {
            let mut last = 0.0;
            for i in 0..=1000 {
                let (value, derivative) = law.relative_permeability(-1.0 + 1e-3 * f64::from(i));
                assert!(
                    value.is_finite() && derivative.is_finite() && value > 0.0 && value >= last,
                    "{law:?} {i}: {value}"
                );
                last = value;
            }
        }
        let solid = LAWS[0].relative_permeability(-0.8).0;
        assert!((solid - LEAST_PORE_VOLUME.powi(2) * (-1.1_f64 * 0.96).exp()).abs() < 1e-12, "{solid}");
    }

    #[test]
    fn rigid_rotation_changes_nothing_but_the_frame() {
        let (sin, cos) = 0.4_f64.sin_cos();
        let rotation = Strain::new(Matrix2::new(cos - 1.0, -sin, sin, cos - 1.0));
        assert!((conductance(2.0, &rotation, true) - Matrix2::identity() * 2.0).amax() < 1e-14);
    }
}
