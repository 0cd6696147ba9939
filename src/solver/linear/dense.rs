//! Elimination within one front: small fronts by loops of our own, larger ones by faer.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place};
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, Par, Spec};
use pulp::{Simd, WithSimd};

use super::Singular;
use super::front::Run;
use super::substitution::subtract;

/// Up to this many unknowns are eliminated by loops of our own: below it the general kernels spend more time on finding out what
/// to do than on doing it.
pub const SMALL: usize = 16;
/// Columns and vectors of rows that are updated together: as many as leave some of sixteen registers for what they are made of.
const COLUMNS: usize = 4;
const VECTORS: usize = 3;

/// A front in its three parts, column by column: `left` the eliminated columns, `top` the eliminated rows of the others, `update`
/// the rest. Becomes the factors and the Schur complement.
pub struct Dense<'a> {
    pub left: &'a mut [f64],
    pub top: &'a mut [f64],
    pub update: &'a mut [f64],
    /// Number of eliminated unknowns and of the others.
    pub size: [usize; 2],
    /// Row that was brought to each eliminated one.
    pub pivots: &'a mut [u32],
}

/// Room to work in.
pub struct Scratch {
    inverse: Vec<u32>,
    column: Vec<f64>,
    memory: MemBuffer,
}

impl Scratch {
    /// For fronts that eliminate up to `largest` unknowns.
    pub fn new(largest: usize) -> Self {
        let memory = MemBuffer::new(lu_in_place_scratch::<u32, f64>(largest, largest, Par::Seq, Spec::default()));
        Self { inverse: vec![0; largest], column: vec![0.0; largest], memory }
    }
}

impl Dense<'_> {
    /// Adds the update matrix over the `m` boundary unknowns of a child.
    pub fn add(&mut self, child: &[f64], m: usize, runs: &[Run]) {
        let [k, b] = self.size;
        let split = runs.partition_point(|run| (run.to as usize) < k);
        let add = |target: &mut [f64], column: &[f64], runs: &[Run], shift: usize| {
            for run in runs {
                let (from, to, length) = (run.from as usize, run.to as usize - shift, run.length as usize);
                target[to..to + length].iter_mut().zip(&column[from..from + length]).for_each(|(t, c)| *t += c);
            }
        };
        for run in runs {
            for i in 0..run.length as usize {
                let column = &child[(run.from as usize + i) * m..(run.from as usize + i + 1) * m];
                let c = run.to as usize + i;
                if c < k {
                    add(&mut self.left[c * (k + b)..(c + 1) * (k + b)], column, runs, 0);
                } else {
                    add(&mut self.top[(c - k) * k..(c - k + 1) * k], column, &runs[..split], 0);
                    add(&mut self.update[(c - k) * b..(c - k + 1) * b], column, &runs[split..], k);
                }
            }
        }
    }

    /// Adds a matrix over `m` unknowns, of which those at these places have these positions.
    pub fn add_scattered(&mut self, matrix: &[f64], m: usize, places: &[(u32, u32)]) {
        let [k, b] = self.size;
        let split = places.partition_point(|(_, position)| (*position as usize) < k);
        let add = |target: &mut [f64], column: &[f64], places: &[(u32, u32)], shift: usize| {
            for (place, position) in places {
                target[*position as usize - shift] += column[*place as usize];
            }
        };
        for (place, position) in places {
            let column = &matrix[*place as usize * m..(*place as usize + 1) * m];
            let c = *position as usize;
            if c < k {
                add(&mut self.left[c * (k + b)..(c + 1) * (k + b)], column, places, 0);
            } else {
                add(&mut self.top[(c - k) * k..(c - k + 1) * k], column, &places[..split], 0);
                add(&mut self.update[(c - k) * b..(c - k + 1) * b], column, &places[split..], k);
            }
        }
    }

    /// LU of the eliminated block with row pivoting inside it, the factors beside and below it, and the Schur complement.
    pub fn eliminate(self, simd: pulp::Arch, scratch: &mut Scratch) -> Result<(), Singular> {
        match self.size[0] {
            0 => Ok(()),
            k if k <= SMALL => simd.dispatch(SmallFront(self)),
            _ => self.eliminate_large(scratch),
        }
    }

    fn eliminate_large(self, scratch: &mut Scratch) -> Result<(), Singular> {
        let Self { left, top, update, size: [k, b], pivots } = self;
        let (mut block, mut below) = MatMut::from_column_major_slice_mut(left, k + b, k).split_at_row_mut(k);
        let stack = MemStack::new(&mut scratch.memory);
        lu_in_place(block.rb_mut(), pivots, &mut scratch.inverse[..k], Par::Seq, stack, Spec::default());
        if (0..k).any(|i| block[(i, i)] == 0.0 || !block[(i, i)].is_finite()) {
            return Err(Singular);
        }
        if b == 0 {
            return Ok(());
        }
        let column = &mut scratch.column[..k];
        for values in top.chunks_exact_mut(k) {
            column.copy_from_slice(values);
            for (value, pivot) in values.iter_mut().zip(pivots.iter()) {
                *value = column[*pivot as usize];
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
}

/// Elimination of a few unknowns.
struct SmallFront<'a>(Dense<'a>);

impl WithSimd for SmallFront<'_> {
    type Output = Result<(), Singular>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Dense { left, top, update, size: [k, b], pivots } = self.0;
        let n = k + b;
        for (pivot, row) in pivots.iter_mut().zip(0..) {
            *pivot = row;
        }
        for j in 0..k {
            let (mut row, mut largest) = (j, 0.0);
            for (i, value) in left[j * n + j..j * n + k].iter().enumerate() {
                if value.abs() > largest {
                    (row, largest) = (j + i, value.abs());
                }
            }
            // A column of NaN has no largest value either.
            if largest == 0.0 || !largest.is_finite() {
                return Err(Singular);
            }
            if row != j {
                pivots.swap(row, j);
                left.chunks_exact_mut(n).for_each(|column| column.swap(row, j));
            }
            let (done, rest) = left.split_at_mut((j + 1) * n);
            let column = &mut done[j * n + j..];
            let inverse = 1.0 / column[0];
            column[1..].iter_mut().for_each(|value| *value *= inverse);
            for other in rest.chunks_exact_mut(n) {
                let factor = other[j];
                subtract(simd, &mut other[j + 1..], &column[1..], factor);
            }
        }
        // The unit lower triangle with zeros elsewhere, in columns of fixed length: loops over these need no remainders.
        let mut lower = [[0.0; SMALL]; SMALL];
        for (j, column) in left.chunks_exact(n).enumerate() {
            lower[j][j + 1..k].copy_from_slice(&column[j + 1..k]);
        }
        for (top, columns) in top.chunks_mut(COLUMNS * k).zip(update.chunks_mut(COLUMNS * b.max(1))) {
            let mut factors = [[0.0; COLUMNS]; SMALL];
            for (c, values) in top.chunks_exact_mut(k).enumerate() {
                let mut solution = [0.0; SMALL];
                for (value, pivot) in solution.iter_mut().zip(pivots.iter()) {
                    *value = values[*pivot as usize];
                }
                for (j, column) in lower[..k].iter().enumerate() {
                    let factor = solution[j];
                    subtract(simd, &mut solution, column, factor);
                }
                values.copy_from_slice(&solution[..k]);
                factors.iter_mut().zip(values).for_each(|(factor, value)| factor[c] = *value);
            }
            schur_complement(simd, columns, &factors[..k], left, b);
        }
        Ok(())
    }
}

/// Subtracts from a few columns of the update matrix, `b` long, the part below the eliminated block times `factors`.
#[inline(always)]
fn schur_complement<S: Simd>(simd: S, columns: &mut [f64], factors: &[[f64; COLUMNS]], left: &[f64], b: usize) {
    let (lanes, k) = (S::F64_LANES, factors.len());
    let zero = simd.splat_f64s(0.0);
    let mut row = 0;
    // Three vectors of rows at a time, as long as there are so many; then one by one.
    while row + VECTORS * lanes <= b {
        let rows = row..row + VECTORS * lanes;
        let mut sums = [[zero; VECTORS]; COLUMNS];
        for (factor, column) in factors.iter().zip(left.chunks_exact(k + b)) {
            let (below, _) = S::as_simd_f64s(&column[k..][rows.clone()]);
            let below: [_; VECTORS] = std::array::from_fn(|v| below[v]);
            for (sum, factor) in sums.iter_mut().zip(factor) {
                let factor = simd.splat_f64s(*factor);
                sum.iter_mut().zip(below).for_each(|(sum, below)| *sum = simd.mul_add_e_f64s(below, factor, *sum));
            }
        }
        for (column, sum) in columns.chunks_exact_mut(b).zip(&sums) {
            let (target, _) = S::as_mut_simd_f64s(&mut column[rows.clone()]);
            target.iter_mut().zip(sum).for_each(|(target, sum)| *target = simd.sub_f64s(*target, *sum));
        }
        row = rows.end;
    }
    while row < b {
        let rows = row..(row + lanes).min(b);
        let mut sums = [zero; COLUMNS];
        for (factor, column) in factors.iter().zip(left.chunks_exact(k + b)) {
            let below = simd.partial_load_f64s(&column[k..][rows.clone()]);
            for (sum, factor) in sums.iter_mut().zip(factor) {
                *sum = simd.mul_add_e_f64s(below, simd.splat_f64s(*factor), *sum);
            }
        }
        for (column, sum) in columns.chunks_exact_mut(b).zip(&sums) {
            let target = &mut column[rows.clone()];
            let value = simd.sub_f64s(simd.partial_load_f64s(target), *sum);
            simd.partial_store_f64s(target, value);
        }
        row = rows.end;
    }
}
