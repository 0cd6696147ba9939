//! Where a table gets more lines, and when it is done.

use super::super::ReducedModel;
use super::super::table::Side;
use super::Builder;
use super::compare::accuracy;
use crate::error::Error;
use crate::parameters::Inputs;

/// States that a finished table is compared with.
const VERIFIED_STATES: usize = 100;
/// A table of more states than this is no longer small.
const MOST_STATES: usize = 6000;

/// Cells are not made narrower than these shares of a side and of the range of ln U: what is left then is the way in which a coarse
/// mesh closes the film element by element.
const NARROWEST: [f64; 2] = [1.0 / 80.0, 1.0 / 20.0];

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
            let places: Vec<Inputs> = (offset..offset + VERIFIED_STATES).map(|i| self.scattered(i)).collect();
            offset += VERIFIED_STATES;
            let found = self.solve(&sorted(places))?;
            let mut comparisons = Vec::new();
            let (mut wide, mut slow) = (vec![Vec::new(); self.stations.len()], Vec::new());
            for sample in &found {
                let comparison = self.compare(&model, sample)?;
                if comparison.excess(&self.tolerance) > 1.0 {
                    // The cell gets a line where the table was farther from the states halfway, if there is room.
                    let chart = &model.content.chart;
                    let u = sample.inputs.sliding_speed.ln();
                    let (side, station) = chart.station(self.stations[0].0, sample.inputs.penetration_depth, u);
                    let patch = self.stations.iter().position(|(other, _)| *other == side).unwrap_or(0);
                    let column = cell(&self.stations[patch].1, station);
                    let line = cell(&self.log_speeds, u);
                    let room = [
                        (&self.stations[patch].1, column, NARROWEST[0]),
                        (&self.log_speeds, line, self.narrowest_speeds()),
                    ]
                    .map(|(lines, i, narrowest)| lines[i + 1] - lines[i] >= 2.0 * narrowest);
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
                return Ok(model);
            }
        }
    }

    /// Solves the lines and what is halfway between them; the largest errors there, as multiples of the tolerance, for the
    /// intervals of each side's stations and for those of the speeds.
    fn halve(&mut self) -> Result<(Vec<Vec<f64>>, Vec<f64>), Error> {
        let half_speeds = halfway(&self.log_speeds);
        if self.has_touch {
            let all = [&self.log_speeds[..], &half_speeds].concat();
            self.find_touches(&all, self.depths[0])?;
        }
        let (mut nodes, mut by_station, mut by_speed) = (Vec::new(), Vec::new(), Vec::new());
        for (patch, (side, stations)) in self.stations.iter().enumerate() {
            for &u in &self.log_speeds {
                nodes.extend(stations.iter().map(|s| (*side, *s, u)));
                by_station.extend(halfway(stations).into_iter().enumerate().map(|(i, s)| (patch, i, (*side, s, u))));
            }
            for (i, &u) in half_speeds.iter().enumerate() {
                by_speed.extend(stations.iter().map(|s| (i, (*side, *s, u))));
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
        for ((_, stations), intervals) in self.stations.iter_mut().zip(wide) {
            any |= split(stations, intervals, NARROWEST[0]);
        }
        let narrowest = self.narrowest_speeds();
        any |= split(&mut self.log_speeds, slow, narrowest);
        let states = self.log_speeds.len() * self.stations.iter().map(|(_, stations)| stations.len()).sum::<usize>();
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
        let [slowest, fastest] = self.range.speeds;
        NARROWEST[1] * (fastest / slowest).ln()
    }

    /// Places that fill the range evenly without a pattern (the additive recurrence of the plastic number, in two dimensions).
    fn scattered(&self, index: usize) -> Inputs {
        let share = |step: f64| (0.5 + step * (index + 1) as f64).fract();
        let ([least, most], [slowest, fastest]) = (self.range.depths, self.range.speeds.map(f64::ln));
        self.inputs(
            least + (most - least) * share(0.754_877_666_246_692_8),
            slowest + (fastest - slowest) * share(0.569_840_290_998_053_3),
        )
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
        .filter(|(i, _)| intervals.contains(i) && lines[i + 1] - lines[*i] >= 2.0 * narrowest)
        .map(|(_, middle)| middle)
        .collect();
    lines.extend(&new);
    lines.sort_by(f64::total_cmp);
    !new.is_empty()
}

fn cell(lines: &[f64], place: f64) -> usize {
    lines.partition_point(|x| *x <= place).saturating_sub(1).min(lines.len() - 2)
}

/// Neighbours in depth one after the other.
fn sorted(mut points: Vec<Inputs>) -> Vec<Inputs> {
    points.sort_by(|a, b| a.penetration_depth.total_cmp(&b.penetration_depth));
    points
}
