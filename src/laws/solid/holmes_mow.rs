//! Exponential solid of Holmes and Mow: it stiffens as it is strained.

use super::isotropic::{FirstDerivatives, OutOfPlane, SecondDerivatives};

/// W = (c/2) (exp(Q) - 1) with c = (l + 2 G) / (2 b), b the stiffening coefficient, l = K - 2 G/3 and
///
/// ```text
/// Q = b / (l + 2 G) [(2 G - l) (I1 - 3) + l (I2 - 3) - (l + 2 G) ln J^2]
/// ```
///
/// (Holmes and Mow, Journal of Biomechanics 23 (11), 1145-1156, 1990, in the notation of the FEBio manual). Without strain there is
/// no stress, and the moduli are G and K. In plane strain, where I2 = I1 - 1 + J^2,
///
/// ```text
/// Q = b / (l + 2 G) [2 G (I1 - 3 - 2 ln J) + l (J^2 - 1 - 2 ln J)]
/// P = exp(Q) [G (F - F^-T) + (l/2) (J^2 - 1) F^-T]
/// ```
///
/// For b = 0 that is a neo-Hookean solid with another volumetric term.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HolmesMow {
    /// Shear modulus G at small strain \[Pa\].
    pub shear_modulus: f64,
    /// Bulk modulus K at small strain \[Pa\]; 2 G/3 or more, or the solid is not stable in great expansion.
    pub bulk_modulus: f64,
    /// b \[1\].
    pub stiffening_coefficient: f64,
}

impl HolmesMow {
    fn lame(&self) -> f64 {
        self.bulk_modulus - 2.0 / 3.0 * self.shear_modulus
    }

    /// Q / b
    fn exponent(&self, i: f64, e: f64) -> f64 {
        let (g, lame, log) = (self.shear_modulus, self.lame(), e.ln_1p());
        (2.0 * g * (i - 2.0 * log) + lame * (e * (2.0 + e) - 2.0 * log)) / (lame + 2.0 * g)
    }

    fn exponential(&self, i: f64, e: f64) -> f64 {
        (self.stiffening_coefficient * self.exponent(i, e)).exp()
    }

    /// Derivatives of Q with respect to I1 and J.
    fn exponent_derivatives(&self, e: f64) -> [f64; 2] {
        let (g, lame, j) = (self.shear_modulus, self.lame(), 1.0 + e);
        let factor = 2.0 * self.stiffening_coefficient / (lame + 2.0 * g);
        [factor * g, factor * (lame * e * (1.0 + j) - 2.0 * g) / j]
    }

    /// With i = I1 - 3 and e = J - 1.
    pub(super) fn energy(&self, i: f64, e: f64) -> f64 {
        let (b, exponent) = (self.stiffening_coefficient, self.exponent(i, e));
        let stiffened = if b == 0.0 { exponent } else { (b * exponent).exp_m1() / b };
        0.25 * (self.lame() + 2.0 * self.shear_modulus) * stiffened
    }

    pub(super) fn first(&self, i: f64, e: f64) -> FirstDerivatives {
        let (g, lame, exponential) = (self.shear_modulus, self.lame(), self.exponential(i, e));
        FirstDerivatives {
            isochoric: exponential * g,
            volumetric: exponential * e / (1.0 + e) * (g + 0.5 * lame * (2.0 + e)),
        }
    }

    pub(super) fn second(&self, i: f64, e: f64) -> SecondDerivatives {
        let (g, lame, j, exponential) = (self.shear_modulus, self.lame(), 1.0 + e, self.exponential(i, e));
        let [by_invariant, by_volume] = self.exponent_derivatives(e);
        // W_J = exp(Q) w
        let w = 0.5 * (lame * e * (1.0 + j) - 2.0 * g) / j;
        SecondDerivatives {
            by_invariant: exponential * 0.5 * g * by_invariant,
            mixed: exponential * 0.5 * g * by_volume,
            by_volume: exponential * (0.5 * lame + (0.5 * lame + g) / (j * j) + w * by_volume),
        }
    }

    /// P_zz = exp(Q) (l/2) (I1 - 3)
    pub(super) fn out_of_plane(&self, i: f64, e: f64) -> OutOfPlane {
        let stiffness = 0.5 * self.lame() * self.exponential(i, e);
        let [by_invariant, by_volume] = self.exponent_derivatives(e);
        OutOfPlane {
            stress: stiffness * i,
            by_invariant: stiffness * (1.0 + i * by_invariant),
            by_volume: stiffness * i * by_volume,
        }
    }
}
