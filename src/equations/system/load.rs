//! What the surfaces carry, and how it changes.

use num_dual::Dual64;

use super::{At, Change, System, surface_speeds};
use crate::fem::element::{GAUSS, GAUSS_WEIGHTS, SIMPSON, pressure, quadratic_derivative};
use crate::laws::chain;
use crate::solver::linear::FIXED;

/// What the fluid and what the solid carries, or a change of both, per unit depth [N/m].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loads {
    /// Of the fluid's pressure.
    pub fluid: Dual64,
    /// Of solid contact.
    pub solid: Dual64,
    /// Integral of real contact's share times the fluid's pressure (rough surfaces).
    pub fluid_in_contact: Dual64,
    /// Integral of real contact's share times all pressure.
    pub in_real_contact: Dual64,
}

impl Loads {
    /// Both together.
    pub fn total(&self) -> Dual64 {
        self.fluid + self.solid
    }
}

impl System {
    /// Pressure of solid on solid at every station, with its change [Pa].
    pub fn contact_pressure(&self, at: At<'_>, change: &Change) -> Vec<Dual64> {
        let smooth = |i: usize| match at.active[i] {
            true => Dual64::new(at.contact_forces[i], change.contact_forces[i]) / self.weights[i],
            false => Dual64::from(0.0),
        };
        let rough =
            |i: usize| self.roughness().map(|rough| chain(rough.pressure(at.gap(self, i)), self.gap_change(change, i)));
        (0..self.stations.len()).map(|i| rough(i).unwrap_or_else(|| smooth(i))).collect()
    }

    fn gap_change(&self, change: &Change, station: usize) -> f64 {
        change.unknowns[self.layout.gap[station] as usize]
    }

    /// What the surfaces carry, with its change: vertical forces, of the consistent formulation and of rough surfaces over the deformed
    /// surfaces (the mean of both bodies), else over the undeformed ones.
    pub fn loads(&self, at: At<'_>, change: &Change) -> Loads {
        let zero = Dual64::from(0.0);
        let mut loads = Loads { fluid: zero, solid: zero, fluid_in_contact: zero, in_real_contact: zero };
        let rough = self.roughness();
        let levels = self.layers[0].mesh.levels();
        let value = |number: u32| match number {
            FIXED => zero,
            number => Dual64::new(at.unknowns[number as usize], change.unknowns[number as usize]),
        };
        for first in (0..self.stations.len() - 1).step_by(2) {
            let nodal =
                |numbers: &[u32]| -> [Dual64; 3] { std::array::from_fn(|a| value(numbers[(first + a) * levels])) };
            let fluid = nodal(&self.layout.pressure[0]);
            let length = 0.5 * (self.stations[first + 2] - self.stations[first]);
            // dx/ds of the surfaces.
            let sideways: Vec<[Dual64; 3]> = self.layout.horizontal.iter().map(|numbers| nodal(numbers)).collect();
            let stretch = |s: f64, deformed: bool| -> Dual64 {
                let slope = quadratic_derivative(s);
                let change: Dual64 = sideways.iter().map(|u| (0..3).map(|a| u[a] * slope[a]).sum::<Dual64>()).sum();
                if deformed { change / self.layers.len() as f64 + length } else { Dual64::from(length) }
            };
            let order = self.layers[0].mesh.pressure_order;
            let interpolated = |s: f64| -> Dual64 { pressure(order, s).iter().zip(&fluid).map(|(n, p)| *p * *n).sum() };
            for (s, w) in GAUSS.into_iter().zip(GAUSS_WEIGHTS) {
                loads.fluid += interpolated(s) * stretch(s, self.layers[0].tissue.consistent) * w;
            }
            if let Some(rough) = rough {
                for (a, share) in SIMPSON.into_iter().enumerate() {
                    let (s, i) = (a as f64 - 1.0, first + a);
                    let gap = (at.gap(self, i), self.gap_change(change, i));
                    let weight = stretch(s, true) * (2.0 * share);
                    let solid = chain(rough.pressure(gap.0), gap.1) * weight;
                    let fluid = interpolated(s) * weight;
                    let share = chain(rough.real_contact_share(gap.0), gap.1);
                    loads.solid += solid;
                    loads.fluid_in_contact += share * fluid;
                    loads.in_real_contact += share * (solid + fluid);
                }
            }
        }
        if rough.is_none() {
            let forces = at.contact_forces.iter().zip(&change.contact_forces).zip(at.active);
            loads.solid = forces.filter(|(_, active)| **active).map(|((f, df), _)| Dual64::new(*f, *df)).sum();
        }
        loads
    }
}

impl System {
    /// What the film beyond the ends of the sector adds to the two parts of the friction forces, see [`crate::laws::film::wall_shear`].
    pub fn film_end_shear(&self, at: At<'_>, change: &Change) -> Vec<[Dual64; 2]> {
        let last = self.stations.len() - 1;
        let levels = self.layers[0].mesh.levels();
        let speeds = surface_speeds(at.inputs).into_iter().zip(change.inputs.surface_speeds(at.inputs));
        let speeds: Vec<_> = speeds.map(|(speed, change)| Dual64::new(speed, change)).collect();
        let ends = self.film_ends.iter().flatten().zip([0, last]).map(|(end, station)| {
            let value = |number: u32| Dual64::new(at.unknowns[number as usize], change.unknowns[number as usize]);
            end.shear(
                value(self.layout.gap[station]),
                value(self.layout.pressure[0][station * levels]),
                [speeds[0], speeds[1]],
            )
        });
        ends.collect()
    }
}
