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
//!
//! Between rest and the slowest line, U_s, ln U is of no use. With U and x reversed a state is its mirror image, so what is kept by
//! that changes with even powers of U, and what changes sign with odd ones. With w = U/U_s,
//!
//! ```text
//! even  q = q_0 + a w^2 + b w^4      odd  q = a w + b w^3
//! ```
//!
//! in which q_0 is the state at rest, and a and b follow from value and slope at U_s; first touch is even. Extrema of fields that
//! vanish at rest have a kink there, q = q_0 + a |w| + b w^2.

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

/// The quantities, or a derivative of them, with x and U reversed. In contact the place of the least film is the first place that
/// touches, the last one in the mirror.
pub fn mirrored(values: &[f64; QUANTITIES]) -> [f64; QUANTITIES] {
    let mut result = *values;
    for place in [place::UPPER_FRICTION, place::LOWER_FRICTION] {
        result[place] = -values[place];
    }
    result[place::MINIMUM_FILM_POSITION] = -(values[place::MINIMUM_FILM_POSITION] + values[place::CONTACT_LENGTH]);
    result[SCALARS..].chunks_exact_mut(STATIONS).for_each(<[f64]>::reverse);
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

/// How a quantity between rest and the slowest line depends on the change from rest to that line and on its slope there, by w:
/// weights of both for the value, and for its derivative by w.
type Shares = [[f64; 2]; 2];

fn even(w: f64) -> Shares {
    [[w * w * (2.0 - w * w), 0.5 * w * w * (w * w - 1.0)], [4.0 * w * (1.0 - w * w), w * (2.0 * w * w - 1.0)]]
}

fn odd(w: f64) -> Shares {
    [[0.5 * w * (3.0 - w * w), 0.5 * w * (w * w - 1.0)], [1.5 * (1.0 - w * w), 0.5 * (3.0 * w * w - 1.0)]]
}

fn kinked(w: f64) -> Shares {
    [[w * (2.0 - w), w * (w - 1.0)], [2.0 * (1.0 - w), 2.0 * w - 1.0]]
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
    /// The same at rest (0 where the patch covers all depths), in a table that goes down to rest.
    pub rest: Option<f64>,
}

/// A depth, and its derivatives by the coordinate s and by U.
#[derive(Clone, Copy)]
pub struct Depth {
    /// The depth [m].
    pub value: f64,
    /// By s [m].
    pub by_station: f64,
    /// By U, s being kept [s].
    pub by_speed: f64,
}

impl Chart {
    /// The speed of the slowest line [m/s].
    pub fn slowest(&self) -> f64 {
        self.log_speeds[0].exp()
    }

    /// Slope by ln U on a line, of what has the values `y` on the lines: that of a parabola, in U where it goes on to rest.
    fn slope(&self, rest: Option<f64>, y: impl Fn(usize) -> f64, line: usize) -> f64 {
        match rest {
            Some(rest) if line == 0 => {
                let speeds = [0.0, self.slowest(), self.log_speeds[1].exp()];
                speeds[1] * slope(&speeds, |k| if k == 0 { rest } else { y(k - 1) }, 1)
            }
            _ => slope(&self.log_speeds, y, line),
        }
    }

    /// The part of the way from rest to the slowest line at a speed, where it is between them; and first touch at rest.
    fn near_rest(&self, speed: f64) -> Option<(f64, f64)> {
        self.rest.filter(|_| speed < self.slowest()).map(|touch| (speed / self.slowest(), touch))
    }

    /// Depth of first touch at a speed of 0 or more and its derivative by U; `None` where it is not in the table.
    pub fn touch(&self, speed: f64) -> Option<[f64; 2]> {
        if self.touch.is_empty() {
            return None;
        }
        let near_rest = self.near_rest(speed);
        let cubic = Cubic::at(&self.log_speeds, near_rest.map_or(speed.ln(), |_| self.log_speeds[0]));
        let (mut value, mut by_log_speed) = (0.0, 0.0);
        for end in 0..2 {
            let i = cubic.first + end;
            let slope = self.slope(self.rest, |k| self.touch[k], i);
            value += cubic.value[end][0] * self.touch[i] + cubic.value[end][1] * slope;
            by_log_speed += cubic.slope[end][0] * self.touch[i] + cubic.slope[end][1] * slope;
        }
        let Some((w, rest)) = near_rest else {
            return Some([value, by_log_speed / speed]);
        };
        let [along, slope] = even(w).map(|[change, slope]| change * (value - rest) + slope * by_log_speed);
        Some([rest + along, slope / self.slowest()])
    }

    /// The depth at a place of a patch.
    pub fn depth(&self, side: Side, station: f64, speed: f64) -> Depth {
        let [least, most] = self.depths;
        match (side, self.touch(speed)) {
            (_, None) => Depth { value: least + station * (most - least), by_station: most - least, by_speed: 0.0 },
            (Side::Film, Some([touch, slope])) => {
                Depth { value: least + station * (touch - least), by_station: touch - least, by_speed: station * slope }
            }
            (Side::Contact, Some([touch, slope])) => Depth {
                value: touch + station * (most - touch),
                by_station: most - touch,
                by_speed: (1.0 - station) * slope,
            },
        }
    }

    /// On which side a depth is, and where there.
    pub fn station(&self, only: Side, depth: f64, speed: f64) -> (Side, f64) {
        let side = match self.touch(speed) {
            None => only,
            Some([touch, _]) if depth <= touch => Side::Film,
            Some(_) => Side::Contact,
        };
        let start = self.depth(side, 0.0, speed);
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
    /// The same at rest, station by station, in a table that goes down to rest.
    pub rest: Vec<f32>,
}

/// Values in a state's block.
const BLOCK: usize = 4 * QUANTITIES;

impl Grid {
    /// Whether there are as many numbers as the grid needs.
    pub fn fits(&self, chart: &Chart) -> bool {
        let line = self.stations.len() * BLOCK;
        self.stations.len() >= 2
            && self.states.len() == line * chart.log_speeds.len()
            && self.rest.len() == line * usize::from(chart.rest.is_some())
    }

    /// Which of the stations is first touch.
    fn touch_column(&self, chart: &Chart) -> Option<usize> {
        let column = if self.side == Side::Film { self.stations.len() - 1 } else { 0 };
        (!chart.touch.is_empty()).then_some(column)
    }
}

/// The scalars that are positive in all moving states, on both sides.
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
    /// At rest: quantities, and their derivatives by s and by the slide-to-roll ratio.
    rest: Vec<f32>,
}

/// Quantities, their derivatives by s, by ln U and by both, and by the slide-to-roll ratio.
type Local = [[f64; QUANTITIES]; 5];

impl Patch {
    /// From the states of a grid, which fits the chart; with which scalars are interpolated as logarithms.
    pub fn new(grid: &Grid, chart: &Chart, logarithmic: [bool; SCALARS]) -> Self {
        let columns = grid.stations.len();
        let mut nodes = vec![0.0; grid.states.len()];
        for (index, (node, state)) in nodes.chunks_exact_mut(BLOCK).zip(grid.states.chunks_exact(BLOCK)).enumerate() {
            let log_speed = chart.log_speeds[index / columns];
            let speed = log_speed.exp();
            let depth = chart.depth(grid.side, grid.stations[index % columns], speed);
            for q in 0..QUANTITIES {
                let [value, by_depth, by_speed] = [0, 1, 2].map(|k| f64::from(state[k * QUANTITIES + q]));
                let logarithmic = q < SCALARS && logarithmic[q];
                let scale = if logarithmic { 1.0 / value } else { 1.0 };
                node[q] = if logarithmic { value.ln() } else { value } as f32;
                node[QUANTITIES + q] = (scale * by_depth * depth.by_station) as f32;
                node[2 * QUANTITIES + q] = (scale * speed * (by_speed + by_depth * depth.by_speed)) as f32;
            }
        }
        let at = |nodes: &[f32], line: usize, column: usize, k: usize, q: usize| {
            f64::from(nodes[(line * columns + column) * BLOCK + k * QUANTITIES + q])
        };
        let rest = Self::at_rest(grid, chart);
        for q in 0..QUANTITIES {
            let has_rest = chart.rest.is_some() && !(q < SCALARS && logarithmic[q]);
            for index in 0..nodes.len() / BLOCK {
                let (line, column) = (index / columns, index % columns);
                let hops = HOPPING.contains(&q);
                if hops {
                    let by_station = slope(&grid.stations, |k| at(&nodes, line, k, 0, q), column);
                    nodes[index * BLOCK + QUANTITIES + q] = by_station as f32;
                }
                // Along first touch both sides have the same values, and so they get the same slopes.
                if hops || Some(column) == grid.touch_column(chart) {
                    let at_rest = has_rest.then(|| f64::from(rest[column * 3 * QUANTITIES + q]));
                    let by_log_speed = chart.slope(at_rest, |k| at(&nodes, k, column, 0, q), line);
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
        Self { side: grid.side, stations: grid.stations.clone(), logarithmic, nodes, by_ratio, rest }
    }

    /// The nodes at rest. A state at rest is its own mirror image.
    fn at_rest(grid: &Grid, chart: &Chart) -> Vec<f32> {
        let by_station = chart.depth(grid.side, 0.0, 0.0).by_station;
        let mut nodes = Vec::with_capacity(3 * grid.rest.len() / 4);
        for state in grid.rest.chunks_exact(BLOCK) {
            for (kind, scale) in [(0, 1.0), (1, by_station), (3, 1.0)] {
                let values: [f64; QUANTITIES] = std::array::from_fn(|q| f64::from(state[kind * QUANTITIES + q]));
                let mirror = mirrored(&values);
                // The ratio keeps its sign, as the quantities do.
                nodes.extend(values.iter().zip(mirror).map(|(a, b)| (0.5 * scale * (a + b)) as f32));
            }
        }
        let at = |nodes: &[f32], column: usize, q: usize| f64::from(nodes[column * 3 * QUANTITIES + q]);
        for column in 0..grid.rest.len() / BLOCK {
            for q in HOPPING {
                nodes[(column * 3 + 1) * QUANTITIES + q] = slope(&grid.stations, |k| at(&nodes, k, q), column) as f32;
            }
        }
        nodes
    }

    /// The state at a station and a speed of 0 or more.
    pub fn state(&self, chart: &Chart, station: f64, speed: f64) -> State {
        let [mut values, by_station, mut by_speed, mut by_ratio] = match chart.near_rest(speed) {
            Some((w, _)) => {
                self.near_rest(station, self.between(chart, station, chart.log_speeds[0]), w, chart.slowest())
            }
            None => {
                let [values, by_station, by_log_speed, _, by_ratio] = self.between(chart, station, speed.ln());
                [values, by_station, by_log_speed.map(|slope| slope / speed), by_ratio]
            }
        };
        let depth = chart.depth(self.side, station, speed);
        let mut by_depth = by_station.map(|slope| slope / depth.by_station);
        for q in 0..QUANTITIES {
            by_speed[q] -= by_depth[q] * depth.by_speed;
            if NEVER_NEGATIVE[q] && values[q] < 0.0 {
                [values[q], by_depth[q], by_speed[q], by_ratio[q]] = [0.0; 4];
            }
        }
        [values, by_depth, by_speed, by_ratio]
    }

    /// Between the lines of the speeds.
    fn between(&self, chart: &Chart, station: f64, log_speed: f64) -> Local {
        let (s, u) = (Cubic::at(&self.stations, station), Cubic::at(&chart.log_speeds, log_speed));
        let mut local = [[0.0; QUANTITIES]; 5];
        for (line, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let index = (u.first + line) * self.stations.len() + s.first + column;
            let node = &self.nodes[index * BLOCK..(index + 1) * BLOCK];
            for (kind, values) in node.chunks_exact(QUANTITIES).enumerate() {
                let (along, across) = (kind % 2, kind / 2);
                let (s_value, s_slope) = (s.value[column][along], s.slope[column][along]);
                let (u_value, u_slope) = (u.value[line][across], u.slope[line][across]);
                let weights = [s_value * u_value, s_slope * u_value, s_value * u_slope, s_slope * u_slope];
                for (sums, weight) in local.iter_mut().zip(weights) {
                    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * f64::from(*value));
                }
            }
            // The full model gives no slopes of these.
            let share = |fraction: f64, end: usize| if end == 0 { 1.0 - fraction } else { fraction };
            let weight = share(u.fraction, line) * share(s.fraction, column);
            let values = &self.by_ratio[index * QUANTITIES..(index + 1) * QUANTITIES];
            local[4].iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * f64::from(*value));
        }
        for q in (0..SCALARS).filter(|q| self.logarithmic[*q]) {
            let [value, by_station, by_log_speed, by_both, _] = local.map(|kind| kind[q]);
            let value = value.exp();
            local[0][q] = value;
            local[1][q] = value * by_station;
            local[2][q] = value * by_log_speed;
            local[3][q] = value * (by_both + by_station * by_log_speed);
        }
        local
    }

    /// Between rest and the slowest line, from what is interpolated on that line.
    fn near_rest(&self, station: f64, line: Local, w: f64, slowest: f64) -> State {
        let s = Cubic::at(&self.stations, station);
        let mut rest = [[0.0; QUANTITIES]; 3];
        for column in 0..2 {
            let node = &self.rest[(s.first + column) * 3 * QUANTITIES..][..3 * QUANTITIES];
            for q in 0..QUANTITIES {
                let [value, by_station, by_ratio] = [0, 1, 2].map(|kind| f64::from(node[kind * QUANTITIES + q]));
                rest[0][q] += s.value[column][0] * value + s.value[column][1] * by_station;
                rest[1][q] += s.slope[column][0] * value + s.slope[column][1] * by_station;
                rest[2][q] += by_ratio * if column == 0 { 1.0 - s.fraction } else { s.fraction };
            }
        }
        let mirror = line.map(|kind| mirrored(&kind));
        let (even, odd, kinked) = (even(w), odd(w), kinked(w));
        let mut state = [[0.0; QUANTITIES]; 4];
        for q in 0..QUANTITIES {
            let shares = if KINKED.contains(&q) { kinked } else { even };
            let kept = |kind: usize| 0.5 * (line[kind][q] + mirror[kind][q]);
            let reversed = |kind: usize| 0.5 * (line[kind][q] - mirror[kind][q]);
            let blend = |kind: usize, derivative: usize| {
                let ([change, slope], [end, end_slope]) = (shares[derivative], odd[derivative]);
                change * (kept(kind) - rest[kind][q])
                    + slope * kept(kind + 2)
                    + end * reversed(kind)
                    + end_slope * reversed(kind + 2)
            };
            state[0][q] = rest[0][q] + blend(0, 0);
            state[1][q] = rest[1][q] + blend(1, 0);
            state[2][q] = blend(0, 1) / slowest;
            state[3][q] = rest[2][q] + w * w * (kept(4) - rest[2][q]) + w * reversed(4);
        }
        state
    }
}

/// Largest and smallest values of fields that vanish at rest, and what leaves the tissue on one side: they change with |U|.
const KINKED: [usize; 4] =
    [place::MAXIMUM_FLUID_PRESSURE, place::MINIMUM_FLUID_PRESSURE, place::VON_MISES, place::EXUDATION];

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
        let (log_speeds, touch) = (vec![0.0, 1.0, 2.5], vec![0.2, 1.0, 3.0]);
        let chart = Chart { depths: [-2.0, 6.0], log_speeds, touch, rest: Some(0.1) };
        let sides = [(Side::Film, 0.0), (Side::Film, 0.4), (Side::Contact, 0.1), (Side::Contact, 1.0)];
        for ((side, s), u) in sides.into_iter().flat_map(|place| [3.7, 0.6].map(|u| (place, u))) {
            let depth = chart.depth(side, s, u);
            let (found, station) = chart.station(Side::Film, depth.value, u);
            assert!(found == side && (station - s).abs() < 1e-12);
            let difference = |du: f64, ds: f64| chart.depth(side, s + ds, u + du).value;
            assert!((depth.by_station - (difference(0.0, 1e-6) - difference(0.0, -1e-6)) / 2e-6).abs() < 1e-8);
            assert!((depth.by_speed - (difference(1e-6, 0.0) - difference(-1e-6, 0.0)) / 2e-6).abs() < 1e-8);
        }
    }

    #[test]
    fn between_rest_and_the_slowest_line_values_and_slopes_are_met() {
        for (shares, power) in [(even as fn(f64) -> Shares, 2), (even, 4), (odd, 1), (odd, 3), (kinked, 1), (kinked, 2)]
        {
            // w^n changes by 1 from rest to the line, where its slope is n.
            for w in [0.0, 0.3, 1.0] {
                let [value, slope] = shares(w).map(|[change, slope]| change + slope * f64::from(power));
                assert!((value - w.powi(power)).abs() < 1e-12);
                assert!((slope - f64::from(power) * w.powi(power - 1)).abs() < 1e-12);
            }
        }
    }
}
