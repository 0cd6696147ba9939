//! Isotropic hyperelastic solids in plane strain.
//!
//! With F_zz = 1 the second invariant is I2 = I1 - 1 + J^2, so that every isotropic energy is a function of I1 and J:
//!
//! ```text
//! P       = 2 W_I F + W_J J F^-T = 2 W_I (F - J F^-T) + (2 W_I + W_J) J F^-T
//! dP/dF   = 2 W_I 1 + 4 W_II F x F + 2 W_IJ (F x C + C x F) + W_JJ C x C + W_J dC/dF,   C = J F^-T = dJ/dF
//! ```
//!
//! The second form of P has no terms that cancel: F - C is formed from H, and the law gives 2 W_I + W_J, which is zero without
//! strain.

use nalgebra::{Matrix2, Matrix4, Vector4};

use crate::laws::kinematics::{COFACTOR_DERIVATIVE, Strain, flatten};

/// First derivatives of the energy.
pub(super) struct FirstDerivatives {
    /// 2 W_I \[Pa\].
    pub isochoric: f64,
    /// 2 W_I + W_J \[Pa\].
    pub volumetric: f64,
}

/// Second derivatives of the energy.
pub(super) struct SecondDerivatives {
    /// W_II \[Pa\].
    pub by_invariant: f64,
    /// W_IJ \[Pa\].
    pub mixed: f64,
    /// W_JJ \[Pa\].
    pub by_volume: f64,
}

/// First Piola-Kirchhoff stress P_zz = dW/dF_zz at F_zz = 1, and its derivatives.
pub(super) struct OutOfPlane {
    /// P_zz \[Pa\].
    pub stress: f64,
    /// By I1 \[Pa\].
    pub by_invariant: f64,
    /// By J \[Pa\].
    pub by_volume: f64,
}

#[inline(always)]
pub(super) fn stress(first: &FirstDerivatives, strain: &Strain) -> Matrix2<f64> {
    let FirstDerivatives { isochoric, volumetric } = *first;
    (strain.gradient - strain.cofactor_change()) * isochoric + strain.cofactor * volumetric
}

pub(super) fn tangent(first: &FirstDerivatives, second: &SecondDerivatives, strain: &Strain) -> Matrix4<f64> {
    let (f, c) = (flatten(&strain.deformation_gradient()), flatten(&strain.cofactor));
    // F x (4 W_II F + 2 W_IJ C) + C x (2 W_IJ F + W_JJ C)
    let along_f = f * (4.0 * second.by_invariant) + c * (2.0 * second.mixed);
    let along_c = f * (2.0 * second.mixed) + c * second.by_volume;
    let by_volume = first.volumetric - first.isochoric;
    let mut tangent = Matrix4::from_fn(|row, column| {
        f[row] * along_f[column] + c[row] * along_c[column] + by_volume * COFACTOR_DERIVATIVE[row][column]
    });
    (0..4).for_each(|row| tangent[(row, row)] += first.isochoric);
    tangent
}

impl OutOfPlane {
    /// Derivative of P_zz with respect to F, in the order of [`flatten`].
    pub(super) fn by_strain(&self, strain: &Strain) -> Vector4<f64> {
        flatten(&strain.deformation_gradient()) * (2.0 * self.by_invariant) + flatten(&strain.cofactor) * self.by_volume
    }
}
