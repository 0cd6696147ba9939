//! Derivatives of a state with respect to the inputs of its last step, and to time.

use super::bodies::{Bodies, State};
use super::transient::{self, Motion};
use super::{Input, Path, Step};
use crate::equations::layout::Quantity;
use crate::equations::system::{self, Change, Direction, Rates, Solved, StoredVolumes};
use crate::outputs::Outputs;
use crate::parameters::Control;
use crate::solver::runge_kutta::Linear;

/// What is asked of a solution, and a change of the load where that is given.
struct Perturbation {
    change: system::Perturbation,
    load: f64,
}

/// Changes of a solution with their perturbations. The tangent is factorised first.
fn changes(bodies: &mut Bodies, state: &State, perturbations: Vec<Perturbation>) -> Result<Vec<Change>, String> {
    bodies.form(state).map_err(|singular| singular.to_string())?;
    let loaded = bodies.parameters.control == Control::Load;
    let system = bodies.system_of(state);
    let loads: Vec<f64> = perturbations.iter().map(|perturbation| perturbation.load).collect();
    let given = |mut perturbation: Perturbation| {
        if loaded {
            perturbation.change.direction.penetration_depth = 0.0;
        }
        perturbation.change
    };
    let deeper = system::Perturbation { direction: Direction::UNIT[0], ..system::Perturbation::default() };
    let perturbations = perturbations.into_iter().map(given).chain([deeper]).collect();
    let mut changes = system.sensitivities(state, perturbations).map_err(|singular| singular.to_string())?;
    let by_depth = changes.pop().ok_or("there is nothing to differentiate")?;
    if loaded {
        // The depth follows so that the load changes as it is told to.
        let stiffness = system.loads(state, &by_depth).total().eps;
        for (change, load) in changes.iter_mut().zip(loads) {
            let approach = (load - system.loads(state, change).total().eps) / stiffness;
            change.inputs.penetration_depth = approach;
            let add = |values: &mut [f64], slope: &[f64]| {
                values.iter_mut().zip(slope).for_each(|(value, slope)| *value += approach * slope);
            };
            add(&mut change.unknowns, &by_depth.unknowns);
            add(&mut change.contact_forces, &by_depth.contact_forces);
        }
    }
    Ok(changes)
}

/// Derivatives of the results, from changes of their solution.
fn results(bodies: &mut Bodies, state: &State, changes: &[Change]) -> Vec<Outputs> {
    let solved = Solved { system: bodies.system_of(state), state };
    changes.iter().map(|change| solved.derivatives(change)).collect()
}

/// Derivatives with respect to the inputs in the order of [`Input::ALL`] during the last step, held as they were but for a constant difference: those of
/// the steady state, or of the discrete step in time with its internal steps.
pub(super) fn by_inputs(bodies: &mut Bodies, last: &Step) -> Result<Vec<Outputs>, String> {
    let perturbation = |input: &Input, time: f64, history: Option<StoredVolumes>| {
        let (direction, load) = last.drive.change(*input, time);
        Perturbation { change: system::Perturbation { direction, history, ..system::Perturbation::default() }, load }
    };
    match &last.path {
        Path::Steady(_) => {
            let perturbations = Input::ALL.iter().map(|input| perturbation(input, last.duration, None)).collect();
            let changes = changes(bodies, &last.state, perturbations)?;
            Ok(results(bodies, &last.state, &changes))
        }
        Path::Transient(motion) => {
            // Changes of what is stored before the internal step, and of its rates in the first stage.
            let (mut stored, mut first): (Vec<StoredVolumes>, Vec<StoredVolumes>) = (Vec::new(), Vec::new());
            let (mut outputs, mut left) = (Vec::new(), 2 * motion.course.steps.len());
            transient::replay(bodies, &motion.course, &last.drive, last.duration, |bodies, stage, time| {
                let nothing = stage.rate.scaled(0.0);
                let perturbations = Input::ALL.iter().enumerate().map(|(k, input)| {
                    let before = stored.get(k).unwrap_or(&nothing);
                    perturbation(input, time, Some(transient::history(&stage.formula, before, first.get(k))))
                });
                let perturbations = perturbations.collect();
                let changes = changes(bodies, &stage.state, perturbations)?;
                let system = bodies.system_of(&stage.state);
                let stored_volumes: Vec<StoredVolumes> =
                    changes.iter().map(|change| system.stored_volumes_change(&stage.state, change)).collect();
                if first.is_empty() {
                    let rate = |(stored_volumes, change): (&StoredVolumes, &Change)| {
                        change.history.as_ref().unwrap_or(&nothing).combined(1.0, stage.formula.present, stored_volumes)
                    };
                    first = stored_volumes.iter().zip(&changes).map(rate).collect();
                } else {
                    stored = stored_volumes;
                    first.clear();
                }
                left -= 1;
                if left == 0 {
                    outputs = results(bodies, &stage.state, &changes);
                }
                Ok(())
            })?;
            Ok(outputs)
        }
    }
}

/// Those with respect to the slide-to-roll ratio of a mirrored pair. With it the bodies part, which the equations of one body do not know.
pub(super) fn by_ratio(bodies: &mut Bodies, last: &Step) -> Result<Outputs, String> {
    let state = bodies.converted(last.state.clone(), false);
    let path = match &last.path {
        Path::Steady(_) => Path::Steady(None),
        Path::Transient(motion) => Path::Transient(Box::new(transient::apart(bodies, motion))),
    };
    let apart = Step { state, path, ..last.clone() };
    Ok(by_inputs(bodies, &apart)?.swap_remove(Input::SlideToRollRatio as usize))
}

/// By time at the end of the last step, with the inputs going on at their rates.
pub(super) fn by_time(bodies: &mut Bodies, last: &Step) -> Result<Outputs, String> {
    let direction = last.drive.rates_at(last.duration);
    let load = last.drive.rates.applied_load;
    let state = &last.state;
    let changes = match (&last.path, &state.rates) {
        (Path::Transient(motion), Some(known)) => {
            // The rates of what is stored are known, and all other equations hold at all times: the unknowns move as in a step
            // of backward Euler that is too short for flow to matter, on a mesh that stays.
            let step = 1e-3 * shortest(motion);
            let system = bodies.system_of(state);
            let stored_volumes = system.stored_volumes(state);
            let mut history = known.history.combined(1.0, -1.0 / step, &stored_volumes);
            let still = |x: &Vec<f64>| x.iter().map(|x| -x / step).collect();
            history.stations = stored_volumes.stations.iter().map(still).collect();
            let moving = StoredVolumes { places: system.rates_of_places(state), ..StoredVolumes::default() };
            history.places = moving.combined(1.0, -1.0 / step, &stored_volumes).places;
            let short_step = State { rates: Some(Rates { rate: 1.0 / step, history }), ..state.clone() };
            let [stored, flows] = [state.rates.clone(), None].map(|rates| {
                let mut residual = Vec::new();
                let formed = system.residual_at(&mut State { rates, ..state.clone() }, &mut residual);
                formed.map(|_| residual).map_err(|inverted| inverted.to_string())
            });
            let (stored, flows) = (stored?, flows?);
            let rate =
                stored.iter().zip(&flows).zip(&system.layout.quantities).map(|((all, flow), quantity)| {
                    if *quantity == Quantity::Pressure { (flow - all) / step } else { 0.0 }
                });
            let history = Some(moving.scaled(-1.0 / step));
            let change = system::Perturbation { direction, history, residual: rate.collect() };
            let mut changes = changes(bodies, &short_step, vec![Perturbation { change, load }])?;
            let system = bodies.system_of(state);
            // What leaves the tissue into the film also changes with the rate of the film's mass, and friction with those of the surfaces' places.
            for change in &mut changes {
                let sideways = StoredVolumes { places: system.sideways(&change.unknowns), ..StoredVolumes::default() };
                let places = sideways.combined(1.0 / step, -1.0 / step, &moving).places;
                let film = motion.film_trend.clone();
                change.history = Some(StoredVolumes { film, places, ..StoredVolumes::default() });
            }
            changes
        }
        _ => {
            let change = system::Perturbation { direction, ..system::Perturbation::default() };
            changes(bodies, state, vec![Perturbation { change, load }])?
        }
    };
    let mut outputs = results(bodies, state, &changes);
    outputs.pop().ok_or_else(|| "there is nothing to differentiate".into())
}

fn shortest(motion: &Motion) -> f64 {
    motion.course.steps.iter().copied().fold(f64::INFINITY, f64::min)
}
