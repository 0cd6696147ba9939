use super::*;
use approx::assert_relative_eq;
use proptest::prelude::*;

const SHEAR: f64 = 0.45e6;
const BULK: f64 = 0.5e6;

/// Every law, with these small-strain moduli.
fn solids() -> Vec<Solid> {
    let holmes_mow =
        |stiffening_coefficient| HolmesMow { shear_modulus: SHEAR, bulk_modulus: BULK, stiffening_coefficient }.into();
    let matrix: Solid = NeoHookean { shear_modulus: SHEAR, bulk_modulus: BULK }.into();
    // Exponents at which finite differences do not see where a fibre begins to pull.
    let fibres = |exponent, coefficient| Solid { fibres: Some(Fibres::new(1e6, exponent, coefficient)), ..matrix };
    vec![matrix, holmes_mow(0.0), holmes_mow(0.35), holmes_mow(2.0), fibres(4.0, 0.0), fibres(3.5, 2.0)]
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

/// Means over the unit sphere: n_y^(2 b) is 1 / (2 b + 1), n_y^(2 b - 2) n_x^2 is 1 / ((2 b - 1) (2 b + 1)).
#[test]
fn fibres_in_uniaxial_extension_match_the_closed_form() {
    for b in [2.0, 3.0, 4.0] {
        let fibres = Fibres::new(3e6, b, 0.0);
        for l in [1.0001_f64, 1.02, 1.3] {
            let (s, x) = (strain([0.0, 0.0, 0.0, l - 1.0]), l * l - 1.0);
            let pull = 2.0 * 3e6 * x.powf(b - 1.0) / (2.0 * b + 1.0);
            assert_relative_eq!(fibres.energy(&s), 3e6 / b * x.powf(b) / (2.0 * b + 1.0), max_relative = 1e-9);
            let p = fibres.stress(&s);
            assert_relative_eq!(p.m22, pull * l, max_relative = 1e-9);
            assert_relative_eq!(p.m11, pull / (2.0 * b - 1.0), max_relative = 1e-9);
            assert_relative_eq!(fibres.out_of_plane_stress(&s), pull / (2.0 * b - 1.0), max_relative = 1e-9);
        }
    }
    // Small extension, b = 2.
    let fibres = Fibres::new(3e6, 2.0, 0.0);
    assert_relative_eq!(fibres.tangent(&strain([0.0, 0.0, 0.0, 1e-9]))[(3, 3)], 0.8 * 3e6, max_relative = 1e-7);
}

#[test]
fn fibres_do_not_push() {
    let fibres = Fibres::new(3e6, 2.0, 1.0);
    for s in [[0.0; 4], [-0.1, 0.05, -0.03, -0.2], [0.0, 0.0, 0.0, -0.1]].map(strain) {
        assert_eq!(fibres.energy(&s), 0.0);
        assert_eq!(fibres.stress(&s), Matrix2::zeros());
        assert_eq!(fibres.tangent(&s), Matrix4::zeros());
        assert_eq!((fibres.out_of_plane_stress(&s), fibres.out_of_plane_derivative(&s)), (0.0, Vector4::zeros()));
    }
}

/// The definition in three dimensions, by the midpoint rule in both angles of the sphere.
#[test]
fn the_energy_of_fibres_is_the_mean_over_the_sphere() {
    const COUNT: usize = 1000;
    let (modulus, b, a) = (2e6, 2.5, 3.0);
    for h in [[0.2, 0.1, -0.05, 0.1], [0.2, 0.1, -0.05, -0.1]] {
        let f = nalgebra::Matrix3::new(1.0 + h[0], h[1], 0.0, h[2], 1.0 + h[3], 0.0, 0.0, 0.0, 1.0);
        let mut sum = 0.0;
        for i in 0..COUNT {
            let cosine = (2 * i + 1) as f64 / COUNT as f64 - 1.0;
            let sine = (1.0 - cosine * cosine).sqrt();
            for j in 0..COUNT {
                let (y, x) = (std::f64::consts::PI * (j as f64 + 0.5) / COUNT as f64).sin_cos();
                let stretch = (f * nalgebra::Vector3::new(sine * x, sine * y, cosine)).norm_squared();
                if stretch > 1.0 {
                    sum += modulus / (a * b) * ((a * (stretch - 1.0).powf(b)).exp() - 1.0);
                }
            }
        }
        let mean = sum / (COUNT * COUNT) as f64;
        assert_relative_eq!(Fibres::new(modulus, b, a).energy(&strain(h)), mean, max_relative = 3e-3);
    }
}

#[test]
fn fibres_are_isotropic_between_their_directions() {
    for exponent in [2.0, 3.0] {
        let fibres = Fibres::new(1e6, exponent, 0.0);
        for compression in [0.01, 0.1, 0.2] {
            let stretches = Matrix2::new(0.1, 0.0, 0.0, -compression);
            let pull = |degrees: f64| {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let rotation = Matrix2::new(cos, -sin, sin, cos);
                (rotation.transpose()
                    * fibres.stress(&Strain::new(rotation * stretches * rotation.transpose()))
                    * rotation)
                    .m11
            };
            (1..8).for_each(|k| assert_relative_eq!(pull(0.0), pull(f64::from(k)), max_relative = 1e-2));
        }
    }
}

/// The tangent where fibres pull from the first, b = 2.
#[test]
fn bilinear_fibres_have_the_derivatives_of_their_energy() {
    let solid = Solid { fibres: Some(Fibres::new(2e6, 2.0, 5.0)), ..solids()[0] };
    for h in [[0.11, 0.07, -0.03, -0.12], [-0.05, 0.2, 0.1, 0.08]] {
        let (p, tangent) = (flatten(&solid.stress(&strain(h))), solid.tangent(&strain(h)));
        for k in 0..4 {
            let along = std::array::from_fn(|i| f64::from(i == k));
            assert_relative_eq!(p[k], difference(|s| solid.energy(s), h, along), max_relative = 1e-6);
            let by_difference = difference(|s| flatten(&solid.stress(s)), h, along);
            assert!((tangent.column(k) - by_difference).amax() < 1e-7 * tangent.amax());
        }
    }
}

/// Plane strain between frictionless plates, free at the sides: Newton's method on the lateral stretch, against bisection on
/// the energy in principal stretches with a fine sum over the fibres, b = 2: the mean of s^4 over the sphere is 8/15.
#[test]
fn unconfined_compression_and_tension_match_a_solution_in_principal_stretches() {
    let (modulus, shear, bulk) = (10e6, 0.17e6, 0.4e6);
    let matrix: Solid = NeoHookean { shear_modulus: shear, bulk_modulus: bulk }.into();
    let solid = Solid { fibres: Some(Fibres::new(modulus, 2.0, 0.0)), ..matrix };
    let energy = |x: f64, y: f64| {
        let count = 4000;
        let pull = |k: usize| {
            let (sin, cos) = (std::f64::consts::PI * (k as f64 + 0.5) / f64::from(count)).sin_cos();
            ((x * x - 1.0) * cos * cos + (y * y - 1.0) * sin * sin).max(0.0).powi(2)
        };
        let fibres = 0.5 * modulus * 8.0 / 15.0 * (0..count as usize).map(pull).sum::<f64>() / f64::from(count);
        let j = x * y;
        0.5 * shear * ((x * x + y * y + 1.0) / j.cbrt().powi(2) - 3.0) + 0.5 * bulk * (j - 1.0).powi(2) + fibres
    };
    let step = 1e-5;
    let mut stiffness = Vec::new();
    for l in [0.8, 0.9, 1.1] {
        let mut lateral = 0.0;
        for _ in 0..30 {
            let s = strain([lateral, 0.0, 0.0, l - 1.0]);
            lateral -= solid.stress(&s).m11 / solid.tangent(&s)[(0, 0)];
        }
        let s = strain([lateral, 0.0, 0.0, l - 1.0]);
        assert!(solid.stress(&s).m11.abs() < 1e-3);
        let side = |x: f64| (energy(x + step, l) - energy(x - step, l)) / (2.0 * step);
        let (mut low, mut high) = (0.5, 1.5);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if side(middle) > 0.0 { high = middle } else { low = middle }
        }
        let exact = (energy(low, l + step) - energy(low, l - step)) / (2.0 * step);
        println!("stretch {l}: lateral {} and {low}, stress {} and {exact}", 1.0 + lateral, solid.stress(&s).m22);
        assert_relative_eq!(1.0 + lateral, low, max_relative = 1e-3);
        assert_relative_eq!(solid.stress(&s).m22, exact, max_relative = 1e-2);
        stiffness.push(solid.stress(&s).m22 / (l - 1.0));
    }
    // The matrix alone is about as stiff in tension as in compression.
    assert!(stiffness[2] > 4.0 * stiffness[1], "{stiffness:?}");
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
        assert_relative_eq!(solid.shear_modulus(), SHEAR, max_relative = 1e-12);
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
