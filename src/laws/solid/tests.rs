use super::*;
use approx::assert_relative_eq;
use proptest::prelude::*;

const SHEAR: f64 = 0.45e6;
const BULK: f64 = 0.5e6;

/// Every law, with these small-strain moduli.
fn solids() -> Vec<Solid> {
    let holmes_mow =
        |stiffening_coefficient| HolmesMow { shear_modulus: SHEAR, bulk_modulus: BULK, stiffening_coefficient }.into();
    vec![
        NeoHookean { shear_modulus: SHEAR, bulk_modulus: BULK }.into(),
        holmes_mow(0.0),
        holmes_mow(0.35),
        holmes_mow(2.0),
    ]
}

fn strain(h: [f64; 4]) -> Strain {
    Strain::new(Matrix2::new(h[0], h[1], h[2], h[3]))
}

#[test]
fn neo_hookean_uniaxial_strain_matches_the_closed_form() {
    // P = (2/3) G (l^(1/3) - l^(-5/3)) + K (l - 1)
    for (l, expected) in [(0.8, -256653.62), (0.95, -56860.545), (1.1, 103746.82)] {
        let p = solids()[0].stress(&strain([0.0, 0.0, 0.0, l - 1.0]));
        assert_relative_eq!(p.m22, expected, max_relative = 1e-7);
        let exact = 2.0 / 3.0 * SHEAR * (l.powf(1.0 / 3.0) - l.powf(-5.0 / 3.0)) + BULK * (l - 1.0);
        assert_relative_eq!(p.m22, exact, max_relative = 1e-12);
    }
}

#[test]
fn neo_hookean_plane_strain_uniaxial_stress_matches_the_computed_stretches() {
    for (l, lateral, expected) in [(0.9, 1.01460287, -116560.61), (1.1, 0.97936163, 97651.323)] {
        let p = solids()[0].stress(&strain([lateral - 1.0, 0.0, 0.0, l - 1.0]));
        assert_relative_eq!(p.m22, expected, max_relative = 2e-7);
        assert!(p.m11.abs() < 1e-2, "lateral stress {} Pa", p.m11);
    }
}

#[test]
fn neo_hookean_simple_shear_is_linear() {
    let p = solids()[0].stress(&strain([0.0, 0.3, 0.0, 0.0]));
    assert_relative_eq!(p.m12, 0.3 * SHEAR, max_relative = 1e-12);
}

#[test]
fn holmes_mow_uniaxial_strain_matches_the_closed_form() {
    // Cauchy stress H/2 (l - 1/l) exp(b (l^2 - 1 - 2 ln l)): the published form H/2 (l^2 - 1) / l^(2 b + 1) exp(b (l^2 - 1)).
    let h = BULK + 4.0 / 3.0 * SHEAR;
    for (solid, b) in solids()[1..].iter().zip([0.0, 0.35, 2.0]) {
        for l in [0.7_f64, 0.95, 1.2] {
            let exact = 0.5 * h * (l * l - 1.0) / l.powf(2.0 * b + 1.0) * (b * (l * l - 1.0)).exp();
            // Along the stretch, Cauchy and first Piola-Kirchhoff stress are the same.
            assert_relative_eq!(solid.stress(&strain([0.0, 0.0, 0.0, l - 1.0])).m22, exact, max_relative = 1e-12);
        }
    }
}

/// W with its constants and invariants as printed, those of C in three dimensions.
#[test]
fn holmes_mow_energy_is_the_published_one() {
    let (solid, b, lame) = (solids()[2], 0.35_f64, BULK - 2.0 / 3.0 * SHEAR);
    for h in [[0.1, 0.2, -0.1, -0.3], [0.3, 0.0, 0.25, 0.2]] {
        let f = nalgebra::Matrix3::new(1.0 + h[0], h[1], 0.0, h[2], 1.0 + h[3], 0.0, 0.0, 0.0, 1.0);
        let c: nalgebra::Matrix3<f64> = f.transpose() * f;
        let (i1, i2) = (c.trace(), 0.5 * (c.trace().powi(2) - (c * c).trace()));
        let brackets =
            (2.0 * SHEAR - lame) * (i1 - 3.0) + lame * (i2 - 3.0) - (lame + 2.0 * SHEAR) * f.determinant().powi(2).ln();
        let q = b / (lame + 2.0 * SHEAR) * brackets;
        let exact = 0.5 * (lame + 2.0 * SHEAR) / (2.0 * b) * (q.exp() - 1.0);
        assert_relative_eq!(solid.energy(&strain(h)), exact, max_relative = 1e-12);
    }
}

/// Hooke's law with G and K, out of the plane too, at strains where 1 + strain has lost most digits.
#[test]
fn small_strain_is_linear_elasticity_and_keeps_its_digits() {
    let lame = BULK - 2.0 / 3.0 * SHEAR;
    for solid in solids() {
        for h in [[0.0, 0.0, 0.0, 1.0], [0.7, 0.2, -0.4, -0.3], [0.0, 1.0, 1.0, 0.0]].map(|h| h.map(|v| 1e-13 * v)) {
            let hooke = |row: usize| {
                let shear = [2.0 * h[0], h[1] + h[2], h[1] + h[2], 2.0 * h[3]][row];
                SHEAR * shear + if row == 0 || row == 3 { lame * (h[0] + h[3]) } else { 0.0 }
            };
            let p = flatten(&solid.stress(&strain(h)));
            (0..4).for_each(|row| assert_relative_eq!(p[row], hooke(row), max_relative = 1e-11, epsilon = 1e-17));
            assert_relative_eq!(solid.out_of_plane_stress(&strain(h)), lame * (h[0] + h[3]), max_relative = 1e-11);
        }
        // The energy is of second order in the strain: relative to round-off in terms of first order it may lose digits, not vanish.
        assert!(solid.energy(&strain([0.0, 0.0, 0.0, 1e-5])) > 0.0);
        assert_relative_eq!(solid.aggregate_modulus(), BULK + 4.0 / 3.0 * SHEAR, max_relative = 1e-12);
    }
}

#[test]
fn von_mises_of_equal_lateral_stresses_is_the_difference_of_the_principal_stresses() {
    for solid in solids() {
        // Uniaxial strain: both lateral stresses are equal in an isotropic solid.
        let s = strain([0.0, 0.0, 0.0, -0.1]);
        let p = solid.stress(&s);
        assert_relative_eq!(solid.von_mises(&s), (p.m11 / 0.9 - p.m22).abs(), max_relative = 1e-12);
    }
}

/// The change of a value along a change of H, by central differences.
fn difference<T>(f: impl Fn(&Strain) -> T, h: [f64; 4], d: [f64; 4]) -> T
where
    T: std::ops::Sub<Output = T> + std::ops::Div<f64, Output = T>,
{
    let at = |s: f64| f(&strain(std::array::from_fn(|k| h[k] + s * d[k])));
    (at(1e-6) - at(-1e-6)) / 2e-6
}

proptest! {
    #[test]
    fn stress_is_the_derivative_of_the_energy(h in prop::array::uniform4(-0.3..0.3f64)) {
        for solid in solids() {
            let p = flatten(&solid.stress(&strain(h)));
            for k in 0..4 {
                let by_difference = difference(|s| solid.energy(s), h, std::array::from_fn(|i| f64::from(i == k)));
                prop_assert!((p[k] - by_difference).abs() < 1e-3 + 1e-8 * p.amax(), "{solid:?} {} {by_difference}", p[k]);
            }
        }
    }

    #[test]
    fn tangent_is_the_derivative_of_the_stress_and_symmetric(h in prop::array::uniform4(-0.3..0.3f64)) {
        for solid in solids() {
            let tangent = solid.tangent(&strain(h));
            prop_assert!((tangent - tangent.transpose()).amax() < 1e-12 * tangent.amax());
            for k in 0..4 {
                let by_difference = difference(|s| flatten(&solid.stress(s)), h, std::array::from_fn(|i| f64::from(i == k)));
                prop_assert!((tangent.column(k) - by_difference).amax() < 1e-8 * tangent.amax(), "{solid:?}");
            }
        }
    }

    #[test]
    fn von_mises_derivative_matches_finite_differences(
        h in prop::array::uniform4(-0.3..0.3f64), d in prop::array::uniform4(-1.0..1.0f64),
    ) {
        for solid in solids() {
            prop_assume!(solid.von_mises(&strain(h)) > 1e4);
            let derivative = solid.von_mises_derivative(&strain(h), &Matrix2::new(d[0], d[1], d[2], d[3]));
            let scale = solid.tangent(&strain(h)).amax();
            prop_assert!((derivative - difference(|s| solid.von_mises(s), h, d)).abs() < 1e-6 * scale, "{solid:?}");
        }
    }

    /// Turned by a rotation R the energy stays, and P becomes R P.
    #[test]
    fn a_rotation_of_the_body_turns_the_stress_with_it(h in prop::array::uniform4(-0.3..0.3f64), angle in -3.0..3.0f64) {
        let (sin, cos) = angle.sin_cos();
        let rotation = Matrix2::new(cos, -sin, sin, cos);
        let here = strain(h);
        let turned = Strain::new(rotation * here.deformation_gradient() - Matrix2::identity());
        for solid in solids() {
            let p = solid.stress(&here);
            prop_assert!((solid.stress(&turned) - rotation * p).amax() < 1e-10 * (SHEAR + p.amax()), "{solid:?}");
            prop_assert!((solid.energy(&turned) - solid.energy(&here)).abs() < 1e-10 * (SHEAR + solid.energy(&here)));
            prop_assert!((solid.von_mises(&turned) - solid.von_mises(&here)).abs() < 1e-9 * (SHEAR + p.amax()));
        }
    }
}
