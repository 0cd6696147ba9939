//! The equations of one body and its mirror image or of two, and solutions of them.

use serde::{Deserialize, Serialize};

use crate::equations::grid;
use crate::equations::system::{At, Cause, Change, Direction, Rates, Residual, System, boundary_friction};
use crate::error::Error;
use crate::memory;
use crate::parameters::{Control, Inputs, Parameters};
use crate::solver::deadline::Deadline;
use crate::solver::linear::{FIXED, Singular};
use crate::solver::newton;
pub(super) use crate::solver::newton::Foreseen;

/// A solution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Point {
    /// The inputs, with the depth that was found where the load is given.
    pub inputs: Inputs,
    /// Whether the lower body is the mirror image of the upper one.
    pub mirrored: bool,
    /// What contact the mesh is made for, see [`crate::equations::grid::contact_half_width`] \[m\].
    pub contact_half_width: f64,
    /// How many times its own viscosity the film has: 1 but on the way to a state.
    pub thickening: f64,
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

    pub fn touches(&self) -> bool {
        self.active.contains(&true)
    }
}

/// Where a tangent was formed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Place {
    pub point: Point,
    pub rates: Option<Rates>,
}

/// How a solution changes with one input, and its load \[N/m\].
#[derive(Debug)]
pub(super) struct Slope {
    pub unknowns: Vec<f64>,
    pub load: f64,
}

/// The tangent that was factorised last, and the changes with depth, speed and slide-to-roll ratio that were asked of it.
#[derive(Debug, Default)]
struct Tangent {
    place: Option<Place>,
    slopes: [Option<Slope>; 3],
}

impl Tangent {
    /// Factorises the tangent at a point, unless it is that already.
    fn form(&mut self, system: &mut System, place: &Place) -> Result<(), Singular> {
        if self.place.as_ref() == Some(place) {
            return Ok(());
        }
        *self = Self::default();
        let Place { point, rates } = place;
        let present = (system.contact_half_width(), system.thickening());
        system.fit(point.contact_half_width, point.thickening);
        let result = system.factorise(&point.unknowns, &point.active, &point.inputs, rates.as_ref());
        system.fit(present.0, present.1);
        result?;
        self.place = Some(place.clone());
        Ok(())
    }

    /// The change with one of depth, speed and slide-to-roll ratio.
    fn slope(&mut self, system: &mut System, input: usize) -> Result<&Slope, Singular> {
        let Some(Place { point, rates }) = &self.place else { return Err(Singular) };
        match &mut self.slopes[input] {
            Some(slope) => Ok(slope),
            slot => {
                let cause = Cause { direction: Direction::UNIT[input], ..Cause::default() };
                let at = point.at(rates.as_ref());
                let present = (system.contact_half_width(), system.thickening());
                system.fit(point.contact_half_width, point.thickening);
                let slope = system.respond(at, vec![cause]).map(|mut changes| {
                    let load = |change: &Change| system.loads(at, change).total().eps;
                    changes.pop().map(|change| Slope { load: load(&change), unknowns: change.unknowns })
                });
                system.fit(present.0, present.1);
                Ok(slot.insert(slope?.ok_or(Singular)?))
            }
        }
    }
}

/// What Newton's method is asked for.
pub(super) struct Task<'a> {
    pub inputs: &'a Inputs,
    pub rates: Option<&'a Rates>,
    pub control: Control,
    pub settings: newton::Settings,
    /// Where the tangent was formed that may serve once more, and what was foreseen with it.
    pub kept: Option<(&'a Place, Foreseen)>,
}

/// The equations: those of a mirrored pair, where the two bodies are equal, and those of two bodies, made when first needed.
#[derive(Debug)]
pub(super) struct Bodies {
    pub parameters: Parameters,
    /// Of the solution that is being looked for.
    pub deadline: Deadline,
    threads: usize,
    mirrored: Option<System>,
    full: Option<System>,
    tangent: Tangent,
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
        Self {
            parameters: *parameters,
            deadline: Deadline::default(),
            threads: 1,
            mirrored,
            full,
            tangent: Tangent::default(),
        }
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
    pub fn drags(&self, point: &Point) -> bool {
        (point.touches() || self.parameters.surface_roughness > 0.0)
            && boundary_friction(&self.parameters, &point.inputs) != 0.0
    }

    /// The equations that a point is a solution of, on its mesh.
    pub fn system_of(&mut self, point: &Point) -> &mut System {
        let system = self.system(point.mirrored);
        system.fit(point.contact_half_width, point.thickening);
        system
    }

    /// Sees that there is memory for a solution; the equations of two bodies apart may still have to be made.
    pub fn reserve(&self) -> Result<(), Error> {
        memory::reserve(&self.parameters, self.full.is_some())
    }

    /// The equations on whatever mesh they had last.
    pub fn system(&mut self, mirrored: bool) -> &mut System {
        self.system_and_tangent(mirrored).0
    }

    /// What contact the mesh is made for at these inputs.
    pub fn contact_half_width(&self, inputs: &Inputs, control: Control) -> f64 {
        grid::contact_half_width(&self.parameters, inputs, control)
    }

    fn system_and_tangent(&mut self, mirrored: bool) -> (&mut System, &mut Tangent) {
        let slot = if mirrored { &mut self.mirrored } else { &mut self.full };
        let system = slot.get_or_insert_with(|| {
            let contact = grid::contact_half_width(&self.parameters, &Inputs::default(), self.parameters.control);
            let mut system = System::new(&self.parameters, mirrored, contact);
            system.set_threads(self.threads);
            system
        });
        (system, &mut self.tangent)
    }

    /// The equations that a point was solved with, if they were made already.
    pub fn made(&self, mirrored: bool) -> Option<&System> {
        if mirrored { self.mirrored.as_ref() } else { self.full.as_ref() }
    }

    /// Both bodies apart and at rest: the one state that is known without solving.
    pub fn rest(&mut self, inputs: &Inputs) -> Point {
        const CLEARANCE: f64 = 10e-6;
        let inputs =
            Inputs { penetration_depth: inputs.penetration_depth.min(-CLEARANCE), sliding_speed: 0.0, ..*inputs };
        let mirrored = self.may_mirror(&inputs);
        let contact_half_width = self.contact_half_width(&inputs, Control::Depth);
        let system = self.system(mirrored);
        system.fit(contact_half_width, 1.0);
        let stations = system.stations.len();
        Point {
            inputs,
            mirrored,
            contact_half_width,
            thickening: 1.0,
            unknowns: system.rest(inputs.penetration_depth),
            active: vec![false; stations],
            contact_forces: vec![0.0; stations],
        }
    }

    /// Newton's method from a guess; and the iterations spent. The last factorisation is near the solution, not at it.
    pub fn settle(&mut self, guess: Point, task: &Task<'_>) -> (Result<Point, String>, usize) {
        let Point { mirrored, mut unknowns, active, inputs, contact_half_width, thickening, .. } = guess;
        let loaded = task.control == Control::Load;
        let (system, tangent) = self.system_and_tangent(mirrored);
        system.fit(contact_half_width, thickening);
        let depth = if loaded { inputs.penetration_depth } else { task.inputs.penetration_depth };
        let inputs = Inputs { penetration_depth: depth, ..*task.inputs };
        let mut balance = Balance { system, tangent, inputs, task, active, residual: Residual::default() };
        if loaded {
            unknowns.push(depth);
        }
        match newton::solve(&mut balance, &mut unknowns, &mut Vec::new(), &task.settings) {
            Err(failure) => (Err(failure.reason), failure.iterations),
            Ok(iterations) => {
                let contact_forces = balance.contact_forces();
                let Balance { inputs, active, system, .. } = balance;
                unknowns.truncate(system.unknowns());
                let point =
                    Point { inputs, mirrored, contact_half_width, thickening, unknowns, active, contact_forces };
                (Ok(point), iterations)
            }
        }
    }

    /// Factorises the tangent at a place, unless that was the last one.
    pub fn form(&mut self, place: &Place) -> Result<(), Singular> {
        let (system, tangent) = self.system_and_tangent(place.point.mirrored);
        tangent.form(system, place)
    }

    /// Where the last tangent was formed.
    pub fn place(&self) -> Option<&Place> {
        self.tangent.place.as_ref()
    }

    /// How the solution changes with one of depth, speed and slide-to-roll ratio, by the last tangent.
    pub fn slope(&mut self, input: usize) -> Result<&Slope, Singular> {
        let mirrored = self.place().ok_or(Singular)?.point.mirrored;
        let (system, tangent) = self.system_and_tangent(mirrored);
        tangent.slope(system, input)
    }

    /// The same solution in the unknowns of one body or of two.
    pub fn converted(&mut self, point: Point, mirrored: bool) -> Point {
        if point.mirrored == mirrored {
            return point;
        }
        Point { unknowns: self.converted_values(&point.unknowns, mirrored), mirrored, ..point }
    }

    /// Values of the unknowns, or their changes, in those of one body (`mirrored`) from those of two, or the other way.
    pub fn converted_values(&mut self, values: &[f64], mirrored: bool) -> Vec<f64> {
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

/// The system with its inputs, as Newton's method sees it. Where the load is given, the depth is the last unknown.
struct Balance<'a> {
    system: &'a mut System,
    tangent: &'a mut Tangent,
    inputs: Inputs,
    task: &'a Task<'a>,
    active: Vec<bool>,
    residual: Residual,
}

/// Most change of the depth in one iteration, as a share of the layers' thickness.
pub(super) const LONGEST_APPROACH: f64 = 0.02;

impl Balance<'_> {
    fn contact_forces(&self) -> Vec<f64> {
        let pressing = |(force, active): (&f64, &bool)| if *active { *force } else { 0.0 };
        self.residual.contact_forces.iter().zip(&self.active).map(pressing).collect()
    }

    /// How far the load is from the given one, and the derivative of that by the load. In a film the load grows with powers of the
    /// depth: below the given one its logarithm is nearer to a straight line.
    fn mismatch(&self, unknowns: &[f64]) -> (f64, f64) {
        const LOGARITHMIC: f64 = 1e-3;
        let (active, contact_forces) = (&self.active, &self.contact_forces());
        let at = At { unknowns, active, contact_forces, inputs: &self.inputs, rates: self.task.rates };
        let (load, given) = (self.system.load(at), self.inputs.applied_load);
        if load > LOGARITHMIC * given && load < given {
            (given * (load / given).ln(), given / load)
        } else {
            (load - given, 1.0)
        }
    }

    /// A depth counts like a displacement of a thousandth of the thickness.
    fn depth_scale(&self, depth: f64) -> f64 {
        depth.abs() + 1e-3 * self.system.thickness()
    }

    fn loaded(&self) -> bool {
        self.task.control == Control::Load
    }
}

impl newton::Problem for Balance<'_> {
    fn residual(&mut self, unknowns: &[f64], residual: &mut Vec<f64>) -> Result<bool, String> {
        let n = self.system.unknowns();
        if self.loaded() {
            self.inputs.penetration_depth = unknowns[n];
        }
        let changed = self
            .system
            .residual(&unknowns[..n], &mut self.active, &self.inputs, self.task.rates, &mut self.residual)
            .map_err(|inverted| inverted.to_string())?;
        residual.clone_from(&self.residual.values);
        if self.loaded() {
            let (mismatch, slope) = self.mismatch(&unknowns[..n]);
            residual.push(mismatch / slope);
        }
        Ok(changed)
    }

    fn kept(&mut self) -> Option<Foreseen> {
        let (place, foreseen) = self.task.kept?;
        let rate = |rates: Option<&Rates>| rates.map(|rates| rates.rate);
        let fits = place.point.mirrored == self.system.mirrored()
            && place.point.active == self.active
            && rate(place.rates.as_ref()) == rate(self.task.rates);
        (fits && self.tangent.form(self.system, place).is_ok()).then_some(foreseen)
    }

    fn factorise(&mut self, unknowns: &[f64]) -> Result<(), String> {
        let point = Point {
            inputs: self.inputs,
            mirrored: self.system.mirrored(),
            contact_half_width: self.system.contact_half_width(),
            thickening: self.system.thickening(),
            unknowns: unknowns[..self.system.unknowns()].to_vec(),
            active: self.active.clone(),
            contact_forces: self.contact_forces(),
        };
        let place = Place { point, rates: self.task.rates.cloned() };
        self.system.set_deadline(self.task.settings.deadline);
        let formed = self.tangent.form(self.system, &place);
        self.system.set_deadline(Deadline::default());
        formed.map_err(|singular| singular.to_string())
    }

    fn solve(&mut self, right_hand_side: &mut [f64]) -> Result<(), String> {
        let n = self.system.unknowns();
        let (update, load) = right_hand_side.split_at_mut(n);
        self.system.solve(update).map_err(|singular| singular.to_string())?;
        let [load] = load else { return Ok(()) };
        // The column of the depth and the row of the load border the tangent.
        let Some(Place { point, rates }) = &self.tangent.place else { return Err("there is no tangent".into()) };
        let along = self.system.load_along(point.at(rates.as_ref()), update);
        let by_depth = self.tangent.slope(self.system, 0).map_err(|singular| singular.to_string())?;
        let most = LONGEST_APPROACH * self.system.thickness();
        let approach = ((along - *load) / by_depth.load).clamp(-most, most);
        update.iter_mut().zip(&by_depth.unknowns).for_each(|(u, s)| *u -= s * approach);
        *load = -approach;
        Ok(())
    }

    fn apply(&self, unknowns: &mut [f64], update: &[f64]) {
        let n = self.system.unknowns();
        let (unknowns, depth) = unknowns.split_at_mut(n);
        self.system.apply(unknowns, &update[..n], &self.active);
        depth.iter_mut().zip(&update[n..]).for_each(|(depth, change)| *depth -= change);
    }

    fn relative_size(&self, unknowns: &[f64], update: &[f64]) -> f64 {
        let n = self.system.unknowns();
        let changes = unknowns[n..].iter().zip(&update[n..]);
        let approach = changes.map(|(depth, change)| (change / self.depth_scale(*depth)).abs());
        approach.fold(self.system.relative_size(&unknowns[..n], &update[..n]), f64::max)
    }

    fn weights(&self, unknowns: &[f64]) -> Vec<f64> {
        let n = self.system.unknowns();
        let mut weights = self.system.weights_of(&unknowns[..n]);
        weights.extend(unknowns[n..].iter().map(|depth| 1.0 / self.depth_scale(*depth)));
        weights
    }
}
