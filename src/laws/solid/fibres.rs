//! Fibres that only pull, in all directions alike.

use nalgebra::{Matrix2, Matrix4, Vector2, Vector4};

use crate::laws::kinematics::{Strain, flatten};

/// Directions in the plane, over half a turn. The stress of the pulling fibres then depends by less than 1 % on how the principal
/// strains lie between them (tests, down to a compression of twice the extension), and on a rotation of the body not at all.
const IN_PLANE: usize = 24;

/// Gauss-Legendre points on [-1, 1] that integrate polynomials of degree nine, and their weights.
const POLAR: [[f64; 2]; 5] = [
    [-0.906_179_845_938_664, 0.236_926_885_056_189_1],
    [-0.538_469_310_105_683_1, 0.478_628_670_499_366_5],
    [0.0, 0.568_888_888_888_888_9],
    [0.538_469_310_105_683_1, 0.478_628_670_499_366_5],
    [0.906_179_845_938_664, 0.236_926_885_056_189_1],
];

/// A continuous distribution of fibres over all directions n of space, each with the energy
///
/// ```text
/// psi = xi / (a b) (exp(a x^b) - 1),   x = n . C n - 1 > 0,   and nothing where x <= 0
/// ```
///
/// or, for a = 0, xi / b x^b; W is the mean of psi over the unit sphere (fibre exp-pow in a spherical distribution of the FEBio
/// manual; Ateshian, Rajan, Chahine, Canal and Hung, Journal of Biomechanical Engineering 131 (6), 061003, 2009).
///
/// In plane strain x = s^2 g where s is the sine of the angle between fibre and normal of the plane, g = m . (C - 1) m, and m the
/// unit vector along the fibre's projection on the plane: whether a fibre pulls depends on m alone. With b = 2 and a = 0 the modulus
/// of a small uniaxial extension grows by 4 xi/5.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fibres {
    /// xi \[Pa\].
    modulus: f64,
    /// b \[1\].
    exponent: f64,
    /// a \[1\].
    exponential_coefficient: f64,
    /// m.
    directions: [Vector2<f64>; IN_PLANE],
    polar: [Polar; POLAR.len()],
}

/// An angle between fibre and normal.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Polar {
    weight: f64,
    /// s^2.
    sine_squared: f64,
    /// s^(2 b).
    sine_power: f64,
}

/// Mean over the fibres above one direction of the plane, as functions of g.
#[derive(Default)]
struct Means {
    /// d psi / dg and its derivative.
    in_plane: [f64; 2],
    /// d psi / dx n_z^2 and its derivative.
    out_of_plane: [f64; 2],
}

impl Fibres {
    /// With modulus xi \[Pa\], exponent b >= 2 and coefficient a >= 0 of the exponential.
    pub fn new(modulus: f64, exponent: f64, exponential_coefficient: f64) -> Self {
        Self {
            modulus,
            exponent,
            exponential_coefficient,
            directions: std::array::from_fn(|k| {
                let (sine, cosine) = (std::f64::consts::PI * k as f64 / IN_PLANE as f64).sin_cos();
                Vector2::new(cosine, sine)
            }),
            polar: POLAR.map(|[point, weight]| {
                let cosine = 0.5 * (1.0 + point);
                let sine_squared = 1.0 - cosine * cosine;
                Polar { weight: 0.5 * weight, sine_squared, sine_power: sine_squared.powf(exponent) }
            }),
        }
    }

    /// Multiplies the modulus.
    pub(super) fn scale(&mut self, factor: f64) {
        self.modulus *= factor;
    }

    /// Sum over the directions in which fibres pull, of m, F m and g.
    fn mean<T: std::ops::AddAssign>(
        &self,
        zero: T,
        strain: &Strain,
        term: impl Fn(Vector2<f64>, Vector2<f64>, f64) -> T,
    ) -> T {
        let mut sum = zero;
        for m in self.directions {
            let change = strain.gradient * m;
            let g = 2.0 * m.dot(&change) + change.norm_squared();
            if g > 0.0 {
                sum += term(m, m + change, g);
            }
        }
        sum
    }

    fn means(&self, g: f64) -> Means {
        let Self { modulus, exponent: b, exponential_coefficient: a, .. } = *self;
        let slope = modulus * g.powf(b - 1.0) / IN_PLANE as f64;
        let power = g.powf(b);
        let mut means = Means::default();
        for Polar { weight, sine_squared, sine_power } in self.polar {
            let stiffening = a * sine_power * power;
            let exponential = if a == 0.0 { 1.0 } else { stiffening.exp() };
            // s^2 d psi / dx, and g times its derivative with respect to g
            let pull = weight * sine_power * slope * exponential;
            let stiffness = pull * (b - 1.0 + b * stiffening);
            let out = (1.0 - sine_squared) / sine_squared;
            means.in_plane[0] += pull;
            means.in_plane[1] += stiffness / g;
            means.out_of_plane[0] += pull * out;
            means.out_of_plane[1] += stiffness * out / g;
        }
        means
    }

    /// Strain energy per reference volume \[J/m^3\].
    pub(super) fn energy(&self, strain: &Strain) -> f64 {
        let Self { modulus, exponent: b, exponential_coefficient: a, .. } = *self;
        self.mean(0.0, strain, |_, _, g| {
            let psi = |polar: &Polar| {
                let power = polar.sine_power * g.powf(b);
                polar.weight * if a == 0.0 { power } else { (a * power).exp_m1() / a }
            };
            modulus / b / IN_PLANE as f64 * self.polar.iter().map(psi).sum::<f64>()
        })
    }

    /// First Piola-Kirchhoff stress \[Pa\].
    pub(super) fn stress(&self, strain: &Strain) -> Matrix2<f64> {
        self.mean(Matrix2::zeros(), strain, |m, f, g| f * m.transpose() * (2.0 * self.means(g).in_plane[0]))
    }

    /// Its derivative with respect to F \[Pa\].
    pub(super) fn tangent(&self, strain: &Strain) -> Matrix4<f64> {
        self.mean(Matrix4::zeros(), strain, |m, f, g| {
            let [pull, stiffness] = self.means(g).in_plane;
            let along = flatten(&(f * m.transpose()));
            let turning = (m * m.transpose()) * (2.0 * pull);
            let mut tangent = along * along.transpose() * (4.0 * stiffness);
            for i in 0..2 {
                let mut block = tangent.fixed_view_mut::<2, 2>(2 * i, 2 * i);
                block += turning;
            }
            tangent
        })
    }

    /// First Piola-Kirchhoff stress out of the plane \[Pa\].
    pub(super) fn out_of_plane_stress(&self, strain: &Strain) -> f64 {
        self.mean(0.0, strain, |_, _, g| 2.0 * self.means(g).out_of_plane[0])
    }

    /// Its derivative with respect to F \[Pa\].
    pub(super) fn out_of_plane_derivative(&self, strain: &Strain) -> Vector4<f64> {
        self.mean(Vector4::zeros(), strain, |m, f, g| {
            flatten(&(f * m.transpose())) * (4.0 * self.means(g).out_of_plane[1])
        })
    }
}
