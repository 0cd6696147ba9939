//! Solution with the factors: forward over the fronts, then back.

use pulp::{Simd, WithSimd};

use super::{Multifrontal, Singular};

impl Multifrontal {
    /// Solves for right-hand sides stored one after the other, in place, unchecked. They are solved for together, because reading the
    /// factors is most of the work.
    ///
    /// # Errors
    /// [`Singular`] where the answer is not finite; the right-hand sides are then garbage.
    pub(super) fn substitute(&self, right_hand_sides: &mut [f64]) -> Result<(), Singular> {
        let n = self.unknowns();
        if n == 0 {
            return Ok(());
        }
        let mut x = vec![0.0; right_hand_sides.len()];
        for (x, rhs) in x.chunks_exact_mut(n).zip(right_hand_sides.chunks_exact(n)) {
            for ((value, place), scale) in rhs.iter().zip(&self.position).zip(&self.row_scale) {
                x[*place as usize] = value * scale;
            }
        }
        self.simd.dispatch(Substitution { factors: self, x: &mut x });
        for (x, solution) in x.chunks_exact(n).zip(right_hand_sides.chunks_exact_mut(n)) {
            for ((value, place), scale) in solution.iter_mut().zip(&self.position).zip(&self.column_scale) {
                *value = x[*place as usize] * scale;
                if !value.is_finite() {
                    return Err(Singular);
                }
            }
        }
        Ok(())
    }
}

/// Forward and backward substitution of vectors in the order of elimination.
struct Substitution<'a> {
    factors: &'a Multifrontal,
    x: &'a mut [f64],
}

impl WithSimd for Substitution<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { factors, x } = self;
        let unknowns = factors.unknowns();
        let mut work = vec![0.0; factors.fronts.iter().map(|f| f.size()).max().unwrap_or(0)];
        for front in &factors.fronts {
            let (k, n) = (front.eliminated, front.size());
            let left = &factors.factors[front.offset..front.offset + n * k];
            let pivots = &factors.pivots[front.start..front.start + k];
            let work = &mut work[..n];
            for x in x.chunks_exact_mut(unknowns) {
                for (w, pivot) in work.iter_mut().zip(pivots) {
                    *w = x[front.start + *pivot as usize];
                }
                work[k..].fill(0.0);
                for (j, column) in left.chunks_exact(n.max(1)).enumerate() {
                    let (done, rest) = work.split_at_mut(j + 1);
                    subtract(simd, rest, &column[j + 1..], done[j]);
                }
                x[front.start..front.start + k].copy_from_slice(&work[..k]);
                for (place, w) in front.boundary.iter().zip(&work[k..]) {
                    x[*place as usize] += w;
                }
            }
        }
        for front in factors.fronts.iter().rev().filter(|front| front.eliminated > 0) {
            let (k, n) = (front.eliminated, front.size());
            let (left, top) = factors.factors[front.offset..front.offset + front.length()].split_at(n * k);
            for x in x.chunks_exact_mut(unknowns) {
                let work = &mut work[..k];
                work.copy_from_slice(&x[front.start..front.start + k]);
                for (place, column) in front.boundary.iter().zip(top.chunks_exact(k)) {
                    subtract(simd, work, column, x[*place as usize]);
                }
                for (j, column) in left.chunks_exact(n).enumerate().rev() {
                    let value = work[j] / column[j];
                    work[j] = value;
                    subtract(simd, &mut work[..j], &column[..j], value);
                }
                x[front.start..front.start + k].copy_from_slice(work);
            }
        }
    }
}

/// target -= factor * column
#[inline(always)]
pub fn subtract<S: Simd>(simd: S, target: &mut [f64], column: &[f64], factor: f64) {
    let (target, target_rest) = S::as_mut_simd_f64s(target);
    let (column, column_rest) = S::as_simd_f64s(column);
    let minus = simd.splat_f64s(-factor);
    for (t, c) in target.iter_mut().zip(column) {
        *t = simd.mul_add_e_f64s(*c, minus, *t);
    }
    for (t, c) in target_rest.iter_mut().zip(column_rest) {
        *t -= c * factor;
    }
}
