//! The film between the bodies, on one element of the interface.
//!
//! One equation serves both faces; the fluxes out of the two bodies cancel, because bodies and film share the pressure and its
//! test function w (divided by the density at ambient pressure, r = exp(chi p)):
//!
//! int -r Q w' + d(r h)/dt w dx,   Q = -h^3/(12 eta) p' + U h/2
//!
//! Where h = 0 nothing is left of it, and the fluid crosses from body to body: the paper's periodic condition.

use crate::fem::element::{GAUSS, GAUSS_WEIGHTS, pressure, pressure_derivative, quadratic};
use crate::laws::film::reynolds_flux;

/// Gaps and pressures at the three nodes of an interface element.
pub type Local = [f64; 6];

/// The lubricant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Film {
    /// Dynamic viscosity [Pa s].
    pub viscosity: f64,
    /// Compressibility chi [1/Pa].
    pub fluid_compressibility: f64,
    /// Order of the pressure's shape functions.
    pub pressure_order: i32,
}

/// How fast the film's mass changes: d(r h)/dt = rate * r h + history; steady is zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MassRate {
    /// Factor of r h [1/s].
    pub rate: f64,
    /// The rest of the difference formula, at each quadrature point [m/s].
    pub history: [f64; 3],
}

/// Residual of the three pressure equations with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Terms {
    /// Residual [m^2/s].
    pub residual: [f64; 3],
    /// By gaps and pressures.
    pub tangent: [[f64; 6]; 3],
    /// By the sliding speed.
    pub by_speed: [f64; 3],
}

impl Film {
    /// Fluid r h at the quadrature points of an element [m]. Beside a node in contact an interpolated gap may be a little below zero;
    /// it counts as it is, so that what is stored is linear in the gaps of the nodes, and has no kink where they close.
    pub fn mass(&self, at: &Local) -> [f64; 3] {
        GAUSS.map(|s| {
            let sum = |f: [f64; 3], v: &[f64]| f[0] * v[0] + f[1] * v[1] + f[2] * v[2];
            sum(quadratic(s), &at[..3])
                * (self.fluid_compressibility * sum(pressure(self.pressure_order, s), &at[3..])).exp()
        })
    }

    /// How [`Film::mass`] changes with gaps and pressures.
    pub fn mass_change(&self, at: &Local, change: &Local) -> [f64; 3] {
        GAUSS.map(|s| {
            let sum = |f: [f64; 3], v: &[f64]| f[0] * v[0] + f[1] * v[1] + f[2] * v[2];
            let value = pressure(self.pressure_order, s);
            let gap = sum(quadratic(s), &at[..3]);
            let density = (self.fluid_compressibility * sum(value, &at[3..])).exp();
            let denser = self.fluid_compressibility * sum(value, &change[3..]);
            density * (sum(quadratic(s), &change[..3]) + gap * denser)
        })
    }

    /// Residual of the three pressure equations for d(r h)/dt alone, given at the quadrature points [m/s].
    pub fn storage(&self, length: f64, rate: &[f64; 3]) -> [f64; 3] {
        let mut residual = [0.0; 3];
        for ((s, w), rate) in GAUSS.into_iter().zip(GAUSS_WEIGHTS).zip(rate) {
            for (r, value) in residual.iter_mut().zip(pressure(self.pressure_order, s)) {
                *r += 0.5 * length * w * rate * value;
            }
        }
        residual
    }

    /// The terms of an element of this length [m].
    pub fn element(&self, length: f64, at: &Local, sliding_speed: f64, mass_rate: &MassRate) -> Terms {
        let mut terms = Terms::default();
        for (q, (s, w)) in GAUSS.into_iter().zip(GAUSS_WEIGHTS).enumerate() {
            let shape = quadratic(s);
            let value = pressure(self.pressure_order, s);
            let slope = pressure_derivative(self.pressure_order, s).map(|d| d * 2.0 / length);
            let sum = |f: &[f64; 3], v: &[f64]| f[0] * v[0] + f[1] * v[1] + f[2] * v[2];
            let gap = sum(&shape, &at[..3]);
            let density = (self.fluid_compressibility * sum(&value, &at[3..])).exp();
            let flux = reynolds_flux(gap, sum(&slope, &at[3..]), sliding_speed, self.viscosity);
            let weight = 0.5 * length * w * density;
            let storage = mass_rate.rate * gap + mass_rate.history[q] / density;
            for a in 0..3 {
                terms.residual[a] += weight * (-flux.value * slope[a] + storage * value[a]);
                terms.by_speed[a] -= weight * flux.by_sliding_speed * slope[a];
                for b in 0..3 {
                    terms.tangent[a][b] +=
                        weight * (-flux.by_film_thickness * slope[a] + mass_rate.rate * value[a]) * shape[b];
                    let chi = self.fluid_compressibility * value[b];
                    terms.tangent[a][3 + b] += weight
                        * (-(flux.by_pressure_gradient * slope[b] + flux.value * chi) * slope[a]
                            + mass_rate.rate * gap * chi * value[a]);
                }
            }
        }
        terms
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn tangent_is_the_derivative_of_the_residual(
            gaps in prop::array::uniform3(0.5..2.0f64), pressures in prop::array::uniform3(-1.0..1.0f64),
            direction in prop::array::uniform6(-1.0..1.0f64), order in 1..3_i32,
        ) {
            let film = Film { viscosity: 1e-3, fluid_compressibility: 1e-7, pressure_order: order };
            let scale = |v: [f64; 6]| -> Local { std::array::from_fn(|i| v[i] * if i < 3 { 1e-6 } else { 1e5 }) };
            let at = scale([gaps[0], gaps[1], gaps[2], pressures[0], pressures[1], pressures[2]]);
            let change = scale(direction);
            let rate = MassRate { rate: 5.0, history: [1e-6, -2e-6, 3e-6] };
            let residual = |s: f64, u: f64| {
                let z: Local = std::array::from_fn(|i| at[i] + s * change[i]);
                film.element(1e-4, &z, u, &rate).residual
            };
            let terms = film.element(1e-4, &at, 0.2, &rate);
            let (plus, minus) = (residual(1e-5, 0.2), residual(-1e-5, 0.2));
            let linear: [f64; 3] = std::array::from_fn(|a| (0..6).map(|b| terms.tangent[a][b] * change[b]).sum());
            let size = linear.iter().fold(1e-12, |m: f64, v| m.max(v.abs()));
            for a in 0..3 {
                prop_assert!(((plus[a] - minus[a]) / 2e-5 - linear[a]).abs() < 1e-7 * size);
                let by_speed = residual(0.0, 1.2)[a] - residual(0.0, 0.2)[a];
                prop_assert!((by_speed - terms.by_speed[a]).abs() < 1e-9 * terms.by_speed[a].abs() + 1e-22);
            }
        }
    }
}
