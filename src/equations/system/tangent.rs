//! The tangent, and what follows from it: updates, and derivatives with respect to the inputs.

use super::{Rates, State, StoredVolumes, System, moves};
use crate::equations::contact::{ContactTangent, ContactTerms};
use crate::equations::film;
use crate::equations::surface::RISE;
use crate::equations::tissue::{ElementTerms, LOCAL, Local};
use crate::fem::element::NODES;
use crate::parameters::Inputs;
use crate::solver::deadline::Deadline;
use crate::solver::linear::{FIXED, Multifrontal, Singular};

/// A change of the inputs.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Direction {
    /// Of the penetration depth \[m\].
    pub penetration_depth: f64,
    /// Of the sliding speed \[m/s\].
    pub sliding_speed: f64,
    /// Of the slide-to-roll ratio \[1\].
    pub slide_to_roll_ratio: f64,
}

impl Direction {
    /// Unit changes of penetration depth, sliding speed and slide-to-roll ratio.
    pub const UNIT: [Self; 3] = {
        let none = Self { penetration_depth: 0.0, sliding_speed: 0.0, slide_to_roll_ratio: 0.0 };
        [
            Self { penetration_depth: 1.0, ..none },
            Self { sliding_speed: 1.0, ..none },
            Self { slide_to_roll_ratio: 1.0, ..none },
        ]
    };

    /// Changes of the two surface speeds \[m/s\].
    pub fn surface_speeds(&self, inputs: &Inputs) -> [f64; 2] {
        let s = inputs.slide_to_roll_ratio;
        let half = 0.5 * inputs.sliding_speed * self.slide_to_roll_ratio;
        [0.5 * (1.0 + s) * self.sliding_speed + half, 0.5 * (1.0 - s) * self.sliding_speed - half]
    }
}

/// What changes a solution.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Perturbation {
    /// Of the inputs.
    pub direction: Direction,
    /// Of the history terms of [`Rates`]; none where there is no change.
    pub history: Option<StoredVolumes>,
    /// Of the residual itself, beside that; empty for none.
    pub residual: Vec<f64>,
}

/// A small change of a solution with its perturbations.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Of the unknowns.
    pub unknowns: Vec<f64>,
    /// Of the inputs.
    pub inputs: Direction,
    /// Of the history terms of [`Rates`]; none where there is no change.
    pub history: Option<StoredVolumes>,
    /// Of the contact forces \[N/m\].
    pub contact_forces: Vec<f64>,
}

impl Change {
    /// No change of a solution with so many unknowns and stations.
    pub fn none(unknowns: usize, stations: usize) -> Self {
        Self {
            unknowns: vec![0.0; unknowns],
            inputs: Direction::default(),
            history: None,
            contact_forces: vec![0.0; stations],
        }
    }

    /// Whether there is no change.
    pub fn is_none(&self) -> bool {
        let zero = |values: &[f64]| values.iter().all(|value| *value == 0.0);
        self.inputs == Direction::default()
            && self.history.is_none()
            && zero(&self.unknowns)
            && zero(&self.contact_forces)
    }
}

impl System {
    /// Factorises on up to this many threads; a single one unless told otherwise. The results are the same bits.
    pub fn set_threads(&mut self, threads: usize) {
        self.linear.set_threads(threads);
    }

    /// When a factorisation is given up.
    pub fn set_deadline(&mut self, deadline: Deadline) {
        self.linear.set_deadline(deadline);
    }

    /// Factorises the tangent at a state.
    ///
    /// # Errors
    /// [`Singular`] where elimination breaks down.
    pub fn factorise_at(&mut self, state: &State) -> Result<(), Singular> {
        let Self { linear, .. } = self;
        // The factorisation is taken out while the rest of the system fills it.
        let mut linear = std::mem::replace(linear, Multifrontal::empty());
        let result = linear.factorise(&self.layout.cells, |cell, matrix| self.cell_tangent(cell, state, matrix));
        self.linear = linear;
        result
    }

    /// Solves with the last factorisation, in place, for any number of right-hand sides. Where that lost digits, the solution is refined
    /// with the tangent itself, as long as the mesh is still the one that it was formed on.
    ///
    /// # Errors
    /// [`Singular`] where the answer is not finite, or wrong.
    pub fn solve(&self, right_hand_sides: &mut [f64]) -> Result<(), Singular> {
        let here = (self.contact_half_width, &self.shifts, self.thickening);
        match self.linearization().filter(|state| (state.contact_half_width, &state.shifts, state.thickening) == here) {
            Some(state) => self.linear.solve_refined(right_hand_sides, &self.layout.cells, |cell, matrix| {
                self.cell_tangent(cell, state, matrix);
            }),
            None => self.linear.solve(right_hand_sides),
        }
    }

    /// Tangent over an element's nodal values, before contact and the film.
    fn element_tangent(
        &self,
        body: usize,
        element: usize,
        at: &Local,
        inputs: &Inputs,
        rates: Option<&Rates>,
    ) -> [f64; LOCAL * LOCAL] {
        let mut tangent = [0.0; LOCAL * LOCAL];
        let terms = ElementTerms { tangent: Some(&mut tangent), ..ElementTerms::default() };
        // An inverted element was refused when the residual was formed.
        if self.add_tissue(body, element, at, inputs, rates, terms).is_err() {
            tangent.fill(f64::NAN);
        }
        tangent
    }

    /// Derivative of an element's residual with respect to the speed of its surface.
    fn element_by_speed(
        &self,
        body: usize,
        element: usize,
        at: &Local,
        inputs: &Inputs,
        rates: Option<&Rates>,
    ) -> Local {
        let mut by_speed = [0.0; LOCAL];
        let terms = ElementTerms { by_speed: Some(&mut by_speed), ..ElementTerms::default() };
        if self.add_tissue(body, element, at, inputs, rates, terms).is_err() {
            by_speed.fill(f64::NAN);
        }
        by_speed
    }

    /// Matrix of a cell over its unknowns: tissue, film, and contact by rows and columns.
    fn cell_tangent(&self, cell: usize, state: &State, matrix: &mut [f64]) {
        let State { unknowns, active, inputs, .. } = state;
        let rates = state.rates.as_ref();
        let (body, element) = self.layout.body_and_element(cell);
        let layer = &self.layers[body];
        let at = self.local(body, element, unknowns, inputs.penetration_depth);
        let mut tangent = self.element_tangent(body, element, &at, inputs, rates);
        let on_surface = element.is_multiple_of(layer.mesh.rows);
        let column = element / layer.mesh.rows;
        let (mut by_gap, mut by_other) = ([[0.0; LOCAL]; 3], [[0.0; LOCAL]; 3]);
        if on_surface {
            let terms = ContactTangent { by_unknowns: &mut tangent, by_gap: &mut by_gap, by_other: &mut by_other };
            let terms = ContactTerms { tangent: Some(terms), ..ContactTerms::default() };
            let contact = self.contact(self.rubbing_on_tissue(column, state));
            contact.element(&layer.mesh, element, layer.side, &at, self.gaps(element, unknowns), terms);
        }
        let m = self.layout.cells[cell].len();
        for (column, values) in tangent.chunks_exact(LOCAL).enumerate() {
            matrix[column * m..column * m + LOCAL].copy_from_slice(values);
        }
        if !on_surface {
            return;
        }
        let two_bodies = self.layers.len() == 2;
        let surface = self.surface(body, column);
        surface.transform_columns(matrix, m);
        let others = if two_bodies { Some(LOCAL + 3) } else { None };
        for (first, by) in [(Some(NODES), by_gap), (others, by_other)] {
            for (place, values) in first.into_iter().flat_map(|first| first..first + 3).zip(&by) {
                let column = &mut matrix[place * m..][..LOCAL];
                column.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
            }
        }
        // Rows, then friction and the condition of contact.
        let friction: [f64; 3] = std::array::from_fn(|a| match active[2 * column + a] {
            true => self.station_friction(2 * column + a, state),
            false => 0.0,
        });
        for j in 0..m {
            let values = &mut matrix[j * m..(j + 1) * m];
            surface.transform_rows(values);
            for a in (0..3).filter(|a| active[2 * column + a]) {
                let force = layer.side * friction[a] * self.cosine[2 * column + a] * values[NODES + a];
                values[a] += force;
                if two_bodies {
                    values[LOCAL + 3 + a] -= force;
                }
                values[NODES + a] = if j == NODES + a { self.contact_law().condition(0.0).1 } else { 0.0 };
            }
        }
        if body == 0 {
            let terms = self.film_terms(column, state);
            // Where the values of the film stand in the cell; the counterface's stay where they are, and the mirror image's are the upper ones.
            let lower = if two_bodies { Some(LOCAL + 3) } else { self.mirrored().then_some(0) };
            let drag_places = if two_bodies { [0, LOCAL + 3, LOCAL] } else { [0; 3] };
            let places = [Some(NODES), Some(2 * NODES), self.film.cavitates.then(|| m - 3), Some(0), lower];
            for (group, first) in places.into_iter().enumerate() {
                for (b, place) in first.into_iter().flat_map(|first| first..first + 3).enumerate() {
                    for a in 0..3 {
                        let row = |row: usize| terms.tangent[row][3 * group + b];
                        matrix[place * m + 2 * NODES + a] += row(a) / self.copies();
                        let drag = row(film::DRAG.start + a);
                        for ((_, part), first) in self.drag_on(2 * column + a).zip(drag_places) {
                            matrix[place * m + first + a] += part * drag;
                        }
                    }
                }
            }
            for station in (2 * column..=2 * column + 2).filter(|station| active[*station]) {
                let rubbing = self.rubbing_on_tissue(column, state);
                let (a, force) = (station - 2 * column, self.part_of(station, column) * state.contact_forces[station]);
                for (k, first) in [Some(0), others].into_iter().enumerate() {
                    for (b, place) in first.into_iter().flat_map(|first| first..first + 3).enumerate() {
                        let change = force * rubbing.by_walls[k] * rubbing.by_sideways[k][b];
                        matrix[place * m + a] += change;
                        if let Some(lower) = others {
                            matrix[place * m + lower + a] -= change;
                        }
                    }
                }
            }
            if let Some(facing) = self.facing(column) {
                let terms = facing.terms(&self.facing_local(column, unknowns));
                let place = |group: usize| [0, LOCAL + 3, LOCAL, RISE, 2 * NODES, NODES][group];
                for (unknown, values) in terms.tangent.iter().enumerate() {
                    let column = &mut matrix[(place(unknown / 3) + unknown % 3) * m..][..m];
                    for a in 0..3 {
                        column[LOCAL + a] += values[a];
                        column[RISE + a] += values[3 + a];
                    }
                }
            }
            let stations = 2 * column..=2 * column + 2;
            for (station, outflow) in self.film_outflows(unknowns, inputs, rates).filter(|(i, _)| stations.contains(i))
            {
                let a = station - 2 * column;
                matrix[(NODES + a) * m + 2 * NODES + a] += outflow.by_gap / self.copies();
                matrix[(2 * NODES + a) * m + 2 * NODES + a] += outflow.by_pressure / self.copies();
            }
        }
        for a in (0..3).filter(|a| self.layout.void[2 * column + a] != FIXED) {
            let row = m - 3 + a;
            match self.is_cavitated(2 * column + a, unknowns, moves(inputs, rates)) {
                true => matrix[(2 * NODES + a) * m + row] = 1.0,
                false => matrix[row * m + row] = self.contact_stiffness,
            }
        }
    }

    /// How a solution changes with its inputs and its history, from the last factorisation, which has to be that at the solution;
    /// one answer for each perturbation.
    ///
    /// # Errors
    /// [`Singular`] where the answer is not finite.
    pub fn sensitivities(&self, at: &State, perturbations: Vec<Perturbation>) -> Result<Vec<Change>, Singular> {
        let n = self.unknowns();
        let mut columns = vec![0.0; perturbations.len() * n];
        for (perturbation, values) in perturbations.iter().zip(columns.chunks_exact_mut(n)) {
            let mut direction = perturbation.direction;
            if self.mirrored() {
                // Exchanging the bodies reverses the slide-to-roll ratio: what is mirror-symmetric does not change with it.
                direction.slide_to_roll_ratio = 0.0;
            }
            self.add_by_inputs(at, &direction, values);
            values.iter_mut().zip(&perturbation.residual).for_each(|(value, change)| *value += change);
            if let Some(history) = &perturbation.history {
                self.add_storage(at, history, values);
            }
            for i in (0..at.active.len()).filter(|i| at.active[*i]) {
                let gap = self.layout.gap[i] as usize;
                let change = self.station_friction(i, at) * self.copies() * self.cosine[i] * values[gap];
                self.add_friction(i, change, values);
                values[gap] = 0.0;
            }
            values.iter_mut().for_each(|v| *v = -*v);
        }
        self.solve(&mut columns)?;
        let changes = perturbations.into_iter().zip(columns.chunks_exact(n)).map(|(perturbation, unknowns)| Change {
            contact_forces: self.contact_force_change(at, unknowns, perturbation.direction.penetration_depth),
            unknowns: unknowns.to_vec(),
            inputs: perturbation.direction,
            history: perturbation.history,
        });
        Ok(changes.collect())
    }

    /// Change of the contact forces along a change of unknowns and penetration depth \[N/m\].
    fn contact_force_change(&self, at: &State, change: &[f64], penetration_depth: f64) -> Vec<f64> {
        let mut values = vec![0.0; self.unknowns()];
        for (body, layer) in self.layers.iter().enumerate() {
            for column in 0..layer.mesh.columns {
                if !at.active[2 * column..=2 * column + 2].contains(&true) {
                    continue;
                }
                let element = column * layer.mesh.rows;
                let local_at = self.local(body, element, &at.unknowns, at.inputs.penetration_depth);
                let local_change = self.local_change(body, element, change, penetration_depth);
                let mut local = [0.0; LOCAL];
                add_product(
                    &self.element_tangent(body, element, &local_at, &at.inputs, None),
                    &local_change,
                    &mut local,
                );
                self.scatter(body, element, &local, &mut values);
            }
        }
        let force = |i: usize| self.copies() * self.cosine[i] * values[self.layout.gap[i] as usize];
        (0..at.active.len()).map(|i| if at.active[i] { force(i) } else { 0.0 }).collect()
    }

    /// Change of the load per unit depth along a change of the unknowns alone \[N/m\].
    pub fn load_along(&self, at: &State, change: &[f64]) -> f64 {
        let change = Change {
            contact_forces: self.contact_force_change(at, change, 0.0),
            unknowns: change.to_vec(),
            inputs: Direction::default(),
            history: None,
        };
        self.loads(at, &change).total().eps
    }

    /// Load per unit depth \[N/m\].
    pub fn load(&self, at: &State) -> f64 {
        self.loads(at, &Change::none(self.unknowns(), self.stations.len())).total().re
    }

    /// Adds the derivative of the residual before contact along a change of the inputs.
    fn add_by_inputs(&self, at: &State, direction: &Direction, values: &mut [f64]) {
        let (unknowns, inputs, rates) = (&at.unknowns, &at.inputs, at.rates.as_ref());
        let speeds = direction.surface_speeds(inputs);
        let none = vec![0.0; self.unknowns()];
        self.add_friction_change(
            at,
            |_, rubbing| rubbing.friction_along(&[0.0; film::LOCAL], speeds, [0.0; 2]),
            values,
        );
        for (body, layer) in self.layers.iter().enumerate() {
            for element in 0..layer.mesh.elements() {
                // Only the row at the bone feels the depth; all rows feel the speed.
                let at_bone = element % layer.mesh.rows + 1 == layer.mesh.rows && direction.penetration_depth != 0.0;
                if !at_bone && speeds[body] == 0.0 {
                    continue;
                }
                let local_at = self.local(body, element, unknowns, inputs.penetration_depth);
                let mut local =
                    self.element_by_speed(body, element, &local_at, inputs, rates).map(|v| v * speeds[body]);
                if at_bone {
                    let change = self.local_change(body, element, &none, direction.penetration_depth);
                    add_product(&self.element_tangent(body, element, &local_at, inputs, rates), &change, &mut local);
                }
                self.scatter(body, element, &local, values);
            }
        }
        let levels = self.layers[0].mesh.levels();
        for (station, outflow) in self.film_outflows(unknowns, inputs, rates) {
            let number = self.layout.pressure[0][station * levels] as usize;
            values[number] += along(outflow.by_speeds, speeds) / self.copies();
        }
        for column in 0..self.layers[0].mesh.columns {
            let terms = self.film_terms(column, at);
            let faster = |row: usize| along(terms.by_speeds.map(|by| by[row]), speeds);
            self.scatter_film(column, [0, 1, 2].map(faster), values);
            self.scatter_drag(column, [0, 1, 2].map(|a| faster(film::DRAG.start + a)), values);
        }
    }

    /// Fluid that flows from the bodies into the film at each station, V times weight \[m^2/s\], from the film's balance; and its
    /// change. Where the film ends with a given pressure there is no balance, and it counts as none.
    pub fn film_outflow(&self, at: &State, change: &Change) -> Vec<[f64; 2]> {
        let mut outflow = vec![[0.0; 2]; self.stations.len()];
        let faster = change.inputs.surface_speeds(&at.inputs);
        for column in 0..self.layers[0].mesh.columns {
            let terms = self.film_terms(column, at);
            let local = self.film_local(column, &change.unknowns);
            let stored = change.history.as_ref().map_or([0.0; 3], |h| self.film.storage(&h.film[column]));
            for a in 0..3 {
                outflow[2 * column + a][0] += terms.rows[a];
                outflow[2 * column + a][1] += terms.along(a, &local, faster) + stored[a];
            }
        }
        if self.film_ends.is_none() {
            let last = outflow.len() - 1;
            (outflow[0], outflow[last]) = ([0.0; 2], [0.0; 2]);
        }
        let levels = self.layers[0].mesh.levels();
        for (station, end) in self.film_outflows(&at.unknowns, &at.inputs, at.rates.as_ref()) {
            let changed = |number: u32| change.unknowns[number as usize];
            let gap = changed(self.layout.gap[station]);
            let pressure = changed(self.layout.pressure[0][station * levels]);
            outflow[station][0] += end.value;
            outflow[station][1] += end.by_gap * gap + end.by_pressure * pressure + along(end.by_speeds, faster);
        }
        outflow
    }
}

/// Derivatives with respect to the two surface speeds, along a change of these.
fn along(by_speeds: [f64; 2], change: [f64; 2]) -> f64 {
    by_speeds[0] * change[0] + by_speeds[1] * change[1]
}

/// Adds matrix times vector.
fn add_product(matrix: &[f64; LOCAL * LOCAL], vector: &Local, sum: &mut Local) {
    for (column, value) in matrix.chunks_exact(LOCAL).zip(vector) {
        if *value != 0.0 {
            sum.iter_mut().zip(column).for_each(|(s, m)| *s += m * value);
        }
    }
}
