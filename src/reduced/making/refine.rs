//! Where a table gets more lines, and when it is done.

use std::f64::consts::LN_2;

use super::super::ReducedModel;
use super::super::chart::Side;
use super::compare::{Comparison, accuracy};
use super::{Builder, first_lines};
use crate::error::Error;
use crate::parameters::Inputs;

/// States that a finished table is compared with.
const VERIFIED_STATES: usize = 100;
/// And states between rest and the slowest line that it is also compared with.
const VERIFIED_STATES_NEAR_REST: usize = 50;
/// The slowest line goes down to this fraction of the fastest at most.
const SLOWEST: f64 = 1.0 / 16384.0;
/// A table of more states than this is no longer small.
const MOST_STATES: usize = 6000;

/// Cells are not made narrower than these fractions of a side and of the range of ln U: what is left then is the way in which a coarse
/// mesh closes the film element by element.
const NARROWEST: [f64; 2] = [1.0 / 80.0, 1.0 / 20.0];
/// Between rough surfaces no film closes so.
const NARROWEST_ROUGH: [f64; 2] = [1.0 / 24.0, 1.0 / 12.0];

impl Builder<'_> {
    pub(super) fn refine(&mut self) -> Result<ReducedModel, Error> {
        let mut offset = 0;
        loop {
            let (station_errors, speed_errors) = self.halve()?;
            let wide: Vec<_> = station_errors.iter().map(|errors| excessive(errors)).collect();
            if self.insert(&wide, &excessive(&speed_errors))? {
                continue;
            }
            let mut model = self.model()?;
            let moving = (0..VERIFIED_STATES).map(|i| self.scattered(offset + i, false));
            let slow =
                (0..VERIFIED_STATES_NEAR_REST).filter(|_| self.rests()).map(|i| self.scattered(offset + i, true));
            let places: Vec<Inputs> = moving.chain(slow).collect();
            offset += VERIFIED_STATES;
            let found = self.solve(&self.sorted(places))?;
            let mut comparisons = Vec::new();
            let (mut wide, mut slow) = (vec![Vec::new(); self.stations.len()], Vec::new());
            for sample in &found {
                let comparison = self.compare(&model, sample)?;
                if comparison.excess(&self.tolerance) > 1.0 {
                    // The cell gets a line where the table was farther from the states halfway, if there is room.
                    let chart = &model.content.chart;
                    let speed = sample.inputs.sliding_speed;
                    let (side, station) = chart.station(self.stations[0].0, sample.depth, speed);
                    let patch = self.stations.iter().position(|(other, _)| *other == side).unwrap_or(0);
                    let column = cell(&self.stations[patch].1, station);
                    let line = cell(&self.lines(), speed.ln());
                    let room = [has_room(&self.stations[patch].1, column, self.narrowest()[0]), self.has_room(line)];
                    let by_station = station_errors[patch][column] >= speed_errors[line];
                    match room == [true, false] || (room[0] && by_station) {
                        true => wide[patch].push(column),
                        false => slow.push(line),
                    }
                }
                comparisons.push(comparison);
            }
            if !self.insert(&wide, &slow)? {
                model.content.accuracy = accuracy(&comparisons);
                model.content.checks = comparisons.iter().map(Comparison::check).collect();
                return Ok(model);
            }
        }
    }

    /// Solves the lines and what is halfway between them; the largest errors there, as multiples of the tolerance, for the
    /// intervals of each side's stations and for those of the speeds.
    fn halve(&mut self) -> Result<(Vec<Vec<f64>>, Vec<f64>), Error> {
        let (lines, half_speeds) = (self.lines(), self.halfway_speeds());
        if self.has_touch {
            let all = [&lines[..], &half_speeds].concat();
            self.find_touches(&all, self.depths[0])?;
        }
        let (mut nodes, mut by_station, mut by_speed) = (Vec::new(), Vec::new(), Vec::new());
        for (patch, (side, stations)) in self.stations.iter().enumerate() {
            for &u in &lines {
                nodes.extend(stations.iter().map(|s| (*side, *s, u)));
                by_station.extend(halfway(stations).into_iter().enumerate().map(|(i, s)| (patch, i, (*side, s, u))));
            }
            for (i, &u) in half_speeds.iter().enumerate() {
                // Towards rest film and load at first touch vanish, and nothing is to be measured against.
                let counts = |s: f64| !(i == 0 && self.rests() && self.at_touch(*side, s));
                by_speed.extend(stations.iter().filter(|s| counts(**s)).map(|s| (i, (*side, *s, u))));
            }
        }
        let places: Vec<_> = (nodes.into_iter())
            .chain(by_station.iter().map(|(_, _, place)| *place))
            .chain(by_speed.iter().map(|(_, place)| *place))
            .collect();
        self.fill(&places)?;
        let model = self.model()?;
        let excess = |(side, s, u): (Side, f64, f64)| -> Result<f64, Error> {
            let sample = self.samples.get(&(side, s.to_bits(), u.to_bits()));
            sample.map_or(Ok(0.0), |sample| Ok(self.compare(&model, sample)?.excess(&self.tolerance)))
        };
        let mut stations: Vec<Vec<f64>> = self.stations.iter().map(|(_, s)| vec![0.0; s.len() - 1]).collect();
        for (patch, i, place) in by_station {
            stations[patch][i] = stations[patch][i].max(excess(place)?);
        }
        let mut speeds = vec![0.0; half_speeds.len()];
        for (i, place) in by_speed {
            speeds[i] = f64::max(speeds[i], excess(place)?);
        }
        Ok((stations, speeds))
    }

    /// New lines in the middle of those of these intervals that are not too narrow; whether there were any.
    fn insert(&mut self, wide: &[Vec<usize>], slow: &[usize]) -> Result<bool, Error> {
        let mut any = false;
        let narrowest = self.narrowest()[0];
        for ((_, stations), intervals) in self.stations.iter_mut().zip(wide) {
            any |= split(stations, intervals, narrowest);
        }
        let narrowest = self.narrowest_speeds();
        let slower = self.rests() && slow.contains(&0) && self.has_room(0);
        let first = usize::from(self.rests());
        let slow: Vec<usize> = slow.iter().filter_map(|line| line.checked_sub(first)).collect();
        any |= split(&mut self.log_speeds, &slow, narrowest);
        if slower {
            self.log_speeds.insert(0, self.log_speeds[0] - LN_2);
            any = true;
        }
        let states = self.lines().len() * self.stations.iter().map(|(_, stations)| stations.len()).sum::<usize>();
        if states <= MOST_STATES {
            return Ok(any);
        }
        let allowed = format!(
            "errors that a table of {MOST_STATES} states keeps; allow more, take a smaller range, or refine the mesh, on which \
             the film may close bit by bit"
        );
        Err(Error::value("tolerance", format!("{:?}", self.tolerance), allowed))
    }

    /// Least width of an interval of ln U.
    fn narrowest_speeds(&self) -> f64 {
        let [slowest, fastest] = first_lines(&self.range);
        self.narrowest()[1] * (fastest - slowest)
    }

    fn narrowest(&self) -> [f64; 2] {
        if self.is_rough() { NARROWEST_ROUGH } else { NARROWEST }
    }

    /// ln U in the middle of the intervals between the lines; after rest, where half the slowest line's speed is.
    fn halfway_speeds(&self) -> Vec<f64> {
        let slow = self.rests().then_some(self.log_speeds[0] - LN_2);
        slow.into_iter().chain(halfway(&self.log_speeds)).collect()
    }

    /// Whether there may be one more line in this interval of speeds.
    fn has_room(&self, line: usize) -> bool {
        match line.checked_sub(usize::from(self.rests())) {
            Some(line) => has_room(&self.log_speeds, line, self.narrowest_speeds()),
            None => self.log_speeds[0] > (SLOWEST * self.range.speeds[1]).ln(),
        }
    }

    /// Places that fill the range evenly without a pattern (the additive recurrence of the plastic number, in two dimensions): on
    /// the lines of the speeds, or between rest and the slowest.
    fn scattered(&self, index: usize, near_rest: bool) -> Inputs {
        let fraction = |step: f64| (0.5 + step * (index + 1) as f64).fract();
        let ([least, most], slowest) = (self.asked, self.log_speeds[0]);
        let place = fraction(0.569_840_290_998_053_3);
        let log_speed = match near_rest {
            true => slowest + place.ln(),
            false => slowest + (self.range.speeds[1].ln() - slowest) * place,
        };
        self.inputs(least + (most - least) * fraction(0.754_877_666_246_692_8), log_speed)
    }

    /// Neighbours one after the other: by depth; between rough surfaces by bands of speed, there and back.
    fn sorted(&self, mut points: Vec<Inputs>) -> Vec<Inputs> {
        const BANDS: f64 = 8.0;
        let [slowest, fastest] = first_lines(&self.range);
        let band = |inputs: &Inputs| match self.is_rough() {
            true => (BANDS * (inputs.sliding_speed.ln() - slowest) / (fastest - slowest)).floor(),
            false => 0.0,
        };
        let place = |inputs: &Inputs| (band(inputs), inputs.penetration_depth, inputs.applied_load);
        points.sort_by(|a, b| place(a).partial_cmp(&place(b)).unwrap_or(std::cmp::Ordering::Equal));
        points.chunk_by_mut(|a, b| band(a) == band(b)).skip(1).step_by(2).for_each(<[_]>::reverse);
        points
    }
}

fn excessive(errors: &[f64]) -> Vec<usize> {
    (0..errors.len()).filter(|i| errors[*i] > 1.0).collect()
}

fn halfway(lines: &[f64]) -> Vec<f64> {
    lines.windows(2).map(|ends| 0.5 * (ends[0] + ends[1])).collect()
}

fn split(lines: &mut Vec<f64>, intervals: &[usize], narrowest: f64) -> bool {
    let new: Vec<f64> = (halfway(lines).into_iter().enumerate())
        .filter(|(i, _)| intervals.contains(i) && has_room(lines, *i, narrowest))
        .map(|(_, middle)| middle)
        .collect();
    lines.extend(&new);
    lines.sort_by(f64::total_cmp);
    !new.is_empty()
}

/// Whether halves of an interval are not too narrow.
fn has_room(lines: &[f64], interval: usize, narrowest: f64) -> bool {
    lines[interval + 1] - lines[interval] >= 2.0 * narrowest
}

fn cell(lines: &[f64], place: f64) -> usize {
    lines.partition_point(|x| *x <= place).saturating_sub(1).min(lines.len() - 2)
}
