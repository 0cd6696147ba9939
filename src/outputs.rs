//! What a solved state is asked for: loads, friction, film, stresses, and profiles along the interface.
//!
//! `results.rs` declares the results; here they are computed.

mod energy;
mod resolution;
mod results;

use num_dual::Dual64;

use crate::equations::film::{DISSIPATION, DRAG};
use crate::equations::system::{Change, Solved};
use crate::fem::element::{GAUSS, GAUSS_WEIGHTS, quadratic, quadratic_derivative};
use crate::fem::mesh::graded;
use crate::parameters::Parameters;
use crate::solver::linear::FIXED;
use resolution::Resolution;
pub(crate) use results::{Derived, Direct};
pub use results::{Floor, Get, Interpolation, Mirror, Outputs, RESULTS, RealTime, ResultRow};

/// Number of fixed stations of the profiles.
pub const STATIONS: usize = 101;

/// Lubrication regime, as named by de Boer et al. (2020), section 3.2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Regime {
    /// Full film between hardly deformed surfaces: the undeformed surfaces would not touch.
    #[default]
    ThinFilmFlow,
    /// Full film that exists only because the layers deform.
    LowFriction,
    /// Solid contact, with ten times more load on the fluid than on the solid.
    BoundaryContact,
    /// Solid contact that carries more than a tenth of the fluid's load.
    HighFriction,
}

impl Regime {
    /// All regimes with name and description; in FMI the first is 1.
    pub const ITEMS: [(&'static str, &'static str); 4] = [
        ("thin_film_flow", "Full film; the undeformed surfaces would not touch"),
        ("low_friction", "Full film that exists only because the layers deform"),
        ("boundary_contact", "Solid contact, fluid load at least ten times the solid load"),
        ("high_friction", "Solid contact, fluid load less than ten times the solid load"),
    ];

    /// The regime of a state: whether the solids touch, penetration depth, loads.
    pub(crate) fn of(touching: bool, penetration_depth: f64, fluid_load: f64, solid_load: f64) -> Self {
        match (touching, penetration_depth > 0.0) {
            (true, _) if fluid_load >= 10.0 * solid_load => Self::BoundaryContact,
            (true, _) => Self::HighFriction,
            (false, true) => Self::LowFriction,
            (false, false) => Self::ThinFilmFlow,
        }
    }

    /// Name in case files, tables and the FMU.
    pub fn name(self) -> &'static str {
        Self::ITEMS[self as usize].0
    }
}

impl Derived<Dual64> {
    /// What follows, at a sliding speed and a penetration depth, from the direct results, from whether the solids touch, and from the
    /// fluid's friction on the upper and the lower body and that of solid on solid, per unit depth (equations 11 to 15).
    pub(crate) fn new(
        parameters: &Parameters,
        [sliding_speed, penetration_depth]: [Dual64; 2],
        direct: &Direct<Dual64>,
        touching: bool,
        fluid_friction: [Dual64; 2],
        boundary_friction: Dual64,
    ) -> Self {
        let (fluid_load, solid_load) = (direct.fluid_load, direct.solid_load);
        let load = fluid_load + solid_load;
        let friction = fluid_friction.map(|fluid| fluid + boundary_friction);
        Self {
            load,
            normal_force: load * parameters.width,
            upper_friction_force: friction[0] * parameters.width,
            lower_friction_force: friction[1] * parameters.width,
            friction_coefficient: ratio_of(largest(friction), load),
            fluid_friction_coefficient: ratio_of(largest(fluid_friction), fluid_load),
            upper_force_x: direct.tangential_load * parameters.width,
            upper_force_y: load * parameters.width,
            upper_moment: direct.load_moment * parameters.width,
            lower_force_x: -direct.tangential_load * parameters.width,
            lower_force_y: -load * parameters.width,
            lower_moment: -direct.load_moment * parameters.width,
            fluid_load_support: ratio_of(fluid_load, load),
            film_parameter: match parameters.surface_roughness {
                0.0 => Dual64::from(0.0),
                rms => direct.minimum_film_thickness / rms,
            },
            sommerfeld_number: ratio_of(sliding_speed * parameters.viscosity, load),
            penetration_depth,
            lubrication_regime: Regime::of(touching, penetration_depth.re, fluid_load.re, solid_load.re),
        }
    }
}

/// Strength of the grading of the profile stations towards x = 0; a constant, so that the stations do not move with the mesh.
const STATION_GRADING: f64 = 3.0;

/// Below this load \[N/m\], the least one that has a steady state, ratios fade to nothing: bodies that are not pressed together have none.
const SMALLEST_LOAD: f64 = 1e-6;

/// The fixed stations of the profiles for an interface of this half width \[m\].
pub fn profile_stations(half_width: f64) -> Vec<f64> {
    let last = (STATIONS - 1) as f64;
    (0..STATIONS).map(|i| half_width * graded(2.0 * i as f64 / last - 1.0, STATION_GRADING)).collect()
}

/// Power that it takes to turn a bone about the centre of its undeformed surface, over the speed of that surface, against this force and moment
/// on the upper body and the opposite on the lower one.
fn resistance(parameters: &Parameters, body: usize, depth: Dual64, force: Dual64, moment: Dual64) -> Dual64 {
    let (curvature, side) = match body {
        0 => (parameters.upper.curvature(), -1.0),
        _ => (parameters.lower.curvature(), 1.0),
    };
    force * side * (-depth * (0.5 * curvature) + 1.0) - moment * curvature
}

impl Solved<'_> {
    /// Results, and what mesh and sector do not resolve.
    pub fn outputs(&self) -> (Outputs, Vec<String>) {
        let none = Change::none(self.system.unknowns(), self.system.stations.len());
        let mut outputs = self.along(&none).map(|dual| dual.re);
        let Resolution { load_error, film_error, friction_error, warnings } = self.resolution(&outputs);
        outputs.estimated_load_error = load_error;
        outputs.estimated_film_error = film_error;
        outputs.estimated_friction_error = friction_error;
        outputs.well_resolved = warnings.is_empty();
        (outputs, warnings)
    }

    /// Derivatives of the results along a change of the solution: the formulas below, differentiated by dual numbers.
    pub fn derivatives(&self, change: &Change) -> Outputs {
        self.along(change).map(|dual| dual.eps)
    }

    /// Results with their derivatives.
    fn along(&self, change: &Change) -> Outputs<Dual64> {
        let p = self.system.parameters();
        let system = self.system;
        let inputs = &self.state.inputs;
        let depth = Dual64::new(inputs.penetration_depth, change.inputs.penetration_depth);
        let speed = Dual64::new(inputs.sliding_speed, change.inputs.sliding_speed);
        let ratio = Dual64::new(inputs.slide_to_roll_ratio, change.inputs.slide_to_roll_ratio);
        let speeds = [speed * (ratio + 1.0) * 0.5, speed * (-ratio + 1.0) * 0.5];
        let difference = speeds[0] - speeds[1];

        let dual = |number: u32| match number {
            FIXED => Dual64::from(0.0),
            _ => Dual64::new(self.state.unknowns[number as usize], change.unknowns[number as usize]),
        };
        let gap = system.film_gaps(self.state, change);
        let levels = system.layers[0].mesh.levels();
        let mut pressure: Vec<_> =
            system.layout.pressure[0].iter().step_by(levels).map(|number| dual(*number)).collect();
        let void = system.layout.void.iter().map(|number| dual(*number));
        let mut void_fraction: Vec<_> = void
            .zip(&gap)
            .zip(&self.state.active)
            .map(|((void, gap), active)| match void.re > 0.0 && !active {
                true if void.re < gap.re => void / *gap,
                true => Dual64::from(1.0),
                false => Dual64::from(0.0),
            })
            .collect();
        if p.pressure_order == 1 {
            for values in [&mut pressure, &mut void_fraction] {
                for i in (1..values.len()).step_by(2) {
                    values[i] = (values[i - 1] + values[i + 1]) * 0.5;
                }
            }
        }
        let contact_pressure = system.contact_pressure(self.state, change);
        let loads = system.loads(self.state, change);

        // Friction: equations 13-15.
        let law = system.contact_law();
        let height = system.mean_height(self.state, change);
        let zero = Dual64::from(0.0);
        let fall = |first: usize, s: f64| -> f64 {
            quadratic(s).iter().enumerate().map(|(a, shape)| system.tangent_fall(first + a) * shape).sum()
        };
        let (mut rolling, mut sliding, mut poiseuille) = (zero, zero, zero);
        // Of the sliding part, the force along x and the lever about the middle of the contact.
        let (mut sliding_along_x, mut sliding_lever) = (zero, zero);
        for column in 0..gap.len() / 2 {
            let local = |f: &[Dual64], shape: [f64; 3]| (0..3).map(|a| f[2 * column + a] * shape[a]).sum::<Dual64>();
            let element = system.film_element(column);
            let terms = system.film_terms(column, self.state);
            let [at, along] = [&self.state.unknowns, &change.unknowns].map(|values| system.film_local(column, values));
            let faster = change.inputs.surface_speeds(inputs);
            let row = |row: usize| Dual64::new(terms.rows[row], terms.along(row, &along, faster));
            rolling += DRAG.map(row).sum::<Dual64>();
            poiseuille += row(DISSIPATION);
            for (s, w) in GAUSS.into_iter().zip(GAUSS_WEIGHTS) {
                let (_, film) = element.stretches(s, &at, &along);
                let [half, half_along_x] = [element.length, element.width].map(|length| film * (0.5 * length));
                let (gap, gradient) = (local(&gap, quadratic(s)), local(&pressure, quadratic_derivative(s)) / half);
                let with_walls = system.film().mean_shear_stress(gap, gradient, difference);
                // Void drags nothing. Its jumps at the ends of the cavitated film make a parabola overshoot; straight lines do not.
                let full = -local(&void_fraction, linear(s)) + 1.0;
                let stress = with_walls * full * w;
                sliding += stress * half;
                sliding_along_x += stress * half_along_x;
                sliding_lever += stress * (local(&height, quadratic(s)) - fall(2 * column, s)) * half_along_x;
            }
        }
        let resultant = system.resultant(self.state, change);
        let mut beyond = zero;
        let ends = system.film_end_shear(self.state, change).into_iter().zip([0, gap.len() - 1]);
        for ([with_pressure, with_walls], end) in ends {
            rolling += with_pressure;
            sliding += with_walls;
            sliding_along_x += with_walls * system.cosine[end];
            sliding_lever += with_walls * (height[end] - system.tangent_fall(end)) * system.cosine[end];
            // Out there the slope of the mean surface is in proportion to that of the gap: int p h' dx = [p h] - int h p' dx.
            let side = if end == 0 { -1.0 } else { 1.0 };
            let [upper, lower] = [p.upper.curvature(), p.lower.curvature()];
            beyond +=
                (pressure[end] * gap[end] * side + with_pressure * 2.0) * (0.5 * (upper - lower) / (upper + lower));
        }
        let fluid_friction = [rolling + sliding, -rolling + sliding];

        let tissue = self.tissue_results(change, speeds);
        let sideways = |friction_along_x: Dual64| resultant.on_slopes + beyond - sliding_along_x - friction_along_x;
        let moment = |moment: Dual64, friction_moment: Dual64| moment + sliding_lever + friction_moment;
        let tangential_load = sideways(resultant.mean(|on| on.friction_along_x));
        let load_moment = moment(resultant.mean(|on| on.moment), resultant.mean(|on| on.friction_moment));
        // Each bone works against what its own tissue feels.
        let bones =
            resultant.bodies.iter().map(|on| (sideways(on.friction_along_x), moment(on.moment, on.friction_moment)));
        let resistances =
            [0, 1].into_iter().zip(bones).map(|(body, (force, moment))| resistance(p, body, depth, force, moment));
        let rotation_power = resistances.zip(speeds).map(|(resistance, speed)| resistance * speed).sum::<Dual64>();

        let (least, position) = extremum(&gap, &system.stations, -1.0);
        let (least, position) = match self.state.active.iter().position(|a| *a) {
            Some(first) => (Dual64::from(0.0), Dual64::from(system.stations[first])),
            None => (law.distance(least), position),
        };
        let touching = law.touches(self.state.touches(), least.re);
        let mut contact_length = Dual64::from(0.0);
        for i in 0..gap.len() - 1 {
            let step = system.arc[i + 1] - system.arc[i];
            let edge =
                |inside: usize, outside: usize| law.edge([gap[inside], gap[outside]], contact_pressure[inside]) * step;
            contact_length += match [i, i + 1].map(|i| law.touches(self.state.active[i], gap[i].re)) {
                [true, true] => Dual64::from(step),
                [true, false] => edge(i, i + 1),
                [false, true] => edge(i + 1, i),
                [false, false] => Dual64::from(0.0),
            };
        }

        let cavitated = system.cavitated(self.state);
        let cavitated = (1..gap.len() - 1).filter(|i| cavitated[*i]);
        let length_at = |i: usize| 0.5 * (system.stations[i + 1] - system.stations[i - 1]);
        let cavitated_length = cavitated.fold(0.0, |sum, i| sum + length_at(i));

        let outflow = system.film_outflow(self.state, change);
        let outflow = outflow.iter().map(|v| Dual64::new(v[0], v[1]));

        // A film that may cavitate has its pressure in straight lines from node to node.
        let least_pressure = match p.cavitation {
            true => pressure.iter().fold(pressure[0], |a, b| if b.re < a.re { *b } else { a }),
            false => extremum(&pressure, &system.stations, -1.0).0,
        };

        let profile = |values: &[Dual64]| self.profile(values);
        let direct = Direct {
            fluid_load: loads.fluid,
            solid_load: loads.solid,
            tangential_load,
            load_moment,
            rotation_power: rotation_power * p.width,
            film_dissipation: (poiseuille + sliding * difference) * p.width,
            pore_flow_dissipation: tissue.pores * p.width,
            boundary_friction_dissipation: resultant.boundary_dissipation * p.width,
            carried_power: (tissue.carried + system.film_end_power(self.state, change) - beyond * difference) * p.width,
            stored_elastic_energy: tissue.stored * p.width,
            minimum_film_thickness: least,
            minimum_film_position: position,
            central_film_thickness: if self.state.active[gap.len() / 2] {
                Dual64::from(0.0)
            } else {
                gap[gap.len() / 2]
            },
            contact_length,
            cavitated_length: Dual64::from(cavitated_length),
            maximum_fluid_pressure: extremum(&pressure, &system.stations, 1.0).0,
            minimum_fluid_pressure: least_pressure,
            maximum_contact_pressure: contact_pressure
                .iter()
                .copied()
                .fold(Dual64::from(0.0), |a, b| if b.re > a.re { b } else { a }),
            maximum_von_mises_stress: tissue.von_mises,
            fluid_exudation: outflow.clone().filter(|v| v.re > 0.0).sum(),
            net_fluid_exudation: outflow.sum(),
            newton_iterations: 0,
            real_contact_share: ratio_of(loads.in_real_contact, loads.total()),
            estimated_load_error: Dual64::from(0.0),
            estimated_film_error: Dual64::from(0.0),
            estimated_friction_error: Dual64::from(0.0),
            well_resolved: true,
            mesh_columns: system.layers[0].mesh.columns as i32,
            mesh_rows: system.layers[0].mesh.rows as i32,
            mesh_half_width: Dual64::from(system.half_width()),
            film_thickness: profile(&gap).into_iter().map(|gap| law.distance(gap)).collect(),
            fluid_pressure: profile(&pressure),
            contact_pressure: self.linear_profile(&contact_pressure),
        };
        let derived = Derived::new(p, [speed, depth], &direct, touching, fluid_friction, resultant.boundary_friction);
        Outputs::new(direct, derived)
    }

    /// Values of a quadratic field of the interface at the fixed stations.
    fn profile(&self, values: &[Dual64]) -> Vec<Dual64> {
        self.at_profile_stations(|first, s| {
            quadratic(s).iter().enumerate().map(|(a, shape)| values[first + a] * *shape).sum()
        })
    }

    /// Likewise of nodal values that are joined by straight lines.
    fn linear_profile(&self, values: &[Dual64]) -> Vec<Dual64> {
        self.at_profile_stations(|first, s| {
            let (i, s) = if s < 0.0 { (first, s + 1.0) } else { (first + 1, s) };
            values[i] * (1.0 - s) + values[i + 1] * s
        })
    }

    /// `f(first node of the element, local coordinate)` at each of the fixed stations.
    fn at_profile_stations(&self, f: impl Fn(usize, f64) -> Dual64) -> Vec<Dual64> {
        let x = &self.system.stations;
        let last = x.len() - 1;
        profile_stations(x[last])
            .into_iter()
            .map(|place| {
                let first = 2 * (x.partition_point(|x| *x <= place).saturating_sub(1).min(last - 2) / 2);
                f(first, (2.0 * (place - x[first]) / (x[first + 2] - x[first]) - 1.0).clamp(-1.0, 1.0))
            })
            .collect()
    }
}

/// Shape functions of the straight lines between the nodes -1, 0, 1.
fn linear(s: f64) -> [f64; 3] {
    if s < 0.0 { [-s, 1.0 + s, 0.0] } else { [0.0, 1.0 - s, s] }
}

/// |a|, with the mean of its two slopes where it is zero.
fn magnitude(a: Dual64) -> Dual64 {
    a * if a.re == 0.0 { 0.0 } else { a.re.signum() }
}

/// The larger magnitude of two friction forces, as the magnitudes of their rolling and of their sliding part together.
fn largest([upper, lower]: [Dual64; 2]) -> Dual64 {
    (magnitude(upper - lower) + magnitude(upper + lower)) * 0.5
}

/// A fraction of a load or a ratio to it; 0 without load, where suction holds the bodies or nothing does.
fn ratio_of(a: Dual64, load: Dual64) -> Dual64 {
    if load.re >= SMALLEST_LOAD {
        a / load
    } else if load.re > 0.0 {
        a * load / SMALLEST_LOAD.powi(2)
    } else {
        Dual64::from(0.0)
    }
}

/// Largest (`sign` = 1) or smallest (-1) value of a quadratic field of the interface, and where it is.
fn extremum(values: &[Dual64], stations: &[f64], sign: f64) -> (Dual64, Dual64) {
    let mut best = (values[0], Dual64::from(stations[0]));
    for first in (0..values.len() - 1).step_by(2) {
        let [a, b, c] = [values[first], values[first + 1], values[first + 2]];
        let half = 0.5 * (stations[first + 2] - stations[first]);
        let (slope, curvature) = ((c - a) * 0.5, (a + c) * 0.5 - b);
        let mut try_at = |value: Dual64, place: Dual64| {
            if sign * value.re > sign * best.0.re {
                best = (value, place);
            }
        };
        try_at(b, Dual64::from(stations[first + 1]));
        try_at(c, Dual64::from(stations[first + 2]));
        // b + slope s + curvature s^2 has its vertex inside the element.
        if sign * curvature.re < 0.0 && slope.re.abs() < 2.0 * curvature.re.abs() {
            let s = -slope / (curvature * 2.0);
            try_at(b + slope * s * 0.5, s * half + stations[first + 1]);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extremum_of_a_parabola_is_found_between_the_nodes() {
        let stations: Vec<f64> = (0..7).map(f64::from).collect();
        let values: Vec<_> = stations.iter().map(|x| Dual64::from((x - 2.6).powi(2) + 1.0)).collect();
        let (value, place) = extremum(&values, &stations, -1.0);
        assert!((value.re - 1.0).abs() < 1e-12 && (place.re - 2.6).abs() < 1e-12);
        let (value, place) = extremum(&values, &stations, 1.0);
        assert_eq!((value.re, place.re), (values[6].re, 6.0));
    }

    #[test]
    fn stations_are_symmetric_and_ascend() {
        let x = profile_stations(8e-3);
        assert_eq!(x.len(), STATIONS);
        assert!(x.windows(2).all(|w| w[0] < w[1]));
        assert_eq!((x[0], x[50], x[100]), (-8e-3, 0.0, 8e-3));
    }
}
