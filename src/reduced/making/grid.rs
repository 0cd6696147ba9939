//! The grid: where its states are, and the table of them.

use super::super::chart::{Chart, Side};
use super::super::patch::Grid;
use super::super::quantities::{MINIMUM_FILM, QUANTITIES};
use super::super::{Accuracy, Content, ReducedModel};
use super::touch::Touch;
use super::{Builder, REST};
use crate::error::Error;
use crate::parameters::Inputs;

/// The table goes this fraction of the range of depths beyond first touch on both sides, so that no patch has no width.
const TOUCH_MARGIN: f64 = 0.1;

const FIRST_STATIONS: [(Side, [f64; 5]); 2] =
    [(Side::Film, [0.0, 0.25, 0.5, 0.75, 1.0]), (Side::Contact, [0.0, 0.1, 0.3, 0.6, 1.0])];

impl Builder<'_> {
    /// Finds first touch on the first lines, and which depths and sides the table has.
    pub(super) fn lay_out(&mut self) -> Result<(), Error> {
        let [least, most] = self.asked;
        let margin = TOUCH_MARGIN * (most - least);
        let lines = self.lines();
        self.find_touches(&lines, least)?;
        let depths: Vec<Option<f64>> = lines.iter().map(|u| self.touch(*u)).collect();
        let film_everywhere = depths.iter().all(|depth| depth.is_none_or(|depth| depth >= most));
        let contact_everywhere = depths.iter().all(|depth| depth.is_some_and(|depth| depth <= least));
        // Rough surfaces may do without.
        let known = !self.is_rough() || depths.iter().all(Option::is_some);
        self.has_touch = known && !film_everywhere && !contact_everywhere;
        if self.has_touch {
            for depth in depths {
                let Some(depth) = depth else {
                    let allowed = "a range in which the solids touch at all speeds or at none; take fewer speeds";
                    let [least, most] = self.range.pressed;
                    return Err(Error::value("depths", format!("{least:e}:{most:e}"), allowed));
                };
                self.depths = [self.depths[0].min(depth - margin), self.depths[1].max(depth + margin)];
            }
        }
        self.stations = FIRST_STATIONS
            .into_iter()
            .filter(|(side, _)| self.has_touch || (*side == Side::Contact) == contact_everywhere)
            .map(|(side, stations)| (side, stations.to_vec()))
            .collect();
        Ok(())
    }

    /// Depth of first touch at a speed where it has been found.
    fn touch(&self, log_speed: f64) -> Option<f64> {
        self.touches.get(&log_speed.to_bits()).map(Touch::depth)
    }

    /// Whether a station is at first touch.
    pub(super) fn at_touch(&self, side: Side, station: f64) -> bool {
        self.has_touch && station == if side == Side::Film { 1.0 } else { 0.0 }
    }

    /// The coordinates of the present lines, if first touch is known on all of them.
    pub(super) fn chart(&self) -> Option<Chart> {
        let (mut touch, mut at_rest) = (Vec::new(), 0.0);
        if self.has_touch {
            touch = self.log_speeds.iter().map(|u| self.touch(*u)).collect::<Option<_>>()?;
            at_rest = if self.rests() { self.touch(REST)? } else { 0.0 };
        }
        let rest = self.rests().then_some(at_rest);
        Some(Chart { depths: self.depths, log_speeds: self.log_speeds.clone(), touch, rest })
    }

    /// The depth at a place of the grid, where first touch at that speed has been found.
    fn depth(&self, (side, station, u): (Side, f64, f64)) -> f64 {
        let touch = if self.has_touch { self.touch(u) } else { None };
        let touch: Vec<f64> = touch.map_or(Vec::new(), |depth| vec![depth; 2]);
        Chart { depths: self.depths, log_speeds: vec![0.0, 1.0], touch, rest: None }.depth(side, station, 1.0).value
    }

    /// Solves the places that have not been solved yet.
    pub(super) fn fill(&mut self, places: &[(Side, f64, f64)]) -> Result<(), Error> {
        let mut missing: Vec<(Side, f64, f64, f64)> = Vec::new();
        for &(side, station, u) in places {
            let key = (side, station.to_bits(), u.to_bits());
            let at_touch = self.touches.get(&u.to_bits()).filter(|_| self.has_touch);
            match (side, at_touch) {
                _ if self.samples.contains_key(&key) => {}
                (Side::Film, Some(touch)) if station == 1.0 => drop(self.samples.insert(key, touch.apart.clone())),
                (Side::Contact, Some(touch)) if station == 0.0 => {
                    let mut sample = touch.touching.clone();
                    // One state for both sides, each with its slopes: the table is continuous.
                    sample.state[0] = touch.apart.state[0];
                    self.samples.insert(key, sample);
                }
                _ => missing.push((side, station, u, self.depth((side, station, u)))),
            }
        }
        missing.sort_by(|a, b| (a.2, a.3).partial_cmp(&(b.2, b.3)).unwrap_or(std::cmp::Ordering::Equal));
        missing.dedup();
        if self.is_rough() {
            // There and back: the next line begins where the last one ended.
            missing.chunk_by_mut(|a, b| a.2 == b.2).skip(1).step_by(2).for_each(<[_]>::reverse);
        }
        let points: Vec<Inputs> = missing.iter().map(|(_, _, u, depth)| self.inputs(*depth, *u)).collect();
        let found = self.solve(&points)?;
        for ((side, station, u, _), sample) in missing.into_iter().zip(found) {
            self.samples.insert((side, station.to_bits(), u.to_bits()), sample);
        }
        Ok(())
    }

    /// The table of the present lines.
    pub(super) fn model(&self) -> Result<ReducedModel, Error> {
        let missing = || Error::State("the table of the reduced model has a gap".into());
        let chart = self.chart().ok_or_else(missing)?;
        let mut grids = Vec::new();
        for (side, stations) in &self.stations {
            let mut states = Vec::with_capacity(4 * QUANTITIES * stations.len() * (1 + chart.log_speeds.len()));
            let mut unresolved = Vec::new();
            for u in self.lines() {
                for station in stations {
                    let key = (*side, station.to_bits(), u.to_bits());
                    let sample = self.samples.get(&key).ok_or_else(missing)?;
                    let start = states.len();
                    unresolved.push(!sample.resolved);
                    states.extend(sample.state.iter().flatten().map(|value| *value as f32));
                    if self.at_touch(*side, *station) && !self.is_rough() {
                        states[start + MINIMUM_FILM] = 0.0;
                    }
                }
            }
            let moving = states.split_off(usize::from(self.rests()) * 4 * QUANTITIES * stations.len());
            grids.push(Grid { side: *side, stations: stations.clone(), states: moving, rest: states, unresolved });
        }
        let (parameters, range, accuracy, checks) = (*self.parameters, self.range, Accuracy::default(), Vec::new());
        Ok(ReducedModel::new(Content { parameters, range, accuracy, checks, chart, grids }))
    }
}
