//! Two bodies as the crate's own discrete system, with its unknowns in reach.

use cartilage_contact::equations::inflow;
use cartilage_contact::equations::system::{Change, Solved, State, System, Task};
use cartilage_contact::equations::tissue::{ElementTerms, LOCAL, VolumeRate};
use cartilage_contact::fem::assembly::scatter;
use cartilage_contact::fem::element::{GAUSS, GAUSS_WEIGHTS, NODES, quadratic, quadratic_derivative};
use cartilage_contact::parameters::{Control, Formulation, Inputs, Parameters};
use cartilage_contact::solver::deadline::Deadline;
use cartilage_contact::solver::linear::FIXED;
use cartilage_contact::solver::newton;

pub struct Pair {
    pub system: System,
    pub state: State,
}

/// What an element of the interface has at one of its quadrature points.
pub struct InterfacePoint {
    /// Quadrature weight, of the film between the deformed surfaces in the consistent formulation \[m\].
    pub weight: f64,
    /// By what factor the film is longer there than undeformed; 1 in the paper's formulation.
    pub stretch: f64,
    /// x, film thickness and its slope, pressure and its slope.
    pub x: f64,
    pub film_thickness: f64,
    pub film_slope: f64,
    pub pressure: f64,
    pub pressure_gradient: f64,
}

/// The film beyond an end of the sector, where the undeformed surfaces run on as a parabola (consistent formulation).
pub struct Beyond {
    /// Pressure at the end.
    pub pressure: f64,
    /// Fluid that leaves the sector there: by Reynolds' equation out to p = 0 at infinity.
    pub outflow: f64,
    /// int h p' dx beyond the end, and int dx/h.
    pub shear: [f64; 2],
}

impl Pair {
    /// The film beyond both ends; none in the paper's formulation. By the midpoint rule over t = s/(l + s).
    pub fn beyond(&self, parameters: &Parameters) -> Vec<Beyond> {
        if parameters.formulation == Formulation::Paper {
            return Vec::new();
        }
        let (x, last) = (self.system.half_width(), self.system.stations.len() - 1);
        let radii = [parameters.upper.outer_radius, parameters.lower.outer_radius];
        let slope: f64 = radii.iter().map(|r| x / (r * r - x * x).sqrt()).sum();
        let curvature: f64 = radii.iter().map(|r| 1.0 / r).sum();
        let (eta, speed) = (parameters.viscosity, self.state.inputs.sliding_speed);
        let ends = [(0, -1.0), (last, 1.0)].into_iter().map(|(station, side)| {
            let gap = self.state.unknowns[self.system.layout.gap[station] as usize];
            let pressure = self.pressure(0, station * self.levels());
            let (length, n) = (gap / slope, 20_000);
            let mut integrals = [0.0; 3];
            for i in 0..n {
                let t = (f64::from(i) + 0.5) / f64::from(n);
                let s = length * t / (1.0 - t);
                let weight = length / (1.0 - t).powi(2) / f64::from(n);
                let h = gap + slope * s + 0.5 * curvature * s * s;
                (0..3).for_each(|k| integrals[k] += weight / h.powi(k as i32 + 1));
            }
            let [one, two, three] = integrals;
            // p' = 12 eta (U h/2 - Q)/h^3 from the end's pressure to none.
            let flux = (0.5 * speed * two + side * pressure / (12.0 * eta)) / three;
            let shear = [12.0 * eta * (0.5 * speed * one - flux * two), one];
            Beyond { pressure, outflow: side * flux, shear }
        });
        ends.collect()
    }

    pub fn new(parameters: &Parameters, mirrored: bool) -> Self {
        let system = System::new(parameters, mirrored, 0.0);
        let state = system.rest(Inputs::default());
        Self { system, state }
    }

    /// Rest at this depth, so that the first step need not move the bones.
    pub fn rest_at(&mut self, penetration_depth: f64) {
        self.state = self.system.rest(Inputs { penetration_depth, ..self.state.inputs });
    }

    /// Solves for these inputs from the present state.
    pub fn go(&mut self, inputs: Inputs) {
        let settings = newton::Settings {
            tolerance: 1e-10,
            maximum_iterations: 40,
            patience: 0.0,
            most_large: 40,
            deadline: Deadline::default(),
        };
        let task = Task { control: Control::Depth, settings, distance_counts: true, reusable: None };
        let guess = self.state.clone().guess_for(&inputs, Control::Depth);
        let (result, _) = self.system.settle(guess, &task);
        self.state = result.unwrap_or_else(|reason| panic!("{inputs}: {reason}"));
    }

    /// What is reported of it.
    pub fn solved(&self) -> Solved<'_> {
        Solved { system: &self.system, state: &self.state }
    }

    /// No change at all.
    pub fn no_change(&self) -> Change {
        Change::none(self.state.unknowns.len(), self.state.active.len())
    }

    /// Nodes through the thickness.
    pub fn levels(&self) -> usize {
        self.system.layers[0].mesh.levels()
    }

    /// Pressure at a node of a body.
    pub fn pressure(&self, body: usize, node: usize) -> f64 {
        match self.system.layout.pressure[body][node] {
            FIXED => 0.0,
            number => self.state.unknowns[number as usize],
        }
    }

    /// Displacement of a node of a body.
    pub fn displacement(&self, body: usize, node: usize) -> [f64; 2] {
        let mesh = &self.system.layers[body].mesh;
        let element =
            (node / mesh.levels()).saturating_sub(1) / 2 * mesh.rows + (node % mesh.levels()).saturating_sub(1) / 2;
        let at = self.system.local(body, element, &self.state.unknowns, self.state.inputs.penetration_depth);
        let a = mesh.element_nodes(element).iter().position(|n| *n == node).unwrap();
        [at[a], at[NODES + a]]
    }

    /// Speeds of both deformed surfaces over a column of a steady state: theirs times what their nodes moved apart to.
    pub fn surface_speeds(&self, column: usize) -> [f64; 2] {
        let ends = [2 * column, 2 * column + 2].map(|station| station * self.levels());
        let speeds = self.state.inputs.surface_speeds();
        std::array::from_fn(|body| {
            let [left, right] = ends.map(|node| self.system.layers[body].mesh.nodes[node][0]);
            let [more, most] = ends.map(|node| self.displacement(body, node)[0]);
            speeds[body] * (right + most - left - more) / (right - left)
        })
    }

    /// Boundary friction of smooth surfaces, from the contact forces and from how fast the surfaces slide on each other \[N/m\].
    pub fn boundary_friction(&self, parameters: &Parameters) -> f64 {
        let stations = &self.system.stations;
        let friction = |column: usize| {
            let [upper, lower] = self.surface_speeds(column);
            let mobilised = match parameters.formulation {
                Formulation::Paper => 1.0,
                Formulation::Consistent => {
                    (upper - lower) / (upper - lower).hypot(parameters.friction_regularisation_speed)
                }
            };
            parameters.boundary_friction_coefficient * mobilised
        };
        // Simpson's weights say how much of a node's force is on either side.
        let length = |column: usize| stations[2 * column + 2] - stations[2 * column];
        let of_node = |node: usize| match (node % 2, node / 2) {
            (1, column) => friction(column),
            (_, column) => {
                let sides = [column - 1, column];
                let sum: f64 = sides.iter().map(|column| length(*column) * friction(*column)).sum();
                sum / (length(column - 1) + length(column))
            }
        };
        let forces = self.state.contact_forces.iter().enumerate().filter(|(_, force)| **force != 0.0);
        forces.map(|(node, force)| force * of_node(node)).sum()
    }

    /// What the tissue's elements add up to at the nodes of a body, without film and contact: forces on the tissue along x and y,
    /// and fluid that flows in; with what the tissue carries out of the ends.
    pub fn reactions(&self, body: usize, speed: f64) -> [Vec<f64>; 3] {
        let layer = &self.system.layers[body];
        let mut reactions = [0; 3].map(|_| vec![0.0; layer.mesh.nodes.len()]);
        for element in 0..layer.mesh.elements() {
            let at = self.system.local(body, element, &self.state.unknowns, self.state.inputs.penetration_depth);
            let mut local = [0.0; LOCAL];
            let terms = ElementTerms { residual: Some(&mut local), by_speed: None, tangent: None };
            layer.tissue.element(&layer.mesh, element, &at, [speed; 2], &VolumeRate::default(), terms).unwrap();
            if layer.tissue.consistent {
                let terms = ElementTerms { residual: Some(&mut local), by_speed: None, tangent: None };
                inflow::ends(&layer.tissue, &layer.mesh, element, &at, [speed; 2], terms);
            }
            let nodes = layer.mesh.element_nodes(element).map(|node| node as u32);
            for (local, reactions) in local.chunks_exact(NODES).zip(&mut reactions) {
                scatter(local, &nodes, reactions);
            }
        }
        reactions
    }

    /// What the tissue of a body carries out of the sector: int alpha (J - 1) U v . n over the end where it leaves, J by the
    /// determinant of the deformed place.
    pub fn carried_out(&self, body: usize, speed: f64) -> f64 {
        let layer = &self.system.layers[body];
        let mut carried = 0.0;
        for element in 0..layer.mesh.elements() {
            let at = self.system.local(body, element, &self.state.unknowns, self.state.inputs.penetration_depth);
            for point in layer.mesh.end_points(element).filter(|point| point.outflow * speed > 0.0) {
                let [gx, gy] = &point.gradients;
                let slope = |g: &[f64; NODES], first: usize| -> f64 { (0..NODES).map(|a| g[a] * at[first + a]).sum() };
                let volume_ratio = (1.0 + slope(gx, 0)) * (1.0 + slope(gy, NODES)) - slope(gy, 0) * slope(gx, NODES);
                carried += layer.tissue.biot_coefficient * (volume_ratio - 1.0) * speed * point.outflow;
            }
        }
        carried
    }

    /// The quadrature points of the interface (pressure of order 2).
    pub fn interface_points(&self) -> Vec<InterfacePoint> {
        let x = &self.system.stations;
        let levels = self.levels();
        let mut places = Vec::new();
        for column in 0..x.len() / 2 {
            let nodes = [2 * column, 2 * column + 1, 2 * column + 2];
            let half = 0.5 * (x[nodes[2]] - x[nodes[0]]);
            let gaps = nodes.map(|i| self.state.unknowns[self.system.layout.gap[i] as usize]);
            let pressures = nodes.map(|i| self.pressure(0, i * levels));
            let bodies = self.system.layers.len();
            let mean =
                |i: usize| (0..bodies).map(|body| self.displacement(body, i * levels)[0]).sum::<f64>() / bodies as f64;
            let deforms = if self.system.layers[0].tissue.consistent { 1.0 } else { 0.0 };
            let sideways = nodes.map(|i| deforms * mean(i));
            for (s, w) in GAUSS.into_iter().zip(GAUSS_WEIGHTS) {
                let sum = |f: [f64; 3], v: [f64; 3]| f[0] * v[0] + f[1] * v[1] + f[2] * v[2];
                let stretch = 1.0 + sum(quadratic_derivative(s), sideways) / half;
                let half = half * stretch;
                places.push(InterfacePoint {
                    weight: half * w,
                    stretch,
                    x: sum(quadratic(s), nodes.map(|i| x[i])),
                    film_thickness: sum(quadratic(s), gaps),
                    film_slope: sum(quadratic_derivative(s), gaps) / half,
                    pressure: sum(quadratic(s), pressures),
                    pressure_gradient: sum(quadratic_derivative(s), pressures) / half,
                });
            }
        }
        places
    }
}
