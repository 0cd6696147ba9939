//! Direct solution of the linear systems: a multifrontal LU on a tree of cells, on dense kernels.
//!
//! The matrix is given as dense matrices of cells (finite elements) that overlap in their unknowns. A tree of clusters of
//! cells says in which order to eliminate: an unknown is eliminated in the smallest cluster that holds all its cells. For a
//! long strip of elements the tree comes from [`Cluster::strip`]. Everything but the numbers is worked out once, in
//! [`Multifrontal::new`]; after that nothing is allocated but the vectors of a solution.

mod cluster;
mod dense;
mod front;
mod substitution;
mod watch;

pub use cluster::Cluster;

use std::sync::{Mutex, PoisonError};

use super::deadline::Deadline;
use dense::{Dense, Scratch};
use front::{Front, Symbolic};
use watch::{CellRoom, ScaleCell, Sums, Watch};

/// Backward error from which on a solution is refined: elimination pivots within its fronts only, and what it then loses is seen here.
/// An update of Newton's method needs few digits; that of a matrix which is factorised well has errors of 1e-15.
const LARGE_ERROR: f64 = 1e-9;

/// Unknown that is not solved for: its rows and columns are dropped.
pub const FIXED: u32 = u32::MAX;

/// The numbers were such that elimination cannot go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the linear system is singular")]
pub struct Singular;

/// A factorised sparse matrix, with room to factorise others of the same structure.
pub struct Multifrontal {
    fronts: Vec<Front>,
    /// Unknown -> place in the order of elimination.
    position: Vec<u32>,
    row_scale: Vec<f64>,
    column_scale: Vec<f64>,
    factors: Vec<f64>,
    pivots: Vec<u32>,
    /// The subtrees that hang from the root, then the root.
    parts: Vec<Part>,
    threads: usize,
    deadline: Deadline,
    watch: Watch,
    simd: pulp::Arch,
}

/// Consecutive fronts, with the room that it takes to eliminate them.
struct Part {
    fronts: std::ops::Range<usize>,
    /// Update matrices, see [`Symbolic::stack`].
    stacks: [Vec<f64>; 2],
    /// Matrix of a cell.
    cell: Vec<f64>,
    room: CellRoom,
    sums: Sums,
    scratch: Scratch,
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
        let Symbolic { mut fronts, position, parts } = Symbolic::new(cells, tree, unknowns);
        let count = fronts.len();
        let mut first = 0;
        let parts = parts.into_iter().chain((count > 0).then_some(count)).map(|end| {
            let range = std::mem::replace(&mut first, end)..end;
            let fronts = &mut fronts[range.clone()];
            let stacks = Symbolic::stack(fronts, range.start).map(|length| vec![0.0; length]);
            let largest = fronts.iter().map(|f| f.eliminated).max().unwrap_or(0);
            let cell = fronts.iter().flat_map(|f| &f.sources).map(|s| s.size * s.size).max().unwrap_or(0);
            Part {
                fronts: range,
                stacks,
                cell: vec![0.0; cell],
                room: CellRoom::default(),
                sums: Sums::default(),
                scratch: Scratch::new(largest),
            }
        });
        let parts = parts.collect();
        let length = fronts.iter().map(Front::length).sum();
        Self {
            fronts,
            position,
            row_scale,
            column_scale,
            factors: vec![0.0; length],
            pivots: vec![0; unknowns],
            parts,
            threads: 1,
            deadline: Deadline::default(),
            watch: Watch::new(unknowns),
            simd: pulp::Arch::new(),
        }
    }

    /// A factorisation of nothing.
    pub fn empty() -> Self {
        Self::new(&[], &Cluster::Union(Vec::new()), Vec::new(), Vec::new())
    }

    /// Factorises on up to this many threads: more than one help as far as the root of the tree has branches. The results are the
    /// same bits.
    pub fn set_threads(&mut self, threads: usize) {
        self.threads = threads;
    }

    /// No front is eliminated after it: a large factorisation may take longer than all else.
    pub fn set_deadline(&mut self, deadline: Deadline) {
        self.deadline = deadline;
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
    /// [`Singular`] where a pivot is zero or not finite, or the time is over.
    pub fn factorise(&mut self, cells: &[Vec<u32>], fill: impl Fn(usize, &mut [f64]) + Sync) -> Result<(), Singular> {
        let Some((root, branches)) = self.parts.split_last_mut() else { return Ok(()) };
        let (fronts, simd, fill) = (&self.fronts, self.simd, &fill);
        self.watch.begin();
        let scale = Scale {
            cells,
            rows: &self.row_scale,
            columns: &self.column_scale,
            weights: &self.watch.weights,
            deadline: self.deadline,
        };
        let (mut factors, mut pivots) = (&mut self.factors[..], &mut self.pivots[..]);
        let mut jobs = Vec::with_capacity(branches.len());
        for part in branches.iter_mut() {
            let of_part = &fronts[part.fronts.clone()];
            let length = of_part.iter().map(Front::length).sum();
            let eliminated = of_part.iter().map(|f| f.eliminated).sum();
            let (own_factors, own_pivots);
            (own_factors, factors) = factors.split_at_mut(length);
            (own_pivots, pivots) = pivots.split_at_mut(eliminated);
            jobs.push(move || part.factorise(fronts, &[], &scale, own_factors, own_pivots, simd, fill));
        }
        let threads = self.threads.min(jobs.len());
        let jobs = Mutex::new(jobs.into_iter());
        let work = || -> Result<(), Singular> {
            loop {
                let job = jobs.lock().unwrap_or_else(PoisonError::into_inner).next();
                let Some(mut job) = job else { break Ok(()) };
                job()?;
            }
        };
        if threads < 2 {
            work()?;
        } else {
            std::thread::scope(|scope| {
                // Where the system refuses a thread, the others do its work.
                let spawn = |_| std::thread::Builder::new().spawn_scoped(scope, work).ok();
                let others: Vec<_> = (1..threads).filter_map(spawn).collect();
                others.into_iter().fold(work(), |result, other| result.and(other.join().unwrap_or(Err(Singular))))
            })?;
        }
        root.factorise(fronts, branches, &scale, factors, pivots, simd, fill)?;
        for part in &self.parts {
            self.watch.add(&part.sums);
        }
        Ok(())
    }

    /// Solves for right-hand sides stored one after the other, in place.
    ///
    /// # Errors
    /// [`Singular`] where an answer is not finite, or its backward error is large; the right-hand sides are then garbage.
    pub fn solve(&self, right_hand_sides: &mut [f64]) -> Result<(), Singular> {
        let given = right_hand_sides.to_vec();
        self.substitute(right_hand_sides)?;
        if self.backward_error(right_hand_sides, &given) <= LARGE_ERROR { Ok(()) } else { Err(Singular) }
    }

    /// As [`Self::solve`], but where the backward error is large, the solution is refined once with the residual of the matrix that
    /// was factorised: `fill` is what [`Self::factorise`] was given.
    ///
    /// # Errors
    /// [`Singular`] where an answer is not finite, or its backward error stays large; the right-hand sides are then garbage.
    pub fn solve_refined(
        &self,
        right_hand_sides: &mut [f64],
        cells: &[Vec<u32>],
        fill: impl Fn(usize, &mut [f64]),
    ) -> Result<(), Singular> {
        let given = right_hand_sides.to_vec();
        self.substitute(right_hand_sides)?;
        if self.backward_error(right_hand_sides, &given) <= LARGE_ERROR {
            return Ok(());
        }
        let mut rest = given.clone();
        let mut matrix = Vec::new();
        for (index, cell) in cells.iter().enumerate() {
            matrix.clear();
            matrix.resize(cell.len().pow(2), 0.0);
            fill(index, &mut matrix);
            let n = self.unknowns();
            for (rest, solution) in rest.chunks_exact_mut(n).zip(right_hand_sides.chunks_exact(n)) {
                for (column, dof) in matrix.chunks_exact(cell.len()).zip(cell).filter(|(_, dof)| **dof != FIXED) {
                    for (value, row) in column.iter().zip(cell).filter(|(_, row)| **row != FIXED) {
                        rest[*row as usize] -= value * solution[*dof as usize];
                    }
                }
            }
        }
        self.substitute(&mut rest)?;
        right_hand_sides.iter_mut().zip(&rest).for_each(|(solution, correction)| *solution += correction);
        if self.backward_error(right_hand_sides, &given) <= LARGE_ERROR { Ok(()) } else { Err(Singular) }
    }

    /// The largest backward error of some solutions, from below.
    fn backward_error(&self, solutions: &[f64], right_hand_sides: &[f64]) -> f64 {
        let n = self.unknowns().max(1);
        let pairs = solutions.chunks_exact(n).zip(right_hand_sides.chunks_exact(n));
        pairs.fold(0.0, |largest: f64, (x, b)| {
            largest.max(self.watch.backward_error(x, b, &self.row_scale, &self.column_scale))
        })
    }
}

/// What rows and columns of the cells' matrices are multiplied by, and when to stop.
#[derive(Clone, Copy)]
struct Scale<'a> {
    cells: &'a [Vec<u32>],
    rows: &'a [f64],
    columns: &'a [f64],
    weights: &'a [f64],
    deadline: Deadline,
}

impl Part {
    /// Eliminates its fronts. `below` are the parts that hold children of its fronts.
    #[allow(clippy::too_many_arguments)]
    fn factorise(
        &mut self,
        fronts: &[Front],
        below: &[Self],
        scale: &Scale<'_>,
        mut factors: &mut [f64],
        mut pivots: &mut [u32],
        simd: pulp::Arch,
        fill: &(impl Fn(usize, &mut [f64]) + Sync),
    ) -> Result<(), Singular> {
        self.sums.clear(scale.rows.len());
        for front in &fronts[self.fronts.clone()] {
            if scale.deadline.passed() {
                return Err(Singular);
            }
            let (k, b) = (front.eliminated, front.boundary.len());
            let (left, top, own);
            (left, factors) = factors.split_at_mut((k + b) * k);
            (top, factors) = factors.split_at_mut(k * b);
            (own, pivots) = pivots.split_at_mut(k);
            let [even, odd] = &mut self.stacks;
            let (stack, children) = if front.stack == 0 { (even, &*odd) } else { (odd, &*even) };
            let update = &mut stack[front.update..front.update + b * b];
            left.fill(0.0);
            top.fill(0.0);
            update.fill(0.0);
            let mut dense = Dense { left, top, update, size: [k, b], pivots: own };
            for child in &front.children {
                let of_child = &fronts[child.front];
                let elsewhere = below.iter().find(|part| part.fronts.contains(&child.front));
                let stack = elsewhere.map_or(children, |part| &part.stacks[of_child.stack]);
                let matrix = &stack[of_child.update..of_child.update + of_child.update_length()];
                dense.add(matrix, of_child.boundary.len(), &child.runs);
            }
            for source in &front.sources {
                let m = source.size;
                let matrix = &mut self.cell[..m * m];
                matrix.fill(0.0);
                fill(source.cell, matrix);
                simd.dispatch(ScaleCell {
                    matrix,
                    unknowns: &scale.cells[source.cell],
                    row_scale: scale.rows,
                    column_scale: scale.columns,
                    weights: scale.weights,
                    room: &mut self.room,
                    sums: &mut self.sums,
                });
                dense.add_scattered(matrix, m, &source.places);
            }
            dense.eliminate(simd, &mut self.scratch)?;
        }
        Ok(())
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

    /// Biquadratic elements with three unknowns a node and 20 rows: fronts with more unknowns than loops of our own take, on one thread
    /// and on two, with the bottom row of nodes fixed.
    #[test]
    fn large_fronts_agree_with_dense_elimination_on_one_thread_and_on_two() {
        let (columns, rows) = (5, 20);
        let levels = 2 * rows + 1;
        let free = 3 * (levels - 1) as u32;
        let number = |column: usize, level: usize, field: usize| match level + 1 == levels {
            true => FIXED,
            false => column as u32 * free + (3 * level + field) as u32,
        };
        let cells: Vec<Vec<u32>> = (0..columns * rows)
            .map(|cell| {
                let node = |a: usize| (2 * (cell / rows) + a % 3, 2 * (cell % rows) + a / 3);
                (0..27).map(|i| number(node(i / 3).0, node(i / 3).1, i % 3)).collect()
            })
            .collect();
        let n = (2 * columns + 1) * free as usize;
        let random = |i: u64| {
            let x = (i + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            ((x ^ (x >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let fill = |cell: usize, matrix: &mut [f64]| {
            for (i, value) in matrix.iter_mut().enumerate() {
                *value = random((cell * 729 + i) as u64) + if i % 28 == 0 { 4.0 } else { 0.0 };
            }
        };
        let mut dense = faer::Mat::<f64>::zeros(n, n);
        for (index, cell) in cells.iter().enumerate() {
            let mut matrix = [0.0; 729];
            fill(index, &mut matrix);
            for (column, j) in matrix.chunks_exact(27).zip(cell).filter(|(_, j)| **j != FIXED) {
                for (value, i) in column.iter().zip(cell).filter(|(_, i)| **i != FIXED) {
                    dense[(*i as usize, *j as usize)] += value;
                }
            }
        }
        let right_hand_side: Vec<f64> = (0..n).map(|i| random(1_000_000 + i as u64)).collect();
        let reference = dense.partial_piv_lu().solve(MatRef::from_column_major_slice(&right_hand_side, n, 1));
        let solve = |threads: usize| {
            let scale: Vec<f64> = (0..n).map(|i| 10.0_f64.powi((i % 5) as i32 - 2)).collect();
            let mut solver = Multifrontal::new(&cells, &Cluster::strip(columns, rows), scale.clone(), scale);
            let largest = solver.fronts.iter().map(|front| front.eliminated).max();
            assert!(largest > Some(3 * dense::SMALL), "no front is large: {largest:?}");
            solver.set_threads(threads);
            solver.factorise(&cells, fill).unwrap();
            let mut x = right_hand_side.clone();
            solver.solve(&mut x).unwrap();
            assert!(solver.backward_error(&x, &right_hand_side) < 1e-12);
            x
        };
        let (one, two) = (solve(1), solve(2));
        for (i, (one, two)) in one.into_iter().zip(two).enumerate() {
            assert_eq!(one.to_bits(), two.to_bits());
            assert!((one - reference[(i, 0)]).abs() < 1e-8 * reference.norm_max(), "{one} {}", reference[(i, 0)]);
        }
    }

    /// Unknown 0 is eliminated alone, with a pivot that is `small` against what couples it: what is left of the others' equations has
    /// lost so many digits.
    #[test]
    fn lost_digits_are_noticed_and_regained_once() {
        let cells = vec![vec![0, 1, 2], vec![1, 2, 3]];
        let tree = Cluster::Union(vec![Cluster::Cells(vec![0]), Cluster::Cells(vec![1])]);
        let right_hand_side = [1.0, -0.3, 0.7, 0.4];
        let solve = |small: f64, refined: bool| {
            let fill = |cell: usize, matrix: &mut [f64]| {
                let values =
                    [[small, 1.0, 0.6, 0.9, 0.3, 1.1, 0.5, 0.8, 1.4], [2.0, 0.1, 0.4, 0.3, 1.7, 0.2, 0.6, 0.5, 1.9]];
                matrix.copy_from_slice(&values[cell]);
            };
            let mut solver = Multifrontal::new(&cells, &tree, vec![1.0; 4], vec![1.0; 4]);
            solver.factorise(&cells, fill)?;
            let mut dense = faer::Mat::<f64>::zeros(4, 4);
            for (index, cell) in cells.iter().enumerate() {
                let mut matrix = [0.0; 9];
                fill(index, &mut matrix);
                for (k, value) in matrix.into_iter().enumerate() {
                    dense[(cell[k % 3] as usize, cell[k / 3] as usize)] += value;
                }
            }
            let mut x = right_hand_side.to_vec();
            let result = match refined {
                true => solver.solve_refined(&mut x, &cells, fill),
                false => solver.solve(&mut x),
            };
            let reference = dense.partial_piv_lu().solve(MatRef::from_column_major_slice(&right_hand_side, 4, 1));
            result.map(|()| x.iter().enumerate().map(|(i, x)| (x - reference[(i, 0)]).abs()).fold(0.0, f64::max))
        };
        assert!(solve(0.5, false).unwrap() < 1e-14);
        assert_eq!(solve(1e-9, false), Err(Singular));
        assert!(solve(1e-9, true).unwrap() < 1e-12);
        assert_eq!(solve(1e-19, true), Err(Singular));
    }

    #[test]
    fn a_singular_matrix_is_an_error() {
        let cells = strip_cells(3, 2);
        let mut solver = Multifrontal::new(&cells, &Cluster::strip(3, 2), vec![1.0; 12], vec![1.0; 12]);
        assert_eq!(solver.factorise(&cells, |_, _| ()), Err(Singular));
    }
}
