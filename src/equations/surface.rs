//! The surfaces' vertical displacements in terms of the unknowns of the interface: u_y = mean + part (gap + rise - gap of the undeformed
//! surfaces), with a part of 1/2 above and -1/2 below. A mirror-symmetric pair has no mean, nor has a body against a rigid counterface.
//! Gaps are thicknesses of the film, across the arc on which it lies: where that is inclined a gap takes more along y, by one over the cosine.
//!
//! A cell has the gaps of its three surface nodes where an element has their vertical displacements, and behind its local unknowns the
//! means, the horizontal displacements of the other body, and the rises.

use crate::fem::assembly::LOCAL;
use crate::fem::element::NODES;

/// Where a cell has the rises.
pub const RISE: usize = LOCAL + 6;

/// The surface of a body on this side of the film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    parts: [f64; 3],
    mean: bool,
    rise: bool,
}

impl Surface {
    /// `parts` is what the body takes of an opening at the three nodes, with its sign along y: 1/2 above and -1/2 below the film, 1 against a
    /// rigid counterface, over the cosine of the film's inclination; `mean` and `rise` whether there are such unknowns.
    pub fn new(parts: [f64; 3], mean: bool, rise: bool) -> Self {
        Self { parts, mean, rise }
    }

    /// What a vertical force on a node of the three adds to the equations of the gap and of the mean. That of the rise says what it is.
    fn force(&self, a: usize, force: f64) -> [f64; 2] {
        [self.parts[a] * force, force]
    }

    /// Columns of an element's matrix with `m` rows, from vertical displacements to gaps and means.
    pub fn transform_columns(&self, matrix: &mut [f64], m: usize) {
        for a in 0..3 {
            for i in 0..LOCAL {
                let [gap, mean] = self.force(a, matrix[(NODES + a) * m + i]);
                matrix[(NODES + a) * m + i] = gap;
                if self.mean {
                    matrix[(LOCAL + a) * m + i] = mean;
                }
                if self.rise {
                    matrix[(RISE + a) * m + i] = gap;
                }
            }
        }
    }

    /// Rows likewise, of one column.
    pub fn transform_rows(&self, column: &mut [f64]) {
        for a in 0..3 {
            let [gap, mean] = self.force(a, column[NODES + a]);
            column[NODES + a] = gap;
            if self.mean {
                column[LOCAL + a] = mean;
            }
        }
    }
}
