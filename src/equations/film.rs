//! The film between the bodies, on one element of the interface.
//!
//! One equation serves both faces; the fluxes out of the two bodies cancel, because bodies and film share the pressure and its
//! test function w (divided by the density at ambient pressure, r = exp(chi p)):
//!
//! int -r Q w' + d(r h)/dt w dx,   Q = -h^3/(12 eta) p' + U h/2
//!
//! Where h = 0 nothing is left of it, and the fluid crosses from body to body: the paper's periodic condition.
//!
//! A film that may tear (cavitation) holds r (h - c), where c of the gap is void, and of what the walls carry the share c/h is
//! void, with c/h from upstream. Where the tissue takes up more than the film holds, void enters its pores: c is then larger than h,
//! and the rest moves with the walls. Pressure and w are then straight lines from node to node and the film is stored at the nodes: with
//! curved ones a node beside the void could neither be full nor torn.

use crate::fem::element::{GAUSS, GAUSS_WEIGHTS, pressure, pressure_derivative, quadratic};
use crate::laws::film::reynolds_flux;

/// Gaps, pressures and thicknesses of void at the three nodes of an interface element.
pub type Local = [f64; 9];

/// The lubricant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Film {
    /// Dynamic viscosity [Pa s].
    pub viscosity: f64,
    /// Compressibility chi [1/Pa].
    pub fluid_compressibility: f64,
    /// Order of the pressure's shape functions.
    pub pressure_order: i32,
    /// Whether the film may tear.
    pub tears: bool,
}

/// How fast the film's mass changes: d(r h)/dt = rate * r h + history; steady is zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MassRate {
    /// Factor of r h [1/s].
    pub rate: f64,
    /// The rest of the difference formula, at each point of storage [m/s].
    pub history: [f64; 3],
}

/// Residual of the three pressure equations with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Terms {
    /// Residual [m^2/s].
    pub residual: [f64; 3],
    /// By gaps, pressures and thicknesses of void.
    pub tangent: [[f64; 9]; 3],
    /// By the sliding speed.
    pub by_speed: [f64; 3],
}

/// Where fluid is stored: shape functions of gap, pressure and void, test functions, and the share of the element's length.
struct Store {
    gap: [f64; 3],
    pressure: [f64; 3],
    void: [f64; 3],
    share: f64,
}

/// Where fluid flows: shape functions of gap and pressure, the node from which void is carried, and derivatives of the pressure's
/// shape functions, which are the test functions too, by the place in the element as a share of its length.
struct Flow {
    gap: [f64; 3],
    pressure: [f64; 3],
    slope: [f64; 3],
    upstream: Option<usize>,
    share: f64,
}

/// Thickness of void that is carried through a gap, with its derivatives.
#[derive(Default)]
struct Void {
    value: f64,
    by_gap: f64,
    by_upstream_gap: f64,
    by_upstream_void: f64,
}

/// In a film thinner than this the share of void is reckoned as if it were this thick [m]: where contact opens there is no share yet.
/// It is far below the roughness of cartilage.
const THINNEST: f64 = 1e-8;

impl Void {
    /// From upstream, where this much of that gap is void: the same share of the present gap, and what is in the pores.
    fn carried(gap: f64, upstream_gap: f64, upstream_void: f64) -> Self {
        let (room, by_gap) = if upstream_gap > THINNEST { (upstream_gap, 1.0) } else { (THINNEST, 0.0) };
        if upstream_void > room {
            let value = gap + upstream_void - room;
            return Self { value, by_gap: 1.0, by_upstream_gap: -by_gap, by_upstream_void: 1.0 };
        }
        let share = upstream_void / room;
        let by_upstream_void = gap / room;
        Self {
            value: share * gap,
            by_gap: share,
            by_upstream_gap: -share * by_upstream_void * by_gap,
            by_upstream_void,
        }
    }
}

fn sum(shape: &[f64; 3], values: &[f64]) -> f64 {
    shape[0] * values[0] + shape[1] * values[1] + shape[2] * values[2]
}

impl Film {
    /// The Gauss points; of a film that may tear the nodes.
    fn stores(&self) -> [Store; 3] {
        let unit = |a: usize| std::array::from_fn(|b| if a == b { 1.0 } else { 0.0 });
        std::array::from_fn(|q| match (self.tears, self.pressure_order) {
            (true, order) => {
                let share = if order == 2 { [0.25, 0.5, 0.25][q] } else { [0.5, 0.0, 0.5][q] };
                Store { gap: unit(q), pressure: unit(q), void: unit(q), share }
            }
            (false, order) => Store {
                gap: quadratic(GAUSS[q]),
                pressure: pressure(order, GAUSS[q]),
                void: [0.0; 3],
                share: 0.5 * GAUSS_WEIGHTS[q],
            },
        })
    }

    /// The Gauss points; of a film that may tear those between two nodes, one pair of nodes after the other.
    fn flows(&self, sliding_speed: f64) -> impl Iterator<Item = Flow> {
        let Self { tears, pressure_order, .. } = *self;
        let pairs: &[[usize; 2]] = match (tears, pressure_order) {
            (false, _) => &[[0, 0]],
            (true, 2) => &[[0, 1], [1, 2]],
            (true, _) => &[[0, 2]],
        };
        pairs.iter().flat_map(move |pair| {
            GAUSS.into_iter().zip(GAUSS_WEIGHTS).map(move |(s, w)| {
                if !tears {
                    let slope = pressure_derivative(pressure_order, s).map(|d| 2.0 * d);
                    let pressure = pressure(pressure_order, s);
                    return Flow { gap: quadratic(s), pressure, slope, upstream: None, share: 0.5 * w };
                }
                let [from, to] = *pair;
                let length = 0.5 * (to - from) as f64;
                let (mut pressure, mut slope) = ([0.0; 3], [0.0; 3]);
                (pressure[from], pressure[to]) = (0.5 * (1.0 - s), 0.5 * (1.0 + s));
                (slope[from], slope[to]) = (-1.0 / length, 1.0 / length);
                let upstream = Some(if sliding_speed < 0.0 { to } else { from });
                let place = from as f64 - 1.0 + length * (1.0 + s);
                Flow { gap: quadratic(place), pressure, slope, upstream, share: 0.5 * w * length }
            })
        })
    }

    /// Fluid r (h - c) where it is stored [m]: at the quadrature points, or at the nodes where the film may tear. Beside a node in
    /// contact an interpolated gap may be a little below zero; it counts as it is, so that what is stored is linear in the gaps of
    /// the nodes, and has no kink where they close.
    pub fn mass(&self, at: &Local) -> [f64; 3] {
        self.stores().map(|store| {
            let density = (self.fluid_compressibility * sum(&store.pressure, &at[3..])).exp();
            density * (sum(&store.gap, at) - sum(&store.void, &at[6..]))
        })
    }

    /// How [`Film::mass`] changes with gaps, pressures and void.
    pub fn mass_change(&self, at: &Local, change: &Local) -> [f64; 3] {
        self.stores().map(|store| {
            let fluid = |values: &Local| sum(&store.gap, values) - sum(&store.void, &values[6..]);
            let density = (self.fluid_compressibility * sum(&store.pressure, &at[3..])).exp();
            let denser = self.fluid_compressibility * sum(&store.pressure, &change[3..]);
            density * (fluid(change) + fluid(at) * denser)
        })
    }

    /// Residual of the three pressure equations for d(r h)/dt alone, given where fluid is stored [m/s].
    pub fn storage(&self, length: f64, rate: &[f64; 3]) -> [f64; 3] {
        let mut residual = [0.0; 3];
        for (store, rate) in self.stores().into_iter().zip(rate) {
            for (r, value) in residual.iter_mut().zip(store.pressure) {
                *r += length * store.share * rate * value;
            }
        }
        residual
    }

    /// The terms of an element of this length [m].
    pub fn element(&self, length: f64, at: &Local, sliding_speed: f64, mass_rate: &MassRate) -> Terms {
        let mut terms = Terms::default();
        let chi = self.fluid_compressibility;
        for (store, history) in self.stores().into_iter().zip(mass_rate.history) {
            if mass_rate.rate == 0.0 && history == 0.0 {
                continue;
            }
            let fluid = sum(&store.gap, at) - sum(&store.void, &at[6..]);
            let factor = length * store.share * mass_rate.rate * (chi * sum(&store.pressure, &at[3..])).exp();
            for a in 0..3 {
                let value = store.pressure[a];
                terms.residual[a] += (factor * fluid + length * store.share * history) * value;
                for b in 0..3 {
                    terms.tangent[a][b] += factor * store.gap[b] * value;
                    terms.tangent[a][3 + b] += factor * fluid * chi * store.pressure[b] * value;
                    terms.tangent[a][6 + b] -= factor * store.void[b] * value;
                }
            }
        }
        for flow in self.flows(sliding_speed) {
            let gap = sum(&flow.gap, at);
            let slope = flow.slope.map(|d| d / length);
            let density = (chi * sum(&flow.pressure, &at[3..])).exp();
            let flux = reynolds_flux(gap, sum(&slope, &at[3..]), sliding_speed, self.viscosity);
            let void = flow.upstream.map_or(Void::default(), |up| Void::carried(gap.max(0.0), at[up], at[6 + up]));
            let value = flux.value - 0.5 * sliding_speed * void.value;
            let by_gap = flux.by_film_thickness - if gap > 0.0 { 0.5 * sliding_speed * void.by_gap } else { 0.0 };
            let weight = length * flow.share * density;
            for a in 0..3 {
                let weight = -weight * slope[a];
                terms.residual[a] += weight * value;
                terms.by_speed[a] += weight * (flux.by_sliding_speed - 0.5 * void.value);
                for (b, slope) in slope.into_iter().enumerate() {
                    terms.tangent[a][b] += weight * by_gap * flow.gap[b];
                    terms.tangent[a][3 + b] +=
                        weight * (flux.by_pressure_gradient * slope + value * chi * flow.pressure[b]);
                }
                if let Some(up) = flow.upstream {
                    terms.tangent[a][up] -= weight * 0.5 * sliding_speed * void.by_upstream_gap;
                    terms.tangent[a][6 + up] -= weight * 0.5 * sliding_speed * void.by_upstream_void;
                }
            }
        }
        terms
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn tangent_is_the_derivative_of_the_residual(
            gaps in prop::array::uniform3(0.5..2.0f64), pressures in prop::array::uniform3(-1.0..1.0f64),
            voids in prop::array::uniform3(0.0..0.5f64), direction in prop::array::uniform9(-1.0..1.0f64), order in 1..3_i32,
            tears: bool, speed in -1.0..1.0f64,
        ) {
            let film = Film { viscosity: 1e-3, fluid_compressibility: 1e-7, pressure_order: order, tears };
            let scaled = |v: [f64; 9]| -> Local { std::array::from_fn(|i| v[i] * [1e-6, 1e5, 1e-6][i / 3]) };
            let at = scaled(std::array::from_fn(|i| [gaps, pressures, voids][i / 3][i % 3]));
            let change = scaled(direction);
            let moved = |s: f64| -> Local { std::array::from_fn(|i| at[i] + s * change[i]) };
            let rate = MassRate { rate: 5.0, history: [1e-6, -2e-6, 3e-6] };
            let residual = |s: f64, u: f64| film.element(1e-4, &moved(s), u, &rate).residual;
            let terms = film.element(1e-4, &at, speed, &rate);
            let (plus, minus) = (residual(1e-5, speed), residual(-1e-5, speed));
            let linear: [f64; 3] = std::array::from_fn(|a| (0..9).map(|b| terms.tangent[a][b] * change[b]).sum());
            let size = linear.iter().fold(1e-12, |m: f64, v| m.max(v.abs()));
            let faster = 2.0 * speed;
            for a in 0..3 {
                prop_assert!(((plus[a] - minus[a]) / 2e-5 - linear[a]).abs() < 1e-7 * size);
                let by_speed = (residual(0.0, faster)[a] - terms.residual[a]) / speed;
                prop_assert!((by_speed - terms.by_speed[a]).abs() < 1e-9 * terms.by_speed[a].abs() + 1e-20 / speed.abs());
            }
            // What flows is not lost, and what is stored is the mass.
            let none = MassRate::default();
            prop_assert!(film.element(1e-4, &at, speed, &none).residual.iter().sum::<f64>().abs() < 1e-20);
            let (mass, stored) = (film.mass(&at), film.storage(1e-4, &[1.0; 3]));
            prop_assert!((stored.iter().sum::<f64>() - 1e-4).abs() < 1e-16);
            let slope = film.mass_change(&at, &change);
            let (plus, minus) = (film.mass(&moved(1e-5)), film.mass(&moved(-1e-5)));
            for q in 0..3 {
                prop_assert!(((plus[q] - minus[q]) / 2e-5 - slope[q]).abs() < 1e-7 * (mass[q].abs() + slope[q].abs()));
            }
        }

        #[test]
        fn a_film_without_void_is_the_same_to_the_order_of_its_elements(
            slope in -0.2..0.2f64, gradient in -1.0..1.0f64, order in 1..3_i32, speed in -1.0..1.0f64,
        ) {
            // Of straight gaps and pressures both are exact.
            let film = Film { viscosity: 1e-3, fluid_compressibility: 0.0, pressure_order: order, tears: false };
            let line = |middle: f64, rise: f64| [middle - rise, middle, middle + rise];
            let (gaps, pressures) = (line(1e-6, 1e-6 * slope), line(1e3, 1e5 * gradient));
            let at: Local = std::array::from_fn(|i| [gaps, pressures, [0.0; 3]][i / 3][i % 3]);
            let [whole, tearing] =
                [film, Film { tears: true, ..film }].map(|f| f.element(1e-4, &at, speed, &MassRate::default()).residual);
            prop_assert!((whole[0] + 0.5 * whole[1] - tearing[0] - 0.5 * tearing[1]).abs() < 1e-9 * whole[0].abs() + 1e-20);
        }
    }
}
