//! Fields of a solved state: over both bodies and along the interface, for pictures and for programs that draw them.

use nalgebra::{Matrix2, Vector2};

use crate::equations::system::{Change, Layer, Solved};
use crate::equations::tissue::{ElementTerms, Inverted, LOCAL, Local, Tissue};
use crate::fem::element::{
    NODES, POINTS, SIMPSON, pressure, pressure_derivative, quadratic, quadratic_derivative, tensor,
};
use crate::laws::kinematics::Strain;
use crate::parameters::Inputs;
use crate::solver::linear::FIXED;

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
    /// Places before deformation \[m\].
    pub reference_position: Vec<[f64; 2]>,
    /// Displacements \[m\].
    pub displacement: Vec<[f64; 2]>,
    /// Pore pressure, above ambient \[Pa\].
    pub fluid_pressure: Vec<f64>,
    /// Von Mises stress of the solid part (true effective stress, plane strain) \[Pa\]. Strains are averaged over the elements
    /// that meet at a node.
    pub von_mises_stress: Vec<f64>,
    /// Flow of fluid relative to the solid, per area of the deformed tissue \[m/s\].
    pub darcy_flux: Vec<[f64; 2]>,
    /// Mean ratio of the volumes after and before deformation, one value an element; element (column, row) has index
    /// `column * rows + row` \[1\].
    pub volume_ratio: Vec<f64>,
}

/// Fields at the surface nodes, in the order of x.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InterfaceFields {
    /// Places along x \[m\].
    pub position: Vec<f64>,
    /// Film thickness h \[m\].
    pub film_thickness: Vec<f64>,
    /// Fluid pressure p, above ambient \[Pa\].
    pub fluid_pressure: Vec<f64>,
    /// How much of the film thickness is void; zero unless the film may cavitate. More than the film where void has entered the tissue's
    /// pores \[m\].
    pub void_thickness: Vec<f64>,
    /// Pressure of solid on solid p_c, the normal stress S_n of the solid at the surface \[Pa\].
    pub contact_pressure: Vec<f64>,
    /// Flux along the film Q = -h^3/(12 eta) p' + U (h - c)/2 with the void c, per unit depth; between rough surfaces the flow factor is on
    /// h^3 \[m^2/s\].
    pub film_flux: Vec<f64>,
    /// Fluid that leaves the upper body through its surface, V_1 \[m/s\].
    pub upper_outflow: Vec<f64>,
    /// Fluid that leaves the lower body through its surface, V_2 \[m/s\].
    pub lower_outflow: Vec<f64>,
    /// Fluid that enters the film, V = V_1 + V_2; none where the bodies touch \[m/s\].
    pub outflow: Vec<f64>,
    /// Length of surface that each node stands for in the balance of fluid \[m\]: sums of outflows times weights are integrals.
    /// Zero where a node has no balance of its own.
    pub weight: Vec<f64>,
}

impl BodyFields {
    /// Nodes through the thickness.
    pub fn levels(&self) -> usize {
        2 * self.rows + 1
    }

    /// Place of a node after deformation \[m\].
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

impl Solved<'_> {
    /// The fields.
    ///
    /// # Errors
    /// [`Inverted`] where an element is turned inside out, which a solution has none of.
    pub fn fields(&self) -> Result<Fields, Inverted> {
        let upper = self.body(0);
        let lower = match self.system.layers.len() {
            2 => self.body(1),
            _ if self.system.mirrored() => upper.mirrored(),
            // A rigid one has no fields.
            _ => BodyFields::default(),
        };
        Ok(Fields { inputs: self.state.inputs, interface: self.interface(&upper)?, bodies: [upper, lower] })
    }

    fn local(&self, body: usize, element: usize) -> Local {
        self.system.local(body, element, &self.state.unknowns, self.state.inputs.penetration_depth)
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
        let mut multiplicity = vec![0.0; nodes];
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
                multiplicity[node] += 1.0;
            }
            let volumes = (0..POINTS).map(|point| Tissue::strain(mesh, element, point, &at).volume_ratio());
            let weights = mesh.points(element).iter().map(|point| point.weight);
            let (volume, area) = volumes.zip(weights).fold((0.0, 0.0), |(v, a), (j, w)| (v + j * w, a + w));
            fields.volume_ratio.push(volume / area);
        }
        for (node, ((strain, slope), multiplicity)) in strains.into_iter().zip(slopes).zip(multiplicity).enumerate() {
            let tissue = layer.tissue.at_depth(mesh.depths[node % mesh.levels()]);
            let strain = Strain::new(strain / multiplicity);
            let mobility = tissue.mobility_at(&strain, &mesh.along(node)).0;
            let reference = -(mobility.conductance(&strain, tissue.consistent) * (slope / multiplicity));
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
        let fluid_pressure: Vec<f64> = upper.fluid_pressure.iter().step_by(upper.levels()).copied().collect();
        let value = |number: &u32| if *number == FIXED { 0.0 } else { self.state.unknowns[*number as usize] };
        let void_thickness: Vec<f64> = system.layout.void.iter().map(value).collect();

        let none = Change::none(system.unknowns(), stations);
        let film_thickness: Vec<f64> =
            system.film_gaps(self.state, &none).into_iter().map(|gap| gap.re.max(0.0)).collect();
        let contact_pressure = system.contact_pressure(self.state, &none).iter().map(|pressure| pressure.re).collect();

        let (upper_outflow, weight) = self.outflow(0)?;
        let lower_outflow = match system.layers.len() {
            2 => self.outflow(1)?.0,
            _ if system.mirrored() => upper_outflow.clone(),
            _ => vec![0.0; stations],
        };
        let outflow: Vec<f64> = upper_outflow.iter().zip(&lower_outflow).map(|(a, b)| a + b).collect();
        let film_flux = self.film_flux(&film_thickness, &outflow, &weight);
        Ok(InterfaceFields {
            position: system.stations.clone(),
            film_thickness,
            fluid_pressure,
            void_thickness,
            contact_pressure,
            film_flux,
            upper_outflow,
            lower_outflow,
            outflow,
            weight,
        })
    }

    /// Flux along the film: the scheme's where the film is thinnest, from there on what the outflows add.
    ///
    /// Reynolds' equation multiplies the slope of the pressure by h^3, which makes the slightest error large where the film is thick.
    fn film_flux(&self, film: &[f64], outflow: &[f64], weight: &[f64]) -> Vec<f64> {
        let middles = (1..film.len()).step_by(2);
        let thinnest = middles.min_by(|a, b| film[*a].total_cmp(&film[*b])).unwrap_or(1);
        let known = self.system.film_flux(thinnest / 2, self.state);
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
            let rate = system.volume_rate(self.state.rates.as_ref(), body, element);
            let terms = ElementTerms { residual: Some(&mut residual), ..ElementTerms::default() };
            let speeds = system.relative_speeds(body, column, &self.state.inputs, self.state.rates.as_ref());
            layer.tissue.element(&layer.mesh, element, &self.local(body, element), speeds, &rate, terms)?;
            let length = system.stations[2 * column + 2] - system.stations[2 * column];
            let fractions = if order == 2 { SIMPSON } else { [0.5, 0.0, 0.5] };
            for a in 0..3 {
                outflow[2 * column + a] -= residual[2 * NODES + a];
                weight[2 * column + a] += fractions[a] * length;
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

/// Gradients of displacement \[1\] and pressure \[Pa/m\] at local coordinates of an element.
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
