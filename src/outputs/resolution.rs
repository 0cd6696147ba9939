//! Whether mesh and sector are good enough for a solution, by signs that cost nothing.

use num_dual::Dual64;

use super::{Outputs, resistance};
use crate::equations::grid;
use crate::equations::system::{Change, Solved};
use crate::parameters::{Body, Control, Formulation, Mesh, Parameters};

/// What can be said of a solution's resolution.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Resolution {
    /// Estimated error of the load by the mesh, relative to the integral of the pressures' magnitude.
    pub load_error: f64,
    /// Estimated error of the least film thickness by the mesh, relative to it.
    pub film_error: f64,
    /// Estimated error of the friction by the mesh, relative to the larger of the two friction forces.
    pub friction_error: f64,
    /// What is not resolved, one sentence each with what to do.
    pub warnings: Vec<String>,
}

/// An estimated error of the load or the film above this is worth a warning; that of the film is between a third and three times the difference
/// from twice the mesh in random cases.
const LARGE_ERROR: f64 = 0.02;
/// Pressure at an end of the sector over the largest one that is worth one.
const LARGE_END: f64 = 0.03;
/// And of the friction: of 48 random cases six were 4 % off and more, and five of these are above it; all others are below 0.01. Of 20 with smooth surfaces
/// that touch and slide 16 were 3 % off and more, and are above it; the others are below 0.02.
const LARGE_FRICTION_ERROR: f64 = 0.03;
/// Difference of the power of the forces on the bones and of what their tissue feels over what friction takes, and of power that goes nowhere over what
/// takes some, that is worth one.
const LARGE_POWER_ERROR: f64 = 0.1;
/// Distance along the surfaces of points that are paired, over the half-width of the interface, that is worth one: by
/// `the_load_does_not_depend_on_which_nodes_are_paired` half as much is off of the load.
const LARGE_MISMATCH: f64 = 0.03;
/// Friction below this fraction of the load is none.
const LEAST_FRICTION: f64 = 1e-5;
/// A film thinner than this is none \[m\].
const THINNEST_FILM: f64 = 1e-8;
/// Of the sector beyond where the pressure ends, in thicknesses, for 2 % of the load.
const LEAST_MARGIN: f64 = 2.5;
/// Time to drain over the time of passage above which the formulation `paper` does not say what is there.
const LARGE_PECLET: f64 = 100.0;
/// Stress over pressure that no contact has.
const LARGE_STRESS: f64 = 20.0;

impl Outputs {
    /// The case on a mesh by which these results can be judged: twice the columns, 1.6 times the rows and half more of a sector, as far
    /// as there is one, with as many columns more as that takes. It may be solved for six times as long.
    pub fn on_finer_mesh(&self, parameters: &Parameters) -> Parameters {
        let radius = |body: &Body| if body.outer_radius == 0.0 { f64::INFINITY } else { body.outer_radius.abs() };
        let radius = radius(&parameters.upper).min(radius(&parameters.lower));
        let widest = grid::LARGEST_ANGLE.sin() * radius * (1.0 - 1e-9);
        let half_width = (1.5 * self.mesh_half_width).min(widest);
        let wider = half_width / self.mesh_half_width;
        Parameters {
            sector_half_angle: (half_width / radius).asin(),
            mesh: Mesh {
                columns: (2.0 * wider.sqrt() * f64::from(self.mesh_columns)) as i32,
                rows: 8 * self.mesh_rows / 5,
                ..parameters.mesh
            },
            maximum_solve_time: 6.0 * parameters.maximum_solve_time,
            ..*parameters
        }
    }
}

impl Solved<'_> {
    /// Looks at pressures, stress and mesh of the solution.
    pub(super) fn resolution(&self, outputs: &Outputs) -> Resolution {
        let von_mises = outputs.maximum_von_mises_stress;
        let (system, p) = (self.system, self.system.parameters());
        let none = Change::none(system.unknowns(), system.stations.len());
        let levels = system.layers[0].mesh.levels();
        let fluid = |i: usize| self.state.unknowns.get(system.layout.pressure[0][i * levels] as usize).copied();
        let solid = system.contact_pressure(self.state, &none);
        // Ends of elements, where pressures of both orders have a value.
        let nodes: Vec<usize> = (0..system.stations.len()).step_by(2).collect();
        let pressure: Vec<f64> = nodes.iter().map(|i| fluid(*i).unwrap_or(0.0) + solid[*i].re).collect();
        let x: Vec<f64> = nodes.iter().map(|i| system.stations[*i]).collect();
        let largest = pressure.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        if largest == 0.0 {
            return Resolution::default();
        }
        // What straight lines leave out of the integral: curvature times length^3 / 12.
        let (mut left_out, mut carried) = (0.0, 0.0);
        for i in 1..x.len() - 1 {
            let [before, after] = [x[i] - x[i - 1], x[i + 1] - x[i]];
            let turn = (pressure[i + 1] - pressure[i]) / after - (pressure[i] - pressure[i - 1]) / before;
            let length = 0.5 * (before + after);
            left_out += turn.abs() * length * length / 12.0;
            carried += pressure[i].abs() * length;
        }
        let load_error = left_out / carried;
        let mut warnings = Vec::new();
        if load_error > LARGE_ERROR {
            warnings.push(format!(
                "the pressures bend so much from column to column that the load may be off by {:.0} %: more mesh.columns, or \
                 mesh.distribution = contact",
                100.0 * load_error
            ));
        }
        let film: Vec<f64> = system.film_gaps(self.state, &none).into_iter().map(|gap| gap.re).collect();
        // Where smooth surfaces touch the least thickness is none.
        let film_error = if self.state.touches() { 0.0 } else { film_error(&system.arc, &film) };
        if film_error > LARGE_ERROR {
            warnings.push(format!(
                "the film bends so much from column to column that its least thickness may be off by {:.0} %, and the film's \
                 friction likewise; load and depth are not concerned: more mesh.columns",
                100.0 * film_error
            ));
        }
        let consistent = p.formulation == Formulation::Consistent;
        let ends = [pressure[0], pressure[pressure.len() - 1]];
        let law = system.contact_law();
        let touching =
            [nodes[0], nodes[nodes.len() - 1]].map(|i| law.touches(self.state.active[i], self.state.gap(system, i)));
        let pressing = |i: &usize| pressure[*i].abs() > LARGE_END * largest;
        let outermost = (0..x.len()).filter(pressing).map(|i| x[i].abs()).fold(0.0, f64::max);
        if touching.contains(&true) || ends.iter().any(|end| end.abs() > LARGE_END * largest) {
            warnings.push("contact or pressure reaches the end of the sector: a larger sector_half_angle, or 0 for a sector that goes with the contact".into());
        } else if system.half_width() - outermost < LEAST_MARGIN * system.thickness() {
            warnings.push("the sector ends within 2.5 thicknesses of where the pressure ends: depth and load may be off by some per cent, at one thickness by a fifth; a larger sector_half_angle, or 0 for a sector that goes with the contact (1.05 rad at most: wider contacts are beyond this model)".into());
        }
        for (layer, speed) in system.layers.iter().zip(self.state.inputs.surface_speeds()).filter(|_| !consistent) {
            let body = if layer.side > 0.0 { &p.upper } else { &p.lower };
            let consolidation = p.hydraulic_permeability(body) * body.surface_aggregate_modulus();
            let passage = 2.0 * system.half_width() / speed.abs();
            if body.thickness.powi(2) > LARGE_PECLET * consolidation * passage {
                warnings.push(
                    "formulation paper leaves open in what state tissue enters that does not drain while it passes: at this permeability and speed the \
                     load may be off by a tenth and more, and depends on sector and mesh; formulation consistent says it"
                        .into(),
                );
                break;
            }
        }
        if von_mises > LARGE_STRESS * largest {
            warnings.push(format!(
                "the stress of the tissue, {von_mises:.2e} Pa, is far above every pressure: refine the mesh, or widen the sector"
            ));
        }
        let inputs = &self.state.inputs;
        if consistent
            && self.state.rates.is_none()
            && inputs.penetration_depth > 1e-6
            && pressure.iter().sum::<f64>() < 0.0
        {
            warnings.push("bodies that are pressed together pull at each other: refine the mesh".into());
        }
        let pressed: Vec<f64> = x.iter().zip(&pressure).filter(|(_, p)| **p > 0.1 * largest).map(|(x, _)| *x).collect();
        let length = pressed.last().zip(pressed.first()).map_or(0.0, |(b, a)| b - a);
        let least = film.iter().copied().fold(f64::INFINITY, f64::min);
        for (layer, speed) in system.layers.iter().zip(inputs.surface_speeds()).filter(|(_, speed)| *speed != 0.0) {
            let row = layer.surface_row();
            let body = if layer.side > 0.0 { &p.upper } else { &p.lower };
            let modulus = body.surface_aggregate_modulus();
            let depth = (layer.tissue.at_depth(0.0).mobility * modulus * length / speed.abs()).sqrt();
            // Where that layer takes up less fluid than the film holds it does not matter.
            if consistent && row > depth && depth * largest / modulus > 0.1 * least {
                warnings.push(format!(
                    "fluid flows within {:.1e} m below the surface, and the uppermost elements are {row:.1e} m thick: more mesh.rows, a \
                     stronger mesh.row_grading, or mesh.distribution = contact",
                    depth
                ));
                break;
            }
        }
        let fluid: Vec<f64> = nodes.iter().map(|i| fluid(*i).unwrap_or(0.0)).collect();
        let [rolling, boundary] = friction_errors(self, &film, &fluid, outputs);
        let friction_error = rolling + boundary;
        if friction_error > LARGE_FRICTION_ERROR && boundary > rolling {
            warnings.push(format!(
                "the film closes within a column where smooth surfaces begin to touch, and what fluid their tissue gives or takes there depends on the mesh: \
                 what the solids carry, and with it boundary friction, may be off by {:.0} % of all friction: more mesh.columns, or a \
                 surface_roughness",
                100.0 * friction_error
            ));
        } else if friction_error > LARGE_FRICTION_ERROR {
            let least = if system.film().rough.is_some() { ", its least thickness by some per cent" } else { "" };
            warnings.push(format!(
                "the film changes so much from column to column where the pressure falls that its rolling friction may be off by {:.0} % of all \
                 friction{least}; load, sliding and boundary friction are not concerned: more mesh.columns",
                100.0 * friction_error
            ));
        }
        let lost = outputs.film_dissipation + outputs.boundary_friction_dissipation;
        let [depth, force, moment] =
            [outputs.penetration_depth, outputs.upper_force_x, outputs.upper_moment].map(Dual64::from);
        let bones = [0, 1].map(|body| resistance(p, body, depth, force, moment).re);
        let passed_on = bones[0] * inputs.surface_speeds()[0] + bones[1] * inputs.surface_speeds()[1];
        let power_error = (passed_on - outputs.rotation_power).abs() / lost;
        if consistent && power_error > LARGE_POWER_ERROR {
            warnings.push(format!(
                "points that face each other before they deform are paired, and move apart along the surfaces: forces along x and moments on the \
                 bones may be off by some {:.0} % of friction; rough surfaces of two layers are paired as they are deformed",
                100.0 * power_error
            ));
        }
        // What the turning bones put in and nothing takes; in time something stores it.
        let taken = lost + outputs.pore_flow_dissipation + outputs.carried_power;
        let least = LEAST_FRICTION * (outputs.normal_force * inputs.sliding_speed).abs();
        let unaccounted = (outputs.rotation_power - taken).abs() / taken.abs().max(least);
        if consistent && self.state.rates.is_none() && unaccounted > LARGE_POWER_ERROR {
            warnings.push(format!(
                "{:.0} % of the power that the turning bones put in goes nowhere: moments on the bones and rotation_power may be off by as much, a \
                 friction coefficient of {:.0e}: more mesh.columns",
                100.0 * unaccounted,
                (outputs.rotation_power - taken).abs() / (outputs.normal_force * inputs.sliding_speed).abs()
            ));
        }
        let rise = system.neglected_rise(self.state).abs();
        if consistent && rise > LARGE_ERROR * inputs.penetration_depth.abs() && rise > THINNEST_FILM {
            warnings.push(format!(
                "points that face each other before they deform are paired, and move apart along sloping surfaces: the depth may be off by some \
                 {rise:.1e} m, a given depth's load accordingly; rough surfaces of two layers are paired as they are deformed"
            ));
        }
        let mismatch = if system.pairs_deformed() { system.mismatch(self.state) } else { 0.0 };
        if mismatch > LARGE_MISMATCH {
            warnings.push(format!(
                "points that are paired are {:.1e} m apart along the surfaces: load and depth may be off by some {:.0} %; the mesh follows in shorter \
                 communication steps, or to a steady state nearby",
                mismatch * system.half_width(),
                50.0 * mismatch
            ));
        }
        if grid::moves(p) {
            // In time the mesh goes with the depth.
            let control = if self.state.rates.is_some() { Control::Depth } else { p.control };
            let ratio = grid::contact_half_width(p, inputs, control) / system.contact_half_width();
            if !(0.7..=1.4).contains(&ratio) {
                warnings.push(format!(
                    "the mesh is made for a contact {:.1} times as wide as the present one: start nearer to it",
                    1.0 / ratio
                ));
            }
        }
        Resolution { load_error, film_error, friction_error, warnings }
    }
}

/// Kink of the film at every end between two elements, and its curvature within one, as changes of thickness over an element \[m\]. A quarter of the smaller
/// is what the interpolation of the film may leave out: each is large alone where a film is flat at rest or bends evenly.
fn kinks_and_bends<'a>(arc: &'a [f64], film: &'a [f64]) -> impl Iterator<Item = (usize, [f64; 2])> + 'a {
    (2..film.len() - 2).step_by(2).map(move |i| {
        let lengths = [i - 2, i].map(|first| 0.5 * (arc[first + 2] - arc[first]));
        // Of the parabolas to both sides.
        let slopes = [
            (1.5 * film[i] - 2.0 * film[i - 1] + 0.5 * film[i - 2]) / lengths[0],
            (2.0 * film[i + 1] - 1.5 * film[i] - 0.5 * film[i + 2]) / lengths[1],
        ];
        let kink = (slopes[1] - slopes[0]) * lengths[0].max(lengths[1]);
        let bend = film[i - 1] - 2.0 * film[i] + film[i + 1];
        (i, [kink.abs(), bend.abs()])
    })
}

/// What that leaves open of the least thickness, where the film is nearly as thin and at the ends of the column in which it is thinnest.
fn film_error(arc: &[f64], film: &[f64]) -> f64 {
    let thinnest = (0..film.len()).min_by(|a, b| film[*a].total_cmp(&film[*b])).unwrap_or(0);
    let least = film[thinnest].max(THINNEST_FILM);
    let thin = kinks_and_bends(arc, film).filter(|(i, _)| film[*i] < 1.3 * least || i.abs_diff(thinnest) == 1);
    let [kink, bend] = thin.fold([0.0; 2], |[a, b]: [f64; 2], (_, [kink, bend])| [a.max(kink), b.max(bend)]);
    0.25 * kink.min(bend) / least
}

/// What is left open of the film's rolling friction and of boundary friction, over all friction. Surfaces at rest have no rolling friction.
fn friction_errors(solved: &Solved<'_>, film: &[f64], fluid_pressure: &[f64], outputs: &Outputs) -> [f64; 2] {
    if solved.state.inputs.surface_speeds() == [0.0; 2] {
        return [0.0; 2];
    }
    let friction = outputs.upper_friction_force.abs().max(outputs.lower_friction_force.abs());
    let least = LEAST_FRICTION * outputs.normal_force.abs();
    let relative = |error: f64| error * solved.system.parameters().width / friction.max(least);
    // More than all of it says nothing.
    [relative(rolling_friction_error(solved, film, fluid_pressure)), relative(boundary_friction_error(solved)).min(1.0)]
}

/// What kinks and bends leave open of the film's rolling friction, int h/2 dp \[N/m\]. The upstream weight of a thin film between rough surfaces moves
/// its thickness besides, by up to half of what it changes over a column.
fn rolling_friction_error(solved: &Solved<'_>, film: &[f64], fluid_pressure: &[f64]) -> f64 {
    let gap = |i: usize| film[2 * i];
    let fall = |i: usize| (fluid_pressure[i + 1] - fluid_pressure[i]).abs();
    let by_shape: f64 = kinks_and_bends(&solved.system.arc, film)
        .map(|(i, [kink, bend])| 0.25 * kink.min(bend) * 0.25 * (fall(i / 2 - 1) + fall(i / 2)))
        .sum();
    let by_weight: f64 = solved.system.film().rough.map_or(0.0, |(roughness, _)| {
        let thin = (0..fluid_pressure.len() - 1).filter(|i| gap(*i).max(gap(*i + 1)) < 10.0 * roughness.rms);
        thin.map(|i| 0.25 * (gap(i + 1) - gap(i)).abs() * fall(i)).sum()
    });
    by_shape + by_weight
}

/// What the edges at which smooth surfaces begin to touch leave open of boundary friction \[N/m\].
///
/// The film closes somewhere within a column there, and at the end that is closed its open part still gives and takes fluid. Tissue that hardly drains
/// carries what it lost through all of the contact, spread to the depth sqrt(pi k M x/v) at the distance x from the edge: a flux q changes the pressure of
/// the solids by M q/v over that depth, and their load by M q l/v over half the depth at the length l of the contact. Elements do not know less than half
/// of their height. Two bodies have both flux and pressure in common.
fn boundary_friction_error(solved: &Solved<'_>) -> f64 {
    let (system, state) = (solved.system, solved.state);
    let active = &state.active;
    let ends = (0..active.len()).find(|i| active[*i]).zip((0..active.len()).rfind(|i| active[*i]));
    let Some((first, last)) = ends.filter(|_| system.parameters().formulation == Formulation::Consistent) else {
        return 0.0;
    };
    // Flux over load of both bodies.
    let uptake = |length: f64| -> f64 {
        let layers = system.layers.iter().zip(state.inputs.surface_speeds()).map(|(layer, speed)| {
            let tissue = layer.tissue.at_depth(0.0);
            let (modulus, rate) = (tissue.solid.aggregate_modulus(), speed.abs() / length);
            let depth_rate = (std::f64::consts::PI * tissue.mobility * modulus * rate).sqrt();
            0.5 * depth_rate.max(layer.surface_row() * rate) / modulus
        });
        layers.sum()
    };
    let change = (0..active.len() / 2).map(|column| {
        let (start, end) = (2 * column, 2 * column + 2);
        let (open, closed, length) = match state.inputs.sliding_speed > 0.0 {
            true => (start, end, system.stations[last] - system.stations[start]),
            false => (end, start, system.stations[end] - system.stations[first]),
        };
        match active[closed] && !active[open] {
            true => system.exchange_in_contact(state, column).abs() / uptake(length),
            false => 0.0,
        }
    });
    let friction = [first, last].map(|station| system.station_friction(station, state).abs());
    friction[0].max(friction[1]) * change.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_whose_ends_are_thicker_than_its_middle_counts() {
        let arc: Vec<f64> = (0..9).map(|i| 1e-4 * f64::from(i)).collect();
        let film = [3.0, 2.9, 2.8, 2.7, 2.6, 1.0, 2.6, 2.7, 2.8].map(|microns| 1e-6 * microns);
        // Bends of 1.5 microns at its ends, and sharper kinks.
        assert!((film_error(&arc, &film) - 0.25 * 1.5).abs() < 1e-9, "{}", film_error(&arc, &film));
        let even = arc.iter().map(|x| 1e-6 + x * x).collect::<Vec<_>>();
        assert!(film_error(&arc, &even) < 1e-9);
    }
}
