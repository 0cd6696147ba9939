//! Which surface nodes of both bodies are paired: those that are at the same place after they deformed, on a mesh that goes along. What is
//! left of their distance, [`Facing`] takes into account.

use super::{Change, State, System};
use crate::equations::facing::{self, Facing};
use crate::equations::grid;
use crate::solver::linear::FIXED;

impl System {
    /// Whether nodes are paired as they are deformed: rough surfaces of two bodies in the consistent formulation. Others are paired as they
    /// are undeformed.
    pub fn pairs_deformed(&self) -> bool {
        !self.layout.rise.is_empty()
    }

    /// The shifts of the mesh with which paired nodes would be at the same place along x, as far as the displacements tell.
    pub fn wanted_shifts(&self, state: &State) -> Vec<f64> {
        let scale = grid::shift_scale(&self.parameters, self.contact_half_width);
        let last = self.layers[0].mesh.columns;
        let place = |body: usize, end: usize| {
            let node = 2 * end * self.layers[0].mesh.levels();
            self.layers[body].mesh.nodes[node][0] + state.unknowns[self.layout.horizontal[body][node] as usize]
        };
        let shift = |end: usize| {
            let [before, after] = [end.saturating_sub(1), (end + 1).min(last)];
            let length = |body: usize| place(body, after) - place(body, before);
            // Of the deformed surfaces: they come nearer by as much more as they are stretched.
            let stretch = 0.5 * (length(0) + length(1)) / (self.stations[2 * after] - self.stations[2 * before]);
            let distance = place(0, end) - place(1, end);
            let present = state.shifts.get(end).copied().unwrap_or_default();
            present - distance / (stretch.max(0.5) * scale)
        };
        (0..=last).map(shift).collect()
    }

    /// How far paired nodes are from each other along x, over the half-width of the interface.
    pub fn mismatch(&self, state: &State) -> f64 {
        let scale = grid::shift_scale(&self.parameters, self.contact_half_width) / self.half_width();
        let present = |end: usize| state.shifts.get(end).copied().unwrap_or_default();
        let wanted = self.wanted_shifts(state).into_iter().enumerate();
        wanted.map(|(end, wanted)| scale * (wanted - present(end)).abs()).fold(0.0, f64::max)
    }

    /// By how much the surfaces rise between paired nodes, in the mean over what these carry, where that is left out \[m\]: about by as
    /// much as the depth is off.
    pub fn neglected_rise(&self, state: &State) -> f64 {
        if self.pairs_deformed() || self.mirrored() {
            return 0.0;
        }
        let none = Change::none(self.unknowns(), self.stations.len());
        let height = self.mean_height(state, &none);
        let contact = self.contact_pressure(state, &none);
        let levels = self.layers[0].mesh.levels();
        let value = |number: u32| if number == FIXED { 0.0 } else { state.unknowns[number as usize] };
        let sideways = |body: usize, i: usize| self.layout.horizontal.get(body).map_or(0.0, |h| value(h[i * levels]));
        let (mut rise, mut load) = (0.0, 0.0);
        for i in (2..self.stations.len() - 2).step_by(2) {
            let length = self.stations[i + 2] - self.stations[i - 2];
            let pressure = value(self.layout.pressure[0][i * levels]) + contact[i].re;
            rise += pressure * (sideways(0, i) - sideways(1, i)) * (height[i + 2].re - height[i - 2].re);
            load += pressure.abs() * length;
        }
        if load > 0.0 { rise / load } else { 0.0 }
    }

    /// A guess of the state with paired nodes at the same place along x, or by a part of the way nearer to that. Film and deformation stay with
    /// the nodes.
    pub fn paired_anew(&self, state: &State, part: f64) -> State {
        let mut state = state.clone();
        let mut shifts = self.wanted_shifts(&state);
        for (end, shift) in shifts.iter_mut().enumerate() {
            let present = state.shifts.get(end).copied().unwrap_or_default();
            *shift = present + part * (*shift - present);
        }
        self.carry(&mut state.unknowns, self.contact_half_width, &shifts);
        for (station, number) in self.layout.rise.iter().enumerate() {
            let fall = part * state.unknowns[*number as usize];
            state.unknowns[*number as usize] -= fall;
            self.follow(station, -fall, &mut state.unknowns);
        }
        State { shifts, ..state }
    }

    /// Which points of the surfaces face each other in a column; none where they do as they do undeformed.
    pub(super) fn facing(&self, column: usize) -> Option<Facing> {
        let station = |a: usize| 2 * column + a;
        self.layout.rise.get(station(2))?;
        let levels = self.layers[0].mesh.levels();
        let height = |i: usize| self.layers.iter().map(|layer| 0.5 * layer.mesh.nodes[i * levels][1]).sum();
        Some(Facing {
            height: [0, 1, 2].map(|a| height(station(a))),
            cosine: [0, 1, 2].map(|a| self.cosine[station(a)]),
            scale: [0, 1, 2].map(|a| self.stress_scale / self.weights[station(a)]),
            pressure_order: self.layers[0].mesh.pressure_order,
            law: self.contact_law(),
            counts: self.distance_counts,
        })
    }

    /// Numbers of the unknowns of [`Facing`] in a column.
    pub(super) fn facing_numbers(&self, column: usize) -> [u32; facing::UNKNOWNS] {
        let (layout, levels) = (&self.layout, self.layers[0].mesh.levels());
        std::array::from_fn(|i| {
            let station = 2 * column + i % 3;
            match i / 3 {
                0 | 1 => layout.horizontal[i / 3][station * levels],
                2 => layout.mean[station],
                3 => layout.rise[station],
                4 => layout.pressure[0][station * levels],
                _ => layout.gap[station],
            }
        })
    }

    /// What [`Facing`] takes from the unknowns: places along x, and the rest.
    pub(super) fn facing_local(&self, column: usize, unknowns: &[f64]) -> [f64; facing::UNKNOWNS] {
        let levels = self.layers[0].mesh.levels();
        let numbers = self.facing_numbers(column);
        std::array::from_fn(|i| {
            let place = self.layers.get(i / 3).map_or(0.0, |layer| layer.mesh.nodes[(2 * column + i % 3) * levels][0]);
            place + if numbers[i] == FIXED { 0.0 } else { unknowns[numbers[i] as usize] }
        })
    }
}
