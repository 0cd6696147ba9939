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
//!
//! On a mesh that moves along the layer with surface speed W the term with dJ/dt is the rate of alpha r (J - 1) dA seen from the mesh, and
//! U_i - W takes the place of U_i: what the mesh passes by is carried through it (arbitrary Lagrangian-Eulerian, conservative form).
//!
//! With pressures of order 1 the convective term of the consistent formulation is weighted by 1 - w s along each column, s = -1 at its
//! upstream end and 1 at the other. Without, the balances of undrained tissue are means over the columns, to which a pressure that
//! alternates from column to column is nothing: little else binds such a ripple. w is 1 where an
//! element is too large for fluid to cross it while it passes, and goes to 0 where the mesh resolves drainage (`Tissue::weighting`).
//!
//! `Tissue::integrand` is what stands under the integrals, `Tissue::integrand_derivatives` its derivatives.

use std::borrow::Cow;

use nalgebra::{Matrix2, Matrix4, Vector2, Vector4};
use pulp::{Simd, WithSimd};

use crate::fem::assembly::{ElementFields, Integrand, IntegrandDerivatives, ResidualSum, TangentFactors};
pub use crate::fem::assembly::{LOCAL, Local};
use crate::fem::element::{GAUSS, GAUSS_WEIGHTS, NODES, POINTS, quadratic, quadratic_derivative};
use crate::fem::mesh::LayerMesh;
use crate::laws::darcy::{HolmesMow, Mobility};
use crate::laws::depth::DepthProfile;
use crate::laws::fluid::relative_density;
use crate::laws::kinematics::{COFACTOR_DERIVATIVE, Strain, flatten};
use crate::laws::solid::Solid;

/// The material of one body and the balance laws it obeys.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tissue {
    /// Drained solid, moduli weighted as the formulation says.
    pub solid: Solid,
    /// Biot-Willis coefficient alpha \[1\].
    pub biot_coefficient: f64,
    /// Hydraulic permeability kappa/eta of the undeformed tissue through its depth \[m^4/(N s)\].
    pub mobility: f64,
    /// That along the articular surface over that through the depth \[1\].
    pub tangential_ratio: f64,
    /// How it answers to strain; `None` where it does not.
    pub strain_dependence: Option<HolmesMow>,
    /// Compressibility chi of the fluid \[1/Pa\].
    pub fluid_compressibility: f64,
    /// Whether stress and Darcy's law are those of the consistent formulation.
    pub consistent: bool,
    /// How all this changes with depth; `None` where it does not.
    pub profile: Option<DepthProfile>,
}

/// How fast what an element took up changes: d((J - 1) dA)/dt = rate * (J - 1) dA + history with the area dA of a quadrature point, by the
/// time integration; steady is rate = history = 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct VolumeRate {
    /// Factor of what is stored \[1/s\].
    pub rate: f64,
    /// The rest of the difference formula, at each quadrature point \[m^2/s\].
    pub history: [f64; POINTS],
}

/// The element has turned inside out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("an element of the tissue is turned inside out")]
pub struct Inverted;

/// What is wanted of an element; matrices are column-major over the local unknowns.
#[derive(Default)]
pub struct ElementTerms<'a> {
    /// Added to: the residual.
    pub residual: Option<&'a mut Local>,
    /// Added to: its derivative with respect to the surface speed.
    pub by_speed: Option<&'a mut Local>,
    /// Added to: its derivative with respect to the local unknowns.
    pub tangent: Option<&'a mut [f64; LOCAL * LOCAL]>,
}

impl ElementTerms<'_> {
    /// The same, for one of several that add to them.
    pub fn reborrow(&mut self) -> ElementTerms<'_> {
        ElementTerms {
            residual: self.residual.as_deref_mut(),
            by_speed: self.by_speed.as_deref_mut(),
            tangent: self.tangent.as_deref_mut(),
        }
    }
}

/// State of the tissue at a quadrature point.
struct State {
    strain: Strain,
    /// p \[Pa\].
    pressure: f64,
    /// grad p \[Pa/m\].
    pressure_gradient: Vector2<f64>,
    /// Rigid rotation of the body per surface speed, v_rot \[1\].
    rotation: Vector2<f64>,
    /// Surface speed U_i, relative to the mesh \[m/s\].
    speed: f64,
    /// Weight of the convective term, and of its derivative with respect to the speed.
    upstream_weights: [f64; 2],
    /// d((J - 1) dA)/dt / dA, which is dJ/dt where the mesh stays \[1/s\].
    volume_rate: f64,
    /// Its derivative with respect to J \[1/s\].
    volume_rate_by_volume: f64,
}

impl Tissue {
    /// The material at a depth, given as a fraction of the thickness.
    #[inline(always)]
    pub fn at_depth(&self, depth: f64) -> Cow<'_, Self> {
        let Some(profile) = &self.profile else { return Cow::Borrowed(self) };
        let factors = profile.at(depth);
        Cow::Owned(Self {
            solid: self.solid.scaled(&factors),
            mobility: self.mobility * factors.permeability,
            strain_dependence: self.strain_dependence.map(|law| HolmesMow {
                solid_volume_fraction: law.solid_volume_fraction * factors.solid_volume_fraction,
                ..law
            }),
            ..*self
        })
    }

    /// The material at a quadrature point of an element.
    #[inline(always)]
    pub fn at_point(&self, mesh: &LayerMesh, element: usize, q: usize) -> Cow<'_, Self> {
        match self.profile {
            None => Cow::Borrowed(self),
            Some(_) => self.at_depth(mesh.point_depth(element, q)),
        }
    }

    /// Hydraulic permeability of the strained tissue, and its derivative with respect to the volume ratio, relative to it. `along` is a direction
    /// of the layer, of any length.
    pub fn mobility_at(&self, strain: &Strain, along: &Vector2<f64>) -> (Mobility, f64) {
        let law = self.strain_dependence.as_ref();
        let (relative, slope) = law.map_or((1.0, 0.0), |law| law.relative_permeability(strain.volume_change));
        let tangent = if self.tangential_ratio == 1.0 { Vector2::x() } else { along.normalize() };
        let across = self.mobility * relative;
        (Mobility { across, tangential_ratio: self.tangential_ratio, tangent }, slope / relative)
    }

    /// r = rho/rho0 = exp(chi p)
    fn density(&self, state: &State) -> f64 {
        relative_density(self.fluid_compressibility, state.pressure)
    }

    /// K grad p: what seeps through the pores, against its direction \[m/s\].
    fn seepage(&self, state: &State) -> Vector2<f64> {
        let (mobility, _) = self.mobility_at(&state.strain, &state.rotation);
        mobility.conductance(&state.strain, self.consistent) * state.pressure_gradient
    }

    /// -alpha (J - 1) v_rot: what the rotation carries, per surface speed \[1\].
    fn convection(&self, state: &State) -> Vector2<f64> {
        state.rotation * (-self.biot_coefficient * state.strain.volume_change)
    }

    /// The weak form at a quadrature point.
    #[inline(always)]
    fn integrand(&self, state: &State) -> Integrand {
        let (alpha, density) = (self.biot_coefficient, self.density(state));
        let effective = self.solid.stress(&state.strain);
        let (stress, force) = match self.consistent {
            true => (effective - state.strain.cofactor * (alpha * state.pressure), Vector2::zeros()),
            false => (effective, state.pressure_gradient * alpha),
        };
        Integrand {
            stress,
            force,
            flow: (self.seepage(state) + self.convection(state) * (state.upstream_weights[0] * state.speed)) * density,
            storage: density * alpha * state.volume_rate,
        }
    }

    /// Its derivative with respect to the surface speed.
    #[inline(always)]
    fn integrand_by_speed(&self, state: &State) -> Integrand {
        Integrand {
            flow: self.convection(state) * (state.upstream_weights[1] * self.density(state)),
            ..Integrand::default()
        }
    }

    /// Its derivatives with respect to strain, p and grad p.
    #[inline(always)]
    fn integrand_derivatives(&self, state: &State) -> IntegrandDerivatives {
        let State { strain, pressure, pressure_gradient, rotation, speed, upstream_weights: [weight, _], .. } = state;
        let (alpha, chi, density) = (self.biot_coefficient, self.fluid_compressibility, self.density(state));
        let (mobility, mobility_by_volume) = self.mobility_at(strain, rotation);
        let conductance = mobility.conductance(strain, self.consistent);
        let seepage = conductance * pressure_gradient;
        let cofactor = flatten(&strain.cofactor);

        let mut stress_by_strain = self.solid.tangent(strain);
        let mut stress_by_pressure = Vector4::zeros();
        let mut flow_by_volume = rotation * (-alpha * weight * speed);
        if self.strain_dependence.is_some() {
            flow_by_volume += seepage * mobility_by_volume;
        }
        let mut flow_by_strain = flow_by_volume * cofactor.transpose();
        if self.consistent {
            stress_by_strain -= Matrix4::from_fn(|row, column| alpha * pressure * COFACTOR_DERIVATIVE[row][column]);
            stress_by_pressure = cofactor * -alpha;
            flow_by_strain += mobility.conductance_derivative(strain, pressure_gradient);
        }
        IntegrandDerivatives {
            stress_by_strain,
            stress_by_pressure,
            force_by_pressure_gradient: if self.consistent { 0.0 } else { alpha },
            flow_by_strain: flow_by_strain * density,
            flow_by_pressure: (seepage + self.convection(state) * (weight * speed)) * (density * chi),
            flow_by_pressure_gradient: conductance * density,
            storage_by_strain: cofactor * (density * alpha * state.volume_rate_by_volume),
            storage_by_pressure: density * alpha * state.volume_rate * chi,
        }
    }

    /// Adds the terms of one element at local values `at`, moving with these surface speeds relative to the left and the right edge of the
    /// mesh's element, linear in between \[m/s\].
    ///
    /// # Errors
    /// [`Inverted`] where J <= 0 at a quadrature point of what is asked for.
    pub fn element(
        &self,
        mesh: &LayerMesh,
        element: usize,
        at: &Local,
        speeds: [f64; 2],
        volume_rate: &VolumeRate,
        terms: ElementTerms<'_>,
    ) -> Result<(), Inverted> {
        let upstream = self.weighting(mesh, element, 0.5 * (speeds[0] + speeds[1]));
        let element = Element { tissue: self, mesh, element, at, speeds, volume_rate, upstream };
        if let Some(residual) = terms.residual {
            pulp::Arch::new().dispatch(AddIntegral::<false> { element: &element, residual })?;
        }
        if let Some(residual) = terms.by_speed {
            pulp::Arch::new().dispatch(AddIntegral::<true> { element: &element, residual })?;
        }
        match terms.tangent {
            Some(tangent) => element.add_tangent(tangent),
            None => Ok(()),
        }
    }

    /// Weight w of the upstream end of an element, positive where the tissue moves along x: P^2 / (1 + P^2), with P the time in which fluid
    /// crosses the element's height over that in which the tissue passes its length.
    /// And its derivative with respect to the speed.
    fn weighting(&self, mesh: &LayerMesh, element: usize, speed: f64) -> [f64; 2] {
        if !self.consistent || mesh.pressure_order == 2 {
            return [0.0; 2];
        }
        let nodes = mesh.element_nodes(element).map(|node| Vector2::from(mesh.nodes[node]));
        let (length, height) = ((nodes[2] - nodes[0]).norm(), (nodes[6] - nodes[0]).norm());
        let velocity = speed * mesh.points(element)[POINTS / 2].velocity[0];
        let consolidation = self.mobility * self.solid.aggregate_modulus();
        let ratio = velocity * height.powi(2) / (consolidation * length);
        let square = ratio * ratio;
        let weight = square / (1.0 + square);
        let slope = if speed == 0.0 { 0.0 } else { 2.0 * square / (1.0 + square).powi(2) / speed };
        [weight, slope].map(|value| velocity.signum() * value)
    }

    /// Residual of an element for d((J - 1) dA)/dt alone, given at its quadrature points \[m^2/s\].
    pub fn storage(&self, mesh: &LayerMesh, at: &Local, rate: &[f64; POINTS]) -> Local {
        let mut residual = [0.0; LOCAL];
        for (q, rate) in rate.iter().enumerate() {
            let shape = &mesh.pressure_shape[q];
            let density = relative_density(self.fluid_compressibility, dot(shape, &at[2 * NODES..]));
            let factor = density * self.biot_coefficient * rate;
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

/// An element with all that its terms depend on.
struct Element<'a> {
    tissue: &'a Tissue,
    mesh: &'a LayerMesh,
    element: usize,
    at: &'a Local,
    speeds: [f64; 2],
    volume_rate: &'a VolumeRate,
    /// See [`Tissue::weighting`].
    upstream: [f64; 2],
}

impl Element<'_> {
    #[inline(always)]
    fn state(&self, fields: &ElementFields<'_>, q: usize) -> Result<State, Inverted> {
        let point = fields.at(q);
        let strain = Strain::new(point.displacement_gradient);
        if strain.volume_ratio() <= 0.0 || !strain.volume_change.is_finite() {
            return Err(Inverted);
        }
        let (here, [left, right]) = (&self.mesh.points(self.element)[q], self.speeds);
        let place = GAUSS[q % 3];
        let speed = 0.5 * (left * (1.0 - place) + right * (1.0 + place));
        let [weight, slope] = self.upstream;
        Ok(State {
            strain,
            pressure: point.pressure,
            pressure_gradient: point.pressure_gradient,
            rotation: Vector2::from(here.velocity),
            speed,
            upstream_weights: [1.0 - weight * place, 1.0 - (weight + slope * speed) * place],
            volume_rate: self.volume_rate.rate * strain.volume_change + self.volume_rate.history[q] / here.weight,
            volume_rate_by_volume: self.volume_rate.rate,
        })
    }

    /// Most of its work is in products, which choose the processor's vectors themselves.
    fn add_tangent(&self, tangent: &mut [f64; LOCAL * LOCAL]) -> Result<(), Inverted> {
        let fields = ElementFields::new(self.mesh, self.element, self.at);
        let mut factors = TangentFactors::NONE;
        for q in 0..POINTS {
            let derivatives =
                self.tissue.at_point(self.mesh, self.element, q).integrand_derivatives(&self.state(&fields, q)?);
            factors.set(self.mesh, self.element, q, &derivatives);
        }
        factors.add_to(tangent);
        Ok(())
    }
}

/// Adds to the residual, or to its derivative with respect to the surface speed; compiled once for each kind of processor.
struct AddIntegral<'a, 'b, const BY_SPEED: bool> {
    element: &'a Element<'a>,
    residual: &'b mut Local,
}

impl<const BY_SPEED: bool> WithSimd for AddIntegral<'_, '_, BY_SPEED> {
    type Output = Result<(), Inverted>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Element { mesh, element, at, .. } = *self.element;
        let fields = ElementFields::new(mesh, element, at);
        let mut sum = ResidualSum::new(mesh, element);
        for q in 0..POINTS {
            let state = self.element.state(&fields, q)?;
            let tissue = &*self.element.tissue.at_point(mesh, element, q);
            let integrand = if BY_SPEED { tissue.integrand_by_speed(&state) } else { tissue.integrand(&state) };
            sum.add(q, &integrand);
        }
        sum.add_to(self.residual);
        Ok(())
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

fn dot(f: &[f64; NODES], values: &[f64]) -> f64 {
    f.iter().zip(values).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::mesh::{graded, quadratic_stations};
    use crate::laws::depth::Factors;
    use crate::laws::solid::{self, Fibres, NeoHookean};
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
        let rate = VolumeRate { rate: 3.0, history: std::array::from_fn(|q| 1e-8 * (q as f64 - 3.0)) };
        let terms =
            ElementTerms { residual: Some(&mut residual), by_speed: Some(&mut by_speed), tangent: Some(&mut tangent) };
        tissue.element(mesh, 2, at, [speed - 0.02, speed + 0.03], &rate, terms).unwrap();
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
            consistent: bool, order in 1..3_i32, upper: bool, strained: bool, stiffening: bool, fibres: bool,
            tangential_ratio in prop::option::of(0.3..3.0f64), layered: bool,
        ) {
            let side = if upper { 1.0 } else { -1.0 };
            let mesh = mesh(order, side);
            let tissue = Tissue {
                solid: Solid {
                    fibres: fibres.then(|| Fibres::new(2e6, 3.0, 4.0)),
                    ..if stiffening {
                        solid::HolmesMow { shear_modulus: 0.45e6, bulk_modulus: 0.5e6, stiffening_coefficient: 2.0 }.into()
                    } else {
                        NeoHookean { shear_modulus: 0.45e6, bulk_modulus: 0.5e6 }.into()
                    }
                },
                biot_coefficient: 0.9, mobility: 1e-12, fluid_compressibility: 1e-7, consistent,
                tangential_ratio: tangential_ratio.unwrap_or(1.0),
                profile: layered.then_some(DepthProfile {
                    surface: Factors { shear_modulus: 0.5, bulk_modulus: 0.7, fibre_modulus: 2.0, permeability: 3.0, solid_volume_fraction: 0.8 },
                    deep: Factors { permeability: 0.3, ..Factors::NONE },
                    middle_zone: [0.3, 0.6],
                }),
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
                    prop_assert!((difference[i] - linear[i]).abs() < 1e-6 * size, "{} {} {}", i, difference[i], linear[i]);
                }
            }
            let [faster, slower] = [1e-4, -1e-4].map(|change| all_terms(&tissue, &mesh, side, &at, 0.3 + change).0);
            let size = by_speed.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
            for i in 0..LOCAL {
                prop_assert!(((faster[i] - slower[i]) / 2e-4 - by_speed[i]).abs() <= 1e-6 * size + 1e-9 * faster[i].abs());
            }
        }
    }

    #[test]
    fn an_element_turned_inside_out_is_refused() {
        let mesh = mesh(2, 1.0);
        let tissue = Tissue {
            solid: NeoHookean { shear_modulus: 1.0, bulk_modulus: 1.0 }.into(),
            biot_coefficient: 1.0,
            mobility: 1.0,
            tangential_ratio: 1.0,
            strain_dependence: None,
            fluid_compressibility: 0.0,
            consistent: false,
            profile: None,
        };
        let mut at = [0.0; LOCAL];
        for (a, n) in mesh.element_nodes(0).into_iter().enumerate() {
            at[NODES + a] = -3.0 * mesh.nodes[n][1];
        }
        let (mut residual, mut tangent) = ([0.0; LOCAL], [0.0; LOCAL * LOCAL]);
        for terms in [
            ElementTerms { residual: Some(&mut residual), ..ElementTerms::default() },
            ElementTerms { tangent: Some(&mut tangent), ..ElementTerms::default() },
        ] {
            assert_eq!(tissue.element(&mesh, 0, &at, [0.0; 2], &VolumeRate::default(), terms), Err(Inverted));
        }
    }
}
