//! Newton's method for equations with a discrete state (the active set of contact) beside the unknowns.

use super::deadline::Deadline;

/// Equations that Newton's method can solve. Errors are reasons in words.
pub trait Problem {
    /// Writes the residual at these unknowns and renews the discrete state; returns whether that changed.
    ///
    /// # Errors
    /// A reason why there is no residual here, such as an element turned inside out.
    fn residual(&mut self, unknowns: &[f64], residual: &mut Vec<f64>) -> Result<bool, String>;

    /// Factorises the tangent at these unknowns, with the discrete state of the last residual.
    ///
    /// # Errors
    /// A reason, such as a singular tangent.
    fn factorise(&mut self, unknowns: &[f64]) -> Result<(), String>;

    /// Solves with the last factorisation, in place.
    ///
    /// # Errors
    /// A reason, such as an answer that is not finite.
    fn solve(&mut self, right_hand_side: &mut [f64]) -> Result<(), String>;

    /// Subtracts an update from the unknowns, within the limits that the problem knows to be wise.
    fn apply(&self, unknowns: &mut [f64], update: &[f64]) {
        unknowns.iter_mut().zip(update).for_each(|(z, d)| *z -= d);
    }

    /// Size of an update relative to the unknowns.
    fn relative_size(&self, unknowns: &[f64], update: &[f64]) -> f64;

    /// Whether there is a discrete state at all beside the unknowns.
    fn has_discrete_state(&self) -> bool {
        true
    }

    /// Whether there is a reusable tangent, factorised before, for the discrete state of the last residual; and what the predictor
    /// estimated with it.
    fn reusable_tangent(&mut self) -> Option<PredictorEstimate> {
        None
    }

    /// What changes of the unknowns are multiplied with before they are compared with each other.
    fn weights(&self, unknowns: &[f64]) -> Vec<f64> {
        vec![1.0; unknowns.len()]
    }
}

/// How a predictor found the first unknowns; sizes are relative to the fields.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PredictorEstimate {
    /// Size of the step to them by the reusable tangent; 0 where there was none.
    pub step: f64,
    /// Size of what was added in place of a first update.
    pub corrected: f64,
    /// See [`Solution::remainder`], of the last solution with this tangent.
    pub remainder: Option<f64>,
}

/// What it took to solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// Iterations spent.
    pub iterations: usize,
    /// What the first update with the last tangent left, over its size, as far as that is known: it says whether one update is enough
    /// the next time (E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, Springer 1996, section IV.8). What was not
    /// measured this time counts as known less well than the last time.
    pub remainder: Option<f64>,
}

/// A remainder that was not measured anew is raised to this power, which brings it nearer to 1.
const FORGETTING: f64 = 0.8;
/// No less than this is left, whatever was measured.
const LEAST_REMAINDER: f64 = 1e-2;

/// Broyden's update of a reusable tangent by the steps that were taken with it, each the solution's whole step: C. T. Kelley, Solving
/// Nonlinear Equations with Newton's Method, SIAM 2003, section 4. What the tangent misses in a few directions is learned from
/// the residuals, and the steps shrink faster than a geometric series.
#[derive(Default)]
struct Broyden {
    /// See [`Problem::weights`].
    weights: Vec<f64>,
    /// Steps since the tangent was factorised, and their squares.
    steps: Vec<(Vec<f64>, f64)>,
}

impl Broyden {
    fn product(&self, a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).zip(&self.weights).map(|((a, b), weight)| weight * weight * a * b).sum()
    }

    /// Turns the solution with the reusable tangent into that with the updated one.
    fn correct(&self, update: &mut [f64]) {
        for (index, (step, square)) in self.steps.iter().enumerate() {
            let ratio = self.product(step, update) / square;
            // The last step was followed by this update, and by no other yet.
            match self.steps.get(index + 1) {
                Some((next, _)) => update.iter_mut().zip(next).for_each(|(u, s)| *u += ratio * s),
                None if ratio < LARGEST_RATIO => update.iter_mut().for_each(|u| *u /= 1.0 - ratio),
                None => {}
            }
        }
    }

    fn add(&mut self, step: &[f64]) {
        let square = self.product(step, step);
        if square > 0.0 {
            self.steps.push((step.to_vec(), square));
        }
    }
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Allowed error of the unknowns, relative.
    pub tolerance: f64,
    /// Most iterations that form a tangent.
    pub maximum_iterations: usize,
    /// A tangent is reused as long as the contraction of the updates promises the solution within so many further iterations,
    /// and the discrete state stays; 0 is Newton's method in full. About what a factorisation costs in iterations without.
    pub patience: f64,
    /// After so many updates larger than the unknowns it is quicker to start again from nearer by.
    pub most_large: usize,
    /// No iteration begins after it, and a factorisation that is under way ends.
    pub deadline: Deadline,
}

/// Why there is no solution, and what it cost to find out.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// In words.
    pub reason: String,
    /// Iterations spent.
    pub iterations: usize,
}

/// An update of this relative size changes the tangent too much for it to be reused.
const LARGE: f64 = 0.3;

/// Why a solution was given up that might have been found.
const OVER: &str = "maximum_solve_time is over";

/// Broyden's update is left out where it would divide by less than one minus this.
const LARGEST_RATIO: f64 = 0.8;

/// Solves in place.
///
/// The method stops when the next update, estimated from the contraction of the last two, would be below the tolerance and the
/// discrete state is that of the solution.
///
/// # Errors
/// [`Failure`] where it does not get there; the unknowns are then somewhere on the way.
pub fn solve(
    problem: &mut impl Problem,
    unknowns: &mut [f64],
    residual: &mut Vec<f64>,
    settings: &Settings,
) -> Result<Solution, Failure> {
    let fail = |reason: String, iterations| Failure { reason, iterations };
    let mut update = vec![0.0; unknowns.len()];
    let mut broyden = Broyden::default();
    problem.residual(unknowns, residual).map_err(|reason| fail(reason, 0))?;
    let estimate = if settings.patience > 0.0 { problem.reusable_tangent() } else { None };
    let mut corrected = estimate.map_or(0.0, |estimate| estimate.corrected);
    let predicted = estimate.map(|estimate| estimate.step).filter(|size| *size > 0.0).unwrap_or(f64::INFINITY);
    // `previous` is the size of the last update, as far as the next one says how fast they shrink.
    let (mut stale, mut previous) = (estimate.is_none(), predicted);
    let (mut iterations, mut formed, mut converged, mut lost) = (0, 0, false, 0);
    let known = estimate.and_then(|estimate| estimate.remainder);
    let mut remainder = known.map(|remainder| remainder.clamp(LEAST_REMAINDER, 1.0).powf(FORGETTING));
    // Size of the first update with the present tangent, until the next one.
    let mut first: Option<f64> = None;
    while !stale || formed < settings.maximum_iterations {
        if settings.deadline.passed() {
            return Err(fail(OVER.into(), iterations));
        }
        iterations += 1;
        let fail = |reason| fail(reason, iterations);
        if stale {
            let tangent = problem.factorise(unknowns);
            tangent.map_err(|reason| fail(if settings.deadline.passed() { OVER.into() } else { reason }))?;
            formed += 1;
            broyden.steps.clear();
            remainder = None;
        }
        update.copy_from_slice(residual);
        match problem.solve(&mut update) {
            // A tangent of the present is another matter.
            Err(_) if !stale => {
                stale = true;
                continue;
            }
            solved => solved.map_err(fail)?,
        }
        if let Some(first) = first.filter(|_| !stale) {
            let contraction = problem.relative_size(unknowns, &update) / first;
            remainder = Some(contraction / (1.0 - contraction.min(0.9)));
        }
        broyden.correct(&mut update);
        let size = problem.relative_size(unknowns, &update);
        first = broyden.steps.is_empty().then_some(size);
        if !size.is_finite() {
            return Err(fail("the update is not finite".into()));
        }
        // By a tangent of elsewhere so large an update leads astray.
        if !stale && size > 1.0 {
            stale = true;
            continue;
        }
        lost += usize::from(size > 1.0);
        if lost > settings.most_large {
            return Err(fail("Newton's method gets lost".into()));
        }
        // The first update would have been as large as what is in its place already.
        let contraction = previous.is_finite().then_some((size + std::mem::take(&mut corrected)) / previous);
        let rest = match contraction {
            // With one factorisation the updates shrink like a geometric series.
            Some(contraction) if !stale => contraction / (1.0 - contraction.min(0.9)),
            None if !stale => remainder.unwrap_or(10.0),
            _ => contraction.unwrap_or(1.0).min(1.0),
        };
        converged = size * rest < settings.tolerance;
        if converged && !problem.has_discrete_state() {
            problem.apply(unknowns, &update);
            return Ok(Solution { iterations, remainder });
        }
        let changed = advance(problem, unknowns, &mut update, residual).map_err(fail)?;
        if converged && !changed {
            return Ok(Solution { iterations, remainder });
        }
        let slow = |contraction: f64| {
            contraction >= 1.0 || (settings.tolerance / size).ln() / contraction.ln() > settings.patience
        };
        let serves = size < LARGE && (stale || !contraction.is_some_and(slow));
        if serves && !changed {
            if broyden.weights.is_empty() {
                broyden.weights = problem.weights(unknowns);
            }
            broyden.add(&update);
        }
        stale = changed || settings.patience == 0.0 || !serves;
        previous = if changed { f64::INFINITY } else { size.min(1.0) };
    }
    let reason = if converged { "the contact does not settle" } else { "Newton's method does not converge" };
    Err(fail(format!("{reason} in {iterations} iterations"), iterations))
}

/// Applies an update, shortened where there is no residual at its end.
fn advance(
    problem: &mut impl Problem,
    unknowns: &mut [f64],
    update: &mut [f64],
    residual: &mut Vec<f64>,
) -> Result<bool, String> {
    let before = unknowns.to_vec();
    let mut length = 1.0;
    loop {
        problem.apply(unknowns, update);
        match problem.residual(unknowns, residual) {
            Err(reason) if length < 0.1 => return Err(reason),
            Err(_) => {
                length *= 0.5;
                update.iter_mut().for_each(|d| *d *= 0.5);
                unknowns.copy_from_slice(&before);
            }
            changed => return changed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One equation f(z) = 0 for z > 0; a negative z has no residual.
    struct Scalar<F: Fn(f64) -> (f64, f64)> {
        function: F,
        slope: f64,
        sizes: Vec<f64>,
        factorised: usize,
    }

    impl<F: Fn(f64) -> (f64, f64)> Problem for Scalar<F> {
        fn residual(&mut self, z: &[f64], residual: &mut Vec<f64>) -> Result<bool, String> {
            if z[0] < 0.0 {
                return Err("negative".into());
            }
            *residual = vec![(self.function)(z[0]).0];
            Ok(false)
        }
        fn factorise(&mut self, z: &[f64]) -> Result<(), String> {
            self.slope = (self.function)(z[0]).1;
            self.factorised += 1;
            Ok(())
        }
        fn solve(&mut self, rhs: &mut [f64]) -> Result<(), String> {
            rhs[0] /= self.slope;
            self.sizes.push(rhs[0].abs());
            Ok(())
        }
        fn relative_size(&self, z: &[f64], update: &[f64]) -> f64 {
            update[0].abs() / z[0].abs()
        }
    }

    fn run<F: Fn(f64) -> (f64, f64)>(
        function: F,
        start: f64,
        patience: f64,
    ) -> (Result<usize, Failure>, f64, Scalar<F>) {
        let mut problem = Scalar { function, slope: 0.0, sizes: vec![], factorised: 0 };
        let mut z = [start];
        let settings = Settings {
            tolerance: 1e-10,
            maximum_iterations: 20,
            patience,
            most_large: 20,
            deadline: Deadline::default(),
        };
        let result = solve(&mut problem, &mut z, &mut Vec::new(), &settings);
        (result.map(|solution| solution.iterations), z[0], problem)
    }

    #[test]
    fn converges_quadratically_and_reaches_the_tolerance() {
        let (result, z, Scalar { sizes, .. }) = run(|z| (z * z - 2.0, 2.0 * z), 3.0, 0.0);
        assert!(result.is_ok());
        assert!((z - 2.0_f64.sqrt()).abs() < 1e-10);
        let last = &sizes[sizes.len() - 3..];
        assert!(last[2] < last[1].powi(2) && last[1] < last[0].powi(2), "{sizes:?}");
    }

    #[test]
    fn a_tangent_is_reused_while_it_serves() {
        let function = |z: f64| (z * z - 2.0, 2.0 * z);
        for start in [1.5, 3.0] {
            let (result, z, reused) = run(function, start, 8.0);
            let (_, _, renewed) = run(function, start, 0.0);
            assert!((z - 2.0_f64.sqrt()).abs() < 1e-10);
            assert!(reused.factorised < renewed.factorised && result.unwrap() > reused.factorised);
        }
    }

    /// With a tangent that was formed before, and what its first update left.
    struct Kept<F: Fn(f64) -> (f64, f64)>(Scalar<F>, Option<f64>);

    impl<F: Fn(f64) -> (f64, f64)> Problem for Kept<F> {
        fn has_discrete_state(&self) -> bool {
            false
        }
        fn residual(&mut self, z: &[f64], residual: &mut Vec<f64>) -> Result<bool, String> {
            self.0.residual(z, residual)
        }
        fn factorise(&mut self, z: &[f64]) -> Result<(), String> {
            self.0.factorise(z)
        }
        fn solve(&mut self, rhs: &mut [f64]) -> Result<(), String> {
            self.0.solve(rhs)
        }
        fn relative_size(&self, z: &[f64], update: &[f64]) -> f64 {
            self.0.relative_size(z, update)
        }
        fn reusable_tangent(&mut self) -> Option<PredictorEstimate> {
            Some(PredictorEstimate { remainder: self.1, ..PredictorEstimate::default() })
        }
    }

    #[test]
    fn one_update_is_enough_where_the_tangent_is_known_to_leave_little() {
        // Formed at 1.5, some 6 % off at the solution.
        let run = |start: f64, remainder: Option<f64>, tolerance: f64| {
            let scalar = Scalar { function: |z| (z * z - 2.0, 2.0 * z), slope: 3.0, sizes: vec![], factorised: 0 };
            let (mut problem, mut z) = (Kept(scalar, remainder), [start]);
            let settings = Settings {
                tolerance,
                maximum_iterations: 20,
                patience: 8.0,
                most_large: 20,
                deadline: Deadline::default(),
            };
            let solution = solve(&mut problem, &mut z, &mut Vec::new(), &settings).unwrap();
            assert_eq!(problem.0.factorised, 0);
            assert!((z[0] / 2.0_f64.sqrt() - 1.0).abs() < tolerance);
            (solution.iterations, solution.remainder)
        };
        let (iterations, remainder) = run(1.42, None, 1e-3);
        let remainder = remainder.unwrap();
        assert_eq!(iterations, 2);
        assert!((remainder - 0.06).abs() < 0.01, "{remainder}");
        // What was not measured is known less well each time, until it is measured again.
        let (iterations, forgotten) = run(1.42, Some(remainder), 1e-3);
        assert_eq!((iterations, forgotten), (1, Some(remainder.powf(FORGETTING))));
        assert_eq!(run(1.42, Some(0.5), 1e-3).0, 2);
        assert_eq!(run(1.42, Some(remainder), 1e-5).0, 3);
    }

    #[test]
    fn a_tangent_that_leads_astray_is_renewed_first() {
        let scalar = Scalar { function: |z| (z * z - 2.0, 2.0 * z), slope: 0.01, sizes: vec![], factorised: 0 };
        let (mut problem, mut z) = (Kept(scalar, None), [1.5]);
        let settings = Settings {
            tolerance: 1e-10,
            maximum_iterations: 20,
            patience: 8.0,
            most_large: 0,
            deadline: Deadline::default(),
        };
        let solution = solve(&mut problem, &mut z, &mut Vec::new(), &settings).unwrap();
        assert!((z[0] - 2.0_f64.sqrt()).abs() < 1e-10 && problem.0.factorised > 0, "{z:?}");
        // The one that was not applied counts, as the work it was.
        assert_eq!(solution.iterations, problem.0.sizes.len());
    }

    #[test]
    fn shortens_an_update_that_leaves_the_domain() {
        let (result, z, _) = run(|z| (z.sqrt() - 1.0, 0.5 / z.sqrt()), 9.0, 0.0);
        assert!(result.is_ok() && (z - 1.0).abs() < 1e-10);
    }

    #[test]
    fn says_why_it_stops() {
        let (result, _, _) = run(|z| (z * z + 1.0, 2.0 * z), 1.0, 0.0);
        assert!(!result.unwrap_err().reason.is_empty());
    }
}
