//! The surfaces' vertical displacements in terms of the unknowns of the interface: u_y = mean + part (gap - gap of the undeformed
//! surfaces), with a part of 1/2 above and -1/2 below. A mirror-symmetric pair has no mean, nor has a body against a rigid counterface.
//!
//! A cell has the gaps of its three surface nodes where an element has their vertical displacements, and the means behind its local
//! unknowns.

use crate::fem::assembly::LOCAL;
use crate::fem::element::NODES;

/// The surface of a body on this side of the film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    part: f64,
    mean: bool,
}

impl Surface {
    /// `part` is what the body takes of an opening, with its sign along y: 1/2 above and -1/2 below the film, 1 against a rigid counterface;
    /// `mean` whether there is one among the unknowns.
    pub fn new(part: f64, mean: bool) -> Self {
        Self { part, mean }
    }

    /// u_y for a mean and an opening, gap less gap of the undeformed surfaces.
    pub fn displacement(&self, mean: f64, opening: f64) -> f64 {
        mean + self.part * opening
    }

    /// What a vertical force on a node adds to the equations of the gap and of the mean.
    pub fn force(&self, force: f64) -> [f64; 2] {
        [self.part * force, force]
    }

    /// Columns of an element's matrix with `m` rows, from vertical displacements to gaps and means.
    pub fn transform_columns(&self, matrix: &mut [f64], m: usize) {
        for a in 0..3 {
            for i in 0..LOCAL {
                let [gap, mean] = self.force(matrix[(NODES + a) * m + i]);
                matrix[(NODES + a) * m + i] = gap;
                if self.mean {
                    matrix[(LOCAL + a) * m + i] = mean;
                }
            }
        }
    }

    /// Rows likewise, of one column.
    pub fn transform_rows(&self, column: &mut [f64]) {
        for a in 0..3 {
            let [gap, mean] = self.force(column[NODES + a]);
            column[NODES + a] = gap;
            if self.mean {
                column[LOCAL + a] = mean;
            }
        }
    }
}
