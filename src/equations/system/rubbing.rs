//! How the surfaces move past each other, and the boundary friction that goes with it.
//!
//! Friction goes by the speeds of the surfaces themselves, not of the bones. Where an undeformed surface moves at U along its arc and is
//! stretched by the factor l, the deformed one moves at
//!
//! v = l (U - W) + dx/dt
//!
//! with the rate dx/dt of a node of the mesh, which itself moves at W along the undeformed surface. So bodies that roll slip where they are
//! stretched unlike, and so do those that are squeezed where one is pushed aside more than the other. A rigid counterface moves at U. In the
//! paper's formulation friction goes by U.

use num_dual::Dual64;

use super::{Change, Layer, Rates, State, StoredVolumes, System};
use crate::equations::contact::{ContactTerms, Rubbing};
use crate::equations::film;
use crate::equations::tissue::LOCAL;
use crate::fem::element::SIMPSON;
use crate::laws::contact::{Mobilised, mobilised_friction};
use crate::parameters::Formulation;

/// Friction, speeds of the undeformed surfaces past the mesh, and speeds of the nodes along the arc, as in [`Rubbing`], with their changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RubbingAlong {
    /// Friction.
    pub friction: Dual64,
    /// Of the undeformed surfaces \[m/s\].
    pub relative: [Dual64; 2],
    /// Of the nodes \[m/s\].
    pub nodes: [Dual64; 2],
}

impl System {
    /// Rubbing of a column, whether or not the tissue feels the friction. It goes by the mean speeds over the column: surfaces that roll stick where they
    /// can, and at every node their displacements could not do so.
    pub fn rubbing(&self, column: usize, at: &State) -> Rubbing {
        let p = &self.parameters;
        let element = self.film_element(column);
        let stretch = element.stretch(0.0, &self.film_local(column, &at.unknowns));
        let rates = at.rates.as_ref().filter(|_| element.deforms);
        let speeds = at.inputs.surface_speeds();
        let [mesh, nodes, node_rates] = self.column_speeds(column, &at.unknowns, rates);
        let relative = [0, 1].map(|k| speeds[k] - mesh[k]);
        let walls = [0, 1].map(|k| stretch.surfaces[k] * relative[k] + nodes[k]);
        let (mobilised, mut slopes) = mobilised_friction(p.formulation, walls, p.friction_regularisation_speed);
        if let Some(mobilised) = at.mobilised.get(column) {
            let slope = mobilised.slope(p.friction_regularisation_speed);
            slopes = [slope, -slope];
        }
        let by_sideways =
            |k: usize| std::array::from_fn(|b| stretch.by_surface[k][b] * relative[k] + node_rates[k] * SIMPSON[b]);
        Rubbing {
            friction: p.boundary_friction_coefficient * mobilised,
            by_walls: slopes.map(|slope| p.boundary_friction_coefficient * slope),
            relative,
            nodes,
            node_rates,
            by_sideways: [0, 1].map(by_sideways),
            stretches: stretch.surfaces,
        }
    }

    /// That which the tissue feels: none where that is not wanted, and none on mirror images, whose symmetry it would break.
    pub fn rubbing_on_tissue(&self, column: usize, at: &State) -> Rubbing {
        if self.rubs_tissue() { self.rubbing(column, at) } else { Rubbing::default() }
    }

    fn rubs_tissue(&self) -> bool {
        self.parameters.boundary_friction_loads_tissue && !self.mirrored()
    }

    /// Takes the friction on the way to a solution along to where its slips are now. Returns whether it is far from what the law says there, anywhere
    /// where the solids press.
    pub(super) fn mobilise(&self, state: &mut State) -> bool {
        /// Of full friction.
        const FAR: f64 = 0.1;
        /// Pressure over the tissue's modulus that is none.
        const NONE: f64 = 1e-4;
        let p = &self.parameters;
        if p.formulation == Formulation::Paper || !self.rubs_tissue() {
            return false;
        }
        let speed = p.friction_regularisation_speed;
        let slips = (0..self.layers[0].mesh.columns).map(|column| self.rubbing(column, state).slip());
        let mobilised = slips.enumerate().map(|(column, slip)| match state.mobilised.get(column) {
            Some(before) => before.moved(slip, speed),
            None => Mobilised::at(slip, speed),
        });
        state.mobilised = mobilised.collect();
        let law = self.contact_law();
        let presses = |station: usize| {
            state.active[station] || law.pressure(state.gap(self, station)).0 > NONE * self.stress_scale
        };
        let far = |(column, now): (usize, &Mobilised)| {
            (now.fraction - Mobilised::at(now.slip, speed).fraction).abs() > FAR
                && (2 * column..=2 * column + 2).any(presses)
        };
        state.mobilised.iter().enumerate().any(far)
    }

    /// Such values with their changes.
    pub fn rubbing_along(&self, column: usize, at: &State, change: &Change, rubbing: &Rubbing) -> RubbingAlong {
        let sideways = self.film_local(column, &change.unknowns);
        let faster = change.inputs.surface_speeds(&at.inputs);
        let history = change.history.as_ref().map_or([0.0; 2], |history| self.history_of_nodes(column, history));
        let moved = |k: usize| {
            let mean: f64 = (0..3).map(|b| SIMPSON[b] * sideways[film::SIDEWAYS + 3 * k + b]).sum();
            rubbing.node_rates[k] * mean + history[k]
        };
        RubbingAlong {
            friction: Dual64::new(rubbing.friction, rubbing.friction_along(&sideways, faster, history)),
            relative: [0, 1].map(|k| Dual64::new(rubbing.relative[k], faster[k])),
            nodes: [0, 1].map(|k| Dual64::new(rubbing.nodes[k], moved(k))),
        }
    }

    /// Whose nodes show how a surface moves: none's of a rigid counterface.
    fn layer_of(&self, surface: usize) -> Option<(usize, &Layer)> {
        let body = if self.mirrored() { 0 } else { surface };
        self.layers.get(body).map(|layer| (body, layer))
    }

    /// Means over a column, along the arc, for each surface: the speed of its mesh past it, that of the nodes \[m/s\], and the derivative of the latter by
    /// the mean displacement along x \[1/s\].
    fn column_speeds(&self, column: usize, unknowns: &[f64], rates: Option<&Rates>) -> [[f64; 2]; 3] {
        let mut speeds = [[0.0; 2]; 3];
        let Some(Rates { rate, history }) = rates else { return speeds };
        let middle = 2 * column + 1;
        for (k, (body, layer)) in (0..2).filter_map(|k| Some((k, self.layer_of(k)?))) {
            let levels = layer.mesh.levels();
            let mesh = |a: usize| {
                let station = 2 * column + a;
                rate * layer.mesh.nodes[station * levels][0] + history.stations[body][station]
            };
            let place = self.mean_place(body, column) + self.mean_sideways(body, column, unknowns);
            speeds[0][k] = (0..3).map(|a| SIMPSON[a] * mesh(a)).sum::<f64>() / self.surface_cosine(body, middle);
            speeds[1][k] = (rate * place + history.places[body][column]) / self.cosine[middle];
            speeds[2][k] = rate / self.cosine[middle];
        }
        speeds
    }

    /// Mean x of the undeformed surface of a body over a column \[m\].
    fn mean_place(&self, body: usize, column: usize) -> f64 {
        let mesh = &self.layers[body].mesh;
        (0..3).map(|a| SIMPSON[a] * mesh.nodes[(2 * column + a) * mesh.levels()][0]).sum()
    }

    /// Mean displacement of that surface along x \[m\].
    fn mean_sideways(&self, body: usize, column: usize, unknowns: &[f64]) -> f64 {
        let (numbers, levels) = (&self.layout.horizontal[body], self.layers[body].mesh.levels());
        (0..3).map(|a| SIMPSON[a] * unknowns[numbers[(2 * column + a) * levels] as usize]).sum()
    }

    /// See [`StoredVolumes::places`].
    pub(super) fn places(&self, unknowns: &[f64]) -> Vec<Vec<f64>> {
        let mut places = self.sideways(unknowns);
        for (body, places) in places.iter_mut().enumerate() {
            places.iter_mut().enumerate().for_each(|(column, place)| *place += self.mean_place(body, column));
        }
        places
    }

    /// How these change with the unknowns.
    pub fn sideways(&self, unknowns: &[f64]) -> Vec<Vec<f64>> {
        let of_body =
            |body| (0..self.layers[0].mesh.columns).map(move |column| self.mean_sideways(body, column, unknowns));
        (0..self.layers.len()).map(|body| of_body(body).collect()).collect()
    }

    /// Rates of these, as they would be on a mesh that stays \[m/s\].
    pub fn rates_of_places(&self, at: &State) -> Vec<Vec<f64>> {
        let speeds = at.inputs.surface_speeds();
        let rate = |body: usize, column: usize| {
            let rubbing = self.rubbing(column, at);
            let past_mesh = rubbing.stretches[body] * (rubbing.relative[body] - speeds[body]);
            self.cosine[2 * column + 1] * (rubbing.nodes[body] + past_mesh)
        };
        let of_body = |body| (0..self.layers[0].mesh.columns).map(move |column| rate(body, column));
        (0..self.layers.len()).map(|body| of_body(body).collect()).collect()
    }

    /// Speeds of the nodes of a column that are part of a difference formula's history, or of its change, likewise.
    pub(super) fn history_of_nodes(&self, column: usize, history: &StoredVolumes) -> [f64; 2] {
        let moves = self.parameters.formulation == Formulation::Consistent;
        [0, 1].map(|k| {
            let places = self.layer_of(k).filter(|_| moves).and_then(|(body, _)| history.places.get(body));
            places.map_or(0.0, |places| places[column] / self.cosine[2 * column + 1])
        })
    }

    /// The columns that a station is part of, and their parts of its weight.
    pub(super) fn columns_of(&self, station: usize) -> impl Iterator<Item = (usize, f64)> {
        let columns = match station % 2 {
            1 => [Some((station / 2, 1)), None],
            _ => [(station / 2).checked_sub(1).map(|before| (before, 2)), Some((station / 2, 0))],
        };
        let last = self.layers[0].mesh.columns;
        columns.into_iter().flatten().filter(move |(column, _)| *column < last).map(move |(column, a)| {
            let length = self.stations[2 * column + 2] - self.stations[2 * column];
            (column, SIMPSON[a] * length / self.weights[station])
        })
    }

    /// The part of a station's weight that a column has.
    pub(super) fn part_of(&self, station: usize, column: usize) -> f64 {
        self.columns_of(station).filter(|(of, _)| *of == column).map(|(_, part)| part).sum()
    }

    /// Friction that goes with the multiplier of a station, per unit of it.
    pub fn station_friction(&self, station: usize, at: &State) -> f64 {
        self.columns_of(station).map(|(column, part)| part * self.rubbing_on_tissue(column, at).friction).sum()
    }

    /// Adds what changes of the friction do to the residual, given by column and rubbing.
    pub(super) fn add_friction_change(&self, at: &State, change: impl Fn(usize, &Rubbing) -> f64, values: &mut [f64]) {
        for column in 0..self.layers[0].mesh.columns {
            let rubbing = self.rubbing_on_tissue(column, at);
            let change = change(column, &rubbing);
            if change == 0.0 {
                continue;
            }
            for (body, layer) in self.layers.iter().enumerate() {
                let element = column * layer.mesh.rows;
                let local = self.local(body, element, &at.unknowns, at.inputs.penetration_depth);
                let mut by_friction = [0.0; LOCAL];
                let terms = ContactTerms { by_friction: Some(&mut by_friction), ..ContactTerms::default() };
                let gaps = self.gaps(element, &at.unknowns);
                self.contact(rubbing).element(&layer.mesh, element, layer.side, &local, gaps, terms);
                self.scatter(body, element, &by_friction.map(|v| v * change), values);
            }
            for station in (2 * column..=2 * column + 2).filter(|station| at.active[*station]) {
                let force = self.part_of(station, column) * at.contact_forces[station];
                self.add_friction(station, change * force, values);
            }
        }
    }
}
