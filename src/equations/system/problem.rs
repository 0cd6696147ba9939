//! The system as a problem for Newton's method: what it is solved for, the active set of contact as the discrete state beside the
//! unknowns, and the tangent that may serve again. Where the load is given, the depth is the last unknown.

use serde::{Deserialize, Serialize};

use super::{Direction, Perturbation, State, System};
use crate::equations::load::LoadBalance;
use crate::parameters::Control;
use crate::solver::deadline::Deadline;
use crate::solver::linear::Singular;
use crate::solver::newton::{self, PredictorEstimate};
use crate::solver::predictor::PredictorError;

/// How a solution changes with one input, and its load \[N/m\].
#[derive(Debug)]
pub struct Slope {
    /// Of the unknowns.
    pub unknowns: Vec<f64>,
    /// Of the load.
    pub load: f64,
}

/// The tangent that was factorised last: where, and the changes with depth, speed and slide-to-roll ratio that were asked of it.
#[derive(Debug, Default)]
pub(super) struct Tangent {
    linearization: Option<State>,
    slopes: [Option<Slope>; 3],
    /// See [`newton::Solution::remainder`].
    remainder: Option<f64>,
}

/// A tangent that may serve once more.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReusableTangent {
    /// Where it was formed.
    pub linearization: State,
    /// By how much the last steady state that was predicted with it was off, unknowns and then the depth.
    pub predictor_error: Option<PredictorError>,
    /// What the first update with it left the last time, see [`newton::Solution::remainder`]; of use in time.
    pub remainder: Option<f64>,
}

impl ReusableTangent {
    /// Whether it is of these equations.
    pub fn fits(&self, system: &System) -> bool {
        let error = self.predictor_error.as_ref();
        system.admits(&self.linearization) && error.is_none_or(|error| error.fits(system.unknowns() + 1))
    }
}

/// How Newton's method goes about a guess.
#[derive(Debug, Clone, Copy)]
pub struct Task<'a> {
    /// Which of depth and load is given.
    pub control: Control,
    /// When to stop.
    pub settings: newton::Settings,
    /// Whether the distance of paired nodes along the surfaces counts, see [`crate::equations::facing`]. On the way to a state it
    /// may not, for nodes are paired anew there.
    pub distance_counts: bool,
    /// Where the tangent was formed that may serve once more, and what the predictor estimated with it.
    pub reusable: Option<(&'a State, PredictorEstimate)>,
}

/// A state that is being solved for.
struct Posed<'a> {
    system: &'a mut System,
    /// As of the last residual.
    state: State,
    load: Option<LoadBalance>,
    deadline: Deadline,
    reusable: Option<(&'a State, PredictorEstimate)>,
}

impl System {
    /// Newton's method from a guess; and the iterations spent. The last factorisation is near the solution, not at it.
    pub fn settle(&mut self, guess: State, task: &Task<'_>) -> (Result<State, String>, usize) {
        self.fit(guess.contact_half_width, &guess.shifts, guess.thickening);
        let load = match task.control {
            Control::Depth => None,
            Control::Load => Some(LoadBalance { given: guess.inputs.applied_load, thickness: self.thickness }),
        };
        let mut unknowns = guess.unknowns.clone();
        unknowns.extend(load.map(|_| guess.inputs.penetration_depth));
        let mut problem =
            Posed { system: self, state: guess, load, deadline: task.settings.deadline, reusable: task.reusable };
        problem.system.distance_counts = task.distance_counts;
        let result = newton::solve(&mut problem, &mut unknowns, &mut Vec::new(), &task.settings);
        problem.system.distance_counts = true;
        match result {
            Err(failure) => (Err(failure.reason), failure.iterations),
            Ok(newton::Solution { iterations, remainder }) => {
                problem.take(&unknowns);
                problem.state.mobilised.clear();
                problem.system.tangent.remainder = remainder;
                (Ok(problem.state), iterations)
            }
        }
    }

    /// Factorises the tangent at a linearization point, unless it is that already.
    ///
    /// # Errors
    /// [`Singular`] where elimination breaks down.
    pub fn form(&mut self, linearization: &State) -> Result<(), Singular> {
        if self.tangent.linearization.as_ref() == Some(linearization) {
            return Ok(());
        }
        self.tangent = Tangent::default();
        self.on_mesh_of(linearization, |system| system.factorise_at(linearization))?;
        self.tangent.linearization = Some(linearization.clone());
        Ok(())
    }

    /// Does something on the mesh of a state, and returns to the present one.
    fn on_mesh_of<T>(&mut self, state: &State, action: impl FnOnce(&mut Self) -> T) -> T {
        let present = (self.contact_half_width, self.shifts.clone(), self.thickening);
        self.fit(state.contact_half_width, &state.shifts, state.thickening);
        let result = action(self);
        self.fit(present.0, &present.1, present.2);
        result
    }

    /// Where the last tangent was formed.
    pub fn linearization(&self) -> Option<&State> {
        self.tangent.linearization.as_ref()
    }

    /// The last tangent, for another solution.
    pub fn reusable_tangent(&self) -> Option<ReusableTangent> {
        let Tangent { linearization, remainder, .. } = &self.tangent;
        Some(ReusableTangent { linearization: linearization.clone()?, predictor_error: None, remainder: *remainder })
    }

    /// How the solution changes with one of depth, speed and slide-to-roll ratio, by the last tangent.
    ///
    /// # Errors
    /// [`Singular`] where there is none, or the answer is not finite.
    pub fn slope(&mut self, input: usize) -> Result<&Slope, Singular> {
        if self.tangent.slopes[input].is_none() {
            let linearization = self.tangent.linearization.clone().ok_or(Singular)?;
            let slope = self.on_mesh_of(&linearization, |system| {
                let perturbation = Perturbation { direction: Direction::UNIT[input], ..Perturbation::default() };
                let change = system.sensitivities(&linearization, vec![perturbation])?.pop().ok_or(Singular)?;
                Ok(Slope { load: system.loads(&linearization, &change).total().eps, unknowns: change.unknowns })
            });
            self.tangent.slopes[input] = Some(slope?);
        }
        self.tangent.slopes[input].as_ref().ok_or(Singular)
    }
}

impl Posed<'_> {
    /// Takes unknowns, and the depth where that is one of them, into the state.
    fn take(&mut self, unknowns: &[f64]) {
        let (unknowns, depth) = unknowns.split_at(self.system.unknowns());
        self.state.unknowns.copy_from_slice(unknowns);
        depth.iter().for_each(|depth| self.state.inputs.penetration_depth = *depth);
    }
}

impl newton::Problem for Posed<'_> {
    fn has_discrete_state(&self) -> bool {
        self.system.has_discrete_state()
    }

    fn residual(&mut self, unknowns: &[f64], residual: &mut Vec<f64>) -> Result<bool, String> {
        let before = self.system.film().cavitates.then(|| self.state.clone());
        self.take(unknowns);
        let touched = self.system.residual_at(&mut self.state, residual).map_err(|inverted| inverted.to_string())?;
        let changed = touched || before.is_some_and(|before| self.system.void_changes(&before, &self.state));
        residual.extend(self.load.map(|balance| balance.residual(self.system.load(&self.state))));
        Ok(changed)
    }

    fn reusable_tangent(&mut self) -> Option<PredictorEstimate> {
        let (linearization, estimate) = self.reusable.take()?;
        let rate = |state: &State| state.rates.as_ref().map(|rates| rates.rate);
        let fits = linearization.mirrored == self.state.mirrored
            && linearization.active == self.state.active
            && rate(linearization) == rate(&self.state);
        (fits && self.system.form(linearization).is_ok()).then_some(estimate)
    }

    fn factorise(&mut self, _unknowns: &[f64]) -> Result<(), String> {
        self.system.set_deadline(self.deadline);
        let formed = self.system.form(&self.state);
        self.system.set_deadline(Deadline::default());
        formed.map_err(|singular| singular.to_string())
    }

    fn solve(&mut self, right_hand_side: &mut [f64]) -> Result<(), String> {
        let (update, load) = right_hand_side.split_at_mut(self.system.unknowns());
        self.system.solve(update).map_err(|singular| singular.to_string())?;
        let ([load], Some(balance)) = (load, self.load) else { return Ok(()) };
        let Some(linearization) = self.system.linearization() else { return Err("there is no tangent".into()) };
        let along = self.system.load_along(linearization, update);
        let by_depth = self.system.slope(0).map_err(|singular| singular.to_string())?;
        *load = balance.depth_update(*load, along, by_depth.load);
        update.iter_mut().zip(&by_depth.unknowns).for_each(|(u, by_depth)| *u += by_depth * *load);
        Ok(())
    }

    fn apply(&self, unknowns: &mut [f64], update: &[f64]) {
        let n = self.system.unknowns();
        let (unknowns, depth) = unknowns.split_at_mut(n);
        self.system.apply(unknowns, &update[..n], &self.state.active);
        depth.iter_mut().zip(&update[n..]).for_each(|(depth, change)| *depth -= change);
    }

    fn relative_size(&self, unknowns: &[f64], update: &[f64]) -> f64 {
        let n = self.system.unknowns();
        let of_fields = self.system.relative_size(&unknowns[..n], &update[..n]);
        match (self.load, unknowns.get(n), update.get(n)) {
            (Some(balance), Some(depth), Some(change)) => of_fields.max((change / balance.depth_scale(*depth)).abs()),
            _ => of_fields,
        }
    }

    fn weights(&self, unknowns: &[f64]) -> Vec<f64> {
        let n = self.system.unknowns();
        let mut weights = self.system.weights_of(&unknowns[..n]);
        if let Some(balance) = self.load {
            weights.extend(unknowns[n..].iter().map(|depth| 1.0 / balance.depth_scale(*depth)));
        }
        weights
    }
}
