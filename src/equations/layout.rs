//! Which unknown stands where: numbering, and the cells that the linear solver eliminates.
//!
//! On the interface both bodies share the pressure, and their vertical displacements are written as
//! u_y = mean + side/2 (gap + rise - gap of the undeformed surfaces), so that the gap itself is an unknown. A mirror-symmetric pair has
//! one body and no mean; what the rise is says [`crate::equations::facing`].

use crate::fem::element::NODES;
use crate::fem::mesh::LayerMesh;
use crate::solver::linear::{Cluster, FIXED};

/// What an unknown measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// A displacement \[m\].
    Displacement,
    /// The distance of the two surfaces \[m\].
    Gap,
    /// A pressure \[Pa\].
    Pressure,
    /// How much of a gap is void \[m\].
    Void,
}

/// Numbers of the unknowns; [`FIXED`] where there is none.
#[derive(Debug)]
pub struct Layout {
    /// What each unknown measures.
    pub quantities: Vec<Quantity>,
    /// Gap at each station.
    pub gap: Vec<u32>,
    /// Mean vertical displacement of the two surfaces at each station; none for a mirror-symmetric pair.
    pub mean: Vec<u32>,
    /// Rise at each station, see [`crate::equations::facing`]; none where surfaces face each other as they do undeformed.
    pub rise: Vec<u32>,
    /// Horizontal displacement of each node of each body.
    pub horizontal: Vec<Vec<u32>>,
    /// Vertical displacement of each node of each body; on the surface [`FIXED`], see `gap` and `mean`.
    pub vertical: Vec<Vec<u32>>,
    /// Pressure of each node of each body; the same number for both on the surface.
    pub pressure: Vec<Vec<u32>>,
    /// Void at each station; [`FIXED`] where there is no pressure or the film cannot cavitate.
    pub void: Vec<u32>,
    /// Unknowns of each cell, see [`Layout::cell`].
    pub cells: Vec<Vec<u32>>,
    /// In how many cells the gap of each station appears.
    pub gap_multiplicity: Vec<f64>,
    rows: usize,
}

impl Layout {
    /// Numbers the unknowns of one or two layers with the same columns and rows, and of a film that may cavitate or not. With
    /// `open_ends` the ends of the layers have a pressure of their own, and those of the film too unless it may cavitate; with `rises` there
    /// is a rise at every station.
    pub fn new(meshes: &[&LayerMesh], cavitates: bool, open_ends: bool, rises: bool) -> Self {
        let (columns, rows, levels) = (meshes[0].columns, meshes[0].rows, meshes[0].levels());
        let stations = 2 * columns + 1;
        let nodes = stations * levels;
        let bodies = meshes.len();
        let order = meshes[0].pressure_order;
        let mut quantities = Vec::new();
        let mut new = |quantity| {
            quantities.push(quantity);
            (quantities.len() - 1) as u32
        };
        let has_pressure = |i: usize, j: usize| {
            let inside = i > 0 && i + 1 < stations;
            (inside || (open_ends && (j > 0 || !cavitates)))
                && (order == 2 || (i.is_multiple_of(2) && j.is_multiple_of(2)))
        };
        let mut gap = Vec::new();
        let mut mean = Vec::new();
        let mut rise = Vec::new();
        let mut void = Vec::new();
        let mut horizontal = vec![vec![FIXED; nodes]; bodies];
        let mut vertical = horizontal.clone();
        let mut pressure = horizontal.clone();
        for i in 0..stations {
            gap.push(new(Quantity::Gap));
            if bodies == 2 {
                mean.push(new(Quantity::Displacement));
            }
            if rises {
                rise.push(new(Quantity::Displacement));
            }
            let shared = if has_pressure(i, 0) { new(Quantity::Pressure) } else { FIXED };
            void.push(if cavitates && shared != FIXED { new(Quantity::Void) } else { FIXED });
            for body in 0..bodies {
                for j in 0..levels {
                    let node = i * levels + j;
                    if j + 1 < levels {
                        horizontal[body][node] = new(Quantity::Displacement);
                    }
                    if j > 0 && j + 1 < levels {
                        vertical[body][node] = new(Quantity::Displacement);
                    }
                    pressure[body][node] = match j {
                        0 => shared,
                        _ if has_pressure(i, j) => new(Quantity::Pressure),
                        _ => FIXED,
                    };
                }
            }
        }
        let mut layout = Self {
            quantities,
            gap,
            mean,
            rise,
            horizontal,
            vertical,
            pressure,
            void,
            cells: Vec::new(),
            gap_multiplicity: vec![0.0; stations],
            rows,
        };
        for cell in 0..columns * rows * bodies {
            let (body, element) = layout.body_and_element(cell);
            let column = element / rows;
            let element_nodes = meshes[body].element_nodes(element);
            let at = |numbers: &[u32]| element_nodes.map(|n| numbers[n]);
            let mut unknowns =
                [at(&layout.horizontal[body]), at(&layout.vertical[body]), at(&layout.pressure[body])].concat();
            if element % rows == 0 {
                for a in 0..3 {
                    let station = 2 * column + a;
                    unknowns[NODES + a] = layout.gap[station];
                    layout.gap_multiplicity[station] += 1.0;
                }
                if bodies == 2 {
                    unknowns.extend_from_slice(&layout.mean[2 * column..2 * column + 3]);
                    unknowns.extend((0..3).map(|a| layout.horizontal[1 - body][element_nodes[a]]));
                }
                if rises {
                    unknowns.extend_from_slice(&layout.rise[2 * column..2 * column + 3]);
                }
                // With both bodies, as the pressures are, so that both are eliminated together.
                if cavitates {
                    unknowns.extend_from_slice(&layout.void[2 * column..2 * column + 3]);
                }
            }
            layout.cells.push(unknowns);
        }
        layout
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.quantities.len()
    }

    fn bodies(&self) -> usize {
        self.horizontal.len()
    }

    /// The body and the element that a cell holds. Cells count the rows of both bodies from bone to bone.
    pub fn body_and_element(&self, cell: usize) -> (usize, usize) {
        if self.bodies() == 1 {
            return (0, cell);
        }
        let (column, row) = (cell / (2 * self.rows), cell % (2 * self.rows));
        if row < self.rows {
            (0, column * self.rows + self.rows - 1 - row)
        } else {
            (1, column * self.rows + row - self.rows)
        }
    }

    /// The cell that holds an element of a body.
    pub fn cell(&self, body: usize, element: usize) -> usize {
        let (column, row) = (element / self.rows, element % self.rows);
        match (self.bodies(), body) {
            (1, _) => element,
            (_, 0) => column * 2 * self.rows + self.rows - 1 - row,
            _ => column * 2 * self.rows + self.rows + row,
        }
    }

    /// The order of elimination.
    pub fn clusters(&self) -> Cluster {
        let rows = self.rows * self.bodies();
        Cluster::strip(self.cells.len() / rows, rows)
    }
}
