//! The surfaces' vertical displacements in terms of the unknowns of the interface: u_y = mean + side/2 (gap - gap of the undeformed
//! surfaces). A mirror-symmetric pair has no mean.
//!
//! A cell has the gaps of its three surface nodes where an element has their vertical displacements, and the means behind its local
//! unknowns.

use crate::fem::assembly::LOCAL;
use crate::fem::element::NODES;

/// The surface of a body on this side of the film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    half: f64,
    mean: bool,
}

impl Surface {
    /// `side` is 1 for the upper body and -1 for the lower one; `mean` whether there is one among the unknowns.
    pub fn new(side: f64, mean: bool) -> Self {
        Self { half: 0.5 * side, mean }
    }

    /// u_y for a mean and an opening, gap less gap of the undeformed surfaces.
    pub fn displacement(&self, mean: f64, opening: f64) -> f64 {
        mean + self.half * opening
    }

    /// What a vertical force on a node adds to the equations of the gap and of the mean.
    pub fn force(&self, force: f64) -> [f64; 2] {
        [self.half * force, force]
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
