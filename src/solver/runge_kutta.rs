//! The two-stage, stiffly accurate, L-stable diagonally implicit Runge-Kutta method of second order: R. Alexander, SIAM Journal on
//! Numerical Analysis 14 (1977) 1006-1021.

use super::time_stepping::LARGEST_GROWTH;

/// The method's diagonal, 1 - 1/sqrt(2).
pub const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// Error in one step over step^3 times the third derivative, 1/6 - 3 gamma^2 + 2 gamma^3 without its sign.
pub const ERROR_CONSTANT: f64 = 3.0 * GAMMA * GAMMA - 2.0 * GAMMA * GAMMA * GAMMA - 1.0 / 6.0;

/// A stage: d/dt = present * (value in the stage) + before * (value at the start) + first * (d/dt in the first stage).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// When it is, after the start \[s\].
    pub time: f64,
    /// Factor of the value in the stage \[1/s\].
    pub present: f64,
    /// Factor of the value at the start \[1/s\].
    pub before: f64,
    /// Factor of the time derivative in the first stage.
    pub first: f64,
}

/// The stages of a step; the second one is its end.
pub fn stages(step: f64) -> [Stage; 2] {
    let rate = 1.0 / (GAMMA * step);
    [
        Stage { time: GAMMA * step, present: rate, before: -rate, first: 0.0 },
        Stage { time: step, present: rate, before: -rate, first: -(1.0 - GAMMA) / GAMMA },
    ]
}

/// Values of which linear combinations are taken.
pub trait Linear {
    /// a * self + b * other, value by value.
    #[must_use]
    fn combined(&self, a: f64, b: f64, other: &Self) -> Self;

    /// a * self.
    #[must_use]
    fn scaled(&self, a: f64) -> Self
    where
        Self: Sized,
    {
        self.combined(a, 0.0, self)
    }
}

/// By how much a step could have been longer for the error that is allowed; below 1 it was too long. From the time derivatives in both
/// stages and, where known, at the start. `size` is asked for the size, over what is allowed, of the error in the solution that comes of
/// one in the time derivative of the second stage.
///
/// # Errors
/// Those of `size`.
pub fn growth<V: Linear, E>(
    before: Option<&V>,
    [first, second]: [&V; 2],
    mut size: impl FnMut(&V) -> Result<f64, E>,
) -> Result<f64, E> {
    let mut size = |error: &V| Ok(size(error)?.max(1e-9));
    // Against the method of first order that goes on with the rates of the first stage; the error in what is stored is this
    // times gamma times the step, which the tangent divides by again.
    let change = second.combined(1.0, -1.0, first);
    let by_first_order = size(&change)?.powf(-1.0 / 2.0);
    // Where the motion is smooth the error of the method itself is less: its error constant times the third derivative, from
    // divided differences of the rates at the start and at the two stages.
    let Some(before) = before.filter(|_| by_first_order < LARGEST_GROWTH) else { return Ok(by_first_order) };
    let earlier = first.combined(1.0, -1.0, before);
    let error = change.combined(1.0 / (1.0 - GAMMA), -1.0 / GAMMA, &earlier).scaled(2.0 * ERROR_CONSTANT / GAMMA);
    Ok(by_first_order.max(size(&error)?.powf(-1.0 / 3.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Linear for f64 {
        fn combined(&self, a: f64, b: f64, other: &Self) -> Self {
            a * self + b * other
        }
    }

    /// Of y' = cos t one step from time 1: its rates are known, and what is off in the rate is off in the solution times gamma h.
    #[test]
    fn growth_is_that_to_the_allowed_error_of_the_method() {
        let (time, step): (f64, f64) = (1.0, 1e-2);
        let rates = [0.0, GAMMA * step, step].map(|after| (time + after).cos());
        let error = |step: f64| ERROR_CONSTANT * step.powi(3) * time.cos();
        for allowed in [error(0.7 * step), error(2.0 * step)] {
            let size = |error: &f64| Ok::<_, ()>((error * GAMMA * step).abs() / allowed);
            let growth = growth(Some(&rates[0]), [&rates[1], &rates[2]], size).unwrap();
            let expected = (allowed / error(step)).cbrt();
            assert!((growth / expected - 1.0).abs() < 0.02, "{growth} {expected}");
        }
        // Where the rates at the start are not known, by the error of the method of first order.
        let by_first_order = |change: &f64| Ok::<_, ()>(change.abs());
        assert_eq!(growth(None, [&1.0, &1.25], by_first_order), Ok(2.0));
        assert_eq!(growth(None, [&1.0, &1.0], |_: &f64| Err("singular")), Err("singular"));
    }

    /// Steps of y' = -y from 1, after time 1.
    fn decayed(steps: u32) -> f64 {
        let step = 1.0 / f64::from(steps);
        let [one, two] = stages(step);
        (0..steps).fold(1.0, |y, _| {
            let first = -one.before * y / (one.present + 1.0);
            -(two.before * y - two.first * first) / (two.present + 1.0)
        })
    }

    #[test]
    fn error_has_the_stated_order_and_constant() {
        let errors = [10, 20].map(|steps| decayed(steps) - (-1.0_f64).exp());
        assert!((errors[0] / errors[1] - 4.0).abs() < 0.3);
        // Of one step: y - exact = -C h^3 y''' with y''' = -y.
        let h: f64 = 1e-2;
        let [one, two] = stages(h);
        let first = -one.before / (one.present + 1.0);
        let y = -(two.before - two.first * first) / (two.present + 1.0);
        assert!(((y - (-h).exp()).abs() / h.powi(3) / ERROR_CONSTANT - 1.0).abs() < 0.05);
    }

    #[test]
    fn what_is_stiff_is_gone_after_a_step() {
        let [one, two] = stages(1.0);
        let stiff = 1e8;
        let first = one.before - one.present * one.before / (one.present + stiff);
        let y = -(two.before + two.first * first) / (two.present + stiff);
        assert!(y.abs() < 1e-7);
    }
}
