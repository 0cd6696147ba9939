//! Compressible neo-Hookean solid.

use super::isotropic::{FirstDerivatives, OutOfPlane, SecondDerivatives};

/// W = (G/2)(J^(-2/3) I1 - 3) + (K/2)(J - 1)^2 (equations 2-4 of de Boer et al. 2020; their weights alpha and 1 - alpha are
/// already multiplied in).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NeoHookean {
    /// Weighted shear modulus G \[Pa\].
    pub shear_modulus: f64,
    /// Weighted bulk modulus K \[Pa\].
    pub bulk_modulus: f64,
}

impl NeoHookean {
    /// With i = I1 - 3 and e = J - 1.
    pub(super) fn energy(&self, i: f64, e: f64) -> f64 {
        // J^(-2/3) I1 - 3 = J^(-2/3) (3 + i) - 3 without the cancelling 3.
        let root = (-2.0 / 3.0 * e.ln_1p()).exp_m1();
        0.5 * self.shear_modulus * (root * (3.0 + i) + i) + 0.5 * self.bulk_modulus * e * e
    }

    pub(super) fn first(&self, i: f64, e: f64) -> FirstDerivatives {
        let a = self.isochoric(e);
        // A (1 - I1 / (3 J)) + K (J - 1)
        FirstDerivatives { isochoric: a, volumetric: a * (e - i / 3.0) / (1.0 + e) + self.bulk_modulus * e }
    }

    pub(super) fn second(&self, i: f64, e: f64) -> SecondDerivatives {
        let (a, j) = (self.isochoric(e), 1.0 + e);
        SecondDerivatives {
            by_invariant: 0.0,
            mixed: -a / (3.0 * j),
            by_volume: 5.0 / 9.0 * a * (3.0 + i) / (j * j) + self.bulk_modulus,
        }
    }

    pub(super) fn out_of_plane(&self, i: f64, e: f64) -> OutOfPlane {
        let (a, j) = (self.isochoric(e), 1.0 + e);
        OutOfPlane {
            stress: -a * i / 3.0 + self.bulk_modulus * e * j,
            by_invariant: -a / 3.0,
            by_volume: 2.0 / 9.0 * a * i / j + self.bulk_modulus * (j + e),
        }
    }

    /// A = G J^(-2/3) = 2 dW/dI1. A cube root would be slower.
    fn isochoric(&self, e: f64) -> f64 {
        self.shear_modulus * (1.0 + e).powf(-2.0 / 3.0)
    }
}
