//! Sums over the tissue: where the work goes, per unit depth, and the largest stress.
//!
//! Of the consistent formulation the weak forms, tested with the velocities of the tissue and with the pressure, add up to
//!
//! ```text
//! bones: rotation + approach = d(stored)/dt + pores + film + boundary friction + carried
//! stored    int W                          elastic energy of the solid
//! pores     int grad p . K grad p          Darcy flow
//! film      int h^3 p'^2/(12 eta) + eta (U1 - U2)^2/h
//! carried   int_ends W v.n - int_inlets alpha r p (J - 1) v.n + sum e p (Q - U h/2)   what moves out of the sector,
//!           and what the film beyond it takes from sliding bodies of different curvature
//! ```
//!
//! up to the size of the elements. Boundary friction is int t (v1 - v2) with the speeds of the stretched tissue, and each bone works against the
//! reaction of its own. The paper's formulation balances another stress on the surface than in the tissue: there the terms
//! do not add up.

use num_dual::{Dual64, DualNum};

use crate::equations::system::{Change, Solved};
use crate::equations::tissue::Tissue;
use crate::fem::element::NODES;
use crate::laws::kinematics::{Strain, flatten};
use nalgebra::{Matrix2, Vector2};

/// Energy, powers and stress of the tissue.
pub(super) struct TissueResults {
    /// Elastic energy of the solid \[J/m\].
    pub stored: Dual64,
    /// Dissipated by flow through the pores \[W/m\].
    pub pores: Dual64,
    /// What moving tissue takes out of the sector \[W/m\].
    pub carried: Dual64,
    /// Largest von Mises stress at the quadrature points \[Pa\].
    pub von_mises: Dual64,
}

impl Solved<'_> {
    /// Of both bodies, at these surface speeds.
    pub(super) fn tissue_results(&self, change: &Change, speeds: [Dual64; 2]) -> TissueResults {
        let system = self.system;
        let depth = self.state.inputs.penetration_depth;
        let zero = Dual64::from(0.0);
        let mut sum = TissueResults { stored: zero, pores: zero, carried: zero, von_mises: zero };
        // Most results are asked for without derivatives.
        let still = change.is_none();
        let mut largest = (0.0, 0, 0, 0);
        let copies = system.copies();
        for (body, (layer, speed)) in system.layers.iter().zip(speeds).enumerate() {
            let Tissue { biot_coefficient, fluid_compressibility, consistent, .. } = layer.tissue;
            for element in 0..layer.mesh.elements() {
                let at = system.local(body, element, &self.state.unknowns, depth);
                let local = system.local_change(body, element, &change.unknowns, change.inputs.penetration_depth);
                for (q, point) in layer.mesh.points(element).iter().enumerate() {
                    let strain = Tissue::strain(&layer.mesh, element, q, &at);
                    let tissue = layer.tissue.at_point(&layer.mesh, element, q);
                    let solid = &tissue.solid;
                    let stress = solid.von_mises(&strain);
                    if stress > largest.0 {
                        largest = (stress, body, element, q);
                    }
                    let weight = copies * point.weight;
                    sum.stored += solid.energy(&strain) * weight;

                    let gradients = layer.mesh.pressure_gradients(element, q);
                    let slope = |values: &[f64]| {
                        let sum = |g: &[f64; NODES]| g.iter().zip(&values[2 * NODES..]).map(|(g, p)| g * p).sum();
                        Vector2::new(sum(&gradients[0]), sum(&gradients[1]))
                    };
                    let gradient = slope(&at);
                    let direction = Vector2::from(point.velocity);
                    let (mobility, mobility_by_volume) = tissue.mobility_at(&strain, &direction);
                    let flux = mobility.conductance(&strain, consistent) * gradient;
                    let power = flux.dot(&gradient);
                    sum.pores += power * weight;
                    if still {
                        continue;
                    }
                    let along = Tissue::strain(&layer.mesh, element, q, &local).gradient;
                    sum.stored.eps += solid.stress(&strain).dot(&along) * weight;
                    let volume = strain.cofactor.dot(&along);
                    let mut power_change = 2.0 * flux.dot(&slope(&local)) + power * mobility_by_volume * volume;
                    if consistent {
                        let derivative = mobility.conductance_derivative(&strain, &gradient) * flatten(&along);
                        power_change += gradient.dot(&derivative);
                    }
                    sum.pores.eps += power_change * weight;
                }
                for (q, end) in layer.mesh.end_points(element).enumerate() {
                    // The depths of an end's points are those of the element's rows of points.
                    let solid = layer.tissue.at_depth(layer.mesh.point_depth(element, 3 * (q % 3))).solid;
                    let dot = |f: &[f64; NODES], values: &[f64]| f.iter().zip(values).map(|(a, b)| a * b).sum::<f64>();
                    let gradient = |values: &[f64]| {
                        let [gx, gy] = &end.gradients;
                        let (ux, uy) = (&values[..NODES], &values[NODES..2 * NODES]);
                        Matrix2::new(dot(gx, ux), dot(gy, ux), dot(gx, uy), dot(gy, uy))
                    };
                    let (strain, along) = (Strain::new(gradient(&at)), gradient(&local));
                    let mut energy = Dual64::new(solid.energy(&strain), solid.stress(&strain).dot(&along));
                    if end.outflow * speed.re < 0.0 {
                        let [pressure, change] = [&at, &local].map(|f| dot(&end.pressure_shape, &f[2 * NODES..]));
                        let pressure = Dual64::new(pressure, change);
                        let volume = Dual64::new(strain.volume_change, strain.cofactor.dot(&along));
                        energy -= pressure * volume * (pressure * fluid_compressibility).exp() * biot_coefficient;
                    }
                    sum.carried += energy * speed * (copies * end.outflow);
                }
            }
        }
        let (stress, body, element, point) = largest;
        let layer = &system.layers[body];
        let strain =
            Tissue::strain(&layer.mesh, element, point, &system.local(body, element, &self.state.unknowns, depth));
        let local = system.local_change(body, element, &change.unknowns, change.inputs.penetration_depth);
        let along = Tissue::strain(&layer.mesh, element, point, &local).gradient;
        let solid = &layer.tissue.at_point(&layer.mesh, element, point).solid;
        sum.von_mises = Dual64::new(stress, solid.von_mises_derivative(&strain, &along));
        sum
    }
}
