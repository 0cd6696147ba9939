//! The curved coordinates of depth and speed, which follow first touch. Where the load is given, its logarithm takes the place of the depth.

use serde::{Deserialize, Serialize};

use super::curves::{Cubic, even, slope};

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
    /// Least and largest depth of the table \[m\].
    pub depths: [f64; 2],
    /// Grid lines: logarithms of speeds, ascending.
    pub log_speeds: Vec<f64>,
    /// Depth of first touch on those lines \[m\]; empty where the patch covers all depths.
    pub touch: Vec<f64>,
    /// The same at rest (0 where the patch covers all depths), in a table that goes down to rest.
    pub rest: Option<f64>,
}

/// A depth, and its derivatives with respect to the coordinate s and to U.
#[derive(Clone, Copy)]
pub struct Depth {
    /// The depth \[m\].
    pub value: f64,
    /// By s \[m\].
    pub by_station: f64,
    /// By U, s being kept \[s\].
    pub by_speed: f64,
}

impl Chart {
    /// The speed of the slowest line \[m/s\].
    pub fn slowest(&self) -> f64 {
        self.log_speeds[0].exp()
    }

    /// Slope by ln U on a line, of what has the values `y` on the lines: that of a parabola, in U where it goes on to rest.
    pub fn slope(&self, rest: Option<f64>, y: impl Fn(usize) -> f64, line: usize) -> f64 {
        match rest {
            Some(rest) if line == 0 => {
                let speeds = [0.0, self.slowest(), self.log_speeds[1].exp()];
                speeds[1] * slope(&speeds, |k| if k == 0 { rest } else { y(k - 1) }, 1)
            }
            _ => slope(&self.log_speeds, y, line),
        }
    }

    /// The part of the way from rest to the slowest line at a speed, where it is between them; and first touch at rest.
    pub fn near_rest(&self, speed: f64) -> Option<(f64, f64)> {
        self.rest.filter(|_| speed < self.slowest()).map(|touch| (speed / self.slowest(), touch))
    }

    /// Depth of first touch at a speed of 0 or more and its derivative with respect to U; `None` where it is not in the table.
    pub fn touch(&self, speed: f64) -> Option<[f64; 2]> {
        if self.touch.is_empty() {
            return None;
        }
        if self.rest.is_none() && speed < self.slowest() {
            return Some([self.touch(self.slowest())?[0], 0.0]);
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
