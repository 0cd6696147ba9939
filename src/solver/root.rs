//! Roots of functions of one number.

/// Newton's method bisects where it leaves the bracket; so many steps are enough for that alone to end at the last bit.
const STEPS: usize = 100;

/// Where an increasing function is zero that is negative at `low` and positive at `high`, to a few last bits; `f` returns its value and its
/// derivative. Newton's method from `start`, which bisects where it leaves the bracket.
pub fn increasing([mut low, mut high]: [f64; 2], start: f64, f: impl Fn(f64) -> (f64, f64)) -> f64 {
    let mut x = start;
    for _ in 0..STEPS {
        let (value, slope) = f(x);
        if value < 0.0 {
            low = x
        } else {
            high = x
        }
        let newton = x - value / slope;
        let next = if (low..=high).contains(&newton) { newton } else { 0.5 * (low + high) };
        let change = (next - x).abs();
        x = next;
        if change <= 4.0 * f64::EPSILON * x.abs() || high - low <= 2.0 * f64::EPSILON * high.abs() {
            break;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn roots_are_found_to_the_last_bits_and_quickly_where_a_function_is_smooth() {
        let calls = Cell::new(0);
        let counted = |value: f64, slope: f64| {
            calls.set(calls.get() + 1);
            (value, slope)
        };
        let root = increasing([0.0, 2.0], 1.0, |x| counted(x * x * x - 2.0, 3.0 * x * x));
        assert!((root - 2.0_f64.cbrt()).abs() < 1e-15 && calls.get() < 9, "{root} after {}", calls.get());
        // From the flat of a step Newton's method would leave the bracket.
        calls.set(0);
        let root = increasing([-3.0, 5.0], -2.9, |x| {
            let place = (x - 1.0) / 1e-3;
            counted(place.atan() + 0.5, 1e3 / (1.0 + place * place))
        });
        assert!(
            (root - (1.0 - 1e-3 * 0.5_f64.tan())).abs() < 1e-15 && calls.get() < 40,
            "{root} after {}",
            calls.get()
        );
    }

    #[test]
    fn a_root_at_the_end_of_the_bracket_and_a_function_without_slope_end() {
        assert_eq!(increasing([0.0, 1.0], 0.5, |x| (x - 1.0, 1.0)), 1.0);
        let stepwise = increasing([0.0, 1.0], 0.3, |x| (if x < 0.7 { -1.0 } else { 1.0 }, 0.0));
        assert!((stepwise - 0.7).abs() < 1e-15);
    }
}
