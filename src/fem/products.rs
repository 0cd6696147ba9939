//! Element matrices as sums of products of test functions with what stands beside them, the inner loop of assembly.

use pulp::{Simd, WithSimd};

use super::element::NODES;

/// Values for the nodes of an element, filled up with zeros to whole vectors of a processor's registers.
pub type Padded = [f64; 12];

/// Values for the nodes, filled up.
pub fn padded(values: &[f64; NODES]) -> Padded {
    std::array::from_fn(|a| values.get(a).copied().unwrap_or(0.0))
}

/// One block of an element matrix: for every pair of nodes a, b the sum over t of tests[t][a] * factors[t][b].
pub struct Block<'a> {
    /// Test functions or their derivatives, at one quadrature point after another.
    pub tests: &'a [Padded],
    /// As many factors.
    pub factors: &'a [Padded],
    /// First row and first column of the block.
    pub at: [usize; 2],
}

/// Adds the blocks to a column-major matrix with `rows` rows.
pub fn add_products(blocks: &[Block<'_>], matrix: &mut [f64], rows: usize) {
    pulp::Arch::new().dispatch(AddProducts { blocks, matrix, rows });
}

struct AddProducts<'a> {
    blocks: &'a [Block<'a>],
    matrix: &'a mut [f64],
    rows: usize,
}

impl WithSimd for AddProducts<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for Block { tests, factors, at: [row, column] } in self.blocks {
            let mut products = [[0.0; 12]; NODES];
            // One vector of rows at a time, for all columns together.
            for v in 0..NODES.div_ceil(S::F64_LANES) {
                let mut sums = [simd.splat_f64s(0.0); NODES];
                for (test, factor) in tests.iter().zip(*factors) {
                    let test = S::as_simd_f64s(test).0[v];
                    for (sum, factor) in sums.iter_mut().zip(factor) {
                        *sum = simd.mul_add_e_f64s(test, simd.splat_f64s(*factor), *sum);
                    }
                }
                for (product, sum) in products.iter_mut().zip(sums) {
                    S::as_mut_simd_f64s(product).0[v] = sum;
                }
            }
            for (target, product) in self.matrix.chunks_exact_mut(self.rows).skip(*column).zip(&products) {
                target[*row..*row + NODES].iter_mut().zip(product).for_each(|(t, p)| *t += p);
            }
        }
    }
}
