//! Polynomials in one variable: slopes through points, cubics between them, and powers of the speed towards rest.

/// Slope at point `i` of the parabola through it and its neighbours; at an end, through the last three points.
pub fn slope(x: &[f64], y: impl Fn(usize) -> f64, i: usize) -> f64 {
    let last = x.len() - 1;
    if last == 0 {
        return 0.0;
    }
    let rise = |k: usize| (y(k + 1) - y(k)) / (x[k + 1] - x[k]);
    if last == 1 {
        return rise(0);
    }
    let middle = i.clamp(1, last - 1);
    let curvature = (rise(middle) - rise(middle - 1)) / (x[middle + 1] - x[middle - 1]);
    rise(middle - 1) + curvature * (2.0 * x[i] - x[middle - 1] - x[middle])
}

/// Weights of value and slope at the two ends of an interval: for the value of a cubic, and for its derivative.
pub struct Cubic {
    /// The point at which the interval begins.
    pub first: usize,
    /// For the value: end by end, the weights of value and slope.
    pub value: [[f64; 2]; 2],
    /// For the derivative.
    pub slope: [[f64; 2]; 2],
    /// Place in the interval, from 0 to 1.
    pub fraction: f64,
}

impl Cubic {
    /// At a place on the axis; beyond its ends the last cubic goes on.
    pub fn at(axis: &[f64], place: f64) -> Self {
        let first = axis.partition_point(|x| *x <= place).saturating_sub(1).min(axis.len() - 2);
        let width = axis[first + 1] - axis[first];
        let t = (place - axis[first]) / width;
        Self {
            first,
            value: [
                [(1.0 + 2.0 * t) * (1.0 - t).powi(2), t * (1.0 - t).powi(2) * width],
                [t * t * (3.0 - 2.0 * t), t * t * (t - 1.0) * width],
            ],
            slope: [
                [6.0 * t * (t - 1.0) / width, (1.0 - t) * (1.0 - 3.0 * t)],
                [6.0 * t * (1.0 - t) / width, t * (3.0 * t - 2.0)],
            ],
            fraction: t,
        }
    }
}

/// How a quantity between rest and the slowest line depends on the change from rest to that line and on its slope there, by w:
/// weights of both for the value, and for its derivative with respect to w.
pub type Weights = [[f64; 2]; 2];

/// With even powers of w.
pub fn even(w: f64) -> Weights {
    [[w * w * (2.0 - w * w), 0.5 * w * w * (w * w - 1.0)], [4.0 * w * (1.0 - w * w), w * (2.0 * w * w - 1.0)]]
}

/// With odd powers of w.
pub fn odd(w: f64) -> Weights {
    [[0.5 * w * (3.0 - w * w), 0.5 * w * (w * w - 1.0)], [1.5 * (1.0 - w * w), 0.5 * (3.0 * w * w - 1.0)]]
}

/// With |w| and its square.
pub fn kinked(w: f64) -> Weights {
    [[w * (2.0 - w), w * (w - 1.0)], [2.0 * (1.0 - w), 2.0 * w - 1.0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_has_its_slopes() {
        let x = [0.0, 1.0, 3.0, 4.5];
        for (i, x_i) in x.iter().enumerate() {
            assert!((slope(&x, |k| x[k] * x[k] - x[k], i) - (2.0 * x_i - 1.0)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_cubic_is_reproduced_with_its_derivative() {
        let (f, g) = (|x: f64| x.powi(3) - 2.0 * x, |x: f64| 3.0 * x * x - 2.0);
        let axis = [-1.0, 0.5, 2.0];
        for place in [-1.0, -0.3, 0.5, 1.9, 2.0] {
            let cubic = Cubic::at(&axis, place);
            let sum = |weights: &[[f64; 2]; 2]| -> f64 {
                (0..2)
                    .map(|end| (end, axis[cubic.first + end]))
                    .map(|(e, x)| weights[e][0] * f(x) + weights[e][1] * g(x))
                    .sum()
            };
            assert!((sum(&cubic.value) - f(place)).abs() < 1e-12 && (sum(&cubic.slope) - g(place)).abs() < 1e-12);
        }
    }

    #[test]
    fn between_rest_and_the_slowest_line_values_and_slopes_are_met() {
        for (weights, power) in
            [(even as fn(f64) -> Weights, 2), (even, 4), (odd, 1), (odd, 3), (kinked, 1), (kinked, 2)]
        {
            // w^n changes by 1 from rest to the line, where its slope is n.
            for w in [0.0, 0.3, 1.0] {
                let [value, slope] = weights(w).map(|[change, slope]| change + slope * f64::from(power));
                assert!((value - w.powi(power)).abs() < 1e-12);
                assert!((slope - f64::from(power) * w.powi(power - 1)).abs() < 1e-12);
            }
        }
    }
}
