//! Darcy's law: how much fluid a pressure gradient drives through the pores.

use nalgebra::{Matrix2, Vector2, Vector4};

use super::neo_hookean::{COFACTOR_DERIVATIVE, Strain, flatten};

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

    #[test]
    fn rigid_rotation_changes_nothing_but_the_frame() {
        let (sin, cos) = 0.4_f64.sin_cos();
        let rotation = Strain::new(Matrix2::new(cos - 1.0, -sin, sin, cos - 1.0));
        assert!((conductance(2.0, &rotation, true) - Matrix2::identity() * 2.0).amax() < 1e-14);
    }
}
