//! One contact, driven by its inputs: the object that the command line, the FMU and Rust programs use.

use serde::{Deserialize, Serialize};

use crate::equations::system::{Rates, Residual, System, boundary_friction, half_width};
use crate::error::Error;
use crate::fields::{Fields, Solution};
use crate::outputs::{Outputs, STATIONS, Solved, profile_stations};
use crate::parameters::{Fidelity, Inputs, Parameters};
use crate::solver::linear::FIXED;
use crate::solver::{continuation, newton};

/// The continuous inputs, in the order of the derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// [`Inputs::penetration_depth`].
    PenetrationDepth,
    /// [`Inputs::sliding_speed`].
    SlidingSpeed,
    /// [`Inputs::slide_to_roll_ratio`].
    SlideToRollRatio,
}

/// The whole state of a [`Simulation`]: going on from it gives the same bits as going on from where it was taken.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Snapshot(Option<State>);

/// A solution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct State {
    inputs: Inputs,
    /// Whether the lower body is the mirror image of the upper one.
    mirrored: bool,
    unknowns: Vec<f64>,
    active: Vec<bool>,
    /// Derivatives of the unknowns by the three inputs; empty at rest, before anything was solved.
    sensitivities: Vec<f64>,
    iterations: i32,
}

/// Two cartilage layers with a film between them.
#[derive(Debug)]
pub struct Simulation {
    parameters: Parameters,
    threads: usize,
    /// The equations of one body and its mirror image, where the two bodies are equal.
    mirrored: Option<System>,
    /// The equations of two bodies; made when they are first needed.
    full: Option<System>,
    state: Option<State>,
    inputs: Inputs,
    outputs: Outputs,
    derivatives: [Outputs; 3],
    position: Vec<f64>,
}

/// Most Newton iterations from a state nearby, which takes three to eight.
const WARM_ITERATIONS: usize = 12;
/// Most Newton iterations from rest, which takes ten to fifteen.
const COLD_ITERATIONS: usize = 25;

/// Most Newton iterations of one step in time on the way to a steady state, and of all of them.
const RELAXING_ITERATIONS: usize = 10;
/// How far the bones approach in one such step of a millisecond or more, as a share of the layers' thickness; in proportion less
/// in shorter ones.
const RELAXING_APPROACH: f64 = 0.02;
const LONGEST_RELAXATION: usize = 2000;

impl Simulation {
    /// Meshes the two bodies. Nothing is solved yet; the outputs are zero.
    ///
    /// # Errors
    /// [`Error::Value`] where a parameter is out of range.
    pub fn new(parameters: &Parameters) -> Result<Self, Error> {
        parameters.validate()?;
        if parameters.fidelity == Fidelity::Reduced {
            return Err(Error::value("fidelity", "reduced", "full: only an FMU has a reduced model in its resources"));
        }
        let mut simulation = Self::unsolved(parameters);
        match parameters.upper == parameters.lower {
            true => simulation.mirrored = Some(System::new(parameters, true)),
            false => simulation.full = Some(System::new(parameters, false)),
        }
        Ok(simulation)
    }

    /// Without equations yet, and with outputs of zero.
    fn unsolved(parameters: &Parameters) -> Self {
        let nothing = Outputs {
            film_thickness: vec![0.0; STATIONS],
            fluid_pressure: vec![0.0; STATIONS],
            contact_pressure: vec![0.0; STATIONS],
            ..Outputs::default()
        };
        Self {
            parameters: *parameters,
            threads: 1,
            mirrored: None,
            full: None,
            state: None,
            inputs: Inputs::default(),
            derivatives: [nothing.clone(), nothing.clone(), nothing.clone()],
            outputs: nothing,
            position: profile_stations(half_width(parameters)),
        }
    }

    /// Works on up to this many threads; on one unless told otherwise. The results are the same bits.
    pub fn set_threads(&mut self, threads: usize) {
        self.threads = threads;
        [&mut self.mirrored, &mut self.full].into_iter().flatten().for_each(|system| system.set_threads(threads));
    }

    /// The parameters it was made with.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The inputs of the last solution.
    pub fn inputs(&self) -> &Inputs {
        &self.inputs
    }

    /// Finds the steady state for these inputs, starting from the present state.
    ///
    /// # Errors
    /// [`Error::Value`] for inputs that are not finite, [`Error::NotConverged`] where no solution was found; either way the
    /// state is what it was before.
    pub fn solve_steady(&mut self, inputs: Inputs) -> Result<(), Error> {
        for (name, value) in [
            ("penetration_depth", inputs.penetration_depth),
            ("sliding_speed", inputs.sliding_speed),
            ("slide_to_roll_ratio", inputs.slide_to_roll_ratio),
        ] {
            if !value.is_finite() {
                return Err(Error::value(name, value, "a finite number"));
            }
        }
        let mut iterations = 0;
        let from = match &self.state {
            Some(state) => state.clone(),
            None => self.rest(&inputs),
        };
        let mut result = self.travel(&from, &inputs, &mut iterations);
        if result.is_err() {
            // Without motion fluid and film play no part, and pressing is easy; then the surfaces are set in motion.
            let rest = self.rest(&inputs);
            let pressed = Inputs { sliding_speed: 0.0, ..inputs };
            let moved = self
                .travel(&rest, &pressed, &mut iterations)
                .and_then(|state| self.travel(&state, &inputs, &mut iterations));
            result = moved.or(result);
        }
        let state = result?;
        self.accept(State { iterations: iterations as i32, ..state })
    }

    /// Goes from one state to others by steps of the inputs, at the end through time; adds to the count of iterations.
    fn travel(&mut self, from: &State, inputs: &Inputs, iterations: &mut usize) -> Result<State, Error> {
        let cold = from.sensitivities.is_empty();
        let limit = if cold { COLD_ITERATIONS } else { WARM_ITERATIONS };
        let mut rest = (!cold).then(|| self.rest(inputs));
        let mut state = from.clone();
        let result = continuation::advance(|to| {
            let target = between(&from.inputs, inputs, to);
            let (mut next, spent) = self.step(&state, &target, limit);
            *iterations += spent;
            let mut reached = to;
            if let (Err(_), Some(rest)) = (&next, rest.take()) {
                // Surfaces close more readily than they part: from rest even far targets are often reached at once.
                let (whole, spent) = self.step(&rest, inputs, COLD_ITERATIONS);
                *iterations += spent;
                if whole.is_ok() {
                    (next, reached) = (whole, 1.0);
                }
            }
            state = next?;
            Ok(reached)
        });
        let Err(continuation::Stuck { fraction, reason }) = result else { return Ok(state) };
        let (relaxed, spent) = self.relax(&state, inputs);
        *iterations += spent;
        relaxed.map_err(|_| Error::NotConverged {
            requested: inputs.to_string(),
            reached: state.inputs.to_string(),
            fraction,
            reason,
        })
    }

    /// Both bodies apart and at rest: the one state that is known without solving.
    fn rest(&mut self, inputs: &Inputs) -> State {
        const CLEARANCE: f64 = 10e-6;
        let inputs =
            Inputs { penetration_depth: inputs.penetration_depth.min(-CLEARANCE), sliding_speed: 0.0, ..*inputs };
        let mirrored = self.may_mirror(&inputs);
        let system = self.system(mirrored);
        State {
            inputs,
            mirrored,
            unknowns: system.rest(inputs.penetration_depth),
            active: vec![false; system.stations.len()],
            sensitivities: Vec::new(),
            iterations: 0,
        }
    }

    /// Whether the bodies may be mirror images of each other: equal, and moving alike.
    fn may_mirror(&self, inputs: &Inputs) -> bool {
        self.mirrored.is_some() && inputs.slide_to_roll_ratio == 0.0
    }

    fn system(&mut self, mirrored: bool) -> &mut System {
        let slot = if mirrored { &mut self.mirrored } else { &mut self.full };
        slot.get_or_insert_with(|| {
            let mut system = System::new(&self.parameters, mirrored);
            system.set_threads(self.threads);
            system
        })
    }

    /// One step of the continuation: the state at `target`, or why not; and the Newton iterations spent.
    fn step(&mut self, from: &State, target: &Inputs, limit: usize) -> (Result<State, String>, usize) {
        let mirrored = from.mirrored && self.may_mirror(target);
        let predicted = self.predict(from, target);
        let guess = self.converted(predicted, mirrored);
        let (result, mut spent) = self.solve(guess, target, limit);
        let state = match result {
            Ok(state) => state,
            Err(reason) => return (Err(reason), spent),
        };
        let touching = state.active.contains(&true);
        // Boundary friction pulls the two bodies apart sideways; without it they are mirror images again.
        let friction = touching && boundary_friction(&self.parameters, target) != 0.0;
        match (state.mirrored, friction) {
            (true, true) => {
                let guess = self.converted(state, false);
                let (result, more) = self.solve(guess, target, limit);
                spent += more;
                (result, spent)
            }
            (false, false) if self.may_mirror(target) => (Ok(self.converted(state, true)), spent),
            _ => (Ok(state), spent),
        }
    }

    /// Steady state as the end of a motion in time: squeeze and drainage damp what Newton's method alone would overshoot. The
    /// bones approach bit by bit; the steps of backward Euler grow as they succeed, until time plays no part.
    fn relax(&mut self, from: &State, target: &Inputs) -> (Result<State, String>, usize) {
        let mirrored = from.mirrored && self.may_mirror(target);
        let mut state = self.converted(from.clone(), mirrored);
        let mut before = self.system(mirrored).contents(&state.unknowns, &state.inputs);
        let approach = (target.penetration_depth - from.inputs.penetration_depth).abs();
        let thickness = self.parameters.upper.thickness.min(self.parameters.lower.thickness);
        let stride = |step: f64| RELAXING_APPROACH * thickness / approach * (step / 1e-3).min(1.0);
        let (mut step, mut done, mut patience, mut quick, mut spent) = (1e-5, 0.0, 0, 0, 0);
        while quick < 3 {
            let next = f64::min(done + stride(step), 1.0);
            let inputs = between(&from.inputs, target, next);
            let rates = Rates::backward_euler(step, &before);
            let mut guess = state.clone();
            let approach = inputs.penetration_depth - state.inputs.penetration_depth;
            self.system(mirrored).compress(&mut guess.unknowns, approach);
            let (result, iterations) = self.solve_with(guess, &inputs, RELAXING_ITERATIONS, Some(&rates), 1e-2);
            spent += iterations;
            match result {
                Ok(solved) => {
                    state = solved;
                    before = self.system(mirrored).contents(&state.unknowns, &inputs);
                    patience -= 1;
                    if patience < 0 {
                        step *= if iterations < 5 { 2.0 } else { 1.2 };
                    }
                    quick = if done == 1.0 && iterations < 2 { quick + 1 } else { 0 };
                    done = next;
                }
                Err(reason) if step < 1e-10 || spent > LONGEST_RELAXATION => return (Err(reason), spent),
                Err(_) => {
                    step /= 3.0;
                    patience = 3;
                }
            }
        }
        let (result, iterations) = self.solve(state, target, COLD_ITERATIONS);
        (result, spent + iterations)
    }

    /// The state on the tangent at the target inputs.
    fn predict(&mut self, from: &State, target: &Inputs) -> State {
        let mut state = from.clone();
        if from.sensitivities.is_empty() {
            let approach = target.penetration_depth - from.inputs.penetration_depth;
            self.system(from.mirrored).compress(&mut state.unknowns, approach);
            return state;
        }
        let changes = [
            target.penetration_depth - from.inputs.penetration_depth,
            target.sliding_speed - from.inputs.sliding_speed,
            target.slide_to_roll_ratio - from.inputs.slide_to_roll_ratio,
        ];
        let mut update = vec![0.0; from.unknowns.len()];
        for (sensitivity, change) in from.sensitivities.chunks_exact(from.unknowns.len()).zip(changes) {
            update.iter_mut().zip(sensitivity).for_each(|(u, s)| *u -= s * change);
        }
        self.system(from.mirrored).apply(&mut state.unknowns, &update, &from.active);
        state
    }

    /// Newton's method from a guess.
    fn solve(&mut self, guess: State, target: &Inputs, limit: usize) -> (Result<State, String>, usize) {
        self.solve_with(guess, target, limit, None, self.parameters.tolerance)
    }

    fn solve_with(
        &mut self,
        guess: State,
        target: &Inputs,
        limit: usize,
        rates: Option<&Rates>,
        tolerance: f64,
    ) -> (Result<State, String>, usize) {
        let settings = newton::Settings { tolerance, maximum_iterations: limit };
        let State { mirrored, mut unknowns, active, .. } = guess;
        let system = self.system(mirrored);
        let mut problem = Balance { system, inputs: target, rates, active, residual: Residual::default() };
        match newton::solve(&mut problem, &mut unknowns, &mut Vec::new(), &settings) {
            Err(failure) => (Err(failure.reason), failure.iterations),
            Ok(iterations) => {
                let Balance { system, active, residual, .. } = problem;
                let sensitivities = system
                    .sensitivities(&unknowns, &active, target, rates, &residual.contact_forces)
                    .map_err(|singular| singular.to_string());
                let state = sensitivities.map(|sensitivities| State {
                    inputs: *target,
                    mirrored,
                    unknowns,
                    active,
                    sensitivities,
                    iterations: iterations as i32,
                });
                (state, iterations)
            }
        }
    }

    /// The same state in the unknowns of one body or of two.
    fn converted(&mut self, state: State, mirrored: bool) -> State {
        if state.mirrored == mirrored {
            return state;
        }
        let (n_from, n_to) = (self.system(state.mirrored).unknowns(), self.system(mirrored).unknowns());
        let (Some(one), Some(two)) = (&self.mirrored, &self.full) else { return state };
        let convert = |values: &[f64]| {
            let mut result = vec![0.0; n_to];
            let mut copy = |in_one: u32, in_two: u32, sign: f64| {
                let (from, to) = if mirrored { (in_two, in_one) } else { (in_one, in_two) };
                if from != FIXED && to != FIXED {
                    result[to as usize] = sign * values[from as usize];
                }
            };
            for (a, b) in one.layout.gap.iter().zip(&two.layout.gap) {
                copy(*a, *b, 1.0);
            }
            // The upper body last: it is the one that counts where two become one.
            for (body, sign) in [(1, -1.0), (0, 1.0)] {
                for node in 0..one.layout.pressure[0].len() {
                    copy(one.layout.horizontal[0][node], two.layout.horizontal[body][node], 1.0);
                    copy(one.layout.vertical[0][node], two.layout.vertical[body][node], sign);
                    copy(one.layout.pressure[0][node], two.layout.pressure[body][node], 1.0);
                }
            }
            result
        };
        State {
            mirrored,
            unknowns: convert(&state.unknowns),
            sensitivities: state
                .sensitivities
                .chunks_exact(n_from)
                .enumerate()
                // A mirrored pair does not change with the slide-to-roll ratio.
                .flat_map(|(k, s)| if mirrored && k == 2 { vec![0.0; n_to] } else { convert(s) })
                .collect(),
            ..state
        }
    }

    /// Makes a converged state the present one.
    fn accept(&mut self, state: State) -> Result<(), Error> {
        let parameters = self.parameters;
        let system = self.system(state.mirrored);
        let mut active = state.active.clone();
        let mut residual = Residual::default();
        system
            .residual(&state.unknowns, &mut active, &state.inputs, None, &mut residual)
            .map_err(|inverted| Error::State(inverted.to_string()))?;
        let contact_force_sensitivities = system.contact_force_sensitivities(
            &state.unknowns,
            &state.active,
            &state.inputs,
            None,
            &state.sensitivities,
        );
        let solved = Solved {
            system,
            parameters: &parameters,
            inputs: &state.inputs,
            unknowns: &state.unknowns,
            active: &state.active,
            contact_forces: &residual.contact_forces,
            sensitivities: &state.sensitivities,
            contact_force_sensitivities: &contact_force_sensitivities,
        };
        (self.outputs, self.derivatives) = solved.outputs();
        self.outputs.newton_iterations = state.iterations;
        self.inputs = state.inputs;
        self.state = Some(state);
        Ok(())
    }

    /// Results of the last solution.
    pub fn outputs(&self) -> &Outputs {
        &self.outputs
    }

    /// Derivatives of the results with respect to one input, from the tangent of the last solution. The fields that are not
    /// continuous (regime, iterations) are meaningless there.
    pub fn derivatives(&self, input: Input) -> &Outputs {
        &self.derivatives[input as usize]
    }

    /// The fixed stations of the profiles [m], [`STATIONS`] of them, ascending.
    pub fn position(&self) -> &[f64] {
        &self.position
    }

    /// Fields of the last solution over both bodies and along the interface; `None` before anything was solved.
    pub fn fields(&self) -> Option<Fields> {
        let State { inputs, mirrored, unknowns, active, .. } = self.state.as_ref()?;
        let system = if *mirrored { &self.mirrored } else { &self.full }.as_ref()?;
        let solution = Solution { system, parameters: &self.parameters, inputs, unknowns, active, rates: None };
        // A state was accepted only with all elements the right way out.
        solution.fields().ok()
    }

    /// Number of unknowns of the present state's equations, or of those that would be solved first.
    pub fn unknowns(&self) -> usize {
        let mirrored = self.state.as_ref().map_or(self.mirrored.is_some(), |s| s.mirrored);
        let system = if mirrored { &self.mirrored } else { &self.full };
        system.as_ref().map_or(0, System::unknowns)
    }

    /// A copy of the state.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot(self.state.clone())
    }

    /// Returns to a state taken from this simulation or from one with equal parameters.
    ///
    /// # Errors
    /// [`Error::State`] where the snapshot does not fit; the state is then unchanged.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), Error> {
        let Some(state) = &snapshot.0 else {
            let (mirrored, full) = (self.mirrored.take(), self.full.take());
            *self = Self { threads: self.threads, mirrored, full, ..Self::unsolved(&self.parameters) };
            return Ok(());
        };
        if state.mirrored && self.mirrored.is_none() {
            return Err(Error::State("it is of two equal bodies, and these are not".into()));
        }
        let system = self.system(state.mirrored);
        let expected = [system.unknowns(), system.stations.len(), 3 * system.unknowns()];
        let given = [state.unknowns.len(), state.active.len(), state.sensitivities.len()];
        if expected != given {
            return Err(Error::State(format!("it has {} unknowns, this mesh {}", given[0], expected[0])));
        }
        self.accept(state.clone())
    }
}

/// The inputs at a fraction of the way.
fn between(from: &Inputs, to: &Inputs, fraction: f64) -> Inputs {
    if fraction == 1.0 {
        return *to;
    }
    let mix = |a: f64, b: f64| a + fraction * (b - a);
    Inputs {
        penetration_depth: mix(from.penetration_depth, to.penetration_depth),
        sliding_speed: mix(from.sliding_speed, to.sliding_speed),
        slide_to_roll_ratio: mix(from.slide_to_roll_ratio, to.slide_to_roll_ratio),
    }
}

/// The system at fixed inputs, as Newton's method sees it.
struct Balance<'a> {
    system: &'a mut System,
    inputs: &'a Inputs,
    rates: Option<&'a Rates>,
    active: Vec<bool>,
    residual: Residual,
}

impl newton::Problem for Balance<'_> {
    fn residual(&mut self, unknowns: &[f64], residual: &mut Vec<f64>) -> Result<bool, String> {
        let changed = self
            .system
            .residual(unknowns, &mut self.active, self.inputs, self.rates, &mut self.residual)
            .map_err(|inverted| inverted.to_string())?;
        residual.clone_from(&self.residual.values);
        Ok(changed)
    }

    fn factorise(&mut self, unknowns: &[f64]) -> Result<(), String> {
        self.system.factorise(unknowns, &self.active, self.inputs, self.rates).map_err(|e| e.to_string())
    }

    fn solve(&mut self, right_hand_side: &mut [f64]) -> Result<(), String> {
        self.system.solve(right_hand_side).map_err(|e| e.to_string())
    }

    fn apply(&self, unknowns: &mut [f64], update: &[f64]) {
        self.system.apply(unknowns, update, &self.active);
    }

    fn relative_size(&self, unknowns: &[f64], update: &[f64]) -> f64 {
        self.system.relative_size(unknowns, update)
    }
}
