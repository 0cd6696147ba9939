//! Where tissue enters and leaves the modelled sector (consistent formulation).
//!
//! The convective term is integrated by parts, so that with the pressure free on an end its flux there is said by
//!
//! int_ends alpha r (J - 1) max(U v_rot . n, 0) w
//!
//! Tissue that leaves takes its volume change along and no more fluid seeps through the end. Where tissue enters, nothing flows
//! but what fresh, unstrained tissue (J = 1) brings: the seepage makes up for the difference (Danckwerts' condition). At rest both
//! ends are sealed.

use crate::equations::tissue::{ElementTerms, LOCAL, Local, Tissue};
use crate::fem::element::NODES;
use crate::fem::mesh::LayerMesh;
use crate::laws::fluid::relative_density;
use crate::laws::kinematics::Strain;
use nalgebra::Matrix2;

/// Adds the terms of those edges of an element that lie on an end of the layer, at these surface speeds relative to the mesh at the
/// left and the right edge \[m/s\].
pub fn ends(tissue: &Tissue, mesh: &LayerMesh, element: usize, at: &Local, speeds: [f64; 2], terms: ElementTerms<'_>) {
    let ElementTerms { mut residual, mut by_speed, mut tangent } = terms;
    for point in mesh.end_points(element) {
        let speed = speeds[usize::from(point.outflow > 0.0)];
        if point.outflow * speed <= 0.0 {
            continue;
        }
        let [gx, gy] = &point.gradients;
        let sum = |shape: &[f64; NODES], first: usize| -> f64 { (0..NODES).map(|a| shape[a] * at[first + a]).sum() };
        let strain = Strain::new(Matrix2::new(sum(gx, 0), sum(gy, 0), sum(gx, NODES), sum(gy, NODES)));
        let density = relative_density(tissue.fluid_compressibility, sum(&point.pressure_shape, 2 * NODES));
        let carried = tissue.biot_coefficient * density * point.outflow;
        for (a, test) in point.pressure_shape.into_iter().enumerate() {
            let row = 2 * NODES + a;
            if let Some(residual) = &mut residual {
                residual[row] += carried * speed * strain.volume_change * test;
            }
            if let Some(by_speed) = &mut by_speed {
                by_speed[row] += carried * strain.volume_change * test;
            }
            if let Some(tangent) = &mut tangent {
                let (c, factor) = (&strain.cofactor, carried * speed * test);
                for b in 0..NODES {
                    tangent[b * LOCAL + row] += factor * (c.m11 * gx[b] + c.m12 * gy[b]);
                    tangent[(NODES + b) * LOCAL + row] += factor * (c.m21 * gx[b] + c.m22 * gy[b]);
                    tangent[(2 * NODES + b) * LOCAL + row] +=
                        factor * strain.volume_change * tissue.fluid_compressibility * point.pressure_shape[b];
                }
            }
        }
    }
}
