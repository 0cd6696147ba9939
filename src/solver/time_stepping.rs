//! Steps in time, as long as the error allows that their method estimates.
//!
//! The steps of an interval are the whole interval halved again and again, so that a small change of what is solved does not change
//! them.

/// Steps are no shorter than the interval over two to this power.
const HALVINGS: i32 = 24;
/// Most steps of an interval, tried and taken: a host tool must not wait for ever.
const MOST_TRIALS: usize = 20_000;

/// Steps are that much shorter than their error would allow.
const SAFETY: f64 = 0.9;
/// How much longer than it was a step could have been is not asked beyond this.
pub const LARGEST_GROWTH: f64 = 4.5;

/// What can step in time.
pub trait Method {
    /// A step that was solved.
    type Step;
    /// Why one was not.
    type Reason: From<String>;

    /// Tries a step from `time` after the start. Returns it with the factor by which it could have been longer for the error that is
    /// allowed: below 1 it was too long.
    ///
    /// # Errors
    /// [`Failure`] where there is no such step.
    fn attempt(&mut self, time: f64, step: f64) -> Result<(Self::Step, f64), Failure<Self::Reason>>;

    /// Takes a step that was tried, of this length.
    fn accept(&mut self, solved: Self::Step, step: f64);
}

/// Why a step was not solved.
#[derive(Debug, Clone, PartialEq)]
pub enum Failure<E> {
    /// A shorter one may be.
    Retry(E),
    /// Nor would a shorter one be.
    Stop(E),
}

/// Where an interval ended early.
#[derive(Debug, Clone, PartialEq)]
pub struct Stuck<E> {
    /// After the start \[s\].
    pub time: f64,
    /// Why the next step failed, however short.
    pub reason: E,
}

/// Goes through an interval by steps of at most `longest`, at first of about `wanted`. Returns their lengths, and the length that the
/// next one should have.
///
/// # Errors
/// [`Stuck`] where it does not get to the end.
pub fn advance<M: Method>(
    method: &mut M,
    duration: f64,
    mut wanted: f64,
    longest: f64,
) -> Result<(Vec<f64>, f64), Stuck<M::Reason>> {
    let shortest = f64::from(-HALVINGS).exp2();
    let (mut done, mut steps) = (0.0, Vec::new());
    for _ in 0..MOST_TRIALS {
        let fraction = fraction_of(done, (1.2 * wanted).min(longest) / duration);
        let (time, step) = (done * duration, fraction * duration);
        match method.attempt(time, step) {
            Ok((_, growth)) if growth < 1.0 && fraction > shortest => {
                wanted = step * (SAFETY * growth).clamp(0.1, 0.4);
            }
            Ok((solved, growth)) => {
                method.accept(solved, step);
                steps.push(step);
                done += fraction;
                wanted = step * SAFETY * growth.min(LARGEST_GROWTH);
            }
            Err(Failure::Retry(_)) if fraction > shortest => wanted = 0.2 * step,
            Err(Failure::Retry(reason) | Failure::Stop(reason)) => return Err(Stuck { time, reason }),
        }
        if done >= 1.0 {
            return Ok((steps, wanted));
        }
    }
    Err(Stuck { time: done * duration, reason: format!("{MOST_TRIALS} internal steps were not enough").into() })
}

/// The next step as a fraction of the interval: one over a power of two, not above `most`, and ending where steps of that length end.
fn fraction_of(done: f64, most: f64) -> f64 {
    let mut fraction = most.min(1.0).log2().floor().exp2();
    // Exact: both are sums of powers of two.
    while (done / fraction).fract() != 0.0 {
        fraction *= 0.5;
    }
    fraction
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::runge_kutta::{GAMMA, growth, stages};

    /// y' = -k (y - cos t) - sin t, whose solution is cos t + (y(0) - 1) exp(-k t).
    struct Decay {
        y: f64,
        tolerance: f64,
        /// Longer steps fail.
        longest: f64,
        stops: bool,
        trials: usize,
    }

    const DECAY: Decay = Decay { y: 2.0, tolerance: 1e-4, longest: 9.0, stops: false, trials: 0 };

    const STIFFNESS: f64 = 1e3;

    impl Method for Decay {
        type Step = f64;
        type Reason = String;

        fn attempt(&mut self, time: f64, step: f64) -> Result<(f64, f64), Failure<String>> {
            self.trials += 1;
            if step > self.longest {
                let reason = format!("too long at {time}");
                return Err(if self.stops { Failure::Stop(reason) } else { Failure::Retry(reason) });
            }
            let mut rates = [0.0; 2];
            let mut y = self.y;
            for (i, stage) in stages(step).into_iter().enumerate() {
                let known = stage.before * self.y + stage.first * rates[0];
                let (sin, cos) = (time + stage.time).sin_cos();
                y = (STIFFNESS * cos - sin - known) / (stage.present + STIFFNESS);
                rates[i] = stage.present * y + known;
            }
            let size =
                |error: &f64| Ok((error * GAMMA * step / (1.0 + GAMMA * step * STIFFNESS)).abs() / self.tolerance);
            let growth = growth(None, [&rates[0], &rates[1]], size).map_err(Failure::Retry)?;
            Ok((y, growth))
        }

        fn accept(&mut self, solved: f64, _: f64) {
            self.y = solved;
        }
    }

    #[test]
    fn steps_are_short_where_the_solution_is_fast_and_its_error_is_near_what_is_allowed() {
        for tolerance in [1e-3, 1e-5] {
            let mut decay = Decay { tolerance, ..DECAY };
            let (steps, next) = advance(&mut decay, 3.0, 3.0, 0.5).unwrap();
            let error = (decay.y - 3.0_f64.cos()).abs();
            assert!(error < tolerance && error > 1e-2 * tolerance, "{error}");
            // The fast part, which lasts some milliseconds, is followed.
            assert!(steps.iter().take_while(|step| **step < 1e-3).count() > 5, "{steps:?}");
            assert!(next > 100.0 * steps[0] && steps.iter().all(|step| *step <= 0.5), "{steps:?}");
            // Each is the whole halved again and again, and ends where steps of its length end.
            let mut done = 0.0;
            for step in steps {
                assert_eq!((step / 3.0).log2().fract(), 0.0);
                assert_eq!((done / step).fract(), 0.0);
                done += step;
            }
            assert_eq!(done, 3.0);
        }
    }

    #[test]
    fn a_small_change_of_what_is_wanted_changes_no_step() {
        let run = |wanted| {
            let mut decay = DECAY;
            (advance(&mut decay, 1.0, wanted, 1.0), decay.y)
        };
        assert_eq!(run(1.1e-3), run(1.2e-3));
    }

    #[test]
    fn steps_that_fail_are_tried_shorter_or_not_at_all() {
        let gentle = Decay { y: 1.0, tolerance: 1.0, ..DECAY };
        let (steps, _) = advance(&mut Decay { longest: 0.1, ..gentle }, 1.0, 1.0, 1.0).unwrap();
        assert!(steps.iter().all(|step| *step <= 0.1) && steps.iter().sum::<f64>() == 1.0);
        for stops in [false, true] {
            let mut never = Decay { longest: 0.0, stops, ..gentle };
            let stuck = advance(&mut never, 1.0, 1.0, 1.0).unwrap_err();
            assert_eq!((stuck.time, &*stuck.reason), (0.0, "too long at 0"));
            assert_eq!(never.trials == 1, stops, "{}", never.trials);
        }
    }
}
