//! What elements and columns take from the unknowns, and where what they give goes.

use super::System;
use crate::equations::film;
use crate::equations::grid;
use crate::equations::tissue::{LOCAL, Local};
use crate::fem::assembly::scatter;
use crate::fem::element::NODES;
use crate::solver::linear::FIXED;

impl System {
    /// Displacements and pressures of an element's nodes.
    pub fn local(&self, body: usize, element: usize, unknowns: &[f64], penetration_depth: f64) -> Local {
        self.gather(body, element, unknowns, -self.part(&self.layers[body]) * penetration_depth, 1.0)
    }

    /// Nodal values: unknowns, the bone's displacement, and the gap of the undeformed surfaces times `offset`.
    fn gather(&self, body: usize, element: usize, unknowns: &[f64], bone: f64, offset: f64) -> Local {
        let layout = &self.layout;
        let layer = &self.layers[body];
        let nodes = layer.mesh.element_nodes(element);
        let value = |number: u32| if number == FIXED { 0.0 } else { unknowns[number as usize] };
        let last = layer.mesh.levels() - 1;
        let mut local = [0.0; LOCAL];
        for (a, n) in nodes.into_iter().enumerate() {
            local[a] = value(layout.horizontal[body][n]);
            let level = n % (last + 1);
            local[NODES + a] = if level == 0 {
                let station = n / (last + 1);
                let rise = layout.rise.get(station).map_or(0.0, |r| unknowns[*r as usize]);
                let opening = unknowns[layout.gap[station] as usize] + rise - offset * self.touching_gap[station];
                let mean = layout.mean.get(station).map_or(0.0, |m| unknowns[*m as usize]);
                mean + self.surface_part(body, station) * opening
            } else if level == last {
                bone
            } else {
                value(layout.vertical[body][n])
            };
            local[2 * NODES + a] = value(layout.pressure[body][n]);
        }
        local
    }

    /// Change of an element's nodal values with a change of the unknowns and of the penetration depth.
    pub fn local_change(&self, body: usize, element: usize, change: &[f64], penetration_depth: f64) -> Local {
        self.gather(body, element, change, -self.part(&self.layers[body]) * penetration_depth, 0.0)
    }

    /// What a column of the film takes from the unknowns.
    pub fn film_local(&self, column: usize, unknowns: &[f64]) -> film::Local {
        let levels = self.layers[0].mesh.levels();
        std::array::from_fn(|i| {
            let station = 2 * column + i % 3;
            let number = match i / 3 {
                0 => self.layout.gap[station],
                1 => self.layout.pressure[0][station * levels],
                2 => self.layout.void[station],
                3 => self.layout.horizontal[0][station * levels],
                _ => self.lower_horizontal(station),
            };
            if number == FIXED { 0.0 } else { unknowns[number as usize] }
        })
    }

    /// Distances of the surfaces at the nodes of an element of the first row.
    pub(super) fn gaps(&self, element: usize, unknowns: &[f64]) -> [f64; 3] {
        let first = 2 * (element / self.layers[0].mesh.rows);
        std::array::from_fn(|a| unknowns[self.layout.gap[first + a] as usize])
    }

    /// Adds local residual terms to the equations. Vertical equations of the surface go to the gap and to the mean.
    pub(super) fn scatter(&self, body: usize, element: usize, local: &Local, values: &mut [f64]) {
        let mut of_cell = [0.0; LOCAL + 3];
        of_cell[..LOCAL].copy_from_slice(local);
        if element.is_multiple_of(self.layers[body].mesh.rows) {
            self.surface(body, element / self.layers[body].mesh.rows).transform_rows(&mut of_cell);
        }
        scatter(&of_cell, &self.layout.cells[self.layout.cell(body, element)], values);
    }

    /// Adds terms of a column of the film to the balances at its three stations.
    pub(super) fn scatter_film(&self, column: usize, terms: [f64; 3], values: &mut [f64]) {
        let levels = self.layers[0].mesh.levels();
        let numbers: [u32; 3] = std::array::from_fn(|a| self.layout.pressure[0][(2 * column + a) * levels]);
        scatter(&terms.map(|term| term / self.copies()), &numbers, values);
    }

    /// Where forces of the film against its arc on the surface nodes of a column act, and with which part: along x on each body, and along
    /// y on both, which is the equation of the mean. In the paper's formulation the tissue does not feel them, and against a counterface the part along y is
    /// left out.
    pub(super) fn drag_on(&self, station: usize) -> impl Iterator<Item = (u32, f64)> {
        let levels = self.layers[0].mesh.levels();
        let felt = if self.layers[0].tissue.consistent { 1.0 } else { 0.0 };
        let sine = self.stations[station] * grid::film_curvature(&self.parameters);
        let along_x =
            self.layout.horizontal.iter().map(move |numbers| (numbers[station * levels], felt * self.cosine[station]));
        along_x.chain(self.layout.mean.get(station).map(|mean| (*mean, 2.0 * felt * sine)))
    }

    /// Adds such forces to the balances.
    pub(super) fn scatter_drag(&self, column: usize, forces: [f64; 3], values: &mut [f64]) {
        for (a, force) in forces.into_iter().enumerate() {
            for (number, part) in self.drag_on(2 * column + a) {
                values[number as usize] += part * force;
            }
        }
    }

    /// Number of the displacement along x of the lower surface: the upper one's of mirror images, none of a rigid counterface.
    pub(super) fn lower_horizontal(&self, station: usize) -> u32 {
        let body = if self.mirrored() { 0 } else { 1 };
        self.layout.horizontal.get(body).map_or(FIXED, |numbers| numbers[station * self.layers[0].mesh.levels()])
    }
}
