//! Elements with a displacement and a pressure: the fields at the quadrature points, and the sums over them.
//!
//! A weak form, with test functions v of the displacement u and w of the pressure p, is an [`Integrand`] at every point,
//!
//! ```text
//! int stress : grad v + force . v + flow . grad w + storage w
//! ```
//!
//! and its derivatives with respect to grad u, p and grad p, the [`IntegrandDerivatives`]. Sums over the nodes are done a vector of a
//! processor's registers at a time. [`scatter`] takes what comes out to the unknowns.

use nalgebra::{Matrix2, Matrix2x4, Matrix4, Vector2, Vector4};
use pulp::{Simd, WithSimd};

use super::element::{NODES, POINTS};
use super::mesh::LayerMesh;

/// Local unknowns of an element: nine horizontal displacements, nine vertical ones, nine pressures.
pub const LOCAL: usize = 3 * NODES;

/// Values or residuals over the local unknowns.
pub type Local = [f64; LOCAL];

/// Adds the values of an element to those of the unknowns with these numbers; a number beyond them is that of a fixed one.
pub fn scatter(local: &[f64], numbers: &[u32], values: &mut [f64]) {
    for (local, number) in local.iter().zip(numbers) {
        if let Some(value) = values.get_mut(*number as usize) {
            *value += local;
        }
    }
}

/// The fields at a quadrature point.
pub struct PointFields {
    /// grad u, with du_i / dX_j in row i.
    pub displacement_gradient: Matrix2<f64>,
    /// p.
    pub pressure: f64,
    /// grad p.
    pub pressure_gradient: Vector2<f64>,
}

/// What the test functions are multiplied with at a quadrature point.
#[derive(Default)]
pub struct Integrand {
    /// With grad v.
    pub stress: Matrix2<f64>,
    /// With v.
    pub force: Vector2<f64>,
    /// With grad w.
    pub flow: Vector2<f64>,
    /// With w.
    pub storage: f64,
}

/// Derivatives of an [`Integrand`]; tensors as vectors in the order 11, 12, 21, 22.
#[derive(Default)]
pub struct IntegrandDerivatives {
    /// d stress / d grad u.
    pub stress_by_strain: Matrix4<f64>,
    /// d stress / d p.
    pub stress_by_pressure: Vector4<f64>,
    /// d force / d grad p, a factor of the unit tensor.
    pub force_by_pressure_gradient: f64,
    /// d flow / d grad u.
    pub flow_by_strain: Matrix2x4<f64>,
    /// d flow / d p.
    pub flow_by_pressure: Vector2<f64>,
    /// d flow / d grad p.
    pub flow_by_pressure_gradient: Matrix2<f64>,
    /// d storage / d grad u.
    pub storage_by_strain: Vector4<f64>,
    /// d storage / d p.
    pub storage_by_pressure: f64,
}

/// Both displacements and the pressure at a node, or what belongs to them, and nothing: as many as fit in a vector.
type Nodal = [f64; 4];

/// The fields of an element.
pub struct ElementFields<'a> {
    mesh: &'a LayerMesh,
    element: usize,
    nodal: [Nodal; NODES],
}

impl<'a> ElementFields<'a> {
    /// From the local unknowns.
    #[inline(always)]
    pub fn new(mesh: &'a LayerMesh, element: usize, at: &Local) -> Self {
        Self { mesh, element, nodal: std::array::from_fn(|a| [at[a], at[NODES + a], at[2 * NODES + a], 0.0]) }
    }

    /// At a quadrature point.
    #[inline(always)]
    pub fn at(&self, point: usize) -> PointFields {
        let sum = |function: &[f64; NODES]| sum(function, &self.nodal);
        let [gx, gy] = &self.mesh.points(self.element)[point].gradients;
        let (by_x, by_y) = (sum(gx), sum(gy));
        let pressure_gradient = if self.mesh.pressure_order == 2 {
            Vector2::new(by_x[2], by_y[2])
        } else {
            let [px, py] = self.mesh.pressure_gradients(self.element, point);
            Vector2::new(sum(px)[2], sum(py)[2])
        };
        PointFields {
            displacement_gradient: Matrix2::new(by_x[0], by_y[0], by_x[1], by_y[1]),
            pressure: sum(&self.mesh.pressure_shape[point])[2],
            pressure_gradient,
        }
    }
}

/// The residual of an element, summed up over the quadrature points.
pub struct ResidualSum<'a> {
    mesh: &'a LayerMesh,
    element: usize,
    nodal: [Nodal; NODES],
}

impl<'a> ResidualSum<'a> {
    /// Nothing yet.
    #[inline(always)]
    pub fn new(mesh: &'a LayerMesh, element: usize) -> Self {
        Self { mesh, element, nodal: [[0.0; 4]; NODES] }
    }

    /// Adds a quadrature point.
    #[inline(always)]
    pub fn add(&mut self, point: usize, integrand: &Integrand) {
        let Integrand { stress, force, flow, storage } = integrand;
        let mesh = self.mesh;
        let at = &mesh.points(self.element)[point];
        let mut add = |function: &[f64; NODES], values: [f64; 3]| {
            let weighted = [at.weight * values[0], at.weight * values[1], at.weight * values[2], 0.0];
            add_outer(&mut self.nodal, function, &weighted);
        };
        let [gx, gy] = &at.gradients;
        if mesh.pressure_order == 2 {
            add(gx, [stress.m11, stress.m21, flow.x]);
            add(gy, [stress.m12, stress.m22, flow.y]);
        } else {
            let [px, py] = mesh.pressure_gradients(self.element, point);
            add(gx, [stress.m11, stress.m21, 0.0]);
            add(gy, [stress.m12, stress.m22, 0.0]);
            add(px, [0.0, 0.0, flow.x]);
            add(py, [0.0, 0.0, flow.y]);
        }
        // Many weak forms have one of these or none.
        if *force != Vector2::zeros() {
            add(&mesh.shape[point], [force.x, force.y, 0.0]);
        }
        if *storage != 0.0 {
            add(&mesh.pressure_shape[point], [0.0, 0.0, *storage]);
        }
    }

    /// Adds the sum to the residual of the element.
    #[inline(always)]
    pub fn add_to(self, residual: &mut Local) {
        for (a, values) in self.nodal.into_iter().enumerate() {
            (0..3).for_each(|field| residual[field * NODES + a] += values[field]);
        }
    }
}

/// Sum over the nodes of a function's values times the fields.
#[inline(always)]
fn sum(function: &[f64; NODES], nodal: &[Nodal; NODES]) -> Nodal {
    let mut sum = [0.0; 4];
    for (value, nodal) in function.iter().zip(nodal) {
        sum.iter_mut().zip(nodal).for_each(|(sum, field)| *sum += value * field);
    }
    sum
}

/// Adds a function's value at every node times the fields.
#[inline(always)]
fn add_outer(sums: &mut [Nodal; NODES], function: &[f64; NODES], fields: &Nodal) {
    for (sum, value) in sums.iter_mut().zip(function) {
        sum.iter_mut().zip(fields).for_each(|(sum, field)| *sum += value * field);
    }
}

/// The tangent of an element before summation over the quadrature points: test functions, and what is multiplied with them.
///
/// Rows of the tables: both derivatives of the test functions at one point after the other, then (fluid only) the test functions.
/// It is large: make it in place.
pub struct TangentFactors {
    gradients: [Padded; 2 * POINTS],
    shapes: [Padded; POINTS],
    pressures: [Padded; 3 * POINTS],
    /// Stress by the fields, for each component of the force balance.
    stress: [[[Padded; 2 * POINTS]; 3]; 2],
    /// Force by the pressures, likewise.
    force: [[Padded; POINTS]; 2],
    /// Flow and storage by the fields.
    fluid: [[Padded; 3 * POINTS]; 3],
    /// Whether the force, the stress by the pressures, and the storage are anything but zero.
    has: Has,
}

struct Has {
    force: bool,
    stress_by_pressure: bool,
    storage: bool,
}

impl TangentFactors {
    /// Nothing yet.
    pub const NONE: Self = {
        let none = [0.0; 12];
        Self {
            gradients: [none; 2 * POINTS],
            shapes: [none; POINTS],
            pressures: [none; 3 * POINTS],
            stress: [[[none; 2 * POINTS]; 3]; 2],
            force: [[none; POINTS]; 2],
            fluid: [[none; 3 * POINTS]; 3],
            has: Has { force: false, stress_by_pressure: false, storage: false },
        }
    };

    /// Sets what belongs to a quadrature point.
    #[inline(always)]
    pub fn set(&mut self, mesh: &LayerMesh, element: usize, q: usize, derivatives: &IntegrandDerivatives) {
        let d = derivatives;
        let point = &mesh.points(element)[q];
        let weight = point.weight;
        let gradients = point.gradients.each_ref().map(padded);
        let pressures = mesh.pressure_gradients(element, q).each_ref().map(padded);
        let value = padded(&mesh.pressure_shape[q]);
        let along = |[gx, gy]: &[Padded; 2], a: f64, b: f64| {
            let (a, b, mut sum) = (weight * a, weight * b, [0.0; 12]);
            sum.iter_mut().zip(gx.iter().zip(gy)).for_each(|(sum, (x, y))| *sum = a * x + b * y);
            sum
        };
        // Columns of the displacements: along a component of the displacement gradient.
        for k in 0..2 {
            for i in 0..4 {
                self.stress[i / 2][k][2 * q + i % 2] =
                    along(&gradients, d.stress_by_strain[(i, 2 * k)], d.stress_by_strain[(i, 2 * k + 1)]);
            }
            for i in 0..2 {
                self.fluid[k][2 * q + i] =
                    along(&gradients, d.flow_by_strain[(i, 2 * k)], d.flow_by_strain[(i, 2 * k + 1)]);
            }
            self.fluid[k][2 * POINTS + q] =
                along(&gradients, d.storage_by_strain[2 * k], d.storage_by_strain[2 * k + 1]);
        }
        // Columns of the pressures.
        if d.stress_by_pressure != Vector4::zeros() {
            self.has.stress_by_pressure = true;
            for i in 0..4 {
                let factor = weight * d.stress_by_pressure[i];
                self.stress[i / 2][2][2 * q + i % 2] = value.map(|v| factor * v);
            }
        }
        if d.force_by_pressure_gradient != 0.0 {
            self.has.force = true;
            let factor = weight * d.force_by_pressure_gradient;
            (0..2).for_each(|k| self.force[k][q] = pressures[k].map(|v| factor * v));
        }
        for i in 0..2 {
            let by_value = weight * d.flow_by_pressure[i];
            let mut row = along(&pressures, d.flow_by_pressure_gradient[(i, 0)], d.flow_by_pressure_gradient[(i, 1)]);
            row.iter_mut().zip(&value).for_each(|(row, v)| *row += by_value * v);
            self.fluid[2][2 * q + i] = row;
        }
        let factor = weight * d.storage_by_pressure;
        self.fluid[2][2 * POINTS + q] = value.map(|v| factor * v);
        self.has.storage |= d.storage_by_strain != Vector4::zeros() || d.storage_by_pressure != 0.0;
        for k in 0..2 {
            self.gradients[2 * q + k] = gradients[k];
            self.pressures[2 * q + k] = pressures[k];
        }
        self.shapes[q] = padded(&mesh.shape[q]);
        self.pressures[2 * POINTS + q] = value;
    }

    /// Adds the sums over all points to the tangent of the element.
    pub fn add_to(&self, tangent: &mut [f64; LOCAL * LOCAL]) {
        let fluid = if self.has.storage { 3 * POINTS } else { 2 * POINTS };
        let blocks: [Block<'_>; 11] = std::array::from_fn(|index| {
            let (row, column) = (index / 3, index % 3);
            let (tests, factors, at) = match (row, column) {
                (2, _) => (&self.pressures[..fluid], &self.fluid[column][..fluid], [row, column]),
                (3, _) => (&self.shapes[..], &self.force[column][..], [column, 2]),
                _ => (&self.gradients[..], &self.stress[row][column][..], [row, column]),
            };
            let given = match (row, column) {
                (3, _) => self.has.force,
                (0 | 1, 2) => self.has.stress_by_pressure,
                _ => true,
            };
            let terms = if given { tests.len() } else { 0 };
            Block { tests: &tests[..terms], factors: &factors[..terms], at: at.map(|field| field * NODES) }
        });
        add_products(&blocks, tangent, LOCAL);
    }
}

/// Values for the nodes of an element, filled up with zeros to whole vectors of a processor's registers.
type Padded = [f64; 12];

/// Values for the nodes, filled up.
fn padded(values: &[f64; NODES]) -> Padded {
    let mut padded = [0.0; 12];
    padded[..NODES].copy_from_slice(values);
    padded
}

/// One block of an element matrix: for every pair of nodes a, b the sum over t of tests[t][a] * factors[t][b].
struct Block<'a> {
    /// Test functions or their derivatives, at one quadrature point after another.
    tests: &'a [Padded],
    /// As many factors.
    factors: &'a [Padded],
    /// First row and first column of the block.
    at: [usize; 2],
}

/// Adds the blocks to a column-major matrix with `rows` rows.
fn add_products(blocks: &[Block<'_>], matrix: &mut [f64], rows: usize) {
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
        for Block { tests, factors, at: [row, column] } in self.blocks.iter().filter(|block| !block.tests.is_empty()) {
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
