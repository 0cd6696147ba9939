//! Elimination within one front, a panel of columns at a time.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::Singular;
use super::front::Run;
use super::substitution::subtract;

/// Columns that are eliminated before the rest of the front is updated with them: few enough to stay in the cache.
const PANEL: usize = 16;
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
    pub fn eliminate(self, simd: pulp::Arch) -> Result<(), Singular> {
        simd.dispatch(Elimination(self))
    }
}

struct Elimination<'a>(Dense<'a>);

impl WithSimd for Elimination<'_> {
    type Output = Result<(), Singular>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Dense { left, top, update, size: [k, b], pivots } = self.0;
        let n = k + b;
        for (pivot, row) in pivots.iter_mut().zip(0..) {
            *pivot = row;
        }
        for start in (0..k).step_by(PANEL) {
            let rows = start..(start + PANEL).min(k);
            for j in rows.clone() {
                eliminate_column(simd, left, [k, n], j, rows.end, pivots)?;
            }
            let (done, rest) = left.split_at_mut(rows.end * n);
            let panel = Panel::new(done, n, rows.clone());
            for columns in rest.chunks_mut(COLUMNS * n) {
                let factors = panel.solve(simd, columns, n);
                panel.subtract(simd, columns, n, rows.end..n, rows.end, &factors);
            }
        }
        if b == 0 {
            return Ok(());
        }
        let mut before = vec![0.0; k];
        for values in top.chunks_exact_mut(k.max(1)) {
            before.copy_from_slice(values);
            values.iter_mut().zip(pivots.iter()).for_each(|(value, pivot)| *value = before[*pivot as usize]);
        }
        for start in (0..k).step_by(PANEL) {
            let rows = start..(start + PANEL).min(k);
            let panel = Panel::new(left, n, rows.clone());
            for (top, update) in top.chunks_mut(COLUMNS * k).zip(update.chunks_mut(COLUMNS * b)) {
                let factors = panel.solve(simd, top, k);
                panel.subtract(simd, top, k, rows.end..k, rows.end, &factors);
                panel.subtract(simd, update, b, 0..b, k, &factors);
            }
        }
        Ok(())
    }
}

/// Brings the largest value to the diagonal, divides by it below, and updates the columns up to `end`.
#[inline(always)]
fn eliminate_column<S: Simd>(
    simd: S,
    left: &mut [f64],
    [k, n]: [usize; 2],
    j: usize,
    end: usize,
    pivots: &mut [u32],
) -> Result<(), Singular> {
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
    let (done, rest) = left[..end * n].split_at_mut((j + 1) * n);
    let column = &mut done[j * n + j..];
    let inverse = 1.0 / column[0];
    column[1..].iter_mut().for_each(|value| *value *= inverse);
    for other in rest.chunks_exact_mut(n) {
        let factor = other[j];
        subtract(simd, &mut other[j + 1..], &column[1..], factor);
    }
    Ok(())
}

/// Eliminated columns.
struct Panel<'a> {
    columns: &'a [f64],
    n: usize,
    /// Their rows on the diagonal.
    rows: Range<usize>,
    /// The unit lower triangle of these rows with zeros elsewhere, in columns of fixed length: loops over these need no remainders.
    lower: [[f64; PANEL]; PANEL],
}

impl<'a> Panel<'a> {
    #[inline(always)]
    fn new(left: &'a [f64], n: usize, rows: Range<usize>) -> Self {
        let columns = &left[rows.start * n..rows.end * n];
        let mut lower = [[0.0; PANEL]; PANEL];
        for (j, column) in columns.chunks_exact(n).enumerate() {
            lower[j][j + 1..rows.len()].copy_from_slice(&column[rows.start + j + 1..rows.end]);
        }
        Self { columns, n, rows, lower }
    }

    /// Solves for the panel's rows of a few columns of this length, and returns them row by row.
    #[inline(always)]
    fn solve<S: Simd>(&self, simd: S, columns: &mut [f64], length: usize) -> [[f64; COLUMNS]; PANEL] {
        let mut factors = [[0.0; COLUMNS]; PANEL];
        for (c, column) in columns.chunks_exact_mut(length).enumerate() {
            let values = &mut column[self.rows.clone()];
            let mut solution = [0.0; PANEL];
            solution[..values.len()].copy_from_slice(values);
            for (j, column) in self.lower[..values.len()].iter().enumerate() {
                let factor = solution[j];
                subtract(simd, &mut solution, column, factor);
            }
            values.copy_from_slice(&solution[..values.len()]);
            factors.iter_mut().zip(values).for_each(|(factor, value)| factor[c] = *value);
        }
        factors
    }

    /// Subtracts from these rows of a few columns of this length the panel, from its row `first` on, times `factors`.
    #[inline(always)]
    fn subtract<S: Simd>(
        &self,
        simd: S,
        columns: &mut [f64],
        length: usize,
        target: Range<usize>,
        first: usize,
        factors: &[[f64; COLUMNS]; PANEL],
    ) {
        let (lanes, count) = (S::F64_LANES, target.len());
        let zero = simd.splat_f64s(0.0);
        let factors = &factors[..self.rows.len()];
        let mut row = 0;
        // Three vectors of rows at a time, as long as there are so many; then one by one.
        while row + VECTORS * lanes <= count {
            let end = row + VECTORS * lanes;
            let mut sums = [[zero; VECTORS]; COLUMNS];
            for (factor, column) in factors.iter().zip(self.columns.chunks_exact(self.n)) {
                let (below, _) = S::as_simd_f64s(&column[first + row..first + end]);
                let below: [_; VECTORS] = std::array::from_fn(|v| below[v]);
                for (sum, factor) in sums.iter_mut().zip(factor) {
                    let factor = simd.splat_f64s(*factor);
                    sum.iter_mut().zip(below).for_each(|(sum, below)| *sum = simd.mul_add_e_f64s(below, factor, *sum));
                }
            }
            for (column, sum) in columns.chunks_exact_mut(length).zip(&sums) {
                let (values, _) = S::as_mut_simd_f64s(&mut column[target.start + row..target.start + end]);
                values.iter_mut().zip(sum).for_each(|(value, sum)| *value = simd.sub_f64s(*value, *sum));
            }
            row = end;
        }
        while row < count {
            let end = (row + lanes).min(count);
            let mut sums = [zero; COLUMNS];
            for (factor, column) in factors.iter().zip(self.columns.chunks_exact(self.n)) {
                let below = simd.partial_load_f64s(&column[first + row..first + end]);
                for (sum, factor) in sums.iter_mut().zip(factor) {
                    *sum = simd.mul_add_e_f64s(below, simd.splat_f64s(*factor), *sum);
                }
            }
            for (column, sum) in columns.chunks_exact_mut(length).zip(&sums) {
                let values = &mut column[target.start + row..target.start + end];
                let value = simd.sub_f64s(simd.partial_load_f64s(values), *sum);
                simd.partial_store_f64s(values, value);
            }
            row = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// Factors and Schur complement of fronts of one panel, of several, and of parts of one.
    #[test]
    fn the_parts_of_a_front_multiply_to_it_again() {
        for (k, b) in [(1, 3), (16, 0), (17, 30), (53, 41), (64, 7)] {
            let n = k + b;
            let number = |i: usize, j: usize| ((i * 31 + j * 57 + i * j * 13) % 101) as f64 / 101.0 - 0.5;
            let matrix = DMatrix::from_fn(n, n, number);
            let mut left = matrix.as_slice()[..n * k].to_vec();
            let mut top = matrix.view((0, k), (k, b)).clone_owned().as_slice().to_vec();
            let mut update = matrix.view((k, k), (b, b)).clone_owned().as_slice().to_vec();
            let mut pivots = vec![0; k];
            let front =
                Dense { left: &mut left, top: &mut top, update: &mut update, size: [k, b], pivots: &mut pivots };
            front.eliminate(pulp::Arch::new()).unwrap();
            let left = DMatrix::from_column_slice(n, k, &left);
            let lower = DMatrix::from_fn(n, k, |i, j| {
                if i == j {
                    1.0
                } else if i > j {
                    left[(i, j)]
                } else {
                    0.0
                }
            });
            let upper = DMatrix::from_fn(k, n, |i, j| match j {
                j if j >= k => top[(j - k) * k + i],
                j if j >= i => left[(i, j)],
                _ => 0.0,
            });
            let mut product = lower * upper;
            let mut rest = product.view_mut((k, k), (b, b));
            rest += DMatrix::from_column_slice(b, b, &update);
            let row = |i: usize| if i < k { pivots[i] as usize } else { i };
            let expected = DMatrix::from_fn(n, n, |i, j| matrix[(row(i), j)]);
            assert!((product - &expected).amax() < 1e-11, "{k} {b}");
            // Row pivoting: no factor is larger than one.
            assert!((0..k).all(|j| (j + 1..k).all(|i| left[(i, j)].abs() <= 1.0)));
        }
    }
}
