//! Making a reduced model: states are solved on a coarse grid and halfway between its lines, and where the table does not meet the
//! states halfway, it gets a line. Then it has to meet states at places that have nothing to do with the grid.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use super::table::{Chart, Grid, QUANTITIES, Side, State, place, primitives};
use super::{Accuracy, Content, Deviation, Range, ReducedModel, boundary_friction};
use crate::error::Error;
use crate::outputs::{Outputs, Regime};
use crate::parameters::{Fidelity, Inputs, Parameters};
use crate::simulation::{Input, Simulation};
use crate::sweep;

/// What a table has to keep: the largest errors between its states, relative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Of the load.
    pub load: f64,
    /// Of the least film thickness.
    pub minimum_film_thickness: f64,
    /// Of the friction coefficient away from first touch.
    pub friction_coefficient: f64,
    /// Of the profile of the fluid pressure: root mean square over the stations, relative to the largest one.
    pub fluid_pressure: f64,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { load: 0.01, minimum_film_thickness: 0.02, friction_coefficient: 0.02, fluid_pressure: 0.03 }
    }
}

/// How far a table has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// States that are solved.
    pub solved: usize,
    /// States that are to be solved before the table is looked at again.
    pub planned: usize,
}

/// First touch is found to this share of the range of depths.
const TOUCH_PRECISION: f64 = 1e-4;
/// The table goes this share of the range of depths beyond first touch on both sides, so that no patch has no width.
const TOUCH_MARGIN: f64 = 0.1;
/// Within this share of the range of depths friction is near first touch.
const NEAR_TOUCH: f64 = 1.0 / 40.0;
/// States that a finished table is compared with.
const VERIFIED_STATES: usize = 100;
/// A table of more states than this is no longer small.
const MOST_STATES: usize = 6000;

/// Cells are not made narrower than these shares of a side and of the range of ln U: what is left then is the way in which a coarse
/// mesh closes the film element by element.
const NARROWEST: [f64; 2] = [1.0 / 80.0, 1.0 / 20.0];

const FIRST_STATIONS: [(Side, [f64; 5]); 2] =
    [(Side::Film, [0.0, 0.25, 0.5, 0.75, 1.0]), (Side::Contact, [0.0, 0.1, 0.3, 0.6, 1.0])];
const FIRST_SPEEDS: usize = 4;

/// A solved state.
#[derive(Clone)]
struct Sample {
    inputs: Inputs,
    state: Box<State>,
    touching: bool,
}

/// Where the film first closes at one speed: the last state without contact, the first one with.
struct Touch {
    apart: Sample,
    touching: Sample,
}

impl Touch {
    fn depth(&self) -> f64 {
        0.5 * (self.apart.inputs.penetration_depth + self.touching.inputs.penetration_depth)
    }
}

/// A place of the grid. Numbers are compared by their bits.
type Key = (Side, u64, u64);

struct Builder<'a> {
    parameters: &'a Parameters,
    range: Range,
    tolerance: Tolerance,
    threads: usize,
    progress: &'a (dyn Fn(Progress) + Sync),
    solved: usize,
    log_speeds: Vec<f64>,
    stations: Vec<(Side, Vec<f64>)>,
    samples: HashMap<Key, Sample>,
    touches: HashMap<u64, Touch>,
    /// Depths that the table covers, and whether first touch is among them.
    depths: [f64; 2],
    has_touch: bool,
}

impl ReducedModel {
    /// Makes a table for a case that keeps a tolerance, on several threads. `progress` hears of every state that is solved.
    ///
    /// # Errors
    /// [`Error::Value`] for a range that is none, or a tolerance that a table of a few thousand states does not keep;
    /// [`Error::NotConverged`] where the full model has no solution.
    pub fn build(
        parameters: &Parameters,
        range: Range,
        tolerance: Tolerance,
        threads: usize,
        progress: &(dyn Fn(Progress) + Sync),
    ) -> Result<Self, Error> {
        let parameters = &Parameters { fidelity: Fidelity::Full, ..*parameters };
        parameters.validate()?;
        check(&range)?;
        if parameters.cavitation {
            return Err(Error::value(
                "cavitation",
                true,
                "false: a reduced model has no torn film; fidelity = full has",
            ));
        }
        let [slowest, fastest] = range.speeds.map(f64::ln);
        let last = (FIRST_SPEEDS - 1) as f64;
        let log_speeds = (0..FIRST_SPEEDS).map(|i| slowest + (fastest - slowest) * i as f64 / last).collect();
        let mut builder = Builder {
            parameters,
            range,
            tolerance,
            threads,
            progress,
            solved: 0,
            log_speeds,
            stations: Vec::new(),
            samples: HashMap::new(),
            touches: HashMap::new(),
            depths: range.depths,
            has_touch: false,
        };
        builder.lay_out()?;
        builder.refine()
    }
}

fn check(range: &Range) -> Result<(), Error> {
    let [least, most] = range.depths;
    let [slowest, fastest] = range.speeds;
    if !(-1e-2..=1e-2).contains(&least) || !(-1e-2..=1e-2).contains(&most) || least >= most {
        return Err(Error::value(
            "depths",
            format!("{least:e}:{most:e}"),
            "two ascending numbers from -1e-2 to 1e-2 m",
        ));
    }
    if !(1e-6..10.0).contains(&slowest) || fastest <= slowest || fastest > 10.0 {
        return Err(Error::value(
            "speeds",
            format!("{slowest}:{fastest}"),
            "two ascending numbers from 1e-6 to 10 m/s",
        ));
    }
    if !(-10.0..=10.0).contains(&range.slide_to_roll_ratio) {
        return Err(Error::value("slide_to_roll_ratio", range.slide_to_roll_ratio, "a number from -10 to 10"));
    }
    Ok(())
}

impl Builder<'_> {
    fn inputs(&self, depth: f64, log_speed: f64) -> Inputs {
        let [slowest, fastest] = self.range.speeds;
        Inputs {
            penetration_depth: depth,
            sliding_speed: log_speed.exp().clamp(slowest, fastest),
            slide_to_roll_ratio: self.range.slide_to_roll_ratio,
            ..Inputs::NONE
        }
    }

    /// Solves all points, in the order in which they are best solved.
    fn solve(&mut self, points: &[Inputs]) -> Result<Vec<Sample>, Error> {
        let planned = self.solved + points.len();
        let found: Mutex<Vec<Option<Sample>>> = Mutex::new(vec![None; points.len()]);
        let trouble = Mutex::new(None);
        sweep::solve(self.parameters, points, self.threads, &|index, result| match result.and_then(sample) {
            Ok(sample) => {
                let mut found = found.lock().unwrap_or_else(PoisonError::into_inner);
                found[index] = Some(sample);
                let solved = planned - found.iter().filter(|sample| sample.is_none()).count();
                (self.progress)(Progress { solved, planned });
            }
            Err(error) => *trouble.lock().unwrap_or_else(PoisonError::into_inner) = Some(error),
        })?;
        if let Some(error) = trouble.into_inner().unwrap_or_else(PoisonError::into_inner) {
            return Err(error);
        }
        self.solved = planned;
        Ok(found.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().flatten().collect())
    }

    /// Finds first touch on the first lines, and which depths and sides the table has.
    fn lay_out(&mut self) -> Result<(), Error> {
        let [least, most] = self.range.depths;
        let margin = TOUCH_MARGIN * (most - least);
        self.find_touches(&self.log_speeds.clone(), least)?;
        let depths: Vec<Option<f64>> =
            self.log_speeds.iter().map(|u| self.touches.get(&u.to_bits()).map(Touch::depth)).collect();
        let film_everywhere = depths.iter().all(|depth| depth.is_none_or(|depth| depth >= most));
        let contact_everywhere = depths.iter().all(|depth| depth.is_some_and(|depth| depth <= least));
        self.has_touch = !film_everywhere && !contact_everywhere;
        if self.has_touch {
            for depth in depths {
                let Some(depth) = depth else {
                    let allowed = "a range in which the solids touch at all speeds or at none; take fewer speeds";
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

    /// Finds first touch at these speeds: by Newton's method on the least film thickness, and by halving.
    fn find_touches(&mut self, log_speeds: &[f64], guess: f64) -> Result<(), Error> {
        let span = self.range.depths[1] - self.range.depths[0];
        let limits = [self.range.depths[0] - span, self.range.depths[1] + span];
        let precision = TOUCH_PRECISION * span;
        let known = self.chart().filter(|chart| !chart.touch.is_empty());
        let mut searches: Vec<Search> = log_speeds
            .iter()
            .filter(|u| !self.touches.contains_key(&u.to_bits()))
            .map(|&log_speed| {
                let near = known.as_ref().and_then(|chart| chart.touch(log_speed));
                let next = near.map_or(guess, |[depth, _]| depth - precision);
                Search { log_speed, apart: None, touching: None, next: Some(next), stride: 8.0 * precision }
            })
            .collect();
        loop {
            let trials: Vec<(usize, f64)> =
                searches.iter().enumerate().filter_map(|(i, search)| Some((i, search.next?))).collect();
            if trials.is_empty() {
                break;
            }
            let points: Vec<Inputs> =
                trials.iter().map(|(i, depth)| self.inputs(*depth, searches[*i].log_speed)).collect();
            for ((i, _), sample) in trials.into_iter().zip(self.solve(&points)?) {
                searches[i].learn(sample, precision, limits);
            }
        }
        for search in searches {
            if let (Some(apart), Some(touching)) = (search.apart, search.touching) {
                self.touches.insert(search.log_speed.to_bits(), Touch { apart, touching });
            }
        }
        Ok(())
    }

    /// The coordinates of the present lines, if first touch is known on all of them.
    fn chart(&self) -> Option<Chart> {
        let touch = match self.has_touch {
            true => {
                self.log_speeds.iter().map(|u| Some(self.touches.get(&u.to_bits())?.depth())).collect::<Option<_>>()?
            }
            false => Vec::new(),
        };
        Some(Chart { depths: self.depths, log_speeds: self.log_speeds.clone(), touch })
    }

    /// The depth at a place of the grid, where first touch at that speed has been found.
    fn depth(&self, (side, station, u): (Side, f64, f64)) -> f64 {
        let touch = if self.has_touch { self.touches.get(&u.to_bits()).map(Touch::depth) } else { None };
        let touch: Vec<f64> = touch.map_or(Vec::new(), |depth| vec![depth; 2]);
        Chart { depths: self.depths, log_speeds: vec![u, u + 1.0], touch }.depth(side, station, u).value
    }

    /// Solves the places that have not been solved yet.
    fn fill(&mut self, places: &[(Side, f64, f64)]) -> Result<(), Error> {
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
        let points: Vec<Inputs> = missing.iter().map(|(_, _, u, depth)| self.inputs(*depth, *u)).collect();
        let found = self.solve(&points)?;
        for ((side, station, u, _), sample) in missing.into_iter().zip(found) {
            self.samples.insert((side, station.to_bits(), u.to_bits()), sample);
        }
        Ok(())
    }

    /// The table of the present lines.
    fn model(&self) -> Result<ReducedModel, Error> {
        let missing = || Error::State("the table of the reduced model has a gap".into());
        let chart = self.chart().ok_or_else(missing)?;
        let mut grids = Vec::new();
        for (side, stations) in &self.stations {
            let mut states = Vec::with_capacity(4 * QUANTITIES * stations.len() * chart.log_speeds.len());
            for u in &chart.log_speeds {
                for station in stations {
                    let key = (*side, station.to_bits(), u.to_bits());
                    let sample = self.samples.get(&key).ok_or_else(missing)?;
                    let start = states.len();
                    states.extend(sample.state.iter().flatten().map(|value| *value as f32));
                    if self.has_touch && *station == if *side == Side::Film { 1.0 } else { 0.0 } {
                        states[start + place::MINIMUM_FILM] = 0.0;
                    }
                }
            }
            grids.push(Grid { side: *side, stations: stations.clone(), states });
        }
        let (parameters, range, accuracy) = (*self.parameters, self.range, Accuracy::default());
        Ok(ReducedModel::new(Content { parameters, range, accuracy, chart, grids }))
    }

    fn refine(&mut self) -> Result<ReducedModel, Error> {
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

    fn compare(&self, model: &ReducedModel, sample: &Sample) -> Result<Comparison, Error> {
        let inputs = &sample.inputs;
        let side = if sample.touching { Side::Contact } else { Side::Film };
        let (full, full_slopes) = model.outputs(inputs, &sample.state, side);
        // Halfway states may lie beyond the range that is asked for, and first touch is where the table says.
        let chart = &model.content.chart;
        let u = model.log_speed(inputs.sliding_speed);
        let state_at = |depth: f64| {
            let (side, station) = chart.station(self.stations[0].0, depth, u);
            let patch = model.patches.iter().find(|patch| patch.side == side).unwrap_or(&model.patches[0]);
            (side, patch.state(chart, station, u))
        };
        let (side, state) = state_at(inputs.penetration_depth);
        let (table, table_slopes) = model.outputs(inputs, &state, side);
        let touch = chart.touch(u).map(|[depth, _]| (depth, state_at(depth).1[0][place::CENTRAL_FILM]));
        let near = NEAR_TOUCH * (self.range.depths[1] - self.range.depths[0]);
        Ok(Comparison {
            near_touch: touch.is_some_and(|(depth, _)| (inputs.penetration_depth - depth).abs() < near),
            thin_film: touch.map_or(0.0, |(_, film)| film),
            stiffness: [full_slopes[0].load, table_slopes[0].load],
            full,
            table,
        })
    }
}

/// The table beside the full model.
struct Comparison {
    full: Outputs,
    table: Outputs,
    /// dL/dd of both [N/m^2].
    stiffness: [f64; 2],
    near_touch: bool,
    /// Film in the middle of the contact at first touch at this speed.
    thin_film: f64,
}

impl Comparison {
    /// |table - full| over the larger of |full| and a scale.
    fn relative(&self, of: fn(&Outputs) -> f64, scale: f64) -> f64 {
        deviation([of(&self.full), of(&self.table)], scale)
    }

    fn load(&self) -> f64 {
        self.relative(|o| o.load, 0.0)
    }

    fn film(&self) -> f64 {
        self.relative(|o| o.minimum_film_thickness, self.thin_film)
    }

    fn friction(&self) -> f64 {
        self.relative(|o| o.friction_coefficient, 0.0)
    }

    /// The largest error as a multiple of what is allowed.
    fn excess(&self, tolerance: &Tolerance) -> f64 {
        let friction = if self.near_touch { 0.0 } else { self.friction() / tolerance.friction_coefficient };
        (self.load() / tolerance.load)
            .max(self.film() / tolerance.minimum_film_thickness)
            .max(self.fluid_pressure() / tolerance.fluid_pressure)
            .max(friction)
    }

    fn fluid_pressure(&self) -> f64 {
        self.profile(|o| &o.fluid_pressure, |_| true, self.full.maximum_fluid_pressure)
    }

    /// Root mean square difference of a profile over a scale, at the stations that `counts` says.
    fn profile(&self, of: fn(&Outputs) -> &[f64], counts: impl Fn(f64) -> bool, scale: f64) -> f64 {
        let stations = of(&self.full).iter().zip(of(&self.table)).filter(|(full, _)| counts(**full));
        let (sum, count) = stations.fold((0.0, 0.0), |(sum, count), (a, b)| (sum + (a - b).powi(2), count + 1.0));
        if sum == 0.0 { 0.0 } else { (sum / count).sqrt() / scale }
    }
}

fn deviation([full, table]: [f64; 2], scale: f64) -> f64 {
    if full == table { 0.0 } else { (table - full).abs() / full.abs().max(scale) }
}

fn accuracy(comparisons: &[Comparison]) -> Accuracy {
    let of = |error: &dyn Fn(&Comparison) -> Option<f64>| {
        let errors: Vec<f64> = comparisons.iter().filter_map(error).collect();
        let mean = errors.iter().map(|e| e * e).sum::<f64>() / errors.len().max(1) as f64;
        Deviation { largest: errors.iter().copied().fold(0.0, f64::max), root_mean_square: mean.sqrt() }
    };
    Accuracy {
        states: comparisons.len(),
        load: of(&|c| Some(c.load())),
        minimum_film_thickness: of(&|c| Some(c.film())),
        friction_coefficient: of(&|c| (!c.near_touch).then(|| c.friction())),
        friction_coefficient_near_touch: of(&|c| c.near_touch.then(|| c.friction())),
        film_thickness: of(&|c| {
            let scale = c.full.central_film_thickness.max(c.thin_film);
            Some(c.profile(|o| &o.film_thickness, |h| h < 10.0 * scale, scale))
        }),
        fluid_pressure: of(&|c| Some(c.fluid_pressure())),
        contact_pressure: of(&|c| {
            let scale = c.full.maximum_contact_pressure;
            (!c.near_touch && scale > 0.0).then(|| c.profile(|o| &o.contact_pressure, |_| true, scale))
        }),
        maximum_von_mises_stress: of(&|c| Some(c.relative(|o| o.maximum_von_mises_stress, 0.0))),
        contact_stiffness: of(&|c| (!c.near_touch).then(|| deviation(c.stiffness, 0.0))),
    }
}

/// A speed on the way to first touch.
struct Search {
    log_speed: f64,
    apart: Option<Sample>,
    touching: Option<Sample>,
    /// The next depth to try; `None` when it is done.
    next: Option<f64>,
    stride: f64,
}

impl Search {
    fn learn(&mut self, sample: Sample, precision: f64, limits: [f64; 2]) {
        let depth = |sample: &Sample| sample.inputs.penetration_depth;
        if sample.touching {
            self.touching = Some(sample);
        } else {
            self.apart = Some(sample);
        }
        self.next = match (&self.apart, &self.touching) {
            (Some(apart), Some(touching)) if depth(touching) - depth(apart) <= precision => None,
            (Some(apart), Some(touching)) => {
                let (a, b) = (depth(apart), depth(touching));
                let inside = apart.closing().map(|depth| depth + 0.4 * precision).filter(|d| *d < b - 0.2 * precision);
                Some(inside.unwrap_or(0.5 * (a + b)))
            }
            (Some(apart), None) => {
                self.stride *= 2.0;
                let beyond = apart.closing().unwrap_or(depth(apart)).max(depth(apart)) + 0.4 * precision;
                Some(beyond.max(depth(apart) + precision).min(limits[1])).filter(|_| depth(apart) < limits[1])
            }
            (None, Some(touching)) => {
                self.stride *= 2.0;
                Some((depth(touching) - self.stride).max(limits[0])).filter(|_| depth(touching) > limits[0])
            }
            (None, None) => None,
        };
    }
}

impl Sample {
    /// Where the film closes on its tangent.
    fn closing(&self) -> Option<f64> {
        let [film, slope] = [0, 1].map(|k| self.state[k][place::MINIMUM_FILM]);
        (slope < 0.0).then(|| self.inputs.penetration_depth - film / slope)
    }
}

fn sample(simulation: &mut Simulation) -> Result<Sample, Error> {
    let (p, inputs, outputs) = (*simulation.parameters(), *simulation.inputs(), simulation.outputs().clone());
    let boundary = boundary_friction(&p, &inputs);
    let mut state = Box::new([primitives(&outputs, boundary[0] * outputs.solid_load, p.width); 4]);
    for input in [Input::PenetrationDepth, Input::SlidingSpeed, Input::SlideToRollRatio] {
        let (k, derivatives) = (1 + input as usize, simulation.derivatives(input)?);
        let friction = boundary[0] * derivatives.solid_load + boundary[k] * outputs.solid_load;
        state[k] = primitives(derivatives, friction, p.width);
    }
    let touching = matches!(outputs.lubrication_regime, Regime::BoundaryContact | Regime::HighFriction);
    Ok(Sample { inputs, state, touching })
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
