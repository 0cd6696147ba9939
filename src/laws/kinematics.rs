//! Strain in plane strain, and tensors as vectors.

use nalgebra::{Matrix2, Vector4};

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

    /// F = 1 + H.
    pub fn deformation_gradient(&self) -> Matrix2<f64> {
        Matrix2::identity() + self.gradient
    }

    /// J F^-T - 1.
    pub fn cofactor_change(&self) -> Matrix2<f64> {
        let h = &self.gradient;
        Matrix2::new(h.m22, -h.m21, -h.m12, h.m11)
    }

    /// I1 - 3 with I1 = F:F + 1, of the three-dimensional tensor.
    pub fn first_invariant_change(&self) -> f64 {
        2.0 * self.gradient.trace() + self.gradient.norm_squared()
    }
}

/// Second derivative of J: d(J F^-T)_ij / dF_kl = e_ik e_jl, in the order of [`flatten`].
pub const COFACTOR_DERIVATIVE: [[f64; 4]; 4] =
    [[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, -1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]];

/// A 2 x 2 tensor as a vector in the order 11, 12, 21, 22, the order of rows and columns of every tangent.
pub fn flatten(m: &Matrix2<f64>) -> Vector4<f64> {
    Vector4::new(m.m11, m.m12, m.m21, m.m22)
}

/// The tensor of [`flatten`].
pub fn unflatten(v: &Vector4<f64>) -> Matrix2<f64> {
    Matrix2::new(v[0], v[1], v[2], v[3])
}
