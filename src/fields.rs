//! Fields of a solved state: over both bodies and along the interface, for pictures and for programs that draw them.

use nalgebra::{Matrix2, Vector2};

use crate::equations::system::{Layer, Rates, Residual, System, surface_speeds};
use crate::equations::tissue::{ElementTerms, Inverted, LOCAL, Local, Tissue, VolumeRate};
use crate::fem::element::{
    NODES, POINTS, SIMPSON, pressure, pressure_derivative, quadratic, quadratic_derivative, tensor,
};
use crate::laws::darcy::conductance;
use crate::laws::film::reynolds_flux;
use crate::laws::neo_hookean::Strain;
use crate::parameters::{Inputs, Parameters};

/// Everything there is to draw of one state, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Fields {
    /// The inputs of the state.
    pub inputs: Inputs,
    /// The upper and the lower body; where one is the mirror image of the other, both are written out.
    pub bodies: [BodyFields; 2],
    /// Along the interface.
    pub interface: InterfaceFields,
}

/// Nodal fields of one body. Node (station, level) has index `station * levels + level`; level 0 is the articular surface.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BodyFields {
    /// Elements along the surface.
    pub columns: usize,
    /// Elements through the thickness.
    pub rows: usize,
    /// Places before deformation [m].
    pub reference_position: Vec<[f64; 2]>,
    /// Displacements [m].
    pub displacement: Vec<[f64; 2]>,
    /// Pore pressure, above ambient [Pa].
    pub fluid_pressure: Vec<f64>,
    /// Von Mises stress of the solid part (true effective stress, plane strain) [Pa]. Strains are averaged over the elements
    /// that meet at a node.
    pub von_mises_stress: Vec<f64>,
    /// Flow of fluid relative to the solid, per area of the deformed tissue [m/s].
    pub darcy_flux: Vec<[f64; 2]>,
    /// Mean ratio of the volumes after and before deformation, one value an element; element (column, row) has index
    /// `column * rows + row` [1].
    pub volume_ratio: Vec<f64>,
}

/// Fields at the surface nodes, in the order of x.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InterfaceFields {
    /// Places along x [m].
    pub position: Vec<f64>,
    /// Film thickness h [m].
    pub film_thickness: Vec<f64>,
    /// Fluid pressure p, above ambient [Pa].
    pub fluid_pressure: Vec<f64>,
    /// Pressure of solid on solid p_c, the normal stress S_n of the solid at the surface [Pa].
    pub contact_pressure: Vec<f64>,
    /// Flux along the film Q = -h^3/(12 eta) p' + U h/2, per unit depth [m^2/s].
    pub film_flux: Vec<f64>,
    /// Fluid that leaves the upper body through its surface, V_1 [m/s].
    pub upper_outflow: Vec<f64>,
    /// Fluid that leaves the lower body through its surface, V_2 [m/s].
    pub lower_outflow: Vec<f64>,
    /// Fluid that enters the film, V = V_1 + V_2; none where the bodies touch [m/s].
    pub outflow: Vec<f64>,
    /// Length of surface that each node stands for in the balance of fluid [m]: sums of outflows times weights are integrals.
    /// Zero where a node has no balance of its own.
    pub weight: Vec<f64>,
}

impl BodyFields {
    /// Nodes through the thickness.
    pub fn levels(&self) -> usize {
        2 * self.rows + 1
    }

    /// Place of a node after deformation [m].
    pub fn position(&self, node: usize) -> [f64; 2] {
        std::array::from_fn(|k| self.reference_position[node][k] + self.displacement[node][k])
    }

    /// Nodes of an element, row by row from the surface inwards, each row along x.
    pub fn element_nodes(&self, element: usize) -> [usize; NODES] {
        let (column, row) = (element / self.rows, element % self.rows);
        std::array::from_fn(|a| (2 * column + a % 3) * self.levels() + 2 * row + a / 3)
    }

    /// The mirror image in y = 0.
    fn mirrored(&self) -> Self {
        let turned = |vectors: &[[f64; 2]]| vectors.iter().map(|[x, y]| [*x, -y]).collect();
        Self {
            reference_position: turned(&self.reference_position),
            displacement: turned(&self.displacement),
            darcy_flux: turned(&self.darcy_flux),
            ..self.clone()
        }
    }
}

/// A state of a [`System`].
#[derive(Debug, Clone, Copy)]
pub struct Solution<'a> {
    /// The equations.
    pub system: &'a System,
    /// The case.
    pub parameters: &'a Parameters,
    /// The inputs.
    pub inputs: &'a Inputs,
    /// The unknowns.
    pub unknowns: &'a [f64],
    /// Stations in contact.
    pub active: &'a [bool],
    /// History terms of the time integration.
    pub rates: Option<&'a Rates>,
}

impl Solution<'_> {
    /// The fields.
    ///
    /// # Errors
    /// [`Inverted`] where an element is turned inside out, which a solution has none of.
    pub fn fields(&self) -> Result<Fields, Inverted> {
        let upper = self.body(0);
        let lower = if self.system.mirrored() { upper.mirrored() } else { self.body(1) };
        Ok(Fields { inputs: *self.inputs, interface: self.interface(&upper)?, bodies: [upper, lower] })
    }

    fn local(&self, body: usize, element: usize) -> Local {
        self.system.local(body, element, self.unknowns, self.inputs.penetration_depth)
    }

    fn body(&self, body: usize) -> BodyFields {
        let layer = &self.system.layers[body];
        let mesh = &layer.mesh;
        let nodes = mesh.nodes.len();
        let mut fields = BodyFields {
            columns: mesh.columns,
            rows: mesh.rows,
            reference_position: mesh.nodes.clone(),
            displacement: vec![[0.0; 2]; nodes],
            fluid_pressure: vec![0.0; nodes],
            volume_ratio: Vec::with_capacity(mesh.elements()),
            ..BodyFields::default()
        };
        // Gradients jump between elements: their mean is the better value at a node.
        let mut uses = vec![0.0; nodes];
        let mut strains = vec![Matrix2::zeros(); nodes];
        let mut slopes = vec![Vector2::zeros(); nodes];
        for element in 0..mesh.elements() {
            let at = self.local(body, element);
            for (a, node) in mesh.element_nodes(element).into_iter().enumerate() {
                let (s, t) = (a as f64 % 3.0 - 1.0, (a / 3) as f64 - 1.0);
                let (strain, slope) = gradients(layer, element, &at, s, t);
                fields.displacement[node] = [at[a], at[NODES + a]];
                fields.fluid_pressure[node] = dot(&pressure_shape(mesh.pressure_order, s, t), &at[2 * NODES..]);
                strains[node] += strain;
                slopes[node] += slope;
                uses[node] += 1.0;
            }
            let volumes = (0..POINTS).map(|point| Tissue::strain(mesh, element, point, &at).volume_ratio());
            let weights = mesh.points(element).iter().map(|point| point.weight);
            let (volume, area) = volumes.zip(weights).fold((0.0, 0.0), |(v, a), (j, w)| (v + j * w, a + w));
            fields.volume_ratio.push(volume / area);
        }
        let tissue = &layer.tissue;
        for ((strain, slope), uses) in strains.into_iter().zip(slopes).zip(uses) {
            let strain = Strain::new(strain / uses);
            let reference = -(conductance(tissue.mobility, &strain, tissue.consistent) * (slope / uses));
            let flux = match tissue.consistent {
                // Piola's transformation: what crosses a deformed area is F Q / J.
                true => (Matrix2::identity() + strain.gradient) * reference / strain.volume_ratio(),
                false => reference,
            };
            fields.von_mises_stress.push(tissue.solid.von_mises(&strain));
            fields.darcy_flux.push([flux.x, flux.y]);
        }
        fields
    }

    fn interface(&self, upper: &BodyFields) -> Result<InterfaceFields, Inverted> {
        let system = self.system;
        let stations = system.stations.len();
        let film_thickness: Vec<f64> = system.layout.gap.iter().map(|n| self.unknowns[*n as usize].max(0.0)).collect();
        let fluid_pressure: Vec<f64> = upper.fluid_pressure.iter().step_by(upper.levels()).copied().collect();

        let mut residual = Residual::default();
        system.residual(self.unknowns, &mut self.active.to_vec(), self.inputs, self.rates, &mut residual)?;
        let contact_pressure = (0..stations)
            .map(|i| if self.active[i] { residual.contact_forces[i] / system.weights[i] } else { 0.0 })
            .collect();

        let (upper_outflow, weight) = self.outflow(0)?;
        let lower_outflow = if system.mirrored() { upper_outflow.clone() } else { self.outflow(1)?.0 };
        let outflow: Vec<f64> = upper_outflow.iter().zip(&lower_outflow).map(|(a, b)| a + b).collect();
        let film_flux = self.film_flux(&film_thickness, &fluid_pressure, &outflow, &weight);
        Ok(InterfaceFields {
            position: system.stations.clone(),
            film_thickness,
            fluid_pressure,
            contact_pressure,
            film_flux,
            upper_outflow,
            lower_outflow,
            outflow,
            weight,
        })
    }

    /// Flux along the film: the formula where the film is thinnest, from there on what the outflows add.
    ///
    /// The formula multiplies the slope of the pressure by h^3, which makes the slightest error large where the film is thick.
    fn film_flux(&self, film: &[f64], pressure: &[f64], outflow: &[f64], weight: &[f64]) -> Vec<f64> {
        let x = &self.system.stations;
        // Middles of elements, where the slope of a quadratic pressure is best.
        let middles = (1..film.len()).step_by(2);
        let thinnest = middles.min_by(|a, b| film[*a].total_cmp(&film[*b])).unwrap_or(1);
        let slope = (pressure[thinnest + 1] - pressure[thinnest - 1]) / (x[thinnest + 1] - x[thinnest - 1]);
        let known = reynolds_flux(film[thinnest], slope, self.inputs.sliding_speed, self.parameters.viscosity).value;
        let mut sum = 0.0;
        let added: Vec<f64> = outflow
            .iter()
            .zip(weight)
            .map(|(v, w)| {
                sum += v * w;
                sum - 0.5 * v * w
            })
            .collect();
        added.iter().map(|sum| known + sum - added[thinnest]).collect()
    }

    /// Volume flux of fluid out of one body's surface at each station, and the length that goes with it.
    ///
    /// It is what the body's own balance of fluid needs at the surface, not the gradient of the pressure there: so it conserves
    /// what the solution conserves, and is of higher order.
    fn outflow(&self, body: usize) -> Result<(Vec<f64>, Vec<f64>), Inverted> {
        let system = self.system;
        let layer = &system.layers[body];
        let order = layer.mesh.pressure_order;
        let stations = system.stations.len();
        let (mut outflow, mut weight) = (vec![0.0; stations], vec![0.0; stations]);
        for column in 0..layer.mesh.columns {
            let element = column * layer.mesh.rows;
            let mut residual = [0.0; LOCAL];
            let rate = self
                .rates
                .map_or_else(VolumeRate::default, |r| VolumeRate { rate: r.rate, history: r.volume[body][element] });
            let terms = ElementTerms { residual: Some(&mut residual), by_speed: None, tangent: None };
            let speed = surface_speeds(self.inputs)[body];
            layer.tissue.element(&layer.mesh, element, &self.local(body, element), speed, &rate, terms)?;
            let length = system.stations[2 * column + 2] - system.stations[2 * column];
            let shares = if order == 2 { SIMPSON } else { [0.5, 0.0, 0.5] };
            for a in 0..3 {
                outflow[2 * column + a] -= residual[2 * NODES + a];
                weight[2 * column + a] += shares[a] * length;
            }
        }
        for (flow, weight) in outflow.iter_mut().zip(&weight).filter(|(_, w)| **w > 0.0) {
            *flow /= weight;
        }
        if order != 2 {
            for i in (1..stations).step_by(2) {
                outflow[i] = 0.5 * (outflow[i - 1] + outflow[i + 1]);
            }
        }
        // The test function of an end also lies on the end face, through which the pressure drives fluid freely.
        for (end, inside) in [(0, 1), (stations - 1, stations - 2)] {
            outflow[end] = outflow[inside];
            weight[end] = 0.0;
        }
        Ok((outflow, weight))
    }
}

/// Gradients of displacement [1] and pressure [Pa/m] at local coordinates of an element.
fn gradients(layer: &Layer, element: usize, at: &Local, s: f64, t: f64) -> (Matrix2<f64>, Vector2<f64>) {
    let mesh = &layer.mesh;
    let places = mesh.element_nodes(element).map(|n| mesh.nodes[n]);
    let by_s = tensor(quadratic_derivative(s), quadratic(t));
    let by_t = tensor(quadratic(s), quadratic_derivative(t));
    let along = |f: &[f64; NODES], k: usize| -> f64 { (0..NODES).map(|a| f[a] * places[a][k]).sum() };
    let [xs, xt, ys, yt] = [along(&by_s, 0), along(&by_t, 0), along(&by_s, 1), along(&by_t, 1)];
    let determinant = xs * yt - xt * ys;
    let gradient = |f_s: f64, f_t: f64| [(yt * f_s - ys * f_t) / determinant, (xs * f_t - xt * f_s) / determinant];
    let [xx, xy] = gradient(dot(&by_s, &at[..NODES]), dot(&by_t, &at[..NODES]));
    let [yx, yy] = gradient(dot(&by_s, &at[NODES..]), dot(&by_t, &at[NODES..]));
    let order = mesh.pressure_order;
    let p_s = dot(&tensor(pressure_derivative(order, s), pressure(order, t)), &at[2 * NODES..]);
    let p_t = dot(&tensor(pressure(order, s), pressure_derivative(order, t)), &at[2 * NODES..]);
    let [px, py] = gradient(p_s, p_t);
    (Matrix2::new(xx, xy, yx, yy), Vector2::new(px, py))
}

fn pressure_shape(order: i32, s: f64, t: f64) -> [f64; NODES] {
    tensor(pressure(order, s), pressure(order, t))
}

/// Sum of products over the first of two lists.
fn dot(f: &[f64], values: &[f64]) -> f64 {
    f.iter().zip(values).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::Simulation;
    use approx::assert_relative_eq;

    /// A state on a small mesh.
    fn solved(depth: f64, change: impl Fn(&mut Parameters)) -> (Simulation, Fields) {
        let mut parameters = Parameters::default();
        (parameters.mesh.columns, parameters.mesh.rows) = (24, 3);
        change(&mut parameters);
        let mut simulation = Simulation::new(&parameters).unwrap();
        assert!(simulation.fields().is_none());
        simulation.solve_steady(Inputs { penetration_depth: depth, ..Inputs::default() }).unwrap();
        let fields = simulation.fields().unwrap();
        (simulation, fields)
    }

    #[test]
    fn fields_agree_with_the_outputs() {
        for (depth, order) in [(5e-6, 2), (5e-6, 1), (20e-6, 2)] {
            let (simulation, fields) = solved(depth, |p| p.pressure_order = order);
            let (outputs, interface) = (simulation.outputs(), &fields.interface);
            let largest = |values: &[f64]| values.iter().copied().fold(f64::MIN, f64::max);
            assert_relative_eq!(
                largest(&interface.fluid_pressure),
                outputs.maximum_fluid_pressure,
                max_relative = 0.02
            );
            assert_relative_eq!(largest(&interface.contact_pressure), outputs.maximum_contact_pressure);
            let von_mises = fields.bodies.each_ref().map(|body| largest(&body.von_mises_stress));
            assert_relative_eq!(von_mises[0].max(von_mises[1]), outputs.maximum_von_mises_stress, max_relative = 0.2);
            assert_eq!(fields.inputs.penetration_depth, depth);
            // The bone moves by half the depth, and a body that is pressed shrinks.
            let bone = fields.bodies[0].displacement[2 * 3];
            assert_eq!(bone, [0.0, -0.5 * depth]);
            assert!(fields.bodies[0].volume_ratio.iter().copied().fold(f64::MAX, f64::min) < 1.0);
        }
    }

    #[test]
    fn outflow_and_film_flux_conserve_fluid() {
        // In contact and out of it; equal bodies and unequal ones.
        for (depth, thickness) in [(5e-6, 1e-3), (5e-6, 1.3e-3), (20e-6, 1e-3)] {
            let (simulation, fields) = solved(depth, |p| p.upper.thickness = thickness);
            let f = &fields.interface;
            let last = f.position.len() - 1;
            let flows: Vec<f64> = f.outflow.iter().zip(&f.weight).map(|(v, w)| v * w).collect();
            let exuded: f64 = flows.iter().map(|v| v.max(0.0)).sum();
            // The outputs have it from the balance of the film, the fields from those of the bodies.
            assert_relative_eq!(exuded, simulation.outputs().fluid_exudation, max_relative = 1e-3);
            let added: f64 = flows.iter().sum();
            assert_relative_eq!(f.film_flux[last] - f.film_flux[0], added, epsilon = 1e-6 * exuded);
            // Where both elements at a station are closed, what leaves one body enters the other.
            for i in 2..last - 1 {
                if f.contact_pressure[i - 2..=i + 2].iter().all(|pressed| *pressed > 0.0) {
                    assert!(f.outflow[i].abs() < 1e-4 * f.upper_outflow[i].abs().max(1e-6), "{i}: {}", f.outflow[i]);
                }
            }
        }
    }

    #[test]
    fn equal_bodies_without_friction_are_mirror_images() {
        let (_, fields) = solved(5e-6, |_| ());
        let [upper, lower] = &fields.bodies;
        for (node, [x, y]) in upper.reference_position.iter().enumerate() {
            assert_eq!(lower.reference_position[node], [*x, -y]);
            assert_eq!(lower.displacement[node], [upper.displacement[node][0], -upper.displacement[node][1]]);
            assert_eq!(lower.darcy_flux[node][1], -upper.darcy_flux[node][1]);
        }
        assert_eq!(fields.interface.upper_outflow, fields.interface.lower_outflow);
    }
}
