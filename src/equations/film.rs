//! The film between the bodies, on one element of the interface.
//!
//! One equation serves both faces; the fluxes out of the two bodies cancel, because bodies and film share the pressure and its
//! test function w (divided by the density at ambient pressure, r = exp(chi p)):
//!
//! int -r Q w' + d(r h)/dt w dx,   Q = -h^3/(12 eta) p' + U h/2
//!
//! with the viscosity eta that the flow driven by pressure feels, see [`crate::laws::fluid`].
//!
//! On a mesh that moves with speed W along x the rate is that of r h dx seen from the mesh, and W r h leaves Q: both walls are slower by W.
//!
//! Where h = 0 nothing is left of it, and the fluid crosses from body to body: the paper's periodic condition.
//!
//! A film that may cavitate holds r (h - c), where c of the gap is void, and of what the walls carry the fraction c/h is
//! void, with c/h from upstream. Where the tissue takes up more than the film holds, void enters its pores: c is then larger than h,
//! and the rest moves with the walls. Pressure and w are then straight lines from node to node and the film is stored at the nodes: with
//! curved ones a node beside the void could neither be full nor cavitated.
//!
//! Between rough surfaces the film has the thickness, the flow factor phi and the storage of [`Roughness`]. Pressure and w are straight
//! lines from node to node, and Q is one number between two nodes, from Reynolds' equation integrated over that length l:
//!
//! Q = U h_c/2 - (p_2 - p_1) / (12 int c dx),   h_c = int c h dx / int c dx,   c = eta/(phi h^3)
//!
//! The lubricant is sheared at the mean rate (U_1 - U_2) <1/h>, and a viscosity that depends on the rate is that of the mean gradient
//! of pressure.
//!
//! Where the film is so thin that pressure cannot follow the surfaces from node to node, h_c moves upstream, by Pe/(1 + Pe) of the way
//! to the node there, with the column's Peclet number Pe = 6 eta |U| l^2/(2 pi G h_c^3): the surfaces' answer to a ripple of pressure of
//! that length against the flow it drives. It vanishes with l^2, so that the scheme is of second order where the film is resolved.

use num_dual::Dual64;

use crate::fem::element::{GAUSS, GAUSS_WEIGHTS, SIMPSON, pressure, pressure_derivative, quadratic};
use crate::laws::chain;
use crate::laws::film::{mean_shear_rate, reynolds_flux, wall_shear};
use crate::laws::fluid::Fluid;
use crate::laws::roughness::Roughness;

/// Gaps, pressures and thicknesses of void at the three nodes of an interface element.
pub type Local = [f64; 9];

/// The lubricant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Film {
    /// Its flow curve.
    pub fluid: Fluid,
    /// Added to the gap of smooth surfaces in the mean shear rate \[m\].
    pub shear_film_offset: f64,
    /// Compressibility chi \[1/Pa\].
    pub fluid_compressibility: f64,
    /// Order of the pressure's shape functions.
    pub pressure_order: i32,
    /// Whether the film may cavitate.
    pub cavitates: bool,
    /// Roughness of the surfaces, and shear modulus of the tissue \[Pa\]; none where they are smooth.
    pub rough: Option<(Roughness, f64)>,
}

/// How fast the film's mass changes: d(r h l)/dt = rate * r h l + history with the element's length l; steady is zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MassRate {
    /// Factor of what is stored \[1/s\].
    pub rate: f64,
    /// The rest of the difference formula, at each point of storage \[m^2/s\].
    pub history: [f64; 3],
    /// Speeds of the element's ends along x, with a mesh that moves \[m/s\].
    pub mesh_speeds: [f64; 2],
}

impl MassRate {
    /// Speeds of the surfaces relative to the mesh, at a fraction of the element's length from its middle -1..=1.
    fn relative(&self, speeds: [f64; 2], place: f64) -> [f64; 2] {
        let [left, right] = self.mesh_speeds;
        speeds.map(|speed| speed - 0.5 * (left * (1.0 - place) + right * (1.0 + place)))
    }
}

/// Residual of the three pressure equations with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Terms {
    /// Residual \[m^2/s\].
    pub residual: [f64; 3],
    /// By gaps, pressures and thicknesses of void.
    pub tangent: [[f64; 9]; 3],
    /// By the speeds of the upper and the lower surface.
    pub by_speeds: [[f64; 3]; 2],
}

/// Where fluid is stored: shape functions of gap, pressure and void, test functions, and the fraction of the element's length.
struct Store {
    gap: [f64; 3],
    pressure: [f64; 3],
    void: [f64; 3],
    fraction: f64,
}

/// Where fluid flows: the place in the element -1..=1, shape functions of gap and pressure, the node from which void is carried, and
/// derivatives of the pressure's shape functions, which are the test functions too, by the place as a fraction of the element's length.
struct Flow {
    place: f64,
    gap: [f64; 3],
    pressure: [f64; 3],
    slope: [f64; 3],
    upstream: Option<usize>,
    fraction: f64,
}

/// Thickness of void that is carried through a gap, with its derivatives.
#[derive(Default)]
struct Void {
    value: f64,
    by_gap: f64,
    by_upstream_gap: f64,
    by_upstream_void: f64,
}

/// In a film thinner than this the fraction of void is reckoned as if it were this thick \[m\]: where contact opens there is none yet.
/// It is far below the roughness of cartilage.
const THINNEST: f64 = 1e-8;

impl Void {
    /// From upstream, where this much of that gap is void: the same fraction of the present gap, and what is in the pores.
    fn carried(gap: f64, upstream_gap: f64, upstream_void: f64) -> Self {
        let (room, by_gap) = if upstream_gap > THINNEST { (upstream_gap, 1.0) } else { (THINNEST, 0.0) };
        if upstream_void > room {
            let value = gap + upstream_void - room;
            return Self { value, by_gap: 1.0, by_upstream_gap: -by_gap, by_upstream_void: 1.0 };
        }
        let fraction = upstream_void / room;
        let by_upstream_void = gap / room;
        Self {
            value: fraction * gap,
            by_gap: fraction,
            by_upstream_gap: -fraction * by_upstream_void * by_gap,
            by_upstream_void,
        }
    }
}

fn sum(shape: &[f64; 3], values: &[f64]) -> f64 {
    shape[0] * values[0] + shape[1] * values[1] + shape[2] * values[2]
}

impl Film {
    /// The Gauss points; of a film that may cavitate or of rough surfaces the nodes.
    fn stores(&self) -> [Store; 3] {
        let unit = |a: usize| std::array::from_fn(|b| if a == b { 1.0 } else { 0.0 });
        if self.rough.is_some() {
            return std::array::from_fn(|q| match self.pressure_order {
                2 => Store { gap: unit(q), pressure: unit(q), void: [0.0; 3], fraction: [0.25, 0.5, 0.25][q] },
                order => {
                    let pressure = pressure(order, q as f64 - 1.0);
                    Store { gap: unit(q), pressure, void: [0.0; 3], fraction: SIMPSON[q] }
                }
            });
        }
        std::array::from_fn(|q| match (self.cavitates, self.pressure_order) {
            (true, order) => {
                let fraction = if order == 2 { [0.25, 0.5, 0.25][q] } else { [0.5, 0.0, 0.5][q] };
                Store { gap: unit(q), pressure: unit(q), void: unit(q), fraction }
            }
            (false, order) => Store {
                gap: quadratic(GAUSS[q]),
                pressure: pressure(order, GAUSS[q]),
                void: [0.0; 3],
                fraction: 0.5 * GAUSS_WEIGHTS[q],
            },
        })
    }

    /// The Gauss points; of a film that may cavitate those between two nodes, one pair of nodes after the other.
    fn flows(&self, sliding_speed: f64) -> impl Iterator<Item = Flow> {
        let Self { cavitates, pressure_order, .. } = *self;
        let pairs = if cavitates { self.pairs() } else { &[[0, 0]] };
        pairs.iter().flat_map(move |pair| {
            GAUSS.into_iter().zip(GAUSS_WEIGHTS).map(move |(s, w)| {
                if !cavitates {
                    let slope = pressure_derivative(pressure_order, s).map(|d| 2.0 * d);
                    let pressure = pressure(pressure_order, s);
                    return Flow { place: s, gap: quadratic(s), pressure, slope, upstream: None, fraction: 0.5 * w };
                }
                let [from, to] = *pair;
                let length = 0.5 * (to - from) as f64;
                let (mut pressure, mut slope) = ([0.0; 3], [0.0; 3]);
                (pressure[from], pressure[to]) = (0.5 * (1.0 - s), 0.5 * (1.0 + s));
                (slope[from], slope[to]) = (-1.0 / length, 1.0 / length);
                let upstream = Some(if sliding_speed < 0.0 { to } else { from });
                let place = from as f64 - 1.0 + length * (1.0 + s);
                Flow { place, gap: quadratic(place), pressure, slope, upstream, fraction: 0.5 * w * length }
            })
        })
    }

    /// Fluid r (h - c) where it is stored \[m\]: at the quadrature points, or at the nodes where the film may cavitate. Beside a node in
    /// contact an interpolated gap may be a little below zero; it counts as it is, so that what is stored is linear in the gaps of
    /// the nodes, and has no kink where they close.
    pub fn mass(&self, at: &Local) -> [f64; 3] {
        self.stores().map(|store| {
            let density = (self.fluid_compressibility * sum(&store.pressure, &at[3..])).exp();
            density * (self.thickness(sum(&store.gap, at)).0 - sum(&store.void, &at[6..]))
        })
    }

    /// Thickness of the fluid for a distance of the surfaces, and its derivative.
    pub fn thickness(&self, gap: f64) -> (f64, f64) {
        self.rough.map_or((gap, 1.0), |(rough, _)| rough.thickness(gap))
    }

    /// Mean shear rate \[1/s\] for a distance of the surfaces and the difference of their speeds.
    fn shear_rate(&self, gap: Dual64, speed_difference: Dual64) -> Dual64 {
        let per_speed = match self.rough {
            Some((rough, _)) => {
                let (thickness, slope) = rough.thickness(gap.re);
                chain(rough.inverse_thickness(thickness), slope * gap.eps)
            }
            None => chain(mean_shear_rate(gap.re, 1.0, self.shear_film_offset), gap.eps),
        };
        speed_difference * per_speed
    }

    /// The two parts of the shear stress on the walls, see [`wall_shear`], for a distance of the surfaces, a pressure gradient and the
    /// difference of the surfaces' speeds.
    pub fn wall_shear(&self, gap: Dual64, pressure_gradient: Dual64, speed_difference: Dual64) -> [Dual64; 2] {
        let thickness = match self.rough {
            Some((rough, _)) => chain(rough.thickness(gap.re), gap.eps),
            None if gap.re > 0.0 => gap,
            None => Dual64::from(0.0),
        };
        wall_shear(&self.fluid, thickness, self.shear_rate(gap, speed_difference), pressure_gradient)
    }

    /// Power that the flow driven by a pressure gradient dissipates over the film's thickness, phi h^3 p'^2/(12 eta) \[W/m^2\]; as
    /// [`Film::wall_shear`].
    pub fn pressure_flow_dissipation(
        &self,
        gap: Dual64,
        pressure_gradient: Dual64,
        speed_difference: Dual64,
    ) -> Dual64 {
        let (thickness, factor) = match self.rough {
            Some((rough, _)) => {
                let thickness = chain(rough.thickness(gap.re), gap.eps);
                (thickness, chain(rough.flow_factor(thickness.re), thickness.eps))
            }
            None if gap.re > 0.0 => (gap, Dual64::from(1.0)),
            None => return Dual64::from(0.0),
        };
        let (rate, difference) = (self.shear_rate(gap, speed_difference), thickness * pressure_gradient * 0.5);
        let film = self.fluid.sheared(rate.re, difference.re);
        let change = film.viscosity_by_rate * rate.eps + film.viscosity_by_difference * difference.eps;
        let viscosity = Dual64::new(film.viscosity, change);
        factor * thickness * thickness * thickness * pressure_gradient * pressure_gradient / (viscosity * 12.0)
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

    /// Residual of the three pressure equations for d(r h l)/dt alone, given where fluid is stored \[m^2/s\].
    pub fn storage(&self, rate: &[f64; 3]) -> [f64; 3] {
        let mut residual = [0.0; 3];
        for (store, rate) in self.stores().into_iter().zip(rate) {
            for (r, value) in residual.iter_mut().zip(store.pressure) {
                *r += store.fraction * rate * value;
            }
        }
        residual
    }

    /// The terms of an element of this length \[m\], between an upper and a lower surface of these speeds \[m/s\].
    pub fn element(&self, length: f64, at: &Local, speeds: [f64; 2], mass_rate: &MassRate) -> Terms {
        let mut terms = Terms::default();
        let chi = self.fluid_compressibility;
        for (store, history) in self.stores().into_iter().zip(mass_rate.history) {
            if mass_rate.rate == 0.0 && history == 0.0 {
                continue;
            }
            let (thickness, slope) = self.thickness(sum(&store.gap, at));
            let fluid = thickness - sum(&store.void, &at[6..]);
            let factor = length * store.fraction * mass_rate.rate * (chi * sum(&store.pressure, &at[3..])).exp();
            for a in 0..3 {
                let value = store.pressure[a];
                terms.residual[a] += (factor * fluid + store.fraction * history) * value;
                for b in 0..3 {
                    terms.tangent[a][b] += factor * slope * store.gap[b] * value;
                    terms.tangent[a][3 + b] += factor * fluid * chi * store.pressure[b] * value;
                    terms.tangent[a][6 + b] -= factor * store.void[b] * value;
                }
            }
        }
        if let Some(rough) = &self.rough {
            self.add_rough_flow(rough, length, at, speeds, mass_rate, &mut terms);
            return terms;
        }
        for flow in self.flows(mass_rate.relative(speeds, 0.0).iter().sum()) {
            // Seen from the mesh: what it passes by counts as flow.
            let speeds = mass_rate.relative(speeds, flow.place);
            let sliding_speed = speeds[0] + speeds[1];
            let gap = sum(&flow.gap, at);
            let slope = flow.slope.map(|d| d / length);
            let density = (chi * sum(&flow.pressure, &at[3..])).exp();
            let flux = reynolds_flux(&self.fluid, gap, sum(&slope, &at[3..]), speeds, self.shear_film_offset);
            let void = flow.upstream.map_or(Void::default(), |up| Void::carried(gap.max(0.0), at[up], at[6 + up]));
            let value = flux.value - 0.5 * sliding_speed * void.value;
            let by_gap = flux.by_film_thickness - if gap > 0.0 { 0.5 * sliding_speed * void.by_gap } else { 0.0 };
            let weight = length * flow.fraction * density;
            for a in 0..3 {
                let weight = -weight * slope[a];
                terms.residual[a] += weight * value;
                for (by_speed, flux) in terms.by_speeds.iter_mut().zip(flux.by_speeds) {
                    by_speed[a] += weight * (flux - 0.5 * void.value);
                }
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
        (rough, shear_modulus): &(Roughness, f64),
        length: f64,
        at: &Local,
        speeds: [f64; 2],
        mass_rate: &MassRate,
        terms: &mut Terms,
    ) {
        let speed_difference = speeds[0] - speeds[1];
        // Between the nodes the logarithm of the thickness is quadratic: at the edge of a contact it grows tenfold within a column, and a
        // parabola through such values would close the film.
        let nodes: [(f64, f64); 3] = std::array::from_fn(|b| rough.thickness(at[b]));
        let logarithms = nodes.map(|(thickness, _)| thickness.ln());
        for &[from, to] in self.pairs() {
            let fraction = 0.5 * (to - from) as f64;
            let distance = fraction * length;
            let sliding_speed: f64 = mass_rate.relative(speeds, from as f64 - 1.0 + fraction).iter().sum();
            let drop = at[3 + to] - at[3 + from];
            // Means over the pair of c, of c h and of the viscosity, with their derivatives with respect to the three gaps, the drop of pressure and
            // the difference of speeds.
            let (mut c_mean, mut ch_mean, mut viscosity) = (Mean::default(), Mean::default(), Mean::default());
            for (s, w) in GAUSS.into_iter().zip(GAUSS_WEIGHTS) {
                let shape = quadratic(from as f64 - 1.0 + fraction * (1.0 + s));
                let h = sum(&shape, &logarithms).exp();
                let (phi, phi_slope) = rough.flow_factor(h);
                let logarithmic: [f64; 3] = std::array::from_fn(|b| h * shape[b] * nodes[b].1 / nodes[b].0);
                let (inverse, inverse_slope) = rough.inverse_thickness(h);
                let gradient = drop / distance;
                let film = self.fluid.sheared(speed_difference * inverse, 0.5 * h * gradient);
                let by_h = film.viscosity_by_rate * speed_difference * inverse_slope
                    + film.viscosity_by_difference * 0.5 * gradient;
                let by_drop = film.viscosity_by_difference * 0.5 * h / distance;
                let by_difference = film.viscosity_by_rate * inverse;
                let factor = 0.5 * w / (phi * h.powi(3));
                let c = factor * film.viscosity;
                let c_slope = factor * by_h - c * (3.0 / h + phi_slope / phi);
                c_mean.add(c, c_slope, &logarithmic, [factor * by_drop, factor * by_difference]);
                ch_mean.add(c * h, c_slope * h + c, &logarithmic, [factor * h * by_drop, factor * h * by_difference]);
                viscosity.add(
                    0.5 * w * film.viscosity,
                    0.5 * w * by_h,
                    &logarithmic,
                    [0.5 * w * by_drop, 0.5 * w * by_difference],
                );
            }
            let carried = ch_mean.value / c_mean.value;
            let up = if sliding_speed < 0.0 { to } else { from };
            let (upstream, upstream_slope) = nodes[up];
            let stiffness = 2.0 * std::f64::consts::PI * shear_modulus;
            let peclet = 6.0 * viscosity.value * sliding_speed.abs() * distance.powi(2) / (stiffness * carried.powi(3));
            let moved = peclet / (1.0 + peclet);
            // What Pe changes of it, over Pe.
            let moved_slope = (upstream - carried) * peclet / (1.0 + peclet).powi(2);
            let carried_upstream = carried + moved * (upstream - carried);
            let conductance = 1.0 / (12.0 * c_mean.value * distance);
            let density = (0.5 * self.fluid_compressibility * (at[3 + to] + at[3 + from])).exp();
            let flux = 0.5 * sliding_speed * carried_upstream - conductance * drop;
            // Of the flux, by what the means depend on, with the drop and the upstream gap as they are.
            let by: [f64; 5] = std::array::from_fn(|k| {
                let carried_by = (ch_mean.by[k] - carried * c_mean.by[k]) / c_mean.value;
                let upstream_by = carried_by * (1.0 - moved - 3.0 * moved_slope / carried)
                    + moved_slope * viscosity.by[k] / viscosity.value;
                0.5 * sliding_speed * upstream_by + conductance * drop * c_mean.by[k] / c_mean.value
            });
            // |U| grows with U as Pe does, so that Pe/U dPe/dU is what it is.
            let by_sum = 0.5 * (carried_upstream + moved_slope);
            for (a, sign) in [(from, density), (to, -density)] {
                terms.residual[a] += sign * flux;
                for (by_speed, way) in terms.by_speeds.iter_mut().zip([1.0, -1.0]) {
                    by_speed[a] += sign * (by_sum + way * by[4]);
                }
                for (tangent, by_gap) in terms.tangent[a].iter_mut().zip(&by[..3]) {
                    *tangent += sign * by_gap;
                }
                terms.tangent[a][up] += sign * 0.5 * sliding_speed * moved * upstream_slope;
                for (b, way) in [(from, 1.0), (to, -1.0)] {
                    terms.tangent[a][3 + b] +=
                        sign * ((conductance - by[3]) * way + 0.5 * self.fluid_compressibility * flux);
                }
            }
        }
    }
}

/// A mean over the length between two nodes, with its derivatives.
#[derive(Default)]
struct Mean {
    value: f64,
    by: [f64; 5],
}

impl Mean {
    /// Adds a part with its derivatives with respect to the gap there and to two other numbers.
    fn add(&mut self, value: f64, by_gap: f64, shape: &[f64; 3], by_others: [f64; 2]) {
        self.value += value;
        for (sum, shape) in self.by.iter_mut().zip(shape) {
            *sum += by_gap * shape;
        }
        for (sum, by) in self.by[3..].iter_mut().zip(by_others) {
            *sum += by;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::fluid::Carreau;
    use crate::laws::roughness::ROUGH;
    use proptest::prelude::*;

    const THINNING: Fluid = Fluid::Carreau(Carreau {
        zero_shear_viscosity: 1.0,
        infinite_shear_viscosity: 1e-3,
        relaxation_time: 1e-3,
        flow_index: 0.5,
    });

    proptest! {
        #[test]
        fn tangent_is_the_derivative_of_the_residual(
            gaps in prop::array::uniform3(0.5..2.0f64), pressures in prop::array::uniform3(-1.0..1.0f64),
            voids in prop::array::uniform3(0.0..0.5f64), direction in prop::array::uniform9(-1.0..1.0f64), order in 1..3_i32,
            cavitates: bool, rough: bool, thinning: bool, speed in -1.0..1.0f64, ratio in -1.5..1.5f64,
        ) {
            prop_assume!(speed.abs() > 1e-3);
            // The column's Peclet number is around 1.
            let rough = rough.then_some((ROUGH, 0.3e6));
            let fluid = if thinning { THINNING } else { Fluid::Newtonian(1e-3) };
            let cavitates = cavitates && rough.is_none();
            let film = Film { fluid, shear_film_offset: 1e-7, fluid_compressibility: 1e-7, pressure_order: order, cavitates, rough };
            let length = if rough.is_some() { 3e-5 } else { 1e-4 };
            let scaled = |v: [f64; 9]| -> Local { std::array::from_fn(|i| v[i] * [1e-6, 1e5, 1e-6][i / 3]) };
            let at = scaled(std::array::from_fn(|i| [gaps, pressures, voids][i / 3][i % 3]));
            let change = scaled(direction);
            let moved = |s: f64| -> Local { std::array::from_fn(|i| at[i] + s * change[i]) };
            let rate = MassRate { rate: 5.0, history: [1e-9, -2e-9, 3e-9], mesh_speeds: [0.03, 0.01] };
            let speeds = [0.5 * speed * (1.0 + ratio), 0.5 * speed * (1.0 - ratio)];
            let residual = |s: f64, u: [f64; 2]| film.element(length, &moved(s), u, &rate).residual;
            let terms = film.element(length, &at, speeds, &rate);
            let (plus, minus) = (residual(1e-5, speeds), residual(-1e-5, speeds));
            let linear: [f64; 3] = std::array::from_fn(|a| (0..9).map(|b| terms.tangent[a][b] * change[b]).sum());
            let size = linear.iter().fold(1e-12, |m: f64, v| m.max(v.abs()));
            let largest = terms.by_speeds.iter().flatten().fold(0.0, |m: f64, v| m.max(v.abs()));
            for a in 0..3 {
                prop_assert!(((plus[a] - minus[a]) / 2e-5 - linear[a]).abs() < 1e-6 * size);
                for k in 0..2 {
                    // Upstream stays where it is.
                    let step = 1e-6 * speed.abs();
                    let faster = |e: f64| std::array::from_fn(|i| speeds[i] + if i == k { e } else { 0.0 });
                    let by_speed = (residual(0.0, faster(step))[a] - residual(0.0, faster(-step))[a]) / (2.0 * step);
                    let slope = terms.by_speeds[k][a];
                    prop_assert!((by_speed - slope).abs() < 1e-5 * largest + 1e-15 / speed.abs(), "{} {}", by_speed, slope);
                }
            }
            // What flows is not lost, and what is stored is the mass.
            let none = MassRate::default();
            prop_assert!(film.element(length, &at, speeds, &none).residual.iter().sum::<f64>().abs() < 1e-20);
            let (mass, stored) = (film.mass(&at), film.storage(&[1e-4; 3]));
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
            let fluid = Fluid::Newtonian(1e-3);
            let film = Film { fluid, shear_film_offset: 1e-7, fluid_compressibility: 0.0, pressure_order: order, cavitates: false, rough: None };
            let line = |middle: f64, rise: f64| [middle - rise, middle, middle + rise];
            let (gaps, pressures) = (line(1e-6, 1e-6 * slope), line(1e3, 1e5 * gradient));
            let at: Local = std::array::from_fn(|i| [gaps, pressures, [0.0; 3]][i / 3][i % 3]);
            let [whole, cavitating] =
                [film, Film { cavitates: true, ..film }].map(|f| f.element(1e-4, &at, [0.5 * speed; 2], &MassRate::default()).residual);
            prop_assert!((whole[0] + 0.5 * whole[1] - cavitating[0] - 0.5 * cavitating[1]).abs() < 1e-9 * whole[0].abs() + 1e-20);
        }
    }
}
