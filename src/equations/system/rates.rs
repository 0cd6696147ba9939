//! How fast elements and columns change in time, and their mesh moves.

use super::{Layer, Rates, System};
use crate::equations::film::MassRate;
use crate::equations::tissue::VolumeRate;
use crate::parameters::Inputs;

impl System {
    /// How fast what an element took up changes.
    pub fn volume_rate(&self, rates: Option<&Rates>, body: usize, element: usize) -> VolumeRate {
        rates
            .map_or_else(VolumeRate::default, |r| VolumeRate { rate: r.rate, history: r.history.volume[body][element] })
    }

    pub(super) fn mass_rate(&self, rates: Option<&Rates>, column: usize) -> MassRate {
        rates.map_or_else(MassRate::default, |r| MassRate {
            rate: r.rate,
            history: r.history.film[column],
            mesh_speeds: self.film_mesh_speeds(rates, column),
        })
    }

    /// x of the surface nodes of every undeformed body \[m\].
    pub(super) fn surfaces(&self) -> Vec<Vec<f64>> {
        let levels = self.layers[0].mesh.levels();
        let nodes = |layer: &Layer| layer.mesh.nodes.iter().step_by(levels).map(|node| node[0]).collect();
        self.layers.iter().map(nodes).collect()
    }

    /// Speeds along x of a body's mesh at both ends of a column \[m/s\].
    fn mesh_speeds(&self, body: usize, rates: Option<&Rates>, column: usize) -> [f64; 2] {
        let (levels, nodes) = (self.layers[0].mesh.levels(), &self.layers[body].mesh.nodes);
        let speed = |i: usize| rates.map_or(0.0, |r| r.rate * nodes[i * levels][0] + r.history.stations[body][i]);
        [2 * column, 2 * column + 2].map(speed)
    }

    /// Those of the film's mesh, halfway between, along its arc.
    pub(super) fn film_mesh_speeds(&self, rates: Option<&Rates>, column: usize) -> [f64; 2] {
        let bodies = self.layers.len();
        let mean = |end: usize| {
            (0..bodies).map(|body| self.mesh_speeds(body, rates, column)[end]).sum::<f64>() / bodies as f64
        };
        let [left, right] = [mean(0), mean(1)];
        [left / self.cosine[2 * column], right / self.cosine[2 * column + 2]]
    }

    /// Surface speeds of a body relative to the mesh at both edges of a column \[m/s\].
    pub fn relative_speeds(&self, body: usize, column: usize, inputs: &Inputs, rates: Option<&Rates>) -> [f64; 2] {
        let speed = inputs.surface_speeds()[body];
        let [left, right] = self.mesh_speeds(body, rates, column);
        // Along the arc.
        let along = |station: usize, mesh: f64| speed - mesh / self.surface_cosine(body, station);
        [along(2 * column, left), along(2 * column + 2, right)]
    }
}
