//! The equations of one body and its mirror image or of two, and solutions of them.

use serde::{Deserialize, Serialize};

use crate::equations::system::{At, Change, Direction, Rates, Residual, System, boundary_friction};
use crate::parameters::{Control, Inputs, Parameters};
use crate::solver::linear::{FIXED, Singular};
use crate::solver::newton;

/// A solution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Point {
    /// The inputs, with the depth that was found where the load is given.
    pub inputs: Inputs,
    /// Whether the lower body is the mirror image of the upper one.
    pub mirrored: bool,
    pub unknowns: Vec<f64>,
    /// Stations in contact.
    pub active: Vec<bool>,
    /// Force of contact at each station, zero where there is none [N/m].
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

/// What Newton's method is asked for.
pub(super) struct Task<'a> {
    pub inputs: &'a Inputs,
    pub rates: Option<&'a Rates>,
    pub control: Control,
    pub settings: newton::Settings,
}

/// The equations: those of a mirrored pair, where the two bodies are equal, and those of two bodies, made when first needed.
#[derive(Debug)]
pub(super) struct Bodies {
    pub parameters: Parameters,
    threads: usize,
    mirrored: Option<System>,
    full: Option<System>,
}

impl Bodies {
    pub fn new(parameters: &Parameters) -> Self {
        let equal = parameters.upper == parameters.lower;
        let system = System::new(parameters, equal);
        let (mirrored, full) = if equal { (Some(system), None) } else { (None, Some(system)) };
        Self { parameters: *parameters, threads: 1, mirrored, full }
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
        point.touches() && boundary_friction(&self.parameters, &point.inputs) != 0.0
    }

    pub fn system(&mut self, mirrored: bool) -> &mut System {
        let slot = if mirrored { &mut self.mirrored } else { &mut self.full };
        slot.get_or_insert_with(|| {
            let mut system = System::new(&self.parameters, mirrored);
            system.set_threads(self.threads);
            system
        })
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
        let system = self.system(mirrored);
        let stations = system.stations.len();
        Point {
            inputs,
            mirrored,
            unknowns: system.rest(inputs.penetration_depth),
            active: vec![false; stations],
            contact_forces: vec![0.0; stations],
        }
    }

    /// Newton's method from a guess; and the iterations spent. The last factorisation is near the solution, not at it.
    pub fn settle(&mut self, guess: Point, task: &Task<'_>) -> (Result<Point, String>, usize) {
        let Point { mirrored, mut unknowns, active, inputs, .. } = guess;
        let loaded = task.control == Control::Load;
        let system = self.system(mirrored);
        let depth = if loaded { inputs.penetration_depth } else { task.inputs.penetration_depth };
        let mut balance = Balance {
            system,
            inputs: Inputs { penetration_depth: depth, ..*task.inputs },
            task,
            active,
            residual: Residual::default(),
            border: None,
        };
        if loaded {
            unknowns.push(depth);
        }
        match newton::solve(&mut balance, &mut unknowns, &mut Vec::new(), &task.settings) {
            Err(failure) => (Err(failure.reason), failure.iterations),
            Ok(iterations) => {
                let contact_forces = balance.contact_forces();
                let Balance { inputs, active, system, .. } = balance;
                unknowns.truncate(system.unknowns());
                (Ok(Point { inputs, mirrored, unknowns, active, contact_forces }), iterations)
            }
        }
    }

    /// Factorises the tangent at a solution.
    pub fn factorise(&mut self, point: &Point, rates: Option<&Rates>) -> Result<(), Singular> {
        self.system(point.mirrored).factorise(&point.unknowns, &point.active, &point.inputs, rates)
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
    inputs: Inputs,
    task: &'a Task<'a>,
    active: Vec<bool>,
    residual: Residual,
    border: Option<Border>,
}

/// The column of the depth and the row of the load, where the tangent was formed.
struct Border {
    unknowns: Vec<f64>,
    active: Vec<bool>,
    /// Change of the solution with the depth.
    by_depth: Change,
    /// Rate of change of the load with the depth [N/m^2].
    stiffness: f64,
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
        let (load, given) = (self.system.load(unknowns, &self.contact_forces()), self.inputs.applied_load);
        if load > LOGARITHMIC * given && load < given {
            (given * (load / given).ln(), given / load)
        } else {
            (load - given, 1.0)
        }
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

    fn factorise(&mut self, unknowns: &[f64]) -> Result<(), String> {
        let unknowns = &unknowns[..self.system.unknowns()];
        let rates = self.task.rates;
        self.system.factorise(unknowns, &self.active, &self.inputs, rates).map_err(|e| e.to_string())?;
        if self.loaded() {
            let contact_forces = &self.residual.contact_forces;
            let at = At { unknowns, active: &self.active, contact_forces, inputs: &self.inputs, rates };
            let causes = vec![(Direction::UNIT[0], None)];
            let by_depth = self.system.respond(at, causes).map_err(|e| e.to_string())?.remove(0);
            self.border = Some(Border {
                stiffness: self.system.load(&by_depth.unknowns, &by_depth.contact_forces),
                unknowns: unknowns.to_vec(),
                active: self.active.clone(),
                by_depth,
            });
        }
        Ok(())
    }

    fn solve(&mut self, right_hand_side: &mut [f64]) -> Result<(), String> {
        let n = self.system.unknowns();
        let (update, load) = right_hand_side.split_at_mut(n);
        self.system.solve(update).map_err(|e| e.to_string())?;
        if let (Some(border), [load]) = (&self.border, load) {
            let at = At {
                unknowns: &border.unknowns,
                active: &border.active,
                contact_forces: &self.residual.contact_forces,
                inputs: &self.inputs,
                rates: self.task.rates,
            };
            let most = LONGEST_APPROACH * self.system.thickness();
            let approach = ((self.system.load_along(at, update) - *load) / border.stiffness).clamp(-most, most);
            update.iter_mut().zip(&border.by_depth.unknowns).for_each(|(u, s)| *u -= s * approach);
            *load = -approach;
        }
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
        // A depth counts like a displacement of a thousandth of the thickness.
        let scale = |depth: f64| depth.abs() + 1e-3 * self.system.thickness();
        let approach = unknowns[n..].iter().zip(&update[n..]).map(|(depth, change)| (change / scale(*depth)).abs());
        approach.fold(self.system.relative_size(&unknowns[..n], &update[..n]), f64::max)
    }
}
