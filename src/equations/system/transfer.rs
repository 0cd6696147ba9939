//! Fields from the mesh of one contact on that of another: the functions of the one at the nodes of the other.

use super::System;
use crate::equations::grid::Grid;
use crate::fem::element::{pressure, quadratic};
use crate::solver::linear::FIXED;

/// Where a place is on the present mesh: first station of the element, and the local coordinate.
fn find(stations: &[f64], x: f64) -> (usize, f64) {
    let last = stations.len() - 1;
    let first = 2 * (stations.partition_point(|station| *station <= x).saturating_sub(1).min(last - 2) / 2);
    let s = 2.0 * (x - stations[first]) / (stations[first + 2] - stations[first]) - 1.0;
    (first, s.clamp(-1.0, 1.0))
}

impl System {
    /// The unknowns on another mesh of as many elements. Beyond the present sector everything is as at its end.
    pub fn interpolated(&self, unknowns: &[f64], grid: &Grid) -> Vec<f64> {
        let present = Grid::new(&self.parameters, self.contact_half_width, &self.shifts);
        let mut result = vec![0.0; unknowns.len()];
        let levels = self.layers[0].mesh.levels();
        let order = self.layers[0].mesh.pressure_order;
        let layout = &self.layout;
        for (station, x) in grid.stations.iter().enumerate() {
            let (first, s) = find(&self.stations, *x);
            let beyond = x.abs() > self.half_width();
            let sum = |shape: [f64; 3], number: &dyn Fn(usize) -> u32| -> f64 {
                (0..3)
                    .filter(|a| number(first + a) != FIXED)
                    .map(|a| shape[a] * unknowns[number(first + a) as usize])
                    .sum()
            };
            let mut put = |number: u32, value: f64| {
                if number != FIXED {
                    result[number as usize] = value;
                }
            };
            let gap = sum(quadratic(s), &|i| layout.gap[i]);
            let end = if s > 0.0 { first + 2 } else { first };
            let opening = if beyond { grid.touching_gap[station] - self.touching_gap[end] } else { 0.0 };
            put(layout.gap[station], gap + opening);
            if let Some(mean) = layout.mean.get(station) {
                put(*mean, sum(quadratic(s), &|i| layout.mean[i]));
            }
            if let Some(rise) = layout.rise.get(station) {
                put(*rise, sum(quadratic(s), &|i| layout.rise[i]));
            }
            put(layout.void[station], sum(pressure(order, s), &|i| layout.void[i]).max(0.0));
            for body in 0..self.layers.len() {
                let (first, s) = find(&present.surfaces[body], grid.surfaces[body][station]);
                let sum = |shape: [f64; 3], number: &dyn Fn(usize) -> u32| -> f64 {
                    (0..3)
                        .filter(|a| number(first + a) != FIXED)
                        .map(|a| shape[a] * unknowns[number(first + a) as usize])
                        .sum()
                };
                for (level, depth) in grid.depths[body].iter().enumerate() {
                    let node = station * levels + level;
                    let (surface, t) = find(&present.depths[body], *depth);
                    let of = |numbers: &'_ [u32], along: [f64; 3], down: [f64; 3]| -> f64 {
                        (0..3).map(|b| down[b] * sum(along, &|i| numbers[i * levels + surface + b])).sum()
                    };
                    let (along, down) = (quadratic(s), quadratic(t));
                    put(layout.horizontal[body][node], of(&layout.horizontal[body], along, down));
                    put(layout.vertical[body][node], of(&layout.vertical[body], along, down));
                    let (along, down) = (pressure(order, s), pressure(order, t));
                    put(layout.pressure[body][node], of(&layout.pressure[body], along, down));
                }
            }
        }
        result
    }
}
