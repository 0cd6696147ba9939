//! The residual: balances, boundary friction, and the active set of contact.

use super::{Change, Layer, Rates, State, StoredVolumes, System, moves};
use crate::equations::contact::{ContactTerms, Rubbing};
use crate::equations::facing;
use crate::equations::film;
use crate::equations::inflow;
use crate::equations::tissue::{ElementTerms, Inverted, LOCAL, Local, Tissue, surface_pressure};
use crate::fem::assembly::scatter;
use crate::parameters::Inputs;
use crate::solver::linear::FIXED;

impl System {
    /// Volumes and masses whose rates of change enter the balances.
    pub fn stored_volumes(&self, state: &State) -> StoredVolumes {
        let State { unknowns, inputs, .. } = state;
        let volume = self.layers.iter().enumerate().map(|(body, layer)| {
            let element = |element| {
                let at = self.local(body, element, unknowns, inputs.penetration_depth);
                let points = layer.mesh.points(element);
                std::array::from_fn(|point| {
                    Tissue::strain(&layer.mesh, element, point, &at).volume_change * points[point].weight
                })
            };
            (0..layer.mesh.elements()).map(element).collect()
        });
        let film = (0..self.layers[0].mesh.columns)
            .map(|column| self.film.mass(&self.film_element(column), &self.film_local(column, unknowns)));
        StoredVolumes {
            volume: volume.collect(),
            film: film.collect(),
            stations: self.surfaces(),
            places: self.places(unknowns),
        }
    }

    /// How [`System::stored_volumes`] change along a change of the state.
    pub fn stored_volumes_change(&self, state: &State, change: &Change) -> StoredVolumes {
        let State { unknowns, inputs, .. } = state;
        let volume = self.layers.iter().enumerate().map(|(body, layer)| {
            let element = |element| {
                let at = self.local(body, element, unknowns, inputs.penetration_depth);
                let along = self.local_change(body, element, &change.unknowns, change.inputs.penetration_depth);
                let points = layer.mesh.points(element);
                std::array::from_fn(|point| {
                    let strain = Tissue::strain(&layer.mesh, element, point, &at);
                    let direction = Tissue::strain(&layer.mesh, element, point, &along);
                    strain.cofactor.dot(&direction.gradient) * points[point].weight
                })
            };
            (0..layer.mesh.elements()).map(element).collect()
        });
        let film = (0..self.layers[0].mesh.columns).map(|column| {
            let [at, change] = [unknowns, &change.unknowns].map(|values| self.film_local(column, values));
            self.film.mass_change(&self.film_element(column), &at, &change)
        });
        StoredVolumes {
            volume: volume.collect(),
            film: film.collect(),
            stations: vec![vec![0.0; self.stations.len()]; self.layers.len()],
            places: self.sideways(&change.unknowns),
        }
    }

    /// Adds what a change of the rates of volume, mass and places does to the residual. What of these is empty does not change.
    pub fn add_storage(&self, state: &State, change: &StoredVolumes, values: &mut [f64]) {
        let State { unknowns, inputs, .. } = state;
        for (body, (layer, volume)) in self.layers.iter().zip(&change.volume).enumerate() {
            for (element, rate) in volume.iter().enumerate() {
                let at = self.local(body, element, unknowns, inputs.penetration_depth);
                let local = layer.tissue.storage(&layer.mesh, &at, rate);
                self.scatter(body, element, &local, values);
            }
        }
        for (column, rate) in change.film.iter().enumerate() {
            self.scatter_film(column, self.film.storage(rate), values);
        }
        let friction = |column: usize, rubbing: &Rubbing| {
            rubbing.friction_along(&[0.0; film::LOCAL], [0.0; 2], self.history_of_nodes(column, change))
        };
        self.add_friction_change(state, friction, values);
    }

    /// Adds what an element of tissue gives, before contact and the film.
    ///
    /// # Errors
    /// [`Inverted`] where it is turned inside out.
    pub(super) fn add_tissue(
        &self,
        body: usize,
        element: usize,
        at: &Local,
        inputs: &Inputs,
        rates: Option<&Rates>,
        mut terms: ElementTerms<'_>,
    ) -> Result<(), Inverted> {
        let Layer { mesh, tissue, side } = &self.layers[body];
        let speeds = self.relative_speeds(body, element / mesh.rows, inputs, rates);
        tissue.element(mesh, element, at, speeds, &self.volume_rate(rates, body, element), terms.reborrow())?;
        if tissue.consistent {
            if element.is_multiple_of(mesh.rows) {
                surface_pressure(mesh, element, *side, at, terms.reborrow());
            }
            inflow::ends(tissue, mesh, element, at, speeds, terms);
        }
        Ok(())
    }

    /// Residual of all equations; contact enters by [`Self::residual_at`].
    fn raw_residual(&self, state: &State, values: &mut [f64]) -> Result<(), Inverted> {
        let State { unknowns, inputs, .. } = state;
        let rates = state.rates.as_ref();
        values.fill(0.0);
        for (body, layer) in self.layers.iter().enumerate() {
            for element in 0..layer.mesh.elements() {
                let at = self.local(body, element, unknowns, inputs.penetration_depth);
                let mut local = [0.0; LOCAL];
                let terms = ElementTerms { residual: Some(&mut local), ..ElementTerms::default() };
                self.add_tissue(body, element, &at, inputs, rates, terms)?;
                if element.is_multiple_of(layer.mesh.rows) {
                    let terms = ContactTerms { residual: Some(&mut local), ..ContactTerms::default() };
                    let contact = self.contact(self.rubbing_on_tissue(element / layer.mesh.rows, state));
                    contact.element(&layer.mesh, element, layer.side, &at, self.gaps(element, unknowns), terms);
                }
                self.scatter(body, element, &local, values);
            }
        }
        let levels = self.layers[0].mesh.levels();
        for (station, outflow) in self.film_outflows(unknowns, inputs, rates) {
            values[self.layout.pressure[0][station * levels] as usize] += outflow.value / self.copies();
        }
        for column in 0..self.layers[0].mesh.columns {
            let terms = self.film_terms(column, state);
            self.scatter_film(column, terms.residual(), values);
            self.scatter_drag(column, terms.drag(), values);
            if let Some(facing) = self.facing(column) {
                let terms = facing.terms(&self.facing_local(column, unknowns));
                scatter(&terms.residual, &self.facing_numbers(column)[facing::ROWS], values);
            }
        }
        Ok(())
    }

    /// Residual at a state, with its active set, contact forces and mobilised friction renewed from that. Returns whether the tangent is another one: with another
    /// set, or friction that is far from its law.
    ///
    /// # Errors
    /// [`Inverted`] where an element is turned inside out.
    pub fn residual_at(&self, state: &mut State, values: &mut Vec<f64>) -> Result<bool, Inverted> {
        values.resize(self.unknowns(), 0.0);
        let mut changed = self.mobilise(state);
        self.raw_residual(state, values)?;
        let law = self.contact_law();
        for i in 0..state.active.len() {
            let gap = self.layout.gap[i] as usize;
            let force = self.copies() * self.cosine[i] * values[gap];
            let multiplier = if state.active[i] { force / self.weights[i] } else { 0.0 };
            let now = law.is_active(state.active[i], multiplier, state.unknowns[gap]);
            changed |= now != state.active[i];
            state.active[i] = now;
            state.contact_forces[i] = if now { force } else { 0.0 };
            if now {
                self.add_friction(i, self.station_friction(i, state) * force, values);
                values[gap] = self.layout.gap_multiplicity[i] * law.condition(state.unknowns[gap]).0;
            }
        }
        let State { unknowns, inputs, rates, active, .. } = state;
        for i in (0..active.len()).filter(|i| self.layout.void[*i] != FIXED) {
            let [pressure, void] = self.pressure_and_void(i, unknowns);
            values[self.layout.void[i] as usize] = self.layout.gap_multiplicity[i]
                * match self.is_cavitated(i, unknowns, moves(inputs, rates.as_ref())) {
                    true => pressure - self.parameters.cavitation_pressure,
                    false => self.contact_stiffness * void,
                };
        }
        Ok(changed)
    }

    /// Adds a tangential force at a station, along -x on the upper and +x on the lower body.
    pub(super) fn add_friction(&self, station: usize, force: f64, values: &mut [f64]) {
        if force != 0.0 {
            let node = station * self.layers[0].mesh.levels();
            for (body, layer) in self.layers.iter().enumerate() {
                values[self.layout.horizontal[body][node] as usize] += layer.side * force;
            }
        }
    }
}
