//! What is left of the distance along the surfaces between nodes of both that are paired.
//!
//! Paired nodes have the same pressures, and the gap is the distance of the surfaces there. Boundary friction, and tissue that stretches
//! more on one side, move them apart along the surfaces. The mesh goes along ([`System::paired_anew`]); what it leaves, between nodes and
//! since it did, is some ξ = x_upper - x_lower. To first order in ξ the surfaces have the distance, and feel the pressures, of the points
//! that are at the same place. With the mean m of both surfaces, over the coordinate s of the columns:
//!
//! - The area between the surfaces, in strips from node to node, is int (y_upper - y_lower) m_x' - ξ m_y' ds. So gap h and vertical distance
//!   differ by the rise r of the mean surface over that length, y_upper - y_lower = h + r, with
//!
//!   int r m_x' w ds = int ξ m_y' w ds   at the nodes (Simpson's rule).
//!
//! - The work of a pressure p on that area moves it along the surfaces: int p/2 (ξ v)' ds in the vertical balances of both bodies, beside
//!   int p n . v da on either surface. By that the moments of p about x = 0, int p/2 (x_upper x_lower)' ds, are the same for both.
//!
//! Of mirror images ξ is zero.
//!
//! [`System::paired_anew`]: crate::equations::system::System::paired_anew

use crate::equations::contact::ContactLaw;
use crate::fem::element::{GAUSS, GAUSS_WEIGHTS, SIMPSON, pressure, quadratic, quadratic_derivative};

/// Local unknowns of a column, at three nodes each: x of the upper and of the lower surface, mean vertical displacement, rise, fluid
/// pressure, gap.
pub const UNKNOWNS: usize = 18;
/// Local equations: those of the mean displacement and of the rise.
pub const EQUATIONS: usize = 6;

/// Which of the local unknowns the equations are of.
pub const ROWS: std::ops::Range<usize> = MEAN..MEAN + EQUATIONS;

const UPPER: usize = 0;
const LOWER: usize = 3;
const MEAN: usize = 6;
const RISE: usize = 9;
const PRESSURE: usize = 12;
const GAP: usize = 15;

/// A column of the interface.
#[derive(Debug, Clone, Copy)]
pub struct Facing {
    /// Height of the middle between the undeformed surfaces at the nodes \[m\].
    pub height: [f64; 3],
    /// Cosines of the inclination of the film at the nodes, across which gaps and rises are measured.
    pub cosine: [f64; 3],
    /// What the condition of the rise is multiplied with at the nodes \[Pa/m\].
    pub scale: [f64; 3],
    /// Order of the fluid's pressure.
    pub pressure_order: i32,
    /// How gap and pressure of the solids go together.
    pub law: ContactLaw,
    /// Whether the distance along the surfaces counts; if not, there is no rise.
    pub counts: bool,
}

/// Residuals and their derivatives: those of the mean displacement, then those of the rise.
#[derive(Debug, Clone, PartialEq)]
pub struct Terms {
    /// Of the six equations.
    pub residual: [f64; EQUATIONS],
    /// By the unknown, then the equation.
    pub tangent: [[f64; EQUATIONS]; UNKNOWNS],
}

impl Facing {
    /// The terms of a column, at places of the surface nodes and values of the other local unknowns.
    pub fn terms(&self, at: &[f64; UNKNOWNS]) -> Terms {
        let mut terms = Terms { residual: [0.0; EQUATIONS], tangent: [[0.0; EQUATIONS]; UNKNOWNS] };
        let group = |first: usize| -> [f64; 3] { std::array::from_fn(|a| at[first + a]) };
        let (upper, lower, mean, rise) = (group(UPPER), group(LOWER), group(MEAN), group(RISE));
        let count = if self.counts { 1.0 } else { 0.0 };
        let apart: [f64; 3] = std::array::from_fn(|a| count * (upper[a] - lower[a]));

        // int p (ξ v)' ds, with the pressure's derivatives with respect to these unknowns.
        let mut move_pressure = |s: f64, value: f64, by: &[(usize, f64)]| {
            let (shape, slope) = (quadratic(s), quadratic_derivative(s));
            let (here, change) = (dot(&shape, &apart), dot(&slope, &apart));
            for a in 0..3 {
                let moved = shape[a] * change + slope[a] * here;
                terms.residual[a] += value * moved;
                for (unknown, by) in by {
                    terms.tangent[*unknown][a] += by * moved;
                }
                for b in 0..3 {
                    let by_distance = count * value * (shape[a] * slope[b] + slope[a] * shape[b]);
                    terms.tangent[UPPER + b][a] += by_distance;
                    terms.tangent[LOWER + b][a] -= by_distance;
                }
            }
        };
        for (s, w) in GAUSS.into_iter().zip(GAUSS_WEIGHTS) {
            let shape = pressure(self.pressure_order, s);
            let by = [0, 1, 2].map(|b| (PRESSURE + b, w * shape[b]));
            move_pressure(s, w * dot(&shape, &group(PRESSURE)), &by);
        }
        for (a, simpson) in SIMPSON.into_iter().enumerate() {
            let (solid, by_gap) = self.law.pressure(at[GAP + a]);
            move_pressure(a as f64 - 1.0, 2.0 * simpson * solid, &[(GAP + a, 2.0 * simpson * by_gap)]);
        }

        let height: [f64; 3] = std::array::from_fn(|a| self.height[a] + mean[a]);
        for (a, simpson) in SIMPSON.into_iter().enumerate() {
            let slope = quadratic_derivative(a as f64 - 1.0);
            let weight = 2.0 * simpson * self.scale[a];
            let (along, up) = (0.5 * (dot(&slope, &upper) + dot(&slope, &lower)), dot(&slope, &height));
            let vertical = rise[a] / self.cosine[a];
            let row = 3 + a;
            terms.residual[row] += weight * (vertical * along - apart[a] * up);
            terms.tangent[RISE + a][row] += weight * along / self.cosine[a];
            terms.tangent[UPPER + a][row] -= count * weight * up;
            terms.tangent[LOWER + a][row] += count * weight * up;
            for (b, slope) in slope.into_iter().enumerate() {
                terms.tangent[UPPER + b][row] += weight * 0.5 * vertical * slope;
                terms.tangent[LOWER + b][row] += weight * 0.5 * vertical * slope;
                terms.tangent[MEAN + b][row] -= weight * apart[a] * slope;
            }
        }
        terms
    }
}

fn dot(f: &[f64; 3], values: &[f64; 3]) -> f64 {
    f[0] * values[0] + f[1] * values[1] + f[2] * values[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::roughness::ROUGH;
    use proptest::prelude::*;

    fn facing(height: [f64; 3], cosine: [f64; 3], pressure_order: i32) -> Facing {
        Facing { height, cosine, scale: [3e9; 3], pressure_order, law: ContactLaw::Rough(ROUGH), counts: true }
    }

    proptest! {
        /// Taylor test by central differences.
        #[test]
        fn tangent_is_the_derivative_of_the_residual(
            seed in prop::collection::vec(-1.0..1.0f64, UNKNOWNS), direction in prop::collection::vec(-1.0..1.0f64, UNKNOWNS),
            order in 1..3_i32,
        ) {
            let facing = facing([0.0, 2e-5, 9e-5], [1.0, 0.97, 0.9], order);
            let scale = [2e-5, 2e-5, 1e-5, 1e-5, 2e5, ROUGH.rms];
            let at = |s: f64| -> [f64; UNKNOWNS] {
                std::array::from_fn(|i| {
                    let place = if i < MEAN { 3e-4 * (i % 3) as f64 } else { 0.0 };
                    place + scale[i / 3] * (seed[i] + s * direction[i])
                })
            };
            prop_assume!((0..3).all(|a| seed[GAP + a].abs() > 1e-2));
            let terms = facing.terms(&at(0.0));
            let [plus, minus] = [1e-5, -1e-5].map(|s| facing.terms(&at(s)).residual);
            let linear: [f64; EQUATIONS] = std::array::from_fn(|row| {
                (0..UNKNOWNS).map(|i| terms.tangent[i][row] * direction[i] * scale[i / 3]).sum()
            });
            for rows in [0..3, 3..6] {
                let size = rows.clone().fold(0.0, |size: f64, row| size.max(linear[row].abs()));
                for row in rows {
                    prop_assert!(((plus[row] - minus[row]) / 2e-5 - linear[row]).abs() < 1e-6 * size, "{}", row);
                }
            }
        }

        /// Two surfaces on one parabola, whose nodes were pulled apart along it, touch: the vertical distance of the nodes is all rise.
        /// And what moves the pressures along has no resultant but a moment, half of p ξ' x + p ξ.
        #[test]
        fn points_of_one_curve_have_no_gap(apart in -1e-4..1e-4f64, middle in -2e-3..2e-3f64, pressure in -1e6..1e6f64) {
            let (radius, half) = (0.03, 2e-4);
            let height = |x: f64| 0.5 * x * x / radius;
            let x = [-half, 0.0, half].map(|s| middle + s);
            let [upper, lower] = [0.5, -0.5].map(|side| x.map(|x| x + side * apart));
            let mean: [f64; 3] = std::array::from_fn(|a| 0.5 * (height(upper[a]) + height(lower[a])));
            let rise: [f64; 3] = std::array::from_fn(|a| height(upper[a]) - height(lower[a]));
            let at: Vec<f64> = [upper, lower, [0.0; 3], rise, [pressure; 3], [1.0; 3]].concat();
            let terms = facing(mean, [1.0; 3], 2).terms(&at.try_into().unwrap());
            for a in 0..3 {
                prop_assert!(terms.residual[3 + a].abs() <= 1e-9 * 3e9 * half * (apart.abs() + 1e-8), "{:?}", terms.residual);
            }
            // Differences of places are known to the last digits of these.
            let size = pressure.abs() * (apart.abs() + 1e-6);
            let force: f64 = terms.residual[..3].iter().sum();
            prop_assert!(force.abs() <= 1e-11 * size);
            let moment: f64 = (0..3).map(|a| terms.residual[a] * x[a]).sum();
            // int p (ξ x)' ds over the column, with a constant ξ.
            prop_assert!((moment - pressure * apart * 2.0 * half).abs() <= 1e-9 * size * half, "{}", moment);
        }
    }
}
