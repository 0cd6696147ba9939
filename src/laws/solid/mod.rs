//! The drained solid of the tissue: hyperelastic, in plane strain.

mod fibres;
mod holmes_mow;
mod isotropic;
mod neo_hookean;
#[cfg(test)]
mod tests;

use nalgebra::{Matrix2, Matrix4, Vector4};

use super::depth::Factors;
use super::kinematics::{Strain, flatten, unflatten};
pub use fibres::Fibres;
pub use holmes_mow::HolmesMow;
use isotropic::{FirstDerivatives, OutOfPlane, SecondDerivatives};
pub use neo_hookean::NeoHookean;

/// The laws of the ground matrix to choose from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GroundMatrix {
    /// Compressible neo-Hookean solid.
    NeoHookean(NeoHookean),
    /// Exponential solid of Holmes and Mow.
    HolmesMow(HolmesMow),
}

/// The solid: what its ground matrix and its fibres add up to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solid {
    /// Ground matrix, isotropic.
    pub matrix: GroundMatrix,
    /// Fibres that only pull, where there are any.
    pub fibres: Option<Fibres>,
}

impl From<NeoHookean> for Solid {
    fn from(law: NeoHookean) -> Self {
        Self { matrix: GroundMatrix::NeoHookean(law), fibres: None }
    }
}

impl From<HolmesMow> for Solid {
    fn from(law: HolmesMow) -> Self {
        Self { matrix: GroundMatrix::HolmesMow(law), fibres: None }
    }
}

/// What the law of a ground matrix says, whichever it is.
macro_rules! of_law {
    ($matrix:expr, $law:ident => $value:expr) => {
        match $matrix {
            GroundMatrix::NeoHookean($law) => $value,
            GroundMatrix::HolmesMow($law) => $value,
        }
    };
}

impl GroundMatrix {
    /// Shear and bulk modulus at small strain \[Pa\].
    fn moduli(&self) -> [f64; 2] {
        of_law!(self, law => [law.shear_modulus, law.bulk_modulus])
    }

    fn energy(&self, strain: &Strain) -> f64 {
        let (i, e) = (strain.first_invariant_change(), strain.volume_change);
        of_law!(self, law => law.energy(i, e))
    }

    #[inline(always)]
    fn first(&self, strain: &Strain) -> FirstDerivatives {
        let (i, e) = (strain.first_invariant_change(), strain.volume_change);
        of_law!(self, law => law.first(i, e))
    }

    fn second(&self, strain: &Strain) -> SecondDerivatives {
        let (i, e) = (strain.first_invariant_change(), strain.volume_change);
        of_law!(self, law => law.second(i, e))
    }

    fn out_of_plane(&self, strain: &Strain) -> OutOfPlane {
        let (i, e) = (strain.first_invariant_change(), strain.volume_change);
        of_law!(self, law => law.out_of_plane(i, e))
    }
}

impl Solid {
    /// With moduli that many times as large.
    pub fn scaled(mut self, factors: &Factors) -> Self {
        let (shear_modulus, bulk_modulus) =
            of_law!(&mut self.matrix, law => (&mut law.shear_modulus, &mut law.bulk_modulus));
        *shear_modulus *= factors.shear_modulus;
        *bulk_modulus *= factors.bulk_modulus;
        if let Some(fibres) = &mut self.fibres {
            fibres.scale(factors.fibre_modulus);
        }
        self
    }

    /// Strain energy W per reference volume \[J/m^3\].
    pub fn energy(&self, strain: &Strain) -> f64 {
        self.matrix.energy(strain) + self.fibres.as_ref().map_or(0.0, |fibres| fibres.energy(strain))
    }

    /// First Piola-Kirchhoff stress P = dW/dF \[Pa\].
    #[inline(always)]
    pub fn stress(&self, strain: &Strain) -> Matrix2<f64> {
        let stress = isotropic::stress(&self.matrix.first(strain), strain);
        match &self.fibres {
            None => stress,
            Some(fibres) => stress + fibres.stress(strain),
        }
    }

    /// Tangent dP/dF \[Pa\], rows and columns in the order of [`flatten`].
    pub fn tangent(&self, strain: &Strain) -> Matrix4<f64> {
        let tangent = isotropic::tangent(&self.matrix.first(strain), &self.matrix.second(strain), strain);
        match &self.fibres {
            None => tangent,
            Some(fibres) => tangent + fibres.tangent(strain),
        }
    }

    /// Modulus of uniaxial compression at small strain, K + 4G/3 \[Pa\]: no fibre pulls.
    pub fn aggregate_modulus(&self) -> f64 {
        let [shear_modulus, bulk_modulus] = self.matrix.moduli();
        bulk_modulus + 4.0 / 3.0 * shear_modulus
    }

    /// Shear modulus G at small strain, where no fibre pulls \[Pa\].
    pub fn shear_modulus(&self) -> f64 {
        self.matrix.moduli()[0]
    }

    /// Von Mises stress of the true (Cauchy) effective stress J^-1 P F^T with the out-of-plane stress of plane strain \[Pa\].
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
        let (j, f, along) = (strain.volume_ratio(), strain.deformation_gradient(), flatten(change));
        let relative_volume = flatten(&strain.cofactor).dot(&along) / j;
        let (p, dp) = (self.stress(strain), unflatten(&(self.tangent(strain) * along)));
        let d = (dp * f.transpose() + p * change.transpose() - p * f.transpose() * relative_volume) / j;
        let dzz = self.out_of_plane_derivative(strain).dot(&along) / j - zz * relative_volume;
        let sum = (xx - yy) * (d.m11 - d.m22) + (yy - zz) * (d.m22 - dzz) + (zz - xx) * (dzz - d.m11);
        (0.5 * sum + 3.0 * xy * d.m12) / size
    }

    /// True effective stress: xx, yy, zz, xy \[Pa\].
    fn cauchy(&self, strain: &Strain) -> [f64; 4] {
        let j = strain.volume_ratio();
        let s = self.stress(strain) * strain.deformation_gradient().transpose() / j;
        [s.m11, s.m22, self.out_of_plane_stress(strain) / j, s.m12]
    }

    /// First Piola-Kirchhoff stress P_zz \[Pa\].
    pub fn out_of_plane_stress(&self, strain: &Strain) -> f64 {
        self.matrix.out_of_plane(strain).stress
            + self.fibres.as_ref().map_or(0.0, |fibres| fibres.out_of_plane_stress(strain))
    }

    /// Its derivative with respect to F \[Pa\], in the order of [`flatten`].
    pub fn out_of_plane_derivative(&self, strain: &Strain) -> Vector4<f64> {
        let derivative = self.matrix.out_of_plane(strain).by_strain(strain);
        match &self.fibres {
            None => derivative,
            Some(fibres) => derivative + fibres.out_of_plane_derivative(strain),
        }
    }
}
