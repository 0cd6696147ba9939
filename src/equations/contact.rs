//! Contact of the surfaces.
//!
//! Smooth ones touch node by node: gap and contact pressure are complementary, [`SmoothContact`]. Of rough ones this is what they carry
//! besides the film's pressure, on one element of the interface of one body:
//!
//! int p_a(h) n . v da + int tau t . v da,   tau = mu [p_a + phi A p]
//!
//! with the asperities' pressure p_a, the share A of real contact and the boundary friction mu of both surfaces; integrated at the nodes
//! (Simpson's rule), so that there is one condition a node. The normal is that of the deformed surface, and tau acts along x.

use crate::equations::tissue::{LOCAL, Local};
use crate::fem::element::{NODES, SIMPSON, pressure, quadratic_derivative};
use crate::fem::mesh::LayerMesh;
use crate::laws::contact::is_active;
use crate::laws::roughness::Roughness;

/// Complementarity of gap and contact pressure at a node, by the primal-dual active set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmoothContact {
    /// Weight of gaps against contact pressures \[Pa/m\].
    pub stiffness: f64,
    /// Modulus of the tissue \[Pa\].
    pub modulus: f64,
}

impl SmoothContact {
    /// Whether a node is in contact, from its contact pressure (0 where it was not) and its gap. One whose pressure and gap are both
    /// round-off keeps its status.
    pub fn touches(&self, touched: bool, pressure: f64, gap: f64) -> bool {
        let hysteresis = 1e-11 * self.modulus * if touched { 1.0 } else { -1.0 };
        is_active(pressure + hysteresis, gap, self.stiffness)
    }

    /// The equation of a node in contact, which says that its gap is closed, and its derivative by the gap.
    pub fn closed(&self, gap: f64) -> (f64, f64) {
        (self.modulus * gap, self.modulus)
    }
}

/// Rough surfaces with their friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoughContact {
    /// The surfaces.
    pub roughness: Roughness,
    /// Friction traction on the upper body per unit of pressure, positive along -x.
    pub friction: f64,
    /// Share phi of the fluid's pressure in real contact that friction feels.
    pub solid_fraction: f64,
}

/// Where the terms of an element go.
#[derive(Default)]
pub struct ContactTerms<'a> {
    /// Added to: the residual.
    pub residual: Option<&'a mut Local>,
    /// Added to: its derivative by the friction traction per unit of pressure.
    pub by_friction: Option<&'a mut Local>,
    /// Added to: its derivatives by the local unknowns, and by the gaps at the three nodes.
    pub tangent: Option<(&'a mut [f64; LOCAL * LOCAL], &'a mut [Local; 3])>,
}

impl RoughContact {
    /// Adds the terms of an element of the first row. `side` is 1 for the upper body and -1 for the lower one.
    pub fn element(
        &self,
        mesh: &LayerMesh,
        element: usize,
        side: f64,
        at: &Local,
        gaps: [f64; 3],
        mut terms: ContactTerms<'_>,
    ) {
        let nodes = mesh.element_nodes(element);
        for (a, gap) in gaps.into_iter().enumerate() {
            let (s, weight) = (a as f64 - 1.0, 2.0 * SIMPSON[a]);
            let slope = quadratic_derivative(s);
            let along =
                |k: usize| -> f64 { (0..3).map(|b| slope[b] * (mesh.nodes[nodes[b]][k] + at[k * NODES + b])).sum() };
            let (x, y) = (along(0), along(1));
            let shape = pressure(mesh.pressure_order, s);
            let fluid: f64 = (0..3).map(|b| shape[b] * at[2 * NODES + b]).sum();
            let (solid, solid_slope) = self.roughness.pressure(gap);
            let (share, share_slope) = self.roughness.real_contact_share(gap);
            let (push, push_slope) = (weight * solid, weight * solid_slope);
            let rubbing = side * weight * (solid + self.solid_fraction * share * fluid);
            let drag = self.friction * rubbing;
            if let Some(residual) = &mut terms.residual {
                residual[a] += push * side * y + drag * x;
                residual[NODES + a] -= push * side * x;
            }
            if let Some(by_friction) = &mut terms.by_friction {
                by_friction[a] += rubbing * x;
            }
            if let Some((tangent, by_gap)) = &mut terms.tangent {
                for b in 0..3 {
                    let turn = push * side * slope[b];
                    tangent[(NODES + b) * LOCAL + a] += turn;
                    tangent[b * LOCAL + NODES + a] -= turn;
                    tangent[b * LOCAL + a] += drag * slope[b];
                    tangent[(2 * NODES + b) * LOCAL + a] +=
                        self.friction * side * weight * self.solid_fraction * share * shape[b] * x;
                }
                let drag_slope =
                    self.friction * side * weight * (solid_slope + self.solid_fraction * share_slope * fluid);
                by_gap[a][a] += push_slope * side * y + drag_slope * x;
                by_gap[a][NODES + a] -= push_slope * side * x;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::mesh::{graded, quadratic_stations};
    use crate::laws::roughness::AsperityLaw;
    use proptest::prelude::*;

    proptest! {
        /// Taylor test by central differences, along a direction of displacements, pressures and gaps.
        #[test]
        fn tangent_is_the_derivative_of_the_residual(
            seed in prop::collection::vec(-1.0..1.0f64, 31), direction in prop::collection::vec(-1.0..1.0f64, 29),
            gaps in prop::array::uniform3(-1.0..3.0f64), opening in prop::array::uniform3(-1.0..1.0f64),
            upper: bool, order in 1..3_i32,
        ) {
            prop_assume!(gaps.iter().all(|gap| gap.abs() > 1e-2));
            let side = if upper { 1.0 } else { -1.0 };
            let stations = quadratic_stations(3, |i| 2e-3 * graded(i as f64 / 1.5 - 1.0, 1.0));
            let mesh = LayerMesh::sector(&stations, &quadratic_stations(2, |j| 0.5e-3 * j as f64), 0.1, side, order);
            let roughness = Roughness {
                rms: 1e-6, law: AsperityLaw::Exponential, asperity_pressure: 2e4, asperity_decay: 0.5, core_pressure: 1e6,
                core_decay: 0.2,
            };
            let contact = RoughContact { roughness, friction: 0.3, solid_fraction: 0.1 };
            let scale = |i: usize| if i < 2 * NODES { 2e-5 } else { 2e5 };
            let residual = |s: f64, friction: f64| {
                let at: Local = std::array::from_fn(|i| (seed[i % 31] + s * direction[i % 29]) * scale(i));
                let gaps = std::array::from_fn(|a| 1e-6 * (gaps[a] + s * opening[a]));
                let (mut residual, mut by_friction) = ([0.0; LOCAL], [0.0; LOCAL]);
                let (mut tangent, mut by_gap) = ([0.0; LOCAL * LOCAL], [[0.0; LOCAL]; 3]);
                let terms = ContactTerms {
                    residual: Some(&mut residual), by_friction: Some(&mut by_friction), tangent: Some((&mut tangent, &mut by_gap)),
                };
                RoughContact { friction, ..contact }.element(&mesh, 2, side, &at, gaps, terms);
                (residual, by_friction, tangent, by_gap)
            };
            let (_, by_friction, tangent, by_gap) = residual(0.0, 0.3);
            let (plus, minus) = (residual(1e-5, 0.3).0, residual(-1e-5, 0.3).0);
            let (more, less) = (residual(0.0, 0.4).0, residual(0.0, 0.2).0);
            let linear: Local = std::array::from_fn(|i| {
                let unknowns = (0..LOCAL).map(|j| tangent[j * LOCAL + i] * direction[j % 29] * scale(j)).sum::<f64>();
                unknowns + (0..3).map(|a| by_gap[a][i] * 1e-6 * opening[a]).sum::<f64>()
            });
            let size = linear.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            for i in 0..LOCAL {
                prop_assert!(((plus[i] - minus[i]) / 2e-5 - linear[i]).abs() < 1e-6 * size, "{}", i);
                prop_assert!(((more[i] - less[i]) / 0.2 - by_friction[i]).abs() < 1e-9 * size, "{}", i);
            }
        }
    }
}
