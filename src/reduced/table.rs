//! Interpolation between solved states: bicubic Hermite polynomials on a grid of penetration depths and sliding speeds.
//!
//! The grid lines of the speeds are equidistant in no coordinate but interpolated in ln U, because films and loads go with powers
//! of U. Those of the depths follow first touch, d_c(U): one patch ends there and another begins, so that no cell has the kink of
//! first touch inside. With [d_0, d_1] the depths of the table,
//!
//! ```text
//! film     d = d_0 + s (d_c - d_0)      contact  d = d_c + s (d_1 - d_c),     0 <= s <= 1
//! ```
//!
//! Quantities that are positive in all states are interpolated as logarithms. Slopes by d and U are the tangents of
//! the full model; mixed second derivatives are differences of those.

use serde::{Deserialize, Serialize};

use crate::outputs::{Outputs, STATIONS};

/// Number of interpolated scalars: see [`primitives`].
pub const SCALARS: usize = 14;
/// Number of interpolated quantities: scalars, and three profiles.
pub const QUANTITIES: usize = SCALARS + 3 * STATIONS;

/// Where in a state some scalars are.
pub mod place {
    /// Load on the fluid.
    pub const FLUID_LOAD: usize = 0;
    /// Load on the solid.
    pub const SOLID_LOAD: usize = 1;
    /// The fluid's friction on the upper body, per unit depth.
    pub const UPPER_FRICTION: usize = 2;
    /// The fluid's friction on the lower body, per unit depth.
    pub const LOWER_FRICTION: usize = 3;
    /// Least film thickness.
    pub const MINIMUM_FILM: usize = 4;
    /// Where it is.
    pub const MINIMUM_FILM_POSITION: usize = 5;
    /// Film thickness in the middle.
    pub const CENTRAL_FILM: usize = 6;
    /// Length of solid contact.
    pub const CONTACT_LENGTH: usize = 7;
    /// Largest fluid pressure.
    pub const MAXIMUM_FLUID_PRESSURE: usize = 8;
    /// Smallest fluid pressure.
    pub const MINIMUM_FLUID_PRESSURE: usize = 9;
    /// Largest contact pressure.
    pub const MAXIMUM_CONTACT_PRESSURE: usize = 10;
    /// Largest von Mises stress.
    pub const VON_MISES: usize = 11;
    /// Fluid that leaves the tissue.
    pub const EXUDATION: usize = 12;
    /// The same less what it takes in.
    pub const NET_EXUDATION: usize = 13;
}

/// All quantities of a state, and their derivatives by penetration depth, sliding speed and slide-to-roll ratio.
pub type State = [[f64; QUANTITIES]; 4];

/// What is interpolated of outputs: the rest follows from it. `boundary_friction` is the part of the friction forces, per unit
/// depth, that is not interpolated because it is known from the solid load.
pub fn primitives(outputs: &Outputs, boundary_friction: f64, width: f64) -> [f64; QUANTITIES] {
    let o = outputs;
    let scalars: [f64; SCALARS] = [
        o.fluid_load,
        o.solid_load,
        o.upper_friction_force / width - boundary_friction,
        o.lower_friction_force / width - boundary_friction,
        o.minimum_film_thickness,
        o.minimum_film_position,
        o.central_film_thickness,
        o.contact_length,
        o.maximum_fluid_pressure,
        o.minimum_fluid_pressure,
        o.maximum_contact_pressure,
        o.maximum_von_mises_stress,
        o.fluid_exudation,
        o.net_fluid_exudation,
    ];
    let profiles = [&o.film_thickness, &o.fluid_pressure, &o.contact_pressure];
    let mut all = scalars.iter().chain(profiles.into_iter().flatten());
    std::array::from_fn(|_| all.next().copied().unwrap_or(0.0))
}

/// The state with x and U reversed; the derivative by U is then that by the reversed speed.
pub fn mirrored(state: &State) -> State {
    let mut result = *state;
    for values in &mut result {
        for place in [place::UPPER_FRICTION, place::LOWER_FRICTION, place::MINIMUM_FILM_POSITION] {
            values[place] = -values[place];
        }
        values[SCALARS..].chunks_exact_mut(STATIONS).for_each(<[f64]>::reverse);
    }
    result
}

/// Slope at point `i` of the parabola through it and its neighbours; at an end, through the last three points.
fn slope(x: &[f64], y: impl Fn(usize) -> f64, i: usize) -> f64 {
    let last = x.len() - 1;
    if last == 0 {
        return 0.0;
    }
    let rise = |k: usize| (y(k + 1) - y(k)) / (x[k + 1] - x[k]);
    if last == 1 {
        return rise(0);
    }
    let middle = i.clamp(1, last - 1);
    let curvature = (rise(middle) - rise(middle - 1)) / (x[middle + 1] - x[middle - 1]);
    rise(middle - 1) + curvature * (2.0 * x[i] - x[middle - 1] - x[middle])
}

/// Weights of value and slope at the two ends of an interval: for the value of a cubic, and for its derivative.
struct Cubic {
    first: usize,
    value: [[f64; 2]; 2],
    slope: [[f64; 2]; 2],
    /// Place in the interval, from 0 to 1.
    fraction: f64,
}

impl Cubic {
    /// At a place on the axis; beyond its ends the last cubic goes on.
    fn at(axis: &[f64], place: f64) -> Self {
        let first = axis.partition_point(|x| *x <= place).saturating_sub(1).min(axis.len() - 2);
        let width = axis[first + 1] - axis[first];
        let t = (place - axis[first]) / width;
        Self {
            first,
            value: [
                [(1.0 + 2.0 * t) * (1.0 - t).powi(2), t * (1.0 - t).powi(2) * width],
                [t * t * (3.0 - 2.0 * t), t * t * (t - 1.0) * width],
            ],
            slope: [
                [6.0 * t * (t - 1.0) / width, (1.0 - t) * (1.0 - 3.0 * t)],
                [6.0 * t * (1.0 - t) / width, t * (3.0 * t - 2.0)],
            ],
            fraction: t,
        }
    }
}

/// Which part of the plane of depth and speed a patch covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Side {
    /// The solids do not touch.
    Film,
    /// They do.
    Contact,
}

/// The curved coordinates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Chart {
    /// Least and largest depth of the table [m].
    pub depths: [f64; 2],
    /// Grid lines: logarithms of speeds, ascending.
    pub log_speeds: Vec<f64>,
    /// Depth of first touch on those lines [m]; empty where the patch covers all depths.
    pub touch: Vec<f64>,
}

/// A depth, and its derivatives by the coordinate s and by ln U.
#[derive(Clone, Copy)]
pub struct Depth {
    /// The depth [m].
    pub value: f64,
    /// By s [m].
    pub by_station: f64,
    /// By ln U, s being kept [m].
    pub by_log_speed: f64,
}

impl Chart {
    /// Depth of first touch and its derivative by ln U; `None` where it is not in the table.
    pub fn touch(&self, log_speed: f64) -> Option<[f64; 2]> {
        if self.touch.is_empty() {
            return None;
        }
        let cubic = Cubic::at(&self.log_speeds, log_speed);
        let mut result = [0.0; 2];
        for end in 0..2 {
            let i = cubic.first + end;
            let slope = slope(&self.log_speeds, |k| self.touch[k], i);
            result[0] += cubic.value[end][0] * self.touch[i] + cubic.value[end][1] * slope;
            result[1] += cubic.slope[end][0] * self.touch[i] + cubic.slope[end][1] * slope;
        }
        Some(result)
    }

    /// The depth at a place of a patch.
    pub fn depth(&self, side: Side, station: f64, log_speed: f64) -> Depth {
        let [least, most] = self.depths;
        match (side, self.touch(log_speed)) {
            (_, None) => Depth { value: least + station * (most - least), by_station: most - least, by_log_speed: 0.0 },
            (Side::Film, Some([touch, slope])) => Depth {
                value: least + station * (touch - least),
                by_station: touch - least,
                by_log_speed: station * slope,
            },
            (Side::Contact, Some([touch, slope])) => Depth {
                value: touch + station * (most - touch),
                by_station: most - touch,
                by_log_speed: (1.0 - station) * slope,
            },
        }
    }

    /// On which side a depth is, and where there.
    pub fn station(&self, only: Side, depth: f64, log_speed: f64) -> (Side, f64) {
        let side = match self.touch(log_speed) {
            None => only,
            Some([touch, _]) if depth <= touch => Side::Film,
            Some(_) => Side::Contact,
        };
        let start = self.depth(side, 0.0, log_speed);
        (side, (depth - start.value) / start.by_station)
    }
}

/// The states of one side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Grid {
    /// Which side.
    pub side: Side,
    /// Grid lines of the coordinate s, from 0 to 1.
    pub stations: Vec<f64>,
    /// Speed by speed and station by station: quantities, and their derivatives by depth, speed and slide-to-roll ratio.
    pub states: Vec<f32>,
}

/// Values in a state's block.
const BLOCK: usize = 4 * QUANTITIES;

impl Grid {
    /// Whether there are as many numbers as the grid needs.
    pub fn fits(&self, chart: &Chart) -> bool {
        self.stations.len() >= 2 && self.states.len() == self.stations.len() * chart.log_speeds.len() * BLOCK
    }

    /// Which of the stations is first touch.
    fn touch_column(&self, chart: &Chart) -> Option<usize> {
        let column = if self.side == Side::Film { self.stations.len() - 1 } else { 0 };
        (!chart.touch.is_empty()).then_some(column)
    }
}

/// The scalars that are positive in all states, on both sides.
pub fn positive(grids: &[Grid]) -> [bool; SCALARS] {
    let states = grids.iter().flat_map(|grid| grid.states.chunks_exact(BLOCK));
    std::array::from_fn(|q| states.clone().all(|state| state[q].is_normal() && state[q] > 0.0))
}

/// One side, ready to be evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// Which side.
    pub side: Side,
    stations: Vec<f64>,
    logarithmic: [bool; SCALARS],
    /// A state's block: quantities, and their derivatives by s, by ln U and by both; of logarithms where that is what is
    /// interpolated.
    nodes: Vec<f32>,
    /// Derivatives by the slide-to-roll ratio.
    by_ratio: Vec<f32>,
}

impl Patch {
    /// From the states of a grid, which fits the chart; with which scalars are interpolated as logarithms.
    pub fn new(grid: &Grid, chart: &Chart, logarithmic: [bool; SCALARS]) -> Self {
        let columns = grid.stations.len();
        let mut nodes = vec![0.0; grid.states.len()];
        for (index, (node, state)) in nodes.chunks_exact_mut(BLOCK).zip(grid.states.chunks_exact(BLOCK)).enumerate() {
            let log_speed = chart.log_speeds[index / columns];
            let depth = chart.depth(grid.side, grid.stations[index % columns], log_speed);
            for q in 0..QUANTITIES {
                let [value, by_depth, by_speed] = [0, 1, 2].map(|k| f64::from(state[k * QUANTITIES + q]));
                let logarithmic = q < SCALARS && logarithmic[q];
                let scale = if logarithmic { 1.0 / value } else { 1.0 };
                node[q] = if logarithmic { value.ln() } else { value } as f32;
                node[QUANTITIES + q] = (scale * by_depth * depth.by_station) as f32;
                node[2 * QUANTITIES + q] =
                    (scale * (by_speed * log_speed.exp() + by_depth * depth.by_log_speed)) as f32;
            }
        }
        let at = |nodes: &[f32], line: usize, column: usize, k: usize, q: usize| {
            f64::from(nodes[(line * columns + column) * BLOCK + k * QUANTITIES + q])
        };
        for q in 0..QUANTITIES {
            for index in 0..nodes.len() / BLOCK {
                let (line, column) = (index / columns, index % columns);
                let hops = HOPPING.contains(&q);
                if hops {
                    let by_station = slope(&grid.stations, |k| at(&nodes, line, k, 0, q), column);
                    nodes[index * BLOCK + QUANTITIES + q] = by_station as f32;
                }
                // Along first touch both sides have the same values, and so they get the same slopes.
                if hops || Some(column) == grid.touch_column(chart) {
                    let by_log_speed = slope(&chart.log_speeds, |k| at(&nodes, k, column, 0, q), line);
                    nodes[index * BLOCK + 2 * QUANTITIES + q] = by_log_speed as f32;
                }
            }
        }
        for row in nodes.chunks_exact_mut(columns * BLOCK) {
            for i in 0..columns {
                for q in 0..QUANTITIES {
                    let by_log_speed = |k: usize| at(row, 0, k, 2, q);
                    let mixed = slope(&grid.stations, by_log_speed, i);
                    row[i * BLOCK + 3 * QUANTITIES + q] = mixed as f32;
                }
            }
        }
        let by_ratio = grid.states.chunks_exact(BLOCK).flat_map(|s| s[3 * QUANTITIES..].iter().copied()).collect();
        Self { side: grid.side, stations: grid.stations.clone(), logarithmic, nodes, by_ratio }
    }

    /// The state at a station and a speed.
    pub fn state(&self, chart: &Chart, station: f64, log_speed: f64) -> State {
        let (s, u) = (Cubic::at(&self.stations, station), Cubic::at(&chart.log_speeds, log_speed));
        let mut state = [[0.0; QUANTITIES]; 4];
        for (line, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let index = (u.first + line) * self.stations.len() + s.first + column;
            let node = &self.nodes[index * BLOCK..(index + 1) * BLOCK];
            for (kind, values) in node.chunks_exact(QUANTITIES).enumerate() {
                let (along, across) = (kind % 2, kind / 2);
                let (in_s, in_u) = (s.value[column][along], u.value[line][across]);
                let weights = [in_s * in_u, s.slope[column][along] * in_u, in_s * u.slope[line][across]];
                for (sums, weight) in state.iter_mut().zip(weights) {
                    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * f64::from(*value));
                }
            }
            // The full model gives no slopes of these.
            let share = |fraction: f64, end: usize| if end == 0 { 1.0 - fraction } else { fraction };
            let weight = share(u.fraction, line) * share(s.fraction, column);
            let values = &self.by_ratio[index * QUANTITIES..(index + 1) * QUANTITIES];
            state[3].iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * f64::from(*value));
        }
        let depth = chart.depth(self.side, station, log_speed);
        let speed = log_speed.exp();
        let [values, by_depth, by_speed, by_ratio] = &mut state;
        for q in 0..QUANTITIES {
            if q < SCALARS && self.logarithmic[q] {
                values[q] = values[q].exp();
                by_depth[q] *= values[q];
                by_speed[q] *= values[q];
            }
            by_depth[q] /= depth.by_station;
            by_speed[q] = (by_speed[q] - by_depth[q] * depth.by_log_speed) / speed;
            if NEVER_NEGATIVE[q] && values[q] < 0.0 {
                [values[q], by_depth[q], by_speed[q], by_ratio[q]] = [0.0; 4];
            }
        }
        state
    }
}

/// Extrema and lengths: with the state they hop from one element of the mesh to the next, and their tangents are those between two
/// hops. Differences between states serve better as slopes.
const HOPPING: [usize; 5] = [
    place::MINIMUM_FILM,
    place::MINIMUM_FILM_POSITION,
    place::CONTACT_LENGTH,
    place::MINIMUM_FLUID_PRESSURE,
    place::MAXIMUM_CONTACT_PRESSURE,
];

/// Quantities that a cubic may carry below zero where they end.
const NEVER_NEGATIVE: [bool; QUANTITIES] = {
    let mut never = [false; QUANTITIES];
    let scalars = [
        place::SOLID_LOAD,
        place::MINIMUM_FILM,
        place::CENTRAL_FILM,
        place::CONTACT_LENGTH,
        place::MAXIMUM_CONTACT_PRESSURE,
    ];
    let mut i = 0;
    while i < scalars.len() {
        never[scalars[i]] = true;
        i += 1;
    }
    let mut i = 0;
    while i < STATIONS {
        never[SCALARS + i] = true;
        never[SCALARS + 2 * STATIONS + i] = true;
        i += 1;
    }
    never
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_has_its_slopes() {
        let x = [0.0, 1.0, 3.0, 4.5];
        for (i, x_i) in x.iter().enumerate() {
            assert!((slope(&x, |k| x[k] * x[k] - x[k], i) - (2.0 * x_i - 1.0)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_cubic_is_reproduced_with_its_derivative() {
        let (f, g) = (|x: f64| x.powi(3) - 2.0 * x, |x: f64| 3.0 * x * x - 2.0);
        let axis = [-1.0, 0.5, 2.0];
        for place in [-1.0, -0.3, 0.5, 1.9, 2.0] {
            let cubic = Cubic::at(&axis, place);
            let sum = |weights: &[[f64; 2]; 2]| -> f64 {
                (0..2)
                    .map(|end| (end, axis[cubic.first + end]))
                    .map(|(e, x)| weights[e][0] * f(x) + weights[e][1] * g(x))
                    .sum()
            };
            assert!((sum(&cubic.value) - f(place)).abs() < 1e-12 && (sum(&cubic.slope) - g(place)).abs() < 1e-12);
        }
    }

    #[test]
    fn depths_and_stations_are_inverse_and_their_derivatives_agree() {
        let chart = Chart { depths: [-2.0, 6.0], log_speeds: vec![0.0, 1.0, 2.5], touch: vec![0.2, 1.0, 3.0] };
        for (side, s) in [(Side::Film, 0.0), (Side::Film, 0.4), (Side::Contact, 0.1), (Side::Contact, 1.0)] {
            let u = 1.3;
            let depth = chart.depth(side, s, u);
            let (found, station) = chart.station(Side::Film, depth.value, u);
            assert!(found == side && (station - s).abs() < 1e-12);
            let difference = |du: f64, ds: f64| chart.depth(side, s + ds, u + du).value;
            assert!((depth.by_station - (difference(0.0, 1e-6) - difference(0.0, -1e-6)) / 2e-6).abs() < 1e-8);
            assert!((depth.by_log_speed - (difference(1e-6, 0.0) - difference(-1e-6, 0.0)) / 2e-6).abs() < 1e-8);
        }
    }
}
