//! Darcy's law: how much fluid a pressure gradient drives through the pores.

use nalgebra::{Matrix2, Matrix2x4, Vector2, Vector4};

use super::kinematics::{COFACTOR_DERIVATIVE, Strain, flatten};

/// Permeability that falls as the tissue is compressed, isotropic in the deformed tissue (Holmes and Mow, Journal of
/// Biomechanics 23 (11), 1145-1156, 1990):
///
/// k / k0 = [(J - s) / (1 - s)]^L exp(M (J^2 - 1) / 2)
///
/// with the volume ratio J and the volume fraction s of the solid at J = 1. The bracket is the pore volume over that at J = 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HolmesMow {
    /// Volume fraction s of the solid in the undeformed tissue \[1\].
    pub solid_volume_fraction: f64,
    /// Exponent L of the pore volume \[1\].
    pub exponent: f64,
    /// Coefficient M of the exponential \[1\].
    pub strain_coefficient: f64,
}

/// The pores never count as smaller than this fraction of their undeformed volume. The law ends at J = s, where no fluid is left; it
/// would close the pores there, and is no number below, where a finite modulus cannot keep the solid from being pressed.
pub const LEAST_PORE_VOLUME: f64 = 0.01;

impl HolmesMow {
    /// k / k0 and its derivative with respect to J, at J = 1 + `volume_change`.
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

/// Hydraulic permeability of the strained tissue, in the deformed configuration: kappa/eta across the layers that lay parallel to the
/// articular surface, a multiple of it along them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mobility {
    /// Across the layers \[m^4/(N s)\].
    pub across: f64,
    /// That along the layers over that across \[1\].
    pub tangential_ratio: f64,
    /// Along the layers of the undeformed tissue; a unit vector.
    pub tangent: Vector2<f64>,
}

impl Mobility {
    /// What is along the layers in excess \[m^4/(N s)\].
    fn excess(&self) -> f64 {
        self.across * (self.tangential_ratio - 1.0)
    }

    /// Conductance tensor of the reference configuration, K with Q = -K grad p.
    ///
    /// Pulled back from the deformed tissue, K = J F^-1 k F^-T with k = k_n 1 + (k_t - k_n) t (x) t and t = F T/|F T|:
    ///
    /// K = k_n J C^-1 + (k_t - k_n) J T (x) T / |F T|^2
    ///
    /// In the paper's literal reading K = k_n 1 + (k_t - k_n) T (x) T, whatever the strain.
    pub fn conductance(&self, strain: &Strain, pulled_back: bool) -> Matrix2<f64> {
        let Self { across, tangent, .. } = *self;
        if !pulled_back {
            let isotropic = Matrix2::identity() * across;
            return if self.excess() == 0.0 { isotropic } else { isotropic + along(&tangent) * self.excess() };
        }
        let j = strain.volume_ratio();
        let isotropic = strain.cofactor.tr_mul(&strain.cofactor) * (across / j);
        if self.excess() == 0.0 {
            return isotropic;
        }
        let stretch = (tangent + strain.gradient * tangent).norm_squared();
        isotropic + along(&tangent) * (self.excess() * j / stretch)
    }

    /// Derivative of [`Self::conductance`] (pulled back) times a vector with respect to the four entries of F, one column each.
    pub fn conductance_derivative(&self, strain: &Strain, gradient: &Vector2<f64>) -> Matrix2x4<f64> {
        let Self { across, tangent, .. } = *self;
        let j = strain.volume_ratio();
        let c = &strain.cofactor;
        let flux = c.tr_mul(&(c * gradient)) / j;
        let cofactor: Vector4<f64> = flatten(c);
        let isotropic = Matrix2x4::from_fn(|row, column| {
            let derivative = |i: usize, k: usize| COFACTOR_DERIVATIVE[2 * i + k][column];
            let dc = Matrix2::new(derivative(0, 0), derivative(0, 1), derivative(1, 0), derivative(1, 1));
            let change = dc.tr_mul(&(c * gradient)) + c.tr_mul(&(dc * gradient));
            across * (change[row] - flux[row] * cofactor[column]) / j
        });
        if self.excess() == 0.0 {
            return isotropic;
        }
        // d(J/|F T|^2) = (cof F - 2 J (F T (x) T)/|F T|^2) : dF / |F T|^2
        let stretched = tangent + strain.gradient * tangent;
        let stretch = stretched.norm_squared();
        let lengthening = flatten(&(stretched * tangent.transpose()));
        let change = (cofactor - lengthening * (2.0 * j / stretch)) / stretch;
        isotropic + tangent * (self.excess() * tangent.dot(gradient)) * change.transpose()
    }
}

fn along(tangent: &Vector2<f64>) -> Matrix2<f64> {
    tangent * tangent.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn derivative_matches_finite_differences(
            h in prop::array::uniform4(-0.3..0.3f64), g in prop::array::uniform2(-1.0..1.0f64), angle in 0.0..6.3f64, ratio in 0.2..5.0f64,
        ) {
            let gradient = Vector2::new(g[0], g[1]);
            let mobility = Mobility { tangential_ratio: ratio, ..isotropic(1.0, angle) };
            let at = |h: [f64; 4]| mobility.conductance(&Strain::new(Matrix2::new(h[0], h[1], h[2], h[3])), true) * gradient;
            let strain = Strain::new(Matrix2::new(h[0], h[1], h[2], h[3]));
            let derivative = mobility.conductance_derivative(&strain, &gradient);
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
        assert!((isotropic(2.0, 0.3).conductance(&rotation, true) - Matrix2::identity() * 2.0).amax() < 1e-14);
        // Nor does a rotation on top of a strain.
        let strained = Matrix2::new(1.1, 0.2, -0.1, 0.8);
        let mobility = Mobility { tangential_ratio: 3.0, ..isotropic(2.0, 0.3) };
        let turned = rotation.deformation_gradient() * strained - Matrix2::identity();
        let strained = Strain::new(strained - Matrix2::identity());
        let difference = mobility.conductance(&Strain::new(turned), true) - mobility.conductance(&strained, true);
        assert!(difference.amax() < 1e-14);
    }

    /// Slabs under a pressure gradient, in the deformed tissue: Darcy's flux per deformed area is k times the drop per deformed length,
    /// with k_t along the layers and k_n across, whatever stretch and shear along the layers came before. A flux through a reference
    /// area becomes F Q/J, a gradient F^-T grad p.
    #[test]
    fn flow_along_and_across_strained_layers_is_that_of_the_deformed_configuration() {
        for (angle, stretch, squeeze, shear) in [(0.0_f64, 1.2, 0.7, 0.0), (0.7, 0.9, 0.8, 0.3), (2.0, 1.0, 0.5, -0.4)]
        {
            let (sine, cosine) = angle.sin_cos();
            let layers = Matrix2::new(cosine, -sine, sine, cosine);
            // In the frame of the layers: they stay flat, and slide over each other.
            let f = layers * Matrix2::new(stretch, shear, 0.0, squeeze) * layers.transpose();
            let strain = Strain::new(f - Matrix2::identity());
            let mobility = Mobility { tangential_ratio: 4.0, ..isotropic(2.0, angle) };
            for (direction, permeability) in [(layers.column(0), 8.0), (layers.column(1), 2.0)] {
                let spatial_gradient = direction * 5.0;
                let flux = f * mobility.conductance(&strain, true) * (f.transpose() * spatial_gradient)
                    / strain.volume_ratio();
                assert!((flux - direction * (5.0 * permeability)).amax() < 1e-13, "{angle} {permeability}: {flux}");
            }
        }
    }

    fn isotropic(across: f64, angle: f64) -> Mobility {
        Mobility { across, tangential_ratio: 1.0, tangent: Vector2::new(angle.cos(), angle.sin()) }
    }
}
