//! Where the next solution is expected, from those before: numbers that go on as they went.

use serde::{Deserialize, Serialize};

/// A quadratic extrapolation in time. It goes by the changes within steps alone: from step to step what is given may jump.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Trend {
    /// Rates of change in the last interval; empty where nothing is known.
    rates: Vec<f64>,
    /// How fast these change; empty likewise.
    changes: Vec<f64>,
    /// Half the length of that interval, which ended with a step \[s\].
    half: f64,
}

impl Trend {
    /// Whether it is of so many numbers, or of none.
    pub fn fits(&self, length: usize) -> bool {
        [&self.rates, &self.changes].into_iter().all(|values| values.is_empty() || values.len() == length)
    }

    /// What changes in an interval that begins so much after the last step, negative as an update of Newton's method.
    pub fn update(&self, after: f64, interval: f64) -> Vec<f64> {
        let mut update: Vec<f64> = self.rates.iter().map(|rate| -interval * rate).collect();
        let factor = interval * (self.half + after + 0.5 * interval);
        update.iter_mut().zip(&self.changes).for_each(|(update, change)| *update -= factor * change);
        update
    }

    /// With rates by which an interval from the last step on would have ended where it did: it missed that by so much.
    #[must_use]
    pub fn corrected(&self, missed: &[f64], interval: f64) -> Self {
        let rates = self.rates.iter().zip(missed).map(|(rate, missed)| rate + missed / interval).collect();
        Self { rates, ..self.clone() }
    }

    /// After a step at whose end an interval led from one list of values to another.
    #[must_use]
    pub fn followed(&self, [before, now]: [&[f64]; 2], interval: f64, step: f64) -> Self {
        let rates: Vec<f64> = before.iter().zip(now).map(|(before, now)| (now - before) / interval).collect();
        let between = self.half + step - 0.5 * interval;
        let changes = rates.iter().zip(&self.rates).map(|(now, before)| (now - before) / between).collect();
        Self { rates, changes, half: 0.5 * interval }
    }

    /// Without curvature, for motion with kinks.
    #[must_use]
    pub fn straight(self) -> Self {
        Self { changes: Vec::new(), ..self }
    }
}

/// The difference of a solution to its prediction. Along a smooth path it grows evenly from step to step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PredictorError {
    /// By how much what is given changed in the step.
    changes: Vec<f64>,
    now: Vec<f64>,
    /// That expected of a step like this one.
    next: Vec<f64>,
}

impl PredictorError {
    /// Of a step with these changes of what is given, after the error of the step before.
    pub fn new(before: Option<&Self>, changes: &[f64], solved: &[f64], predicted: &[f64]) -> Self {
        let now: Vec<f64> = solved.iter().zip(predicted).map(|(z, p)| z - p).collect();
        let next = match before.and_then(|before| Some((&before.now, proportion(changes, &before.changes)?))) {
            Some((before, ratio)) => now.iter().zip(before).map(|(now, before)| 2.0 * now - ratio * before).collect(),
            None => now.clone(),
        };
        Self { changes: changes.to_vec(), now, next }
    }

    /// Whether it is of so many numbers.
    pub fn fits(&self, length: usize) -> bool {
        self.now.len() == length && self.next.len() == length
    }

    /// That expected of a step with these changes, negative as an update of Newton's method; none where they go in another direction.
    pub fn update(&self, changes: &[f64]) -> Option<Vec<f64>> {
        let steps = proportion(changes, &self.changes)?;
        Some(self.next.iter().map(|error| -steps * error).collect())
    }
}

/// How many times as far as before changes go in the same direction; none if in another, or much further.
pub fn proportion(now: &[f64], then: &[f64]) -> Option<f64> {
    const ALIKE: f64 = 0.3;
    let mut ratios = now.iter().zip(then).filter(|(now, then)| **now != 0.0 || **then != 0.0);
    let ratio = ratios.next().map(|(now, then)| now / then)?;
    let alike = ratios.all(|(now, then)| (now / then - ratio).abs() <= ALIKE * ratio.abs());
    (alike && ratio.abs() < 3.0).then_some(ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What changes course at a step is met again in the second interval after it.
    #[test]
    fn a_trend_that_missed_is_corrected_for_what_follows() {
        let trend = Trend::default().followed([&[0.0, 0.0], &[0.2, 0.1]], 0.1, 0.1);
        // From there on 5 a second, and the first as before.
        let missed = [0.0, (5.0 - 1.0) * 0.03];
        let update = trend.corrected(&missed, 0.03).update(0.03, 0.07);
        let straight = trend.update(0.03, 0.07);
        assert_eq!(update[0], straight[0]);
        assert!((update[1] - (straight[1] - (5.0 - 1.0) * 0.07)).abs() < 1e-14, "{update:?} {straight:?}");
        // Where nothing is known nothing is corrected.
        assert!(Trend::default().corrected(&missed, 0.03).update(0.03, 0.07).is_empty());
    }

    /// Three steps of different lengths; the changes of each are known from the last 0.7 of it.
    #[test]
    fn motion_on_a_parabola_is_predicted_exactly() {
        let at = |t: f64| [1.0 - 2.0 * t + 3.0 * t * t, 4.0 * t - t * t];
        let (mut trend, mut time) = (Trend::default(), 0.0);
        for (index, step) in [0.1, 0.4, 0.2].into_iter().enumerate() {
            for (from, to) in [(0.0, 0.3), (0.3, 1.0)].map(|(a, b)| (a * step, b * step)) {
                let update = trend.update(from, to - from);
                let expected: Vec<f64> =
                    at(time + from).iter().zip(at(time + to)).map(|(before, now)| before - now).collect();
                match index {
                    0 => assert!(update.is_empty()),
                    // One interval tells no curvature.
                    1 => assert!(update.iter().zip(&expected).all(|(a, b)| (a - b).abs() > 1e-3)),
                    _ => assert!(update.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12), "{update:?}"),
                }
            }
            let interval = 0.7 * step;
            trend = trend.followed([&at(time + 0.3 * step), &at(time + step)], interval, step);
            time += step;
        }
        assert!(trend.fits(2) && !trend.fits(3) && Trend::default().fits(3));
        // On a line at the last interval's rate.
        let rate = -2.0 + 6.0 * (time - 0.07);
        assert!((trend.straight().update(0.5, 2.0)[0] + 2.0 * rate).abs() < 1e-12);
    }

    /// y = x^3, predicted by its slope at the start of each step of 1: the errors are 1, 4, 7.
    #[test]
    fn an_error_that_grows_evenly_is_predicted_exactly() {
        let error =
            |before: Option<&PredictorError>, x: f64| PredictorError::new(before, &[1.0], &[3.0 * x + 1.0], &[0.0]);
        let first = error(None, 0.0);
        assert_eq!(first.update(&[1.0]), Some(vec![-1.0]));
        let second = error(Some(&first), 1.0);
        assert_eq!(second.update(&[1.0]), Some(vec![-7.0]));
        assert_eq!(second.update(&[0.5]), Some(vec![-3.5]));
        assert_eq!(second.update(&[10.0]), None);
        assert!(second.fits(1) && !second.fits(2));
    }

    #[test]
    fn changes_go_on_in_proportion_or_elsewhere() {
        assert_eq!(proportion(&[2.0, 0.0, -4.0], &[1.0, 0.0, -2.0]), Some(2.0));
        assert_eq!(proportion(&[-1.0, 0.0], &[2.0, 0.0]), Some(-0.5));
        // Another direction, much further, nowhere.
        assert_eq!(proportion(&[1.0, 1.0], &[1.0, 0.0]), None);
        assert_eq!(proportion(&[1.0, 2.0], &[1.0, 1.0]), None);
        assert_eq!(proportion(&[4.0], &[1.0]), None);
        assert_eq!(proportion(&[0.0], &[0.0]), None);
    }
}
