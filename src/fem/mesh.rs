//! Structured meshes of a layer, with everything at the quadrature points that does not change during a simulation.

use std::array::from_fn;

use nalgebra::Vector2;

use super::element::{
    GAUSS, GAUSS_WEIGHTS, NODES, POINTS, pressure, pressure_derivative, quadratic, quadratic_derivative, tensor,
};

/// Position of a fraction -1..=1 (or 0..=1) after sinh grading towards 0; strength 0 is uniform.
pub fn graded(fraction: f64, strength: f64) -> f64 {
    if strength == 0.0 { fraction } else { (strength * fraction).sinh() / strength.sinh() }
}

/// Ends and middles of `count` elements whose ends are `end(0), ..., end(count)`.
pub fn quadratic_stations(count: usize, end: impl Fn(usize) -> f64) -> Vec<f64> {
    (0..=2 * count).map(|i| if i % 2 == 0 { end(i / 2) } else { 0.5 * (end(i / 2) + end(i / 2 + 1)) }).collect()
}

/// Derivatives with respect to X and Y from those by the local coordinates s and t, with the Jacobian [dX/ds dX/dt dY/ds dY/dt].
#[inline(always)]
fn gradients([xs, xt, ys, yt]: [f64; 4], by_s: &[f64; NODES], by_t: &[f64; NODES]) -> [[f64; NODES]; 2] {
    let inverse = 1.0 / (xs * yt - xt * ys);
    let [xs, xt, ys, yt] = [xs, xt, ys, yt].map(|value| inverse * value);
    [from_fn(|a| yt * by_s[a] - ys * by_t[a]), from_fn(|a| xs * by_t[a] - xt * by_s[a])]
}

/// What the weak forms need at one quadrature point.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    /// Quadrature weight times Jacobian \[m^2\].
    pub weight: f64,
    /// d(shape function)/dX and d/dY of the displacement's nodes \[1/m\].
    pub gradients: [[f64; NODES]; 2],
    /// Velocity of the rotating body per unit of surface speed \[1\].
    pub velocity: [f64; 2],
}

/// What the weak forms need at one quadrature point of an end of the layer.
#[derive(Debug, Clone, Copy)]
pub struct EndPoint {
    /// Velocity outwards through the end per unit of surface speed, times quadrature weight times length \[m\].
    pub outflow: f64,
    /// d(shape function)/dX and d/dY of the displacement's nodes \[1/m\].
    pub gradients: [[f64; NODES]; 2],
    /// Values of the pressure's shape functions.
    pub pressure_shape: [f64; NODES],
}

/// A layer meshed with `columns` x `rows` biquadratic elements.
///
/// Nodes lie on stations along the surface and levels inwards; node (station, level) has index
/// `station * levels + level`, level 0 being the articular surface.
#[derive(Debug, Clone)]
pub struct LayerMesh {
    /// Elements along the surface.
    pub columns: usize,
    /// Elements through the thickness.
    pub rows: usize,
    /// Reference positions of the nodes \[m\].
    pub nodes: Vec<[f64; 2]>,
    /// Order of the pressure's shape functions.
    pub pressure_order: i32,
    /// Depth of the levels below the surface, as a fraction of the thickness.
    pub depths: Vec<f64>,
    points: Vec<Point>,
    pressure_gradients: Vec<[[f64; NODES]; 2]>,
    /// Of the elements of the first and of the last column.
    ends: [Vec<[EndPoint; 3]>; 2],
    /// Values of the displacement's shape functions at the quadrature points.
    pub shape: [[f64; NODES]; POINTS],
    /// Values of the pressure's shape functions at the quadrature points.
    pub pressure_shape: [[f64; NODES]; POINTS],
}

impl LayerMesh {
    /// Meshes the image of stations x levels under `position`; `velocity` is that of the material per unit of surface speed.
    pub fn new(
        [columns, rows]: [usize; 2],
        pressure_order: i32,
        position: impl Fn(usize, usize) -> [f64; 2],
        velocity: impl Fn([f64; 2]) -> [f64; 2],
    ) -> Self {
        let levels = 2 * rows + 1;
        let nodes: Vec<_> =
            (0..=2 * columns).flat_map(|i| (0..levels).map(move |j| (i, j))).map(|(i, j)| position(i, j)).collect();
        let at_points = |f: &dyn Fn(f64, f64) -> [f64; NODES]| -> [[f64; NODES]; POINTS] {
            from_fn(|q| f(GAUSS[q % 3], GAUSS[q / 3]))
        };
        let shape = at_points(&|s, t| tensor(quadratic(s), quadratic(t)));
        let by_s = at_points(&|s, t| tensor(quadratic_derivative(s), quadratic(t)));
        let by_t = at_points(&|s, t| tensor(quadratic(s), quadratic_derivative(t)));
        let pressure_shape = at_points(&|s, t| tensor(pressure(pressure_order, s), pressure(pressure_order, t)));
        let pressure_by_s =
            at_points(&|s, t| tensor(pressure_derivative(pressure_order, s), pressure(pressure_order, t)));
        let pressure_by_t =
            at_points(&|s, t| tensor(pressure(pressure_order, s), pressure_derivative(pressure_order, t)));

        let [x, y] = nodes[0];
        let below: Vec<f64> = nodes[..levels].iter().map(|at| (at[0] - x).hypot(at[1] - y)).collect();
        let mut mesh = Self {
            depths: below.iter().map(|depth| depth / below[levels - 1]).collect(),
            columns,
            rows,
            nodes,
            pressure_order,
            points: Vec::with_capacity(columns * rows * POINTS),
            pressure_gradients: Vec::new(),
            ends: [Vec::new(), Vec::new()],
            shape,
            pressure_shape,
        };
        // A mesh that goes with the contact is made anew twice a step: with the processor's vectors.
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || {
                for element in 0..columns * rows {
                    let at = mesh.element_nodes(element).map(|n| mesh.nodes[n]);
                    for q in 0..POINTS {
                        // At the point: place, and its derivatives with respect to the local coordinates.
                        let (mut place, mut along_s, mut along_t) = ([0.0; 2], [0.0; 2], [0.0; 2]);
                        for (a, at) in at.iter().enumerate() {
                            for k in 0..2 {
                                place[k] += shape[q][a] * at[k];
                                along_s[k] += by_s[q][a] * at[k];
                                along_t[k] += by_t[q][a] * at[k];
                            }
                        }
                        let jacobian @ [xs, xt, ys, yt] = [along_s[0], along_t[0], along_s[1], along_t[1]];
                        mesh.points.push(Point {
                            weight: (xs * yt - xt * ys).abs() * GAUSS_WEIGHTS[q % 3] * GAUSS_WEIGHTS[q / 3],
                            gradients: gradients(jacobian, &by_s[q], &by_t[q]),
                            velocity: velocity(place),
                        });
                        if pressure_order != 2 {
                            mesh.pressure_gradients.push(gradients(jacobian, &pressure_by_s[q], &pressure_by_t[q]));
                        }
                    }
                }
            },
        );
        mesh.ends = [(0, -1.0), (columns - 1, 1.0)].map(|(column, s)| {
            let element = |row| from_fn(|q| mesh.end_point(column * rows + row, s, q, &velocity));
            (0..rows).map(element).collect()
        });
        mesh
    }

    /// Quadrature point `q` of the edge of an element at its local coordinate `s` = -1 or 1.
    fn end_point(&self, element: usize, s: f64, q: usize, velocity: &impl Fn([f64; 2]) -> [f64; 2]) -> EndPoint {
        let t = GAUSS[q];
        let nodes = self.element_nodes(element).map(|n| self.nodes[n]);
        let sum = |values: &[f64; NODES], k: usize| -> f64 { (0..NODES).map(|a| values[a] * nodes[a][k]).sum() };
        let shape = tensor(quadratic(s), quadratic(t));
        let (by_s, by_t) =
            (tensor(quadratic_derivative(s), quadratic(t)), tensor(quadratic(s), quadratic_derivative(t)));
        let jacobian = [sum(&by_s, 0), sum(&by_t, 0), sum(&by_s, 1), sum(&by_t, 1)];
        let [xs, xt, ys, yt] = jacobian;
        let v = velocity([sum(&shape, 0), sum(&shape, 1)]);
        // The outward normal is along the gradient of s, with its sign.
        let outwards = s * (xs * yt - xt * ys).signum();
        EndPoint {
            outflow: GAUSS_WEIGHTS[q] * outwards * (v[0] * yt - v[1] * xt),
            gradients: gradients(jacobian, &by_s, &by_t),
            pressure_shape: tensor(pressure(self.pressure_order, s), pressure(self.pressure_order, t)),
        }
    }

    /// Quadrature points of those edges of an element that lie on an end of the layer.
    pub fn end_points(&self, element: usize) -> impl Iterator<Item = &EndPoint> {
        let (column, row) = (element / self.rows, element % self.rows);
        let first = (column == 0).then(|| &self.ends[0][row]);
        let last = (column + 1 == self.columns).then(|| &self.ends[1][row]);
        first.into_iter().chain(last).flatten()
    }

    /// A cartilage layer on the outside of a circle that touches y = 0 at x = 0 from above (`side` = 1) or from below (-1); on its inside
    /// where the radius is negative, and a flat one where it is infinite.
    ///
    /// `stations` are the x of the surface nodes \[m\], `depths` the distances of the levels from the surface \[m\].
    pub fn sector(stations: &[f64], depths: &[f64], radius: f64, side: f64, pressure_order: i32) -> Self {
        let curvature = 1.0 / radius;
        Self::new(
            [stations.len() / 2, depths.len() / 2],
            pressure_order,
            |i, j| {
                let (x, sine) = (stations[i], stations[i] * curvature);
                // (1 - cos)/sin without cancellation
                let half_tangent = sine / (1.0 + (1.0 - sine * sine).sqrt());
                [x - depths[j] * sine, side * (x * half_tangent + depths[j] * (1.0 - sine * half_tangent))]
            },
            |[x, y]| [1.0 - side * y * curvature, side * x * curvature],
        )
    }

    /// Number of node levels through the thickness.
    pub fn levels(&self) -> usize {
        2 * self.rows + 1
    }

    /// Number of elements; element (column, row) has index `column * rows + row`.
    pub fn elements(&self) -> usize {
        self.columns * self.rows
    }

    /// Node indices of an element.
    pub fn element_nodes(&self, element: usize) -> [usize; NODES] {
        let (column, row) = (element / self.rows, element % self.rows);
        from_fn(|a| (2 * column + a % 3) * self.levels() + 2 * row + a / 3)
    }

    /// The direction along the layer at a node, of any length: across the line of its station through the depth.
    pub fn along(&self, node: usize) -> Vector2<f64> {
        let surface = node - node % self.levels();
        let ([x, y], [below_x, below_y]) = (self.nodes[surface], self.nodes[surface + self.levels() - 1]);
        Vector2::new(y - below_y, below_x - x)
    }

    /// Depth of a quadrature point below the surface, as a fraction of the thickness.
    pub fn point_depth(&self, element: usize, point: usize) -> f64 {
        let first = 2 * (element % self.rows);
        quadratic(GAUSS[point / 3]).iter().zip(&self.depths[first..]).map(|(shape, depth)| shape * depth).sum()
    }

    /// Geometry at the quadrature points of an element.
    pub fn points(&self, element: usize) -> &[Point] {
        &self.points[element * POINTS..(element + 1) * POINTS]
    }

    /// Gradients of the pressure's shape functions at a quadrature point of an element \[1/m\].
    pub fn pressure_gradients(&self, element: usize, point: usize) -> &[[f64; NODES]; 2] {
        let index = element * POINTS + point;
        if self.pressure_order == 2 { &self.points[index].gradients } else { &self.pressure_gradients[index] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn sector(side: f64) -> LayerMesh {
        let stations = quadratic_stations(20, |i| 8e-3 * graded(f64::from(i as u32) / 10.0 - 1.0, 2.0));
        let depths = quadratic_stations(4, |j| 1e-3 * graded(f64::from(j as u32) / 4.0, 2.0));
        LayerMesh::sector(&stations, &depths, 0.1, side, 1)
    }

    #[test]
    fn area_is_that_of_the_sector() {
        let angle = 2.0 * (8e-3_f64 / 0.1).asin();
        let exact = 0.5 * angle * (0.1_f64.powi(2) - 0.099_f64.powi(2));
        for side in [1.0, -1.0] {
            let mesh = sector(side);
            let area: f64 = (0..mesh.elements()).flat_map(|e| mesh.points(e).iter().map(|p| p.weight)).sum();
            assert_relative_eq!(area, exact, max_relative = 1e-7);
        }
    }

    #[test]
    fn depths_are_distances_from_the_surface() {
        for side in [1.0, -1.0] {
            let mesh = sector(side);
            for element in [0, 2, 37, 79] {
                let nodes = mesh.element_nodes(element).map(|n| mesh.nodes[n]);
                for q in 0..POINTS {
                    let place = |k: usize| -> f64 { (0..NODES).map(|a| mesh.shape[q][a] * nodes[a][k]).sum() };
                    let radius = place(0).hypot(place(1) - side * 0.1);
                    assert_relative_eq!(mesh.point_depth(element, q), (0.1 - radius) / 1e-3, epsilon = 1e-4);
                }
            }
            assert_eq!((mesh.depths[0], mesh.depths[mesh.levels() - 1]), (0.0, 1.0));
        }
    }

    #[test]
    fn gradients_differentiate_linear_fields_and_the_body_rotates_with_unit_surface_speed() {
        for side in [1.0, -1.0] {
            let mesh = sector(side);
            for element in [0, 37, 79] {
                let nodes = mesh.element_nodes(element).map(|n| mesh.nodes[n]);
                for (q, point) in mesh.points(element).iter().enumerate() {
                    let field = |[x, y]: [f64; 2]| 2.0 * x - 3.0 * y + 1.0;
                    for (k, expected) in [(0, 2.0), (1, -3.0)] {
                        let sum: f64 = (0..NODES).map(|a| point.gradients[k][a] * field(nodes[a])).sum();
                        assert_relative_eq!(sum, expected, max_relative = 1e-9);
                        assert_relative_eq!(
                            mesh.pressure_gradients(element, q)[k].iter().sum::<f64>(),
                            0.0,
                            epsilon = 1e-9
                        );
                    }
                    // About (0, side R), so that the lowest or highest point moves along +x with speed 1.
                    let place = |k: usize| (0..NODES).map(|a| mesh.shape[q][a] * nodes[a][k]).sum::<f64>();
                    let rotation = [1.0 - side * place(1) / 0.1, side * place(0) / 0.1];
                    assert_relative_eq!(point.velocity[0], rotation[0], max_relative = 1e-12);
                    assert_relative_eq!(point.velocity[1], rotation[1], max_relative = 1e-12, epsilon = 1e-15);
                }
            }
        }
    }
}
