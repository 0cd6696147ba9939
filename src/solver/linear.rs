//! Direct solution of the linear systems: a multifrontal LU on a tree of cells, on faer's dense kernels.
//!
//! The matrix is given as dense matrices of cells (finite elements) that overlap in their unknowns. A tree of clusters of
//! cells says in which order to eliminate: an unknown is eliminated in the smallest cluster that holds all its cells. For a
//! long strip of elements the tree comes from [`Cluster::strip`]. Everything but the numbers is worked out once, in
//! [`Multifrontal::new`].

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place};
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, Par, Spec};

/// Unknown that is not solved for: its rows and columns are dropped.
pub const FIXED: u32 = u32::MAX;

/// A set of cells that is eliminated together, after its parts.
#[derive(Debug, Clone)]
pub enum Cluster {
    /// One cell.
    Cell(usize),
    /// The union of smaller clusters.
    Union(Vec<Cluster>),
}

impl Cluster {
    /// Nested dissection of a strip of `columns` x `rows` cells, cell (column, row) having index `column * rows + row`: blocks
    /// about as long as high are bisected in turn; the blocks themselves are eliminated one after the other from the two ends
    /// towards the middle, where a block has only one open side.
    pub fn strip(columns: usize, rows: usize) -> Self {
        let blocks = (columns / rows.max(1)).max(1);
        let block = |b: usize| Self::bisect([b * columns / blocks, (b + 1) * columns / blocks], [0, rows], rows);
        let chain = |order: &mut dyn Iterator<Item = usize>| {
            order.map(block).reduce(|done, next| Self::Union(vec![done, next]))
        };
        let middle = blocks / 2;
        let halves = [chain(&mut (0..middle)), chain(&mut (middle..blocks).rev())];
        Self::Union(halves.into_iter().flatten().collect())
    }

    fn bisect(columns: [usize; 2], rows: [usize; 2], height: usize) -> Self {
        let (wide, high) = (columns[1] - columns[0], rows[1] - rows[0]);
        if wide * high == 1 {
            return Self::Cell(columns[0] * height + rows[0]);
        }
        let halves = if wide >= high {
            let middle = columns[0] + wide / 2;
            [([columns[0], middle], rows), ([middle, columns[1]], rows)]
        } else {
            let middle = rows[0] + high / 2;
            [(columns, [rows[0], middle]), (columns, [middle, rows[1]])]
        };
        Self::Union(halves.map(|(c, r)| Self::bisect(c, r, height)).into())
    }
}

/// The numbers were such that elimination cannot go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the linear system is singular")]
pub struct Singular;

/// One step of the elimination: a dense matrix over `eliminated` unknowns followed by `boundary` ones.
#[derive(Debug)]
struct Front {
    /// First of its eliminated unknowns, in elimination order.
    start: usize,
    eliminated: usize,
    /// The other unknowns, in elimination order, ascending.
    boundary: Vec<u32>,
    /// Fronts below, with the positions of their boundaries in this front.
    children: Vec<(usize, Vec<u32>)>,
    /// The cell, with the positions of its unknowns in this front.
    cell: Option<(usize, Vec<u32>)>,
    /// Where its factors are kept.
    offset: usize,
}

impl Front {
    fn size(&self) -> usize {
        self.eliminated + self.boundary.len()
    }

    /// Length of its factors: the eliminated columns, then the eliminated rows of the other columns.
    fn length(&self) -> usize {
        self.eliminated * (self.size() + self.boundary.len())
    }
}

/// A factorised sparse matrix, with room to factorise others of the same structure.
pub struct Multifrontal {
    fronts: Vec<Front>,
    /// Unknown -> position in elimination order.
    position: Vec<u32>,
    row_scale: Vec<f64>,
    column_scale: Vec<f64>,
    factors: Vec<f64>,
    pivots: Vec<u32>,
    largest_cell: usize,
}

impl std::fmt::Debug for Multifrontal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Multifrontal({} unknowns, {} factor entries)", self.position.len(), self.factors.len())
    }
}

impl Multifrontal {
    /// Works out the elimination of `row_scale.len()` unknowns for cells with these unknowns (or [`FIXED`]).
    ///
    /// Rows are multiplied by `row_scale` and columns by `column_scale` before elimination, so that pivots can be compared.
    pub fn new(cells: &[Vec<u32>], tree: &Cluster, row_scale: Vec<f64>, column_scale: Vec<f64>) -> Self {
        let unknowns = row_scale.len();
        let mut uses = vec![0_u32; unknowns];
        for dof in cells.iter().flatten().filter(|d| **d != FIXED) {
            uses[*dof as usize] += 1;
        }
        let mut symbolic = Symbolic { cells, uses, fronts: Vec::new(), order: Vec::new() };
        symbolic.visit(tree);
        let Symbolic { mut fronts, order, .. } = symbolic;
        let mut position = vec![0_u32; unknowns];
        for (i, dof) in order.iter().enumerate() {
            position[*dof as usize] = i as u32;
        }
        // From unknowns to positions in elimination order, then to positions in each front.
        let mut offset = 0;
        for index in 0..fronts.len() {
            let (below, rest) = fronts.split_at_mut(index);
            let front = &mut rest[0];
            for dof in &mut front.boundary {
                *dof = position[*dof as usize];
            }
            front.boundary.sort_unstable();
            front.offset = offset;
            offset += front.length();
            let (start, eliminated, boundary) = (front.start, front.eliminated, &front.boundary);
            let local = |p: u32| -> u32 {
                let p = p as usize;
                let found = if p < start + eliminated {
                    p - start
                } else {
                    eliminated + boundary.partition_point(|b| (*b as usize) < p)
                };
                found as u32
            };
            for (child, map) in &mut front.children {
                *map = below[*child].boundary.iter().map(|p| local(*p)).collect();
            }
            if let Some((cell, map)) = &mut front.cell {
                *map = cells[*cell]
                    .iter()
                    .map(|d| if *d == FIXED { FIXED } else { local(position[*d as usize]) })
                    .collect();
            }
        }
        let largest_cell = cells.iter().map(Vec::len).max().unwrap_or(0);
        Self {
            fronts,
            factors: vec![0.0; offset],
            pivots: vec![0; unknowns],
            position,
            row_scale,
            column_scale,
            largest_cell,
        }
    }

    /// A factorisation of nothing.
    pub fn empty() -> Self {
        Self::new(&[], &Cluster::Union(Vec::new()), Vec::new(), Vec::new())
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.position.len()
    }

    /// Entries that the factors hold.
    pub fn factor_entries(&self) -> usize {
        self.factors.len()
    }

    /// Factorises the sum of the cells' matrices.
    ///
    /// `fill(cell, matrix)` writes the cell's matrix, column by column, over its unknowns in the order given to [`Self::new`]; the
    /// matrix comes zeroed.
    ///
    /// # Errors
    /// [`Singular`] where a pivot is zero or not finite.
    pub fn factorise(&mut self, cells: &[Vec<u32>], fill: impl Fn(usize, &mut [f64]) + Sync) -> Result<(), Singular> {
        let mut updates: Vec<Vec<f64>> = vec![Vec::new(); self.fronts.len()];
        let mut cell_matrix = vec![0.0; self.largest_cell * self.largest_cell];
        let largest = self.fronts.iter().map(|f| f.eliminated).max().unwrap_or(0);
        let (mut permutation, mut inverse) = (vec![0_u32; largest], vec![0_u32; largest]);
        let mut memory = MemBuffer::new(lu_in_place_scratch::<u32, f64>(largest, largest, Par::Seq, Spec::default()));
        let mut column = vec![0.0; largest];
        for index in 0..self.fronts.len() {
            let front = &self.fronts[index];
            let (k, b, n) = (front.eliminated, front.boundary.len(), front.size());
            let factor = &mut self.factors[front.offset..front.offset + front.length()];
            factor.fill(0.0);
            let (left, top) = factor.split_at_mut(n * k);
            let mut update = vec![0.0; b * b];
            for (child, map) in &front.children {
                extend_add(&std::mem::take(&mut updates[*child]), map, left, top, &mut update, k, b);
            }
            if let Some((cell, map)) = &front.cell {
                let m = map.len();
                let matrix = &mut cell_matrix[..m * m];
                matrix.fill(0.0);
                fill(*cell, matrix);
                let dofs = &cells[*cell];
                for (j, c) in map.iter().enumerate().filter(|(_, c)| **c != FIXED) {
                    let c = *c as usize;
                    let scale = self.column_scale[dofs[j] as usize];
                    for (i, r) in map.iter().enumerate().filter(|(_, r)| **r != FIXED) {
                        let r = *r as usize;
                        let value = matrix[j * m + i] * scale * self.row_scale[dofs[i] as usize];
                        *entry(left, top, &mut update, r, c, k, b) += value;
                    }
                }
            }
            if k > 0 {
                let pivots = &mut self.pivots[front.start..front.start + k];
                let stack = MemStack::new(&mut memory);
                eliminate(
                    left,
                    top,
                    &mut update,
                    [k, b],
                    [&mut permutation, &mut inverse],
                    pivots,
                    stack,
                    &mut column,
                )?;
            }
            updates[index] = update;
        }
        Ok(())
    }

    /// Solves for `count` right-hand sides stored one after the other, in place.
    ///
    /// # Errors
    /// [`Singular`] where the answer is not finite; the right-hand sides are then garbage.
    pub fn solve(&self, right_hand_sides: &mut [f64]) -> Result<(), Singular> {
        let n = self.unknowns();
        let mut x = vec![0.0; n];
        for rhs in right_hand_sides.chunks_exact_mut(n) {
            for (dof, value) in rhs.iter().enumerate() {
                x[self.position[dof] as usize] = value * self.row_scale[dof];
            }
            self.substitute(&mut x);
            for (dof, value) in rhs.iter_mut().enumerate() {
                *value = x[self.position[dof] as usize] * self.column_scale[dof];
                if !value.is_finite() {
                    return Err(Singular);
                }
            }
        }
        Ok(())
    }

    fn substitute(&self, x: &mut [f64]) {
        let mut work = vec![0.0; self.fronts.iter().map(|f| f.size()).max().unwrap_or(0)];
        for front in &self.fronts {
            let (k, n) = (front.eliminated, front.size());
            let left = &self.factors[front.offset..front.offset + n * k];
            let pivots = &self.pivots[front.start..front.start + k];
            let work = &mut work[..n];
            for (w, p) in work.iter_mut().zip(pivots) {
                *w = x[front.start + *p as usize];
            }
            work[k..].fill(0.0);
            for j in 0..k {
                let y = work[j];
                if y != 0.0 {
                    let column = &left[j * n + j + 1..(j + 1) * n];
                    for (w, l) in work[j + 1..].iter_mut().zip(column) {
                        *w -= l * y;
                    }
                }
            }
            x[front.start..front.start + k].copy_from_slice(&work[..k]);
            for (b, w) in front.boundary.iter().zip(&work[k..]) {
                x[*b as usize] += w;
            }
        }
        for front in self.fronts.iter().rev() {
            let (k, n) = (front.eliminated, front.size());
            let (left, top) = self.factors[front.offset..front.offset + front.length()].split_at(n * k);
            let work = &mut work[..k];
            work.copy_from_slice(&x[front.start..front.start + k]);
            for (j, b) in front.boundary.iter().enumerate() {
                let value = x[*b as usize];
                for (w, t) in work.iter_mut().zip(&top[j * k..(j + 1) * k]) {
                    *w -= t * value;
                }
            }
            for j in (0..k).rev() {
                let column = &left[j * n..j * n + j + 1];
                let value = work[j] / column[j];
                work[j] = value;
                for (w, u) in work[..j].iter_mut().zip(column) {
                    *w -= u * value;
                }
            }
            x[front.start..front.start + k].copy_from_slice(work);
        }
    }
}

/// Entry (r, c) of a front that is stored in its three parts.
fn entry<'a>(
    left: &'a mut [f64],
    top: &'a mut [f64],
    update: &'a mut [f64],
    r: usize,
    c: usize,
    k: usize,
    b: usize,
) -> &'a mut f64 {
    if c < k {
        &mut left[c * (k + b) + r]
    } else if r < k {
        &mut top[(c - k) * k + r]
    } else {
        &mut update[(c - k) * b + r - k]
    }
}

/// Adds a child's update matrix to a front. Positions ascend, so those among the eliminated unknowns come first.
fn extend_add(child: &[f64], map: &[u32], left: &mut [f64], top: &mut [f64], update: &mut [f64], k: usize, b: usize) {
    let m = map.len();
    let split = map.partition_point(|p| (*p as usize) < k);
    for (column, c) in child.chunks_exact(m.max(1)).zip(map) {
        let c = *c as usize;
        if c < k {
            let target = &mut left[c * (k + b)..(c + 1) * (k + b)];
            for (value, r) in column.iter().zip(map) {
                target[*r as usize] += value;
            }
        } else {
            let target = &mut top[(c - k) * k..(c - k + 1) * k];
            for (value, r) in column.iter().zip(&map[..split]) {
                target[*r as usize] += value;
            }
            let target = &mut update[(c - k) * b..(c - k + 1) * b];
            for (value, r) in column[split..].iter().zip(&map[split..]) {
                target[*r as usize - k] += value;
            }
        }
    }
}

/// LU of the eliminated block with row pivoting inside it, the factors beside and below it, and the Schur complement.
#[allow(clippy::too_many_arguments)]
fn eliminate(
    left: &mut [f64],
    top: &mut [f64],
    update: &mut [f64],
    [k, b]: [usize; 2],
    [permutation, inverse]: [&mut Vec<u32>; 2],
    pivots: &mut [u32],
    stack: &mut MemStack,
    column: &mut [f64],
) -> Result<(), Singular> {
    let n = k + b;
    let left = MatMut::from_column_major_slice_mut(left, n, k);
    let (mut block, mut below) = left.split_at_row_mut(k);
    let (permutation, inverse) = (&mut permutation[..k], &mut inverse[..k]);
    lu_in_place(block.rb_mut(), permutation, inverse, Par::Seq, stack, Spec::default());
    pivots.copy_from_slice(permutation);
    for i in 0..k {
        let pivot = block[(i, i)];
        if pivot == 0.0 || !pivot.is_finite() {
            return Err(Singular);
        }
    }
    if b == 0 {
        return Ok(());
    }
    for values in top.chunks_exact_mut(k) {
        column[..k].copy_from_slice(values);
        for (value, p) in values.iter_mut().zip(pivots.iter()) {
            *value = column[*p as usize];
        }
    }
    let mut top = MatMut::from_column_major_slice_mut(top, k, b);
    solve_unit_lower_triangular_in_place(block.rb(), top.rb_mut(), Par::Seq);
    // below := below U^-1, as U^T below^T := below^T
    solve_lower_triangular_in_place(block.rb().transpose(), below.rb_mut().transpose_mut(), Par::Seq);
    let update = MatMut::from_column_major_slice_mut(update, b, b);
    matmul(update, Accum::Add, below.rb(), top.rb(), -1.0, Par::Seq);
    Ok(())
}

/// Walks the tree upwards, deciding where every unknown is eliminated.
struct Symbolic<'a> {
    cells: &'a [Vec<u32>],
    /// In how many cells each unknown appears.
    uses: Vec<u32>,
    fronts: Vec<Front>,
    order: Vec<u32>,
}

impl Symbolic<'_> {
    /// Appends the fronts of a cluster; returns the index of its last one, and the unknowns on its boundary with the number of
    /// the cluster's cells that they appear in.
    fn visit(&mut self, cluster: &Cluster) -> (usize, Vec<(u32, u32)>) {
        let (mut children, mut cell) = (Vec::new(), None);
        let mut counts: Vec<(u32, u32)> = match cluster {
            Cluster::Cell(index) => {
                cell = Some((*index, Vec::new()));
                self.cells[*index].iter().filter(|d| **d != FIXED).map(|d| (*d, 1)).collect()
            }
            Cluster::Union(parts) => parts
                .iter()
                .flat_map(|part| {
                    let (child, boundary) = self.visit(part);
                    children.push((child, Vec::new()));
                    boundary
                })
                .collect(),
        };
        counts.sort_unstable();
        counts.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                kept.1 += next.1;
            }
            same
        });
        let start = self.order.len();
        counts.retain(|(dof, count)| {
            let complete = *count == self.uses[*dof as usize];
            if complete {
                self.order.push(*dof);
            }
            !complete
        });
        let eliminated = self.order.len() - start;
        let boundary = counts.iter().map(|(dof, _)| *dof).collect();
        self.fronts.push(Front { start, eliminated, boundary, children, cell, offset: 0 });
        (self.fronts.len() - 1, counts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::MatRef;
    use faer::linalg::solvers::Solve;
    use proptest::prelude::*;

    /// Cells of a strip, each over the four corners of a grid of nodes with one unknown.
    fn strip_cells(columns: usize, rows: usize) -> Vec<Vec<u32>> {
        (0..columns * rows)
            .map(|cell| {
                let (c, r) = (cell / rows, cell % rows);
                let node = |i: usize, j: usize| ((c + i) * (rows + 1) + r + j) as u32;
                vec![node(0, 0), node(0, 1), node(1, 0), node(1, 1)]
            })
            .collect()
    }

    proptest! {
        #[test]
        fn agrees_with_dense_elimination(columns in 1..9_usize, rows in 1..5_usize, seed in 0..1000_u64, fixed in 0..3_u32) {
            let mut cells = strip_cells(columns, rows);
            let n = (columns + 1) * (rows + 1);
            // The last few unknowns are fixed.
            let free = n as u32 - fixed;
            for dof in cells.iter_mut().flatten() {
                if *dof >= free { *dof = FIXED; }
            }
            let n = free as usize;
            let number = |i: u64| ((i * 2654435761 + seed * 40503) % 1009) as f64 / 1009.0 - 0.5;
            let matrix = |cell: usize, m: &mut [f64]| {
                for (i, v) in m.iter_mut().enumerate() {
                    *v = number((cell * 16 + i) as u64) + if i % 5 == 0 { 1.0 } else { 0.0 };
                }
            };
            let mut dense = faer::Mat::<f64>::zeros(n, n);
            for (cell, dofs) in cells.iter().enumerate() {
                let mut m = [0.0; 16];
                matrix(cell, &mut m);
                for i in 0..4 { for j in 0..4 {
                    if dofs[i] != FIXED && dofs[j] != FIXED { dense[(dofs[i] as usize, dofs[j] as usize)] += m[4 * j + i]; }
                } }
            }
            let scale: Vec<f64> = (0..n).map(|i| 10.0_f64.powi((i % 7) as i32 - 3)).collect();
            let mut solver = Multifrontal::new(&cells, &Cluster::strip(columns, rows), scale.clone(), scale);
            solver.factorise(&cells, matrix).unwrap();
            let rhs: Vec<f64> = (0..2 * n).map(|i| number(i as u64 + 77)).collect();
            let mut x = rhs.clone();
            solver.solve(&mut x).unwrap();
            let reference = dense.partial_piv_lu().solve(MatRef::from_column_major_slice(&rhs, n, 2));
            for (i, value) in x.iter().enumerate() {
                let expected = reference[(i % n, i / n)];
                prop_assert!((value - expected).abs() < 1e-7 * (1.0 + reference.norm_max()), "{} {}", value, expected);
            }
        }
    }

    #[test]
    fn a_singular_matrix_is_an_error() {
        let cells = strip_cells(3, 2);
        let mut solver = Multifrontal::new(&cells, &Cluster::strip(3, 2), vec![1.0; 12], vec![1.0; 12]);
        assert_eq!(solver.factorise(&cells, |_, _| ()), Err(Singular));
    }
}
