//! The film between the bodies, on one element of the interface.
//!
//! One equation serves both faces; the fluxes out of the two bodies cancel, because bodies and film share the pressure and its
//! test function w (divided by the density at ambient pressure, r = exp(chi p)):
//!
//! int -r Q w' + d(r h)/dt w dx,   Q = -h^3/(12 eta) p' + u h/2
//!
//! with the viscosity eta that the flow driven by pressure feels, see [`crate::laws::fluid`].
//!
//! In the consistent formulation x is the place along the deformed film, halfway between the surfaces, and u the sum of the speeds of the
//! deformed surfaces: where tissue is stretched by the factor l it moves at l U. Stretch counts along x, gaps and the film's slope being those
//! across and along the undeformed arc. In the paper's formulation the film stays there. That surfaces which roll stretch unlike, and so slide a little, is
//! left out: the difference of speeds is that of the bones.
//!
//! On a mesh that moves with speed W along the undeformed film the rate is that of r h dx seen from the mesh, and both walls are slower by W.
//!
//! Where h = 0 nothing is left of it, and the fluid crosses from body to body: the paper's periodic condition.
//!
//! A film that may cavitate holds r (h - c), where c of the gap is void, and of what the walls carry the fraction c/h is
//! void, with c/h from upstream. Where the tissue takes up more than the film holds, void enters its pores: c is then larger than h,
//! and the rest moves with the walls. Pressure and w are then straight lines from node to node and the film is stored at the nodes: with
//! curved ones a node beside the void could neither be full nor cavitated.
//!
//! What flows between rough surfaces is in `film/rough.rs`.

mod rough;

use num_dual::Dual64;

use crate::fem::element::{
    GAUSS, GAUSS_WEIGHTS, SIMPSON, pressure, pressure_derivative, quadratic, quadratic_derivative,
};
use crate::laws::chain;
use crate::laws::film::{mean_shear_rate, mean_shear_stress, reynolds_flux};
use crate::laws::fluid::{Fluid, relative_density};
use crate::laws::roughness::Roughness;

/// Values of an element: gaps, pressures, thicknesses of void, and displacements along x of the upper and of the lower surface, at three nodes
/// each.
pub const LOCAL: usize = 15;

/// These values.
pub type Local = [f64; LOCAL];

/// Where the displacements along x begin.
pub const SIDEWAYS: usize = 9;

/// An element of the undeformed interface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    /// Length along the arc of the film \[m\].
    pub length: f64,
    /// Width along x \[m\].
    pub width: f64,
    /// Widths of the parts of the upper and of the lower surface that face it, over its own.
    pub surfaces: [f64; 2],
    /// Whether the film goes with the deformed surfaces.
    pub deforms: bool,
}

/// By what factors the surfaces and the film between them are longer than undeformed, at a place.
pub struct Stretch {
    /// The surfaces.
    pub surfaces: [f64; 2],
    film: f64,
    /// Derivatives of `surfaces` with respect to the displacements of each surface at the three nodes \[1/m\].
    pub by_surface: [[f64; 3]; 2],
    /// Derivatives of `film` with respect to the displacements of either surface.
    by_either: [f64; 3],
}

impl Stretch {
    /// Derivatives with respect to the displacements along x, from those with respect to the stretches of the film and of the surfaces.
    fn by_sideways(&self, by_film: f64, by_surfaces: [f64; 2]) -> [f64; 6] {
        std::array::from_fn(|i| by_film * self.by_either[i % 3] + by_surfaces[i / 3] * self.by_surface[i / 3][i % 3])
    }
}

impl Element {
    /// At a fraction -1..=1 of the way from the middle to the right end.
    pub fn stretch(&self, place: f64, at: &Local) -> Stretch {
        let slope = if self.deforms { quadratic_derivative(place).map(|d| 2.0 * d / self.width) } else { [0.0; 3] };
        let [upper, lower] = [0, 1].map(|k| self.surfaces[k] + sum(&slope, &at[SIDEWAYS + 3 * k..]));
        Stretch {
            surfaces: [upper / self.surfaces[0], lower / self.surfaces[1]],
            film: 0.5 * (upper + lower),
            by_surface: self.surfaces.map(|width| slope.map(|d| d / width)),
            by_either: slope.map(|d| 0.5 * d),
        }
    }

    /// By what factors the upper and the lower surface, and the film between them, are longer than undeformed at such a place, along a change of
    /// the values.
    pub fn stretches(&self, place: f64, at: &Local, change: &Local) -> ([Dual64; 2], Dual64) {
        let stretch = self.stretch(place, at);
        let moved = |k: usize, by: &[f64; 3]| sum(by, &change[SIDEWAYS + 3 * k..]);
        let surfaces = [0, 1].map(|k| Dual64::new(stretch.surfaces[k], moved(k, &stretch.by_surface[k])));
        let film = moved(0, &stretch.by_either) + moved(1, &stretch.by_either);
        (surfaces, Dual64::new(stretch.film, film))
    }
}

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

/// What an element gives, see [`Terms`].
pub const ROWS: usize = 7;
/// Which rows are the forces.
pub const DRAG: std::ops::Range<usize> = 3..6;
/// Which row is the power.
pub const DISSIPATION: usize = 6;

/// What an element gives, with its derivatives, by rows: the residual of the three pressure equations \[m^2/s\]; what the flow that pressure
/// drives drags along either wall, (h/2) p', as forces on the three nodes against the arc \[N/m\]; the power that it dissipates \[W/m\].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Terms {
    /// The rows.
    pub rows: [f64; ROWS],
    /// Derivatives of each row with respect to the values of the element.
    pub tangent: [[f64; LOCAL]; ROWS],
    /// With respect to the speeds of the upper and the lower surface.
    pub by_speeds: [[f64; ROWS]; 2],
}

impl Terms {
    /// Residual of the three pressure equations \[m^2/s\].
    pub fn residual(&self) -> [f64; 3] {
        [self.rows[0], self.rows[1], self.rows[2]]
    }

    /// Forces on the three nodes of either wall against the arc \[N/m\].
    pub fn drag(&self) -> [f64; 3] {
        std::array::from_fn(|a| self.rows[DRAG.start + a])
    }

    /// Change of a row along changes of the values and of the speeds.
    pub fn along(&self, row: usize, change: &Local, speeds: [f64; 2]) -> f64 {
        let by_values: f64 = self.tangent[row].iter().zip(change).map(|(by, change)| by * change).sum();
        by_values + self.by_speeds[0][row] * speeds[0] + self.by_speeds[1][row] * speeds[1]
    }

    /// Adds a part of a row.
    fn add(&mut self, row: usize, factor: f64, value: f64, by: &Gradient) {
        self.rows[row] += factor * value;
        for (sum, by) in self.tangent[row].iter_mut().zip(&by.values) {
            *sum += factor * by;
        }
        for (sum, by) in self.by_speeds.iter_mut().zip(by.speeds) {
            sum[row] += factor * by;
        }
    }
}

/// Derivatives with respect to the values of an element and to the speeds of the surfaces.
#[derive(Default)]
struct Gradient {
    values: Local,
    speeds: [f64; 2],
}

/// Where fluid is stored: shape functions of gap, pressure and void, test functions, and the fraction of the element's length.
struct Store {
    place: f64,
    gap: [f64; 3],
    pressure: [f64; 3],
    void: [f64; 3],
    fraction: f64,
}

/// Where fluid flows: the place in the element -1..=1, shape functions of gap and pressure, the node from which void is carried, and
/// derivatives of the pressure's shape functions, which are the test functions too, along the element as a fraction of its length.
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
    /// The Gauss points; of a film that may cavitate or of rough surfaces the nodes, with the mean stretch of what the pairs have there.
    fn stores(&self) -> [Store; 3] {
        let unit = |a: usize| std::array::from_fn(|b| if a == b { 1.0 } else { 0.0 });
        let place = |q: usize| if self.pressure_order == 2 { 0.5 * (q as f64 - 1.0) } else { 0.0 };
        let halves = [0.25, 0.5, 0.25];
        std::array::from_fn(|q| match (self.rough.is_some(), self.cavitates, self.pressure_order) {
            (true, _, 2) => {
                Store { place: place(q), gap: unit(q), pressure: unit(q), void: [0.0; 3], fraction: halves[q] }
            }
            (true, _, order) => {
                let pressure = pressure(order, q as f64 - 1.0);
                Store { place: place(q), gap: unit(q), pressure, void: [0.0; 3], fraction: SIMPSON[q] }
            }
            (false, true, order) => {
                let fraction = if order == 2 { halves[q] } else { [0.5, 0.0, 0.5][q] };
                Store { place: place(q), gap: unit(q), pressure: unit(q), void: unit(q), fraction }
            }
            (false, false, order) => Store {
                place: GAUSS[q],
                gap: quadratic(GAUSS[q]),
                pressure: pressure(order, GAUSS[q]),
                void: [0.0; 3],
                fraction: 0.5 * GAUSS_WEIGHTS[q],
            },
        })
    }

    /// The Gauss points; of a film that may cavitate those between two nodes, one segment after the other.
    fn flows(&self, sliding_speed: f64) -> impl Iterator<Item = Flow> {
        let Self { cavitates, pressure_order, .. } = *self;
        let segments = if cavitates { self.segments() } else { &[[0, 0]] };
        segments.iter().flat_map(move |segment| {
            GAUSS.into_iter().zip(GAUSS_WEIGHTS).map(move |(s, w)| {
                if !cavitates {
                    let slope = pressure_derivative(pressure_order, s).map(|d| 2.0 * d);
                    let pressure = pressure(pressure_order, s);
                    return Flow { place: s, gap: quadratic(s), pressure, slope, upstream: None, fraction: 0.5 * w };
                }
                let [from, to] = *segment;
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

    /// Fluid r (h - c) l of an element where it is stored \[m^2\]: at the quadrature points, or at the nodes where the film may cavitate. Beside
    /// a node in contact an interpolated gap may be a little below zero; it counts as it is, so that what is stored is linear in the gaps
    /// of the nodes, and has no kink where they close.
    pub fn mass(&self, element: &Element, at: &Local) -> [f64; 3] {
        self.stores().map(|store| {
            let density = relative_density(self.fluid_compressibility, sum(&store.pressure, &at[3..]));
            let length = element.length * element.stretch(store.place, at).film;
            density * (self.thickness(sum(&store.gap, at)).0 - sum(&store.void, &at[6..])) * length
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

    /// Mean shear stress over the film, see [`mean_shear_stress`], for a distance of the surfaces, a pressure gradient and the difference of the
    /// surfaces' speeds.
    pub fn mean_shear_stress(&self, gap: Dual64, pressure_gradient: Dual64, speed_difference: Dual64) -> Dual64 {
        let thickness = match self.rough {
            Some((rough, _)) => chain(rough.thickness(gap.re), gap.eps),
            None if gap.re > 0.0 => gap,
            None => Dual64::from(0.0),
        };
        mean_shear_stress(&self.fluid, thickness, self.shear_rate(gap, speed_difference), pressure_gradient)
    }

    /// How [`Film::mass`] changes with gaps, pressures and void.
    pub fn mass_change(&self, element: &Element, at: &Local, change: &Local) -> [f64; 3] {
        self.stores().map(|store| {
            let stretch = element.stretch(store.place, at);
            let sideways: [f64; 3] = std::array::from_fn(|b| change[SIDEWAYS + b] + change[SIDEWAYS + 3 + b]);
            let (thickness, slope) = self.thickness(sum(&store.gap, at));
            let fluid = thickness - sum(&store.void, &at[6..]);
            let more = slope * sum(&store.gap, change) - sum(&store.void, &change[6..]);
            let density = relative_density(self.fluid_compressibility, sum(&store.pressure, &at[3..]));
            let denser = self.fluid_compressibility * sum(&store.pressure, &change[3..]);
            let longer = sum(&stretch.by_either, &sideways);
            density * element.length * ((more + fluid * denser) * stretch.film + fluid * longer)
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

    /// The terms of an element between an upper and a lower surface of these speeds \[m/s\].
    pub fn element(&self, element: &Element, at: &Local, speeds: [f64; 2], mass_rate: &MassRate) -> Terms {
        let mut terms = Terms::default();
        self.add_storage(element, at, mass_rate, &mut terms);
        match &self.rough {
            Some(rough) => self.add_rough_flow(rough, element, at, speeds, mass_rate, &mut terms),
            None => self.add_smooth_flow(element, at, speeds, mass_rate, &mut terms),
        }
        terms
    }

    /// Adds d(r h)/dt.
    fn add_storage(&self, element: &Element, at: &Local, mass_rate: &MassRate, terms: &mut Terms) {
        let chi = self.fluid_compressibility;
        for (store, history) in self.stores().into_iter().zip(mass_rate.history) {
            if mass_rate.rate == 0.0 && history == 0.0 {
                continue;
            }
            let (thickness, slope) = self.thickness(sum(&store.gap, at));
            let fluid = thickness - sum(&store.void, &at[6..]);
            let stretch = element.stretch(store.place, at);
            let density = relative_density(chi, sum(&store.pressure, &at[3..]));
            let unstretched = element.length * store.fraction * mass_rate.rate * density;
            let factor = unstretched * stretch.film;
            for a in 0..3 {
                let value = store.pressure[a];
                terms.rows[a] += (factor * fluid + store.fraction * history) * value;
                let sideways = stretch.by_sideways(unstretched * fluid * value, [0.0; 2]);
                for (sum, by) in terms.tangent[a][SIDEWAYS..].iter_mut().zip(sideways) {
                    *sum += by;
                }
                for b in 0..3 {
                    terms.tangent[a][b] += factor * slope * store.gap[b] * value;
                    terms.tangent[a][3 + b] += factor * fluid * chi * store.pressure[b] * value;
                    terms.tangent[a][6 + b] -= factor * store.void[b] * value;
                }
            }
        }
    }

    /// Adds the flow between smooth surfaces.
    fn add_smooth_flow(
        &self,
        element: &Element,
        at: &Local,
        speeds: [f64; 2],
        mass_rate: &MassRate,
        terms: &mut Terms,
    ) {
        let chi = self.fluid_compressibility;
        for flow in self.flows(mass_rate.relative(speeds, 0.0).iter().sum()) {
            // Seen from the mesh: what it passes by counts as flow.
            let unstretched = mass_rate.relative(speeds, flow.place);
            let stretch = element.stretch(flow.place, at);
            let sliding_speed = unstretched[0] * stretch.surfaces[0] + unstretched[1] * stretch.surfaces[1];
            let gap = sum(&flow.gap, at);
            let length = element.length * stretch.film;
            let slope = flow.slope.map(|d| d / length);
            let gradient = sum(&slope, &at[3..]);
            let density = relative_density(chi, sum(&flow.pressure, &at[3..]));
            let both = [sliding_speed, speeds[0] - speeds[1]];
            let flux = reynolds_flux(&self.fluid, gap, gradient, both, self.shear_film_offset);
            let open = gap.max(0.0);
            let void = flow.upstream.map_or(Void::default(), |up| Void::carried(open, at[up], at[6 + up]));
            let value = flux.value - 0.5 * sliding_speed * void.value;
            // Of what goes with the gap, the slope of pressure, sum and difference of speeds, and, if it is so much per length, with that.
            let spread = |by_gap: f64, by_slope: f64, by_sum: f64, by_difference: f64, per_length: f64| {
                let mut by = Gradient::default();
                for (b, (shape, slope)) in flow.gap.iter().zip(slope).enumerate() {
                    by.values[b] = by_gap * shape;
                    by.values[3 + b] = by_slope * slope;
                }
                let by_film = (per_length - by_slope * gradient) / stretch.film;
                by.values[SIDEWAYS..].copy_from_slice(&stretch.by_sideways(by_film, unstretched.map(|u| by_sum * u)));
                by.speeds =
                    [by_sum * stretch.surfaces[0] + by_difference, by_sum * stretch.surfaces[1] - by_difference];
                by
            };
            let open_slope = if gap > 0.0 { 1.0 } else { 0.0 };
            let by_gap = flux.by_film_thickness - 0.5 * sliding_speed * void.by_gap * open_slope;
            let by_sum = flux.by_speed_sum - 0.5 * void.value;
            let mut by = spread(by_gap, flux.by_pressure_gradient, by_sum, flux.by_speed_difference, 0.0);
            for (by, shape) in by.values[3..].iter_mut().zip(flow.pressure) {
                *by += value * chi * shape;
            }
            if let Some(up) = flow.upstream {
                by.values[up] -= 0.5 * sliding_speed * void.by_upstream_gap;
                by.values[6 + up] -= 0.5 * sliding_speed * void.by_upstream_void;
            }
            for (a, slope) in flow.slope.into_iter().enumerate() {
                terms.add(a, -flow.fraction * density * slope, value, &by);
            }
            // (h/2) p', and what is driven times p'.
            let drag = 0.5 * open * gradient;
            let by = spread(0.5 * open_slope * gradient, 0.5 * open, 0.0, 0.0, drag);
            for (row, shape) in DRAG.zip(flow.gap) {
                terms.add(row, flow.fraction * length * shape, drag, &by);
            }
            let driven = -flux.driven;
            let by_gap = (0.5 * sliding_speed * open_slope - flux.by_film_thickness) * gradient;
            let by_slope = driven - flux.by_pressure_gradient * gradient;
            let by = spread(by_gap, by_slope, 0.0, -flux.by_speed_difference * gradient, driven * gradient);
            terms.add(DISSIPATION, flow.fraction * length, driven * gradient, &by);
        }
    }

    /// Segments between neighbouring nodes with a pressure of their own.
    fn segments(&self) -> &'static [[usize; 2]] {
        if self.pressure_order == 2 { &[[0, 1], [1, 2]] } else { &[[0, 2]] }
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
            voids in prop::array::uniform3(0.0..0.5f64), sideways in prop::collection::vec(-1.0..1.0f64, 6),
            direction in prop::collection::vec(-1.0..1.0f64, LOCAL), order in 1..3_i32,
            cavitates: bool, rough: bool, thinning: bool, deforms: bool, speed in -1.0..1.0f64, ratio in -1.5..1.5f64,
        ) {
            prop_assume!(speed.abs() > 1e-3);
            // The column's Peclet number is around 1.
            let rough = rough.then_some((ROUGH, 0.3e6));
            let fluid = if thinning { THINNING } else { Fluid::Newtonian(1e-3) };
            let cavitates = cavitates && rough.is_none();
            let film = Film { fluid, shear_film_offset: 1e-7, fluid_compressibility: 1e-7, pressure_order: order, cavitates, rough };
            let length = if rough.is_some() { 3e-5 } else { 1e-4 };
            // Stretched by up to a fifth.
            let element = Element { length: 1.1 * length, width: length, surfaces: [1.02, 0.98], deforms };
            let far = length / 20.0;
            let scaled = |v: &[f64]| -> Local { std::array::from_fn(|i| v[i] * [1e-6, 1e5, 1e-6, far, far][i / 3]) };
            let at = scaled(&[&gaps, &pressures, &voids, &sideways[..]].concat());
            let change = scaled(&direction);
            let moved = |s: f64| -> Local { std::array::from_fn(|i| at[i] + s * change[i]) };
            let rate = MassRate { rate: 5.0, history: [1e-9, -2e-9, 3e-9], mesh_speeds: [0.03, 0.01] };
            let speeds = [0.5 * speed * (1.0 + ratio), 0.5 * speed * (1.0 - ratio)];
            let residual = |s: f64, u: [f64; 2]| film.element(&element, &moved(s), u, &rate).rows;
            let terms = film.element(&element, &at, speeds, &rate);
            let (plus, minus) = (residual(1e-5, speeds), residual(-1e-5, speeds));
            // Residual, forces, power.
            for rows in [0..3, DRAG, DISSIPATION..ROWS] {
                let linear = |row: usize| terms.along(row, &change, [0.0; 2]);
                // Where pressure all but drives nothing, over what the speeds would take.
                let drag: f64 = if rows.start == DISSIPATION { terms.drag().iter().map(|force| force.abs()).sum() } else { 0.0 };
                let least = 1e-12 + 1e-3 * drag * speed.abs();
                let size = rows.clone().fold(least, |size: f64, row| size.max(linear(row).abs()));
                let largest = terms.by_speeds.iter().flat_map(|by| &by[rows.clone()]).fold(0.0, |m: f64, v| m.max(v.abs()));
                for row in rows {
                    prop_assert!(((plus[row] - minus[row]) / 2e-5 - linear(row)).abs() < 1e-6 * size, "{}", row);
                    for k in 0..2 {
                        // Upstream stays where it is.
                        let step = 1e-6 * speed.abs();
                        let faster = |e: f64| std::array::from_fn(|i| speeds[i] + if i == k { e } else { 0.0 });
                        let change = residual(0.0, faster(step))[row] - residual(0.0, faster(-step))[row];
                        let (by_speed, slope) = (change / (2.0 * step), terms.by_speeds[k][row]);
                        let bound = 1e-5 * largest + 1e-15 / speed.abs() + 1e-9 * terms.rows[row].abs() / speed.abs();
                        prop_assert!((by_speed - slope).abs() < bound, "{}: {} {}", row, by_speed, slope);
                    }
                }
            }
            // What flows is not lost, and what is stored is the mass.
            let none = MassRate::default();
            prop_assert!(film.element(&element, &at, speeds, &none).residual().iter().sum::<f64>().abs() < 1e-20);
            let (mass, stored) = (film.mass(&element, &at), film.storage(&[1e-4; 3]));
            prop_assert!((stored.iter().sum::<f64>() - 1e-4).abs() < 1e-16);
            let slope = film.mass_change(&element, &at, &change);
            let (plus, minus) = (film.mass(&element, &moved(1e-5)), film.mass(&element, &moved(-1e-5)));
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
            let at: Local = std::array::from_fn(|i| [gaps, pressures, [0.0; 3], [0.0; 3], [0.0; 3]][i / 3][i % 3]);
            let element = Element { length: 1e-4, width: 1e-4, surfaces: [1.0; 2], deforms: true };
            let [whole, cavitating] =
                [film, Film { cavitates: true, ..film }].map(|f| f.element(&element, &at, [0.5 * speed; 2], &MassRate::default()).residual());
            prop_assert!((whole[0] + 0.5 * whole[1] - cavitating[0] - 0.5 * cavitating[1]).abs() < 1e-9 * whole[0].abs() + 1e-20);
        }
    }
}
