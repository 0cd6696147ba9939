//! The way to a steady state: steps of what is given, and where they fail, motion in time that comes to rest.

mod path;
mod relaxation;
mod step;

use self::path::Target;
use self::step::settings;
use super::bodies::{Bodies, ReusableTangent, State, Task};
use crate::equations::grid;
use crate::equations::system::Solved;
use crate::error::Error;
use crate::parameters::{Control, Formulation, Inputs, Parameters};
use crate::solver::continuation;

/// A tangent is reused for as many Newton iterations as cost about as much as its factorisation, see [`newton::Settings::patience`].
pub(super) const PATIENCE: f64 = 4.0;
/// Most Newton iterations of a step.
const ITERATIONS: usize = 25;
/// How many times its own viscosity the fluid has at most, in film and pores, on the way to a state from rest: so thick that no fluid to speak
/// of comes out of the tissue where it enters the contact. A thin film cannot carry that off (of a flux Q = U h/2 - h^3 p'/(12 eta) there
/// is a most), it piles up in a jump, and the jump moves through the mesh as the load grows.
const THICKENING: f64 = 1000.0;
/// But not so thick that the film is thicker than about this fraction of the depth: between surfaces that all but conform it would be, and would
/// hold them together beyond the contact.
const THICKEST_FILM: f64 = 0.2;
/// From what depth such a way starts at once, or from a half or a quarter of it, and with a film of what thickness, as fractions of a layer's
/// thickness.
const AFLOAT: (f64, f64) = (0.1, 0.02);

/// Fractions of the depth and of the load from which a state is reached that is not from rest.
const LESS: (f64, f64) = (0.75, 0.5);

/// Fibres make tissue far stiffer than the theory that says what depth goes with a load. From this load on it is followed up \[N/m\].
const FIRST_LOAD: f64 = 50.0;

/// Slower motion is followed down from this speed: the slower tissue passes the contact, the more of its fluid it gives off \[m/s\].
const FIRST_SPEED: f64 = 0.03;

/// Least load for which there is a steady film worth the name \[N/m\].
const LEAST_LOAD: f64 = 1e-6;

/// The shortest step before giving up: as a fraction of the way, and where the mesh goes with the contact as one of the first step, since
/// shorter ones take longer than motion in time.
const SHORTEST: [f64; 2] = [1.0 / 1024.0, 0.1];

/// The way to a steady state, as far as it was gone: the state that was reached, and the tangent that led to it.
pub(super) struct Way<'a> {
    bodies: &'a mut Bodies,
    pub state: State,
    pub reusable: Option<Box<ReusableTangent>>,
    /// Newton iterations spent.
    pub iterations: usize,
}

/// Where a way ended early.
struct Stuck {
    reached: Inputs,
    fraction: f64,
    reason: String,
}

/// Goes to the steady state for these inputs, from a state that may be near with its tangent, or from rest.
pub(super) fn solve<'a>(
    bodies: &'a mut Bodies,
    from: Option<(State, Option<Box<ReusableTangent>>)>,
    inputs: &Inputs,
) -> Result<Way<'a>, Error> {
    let control = bodies.parameters.control;
    if control == Control::Load && inputs.applied_load < LEAST_LOAD {
        let allowed = format!("{LEAST_LOAD:e} N/m or more: with less the surfaces part, and there is no steady state");
        return Err(Error::value("applied_load", inputs.applied_load, allowed));
    }
    let target = Target::new(control, inputs);
    let solved = from.is_some();
    let (state, reusable) = from.unwrap_or_else(|| (bodies.rest(inputs), None));
    // Tissue that turns round comes to rest on its way, and there it drains: such states are further from each other than from rest.
    let ways = |inputs: &Inputs| inputs.surface_speeds().map(|speed| if speed == 0.0 { 0.0 } else { speed.signum() });
    let near = !grid::moves(&bodies.parameters) || ways(&state.inputs) == ways(inputs);
    let mut way = Way { bodies, state, reusable, iterations: 0 };
    let result = match (solved, near) {
        (false, _) => way.start(inputs),
        (true, true) => match way.follow(&target) {
            Err(stuck) if stuck.reason != UNRESOLVED => way.start(inputs),
            result => result,
        },
        (true, false) => {
            let before = (way.state.clone(), way.reusable.clone());
            way.start(inputs).or_else(|_| {
                (way.state, way.reusable) = before;
                way.follow(&target)
            })
        }
    };
    match result {
        Ok(()) => Ok(way),
        Err(Stuck { reached, fraction, reason }) => {
            let requested = inputs.described(control);
            Err(Error::NotConverged { requested, reached: reached.to_string(), fraction, reason })
        }
    }
}

impl Way<'_> {
    /// From rest: at once, or where that fails and the mesh goes with the contact, from less depth or load.
    fn start(&mut self, inputs: &Inputs) -> Result<(), Stuck> {
        let parameters = &self.bodies.parameters;
        let control = parameters.control;
        let less = match control {
            Control::Depth => Inputs { penetration_depth: LESS.0 * inputs.penetration_depth, ..*inputs },
            Control::Load => Inputs { applied_load: LESS.1 * inputs.applied_load, ..*inputs },
        };
        let depth = grid::Expected::new(parameters, &less, control).depth;
        let deep = grid::moves(parameters) && depth > AFLOAT.0 * self.thickness();
        match self.start_at_once(inputs) {
            Err(stuck) if deep && !self.bodies.deadline.passed() => match self.start(&less) {
                Ok(()) => self.follow(&Target::new(control, inputs)),
                Err(_) => Err(stuck),
            },
            result => result,
        }
    }

    /// From rest at once. Where the mesh goes with the contact: afloat on a thick fluid, then pressed on each other, and last the fluid
    /// becomes what it is in time. Else the surfaces are set in motion before they touch, and then pressed on each other.
    fn start_at_once(&mut self, inputs: &Inputs) -> Result<(), Stuck> {
        let parameters = self.bodies.parameters;
        let control = parameters.control;
        let target = Target::new(control, inputs);
        let fibres = [parameters.upper, parameters.lower].iter().any(|body| body.fibre_modulus > 0.0);
        let mut first = *inputs;
        if control == Control::Load && fibres {
            first.applied_load = inputs.applied_load.min(FIRST_LOAD);
        }
        let speed = inputs.sliding_speed;
        if grid::moves(&parameters) && speed != 0.0 {
            first.sliding_speed = speed.abs().max(FIRST_SPEED).copysign(speed);
        }
        if first != *inputs {
            self.start(&first)?;
            return self.follow(&target);
        }
        let expected = grid::Expected::new(&parameters, inputs, control);
        let depth = match control {
            Control::Depth => inputs.penetration_depth,
            Control::Load => expected.depth,
        };
        let thickening = if grid::moves(&parameters) { thickening(&parameters, inputs, &expected) } else { 1.0 };
        let at = |penetration_depth| {
            let inputs = Inputs { penetration_depth, ..*inputs };
            Target { control: Control::Depth, inputs, thickening }
        };
        self.state = State { thickening, ..self.bodies.rest(inputs) };
        self.reusable = None;
        if !(thickening > 1.0 && self.float(depth, at)) {
            self.follow(&at(self.state.inputs.penetration_depth))?;
        }
        self.follow(&at(depth))?;
        match (control, thickening) {
            (Control::Depth, 1.0) => Ok(()),
            _ => self.relax(&target),
        }
    }

    /// Sets the surfaces afloat on a thick fluid, at no more than this depth; returns whether that was possible.
    fn float(&mut self, depth: f64, at: impl Fn(f64) -> Target) -> bool {
        let thickness = self.thickness();
        [1.0, 0.5, 0.25].into_iter().any(|part| {
            let afloat = at(part * depth.min(AFLOAT.0 * thickness));
            let guess = self.bodies.afloat(&afloat.inputs, AFLOAT.1 * thickness, afloat.thickening);
            // Not from nearby: what was no more than guessed changes by much.
            let settings = settings(self.bodies);
            let task = Task { control: afloat.control, settings, distance_counts: true, reusable: None };
            let (result, spent) = self.bodies.settle(guess, &task);
            self.iterations += spent;
            let Ok(state) = result else { return false };
            self.state = state;
            true
        })
    }

    /// Goes to another state by steps of what is given, and from where they fail by motion in time.
    fn follow(&mut self, to: &Target) -> Result<(), Stuck> {
        match self.continue_to(to) {
            Err(stuck) if stuck.reason != UNRESOLVED => self.relax(to),
            result => result,
        }
    }

    /// Goes to another state by steps of what is given.
    fn continue_to(&mut self, to: &Target) -> Result<(), Stuck> {
        let moves = grid::moves(&self.bodies.parameters);
        let start = Target::of(&self.state, to.control);
        let first = if moves { start.first_step(to) } else { 1.0 };
        let shortest = if moves { SHORTEST[1] * first } else { SHORTEST[0] };
        let mut lost = false;
        let result = continuation::advance(first, shortest, |fraction| {
            if lost {
                return Err(UNRESOLVED.to_string());
            }
            let before = self.iterations;
            let result = self.step(&start.between(to, fraction, moves));
            lost = result.is_err() && unresolved(self.bodies, &self.state);
            result.map(|()| self.iterations - before)
        });
        result.map_err(|continuation::Stuck { fraction, reason }| self.stuck(fraction, reason))
    }

    fn stuck(&self, fraction: f64, reason: String) -> Stuck {
        Stuck { reached: self.state.inputs, fraction, reason }
    }

    /// Thickness of the layers \[m\].
    fn thickness(&mut self) -> f64 {
        self.bodies.system(self.bodies.equal()).thickness()
    }
}

/// How many times its own viscosity the fluid has on the way from rest to a contact like this.
fn thickening(parameters: &Parameters, inputs: &Inputs, expected: &grid::Expected) -> f64 {
    let grid::Expected { depth, half_width, load } = *expected;
    // Viscosity times speed times half-width over the mean pressure is about the square of the film's thickness.
    let square = parameters.viscosity * inputs.sliding_speed.abs() * half_width / (load / (2.0 * half_width));
    ((THICKEST_FILM * depth).powi(2) / square).clamp(1.0, THICKENING)
}

/// Why no other way is tried, however long it would take.
const UNRESOLVED: &str = "the stress of the tissue is far above every pressure: the mesh does not resolve how the pressure falls in so \
                          tight a tissue, which in the paper's formulation turns elements inside out (formulation = \"consistent\" \
                          has no such limit, a larger permeability is further from it)";
/// Stress over pressure of such a state. On a mesh that is good enough they are of one size.
const UNRESOLVED_STRESS: f64 = 1e3;

/// Whether a state of the paper's equations is one from which no step is worth trying that failed once.
fn unresolved(bodies: &mut Bodies, state: &State) -> bool {
    if bodies.parameters.formulation != Formulation::Paper {
        return false;
    }
    let (outputs, _) = Solved { system: bodies.system_of(state), state }.outputs();
    let fluid = outputs.maximum_fluid_pressure.max(-outputs.minimum_fluid_pressure);
    let largest = fluid.max(outputs.maximum_contact_pressure);
    largest > 0.0 && outputs.maximum_von_mises_stress > UNRESOLVED_STRESS * largest
}
