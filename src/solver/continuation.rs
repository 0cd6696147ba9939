//! Steps along a path: as long as they succeed, shorter where they do not.

/// Where a path ended early.
#[derive(Debug, Clone, PartialEq)]
pub struct Stuck<E> {
    /// Fraction of the path that was covered.
    pub fraction: f64,
    /// Why the next step failed, however short.
    pub reason: E,
}

/// A step that took so many iterations is followed by one as long.
const WISHED: f64 = 7.0;
/// By what factor steps grow at most: one that fails costs more than some that are shorter.
const LARGEST_GROWTH: f64 = 1.3;

/// Goes from 0 to 1, at first by a step of length `first`, and by none shorter than `shortest`. `attempt(to)` tries one step: it moves
/// its caller's state and says how many iterations that took, or leaves it alone and says why.
///
/// # Errors
/// [`Stuck`] where even the shortest step fails.
pub fn advance<E>(first: f64, shortest: f64, mut attempt: impl FnMut(f64) -> Result<usize, E>) -> Result<(), Stuck<E>> {
    let (mut done, mut step) = (0.0, first);
    while done < 1.0 {
        // The last step ends on 1 exactly.
        let target = if done + step >= 1.0 - 1e-12 { 1.0 } else { done + step };
        match attempt(target) {
            Ok(iterations) => {
                done = target;
                step *= (WISHED / iterations as f64).clamp(0.5, LARGEST_GROWTH);
            }
            Err(reason) if step <= shortest => return Err(Stuck { fraction: done, reason }),
            Err(_) => step *= 0.4,
        }
        step = step.min(1.0 - done).max(shortest);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shortens_on_failure_and_grows_on_success() {
        let (mut steps, mut from) = (Vec::new(), 0.0);
        let result = advance(1.0, 1e-3, |to| {
            // Steps longer than 0.3 fail.
            if to - from > 0.3 {
                return Err("too long");
            }
            steps.push(to - from);
            from = to;
            Ok(5)
        });
        assert_eq!(result, Ok(()));
        assert!((steps.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(steps.len() <= 6, "{steps:?}");
    }

    #[test]
    fn says_how_far_it_came() {
        let result = advance(1.0, 1e-3, |to| if to > 0.6 { Err("wall") } else { Ok(9) });
        let stuck = result.unwrap_err();
        assert_eq!(stuck.reason, "wall");
        assert!(stuck.fraction > 0.598 && stuck.fraction <= 0.6);
    }
}
