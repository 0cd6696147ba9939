//! The backward error of a solution, without the matrix.
//!
//! A residual r = b - A x takes the matrix once more. Its projection w^T r = w^T b - (w^T A) x takes two products of vectors, where w^T A is
//! summed up as the matrices of the cells pass by. With weights of either sign, w_i = +-1 over the magnitude of row i, that is about
//! the root mean square of the rows' errors (R. Freivalds, Fast probabilistic algorithms, 1979), and over the same sums of magnitudes,
//! |w|^T |A| |x| + |w|^T |b|, it is a backward error, from below. Magnitudes are those of the last factorisation: they only weigh.

use pulp::{Simd, WithSimd};

use super::FIXED;

/// Sums over the cells of some fronts, one value for each unknown.
#[derive(Debug, Clone, Default)]
pub struct Sums {
    /// w^T A.
    projected: Vec<f64>,
    /// |w|^T |A|.
    bound: Vec<f64>,
    /// Magnitudes of the rows.
    rows: Vec<f64>,
}

impl Sums {
    /// Zero for so many unknowns.
    pub fn clear(&mut self, unknowns: usize) {
        for values in [&mut self.projected, &mut self.bound, &mut self.rows] {
            values.clear();
            values.resize(unknowns, 0.0);
        }
    }
}

/// What a check takes.
#[derive(Debug)]
pub struct Watch {
    /// Of the rows that are multiplied by the row scale.
    pub weights: Vec<f64>,
    sums: Sums,
}

impl Watch {
    /// Every row counts alike.
    pub fn new(unknowns: usize) -> Self {
        Self { weights: (0..unknowns).map(sign).collect(), sums: Sums::default() }
    }

    /// Takes the magnitudes of the last factorisation for weights.
    pub fn begin(&mut self) {
        for (row, (weight, magnitude)) in self.weights.iter_mut().zip(&self.sums.rows).enumerate() {
            if magnitude.is_normal() {
                *weight = sign(row) / magnitude;
            }
        }
        self.sums.clear(self.weights.len());
    }

    /// Adds what was summed up over some of the cells.
    pub fn add(&mut self, part: &Sums) {
        let add = |sum: &mut [f64], values: &[f64]| sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        add(&mut self.sums.projected, &part.projected);
        add(&mut self.sums.bound, &part.bound);
        add(&mut self.sums.rows, &part.rows);
    }

    /// Backward error of a solution, from below; rows and columns of the matrix were multiplied by these scales.
    pub fn backward_error(&self, solution: &[f64], right_hand_side: &[f64], rows: &[f64], columns: &[f64]) -> f64 {
        let (mut error, mut size) = (0.0, 0.0);
        for (((x, scale), projected), bound) in
            solution.iter().zip(columns).zip(&self.sums.projected).zip(&self.sums.bound)
        {
            let x = x / scale;
            error -= projected * x;
            size += bound * x.abs();
        }
        for ((b, scale), weight) in right_hand_side.iter().zip(rows).zip(&self.weights) {
            let b = weight * scale * b;
            error += b;
            size += b.abs();
        }
        if size == 0.0 { 0.0 } else { error.abs() / size }
    }
}

/// 1 or -1, without a pattern.
fn sign(row: usize) -> f64 {
    let mixed = (row as u64 ^ 0x9e37_79b9).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    if (mixed ^ (mixed >> 31)).wrapping_mul(0x94d0_49bb_1331_11eb) >> 63 == 0 { 1.0 } else { -1.0 }
}

/// Room for a cell's values.
#[derive(Debug, Default)]
pub struct CellRoom {
    row_scale: Vec<f64>,
    weights: Vec<f64>,
    rows: Vec<f64>,
}

/// Multiplies the matrix of a cell by the scales of its rows and columns, and adds to the sums.
pub struct ScaleCell<'a> {
    pub matrix: &'a mut [f64],
    pub unknowns: &'a [u32],
    pub row_scale: &'a [f64],
    pub column_scale: &'a [f64],
    pub weights: &'a [f64],
    pub room: &'a mut CellRoom,
    pub sums: &'a mut Sums,
}

impl WithSimd for ScaleCell<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { matrix, unknowns, row_scale, column_scale, weights, room, sums } = self;
        let of_cell = |values: &mut Vec<f64>, all: &[f64]| {
            values.clear();
            values.extend(unknowns.iter().map(|dof| if *dof == FIXED { 0.0 } else { all[*dof as usize] }));
        };
        of_cell(&mut room.row_scale, row_scale);
        of_cell(&mut room.weights, weights);
        room.rows.clear();
        room.rows.resize(unknowns.len(), 0.0);
        let (scales, last_scales) = S::as_simd_f64s(&room.row_scale);
        let (weights, last_weights) = S::as_simd_f64s(&room.weights);
        for (column, dof) in matrix.chunks_exact_mut(unknowns.len()).zip(unknowns).filter(|(_, dof)| **dof != FIXED) {
            let scale = column_scale[*dof as usize];
            let (rows, last_rows) = S::as_mut_simd_f64s(&mut room.rows);
            let (values, last_values) = S::as_mut_simd_f64s(column);
            let of_column = simd.splat_f64s(scale);
            let (mut projected, mut bound) = (simd.splat_f64s(0.0), simd.splat_f64s(0.0));
            for (((value, row_scale), weight), row) in values.iter_mut().zip(scales).zip(weights).zip(rows) {
                *value = simd.mul_f64s(*value, simd.mul_f64s(of_column, *row_scale));
                let weighted = simd.mul_f64s(*weight, *value);
                projected = simd.add_f64s(projected, weighted);
                bound = simd.add_f64s(bound, simd.abs_f64s(weighted));
                *row = simd.add_f64s(*row, simd.abs_f64s(*value));
            }
            let (mut projected, mut bound) = (simd.reduce_sum_f64s(projected), simd.reduce_sum_f64s(bound));
            for (((value, row_scale), weight), row) in
                last_values.iter_mut().zip(last_scales).zip(last_weights).zip(last_rows)
            {
                *value *= scale * row_scale;
                projected += weight * *value;
                bound += (weight * *value).abs();
                *row += value.abs();
            }
            sums.projected[*dof as usize] += projected;
            sums.bound[*dof as usize] += bound;
        }
        for (dof, row) in unknowns.iter().zip(&room.rows).filter(|(dof, _)| **dof != FIXED) {
            sums.rows[*dof as usize] += row;
        }
    }
}
