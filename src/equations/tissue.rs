//! The poroelastic tissue of one body.
//!
//! With test functions v and w, per unit depth, over the reference layer (section 2.2 of de Boer et al. 2020; fluid mass divided
//! by the density at ambient pressure, r = rho/rho0 = exp(chi p)):
//!
//! paper:       int P_eff : grad v + alpha grad p . v
//! consistent:  int (P_eff - alpha p J F^-T) : grad v   (+ the film's pressure on the surface, [`surface_pressure`])
//! both:        int r K grad p . grad w - alpha r (J - 1) U_i v_rot . grad w + alpha r dJ/dt w
//!
//! U_i v_rot is the rigid rotation of the body with surface speed U_i; the convective term v . grad J is integrated by parts, so
//! that no second derivatives of the displacement appear (its density-gradient part, of order chi p = 1e-5, is dropped).

use nalgebra::{Matrix2, Vector2};
use pulp::{Simd, WithSimd};

use crate::fem::element::{GAUSS, GAUSS_WEIGHTS, NODES, POINTS, quadratic, quadratic_derivative};
use crate::fem::mesh::LayerMesh;
use crate::fem::products::{Block, Padded, add_products, padded};
use crate::laws::darcy::{HolmesMow, conductance, conductance_derivative};
use crate::laws::neo_hookean::{COFACTOR_DERIVATIVE, NeoHookean, Strain, flatten};

/// Local unknowns of an element: nine horizontal displacements, nine vertical ones, nine pressures.
pub const LOCAL: usize = 3 * NODES;

/// Values or residuals over the local unknowns.
pub type Local = [f64; LOCAL];

/// The material of one body and the balance laws it obeys.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tissue {
    /// Drained solid, moduli weighted as the formulation says.
    pub solid: NeoHookean,
    /// Biot-Willis coefficient alpha [1].
    pub biot_coefficient: f64,
    /// Hydraulic permeability kappa/eta of the undeformed tissue [m^4/(N s)].
    pub mobility: f64,
    /// How it answers to strain; `None` where it does not.
    pub strain_dependence: Option<HolmesMow>,
    /// Compressibility chi of the fluid [1/Pa].
    pub fluid_compressibility: f64,
    /// Whether stress and Darcy's law are those of the consistent formulation.
    pub consistent: bool,
}

/// How fast an element's volume changes: dJ/dt = rate * J + history, by the time integration; steady is rate = history = 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct VolumeRate {
    /// Factor of J [1/s].
    pub rate: f64,
    /// The rest of the difference formula, at each quadrature point [1/s].
    pub history: [f64; POINTS],
}

/// The tangent before summation over the quadrature points: test functions, and what is multiplied with them.
///
/// Rows of the tables: both derivatives of the test functions at one point after the other, then (fluid only) the test functions.
struct Factors {
    gradients: [Padded; 2 * POINTS],
    shapes: [Padded; POINTS],
    pressures: [Padded; 3 * POINTS],
    /// Stress by the fields, for each component of the force balance.
    stress: [[[Padded; 2 * POINTS]; 3]; 2],
    /// Force of the pressure on the tissue by the pressures, likewise.
    force: [[Padded; POINTS]; 2],
    /// Flow and storage by the fields.
    fluid: [[Padded; 3 * POINTS]; 3],
}

impl Factors {
    const NONE: Self = {
        let none = [0.0; 12];
        Self {
            gradients: [none; 2 * POINTS],
            shapes: [none; POINTS],
            pressures: [none; 3 * POINTS],
            stress: [[[none; 2 * POINTS]; 3]; 2],
            force: [[none; POINTS]; 2],
            fluid: [[none; 3 * POINTS]; 3],
        }
    };

    /// The test functions at a point.
    fn test(&mut self, q: usize, gradients: [&Padded; 2], shape: &Padded, pressure: [&Padded; 2], value: &Padded) {
        for k in 0..2 {
            self.gradients[2 * q + k] = *gradients[k];
            self.pressures[2 * q + k] = *pressure[k];
        }
        self.shapes[q] = *shape;
        self.pressures[2 * POINTS + q] = *value;
    }

    /// Adds the sums over all points.
    fn multiply(&self, tangent: &mut [f64; LOCAL * LOCAL], consistent: bool, storage: bool) {
        let fluid = if storage { 3 * POINTS } else { 2 * POINTS };
        let blocks: [Block<'_>; 9] = std::array::from_fn(|index| {
            let (row, column) = (index / 3, index % 3);
            let (tests, factors) = match (row, column) {
                (2, _) => (&self.pressures[..fluid], &self.fluid[column][..fluid]),
                (_, 2) if !consistent => (&self.shapes[..], &self.force[row][..]),
                _ => (&self.gradients[..], &self.stress[row][column][..]),
            };
            Block { tests, factors, at: [row * NODES, column * NODES] }
        });
        add_products(&blocks, tangent, LOCAL);
    }
}

/// a * x + b * y
fn combined(a: f64, x: &Padded, b: f64, y: &Padded) -> Padded {
    std::array::from_fn(|i| a * x[i] + b * y[i])
}

/// The element has turned inside out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("an element of the tissue is turned inside out")]
pub struct Inverted;

/// What is wanted of an element; matrices are column-major over the local unknowns.
pub struct ElementTerms<'a> {
    /// Added to: the residual.
    pub residual: Option<&'a mut Local>,
    /// Added to: its derivative with respect to the surface speed.
    pub by_speed: Option<&'a mut Local>,
    /// Added to: its derivative with respect to the local unknowns.
    pub tangent: Option<&'a mut [f64; LOCAL * LOCAL]>,
}

/// An element with all that its terms depend on.
struct Element<'a, 'b> {
    tissue: &'a Tissue,
    mesh: &'a LayerMesh,
    element: usize,
    at: &'a Local,
    speed: f64,
    volume_rate: &'a VolumeRate,
    terms: ElementTerms<'b>,
}

/// Compiled once for each kind of processor.
impl WithSimd for Element<'_, '_> {
    type Output = Result<(), Inverted>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.tissue.add_element(self)
    }
}

impl Tissue {
    /// Hydraulic permeability of the strained tissue [m^4/(N s)], and its derivative by the volume ratio.
    pub fn mobility_at(&self, strain: &Strain) -> (f64, f64) {
        let Some(law) = &self.strain_dependence else { return (self.mobility, 0.0) };
        let (relative, slope) = law.relative_permeability(strain.volume_change);
        (self.mobility * relative, self.mobility * slope)
    }

    /// Adds the terms of one element at local values `at`, moving with `speed` [m/s].
    ///
    /// # Errors
    /// [`Inverted`] where J <= 0 at a quadrature point.
    pub fn element(
        &self,
        mesh: &LayerMesh,
        element: usize,
        at: &Local,
        speed: f64,
        volume_rate: &VolumeRate,
        terms: ElementTerms<'_>,
    ) -> Result<(), Inverted> {
        let asked = Element { tissue: self, mesh, element, at, speed, volume_rate, terms };
        match asked.terms.tangent {
            // Most of its work is in products, which have their own; and valgrind does not know all that would come of this.
            Some(_) => self.add_element(asked),
            None => pulp::Arch::new().dispatch(asked),
        }
    }

    #[inline(always)]
    fn add_element(&self, asked: Element<'_, '_>) -> Result<(), Inverted> {
        let Element { mesh, element, at, speed, volume_rate, mut terms, .. } = asked;
        let alpha = self.biot_coefficient;
        let fields: [Fields; NODES] = std::array::from_fn(|a| [at[a], at[NODES + a], at[2 * NODES + a], 0.0]);
        let mut residuals = [[0.0; 4]; NODES];
        // Made in place, and only where it is needed: it is large.
        let mut room;
        let mut factors = match terms.tangent {
            Some(_) => {
                room = Factors::NONE;
                Some(&mut room)
            }
            None => None,
        };
        for (q, point) in mesh.points(element).iter().enumerate() {
            let [gx, gy] = &point.gradients;
            let [px, py] = mesh.pressure_gradients(element, q);
            let (shape, pressure_shape) = (&mesh.shape[q], &mesh.pressure_shape[q]);
            let [by_x, by_y] = [gx, gy].map(|gradient| sum(gradient, &fields));
            let strain = Strain::new(Matrix2::new(by_x[0], by_y[0], by_x[1], by_y[1]));
            let pressure = sum(pressure_shape, &fields)[2];
            let pressure_gradient = if mesh.pressure_order == 2 {
                Vector2::new(by_x[2], by_y[2])
            } else {
                Vector2::new(sum(px, &fields)[2], sum(py, &fields)[2])
            };
            if strain.volume_ratio() <= 0.0 || !strain.volume_change.is_finite() {
                return Err(Inverted);
            }
            let density = (self.fluid_compressibility * pressure).exp();
            let rotation = Vector2::from(point.velocity);
            let (mobility, mobility_by_volume) = self.mobility_at(&strain);
            let conductance = conductance(mobility, &strain, self.consistent);
            let convected = rotation * (-alpha * strain.volume_change);
            let seepage = conductance * pressure_gradient;
            let flow = seepage + convected * speed;
            let volume_change_rate = volume_rate.rate * strain.volume_ratio() + volume_rate.history[q];
            let weight = point.weight;

            if terms.residual.is_some() {
                let mut stress = self.solid.stress(&strain);
                let mut force = pressure_gradient * alpha;
                if self.consistent {
                    stress -= strain.cofactor * (alpha * pressure);
                    force = Vector2::zeros();
                }
                let fluid = density * alpha * volume_change_rate;
                let flow = flow * density;
                let weighted = |values: [f64; 3]| [weight * values[0], weight * values[1], weight * values[2], 0.0];
                if mesh.pressure_order == 2 {
                    add_outer(&mut residuals, gx, &weighted([stress.m11, stress.m21, flow.x]));
                    add_outer(&mut residuals, gy, &weighted([stress.m12, stress.m22, flow.y]));
                } else {
                    add_outer(&mut residuals, gx, &weighted([stress.m11, stress.m21, 0.0]));
                    add_outer(&mut residuals, gy, &weighted([stress.m12, stress.m22, 0.0]));
                    add_outer(&mut residuals, px, &weighted([0.0, 0.0, flow.x]));
                    add_outer(&mut residuals, py, &weighted([0.0, 0.0, flow.y]));
                }
                if !self.consistent {
                    add_outer(&mut residuals, shape, &weighted([force.x, force.y, 0.0]));
                }
                if fluid != 0.0 {
                    add_outer(&mut residuals, pressure_shape, &weighted([0.0, 0.0, fluid]));
                }
            }
            if let Some(by_speed) = &mut terms.by_speed {
                for a in 0..NODES {
                    by_speed[2 * NODES + a] += weight * density * (convected.x * px[a] + convected.y * py[a]);
                }
            }
            if let Some(factors) = &mut factors {
                let mut stress_by_strain = self.solid.tangent(&strain);
                let cofactor = flatten(&strain.cofactor);
                let mut flow_by_strain = Vector2::new(rotation.x, rotation.y) * cofactor.transpose() * (-alpha * speed);
                if self.consistent {
                    for row in 0..4 {
                        for column in 0..4 {
                            stress_by_strain[(row, column)] -= alpha * pressure * COFACTOR_DERIVATIVE[row][column];
                        }
                    }
                    flow_by_strain += conductance_derivative(mobility, &strain, &pressure_gradient);
                }
                if self.strain_dependence.is_some() {
                    flow_by_strain += seepage * cofactor.transpose() * (mobility_by_volume / mobility);
                }
                let fluid = weight * density;
                let storage_by_volume = fluid * alpha * volume_rate.rate;
                let chi = self.fluid_compressibility;
                let [gx, gy, px, py, value] = [gx, gy, px, py, pressure_shape].map(padded);
                factors.test(q, [&gx, &gy], &padded(shape), [&px, &py], &value);
                // Columns of the displacements: along a component of the displacement gradient.
                for k in 0..2 {
                    let along = |factor: f64, row: [f64; 2]| combined(factor * row[0], &gx, factor * row[1], &gy);
                    for i in 0..4 {
                        let row = [stress_by_strain[(i, 2 * k)], stress_by_strain[(i, 2 * k + 1)]];
                        factors.stress[i / 2][k][2 * q + i % 2] = along(weight, row);
                    }
                    for i in 0..2 {
                        let row = [flow_by_strain[(i, 2 * k)], flow_by_strain[(i, 2 * k + 1)]];
                        factors.fluid[k][2 * q + i] = along(fluid, row);
                    }
                    factors.fluid[k][2 * POINTS + q] = along(storage_by_volume, [cofactor[2 * k], cofactor[2 * k + 1]]);
                }
                // Columns of the pressures.
                if self.consistent {
                    for i in 0..4 {
                        factors.stress[i / 2][2][2 * q + i % 2] = value.map(|v| -alpha * weight * cofactor[i] * v);
                    }
                } else {
                    factors.force[0][q] = px.map(|v| alpha * weight * v);
                    factors.force[1][q] = py.map(|v| alpha * weight * v);
                }
                for i in 0..2 {
                    let by_gradient = combined(fluid * conductance[(i, 0)], &px, fluid * conductance[(i, 1)], &py);
                    factors.fluid[2][2 * q + i] = combined(1.0, &by_gradient, fluid * chi * flow[i], &value);
                }
                factors.fluid[2][2 * POINTS + q] = value.map(|v| fluid * alpha * volume_change_rate * chi * v);
            }
        }
        if let Some(residual) = terms.residual {
            for (a, values) in residuals.into_iter().enumerate() {
                (0..3).for_each(|field| residual[field * NODES + a] += values[field]);
            }
        }
        if let (Some(tangent), Some(factors)) = (terms.tangent, factors) {
            factors.multiply(tangent, self.consistent, *volume_rate != VolumeRate::default());
        }
        Ok(())
    }

    /// Residual of an element for dJ/dt alone, given at its quadrature points [1/s].
    pub fn storage(&self, mesh: &LayerMesh, element: usize, at: &Local, rate: &[f64; POINTS]) -> Local {
        let mut residual = [0.0; LOCAL];
        for (q, (point, rate)) in mesh.points(element).iter().zip(rate).enumerate() {
            let shape = &mesh.pressure_shape[q];
            let density = (self.fluid_compressibility * dot(shape, &at[2 * NODES..])).exp();
            let factor = point.weight * density * self.biot_coefficient * rate;
            for (r, shape) in residual[2 * NODES..].iter_mut().zip(shape) {
                *r += factor * shape;
            }
        }
        residual
    }

    /// Displacement gradient at a quadrature point.
    pub fn strain(mesh: &LayerMesh, element: usize, point: usize, at: &Local) -> Strain {
        let [gx, gy] = &mesh.points(element)[point].gradients;
        let (ux, uy) = (&at[..NODES], &at[NODES..2 * NODES]);
        Strain::new(Matrix2::new(dot(gx, ux), dot(gy, ux), dot(gx, uy), dot(gy, uy)))
    }
}

/// Adds the film's pressure on the deformed articular surface, int p n . v da, of an element of the first row; consistent
/// formulation only. `side` is 1 for the upper body, whose outward normal points down, and -1 for the lower one.
pub fn surface_pressure(mesh: &LayerMesh, element: usize, side: f64, at: &Local, terms: ElementTerms<'_>) {
    let nodes = mesh.element_nodes(element);
    let place = |k: usize| -> [f64; 3] { std::array::from_fn(|a| mesh.nodes[nodes[a]][k] + at[k * NODES + a]) };
    let (x, y) = (place(0), place(1));
    let ElementTerms { mut residual, mut tangent, .. } = terms;
    for (s, w) in GAUSS.into_iter().zip(GAUSS_WEIGHTS) {
        let (shape, slope) = (quadratic(s), quadratic_derivative(s));
        let pressure_shape = crate::fem::element::pressure(mesh.pressure_order, s);
        let sum = |f: &[f64; 3], v: &[f64]| f[0] * v[0] + f[1] * v[1] + f[2] * v[2];
        let pressure = sum(&pressure_shape, &at[2 * NODES..]);
        let normal = [side * sum(&slope, &y), -side * sum(&slope, &x)];
        for a in 0..3 {
            if let Some(residual) = &mut residual {
                residual[a] += w * pressure * normal[0] * shape[a];
                residual[NODES + a] += w * pressure * normal[1] * shape[a];
            }
            if let Some(tangent) = &mut tangent {
                for b in 0..3 {
                    let turn = w * pressure * side * slope[b] * shape[a];
                    tangent[(NODES + b) * LOCAL + a] += turn;
                    tangent[b * LOCAL + NODES + a] -= turn;
                    let push = w * pressure_shape[b] * shape[a];
                    tangent[(2 * NODES + b) * LOCAL + a] += push * normal[0];
                    tangent[(2 * NODES + b) * LOCAL + NODES + a] += push * normal[1];
                }
            }
        }
    }
}

/// Both displacements and the pressure at a node, or what belongs to them, and nothing: as many as fit in a vector.
type Fields = [f64; 4];

/// Sum over the nodes of a function's values times the fields.
#[inline(always)]
fn sum(function: &[f64; NODES], fields: &[Fields; NODES]) -> Fields {
    let mut sum = [0.0; 4];
    for (value, fields) in function.iter().zip(fields) {
        sum.iter_mut().zip(fields).for_each(|(sum, field)| *sum += value * field);
    }
    sum
}

/// Adds a function's value at every node times the fields.
#[inline(always)]
fn add_outer(sums: &mut [Fields; NODES], function: &[f64; NODES], fields: &Fields) {
    for (sum, value) in sums.iter_mut().zip(function) {
        sum.iter_mut().zip(fields).for_each(|(sum, field)| *sum += value * field);
    }
}

fn dot(f: &[f64; NODES], values: &[f64]) -> f64 {
    f.iter().zip(values).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::mesh::{graded, quadratic_stations};
    use proptest::prelude::*;

    fn mesh(order: i32, side: f64) -> LayerMesh {
        let stations = quadratic_stations(3, |i| 2e-3 * graded(i as f64 / 1.5 - 1.0, 1.0));
        LayerMesh::sector(&stations, &quadratic_stations(2, |j| 0.5e-3 * j as f64), 0.1, side, order)
    }

    /// Displacements of 20 micron and pressures of 0.2 MPa, made of these numbers.
    fn values(seed: &[f64]) -> Local {
        std::array::from_fn(|i| seed[i % seed.len()] * if i < 2 * NODES { 2e-5 } else { 2e5 })
    }

    fn all_terms(tissue: &Tissue, mesh: &LayerMesh, side: f64, at: &Local, speed: f64) -> (Local, Local, Vec<f64>) {
        let (mut residual, mut by_speed, mut tangent) = ([0.0; LOCAL], [0.0; LOCAL], [0.0; LOCAL * LOCAL]);
        let rate = VolumeRate { rate: 3.0, history: std::array::from_fn(|q| q as f64 - 3.0) };
        let terms =
            ElementTerms { residual: Some(&mut residual), by_speed: Some(&mut by_speed), tangent: Some(&mut tangent) };
        tissue.element(mesh, 2, at, speed, &rate, terms).unwrap();
        if tissue.consistent {
            let terms = ElementTerms { residual: Some(&mut residual), by_speed: None, tangent: Some(&mut tangent) };
            surface_pressure(mesh, 2, side, at, terms);
        }
        (residual, by_speed, tangent.to_vec())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        /// Taylor test: residual(z + s dz) - residual(z) - s tangent dz falls with s^2, column by column.
        #[test]
        fn tangent_is_the_derivative_of_the_residual(
            seed in prop::collection::vec(-1.0..1.0f64, 31),
            direction in prop::collection::vec(-1.0..1.0f64, 29),
            consistent: bool, order in 1..3_i32, upper: bool, strained: bool,
        ) {
            let side = if upper { 1.0 } else { -1.0 };
            let mesh = mesh(order, side);
            let tissue = Tissue {
                solid: NeoHookean { shear_modulus: 0.45e6, bulk_modulus: 0.5e6 },
                biot_coefficient: 0.9, mobility: 1e-12, fluid_compressibility: 1e-7, consistent,
                strain_dependence: strained.then_some(HolmesMow {
                    solid_volume_fraction: 0.3, exponent: 2.0, strain_coefficient: 3.0,
                }),
            };
            let at = values(&seed);
            let change = values(&direction);
            let (_, by_speed, tangent) = all_terms(&tissue, &mesh, side, &at, 0.3);
            let mut linear = [0.0; LOCAL];
            for j in 0..LOCAL { for i in 0..LOCAL { linear[i] += tangent[j * LOCAL + i] * change[j]; } }
            let moved = |s: f64| {
                let z: Local = std::array::from_fn(|i| at[i] + s * change[i]);
                all_terms(&tissue, &mesh, side, &z, 0.3).0
            };
            let central = |s: f64| -> Local {
                let (plus, minus) = (moved(s), moved(-s));
                std::array::from_fn(|i| (plus[i] - minus[i]) / (2.0 * s))
            };
            let difference = central(1e-4);
            for group in [0..2 * NODES, 2 * NODES..LOCAL] {
                let size = group.clone().map(|i| linear[i].abs()).fold(0.0, f64::max);
                for i in group {
                    prop_assert!((difference[i] - linear[i]).abs() < 2e-7 * size, "{} {} {}", i, difference[i], linear[i]);
                }
            }
            // The residual is linear in the speed.
            let (faster, _, _) = all_terms(&tissue, &mesh, side, &at, 1.3);
            let (slower, _, _) = all_terms(&tissue, &mesh, side, &at, 0.3);
            for i in 0..LOCAL {
                prop_assert!((faster[i] - slower[i] - by_speed[i]).abs() <= 1e-9 * (faster[i].abs() + by_speed[i].abs()) + 1e-30);
            }
        }
    }

    #[test]
    fn an_element_turned_inside_out_is_refused() {
        let mesh = mesh(2, 1.0);
        let tissue = Tissue {
            solid: NeoHookean { shear_modulus: 1.0, bulk_modulus: 1.0 },
            biot_coefficient: 1.0,
            mobility: 1.0,
            strain_dependence: None,
            fluid_compressibility: 0.0,
            consistent: false,
        };
        let mut at = [0.0; LOCAL];
        for (a, n) in mesh.element_nodes(0).into_iter().enumerate() {
            at[NODES + a] = -3.0 * mesh.nodes[n][1];
        }
        let terms = ElementTerms { residual: None, by_speed: None, tangent: None };
        assert_eq!(tissue.element(&mesh, 0, &at, 0.0, &VolumeRate::default(), terms), Err(Inverted));
    }
}
