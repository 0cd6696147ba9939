//! A steady state as the end of a motion in time. Bit by bit what is given becomes what it is to be; then the steps grow as they
//! succeed, until time plays no part.

/// What moves in time towards a steady state.
pub trait Motion {
    /// Why a step or the steady state was not solved.
    type Reason;

    /// Tries a step in time, at whose end what is given is so far on its way from 0 to 1. Moves there, or says why not; and the
    /// iterations spent.
    fn advance(&mut self, step: f64, fraction: f64) -> (Result<(), Self::Reason>, usize);

    /// Tries the steady state from where it is. Moves there, or says why not; and the iterations spent.
    fn settle(&mut self) -> (Result<(), Self::Reason>, usize);
}

/// Lengths of steps in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lengths {
    /// Of the first one \[s\].
    pub first: f64,
    /// Only after longer ones is it worth trying whether time plays no part any more \[s\].
    pub steady: f64,
    /// After a longer one time plays no part \[s\].
    pub longest: f64,
}

/// Steps are no shorter \[s\].
const SHORTEST: f64 = 1e-10;
/// Most iterations in all.
const MOST_ITERATIONS: usize = 2000;
/// By how much the portion of the way that is gone in a step grows at most.
const LARGEST_GROWTH: f64 = 1.5;
/// After so many steps that were quick to solve the steady state is tried.
const QUICK: usize = 3;

/// Goes to the steady state by steps in time, in the first of which a `portion` of the way of what is given is gone. Moves there, or says
/// why there is none; and the iterations spent.
pub fn relax<M: Motion>(motion: &mut M, lengths: &Lengths, mut portion: f64) -> (Result<(), M::Reason>, usize) {
    let (mut step, mut done) = (lengths.first, 0.0);
    let (mut patience, mut quick, mut spent) = (0, 0, 0);
    loop {
        if quick >= QUICK {
            let (result, iterations) = motion.settle();
            spent += iterations;
            if result.is_ok() || step > lengths.longest {
                return (result, spent);
            }
            quick = 0;
        }
        let next = f64::min(done + portion, 1.0);
        let (result, iterations) = motion.advance(step, next);
        spent += iterations;
        match result {
            Ok(()) => {
                patience -= 1;
                if next < 1.0 {
                    portion *= (5.0 / iterations as f64).clamp(0.5, LARGEST_GROWTH);
                } else if patience < 0 {
                    step *= [4.0, 2.5, 1.4][usize::from(iterations > 3) + usize::from(iterations > 5)];
                }
                quick = if next == 1.0 && iterations < 4 && step > lengths.steady { quick + 1 } else { 0 };
                done = next;
            }
            Err(reason) if step < SHORTEST || spent > MOST_ITERATIONS => return (Err(reason), spent),
            Err(_) if done < 1.0 => {
                portion /= 2.0;
                step /= 2.0;
            }
            Err(_) => {
                step /= 4.0;
                patience = 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y' = a - y by backward Euler, where a goes from 0 to 2; steps fail that are longer, or in which a changes by more.
    struct Decay {
        y: f64,
        a: f64,
        longest: f64,
        largest: f64,
        steps: Vec<f64>,
    }

    impl Motion for Decay {
        type Reason = &'static str;

        fn advance(&mut self, step: f64, fraction: f64) -> (Result<(), Self::Reason>, usize) {
            let a = 2.0 * fraction;
            if step > self.longest || a - self.a > self.largest {
                return (Err("too far"), 10);
            }
            self.a = a;
            self.y = (self.y + step * a) / (1.0 + step);
            self.steps.push(step);
            (Ok(()), 3)
        }

        fn settle(&mut self) -> (Result<(), Self::Reason>, usize) {
            if (self.y - self.a).abs() > 1e-3 {
                return (Err("still moving"), 1);
            }
            self.y = self.a;
            (Ok(()), 1)
        }
    }

    const LENGTHS: Lengths = Lengths { first: 1e-3, steady: 1e-2, longest: 1e3 };

    #[test]
    fn what_is_given_goes_first_and_then_the_steps_grow_until_time_plays_no_part() {
        let mut decay = Decay { y: 1.0, a: 0.0, longest: 1e9, largest: 9.0, steps: Vec::new() };
        let (result, spent) = relax(&mut decay, &LENGTHS, 0.25);
        assert_eq!((result, decay.y), (Ok(()), 2.0));
        let taken = decay.steps.len();
        assert!(taken < 20 && spent < 4 * taken, "{spent} {taken}");
        assert_eq!(decay.steps[..5], [1e-3, 1e-3, 1e-3, 4e-3, 16e-3]);
        assert!(decay.steps[3..].windows(2).all(|pair| pair[1] == 4.0 * pair[0]), "{:?}", decay.steps);
        // What changes too much at once goes in smaller portions and shorter steps.
        let mut decay = Decay { y: 1.0, a: 0.0, largest: 0.3, steps: Vec::new(), ..decay };
        assert_eq!((relax(&mut decay, &LENGTHS, 0.25).0, decay.y), (Ok(()), 2.0));
        assert_eq!(decay.steps[..2], [5e-4, 2.5e-4]);
    }

    #[test]
    fn what_does_not_move_or_does_not_settle_ends_with_the_reason() {
        let mut stuck = Decay { y: 1.0, a: 0.0, longest: 0.0, largest: 9.0, steps: Vec::new() };
        let (result, spent) = relax(&mut stuck, &LENGTHS, 1.0);
        assert_eq!(result, Err("too far"));
        assert!(stuck.steps.is_empty() && spent < 400, "{spent}");
        // Steps of one second at most never come to where time plays no part, but decay.
        let mut short = Decay { longest: 1.0, ..stuck };
        assert_eq!((relax(&mut short, &LENGTHS, 1.0).0, short.y), (Ok(()), 2.0));
    }
}
