//! One poroelastic layer with boundary conditions of one's choice, as a problem for Newton's method: steady, or in steps in time.

use std::array::from_fn;

use cartilage_contact::equations::tissue::{ElementTerms, LOCAL, Local, Tissue, VolumeRate, surface_pressure};
use cartilage_contact::fem::assembly::scatter;
use cartilage_contact::fem::element::{NODES, POINTS};
use cartilage_contact::fem::mesh::LayerMesh;
use cartilage_contact::solver::deadline::Deadline;
use cartilage_contact::solver::linear::{Cluster, FIXED, Multifrontal};
use cartilage_contact::solver::newton::{self, Problem};
use cartilage_contact::solver::runge_kutta;

/// The three fields, in the order of the element's local unknowns.
pub const X: usize = 0;
/// Vertical displacement.
pub const Y: usize = 1;
/// Pressure.
pub const P: usize = 2;

/// What is asked of a field at a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Condition {
    /// Its equation holds.
    Free,
    /// It has the value in [`Strip::prescribed`].
    Fixed,
    /// It is one with the same field of the node (station, level): periodicity, a rigid platen.
    SameAs(usize, usize),
}

/// The layer. Nodes are numbered as in its mesh, station * levels + level.
pub struct Strip {
    pub mesh: LayerMesh,
    pub tissue: Tissue,
    /// Speed of the moving tissue \[m/s\].
    pub speed: f64,
    /// 1 or -1 where the fluid's pressure loads the surface (consistent formulation), as in [`surface_pressure`]; else 0.
    pub loaded_side: f64,
    /// Values of the fixed fields at the nodes.
    pub prescribed: [Vec<f64>; 3],
    /// Nodal forces \[N/m\] and nodal inflows of fluid \[m^2/s\].
    pub sources: [Vec<f64>; 3],
    /// Height below which a rigid body keeps the surface nodes, u_y <= obstacle, without friction; none if empty.
    pub obstacle: Vec<f64>,
    /// Stations that it presses on.
    pub active: Vec<bool>,
    /// dJ/dt of every element.
    pub rates: Vec<VolumeRate>,
    /// Reactions: what the elements add up to at each node, before sources. Forces on the layer, and inflow of fluid.
    pub reactions: [Vec<f64>; 3],
    unknowns: Vec<f64>,
    numbers: [Vec<u32>; 3],
    cells: Vec<Vec<u32>>,
    linear: Multifrontal,
    scales: [f64; 2],
}

impl Strip {
    /// `scales`: a typical displacement \[m\] and a typical pressure \[Pa\]. `condition(field, station, level)`.
    pub fn new(
        mesh: LayerMesh,
        tissue: Tissue,
        scales: [f64; 2],
        condition: impl Fn(usize, usize, usize) -> Condition,
    ) -> Self {
        let (levels, nodes) = (mesh.levels(), mesh.nodes.len());
        let mut numbers: [Vec<u32>; 3] = from_fn(|_| vec![FIXED; nodes]);
        let absent = |f: usize, i: usize, j: usize| f == P && mesh.pressure_order == 1 && (i % 2 == 1 || j % 2 == 1);
        let mut count = 0;
        for node in 0..nodes {
            let (i, j) = (node / levels, node % levels);
            for (f, numbers) in numbers.iter_mut().enumerate() {
                if !absent(f, i, j) && condition(f, i, j) == Condition::Free {
                    numbers[node] = count;
                    count += 1;
                }
            }
        }
        for node in 0..nodes {
            let (i, j) = (node / levels, node % levels);
            for (f, numbers) in numbers.iter_mut().enumerate() {
                if let (false, Condition::SameAs(i, j)) = (absent(f, i, j), condition(f, i, j)) {
                    numbers[node] = numbers[i * levels + j];
                }
            }
        }
        let cells: Vec<Vec<u32>> = (0..mesh.elements())
            .map(|e| numbers.iter().flat_map(|numbers| mesh.element_nodes(e).map(|n| numbers[n])).collect())
            .collect();
        let modulus = modulus(&tissue);
        let (mut rows, mut columns) = (vec![0.0; count as usize], vec![0.0; count as usize]);
        for (f, numbers) in numbers.iter().enumerate() {
            for n in numbers.iter().filter(|n| **n != FIXED) {
                columns[*n as usize] = scales[f / 2];
                rows[*n as usize] =
                    if f == P { 1.0 / (tissue.mobility * scales[1]) } else { 1.0 / (modulus * scales[0]) };
            }
        }
        let linear = Multifrontal::new(&cells, &Cluster::strip(mesh.columns, mesh.rows), rows, columns);
        let zeros = || from_fn(|_| vec![0.0; nodes]);
        Self {
            rates: vec![VolumeRate::default(); mesh.elements()],
            mesh,
            tissue,
            speed: 0.0,
            loaded_side: 0.0,
            prescribed: zeros(),
            obstacle: Vec::new(),
            active: Vec::new(),
            sources: zeros(),
            reactions: zeros(),
            unknowns: vec![0.0; count as usize],
            numbers,
            cells,
            linear,
            scales,
        }
    }

    fn modulus(&self) -> f64 {
        modulus(&self.tissue)
    }

    /// Node at a station and level.
    pub fn node(&self, station: usize, level: usize) -> usize {
        station * self.mesh.levels() + level
    }

    /// Value of a field at a node.
    pub fn value(&self, field: usize, node: usize) -> f64 {
        self.at(&self.unknowns, field, node)
    }

    /// Gives a field at a node a value to start from.
    pub fn start_from(&mut self, field: usize, node: usize, value: f64) {
        let number = self.numbers[field][node];
        if number != FIXED {
            self.unknowns[number as usize] = value;
        }
    }

    fn at(&self, unknowns: &[f64], field: usize, node: usize) -> f64 {
        let number = self.numbers[field][node];
        if number == FIXED { self.prescribed[field][node] } else { unknowns[number as usize] }
    }

    /// Values at the nodes of an element.
    pub fn local(&self, element: usize, unknowns: &[f64]) -> Local {
        let nodes = self.mesh.element_nodes(element);
        from_fn(|i| self.at(unknowns, i / NODES, nodes[i % NODES]))
    }

    /// Values at the nodes of an element of the present solution.
    pub fn solution(&self, element: usize) -> Local {
        self.local(element, &self.unknowns)
    }

    /// Solves from the present values. Returns the number of Newton iterations.
    pub fn solve(&mut self) -> usize {
        let mut unknowns = self.unknowns.clone();
        let settings = newton::Settings {
            tolerance: 1e-10,
            maximum_iterations: 30,
            patience: 0.0,
            most_large: 40,
            deadline: Deadline::default(),
        };
        let solution = newton::solve(self, &mut unknowns, &mut Vec::new(), &settings).unwrap();
        self.unknowns = unknowns;
        solution.iterations
    }

    /// Change of volume (J - 1) dA at the quadrature points of every element.
    fn volume_changes(&self) -> Vec<[f64; POINTS]> {
        let change =
            |e, q| Tissue::strain(&self.mesh, e, q, &self.solution(e)).volume_change * self.mesh.points(e)[q].weight;
        (0..self.mesh.elements()).map(|e| from_fn(|q| change(e, q))).collect()
    }

    /// One time step of the crate's Runge-Kutta method; `drive(strip, time)` sets what is prescribed at a time.
    pub fn step(&mut self, time: f64, dt: f64, drive: impl Fn(&mut Self, f64)) {
        let before = self.volume_changes();
        let mut first: Vec<[f64; POINTS]> = vec![[0.0; POINTS]; before.len()];
        for stage in runge_kutta::stages(dt) {
            drive(self, time + stage.time);
            for ((rates, before), first) in self.rates.iter_mut().zip(&before).zip(&first) {
                let history = from_fn(|q| stage.before * before[q] + stage.first * first[q]);
                *rates = VolumeRate { rate: stage.present, history };
            }
            self.solve();
            for ((first, now), rates) in first.iter_mut().zip(self.volume_changes()).zip(&self.rates) {
                *first = from_fn(|q| rates.rate * now[q] + rates.history[q]);
            }
        }
    }

    fn terms(&self, element: usize, at: &Local, mut terms: ElementTerms<'_>) -> Result<(), String> {
        if self.loaded_side != 0.0 && element.is_multiple_of(self.mesh.rows) {
            let ElementTerms { residual, tangent, .. } = &mut terms;
            let (residual, tangent) = (residual.as_deref_mut(), tangent.as_deref_mut());
            let surface = ElementTerms { residual, by_speed: None, tangent };
            surface_pressure(&self.mesh, element, self.loaded_side, at, surface);
        }
        let rate = &self.rates[element];
        self.tissue.element(&self.mesh, element, at, [self.speed; 2], rate, terms).map_err(|e| e.to_string())
    }
}

impl Problem for Strip {
    fn residual(&mut self, unknowns: &[f64], residual: &mut Vec<f64>) -> Result<bool, String> {
        self.reactions.iter_mut().for_each(|r| r.fill(0.0));
        for element in 0..self.mesh.elements() {
            let mut local = [0.0; LOCAL];
            let at = self.local(element, unknowns);
            self.terms(element, &at, ElementTerms { residual: Some(&mut local), by_speed: None, tangent: None })?;
            let nodes = self.mesh.element_nodes(element).map(|node| node as u32);
            for (local, reactions) in local.chunks_exact(NODES).zip(&mut self.reactions) {
                scatter(local, &nodes, reactions);
            }
        }
        residual.clear();
        residual.resize(unknowns.len(), 0.0);
        for f in 0..3 {
            let balances: Vec<f64> = self.reactions[f].iter().zip(&self.sources[f]).map(|(r, s)| r - s).collect();
            scatter(&balances, &self.numbers[f], residual);
        }
        let modulus = self.modulus();
        let mut changed = false;
        self.active.resize(self.obstacle.len(), false);
        for (i, obstacle) in self.obstacle.iter().enumerate() {
            let number = self.numbers[Y][self.node(i, 0)] as usize;
            let pressing = if self.active[i] { -residual[number] } else { 0.0 };
            let now = pressing - modulus * (obstacle - unknowns[number]) > 0.0;
            changed |= now != self.active[i];
            self.active[i] = now;
            if now {
                residual[number] = modulus * (unknowns[number] - obstacle);
            }
        }
        Ok(changed)
    }

    fn factorise(&mut self, unknowns: &[f64]) -> Result<(), String> {
        let mut linear = std::mem::replace(&mut self.linear, Multifrontal::empty());
        let result = linear.factorise(&self.cells, |element, matrix| {
            let mut tangent = [0.0; LOCAL * LOCAL];
            let terms = ElementTerms { residual: None, by_speed: None, tangent: Some(&mut tangent) };
            self.terms(element, &self.local(element, unknowns), terms).unwrap();
            matrix.copy_from_slice(&tangent);
            if !self.active.is_empty() && element.is_multiple_of(self.mesh.rows) {
                let first = 2 * (element / self.mesh.rows);
                for a in (0..3).filter(|a| self.active[first + a]) {
                    let row = NODES + a;
                    (0..LOCAL).for_each(|j| matrix[j * LOCAL + row] = 0.0);
                    // A node between two elements gets half from each.
                    let end = first + a == 0 || first + a == 2 * self.mesh.columns;
                    matrix[row * LOCAL + row] = self.modulus() * if a == 1 || end { 1.0 } else { 0.5 };
                }
            }
        });
        self.linear = linear;
        result.map_err(|e| e.to_string())
    }

    fn solve(&mut self, right_hand_side: &mut [f64]) -> Result<(), String> {
        self.linear.solve(right_hand_side).map_err(|e| e.to_string())
    }

    fn relative_size(&self, _: &[f64], update: &[f64]) -> f64 {
        let mut size = 0.0_f64;
        for (f, numbers) in self.numbers.iter().enumerate() {
            for number in numbers.iter().filter(|n| **n != FIXED) {
                let change = update[*number as usize].abs() / self.scales[f / 2];
                size = if change.is_nan() { f64::NAN } else { size.max(change) };
            }
        }
        size
    }
}

/// Modulus of uniaxial strain.
fn modulus(tissue: &Tissue) -> f64 {
    tissue.solid.aggregate_modulus()
}

/// A flat layer of this length and thickness whose surface is y = 0, below it (a lower body) and moving along x.
pub fn flat(lengths: &[f64], depths: &[f64], pressure_order: i32) -> LayerMesh {
    let elements = [lengths.len() / 2, depths.len() / 2];
    LayerMesh::new(elements, pressure_order, |i, j| [lengths[i], -depths[j]], |_| [1.0, 0.0])
}

/// `count` equal quadratic elements from 0 to `length`.
pub fn uniform(length: f64, count: usize) -> Vec<f64> {
    cartilage_contact::fem::mesh::quadratic_stations(count, |i| length * i as f64 / count as f64)
}

/// Observed orders of a sequence of errors under halving.
pub fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect()
}
