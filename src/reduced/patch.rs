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
//!
//! A table that does not go down to rest holds the state of its slowest line below it: what is even stays, what is odd goes with w.

use serde::{Deserialize, Serialize};

use super::chart::{Chart, Side};
use super::curves::{Cubic, even, kinked, odd, slope};
use super::quantities::{INTERPOLATION, QUANTITIES, SCALARS, State, mirrored};
use crate::outputs::{Floor, Interpolation};

/// The states of one side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Grid {
    /// Which side.
    pub side: Side,
    /// Grid lines of the coordinate s, from 0 to 1.
    pub stations: Vec<f64>,
    /// Speed by speed and station by station: quantities, and their derivatives with respect to depth, speed and slide-to-roll ratio.
    pub states: Vec<f32>,
    /// The same at rest, station by station, in a table that goes down to rest.
    pub rest: Vec<f32>,
    /// Which states their mesh does not resolve: those at rest, if there are, and then the others.
    pub unresolved: Vec<bool>,
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
            && self.unresolved.len() * BLOCK == self.states.len() + self.rest.len()
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

/// How the states of a case are interpolated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Manner {
    /// The scalars that are interpolated as logarithms.
    pub logarithmic: [bool; SCALARS],
    /// Whether the stations of profiles go with the contact: the full model's slopes are those at a fixed place, and differences serve.
    pub stations_move: bool,
    /// Whether the surfaces are rough, so that their mean planes may overlap.
    pub rough: bool,
}

impl Manner {
    /// Whether differences between states serve as slopes.
    fn hops(&self, quantity: usize) -> bool {
        let Interpolation { hops, floor, .. } = INTERPOLATION[quantity];
        // The least distance of rough surfaces changes smoothly.
        let smooth = self.rough && floor == Floor::Distance;
        (hops && !smooth) || (self.stations_move && quantity >= SCALARS)
    }

    /// Whether it is never negative.
    fn has_floor(&self, quantity: usize) -> bool {
        match INTERPOLATION[quantity].floor {
            Floor::None => false,
            Floor::Zero => true,
            Floor::Distance => !self.rough,
        }
    }
}

/// One side, ready to be evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// Which side.
    pub side: Side,
    stations: Vec<f64>,
    manner: Manner,
    /// A state's block: quantities, and their derivatives with respect to s, to ln U and to both; of logarithms where that is what is
    /// interpolated.
    nodes: Vec<f32>,
    /// Derivatives with respect to the slide-to-roll ratio.
    by_ratio: Vec<f32>,
    /// At rest: quantities, and their derivatives with respect to s and to the slide-to-roll ratio.
    rest: Vec<f32>,
    unresolved: Vec<bool>,
}

/// Quantities, their derivatives with respect to s, to ln U and to both, and to the slide-to-roll ratio.
type Local = [[f64; QUANTITIES]; 5];

impl Patch {
    /// From the states of a grid, which fits the chart.
    pub fn new(grid: &Grid, chart: &Chart, manner: Manner) -> Self {
        let columns = grid.stations.len();
        let mut nodes = vec![0.0; grid.states.len()];
        for (index, (node, state)) in nodes.chunks_exact_mut(BLOCK).zip(grid.states.chunks_exact(BLOCK)).enumerate() {
            let log_speed = chart.log_speeds[index / columns];
            let speed = log_speed.exp();
            let depth = chart.depth(grid.side, grid.stations[index % columns], speed);
            for q in 0..QUANTITIES {
                let [value, by_depth, by_speed] = [0, 1, 2].map(|k| f64::from(state[k * QUANTITIES + q]));
                let logarithmic = q < SCALARS && manner.logarithmic[q];
                let scale = if logarithmic { 1.0 / value } else { 1.0 };
                node[q] = if logarithmic { value.ln() } else { value } as f32;
                node[QUANTITIES + q] = (scale * by_depth * depth.by_station) as f32;
                node[2 * QUANTITIES + q] = (scale * speed * (by_speed + by_depth * depth.by_speed)) as f32;
            }
        }
        let at = |nodes: &[f32], line: usize, column: usize, k: usize, q: usize| {
            f64::from(nodes[(line * columns + column) * BLOCK + k * QUANTITIES + q])
        };
        let rest = Self::at_rest(grid, chart, manner);
        for q in 0..QUANTITIES {
            let has_rest = chart.rest.is_some() && !(q < SCALARS && manner.logarithmic[q]);
            for index in 0..nodes.len() / BLOCK {
                let (line, column) = (index / columns, index % columns);
                let hops = manner.hops(q);
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
        let (side, stations, unresolved) = (grid.side, grid.stations.clone(), grid.unresolved.clone());
        Self { side, stations, manner, nodes, by_ratio, rest, unresolved }
    }

    /// The nodes at rest. A state at rest is its own mirror image.
    fn at_rest(grid: &Grid, chart: &Chart, manner: Manner) -> Vec<f32> {
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
            for q in (0..QUANTITIES).filter(|q| manner.hops(*q)) {
                nodes[(column * 3 + 1) * QUANTITIES + q] = slope(&grid.stations, |k| at(&nodes, k, q), column) as f32;
            }
        }
        nodes
    }

    /// Whether their mesh does not resolve one of the states between which this station and speed are.
    pub fn is_unresolved(&self, chart: &Chart, station: f64, speed: f64) -> bool {
        let first = Cubic::at(&self.stations, station).first;
        let lines = match (chart.rest.is_some(), speed < chart.slowest()) {
            (rest, true) => 0..1 + usize::from(rest),
            (rest, false) => {
                let line = usize::from(rest) + Cubic::at(&chart.log_speeds, speed.ln()).first;
                line..line + 2
            }
        };
        let at = |line: usize| &self.unresolved[line * self.stations.len() + first..][..2];
        lines.flat_map(at).any(|unresolved| *unresolved)
    }

    /// The state at a station and a speed of 0 or more.
    pub fn state(&self, chart: &Chart, station: f64, speed: f64) -> State {
        let slowest = chart.slowest();
        let [mut values, by_station, mut by_speed, mut by_ratio] = match chart.near_rest(speed) {
            Some((w, _)) => self.near_rest(station, self.between(chart, station, chart.log_speeds[0]), w, slowest),
            None if speed < slowest => {
                held(self.between(chart, station, chart.log_speeds[0]), speed / slowest, slowest)
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
            if self.manner.has_floor(q) && values[q] < 0.0 {
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
            let linear = |fraction: f64, end: usize| if end == 0 { 1.0 - fraction } else { fraction };
            let weight = linear(u.fraction, line) * linear(s.fraction, column);
            let values = &self.by_ratio[index * QUANTITIES..(index + 1) * QUANTITIES];
            local[4].iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * f64::from(*value));
        }
        for q in (0..SCALARS).filter(|q| self.manner.logarithmic[*q]) {
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
            let weights = if INTERPOLATION[q].kinked { kinked } else { even };
            let kept = |kind: usize| 0.5 * (line[kind][q] + mirror[kind][q]);
            let reversed = |kind: usize| 0.5 * (line[kind][q] - mirror[kind][q]);
            let blend = |kind: usize, derivative: usize| {
                let ([change, slope], [end, end_slope]) = (weights[derivative], odd[derivative]);
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

/// Below the slowest line of a table without rest: what is even as on that line, what is odd in proportion to w.
fn held(line: Local, w: f64, slowest: f64) -> State {
    let [values, by_station, _, _, by_ratio] = line;
    let blend = |values: [f64; QUANTITIES]| {
        let mirror = mirrored(&values);
        std::array::from_fn(|q| 0.5 * (values[q] + mirror[q]) + 0.5 * w * (values[q] - mirror[q]))
    };
    let mirror = mirrored(&values);
    let by_speed = std::array::from_fn(|q| 0.5 * (values[q] - mirror[q]) / slowest);
    [blend(values), blend(by_station), by_speed, blend(by_ratio)]
}

#[cfg(test)]
mod tests {
    use super::super::quantities::MINIMUM_FILM;
    use super::*;

    #[test]
    fn a_state_that_is_not_resolved_makes_its_cells_doubtful() {
        // Three stations, at rest (where there is one) and at 1, e and e^2 m/s; not resolved is one state of the first line or one of the last.
        let manner = Manner { logarithmic: [false; SCALARS], stations_move: false, rough: false };
        let stations = vec![0.0, 0.5, 1.0];
        for (rest, first, last) in [(Some(0.0), 0, 11), (None, 0, 8)] {
            let chart = Chart { depths: [0.0, 1.0], log_speeds: vec![0.0, 1.0, 2.0], touch: Vec::new(), rest };
            let patch = |wrong: usize| {
                let lines = 3 + usize::from(rest.is_some());
                let grid = Grid {
                    side: Side::Film,
                    stations: stations.clone(),
                    states: vec![0.0; 9 * BLOCK],
                    rest: vec![0.0; 3 * BLOCK * usize::from(rest.is_some())],
                    unresolved: (0..3 * lines).map(|state| state == wrong).collect(),
                };
                assert!(grid.fits(&chart));
                Patch::new(&grid, &chart, manner)
            };
            let at = |wrong: usize, station: f64, speed: f64| patch(wrong).is_unresolved(&chart, station, speed);
            // Below the slowest line it is that of rest, or what is held.
            assert!(at(first, 0.2, 0.5) && at(first, 0.2, 0.0) && !at(first, 0.8, 0.5) && !at(last, 0.8, 0.5));
            assert_eq!(at(first, 0.2, 1.5), rest.is_none());
            // The slowest line has a part in what is below it.
            assert!(at(if rest.is_some() { 3 } else { 0 }, 0.2, 0.5));
            assert!(!at(first, 0.2, 3.0) && at(last, 0.8, 3.0) && at(last, 1.0, 2.0_f64.exp()) && !at(last, 0.2, 3.0));
        }
    }

    #[test]
    fn what_is_kept_from_going_below_zero_depends_on_the_surfaces() {
        let solid_load = (0..SCALARS).find(|q| INTERPOLATION[*q].floor == Floor::Zero).unwrap();
        for rough in [false, true] {
            let manner = Manner { logarithmic: [false; SCALARS], stations_move: false, rough };
            // Mean planes of rough surfaces may overlap, and their distance has slopes of its own.
            assert_eq!([manner.has_floor(MINIMUM_FILM), manner.hops(MINIMUM_FILM)], [!rough; 2]);
            assert!(manner.has_floor(solid_load) && !manner.hops(SCALARS));
            assert!(Manner { stations_move: true, ..manner }.hops(SCALARS));
        }
    }
}
