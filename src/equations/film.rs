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
//!
//! Between rough surfaces the film has the thickness, the flow factor phi and the storage of [`Roughness`]. Pressure and w are straight
//! lines from node to node, and Q is one number between two nodes, from Reynolds' equation integrated over that length l:
//!
//! Q = U h_c/2 - (p_2 - p_1) / (12 eta int c dx),   h_c = int c h dx / int c dx,   c = 1/(phi h^3)
//!
//! Where the film is so thin that pressure cannot follow the surfaces from node to node, h_c moves upstream, by Pe/(1 + Pe) of the way
//! to the node there, with the column's Peclet number Pe = 6 eta |U| l^2/(2 pi G h_c^3): the surfaces' answer to a ripple of pressure of
//! that length against the flow it drives. It vanishes with l^2, so that the scheme is of second order where the film is resolved.

use crate::fem::element::{GAUSS, GAUSS_WEIGHTS, SIMPSON, pressure, pressure_derivative, quadratic};
use crate::laws::film::reynolds_flux;
use crate::laws::roughness::Roughness;

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
    /// Roughness of the surfaces, and shear modulus of the tissue [Pa]; none where they are smooth.
    pub rough: Option<(Roughness, f64)>,
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
    /// The Gauss points; of a film that may tear or of rough surfaces the nodes.
    fn stores(&self) -> [Store; 3] {
        let unit = |a: usize| std::array::from_fn(|b| if a == b { 1.0 } else { 0.0 });
        if self.rough.is_some() {
            return std::array::from_fn(|q| match self.pressure_order {
                2 => Store { gap: unit(q), pressure: unit(q), void: [0.0; 3], share: [0.25, 0.5, 0.25][q] },
                order => {
                    let pressure = pressure(order, q as f64 - 1.0);
                    Store { gap: unit(q), pressure, void: [0.0; 3], share: SIMPSON[q] }
                }
            });
        }
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
        let pairs = if tears { self.pairs() } else { &[[0, 0]] };
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
            density * (self.thickness(sum(&store.gap, at)).0 - sum(&store.void, &at[6..]))
        })
    }

    /// Thickness of the fluid for a distance of the surfaces, and its derivative.
    fn thickness(&self, gap: f64) -> (f64, f64) {
        self.rough.map_or((gap, 1.0), |(rough, _)| rough.thickness(gap))
    }

    /// How [`Film::mass`] changes with gaps, pressures and void.
    pub fn mass_change(&self, at: &Local, change: &Local) -> [f64; 3] {
        self.stores().map(|store| {
            let (thickness, slope) = self.thickness(sum(&store.gap, at));
            let fluid = thickness - sum(&store.void, &at[6..]);
            let more = slope * sum(&store.gap, change) - sum(&store.void, &change[6..]);
            let density = (self.fluid_compressibility * sum(&store.pressure, &at[3..])).exp();
            let denser = self.fluid_compressibility * sum(&store.pressure, &change[3..]);
            density * (more + fluid * denser)
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
            let (thickness, slope) = self.thickness(sum(&store.gap, at));
            let fluid = thickness - sum(&store.void, &at[6..]);
            let factor = length * store.share * mass_rate.rate * (chi * sum(&store.pressure, &at[3..])).exp();
            for a in 0..3 {
                let value = store.pressure[a];
                terms.residual[a] += (factor * fluid + length * store.share * history) * value;
                for b in 0..3 {
                    terms.tangent[a][b] += factor * slope * store.gap[b] * value;
                    terms.tangent[a][3 + b] += factor * fluid * chi * store.pressure[b] * value;
                    terms.tangent[a][6 + b] -= factor * store.void[b] * value;
                }
            }
        }
        if let Some((rough, shear_modulus)) = &self.rough {
            self.add_rough_flow(rough, *shear_modulus, length, at, sliding_speed, &mut terms);
            return terms;
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

    /// Pairs of neighbouring nodes with a pressure of their own.
    fn pairs(&self) -> &'static [[usize; 2]] {
        if self.pressure_order == 2 { &[[0, 1], [1, 2]] } else { &[[0, 2]] }
    }

    /// Flow between rough surfaces.
    fn add_rough_flow(
        &self,
        rough: &Roughness,
        shear_modulus: f64,
        length: f64,
        at: &Local,
        sliding_speed: f64,
        terms: &mut Terms,
    ) {
        // Between the nodes the logarithm of the thickness is quadratic: at the edge of a contact it grows tenfold within a column, and a
        // parabola through such values would close the film.
        let nodes: [(f64, f64); 3] = std::array::from_fn(|b| rough.thickness(at[b]));
        let logarithms = nodes.map(|(thickness, _)| thickness.ln());
        for &[from, to] in self.pairs() {
            let share = 0.5 * (to - from) as f64;
            // Means over the pair of c and of c h, with their derivatives by the gaps.
            let (mut c_mean, mut ch_mean) = ([0.0; 4], [0.0; 4]);
            for (s, w) in GAUSS.into_iter().zip(GAUSS_WEIGHTS) {
                let shape = quadratic(from as f64 - 1.0 + share * (1.0 + s));
                let h = sum(&shape, &logarithms).exp();
                let (phi, phi_slope) = rough.flow_factor(h);
                let c = 0.5 * w / (phi * h.powi(3));
                let c_slope = -c * (3.0 / h + phi_slope / phi);
                c_mean[3] += c;
                ch_mean[3] += c * h;
                for b in 0..3 {
                    let slope = h * shape[b] * nodes[b].1 / nodes[b].0;
                    c_mean[b] += c_slope * slope;
                    ch_mean[b] += (c_slope * h + c) * slope;
                }
            }
            let carried = ch_mean[3] / c_mean[3];
            let up = if sliding_speed < 0.0 { to } else { from };
            let (upstream, upstream_slope) = nodes[up];
            let distance = share * length;
            let stiffness = 2.0 * std::f64::consts::PI * shear_modulus;
            let peclet = 6.0 * self.viscosity * sliding_speed.abs() * distance.powi(2) / (stiffness * carried.powi(3));
            let moved = peclet / (1.0 + peclet);
            // What Pe changes of it, over Pe.
            let moved_slope = (upstream - carried) * peclet / (1.0 + peclet).powi(2);
            let carried_upstream = carried + moved * (upstream - carried);
            let conductance = 1.0 / (12.0 * self.viscosity * c_mean[3] * distance);
            let drop = at[3 + to] - at[3 + from];
            let density = (0.5 * self.fluid_compressibility * (at[3 + to] + at[3 + from])).exp();
            let flux = 0.5 * sliding_speed * carried_upstream - conductance * drop;
            for (a, sign) in [(from, density), (to, -density)] {
                terms.residual[a] += sign * flux;
                // |U| grows with U as Pe does, so that Pe/U dPe/dU is what it is.
                terms.by_speed[a] += sign * 0.5 * (carried_upstream + moved_slope);
                for b in 0..3 {
                    let carried_by = (ch_mean[b] - carried * c_mean[b]) / c_mean[3];
                    let upstream_by = if b == up { upstream_slope } else { 0.0 };
                    let by_gap = carried_by * (1.0 - moved - 3.0 * moved_slope / carried) + moved * upstream_by;
                    terms.tangent[a][b] +=
                        sign * (0.5 * sliding_speed * by_gap + conductance * drop * c_mean[b] / c_mean[3]);
                }
                for (b, way) in [(from, 1.0), (to, -1.0)] {
                    terms.tangent[a][3 + b] += sign * (conductance * way + 0.5 * self.fluid_compressibility * flux);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::roughness::AsperityLaw;
    use proptest::prelude::*;

    const ROUGH: Roughness = Roughness {
        rms: 0.3e-6,
        law: AsperityLaw::Exponential,
        asperity_pressure: 20e3,
        asperity_decay: 0.5,
        core_pressure: 10e6,
        core_decay: 0.1,
    };

    proptest! {
        #[test]
        fn tangent_is_the_derivative_of_the_residual(
            gaps in prop::array::uniform3(0.5..2.0f64), pressures in prop::array::uniform3(-1.0..1.0f64),
            voids in prop::array::uniform3(0.0..0.5f64), direction in prop::array::uniform9(-1.0..1.0f64), order in 1..3_i32,
            tears: bool, rough: bool, speed in -1.0..1.0f64,
        ) {
            // The column's Peclet number is around 1.
            let rough = rough.then_some((ROUGH, 0.3e6));
            let film = Film { viscosity: 1e-3, fluid_compressibility: 1e-7, pressure_order: order, tears: tears && rough.is_none(), rough };
            let length = if rough.is_some() { 3e-5 } else { 1e-4 };
            let scaled = |v: [f64; 9]| -> Local { std::array::from_fn(|i| v[i] * [1e-6, 1e5, 1e-6][i / 3]) };
            let at = scaled(std::array::from_fn(|i| [gaps, pressures, voids][i / 3][i % 3]));
            let change = scaled(direction);
            let moved = |s: f64| -> Local { std::array::from_fn(|i| at[i] + s * change[i]) };
            let rate = MassRate { rate: 5.0, history: [1e-6, -2e-6, 3e-6] };
            let residual = |s: f64, u: f64| film.element(length, &moved(s), u, &rate).residual;
            let terms = film.element(length, &at, speed, &rate);
            let (plus, minus) = (residual(1e-5, speed), residual(-1e-5, speed));
            let linear: [f64; 3] = std::array::from_fn(|a| (0..9).map(|b| terms.tangent[a][b] * change[b]).sum());
            let size = linear.iter().fold(1e-12, |m: f64, v| m.max(v.abs()));
            let faster = (1.0 + 1e-5) * speed;
            for a in 0..3 {
                prop_assert!(((plus[a] - minus[a]) / 2e-5 - linear[a]).abs() < 1e-7 * size);
                let by_speed = (residual(0.0, faster)[a] - residual(0.0, (1.0 - 1e-5) * speed)[a]) / (2e-5 * speed);
                prop_assert!((by_speed - terms.by_speed[a]).abs() < 1e-7 * terms.by_speed[a].abs() + 1e-15 / speed.abs());
            }
            // What flows is not lost, and what is stored is the mass.
            let none = MassRate::default();
            prop_assert!(film.element(length, &at, speed, &none).residual.iter().sum::<f64>().abs() < 1e-20);
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
            let film = Film { viscosity: 1e-3, fluid_compressibility: 0.0, pressure_order: order, tears: false, rough: None };
            let line = |middle: f64, rise: f64| [middle - rise, middle, middle + rise];
            let (gaps, pressures) = (line(1e-6, 1e-6 * slope), line(1e3, 1e5 * gradient));
            let at: Local = std::array::from_fn(|i| [gaps, pressures, [0.0; 3]][i / 3][i % 3]);
            let [whole, tearing] =
                [film, Film { tears: true, ..film }].map(|f| f.element(1e-4, &at, speed, &MassRate::default()).residual);
            prop_assert!((whole[0] + 0.5 * whole[1] - tearing[0] - 0.5 * tearing[1]).abs() < 1e-9 * whole[0].abs() + 1e-20);
        }
    }
}
