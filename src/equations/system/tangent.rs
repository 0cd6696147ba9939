//! The tangent, and what follows from it: updates, and derivatives by the inputs.

use super::{Rates, System, surface_speeds};
use crate::equations::tissue::{self, ElementTerms, LOCAL, Local, VolumeRate};
use crate::fem::element::NODES;
use crate::parameters::Inputs;
use crate::solver::linear::{FIXED, Multifrontal, Singular};

/// A change of the inputs.
struct Direction {
    penetration_depth: f64,
    speeds: [f64; 2],
}

/// Unit changes of penetration depth, sliding speed and slide-to-roll ratio.
fn input_directions(inputs: &Inputs) -> [Direction; 3] {
    let s = inputs.slide_to_roll_ratio;
    let half = 0.5 * inputs.sliding_speed;
    [
        Direction { penetration_depth: 1.0, speeds: [0.0; 2] },
        Direction { penetration_depth: 0.0, speeds: [0.5 * (1.0 + s), 0.5 * (1.0 - s)] },
        Direction { penetration_depth: 0.0, speeds: [half, -half] },
    ]
}

impl System {
    /// Factorises on up to this many threads; a single one unless told otherwise. The results are the same bits.
    pub fn set_threads(&mut self, threads: usize) {
        self.linear.set_threads(threads);
    }

    /// Factorises the tangent at these unknowns.
    ///
    /// # Errors
    /// [`Singular`] where elimination breaks down.
    pub fn factorise(
        &mut self,
        unknowns: &[f64],
        active: &[bool],
        inputs: &Inputs,
        rates: Option<&Rates>,
    ) -> Result<(), Singular> {
        let Self { linear, .. } = self;
        // The factorisation is taken out while the rest of the system fills it.
        let mut linear = std::mem::replace(linear, Multifrontal::empty());
        let result = linear.factorise(&self.layout.cells, |cell, matrix| {
            self.cell_tangent(cell, unknowns, active, inputs, rates, matrix);
        });
        self.linear = linear;
        result
    }

    /// Solves with the last factorisation, in place, for any number of right-hand sides.
    ///
    /// # Errors
    /// [`Singular`] where the answer is not finite.
    pub fn solve(&self, right_hand_sides: &mut [f64]) -> Result<(), Singular> {
        self.linear.solve(right_hand_sides)
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
        let layer = &self.layers[body];
        let mut tangent = [0.0; LOCAL * LOCAL];
        let rate = self.volume_rate(rates, body, element);
        let terms = ElementTerms { residual: None, by_speed: None, tangent: Some(&mut tangent) };
        // An inverted element was refused when the residual was formed.
        let inverted =
            layer.tissue.element(&layer.mesh, element, at, surface_speeds(inputs)[body], &rate, terms).is_err();
        if inverted {
            tangent.fill(f64::NAN);
        }
        if element.is_multiple_of(layer.mesh.rows) && layer.tissue.consistent {
            let terms = ElementTerms { residual: None, by_speed: None, tangent: Some(&mut tangent) };
            tissue::surface_pressure(&layer.mesh, element, layer.side, at, terms);
        }
        tangent
    }

    /// Derivative of an element's residual by the speed of its surface.
    fn element_by_speed(&self, body: usize, element: usize, at: &Local, inputs: &Inputs) -> Local {
        let layer = &self.layers[body];
        let mut by_speed = [0.0; LOCAL];
        let terms = ElementTerms { residual: None, by_speed: Some(&mut by_speed), tangent: None };
        let speed = surface_speeds(inputs)[body];
        if layer.tissue.element(&layer.mesh, element, at, speed, &VolumeRate::default(), terms).is_err() {
            by_speed.fill(f64::NAN);
        }
        by_speed
    }

    /// Matrix of a cell over its unknowns: tissue, film, and contact by rows and columns.
    fn cell_tangent(
        &self,
        cell: usize,
        unknowns: &[f64],
        active: &[bool],
        inputs: &Inputs,
        rates: Option<&Rates>,
        matrix: &mut [f64],
    ) {
        let (body, element) = self.layout.body_and_element(cell);
        let layer = &self.layers[body];
        let at = self.local(body, element, unknowns, inputs.penetration_depth);
        let tangent = self.element_tangent(body, element, &at, inputs, rates);
        let m = self.layout.cells[cell].len();
        for (column, values) in tangent.chunks_exact(LOCAL).enumerate() {
            matrix[column * m..column * m + LOCAL].copy_from_slice(values);
        }
        if element % layer.mesh.rows != 0 {
            return;
        }
        let column = element / layer.mesh.rows;
        let half = 0.5 * layer.side;
        let two_bodies = m > LOCAL;
        // Columns: the vertical displacement of a surface node is mean + side/2 gap.
        for a in 0..3 {
            for i in 0..LOCAL {
                let value = matrix[(NODES + a) * m + i];
                matrix[(NODES + a) * m + i] = half * value;
                if two_bodies {
                    matrix[(LOCAL + a) * m + i] = value;
                }
            }
        }
        // Rows likewise, then friction and the condition of contact.
        let (share, _) = self.friction(inputs);
        for j in 0..m {
            let values = &mut matrix[j * m..(j + 1) * m];
            for a in 0..3 {
                let value = values[NODES + a];
                values[NODES + a] = half * value;
                if two_bodies {
                    values[LOCAL + a] = value;
                    if active[2 * column + a] {
                        values[a] += layer.side * share * half * value;
                        values[LOCAL + 3 + a] -= layer.side * share * half * value;
                    }
                }
                if active[2 * column + a] {
                    values[NODES + a] = if j == NODES + a { self.contact_diagonal() } else { 0.0 };
                }
            }
        }
        if body == 0 {
            let at = self.film_local(column, unknowns);
            let terms =
                self.film.element(self.film_length(column), &at, inputs.sliding_speed, &self.mass_rate(rates, column));
            for a in 0..3 {
                for b in 0..3 {
                    matrix[(NODES + b) * m + 2 * NODES + a] += terms.tangent[a][b] / self.copies();
                    matrix[(2 * NODES + b) * m + 2 * NODES + a] += terms.tangent[a][3 + b] / self.copies();
                }
            }
        }
    }

    /// Derivatives of the unknowns by penetration depth, sliding speed and slide-to-roll ratio, from the last factorisation: three
    /// vectors, one after the other.
    ///
    /// # Errors
    /// [`Singular`] where the answer is not finite.
    pub fn sensitivities(
        &self,
        unknowns: &[f64],
        active: &[bool],
        inputs: &Inputs,
        rates: Option<&Rates>,
        contact_forces: &[f64],
    ) -> Result<Vec<f64>, Singular> {
        let n = self.unknowns();
        let mut columns = vec![0.0; 3 * n];
        for (k, direction) in input_directions(inputs).into_iter().enumerate() {
            if k == 2 && self.mirrored() {
                // Exchanging the bodies reverses the slide-to-roll ratio: what is mirror-symmetric does not change with it.
                continue;
            }
            let values = &mut columns[k * n..(k + 1) * n];
            let zero = vec![0.0; n];
            self.directional(unknowns, inputs, rates, &zero, &direction, 0..self.layers[0].mesh.rows, values);
            let (share, slopes) = self.friction(inputs);
            for i in (0..active.len()).filter(|i| active[*i]) {
                let gap = self.layout.gap[i] as usize;
                let change = share * self.copies() * values[gap]
                    + (slopes[0] * direction.speeds[0] + slopes[1] * direction.speeds[1]) * contact_forces[i];
                self.add_friction(i, change, values);
                values[gap] = 0.0;
            }
            values.iter_mut().for_each(|v| *v = -*v);
        }
        self.solve(&mut columns)?;
        Ok(columns)
    }

    /// Derivatives of the contact forces by the three inputs, given those of the unknowns.
    pub fn contact_force_sensitivities(
        &self,
        unknowns: &[f64],
        active: &[bool],
        inputs: &Inputs,
        rates: Option<&Rates>,
        sensitivities: &[f64],
    ) -> Vec<Vec<f64>> {
        let n = self.unknowns();
        let mut values = vec![0.0; n];
        input_directions(inputs)
            .into_iter()
            .enumerate()
            .map(|(k, direction)| {
                values.fill(0.0);
                if active.contains(&true) {
                    self.directional(
                        unknowns,
                        inputs,
                        rates,
                        &sensitivities[k * n..(k + 1) * n],
                        &direction,
                        0..1,
                        &mut values,
                    );
                }
                let force = |i: usize| self.copies() * values[self.layout.gap[i] as usize];
                (0..active.len()).map(|i| if active[i] { force(i) } else { 0.0 }).collect()
            })
            .collect()
    }

    /// Adds the derivative of the residual before contact along a change of unknowns and inputs, for some rows of elements.
    #[allow(clippy::too_many_arguments)]
    fn directional(
        &self,
        unknowns: &[f64],
        inputs: &Inputs,
        rates: Option<&Rates>,
        change: &[f64],
        direction: &Direction,
        rows: std::ops::Range<usize>,
        values: &mut [f64],
    ) {
        for (body, layer) in self.layers.iter().enumerate() {
            for element in 0..layer.mesh.elements() {
                let row = element % layer.mesh.rows;
                // Only the row at the bone feels the depth; all rows feel the speed.
                let relevant = direction.speeds != [0.0; 2] || rows.len() == 1 || row + 1 == layer.mesh.rows;
                if !rows.contains(&row) || !relevant {
                    continue;
                }
                let at = self.local(body, element, unknowns, inputs.penetration_depth);
                let local_change = self.local_change(body, element, change, direction.penetration_depth);
                let mut local = self.element_by_speed(body, element, &at, inputs).map(|v| v * direction.speeds[body]);
                if local_change.iter().any(|c| *c != 0.0) {
                    let tangent = self.element_tangent(body, element, &at, inputs, rates);
                    for (column, c) in tangent.chunks_exact(LOCAL).zip(local_change) {
                        if c != 0.0 {
                            local.iter_mut().zip(column).for_each(|(l, t)| *l += t * c);
                        }
                    }
                }
                self.scatter(body, element, &local, values);
            }
        }
        let levels = self.layers[0].mesh.levels();
        let sliding = direction.speeds[0] + direction.speeds[1];
        for column in 0..self.layers[0].mesh.columns {
            let at = self.film_local(column, unknowns);
            let local = self.film_local(column, change);
            let terms =
                self.film.element(self.film_length(column), &at, inputs.sliding_speed, &self.mass_rate(rates, column));
            for a in 0..3 {
                let number = self.layout.pressure[0][(2 * column + a) * levels];
                if number != FIXED {
                    let along: f64 = terms.tangent[a].iter().zip(local).map(|(t, c)| t * c).sum();
                    values[number as usize] += (along + terms.by_speed[a] * sliding) / self.copies();
                }
            }
        }
    }

    /// Fluid that flows from the bodies into the film at each station, V times weight [m^2/s], from the film's balance; and its
    /// derivative along a change of the unknowns and of the sliding speed.
    pub fn film_outflow(
        &self,
        unknowns: &[f64],
        inputs: &Inputs,
        rates: Option<&Rates>,
        change: &[f64],
        sliding: f64,
    ) -> Vec<[f64; 2]> {
        let mut outflow = vec![[0.0; 2]; self.stations.len()];
        for column in 0..self.layers[0].mesh.columns {
            let at = self.film_local(column, unknowns);
            let local = self.film_local(column, change);
            let terms =
                self.film.element(self.film_length(column), &at, inputs.sliding_speed, &self.mass_rate(rates, column));
            for a in 0..3 {
                let along: f64 = terms.tangent[a].iter().zip(local).map(|(t, c)| t * c).sum();
                outflow[2 * column + a][0] += terms.residual[a];
                outflow[2 * column + a][1] += along + terms.by_speed[a] * sliding;
            }
        }
        outflow
    }
}
