//! Contact of the surfaces: how much they press on each other at every station, and the friction that goes with it.
//!
//! There is one interface over two kinds of law, [`ContactLaw`]. The contact pressure at a station is the sum of what follows from the
//! gap h and of a multiplier,
//!
//! p_c = p_a(h) + lambda
//!
//! Rough surfaces have the asperities' pressure p_a(h) and no multiplier. Smooth ones have p_a = 0 and complementarity,
//! lambda >= 0, h >= 0, lambda h = 0: a station is active where they touch, lambda is what its balance of forces then misses, and the
//! condition h = 0 stands in for that balance.
//!
//! What follows from the gap is part of the elements of the surface,
//!
//! int p_a(h) n . v da + int tau t . v da,   tau = mu [p_a + phi A p]
//!
//! with the fraction A of real contact and the boundary friction mu by the speeds of both surfaces there, see [`Rubbing`]; integrated at the nodes
//! (Simpson's rule), so that there is one condition a node. The normal is that of the deformed surface, and tau acts along x. The multiplier
//! of an active station rubs with tau = mu lambda.

use num_dual::Dual64;

use crate::equations::film;
use crate::equations::tissue::{LOCAL, Local};
use crate::fem::element::{NODES, SIMPSON, pressure, quadratic_derivative};
use crate::fem::mesh::LayerMesh;
use crate::laws::contact::is_active;
use crate::laws::roughness::Roughness;

/// How gap and pressure of the solids go together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ContactLaw {
    /// Complementarity, by the primal-dual active set.
    Smooth {
        /// Weight of gaps against contact pressures \[Pa/m\].
        stiffness: f64,
        /// Modulus of the tissue \[Pa\].
        modulus: f64,
    },
    /// The asperities' pressure.
    Rough(Roughness),
}

impl ContactLaw {
    /// Whether pressure follows from the gap; else all of it is in the multipliers.
    pub fn follows_from_gap(&self) -> bool {
        match self {
            Self::Smooth { .. } => false,
            Self::Rough(_) => true,
        }
    }

    /// Whether it is the same law, with whatever parameters.
    pub fn same_kind(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }

    /// Pressure that follows from the gap, and its derivative.
    pub fn pressure(&self, gap: f64) -> (f64, f64) {
        match self {
            Self::Smooth { .. } => (0.0, 0.0),
            Self::Rough(roughness) => roughness.pressure(gap),
        }
    }

    /// Fraction of real contact that follows from the gap, and its derivative.
    pub fn real_contact_fraction(&self, gap: f64) -> (f64, f64) {
        match self {
            Self::Smooth { .. } => (0.0, 0.0),
            Self::Rough(roughness) => roughness.real_contact_fraction(gap),
        }
    }

    /// Whether a station is active, from its multiplier (0 where it was not) and its gap. One whose multiplier and gap are both
    /// round-off keeps its status.
    pub fn is_active(&self, active: bool, multiplier: f64, gap: f64) -> bool {
        match *self {
            Self::Smooth { stiffness, modulus } => {
                let hysteresis = 1e-11 * modulus * if active { 1.0 } else { -1.0 };
                is_active(multiplier + hysteresis, gap, stiffness)
            }
            Self::Rough(_) => false,
        }
    }

    /// The condition of an active station, and its derivative with respect to the gap.
    pub fn condition(&self, gap: f64) -> (f64, f64) {
        match *self {
            Self::Smooth { modulus, .. } => (modulus * gap, modulus),
            // None is active.
            Self::Rough(_) => (0.0, 0.0),
        }
    }

    /// Whether the solids count as touching where a station is active or not, at this gap.
    pub fn touches(&self, active: bool, gap: f64) -> bool {
        match self {
            Self::Smooth { .. } => active,
            Self::Rough(roughness) => gap < roughness.mixed_film(),
        }
    }

    /// Where contact ends between two stations, as a fraction of the way from one that touches to one that does not: where a line
    /// through both is zero.
    pub fn edge(&self, [inside, outside]: [Dual64; 2], pressure_inside: Dual64) -> Dual64 {
        match self {
            Self::Smooth { stiffness, .. } => pressure_inside / (pressure_inside + outside * *stiffness),
            Self::Rough(roughness) => (inside - roughness.mixed_film()) / (inside - outside),
        }
    }

    /// Distance of the surfaces, from the gap of the solution: mean planes of rough surfaces may overlap. Smooth surfaces do not; what
    /// is below zero there is round-off, or comes of interpolation between stations in contact.
    pub fn distance(&self, gap: Dual64) -> Dual64 {
        match self {
            Self::Smooth { .. } if gap.re > 0.0 => gap,
            Self::Smooth { .. } => Dual64::from(0.0),
            Self::Rough(_) => gap,
        }
    }

    /// How far a film of this gap may close and open within one update, as factors of the gap: its conductance goes with the cube of
    /// it, so that a tangent says nothing about larger changes. Where smooth surfaces touch, the active set takes over what rough ones
    /// have to find in smaller steps.
    pub fn film_limits(&self) -> [f64; 2] {
        match self {
            Self::Smooth { .. } => [0.1, 3.0],
            Self::Rough(_) => [0.4, 2.0],
        }
    }

    /// The gap at which they press this hard.
    pub fn gap_at(&self, pressure: f64) -> f64 {
        match self {
            Self::Smooth { .. } => 0.0,
            Self::Rough(roughness) => roughness.gap_at(pressure),
        }
    }

    /// The least gap that an update from `before` to `wanted` may lead to. Rough surfaces close to where they press as the tangent says,
    /// or to the gap `free`: their pressure rises exponentially, and their distance by the tangent would be far too small.
    pub fn least_gap(&self, before: f64, wanted: f64, free: f64) -> f64 {
        match self {
            Self::Rough(roughness) if wanted < before.min(free) => {
                let (pressure, slope) = roughness.pressure(before);
                roughness.gap_at(pressure + slope * (wanted - before)).min(before).min(free)
            }
            _ => f64::NEG_INFINITY,
        }
    }
}

/// How the surfaces move in a column, and the friction that goes with it; see `equations::system::rubbing`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rubbing {
    /// Friction traction on the upper body per unit of pressure, positive along -x.
    pub friction: f64,
    /// Its derivatives with respect to the speeds v of the upper and of the lower surface \[s/m\].
    pub by_walls: [f64; 2],
    /// Speeds of the undeformed surfaces past the mesh \[m/s\].
    pub relative: [f64; 2],
    /// By what factors the surfaces are stretched there: derivatives of their speeds v by those of the undeformed ones.
    pub stretches: [f64; 2],
    /// Speeds of the nodes along the arc \[m/s\].
    pub nodes: [f64; 2],
    /// Their derivatives with respect to their mean displacement along x \[1/s\].
    pub node_rates: [f64; 2],
    /// Derivatives of each surface's speed v by its displacements along x at the three nodes \[1/s\].
    pub by_sideways: [[f64; 3]; 2],
}

impl Rubbing {
    /// Difference of the speeds v \[m/s\].
    pub fn slip(&self) -> f64 {
        let wall = |k: usize| self.stretches[k] * self.relative[k] + self.nodes[k];
        wall(0) - wall(1)
    }

    /// Change of the friction along a change of what the film takes from the unknowns, of the speeds of the undeformed surfaces, and, beside that, of
    /// those of the nodes.
    pub fn friction_along(&self, change: &film::Local, speeds: [f64; 2], nodes: [f64; 2]) -> f64 {
        let wall = |k: usize| {
            let sideways = &change[film::SIDEWAYS + 3 * k..][..3];
            let moved: f64 = self.by_sideways[k].iter().zip(sideways).map(|(by, change)| by * change).sum();
            moved + self.stretches[k] * speeds[k] + nodes[k]
        };
        self.by_walls[0] * wall(0) + self.by_walls[1] * wall(1)
    }
}

/// Contact in a column, with its friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// How gap and pressure go together.
    pub law: ContactLaw,
    /// What rubs.
    pub rubbing: Rubbing,
    /// Fraction phi of the fluid's pressure in real contact that friction feels.
    pub solid_fraction: f64,
}

/// Derivatives of the residual of an element.
pub struct ContactTangent<'a> {
    /// With respect to the local unknowns.
    pub by_unknowns: &'a mut [f64; LOCAL * LOCAL],
    /// With respect to the gaps at the three nodes.
    pub by_gap: &'a mut [Local; 3],
    /// With respect to the displacements along x of the other body's three nodes.
    pub by_other: &'a mut [Local; 3],
}

/// Where the terms of an element go.
#[derive(Default)]
pub struct ContactTerms<'a> {
    /// Added to: the residual.
    pub residual: Option<&'a mut Local>,
    /// Added to: its derivative with respect to the friction traction per unit of pressure.
    pub by_friction: Option<&'a mut Local>,
    /// Added to: its derivatives.
    pub tangent: Option<ContactTangent<'a>>,
}

impl Contact {
    /// Adds what follows from the gaps to an element of the first row. `side` is 1 for the upper body and -1 for the lower one.
    pub fn element(
        &self,
        mesh: &LayerMesh,
        element: usize,
        side: f64,
        at: &Local,
        gaps: [f64; 3],
        mut terms: ContactTerms<'_>,
    ) {
        if !self.law.follows_from_gap() {
            return;
        }
        let (nodes, rubbing) = (mesh.element_nodes(element), &self.rubbing);
        for (a, gap) in gaps.into_iter().enumerate() {
            let (s, weight) = (a as f64 - 1.0, 2.0 * SIMPSON[a]);
            let slope = quadratic_derivative(s);
            let along =
                |k: usize| -> f64 { (0..3).map(|b| slope[b] * (mesh.nodes[nodes[b]][k] + at[k * NODES + b])).sum() };
            let (x, y) = (along(0), along(1));
            let shape = pressure(mesh.pressure_order, s);
            let fluid: f64 = (0..3).map(|b| shape[b] * at[2 * NODES + b]).sum();
            let (solid, solid_slope) = self.law.pressure(gap);
            let (real, real_slope) = self.law.real_contact_fraction(gap);
            let (push, push_slope) = (weight * solid, weight * solid_slope);
            let rubs = side * weight * (solid + self.solid_fraction * real * fluid);
            let drag = rubbing.friction * rubs;
            if let Some(residual) = &mut terms.residual {
                residual[a] += push * side * y + drag * x;
                residual[NODES + a] += drag * y - push * side * x;
            }
            if let Some(by_friction) = &mut terms.by_friction {
                by_friction[a] += rubs * x;
                by_friction[NODES + a] += rubs * y;
            }
            if let Some(ContactTangent { by_unknowns: tangent, by_gap, by_other }) = &mut terms.tangent {
                for b in 0..3 {
                    let turn = push * side * slope[b];
                    tangent[(NODES + b) * LOCAL + a] += turn;
                    tangent[b * LOCAL + NODES + a] -= turn;
                    tangent[b * LOCAL + a] += drag * slope[b];
                    tangent[(NODES + b) * LOCAL + NODES + a] += drag * slope[b];
                    let drag_by_fluid = rubbing.friction * side * weight * self.solid_fraction * real * shape[b];
                    tangent[(2 * NODES + b) * LOCAL + a] += drag_by_fluid * x;
                    tangent[(2 * NODES + b) * LOCAL + NODES + a] += drag_by_fluid * y;
                    let drag_by = |k: usize| rubs * rubbing.by_walls[k] * rubbing.by_sideways[k][b];
                    let (own, other) = if side > 0.0 { (drag_by(0), drag_by(1)) } else { (drag_by(1), drag_by(0)) };
                    tangent[b * LOCAL + a] += own * x;
                    tangent[b * LOCAL + NODES + a] += own * y;
                    by_other[b][a] += other * x;
                    by_other[b][NODES + a] += other * y;
                }
                let drag_slope =
                    rubbing.friction * side * weight * (solid_slope + self.solid_fraction * real_slope * fluid);
                by_gap[a][a] += push_slope * side * y + drag_slope * x;
                by_gap[a][NODES + a] += drag_slope * y - push_slope * side * x;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::mesh::{graded, quadratic_stations};
    use crate::laws::roughness::ROUGH;
    use proptest::prelude::*;

    /// Rough surfaces touch up to where a gap on a line is 3 times the roughness. Between smooth ones the pressure falls on a line to zero,
    /// from where the gap times the stiffness goes on along the same line.
    #[test]
    fn contact_ends_where_a_line_through_both_stations_does() {
        let (rough, smooth) = (ContactLaw::Rough(ROUGH), ContactLaw::Smooth { stiffness: 1e9, modulus: 1e6 });
        let edge =
            |law: ContactLaw, gaps: [f64; 2], pressure: f64| law.edge(gaps.map(Dual64::from), pressure.into()).re;
        for fraction in [0.1, 0.5, 0.8] {
            let line = |x: f64| (3.0 + (x - fraction) * 4.0) * ROUGH.rms;
            assert!(rough.touches(false, line(fraction - 1e-3)) && !rough.touches(false, line(fraction + 1e-3)));
            assert!((edge(rough, [line(0.0), line(1.0)], 0.0) - fraction).abs() < 1e-12);
            assert!((edge(smooth, [0.0, (1.0 - fraction) * 1e-6], fraction * 1e3) - fraction).abs() < 1e-12);
        }
        assert!(smooth.touches(true, 1e-20) && !smooth.touches(false, -1e-20));
        let overlap = Dual64::new(-1e-7, 1.0);
        assert_eq!((rough.distance(overlap), smooth.distance(overlap)), (overlap, Dual64::from(0.0)));
    }

    proptest! {
        /// Taylor test by central differences, along a direction of displacements of both bodies, pressures and gaps.
        #[test]
        fn tangent_is_the_derivative_of_the_residual(
            seed in prop::collection::vec(-1.0..1.0f64, 31), direction in prop::collection::vec(-1.0..1.0f64, 29),
            gaps in prop::array::uniform3(-1.0..3.0f64), opening in prop::array::uniform3(-1.0..1.0f64),
            other in prop::array::uniform3(-1.0..1.0f64), upper: bool, order in 1..3_i32,
        ) {
            prop_assume!(gaps.iter().all(|gap| gap.abs() > 1e-2));
            let side = if upper { 1.0 } else { -1.0 };
            let stations = quadratic_stations(3, |i| 2e-3 * graded(i as f64 / 1.5 - 1.0, 1.0));
            let mesh = LayerMesh::sector(&stations, &quadratic_stations(2, |j| 0.5e-3 * j as f64), 0.1, side, order);
            let scale = |i: usize| if i < 2 * NODES { 2e-5 } else { 2e5 };
            let residual = |s: f64, friction: f64| {
                let at: Local = std::array::from_fn(|i| (seed[i % 31] + s * direction[i % 29]) * scale(i));
                let gaps = std::array::from_fn(|a| ROUGH.rms * (gaps[a] + s * opening[a]));
                // Friction by the difference of two speeds that go with the displacements along x.
                let by_sideways: [[f64; 3]; 2] = [[2e3, -5e3, 4e3], [-1e3, 3e3, 2e3]];
                let own: [f64; 3] = std::array::from_fn(|b| at[b]);
                let others = other.map(|change| s * change * scale(0));
                let [first, second] = if upper { [own, others] } else { [others, own] };
                let slip: f64 = (0..3).map(|b| by_sideways[0][b] * first[b] - by_sideways[1][b] * second[b]).sum();
                let rubbing = Rubbing { friction: friction + 0.1 * slip, by_walls: [0.1, -0.1], by_sideways, ..Rubbing::default() };
                let (mut residual, mut by_friction) = ([0.0; LOCAL], [0.0; LOCAL]);
                let (mut tangent, mut by_gap, mut by_other) = ([0.0; LOCAL * LOCAL], [[0.0; LOCAL]; 3], [[0.0; LOCAL]; 3]);
                let terms = ContactTangent { by_unknowns: &mut tangent, by_gap: &mut by_gap, by_other: &mut by_other };
                let terms = ContactTerms {
                    residual: Some(&mut residual), by_friction: Some(&mut by_friction), tangent: Some(terms),
                };
                let contact = Contact { law: ContactLaw::Rough(ROUGH), rubbing, solid_fraction: 0.1 };
                contact.element(&mesh, 2, side, &at, gaps, terms);
                (residual, by_friction, tangent, by_gap, by_other)
            };
            let (_, by_friction, tangent, by_gap, by_other) = residual(0.0, 0.3);
            let (plus, minus) = (residual(1e-5, 0.3).0, residual(-1e-5, 0.3).0);
            let (more, less) = (residual(0.0, 0.4).0, residual(0.0, 0.2).0);
            let linear: Local = std::array::from_fn(|i| {
                let unknowns = (0..LOCAL).map(|j| tangent[j * LOCAL + i] * direction[j % 29] * scale(j)).sum::<f64>();
                let others = (0..3).map(|b| by_other[b][i] * other[b] * scale(0)).sum::<f64>();
                unknowns + others + (0..3).map(|a| by_gap[a][i] * ROUGH.rms * opening[a]).sum::<f64>()
            });
            let size = linear.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            for i in 0..LOCAL {
                prop_assert!(((plus[i] - minus[i]) / 2e-5 - linear[i]).abs() < 1e-6 * size, "{}", i);
                prop_assert!(((more[i] - less[i]) / 0.2 - by_friction[i]).abs() < 1e-9 * size, "{}", i);
            }
        }
    }
}
