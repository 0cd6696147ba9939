//! Compressible neo-Hookean solid in plane strain.

use nalgebra::{Matrix2, Matrix4, Vector4};

/// Shear and bulk modulus as they enter the strain energy W = (G/2)(J^(-2/3) I1 - 3) + (K/2)(J - 1)^2, [Pa], with
/// I1 = F:F + 1 (equations 2-4 of de Boer et al. 2020; their weights alpha and 1 - alpha are already multiplied in).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NeoHookean {
    /// Weighted shear modulus G [Pa].
    pub shear_modulus: f64,
    /// Weighted bulk modulus K [Pa].
    pub bulk_modulus: f64,
}

/// Kinematics of a displacement gradient H = grad u.
///
/// Everything is formed from H itself, never from F = 1 + H, so that strains far below machine epsilon relative to 1 keep
/// their digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strain {
    /// H, with H_ij = du_i / dX_j.
    pub gradient: Matrix2<f64>,
    /// J - 1 = tr H + det H.
    pub volume_change: f64,
    /// Cofactor of F, J F^-T; it is also dJ/dF.
    pub cofactor: Matrix2<f64>,
}

impl Strain {
    /// From the displacement gradient.
    pub fn new(gradient: Matrix2<f64>) -> Self {
        let h = &gradient;
        Self {
            gradient,
            volume_change: h.trace() + h.determinant(),
            cofactor: Matrix2::new(1.0 + h.m22, -h.m21, -h.m12, 1.0 + h.m11),
        }
    }

    /// J = det F.
    pub fn volume_ratio(&self) -> f64 {
        1.0 + self.volume_change
    }
}

/// Second derivative of J: d(J F^-T)_ij / dF_kl = e_ik e_jl, in the order of [`flatten`].
pub const COFACTOR_DERIVATIVE: [[f64; 4]; 4] =
    [[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, -1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]];

/// A 2 x 2 tensor as a vector in the order 11, 12, 21, 22, the order of rows and columns of every tangent.
pub fn flatten(m: &Matrix2<f64>) -> Vector4<f64> {
    Vector4::new(m.m11, m.m12, m.m21, m.m22)
}

impl NeoHookean {
    /// Strain energy per reference volume [J/m^3].
    pub fn energy(&self, strain: &Strain) -> f64 {
        let j = strain.volume_ratio();
        // J^(-2/3) I1 - 3 with I1 = 3 + i and J = 1 + e, without the cancelling 3.
        let i = 2.0 * strain.gradient.trace() + strain.gradient.norm_squared();
        let root = (-2.0 / 3.0 * strain.volume_change.ln_1p()).exp_m1();
        0.5 * self.shear_modulus * (root * (3.0 + i) + i) + 0.5 * self.bulk_modulus * (j - 1.0).powi(2)
    }

    /// First Piola-Kirchhoff stress P = dW/dF [Pa].
    ///
    /// P = A (F - (I1/3) F^-T) + K (J - 1) J F^-T, A = G J^(-2/3).
    pub fn stress(&self, strain: &Strain) -> Matrix2<f64> {
        let h = &strain.gradient;
        let e = strain.volume_change;
        let j = 1.0 + e;
        let i = 2.0 * h.trace() + h.norm_squared();
        let cofactor_change = strain.cofactor - Matrix2::identity();
        // F - (I1/3) F^-T = [(e - i/3) 1 + (1 + e) H - (1 + i/3) (J F^-T - 1)] / J
        let isochoric = (Matrix2::identity() * (e - i / 3.0) + h * j - cofactor_change * (1.0 + i / 3.0)) / j;
        isochoric * (self.shear_modulus * power_minus_two_thirds(j)) + strain.cofactor * (self.bulk_modulus * e)
    }

    /// Tangent dP/dF [Pa], rows and columns in the order of [`flatten`].
    pub fn tangent(&self, strain: &Strain) -> Matrix4<f64> {
        let j = strain.volume_ratio();
        let f = Matrix2::identity() + strain.gradient;
        let t = strain.cofactor / j;
        let third = (f.norm_squared() + 1.0) / 3.0;
        let a = self.shear_modulus * power_minus_two_thirds(j);
        let (f, t, c) = (flatten(&f), flatten(&t), flatten(&strain.cofactor));
        // F^-T_ij differentiates to -F^-T_il F^-T_kj.
        let mut tangent = Matrix4::zeros();
        for row in 0..4 {
            for column in 0..4 {
                let (i, jj, k, l) = (row / 2, row % 2, column / 2, column % 2);
                let inverse = t[2 * i + l] * t[2 * k + jj];
                tangent[(row, column)] = a
                    * (third * (inverse + 2.0 / 3.0 * t[row] * t[column])
                        - 2.0 / 3.0 * (t[row] * f[column] + f[row] * t[column]))
                    + self.bulk_modulus
                        * (c[row] * c[column] + strain.volume_change * COFACTOR_DERIVATIVE[row][column]);
            }
            tangent[(row, row)] += a;
        }
        tangent
    }

    /// Von Mises stress of the true (Cauchy) effective stress J^-1 P F^T with the out-of-plane stress of plane strain [Pa].
    pub fn von_mises(&self, strain: &Strain) -> f64 {
        let [xx, yy, zz, xy] = self.cauchy(strain);
        (0.5 * ((xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2)) + 3.0 * xy * xy).sqrt()
    }

    /// Derivative of [`Self::von_mises`] along a change of the displacement gradient.
    pub fn von_mises_derivative(&self, strain: &Strain, change: &Matrix2<f64>) -> f64 {
        let [xx, yy, zz, xy] = self.cauchy(strain);
        let size = self.von_mises(strain);
        if size == 0.0 {
            return 0.0;
        }
        let (j, f) = (strain.volume_ratio(), Matrix2::identity() + strain.gradient);
        let relative_volume = flatten(&strain.cofactor).dot(&flatten(change)) / j;
        let stress = self.stress(strain);
        let p = self.tangent(strain) * flatten(change);
        let dp = Matrix2::new(p[0], p[1], p[2], p[3]);
        let d = (dp * f.transpose() + stress * change.transpose()) / j - stress * f.transpose() * (relative_volume / j);
        let third = (f.norm_squared() + 1.0) / 3.0;
        let a = self.shear_modulus * power_minus_two_thirds(j) / j;
        let dzz = -5.0 / 3.0 * relative_volume * a * (1.0 - third) - a * 2.0 / 3.0 * f.dot(change)
            + self.bulk_modulus * relative_volume * j;
        let sum = (xx - yy) * (d.m11 - d.m22) + (yy - zz) * (d.m22 - dzz) + (zz - xx) * (dzz - d.m11);
        (0.5 * sum + 3.0 * xy * d.m12) / size
    }

    /// True effective stress: xx, yy, zz, xy [Pa].
    fn cauchy(&self, strain: &Strain) -> [f64; 4] {
        let j = strain.volume_ratio();
        let f = Matrix2::identity() + strain.gradient;
        let s = self.stress(strain) * f.transpose() / j;
        let i = 2.0 * strain.gradient.trace() + strain.gradient.norm_squared();
        let zz =
            -self.shear_modulus * power_minus_two_thirds(j) * i / (3.0 * j) + self.bulk_modulus * strain.volume_change;
        [s.m11, s.m22, zz, s.m12]
    }
}

fn power_minus_two_thirds(j: f64) -> f64 {
    // A cube root is slower.
    j.powf(-2.0 / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    const PAPER: NeoHookean = NeoHookean { shear_modulus: 0.45e6, bulk_modulus: 0.5e6 };

    fn strain(h: [f64; 4]) -> Strain {
        Strain::new(Matrix2::new(h[0], h[1], h[2], h[3]))
    }

    #[test]
    fn uniaxial_strain_matches_the_closed_form() {
        // P = (2/3) G (l^(1/3) - l^(-5/3)) + K (l - 1)
        for (l, expected) in [(0.8, -256653.62), (0.95, -56860.545), (1.1, 103746.82)] {
            let p = PAPER.stress(&strain([0.0, 0.0, 0.0, l - 1.0]));
            assert_relative_eq!(p.m22, expected, max_relative = 1e-7);
            let (g, k) = (PAPER.shear_modulus, PAPER.bulk_modulus);
            let exact = 2.0 / 3.0 * g * (l.powf(1.0 / 3.0) - l.powf(-5.0 / 3.0)) + k * (l - 1.0);
            assert_relative_eq!(p.m22, exact, max_relative = 1e-12);
        }
    }

    #[test]
    fn plane_strain_uniaxial_stress_matches_the_computed_stretches() {
        for (l, lateral, expected) in [(0.9, 1.01460287, -116560.61), (1.1, 0.97936163, 97651.323)] {
            let p = PAPER.stress(&strain([lateral - 1.0, 0.0, 0.0, l - 1.0]));
            assert_relative_eq!(p.m22, expected, max_relative = 2e-7);
            assert!(p.m11.abs() < 1e-2, "lateral stress {} Pa", p.m11);
        }
    }

    #[test]
    fn simple_shear_is_linear() {
        let p = PAPER.stress(&strain([0.0, 0.3, 0.0, 0.0]));
        assert_relative_eq!(p.m12, 0.3 * PAPER.shear_modulus, max_relative = 1e-12);
    }

    #[test]
    fn tiny_strains_keep_their_digits() {
        // Linear elasticity: P_22 = (K + 4G/3) e for uniaxial strain e.
        let e = 1e-13;
        let p = PAPER.stress(&strain([0.0, 0.0, 0.0, e]));
        let modulus = PAPER.bulk_modulus + 4.0 / 3.0 * PAPER.shear_modulus;
        assert_relative_eq!(p.m22, modulus * e, max_relative = 1e-12);
        // The energy is of second order in e: relative to round-off in first-order terms it may lose digits, not vanish.
        assert!(PAPER.energy(&strain([0.0, 0.0, 0.0, 1e-5])) > 0.0);
    }

    #[test]
    fn von_mises_of_uniaxial_strain_is_the_difference_of_the_principal_stresses() {
        let s = strain([0.0, 0.0, 0.0, -0.1]);
        let p = PAPER.stress(&s);
        let (lateral, axial) = (p.m11 / 0.9, p.m22);
        assert_relative_eq!(PAPER.von_mises(&s), (lateral - axial).abs(), max_relative = 1e-12);
    }

    proptest! {
        #[test]
        fn stress_is_the_derivative_of_the_energy(h in prop::array::uniform4(-0.3..0.3f64)) {
            let p = flatten(&PAPER.stress(&strain(h)));
            for k in 0..4 {
                let step = 1e-6;
                let (mut plus, mut minus) = (h, h);
                plus[k] += step;
                minus[k] -= step;
                let difference = (PAPER.energy(&strain(plus)) - PAPER.energy(&strain(minus))) / (2.0 * step);
                prop_assert!((p[k] - difference).abs() < 1e-9 * 1e6 + 1e-8 * p.amax(), "{} {}", p[k], difference);
            }
        }

        #[test]
        fn von_mises_derivative_matches_finite_differences(h in prop::array::uniform4(-0.3..0.3f64), d in prop::array::uniform4(-1.0..1.0f64)) {
            let at = |s: f64| PAPER.von_mises(&strain(std::array::from_fn(|k| h[k] + s * d[k])));
            prop_assume!(at(0.0) > 1e4);
            let derivative = PAPER.von_mises_derivative(&strain(h), &Matrix2::new(d[0], d[1], d[2], d[3]));
            prop_assert!((derivative - (at(1e-6) - at(-1e-6)) / 2e-6).abs() < 1e-7 * 1e7);
        }

        #[test]
        fn tangent_is_the_derivative_of_the_stress(h in prop::array::uniform4(-0.3..0.3f64)) {
            let tangent = PAPER.tangent(&strain(h));
            for k in 0..4 {
                let step = 1e-6;
                let (mut plus, mut minus) = (h, h);
                plus[k] += step;
                minus[k] -= step;
                let difference = (flatten(&PAPER.stress(&strain(plus))) - flatten(&PAPER.stress(&strain(minus)))) / (2.0 * step);
                prop_assert!((tangent.column(k) - difference).amax() < 1e-8 * tangent.amax());
            }
        }
    }
}
