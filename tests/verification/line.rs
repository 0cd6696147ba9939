//! A film on a line between rigid or Winkler-like bodies, of the crate's film elements.

use cartilage_contact::equations::film::{Element, Film, MassRate};
use cartilage_contact::fem::assembly::scatter;
use cartilage_contact::fem::element::SIMPSON;
use cartilage_contact::laws::fluid::Fluid;
use cartilage_contact::solver::deadline::Deadline;
use cartilage_contact::solver::linear::{Cluster, FIXED, Multifrontal};
use cartilage_contact::solver::newton::{self, Problem};

/// An incompressible film of this fluid between smooth surfaces that does not cavitate.
pub fn film(fluid: Fluid, pressure_order: i32) -> Film {
    Film { fluid, shear_film_offset: 0.0, fluid_compressibility: 0.0, pressure_order, cavitates: false, rough: None }
}

/// The film: h = gap + compliance * p at every node.
pub struct Line {
    pub film: Film,
    /// x of the nodes \[m\].
    pub stations: Vec<f64>,
    /// Distance of the undeformed surfaces at the nodes \[m\].
    pub gap: Vec<f64>,
    /// Winkler compliance of the bodies together \[m/Pa\].
    pub compliance: f64,
    /// Speeds of the upper and the lower surface \[m/s\].
    pub speeds: [f64; 2],
    /// d(rho h)/dt of every element.
    pub rates: Vec<MassRate>,
    /// Pressure at the nodes \[Pa\]; the two ends keep theirs.
    pub pressure: Vec<f64>,
    cells: Vec<Vec<u32>>,
    linear: Multifrontal,
}

impl Line {
    pub fn new(film: Film, stations: Vec<f64>, gap: impl Fn(f64) -> f64, sliding_speed: f64) -> Self {
        let last = stations.len() - 1;
        let order = film.pressure_order as usize;
        let number = |i: usize| match i {
            0 => FIXED,
            _ if i == last || (order == 1 && i % 2 == 1) => FIXED,
            _ => (if order == 1 { i / 2 - 1 } else { i - 1 }) as u32,
        };
        let cells: Vec<Vec<u32>> = (0..last / 2).map(|e| (0..3).map(|a| number(2 * e + a)).collect()).collect();
        let unknowns = cells.iter().flatten().filter(|n| **n != FIXED).max().map_or(0, |n| *n as usize + 1);
        // Rows are balanced by the film's conductance over an element at its narrowest.
        let gap: Vec<f64> = stations.iter().map(|x| gap(*x)).collect();
        let least = gap.iter().copied().fold(f64::INFINITY, f64::min);
        let scale =
            12.0 * film.fluid.viscosity(0.0.into()).re * (stations[last] - stations[0]) / least.powi(3) / last as f64;
        let ones = vec![1.0; unknowns];
        let linear = Multifrontal::new(&cells, &Cluster::strip(last / 2, 1), vec![scale; unknowns], ones);
        Self {
            film,
            pressure: vec![0.0; stations.len()],
            rates: vec![MassRate::default(); last / 2],
            stations,
            gap,
            compliance: 0.0,
            speeds: [0.5 * sliding_speed; 2],
            cells,
            linear,
        }
    }

    /// Distance of the deformed surfaces at a node.
    pub fn thickness(&self, node: usize) -> f64 {
        self.gap[node] + self.compliance * self.pressure[node]
    }

    /// Solves for the pressure, from the present one.
    pub fn solve(&mut self) {
        let mut unknowns = vec![0.0; self.linear.unknowns()];
        for (number, node) in self.numbered() {
            unknowns[number] = self.pressure[node];
        }
        let settings = newton::Settings {
            tolerance: 1e-11,
            maximum_iterations: 50,
            patience: 0.0,
            most_large: 40,
            deadline: Deadline::default(),
        };
        newton::solve(self, &mut unknowns, &mut Vec::new(), &settings).unwrap();
        self.set(&unknowns);
    }

    /// Load per unit depth \[N/m\], by Simpson's rule.
    pub fn load(&self) -> f64 {
        (0..self.cells.len())
            .map(|e| {
                let length = self.stations[2 * e + 2] - self.stations[2 * e];
                (0..3).map(|a| length * SIMPSON[a] * self.pressure[2 * e + a]).sum::<f64>()
            })
            .sum()
    }

    fn numbered(&self) -> Vec<(usize, usize)> {
        let all = self
            .cells
            .iter()
            .enumerate()
            .flat_map(|(e, cell)| cell.iter().enumerate().map(move |(a, number)| (*number, 2 * e + a)));
        all.filter(|(number, _)| *number != FIXED).map(|(number, node)| (number as usize, node)).collect()
    }

    fn set(&mut self, unknowns: &[f64]) {
        for (number, node) in self.numbered() {
            self.pressure[node] = unknowns[number];
        }
        if self.film.pressure_order == 1 {
            for i in (1..self.pressure.len()).step_by(2) {
                self.pressure[i] = 0.5 * (self.pressure[i - 1] + self.pressure[i + 1]);
            }
        }
    }

    fn terms(&self, element: usize) -> cartilage_contact::equations::film::Terms {
        let at = std::array::from_fn(|i| {
            let node = 2 * element + i % 3;
            match i / 3 {
                0 => self.thickness(node),
                1 => self.pressure[node],
                _ => 0.0,
            }
        });
        let width = self.stations[2 * element + 2] - self.stations[2 * element];
        let column = Element { length: width, width, surfaces: [1.0; 2], deforms: false };
        self.film.element(&column, &at, self.speeds, &self.rates[element])
    }
}

impl Problem for Line {
    fn residual(&mut self, unknowns: &[f64], residual: &mut Vec<f64>) -> Result<bool, String> {
        self.set(unknowns);
        residual.clear();
        residual.resize(unknowns.len(), 0.0);
        for (element, cell) in self.cells.iter().enumerate() {
            scatter(&self.terms(element).residual(), cell, residual);
        }
        Ok(false)
    }

    fn factorise(&mut self, _: &[f64]) -> Result<(), String> {
        let mut linear = std::mem::replace(&mut self.linear, Multifrontal::empty());
        let result = linear.factorise(&self.cells, |element, matrix| {
            let terms = self.terms(element);
            for a in 0..3 {
                for b in 0..3 {
                    matrix[3 * b + a] = terms.tangent[a][3 + b] + self.compliance * terms.tangent[a][b];
                }
            }
        });
        self.linear = linear;
        result.map_err(|e| e.to_string())
    }

    fn solve(&mut self, right_hand_side: &mut [f64]) -> Result<(), String> {
        self.linear.solve(right_hand_side).map_err(|e| e.to_string())
    }

    fn relative_size(&self, unknowns: &[f64], update: &[f64]) -> f64 {
        let largest = |v: &[f64]| v.iter().fold(0.0_f64, |m, v| if v.is_nan() { f64::NAN } else { m.max(v.abs()) });
        largest(update) / largest(unknowns).max(largest(update)).max(f64::MIN_POSITIVE)
    }
}
