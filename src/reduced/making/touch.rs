//! First touch: the depth at which the film first closes at a speed; that of rough surfaces at which it is as thin as they are rough. There it lifts them
//! apart, within a few per cent of the speed.

use super::super::quantities::MINIMUM_FILM;
use super::{Builder, Progress, Sample, sample};
use crate::error::Error;
use crate::simulation::Simulation;
use crate::sweep;

/// First touch is found to this fraction of the range of depths.
const TOUCH_PRECISION: f64 = 1e-4;

/// Where the film first closes at one speed: the last state without contact, the first one with.
pub(super) struct Touch {
    pub(super) apart: Sample,
    pub(super) touching: Sample,
}

impl Touch {
    pub(super) fn depth(&self) -> f64 {
        0.5 * (self.apart.depth + self.touching.depth)
    }
}

impl Builder<'_> {
    /// Finds first touch at these speeds: by Newton's method on the least film thickness, and by halving.
    pub(super) fn find_touches(&mut self, log_speeds: &[f64], guess: f64) -> Result<(), Error> {
        let [least, most] = self.asked;
        let span = most - least;
        let limits = [least - span, most + span];
        let precision = TOUCH_PRECISION * span;
        let known = self.chart().filter(|chart| !chart.touch.is_empty());
        let mut searches: Vec<Search> = log_speeds
            .iter()
            .filter(|u| !self.touches.contains_key(&u.to_bits()))
            .map(|&log_speed| {
                let near = known.as_ref().and_then(|chart| chart.touch(log_speed.exp()));
                let next = near.map_or(guess, |[depth, _]| depth - precision);
                Search { log_speed, apart: None, touching: None, next: Some(next), increment: 8.0 * precision }
            })
            .collect();
        // Every state from the one before: those of one speed are near each other.
        let mut simulation = Simulation::new(self.parameters)?;
        let rest = simulation.snapshot();
        for search in &mut searches {
            while let Some(depth) = search.next {
                sweep::solve_next(&mut simulation, &rest, self.inputs(depth, search.log_speed))?;
                search.learn(sample(&mut simulation)?, precision, limits, self.parameters.surface_roughness);
                self.solved += 1;
                (self.progress)(Progress { solved: self.solved, planned: self.solved });
            }
        }
        for search in searches {
            if let (Some(apart), Some(touching)) = (search.apart, search.touching) {
                self.touches.insert(search.log_speed.to_bits(), Touch { apart, touching });
            }
        }
        Ok(())
    }
}

/// A speed on the way to first touch.
struct Search {
    log_speed: f64,
    apart: Option<Sample>,
    touching: Option<Sample>,
    /// The next depth to try; `None` when it is done.
    next: Option<f64>,
    increment: f64,
}

impl Search {
    fn learn(&mut self, sample: Sample, precision: f64, limits: [f64; 2], film: f64) {
        let depth = |sample: &Sample| sample.depth;
        if sample.touching {
            self.touching = Some(sample);
        } else {
            self.apart = Some(sample);
        }
        self.next = match (&self.apart, &self.touching) {
            (Some(apart), Some(touching)) if depth(touching) - depth(apart) <= precision => None,
            (Some(apart), Some(touching)) => {
                let (a, b) = (depth(apart), depth(touching));
                let inside =
                    apart.closing(film).map(|depth| depth + 0.4 * precision).filter(|d| *d < b - 0.2 * precision);
                Some(inside.unwrap_or(0.5 * (a + b)))
            }
            (Some(apart), None) => {
                self.increment *= 2.0;
                let beyond = apart.closing(film).unwrap_or(depth(apart)).max(depth(apart)) + 0.4 * precision;
                Some(beyond.max(depth(apart) + precision).min(limits[1])).filter(|_| depth(apart) < limits[1])
            }
            (None, Some(touching)) => {
                self.increment *= 2.0;
                Some((depth(touching) - self.increment).max(limits[0])).filter(|_| depth(touching) > limits[0])
            }
            (None, None) => None,
        };
    }
}

impl Sample {
    /// Where the film closes to this thickness on its tangent.
    fn closing(&self, least: f64) -> Option<f64> {
        let [film, slope] = [0, 1].map(|k| self.state[k][MINIMUM_FILM]);
        (slope < 0.0).then(|| self.depth - (film - least) / slope)
    }
}
