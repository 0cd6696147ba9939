//! The two-stage, stiffly accurate, L-stable diagonally implicit Runge-Kutta method of second order: R. Alexander, SIAM Journal on
//! Numerical Analysis 14 (1977) 1006-1021.

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

#[cfg(test)]
mod tests {
    use super::*;

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
