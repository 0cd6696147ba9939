//! Biquadratic quadrilaterals and their quadrature.
//!
//! Local nodes are numbered 3 * row + column: columns along the surface, rows from the surface inwards.

/// Nodes of an element.
pub const NODES: usize = 9;
/// Quadrature points of an element.
pub const POINTS: usize = 9;

/// Gauss-Legendre points on [-1, 1] that integrate polynomials of degree five.
pub const GAUSS: [f64; 3] = [-0.774_596_669_241_483_4, 0.0, 0.774_596_669_241_483_4];
/// Their weights.
pub const GAUSS_WEIGHTS: [f64; 3] = [5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0];
/// Fraction of an element's length that Simpson's rule gives to its two ends and its middle.
pub const SIMPSON: [f64; 3] = [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0];

/// Quadratic shape functions of the nodes -1, 0, 1.
pub fn quadratic(s: f64) -> [f64; 3] {
    [0.5 * s * (s - 1.0), 1.0 - s * s, 0.5 * s * (s + 1.0)]
}

/// Their derivatives.
pub fn quadratic_derivative(s: f64) -> [f64; 3] {
    [s - 0.5, -2.0 * s, s + 0.5]
}

/// Shape functions of the pressure along one direction, on the nodes -1, 0, 1: quadratic, or linear with nothing at the middle.
pub fn pressure(order: i32, s: f64) -> [f64; 3] {
    if order == 2 { quadratic(s) } else { [0.5 * (1.0 - s), 0.0, 0.5 * (1.0 + s)] }
}

/// Their derivatives.
pub fn pressure_derivative(order: i32, s: f64) -> [f64; 3] {
    if order == 2 { quadratic_derivative(s) } else { [-0.5, 0.0, 0.5] }
}

/// Products of one function of the column with one of the row, for the nine nodes.
pub fn tensor(along: [f64; 3], inwards: [f64; 3]) -> [f64; NODES] {
    std::array::from_fn(|node| along[node % 3] * inwards[node / 3])
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn shape_functions_are_a_partition_of_unity_and_nodal() {
        for order in [1, 2] {
            for s in [-1.0, -0.3, 0.0, 0.7, 1.0] {
                assert_relative_eq!(pressure(order, s).iter().sum::<f64>(), 1.0, epsilon = 1e-14);
                assert_relative_eq!(pressure_derivative(order, s).iter().sum::<f64>(), 0.0, epsilon = 1e-14);
            }
        }
        assert_eq!(quadratic(-1.0), [1.0, 0.0, 0.0]);
        assert_eq!(quadratic(0.0), [0.0, 1.0, 0.0]);
    }

    #[test]
    fn quadrature_is_exact_to_degree_five() {
        for degree in 0..6 {
            let sum: f64 = GAUSS.iter().zip(GAUSS_WEIGHTS).map(|(s, w)| w * s.powi(degree)).sum();
            let exact = if degree % 2 == 0 { 2.0 / f64::from(degree + 1) } else { 0.0 };
            assert_relative_eq!(sum, exact, epsilon = 1e-14);
        }
    }
}
