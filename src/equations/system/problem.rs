//! The system as a problem for Newton's method: what it is solved for, the active set of contact as the discrete state beside the
//! unknowns, and the tangent that may serve again. Where the load is given, the depth is the last unknown.

use serde::{Deserialize, Serialize};

use super::{At, Direction, Perturbation, Rates, Residual, System};
use crate::equations::load::LoadBalance;
use crate::parameters::{Control, Inputs};
use crate::solver::deadline::Deadline;
use crate::solver::linear::Singular;
use crate::solver::newton::{self, PredictorEstimate};

/// A solution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// The inputs, with the depth that was found where the load is given.
    pub inputs: Inputs,
    /// Whether the lower body is the mirror image of the upper one.
    pub mirrored: bool,
    /// What contact the mesh is made for, see [`crate::equations::grid::contact_half_width`] \[m\].
    pub contact_half_width: f64,
    /// How many times its own viscosity the film has: 1 but on the way to a state.
    pub thickening: f64,
    /// The unknowns.
    pub unknowns: Vec<f64>,
    /// Stations in contact.
    pub active: Vec<bool>,
    /// Force of contact at each station, zero where there is none \[N/m\].
    pub contact_forces: Vec<f64>,
}

impl Point {
    /// Where derivatives are taken.
    pub fn at<'a>(&'a self, rates: Option<&'a Rates>) -> At<'a> {
        let Self { inputs, unknowns, active, contact_forces, .. } = self;
        At { unknowns, active, contact_forces, inputs, rates }
    }

    /// Whether smooth surfaces touch.
    pub fn touches(&self) -> bool {
        self.active.contains(&true)
    }
}

/// Where a tangent was formed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LinearizationPoint {
    /// The state.
    pub point: Point,
    /// Its time derivatives; none of a steady one.
    pub rates: Option<Rates>,
}

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
    linearization: Option<LinearizationPoint>,
    slopes: [Option<Slope>; 3],
}

/// What Newton's method is asked for.
#[derive(Debug, Clone, Copy)]
pub struct Task<'a> {
    /// The inputs; the depth is not looked at where the load is given.
    pub inputs: &'a Inputs,
    /// Time derivatives; none of a steady state.
    pub rates: Option<&'a Rates>,
    /// Which of depth and load is given.
    pub control: Control,
    /// When to stop.
    pub settings: newton::Settings,
    /// Where the tangent was formed that may serve once more, and what the predictor estimated with it.
    pub reusable: Option<(&'a LinearizationPoint, PredictorEstimate)>,
}

/// What is being solved for, and the discrete state.
#[derive(Debug, Default)]
pub(super) struct Posed {
    inputs: Inputs,
    rates: Option<Rates>,
    load: Option<LoadBalance>,
    deadline: Deadline,
    reusable: Option<(LinearizationPoint, PredictorEstimate)>,
    active: Vec<bool>,
    residual: Residual,
}

impl Posed {
    fn contact_forces(&self) -> Vec<f64> {
        let pressing = |(force, active): (&f64, &bool)| if *active { *force } else { 0.0 };
        self.residual.contact_forces.iter().zip(&self.active).map(pressing).collect()
    }
}

impl System {
    /// Newton's method from a guess; and the iterations spent. The last factorisation is near the solution, not at it.
    pub fn settle(&mut self, guess: Point, task: &Task<'_>) -> (Result<Point, String>, usize) {
        let Point { mirrored, mut unknowns, active, inputs, contact_half_width, thickening, .. } = guess;
        self.fit(contact_half_width, thickening);
        let load = match task.control {
            Control::Depth => None,
            Control::Load => Some(LoadBalance { given: task.inputs.applied_load, thickness: self.thickness }),
        };
        let depth = if load.is_some() { inputs.penetration_depth } else { task.inputs.penetration_depth };
        unknowns.extend(load.map(|_| depth));
        self.posed = Posed {
            inputs: Inputs { penetration_depth: depth, ..*task.inputs },
            rates: task.rates.cloned(),
            load,
            deadline: task.settings.deadline,
            reusable: task.reusable.map(|(linearization, estimate)| (linearization.clone(), estimate)),
            active,
            residual: Residual::default(),
        };
        let result = newton::solve(self, &mut unknowns, &mut Vec::new(), &task.settings);
        let posed = std::mem::take(&mut self.posed);
        match result {
            Err(failure) => (Err(failure.reason), failure.iterations),
            Ok(iterations) => {
                unknowns.truncate(self.unknowns());
                let contact_forces = posed.contact_forces();
                let Posed { inputs, active, .. } = posed;
                let point =
                    Point { inputs, mirrored, contact_half_width, thickening, unknowns, active, contact_forces };
                (Ok(point), iterations)
            }
        }
    }

    /// Factorises the tangent at a linearization point, unless it is that already.
    ///
    /// # Errors
    /// [`Singular`] where elimination breaks down.
    pub fn form(&mut self, linearization: &LinearizationPoint) -> Result<(), Singular> {
        if self.tangent.linearization.as_ref() == Some(linearization) {
            return Ok(());
        }
        self.tangent = Tangent::default();
        let LinearizationPoint { point, rates } = linearization;
        self.on_mesh_of(point, |system| {
            system.factorise_at(&point.unknowns, &point.active, &point.inputs, rates.as_ref())
        })?;
        self.tangent.linearization = Some(linearization.clone());
        Ok(())
    }

    /// Does something on the mesh of a point, and returns to the present one.
    fn on_mesh_of<T>(&mut self, point: &Point, action: impl FnOnce(&mut Self) -> T) -> T {
        let present = (self.contact_half_width, self.thickening);
        self.fit(point.contact_half_width, point.thickening);
        let result = action(self);
        self.fit(present.0, present.1);
        result
    }

    /// Where the last tangent was formed.
    pub fn linearization(&self) -> Option<&LinearizationPoint> {
        self.tangent.linearization.as_ref()
    }

    /// How the solution changes with one of depth, speed and slide-to-roll ratio, by the last tangent.
    ///
    /// # Errors
    /// [`Singular`] where there is none, or the answer is not finite.
    pub fn slope(&mut self, input: usize) -> Result<&Slope, Singular> {
        if self.tangent.slopes[input].is_none() {
            let linearization = self.tangent.linearization.clone().ok_or(Singular)?;
            let slope = self.on_mesh_of(&linearization.point, |system| {
                let at = linearization.point.at(linearization.rates.as_ref());
                let perturbation = Perturbation { direction: Direction::UNIT[input], ..Perturbation::default() };
                let change = system.sensitivities(at, vec![perturbation])?.pop().ok_or(Singular)?;
                Ok(Slope { load: system.loads(at, &change).total().eps, unknowns: change.unknowns })
            });
            self.tangent.slopes[input] = Some(slope?);
        }
        self.tangent.slopes[input].as_ref().ok_or(Singular)
    }
}

impl newton::Problem for System {
    fn residual(&mut self, unknowns: &[f64], residual: &mut Vec<f64>) -> Result<bool, String> {
        let (unknowns, depth) = unknowns.split_at(self.unknowns());
        let mut posed = std::mem::take(&mut self.posed);
        depth.iter().for_each(|depth| posed.inputs.penetration_depth = *depth);
        let Posed { inputs, rates, active, residual: parts, .. } = &mut posed;
        let changed = self.residual_at(unknowns, active, inputs, rates.as_ref(), parts);
        if changed.is_ok() {
            residual.clone_from(&parts.values);
            if let Some(balance) = posed.load {
                let (active, contact_forces) = (&posed.active, &posed.contact_forces());
                let at = At { unknowns, active, contact_forces, inputs: &posed.inputs, rates: posed.rates.as_ref() };
                residual.push(balance.residual(self.load(at)));
            }
        }
        self.posed = posed;
        changed.map_err(|inverted| inverted.to_string())
    }

    fn reusable_tangent(&mut self) -> Option<PredictorEstimate> {
        let (linearization, estimate) = self.posed.reusable.take()?;
        let rate = |rates: &Option<Rates>| rates.as_ref().map(|rates| rates.rate);
        let fits = linearization.point.mirrored == self.mirrored()
            && linearization.point.active == self.posed.active
            && rate(&linearization.rates) == rate(&self.posed.rates);
        (fits && self.form(&linearization).is_ok()).then_some(estimate)
    }

    fn factorise(&mut self, unknowns: &[f64]) -> Result<(), String> {
        let posed = &self.posed;
        let point = Point {
            inputs: posed.inputs,
            mirrored: self.mirrored(),
            contact_half_width: self.contact_half_width,
            thickening: self.thickening,
            unknowns: unknowns[..self.unknowns()].to_vec(),
            active: posed.active.clone(),
            contact_forces: posed.contact_forces(),
        };
        let linearization = LinearizationPoint { point, rates: posed.rates.clone() };
        self.set_deadline(self.posed.deadline);
        let formed = self.form(&linearization);
        self.set_deadline(Deadline::default());
        formed.map_err(|singular| singular.to_string())
    }

    fn solve(&mut self, right_hand_side: &mut [f64]) -> Result<(), String> {
        let (update, load) = right_hand_side.split_at_mut(self.unknowns());
        System::solve(self, update).map_err(|singular| singular.to_string())?;
        let ([load], Some(balance)) = (load, self.posed.load) else { return Ok(()) };
        let Some(LinearizationPoint { point, rates }) = &self.tangent.linearization else {
            return Err("there is no tangent".into());
        };
        let along = self.load_along(point.at(rates.as_ref()), update);
        let by_depth = self.slope(0).map_err(|singular| singular.to_string())?;
        *load = balance.depth_update(*load, along, by_depth.load);
        update.iter_mut().zip(&by_depth.unknowns).for_each(|(u, by_depth)| *u += by_depth * *load);
        Ok(())
    }

    fn apply(&self, unknowns: &mut [f64], update: &[f64]) {
        let n = self.unknowns();
        let (unknowns, depth) = unknowns.split_at_mut(n);
        self.apply(unknowns, &update[..n], &self.posed.active);
        depth.iter_mut().zip(&update[n..]).for_each(|(depth, change)| *depth -= change);
    }

    fn relative_size(&self, unknowns: &[f64], update: &[f64]) -> f64 {
        let n = self.unknowns();
        let of_fields = self.relative_size(&unknowns[..n], &update[..n]);
        match (self.posed.load, unknowns.get(n), update.get(n)) {
            (Some(balance), Some(depth), Some(change)) => of_fields.max((change / balance.depth_scale(*depth)).abs()),
            _ => of_fields,
        }
    }

    fn weights(&self, unknowns: &[f64]) -> Vec<f64> {
        let n = self.unknowns();
        let mut weights = self.weights_of(&unknowns[..n]);
        if let Some(balance) = self.posed.load {
            weights.extend(unknowns[n..].iter().map(|depth| 1.0 / balance.depth_scale(*depth)));
        }
        weights
    }
}
