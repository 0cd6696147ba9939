//! The equations of one body and its mirror image or of two, and solutions of them.

use crate::equations::grid;
use crate::equations::system::System;
pub(super) use crate::equations::system::{ReusableTangent, State, Task};
use crate::error::Error;
use crate::memory;
use crate::parameters::{Control, Inputs, Parameters};
use crate::solver::deadline::Deadline;
use crate::solver::linear::{FIXED, Singular};
pub(super) use crate::solver::newton::PredictorEstimate;

/// The equations: those of a mirrored pair, where the two bodies are equal, and those of two bodies, made when first needed.
#[derive(Debug)]
pub(super) struct Bodies {
    pub parameters: Parameters,
    /// Of the solution that is being looked for.
    pub deadline: Deadline,
    threads: usize,
    mirrored: Option<System>,
    full: Option<System>,
}

impl Bodies {
    pub fn new(parameters: &Parameters) -> Self {
        let equal = parameters.equal_bodies();
        let system = System::new(
            parameters,
            equal,
            grid::contact_half_width(parameters, &Inputs::default(), parameters.control),
        );
        let (mirrored, full) = if equal { (Some(system), None) } else { (None, Some(system)) };
        Self { parameters: *parameters, deadline: Deadline::default(), threads: 1, mirrored, full }
    }

    pub fn set_threads(&mut self, threads: usize) {
        self.threads = threads;
        [&mut self.mirrored, &mut self.full].into_iter().flatten().for_each(|system| system.set_threads(threads));
    }

    /// Whether the two bodies are equal.
    pub fn equal(&self) -> bool {
        self.mirrored.is_some()
    }

    /// Whether the bodies may be mirror images of each other: equal, and moving alike.
    pub fn may_mirror(&self, inputs: &Inputs) -> bool {
        self.equal() && inputs.slide_to_roll_ratio == 0.0
    }

    /// Whether boundary friction pulls the two bodies apart sideways.
    pub fn drags(&self, state: &State) -> bool {
        self.made(state.mirrored).is_some_and(|system| system.drags(state))
    }

    /// The equations of a state, on its mesh.
    pub fn system_of(&mut self, state: &State) -> &mut System {
        let system = self.system(state.mirrored);
        system.fit(state.contact_half_width, &state.shifts, state.thickening);
        system
    }

    /// Sees that there is memory for a solution; the equations of two bodies apart may still have to be made.
    pub fn reserve(&self) -> Result<(), Error> {
        memory::reserve(&self.parameters, self.full.is_some())
    }

    /// The equations on whatever mesh they had last.
    pub fn system(&mut self, mirrored: bool) -> &mut System {
        let slot = if mirrored { &mut self.mirrored } else { &mut self.full };
        slot.get_or_insert_with(|| {
            let contact = grid::contact_half_width(&self.parameters, &Inputs::default(), self.parameters.control);
            let mut system = System::new(&self.parameters, mirrored, contact);
            system.set_threads(self.threads);
            system
        })
    }

    /// What contact the mesh is made for at these inputs.
    pub fn contact_half_width(&self, inputs: &Inputs, control: Control) -> f64 {
        grid::contact_half_width(&self.parameters, inputs, control)
    }

    /// The equations of one body or of two, if they were made already.
    pub fn made(&self, mirrored: bool) -> Option<&System> {
        if mirrored { self.mirrored.as_ref() } else { self.full.as_ref() }
    }

    /// Both bodies apart and at rest: the one state that is known without solving.
    pub fn rest(&mut self, inputs: &Inputs) -> State {
        const CLEARANCE: f64 = 10e-6;
        let inputs = Inputs { penetration_depth: inputs.penetration_depth.min(-CLEARANCE), ..*inputs };
        let contact_half_width = self.contact_half_width(&inputs, Control::Depth);
        let system = self.system(self.may_mirror(&inputs));
        system.fit(contact_half_width, &[], 1.0);
        system.rest(inputs)
    }

    /// A guess of a state in motion: the bones at a depth, and the surfaces apart by a film of a fluid that is thicker than it is.
    pub fn afloat(&mut self, inputs: &Inputs, film: f64, thickening: f64) -> State {
        let contact_half_width = self.contact_half_width(inputs, Control::Depth);
        let system = self.system(self.may_mirror(inputs));
        system.fit(contact_half_width, &[], thickening);
        let mut state = State { inputs: *inputs, ..system.rest(*inputs) };
        system.lift(&mut state.unknowns, film);
        state
    }

    /// A guess of a state in which surface nodes that are paired are at the same place along x, where they are not near enough, see
    /// [`crate::equations::facing`]. On the way with a thicker fluid that is further off.
    pub fn paired_anew(&mut self, state: &State, part: f64) -> Option<State> {
        /// Over the half-width of the interface.
        const NEAR: f64 = 3e-4;
        let system = self.system_of(state);
        let near = if state.thickening == 1.0 { NEAR } else { 10.0 * NEAR };
        (system.pairs_deformed() && system.mismatch(state) > near).then(|| system.paired_anew(state, part))
    }

    /// A guess of a state nearby, on the mesh of the contact there: each node keeps what it has in proportion to the contact.
    pub fn carried(&mut self, state: &State, contact_half_width: f64, shifts: Vec<f64>) -> State {
        let mut guess = State { contact_half_width, shifts, ..state.clone() };
        if (contact_half_width, &guess.shifts) != (state.contact_half_width, &state.shifts) {
            let system = self.system_of(state);
            let ratio = system.carry(&mut guess.unknowns, contact_half_width, &guess.shifts);
            guess.inputs.penetration_depth *= ratio;
        }
        guess
    }

    /// Newton's method from a guess; and the iterations spent.
    pub fn settle(&mut self, guess: State, task: &Task<'_>) -> (Result<State, String>, usize) {
        self.system(guess.mirrored).settle(guess, task)
    }

    /// Factorises the tangent at a linearization point, unless that was the last one.
    pub fn form(&mut self, linearization: &State) -> Result<(), Singular> {
        self.system(linearization.mirrored).form(linearization)
    }

    /// The same state in the unknowns of one body (`mirrored`) or of two.
    pub fn converted(&mut self, mut state: State, mirrored: bool) -> State {
        if state.mirrored == mirrored {
            return state;
        }
        if let Some(rates) = &mut state.rates {
            match mirrored {
                true => {
                    rates.history.volume.truncate(1);
                    rates.history.stations.truncate(1);
                    rates.history.places.truncate(1);
                }
                false => {
                    rates.history.volume.extend_from_within(..);
                    rates.history.stations.extend_from_within(..);
                    rates.history.places.extend_from_within(..);
                }
            }
        }
        let shifts = if mirrored { Vec::new() } else { state.shifts };
        State { unknowns: self.converted_values(&state.unknowns, mirrored), mirrored, shifts, ..state }
    }

    fn converted_values(&mut self, values: &[f64], mirrored: bool) -> Vec<f64> {
        let mut result = vec![0.0; self.system(mirrored).unknowns()];
        let (Some(one), Some(two)) = (&self.mirrored, &self.full) else { return result };
        let mut copy = |in_one: u32, in_two: u32, sign: f64| {
            let (from, to) = if mirrored { (in_two, in_one) } else { (in_one, in_two) };
            if from != FIXED && to != FIXED {
                result[to as usize] = sign * values[from as usize];
            }
        };
        for (a, b) in one.layout.gap.iter().zip(&two.layout.gap) {
            copy(*a, *b, 1.0);
        }
        for (a, b) in one.layout.void.iter().zip(&two.layout.void) {
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
    }
}
