//! A state of the equations: the unknowns and all that they belong to.

use serde::{Deserialize, Serialize};

use super::System;
use crate::fem::element::POINTS;
use crate::laws::contact::Mobilised;
use crate::parameters::{Control, Inputs};
use crate::solver::runge_kutta::Linear;

/// A state: a solution, the guess of one, or where a tangent was formed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// The inputs, with the depth that was found where the load is given.
    pub inputs: Inputs,
    /// Time derivatives; none of a steady state.
    pub rates: Option<Rates>,
    /// Whether the lower body is the mirror image of the upper one.
    pub mirrored: bool,
    /// What contact the mesh is made for, see [`crate::equations::grid::contact_half_width`] \[m\].
    pub contact_half_width: f64,
    /// How far the upper surface's nodes are shifted against the lower one's on that mesh, see [`crate::equations::grid::Grid::new`].
    pub shifts: Vec<f64>,
    /// How many times its own viscosity the fluid has, in film and pores: 1 but on the way to a state.
    pub thickening: f64,
    /// The unknowns.
    pub unknowns: Vec<f64>,
    /// Slip and friction of every column on the way to a solution; none at one, where friction is that of the law.
    pub mobilised: Vec<Mobilised>,
    /// Stations in contact.
    pub active: Vec<bool>,
    /// Force of contact at each station, zero where there is none \[N/m\].
    pub contact_forces: Vec<f64>,
}

impl State {
    /// A guess for these inputs. Where the load is given the depth stays, as a guess too.
    #[must_use]
    pub fn guess_for(self, inputs: &Inputs, control: Control) -> Self {
        let penetration_depth = match control {
            Control::Depth => inputs.penetration_depth,
            Control::Load => self.inputs.penetration_depth,
        };
        Self { inputs: Inputs { penetration_depth, ..*inputs }, ..self }
    }

    /// Whether any station is active.
    pub fn touches(&self) -> bool {
        self.active.contains(&true)
    }

    /// The unknowns, and then the depth.
    pub fn unknowns_and_depth(&self) -> Vec<f64> {
        [&self.unknowns[..], &[self.inputs.penetration_depth]].concat()
    }

    /// Distance of the surfaces at a station \[m\].
    pub fn gap(&self, system: &System, station: usize) -> f64 {
        self.unknowns[system.layout.gap[station] as usize]
    }
}

/// A solved state with its equations, which are on its mesh.
#[derive(Debug, Clone, Copy)]
pub struct Solved<'a> {
    /// The equations.
    pub system: &'a System,
    /// The solution.
    pub state: &'a State,
}

/// Time derivatives by a difference formula, d/dt = rate * present value + history, seen from a mesh that may move; steady has none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rates {
    /// Factor of the present value \[1/s\].
    pub rate: f64,
    /// The rest of the derivatives of what is stored.
    pub history: StoredVolumes,
}

/// What time derivatives are taken of, at the quadrature points.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct StoredVolumes {
    /// Change of volume (J - 1) dA in every element of every body \[m^2\].
    pub volume: Vec<Vec<[f64; POINTS]>>,
    /// Fluid r h of the film times the length of its element \[m^2\].
    pub film: Vec<[f64; 3]>,
    /// x of the surface nodes of every undeformed body, whose rates are the speed of its mesh \[m\].
    pub stations: Vec<Vec<f64>>,
    /// Mean x of the deformed surface of every body over every column, for the speeds at which surfaces rub on each other \[m\].
    pub places: Vec<Vec<f64>>,
}

impl Linear for StoredVolumes {
    fn combined(&self, a: f64, b: f64, other: &Self) -> Self {
        let mix = |x: f64, y: f64| a * x + b * y;
        let mix_all = |x: &[Vec<f64>], y: &[Vec<f64>]| {
            x.iter().zip(y).map(|(x, y)| x.iter().zip(y).map(|(x, y)| mix(*x, *y)).collect()).collect()
        };
        Self {
            volume: self
                .volume
                .iter()
                .zip(&other.volume)
                .map(|(x, y)| x.iter().zip(y).map(|(x, y)| std::array::from_fn(|q| mix(x[q], y[q]))).collect())
                .collect(),
            film: self.film.iter().zip(&other.film).map(|(x, y)| std::array::from_fn(|q| mix(x[q], y[q]))).collect(),
            stations: mix_all(&self.stations, &other.stations),
            places: mix_all(&self.places, &other.places),
        }
    }
}

impl Rates {
    /// Derivatives that are known already.
    pub fn known(derivatives: StoredVolumes) -> Self {
        Self { rate: 0.0, history: derivatives }
    }

    /// d/dt of these stored volumes.
    pub fn of(&self, stored_volumes: &StoredVolumes) -> StoredVolumes {
        self.history.combined(1.0, self.rate, stored_volumes)
    }

    /// d/dt = (present - before) / step.
    pub fn backward_euler(step: f64, before: &StoredVolumes) -> Self {
        Self { rate: 1.0 / step, history: before.scaled(-1.0 / step) }
    }
}

impl System {
    /// Whether shifts are those of a mesh with as many columns.
    pub fn admits_shifts(&self, shifts: &[f64]) -> bool {
        (shifts.is_empty() || shifts.len() == self.layers[0].mesh.columns + 1)
            && shifts.iter().all(|shift| shift.is_finite())
    }

    /// Whether a state is one of these equations, on any mesh.
    pub fn admits(&self, state: &State) -> bool {
        let stations = self.stations.len();
        let stored = |volumes: &StoredVolumes| {
            [(&volumes.stations, stations), (&volumes.places, stations / 2)]
                .into_iter()
                .all(|(x, length)| x.len() == self.layers.len() && x.iter().all(|x| x.len() == length))
                && volumes.film.len() == (stations - 1) / 2
                && volumes.volume.iter().map(Vec::len).eq(self.layers.iter().map(|layer| layer.mesh.elements()))
        };
        state.mirrored == self.mirrored()
            && state.contact_half_width.is_finite()
            && state.contact_half_width >= 0.0
            && self.admits_shifts(&state.shifts)
            && state.unknowns.len() == self.unknowns()
            && (state.mobilised.is_empty() || state.mobilised.len() == stations / 2)
            && state.active.len() == stations
            && state.contact_forces.len() == stations
            && state.rates.as_ref().is_none_or(|rates| stored(&rates.history))
    }
}
