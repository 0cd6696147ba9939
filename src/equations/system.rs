//! The discrete system: two poroelastic layers, the film between them and their contact, as one set of equations.

use crate::equations::film::{self, Film, MassRate};
use crate::equations::layout::{Layout, Quantity};
use crate::equations::tissue::{self, ElementTerms, Inverted, LOCAL, Local, Tissue, VolumeRate};
use crate::fem::element::{NODES, POINTS, SIMPSON};
use crate::fem::mesh::{LayerMesh, graded, quadratic_stations};
use crate::laws::Formulation;
use crate::laws::contact::{is_active, mobilised_friction};
use crate::laws::neo_hookean::NeoHookean;
use crate::parameters::{Body, Inputs, Mesh, Parameters};
use crate::solver::linear::{FIXED, Multifrontal, Singular};

/// One body: its mesh and its material.
#[derive(Debug)]
pub struct Layer {
    /// The mesh.
    pub mesh: LayerMesh,
    /// The material.
    pub tissue: Tissue,
    /// 1 above the film, -1 below.
    pub side: f64,
}

/// History terms of the time integration; steady has none.
#[derive(Debug, Clone, PartialEq)]
pub struct Rates {
    /// Factor of the present value in d/dt [1/s].
    pub rate: f64,
    /// Rest of dJ/dt at the quadrature points of every element of every body [1/s].
    pub volume: Vec<Vec<[f64; POINTS]>>,
    /// Rest of d(r h)/dt at the quadrature points of every interface element [m/s].
    pub film: Vec<[f64; 3]>,
}

/// What time derivatives are taken of, at the quadrature points.
#[derive(Debug, Clone, PartialEq)]
pub struct Contents {
    /// J in every element of every body.
    pub volume: Vec<Vec<[f64; POINTS]>>,
    /// Fluid r h of the film in every interface element [m].
    pub film: Vec<[f64; 3]>,
}

impl Rates {
    /// d/dt = (present - before) / step.
    pub fn backward_euler(step: f64, before: &Contents) -> Self {
        Self {
            rate: 1.0 / step,
            volume: before.volume.iter().map(|body| body.iter().map(|j| j.map(|j| -j / step)).collect()).collect(),
            film: before.film.iter().map(|m| m.map(|m| -m / step)).collect(),
        }
    }
}

/// The discrete equations of a pair of layers, with the factorisation of their last tangent.
#[derive(Debug)]
pub struct System {
    /// The upper body, and the lower one unless it is the upper one's mirror image.
    pub layers: Vec<Layer>,
    /// x of the interface nodes [m].
    pub stations: Vec<f64>,
    /// Simpson weights of the interface nodes [m].
    pub weights: Vec<f64>,
    /// Distance of the undeformed surfaces at first touch [m].
    pub touching_gap: Vec<f64>,
    /// The unknowns.
    pub layout: Layout,
    film: Film,
    parameters: Parameters,
    contact_stiffness: f64,
    stress_scale: f64,
    thickness: f64,
    /// Height of the levels above the bone, as a share of the thickness.
    height: Vec<f64>,
    linear: Multifrontal,
}

/// Residual at some unknowns, and the contact forces that go with it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Residual {
    /// Residual of every equation.
    pub values: Vec<f64>,
    /// Force with which the bodies press on each other at every station [N/m]; meaningful where the station is active.
    pub contact_forces: Vec<f64>,
}

/// A film thinner than this share of the layers' thickness (0.1 micron for 1 mm) may close within one update.
const THIN_FILM: f64 = 1e-4;

/// Speeds of the two surfaces.
pub fn surface_speeds(inputs: &Inputs) -> [f64; 2] {
    let (u, s) = (inputs.sliding_speed, inputs.slide_to_roll_ratio);
    [0.5 * u * (1.0 + s), 0.5 * u * (1.0 - s)]
}

/// Half the width of the interface [m].
pub fn half_width(parameters: &Parameters) -> f64 {
    parameters.upper.outer_radius.min(parameters.lower.outer_radius) * parameters.sector_half_angle.sin()
}

/// Traction on the upper body's tissue per unit of contact pressure, positive along -x.
pub fn boundary_friction(parameters: &Parameters, inputs: &Inputs) -> f64 {
    boundary_friction_with_slopes(parameters, inputs).0
}

/// Likewise with its derivatives by the two surface speeds.
fn boundary_friction_with_slopes(parameters: &Parameters, inputs: &Inputs) -> (f64, [f64; 2]) {
    let p = parameters;
    if !p.boundary_friction_loads_tissue {
        return (0.0, [0.0; 2]);
    }
    let (m, slopes) = mobilised_friction(p.formulation, surface_speeds(inputs), p.friction_regularisation_speed);
    (m * p.boundary_friction_coefficient, slopes.map(|s| s * p.boundary_friction_coefficient))
}

/// Depths of the node levels below the surface of a layer of this thickness [m].
fn levels_below_surface(mesh: &Mesh, thickness: f64) -> Vec<f64> {
    quadratic_stations(mesh.rows as usize, |j| thickness * graded(j as f64 / f64::from(mesh.rows), mesh.row_grading))
}

impl Layer {
    fn new(parameters: &Parameters, body: &Body, side: f64, stations: &[f64]) -> Self {
        let consistent = parameters.formulation == Formulation::Consistent;
        let alpha = body.biot_coefficient;
        let (isochoric, volumetric) = if consistent { (1.0, 1.0) } else { (alpha, 1.0 - alpha) };
        let depths = levels_below_surface(&parameters.mesh, body.thickness);
        Self {
            mesh: LayerMesh::sector(stations, &depths, body.outer_radius, side, parameters.pressure_order),
            tissue: Tissue {
                solid: NeoHookean {
                    shear_modulus: isochoric * body.shear_modulus,
                    bulk_modulus: volumetric * body.bulk_modulus,
                },
                biot_coefficient: alpha,
                mobility: body.permeability / parameters.viscosity,
                fluid_compressibility: parameters.fluid_compressibility,
                consistent,
            },
            side,
        }
    }

    /// Modulus of uniaxial strain [Pa].
    fn aggregate_modulus(&self) -> f64 {
        self.tissue.solid.bulk_modulus + 4.0 / 3.0 * self.tissue.solid.shear_modulus
    }
}

impl System {
    /// Meshes and numbers a case. `mirrored` solves for the upper body only and takes the lower one as its mirror image.
    pub fn new(parameters: &Parameters, mirrored: bool) -> Self {
        let p = parameters;
        let columns = p.mesh.columns as usize;
        let half_width = half_width(p);
        let stations = quadratic_stations(columns, |i| {
            half_width * graded(2.0 * i as f64 / columns as f64 - 1.0, p.mesh.column_grading)
        });
        let mut layers = vec![Layer::new(p, &p.upper, 1.0, &stations)];
        if !mirrored {
            layers.push(Layer::new(p, &p.lower, -1.0, &stations));
        }
        let levels = layers[0].mesh.levels();
        let height = |layer: &Layer, i: usize| layer.side * layer.mesh.nodes[i * levels][1];
        let touching_gap = (0..stations.len())
            .map(|i| height(&layers[0], i) + layers.last().map_or(0.0, |layer| height(layer, i)))
            .collect();
        let mut weights = vec![0.0; stations.len()];
        for column in 0..columns {
            let length = stations[2 * column + 2] - stations[2 * column];
            for (a, share) in SIMPSON.into_iter().enumerate() {
                weights[2 * column + a] += share * length;
            }
        }
        let meshes: Vec<_> = layers.iter().map(|layer| &layer.mesh).collect();
        let layout = Layout::new(&meshes);

        let modulus = layers.iter().map(Layer::aggregate_modulus).fold(0.0, f64::max);
        let thickness = p.upper.thickness.max(p.lower.thickness);
        let mobility = layers.iter().map(|layer| layer.tissue.mobility).fold(0.0, f64::max);
        // One micron of displacement goes with this much pressure; rows are scaled to match.
        let (length, pressure) = (1e-6, 1e-6 * modulus / thickness);
        let column_scale = layout.quantities.iter().map(|q| if *q == Quantity::Pressure { pressure } else { length });
        let row_scale = layout.quantities.iter().map(|q| match q {
            Quantity::Pressure => 1.0 / (mobility * pressure),
            _ => 1.0 / (modulus * length),
        });
        let linear = Multifrontal::new(&layout.cells, &layout.clusters(), row_scale.collect(), column_scale.collect());
        Self {
            layers,
            stations,
            weights,
            touching_gap,
            film: Film {
                viscosity: p.viscosity,
                fluid_compressibility: p.fluid_compressibility,
                pressure_order: p.pressure_order,
            },
            parameters: *parameters,
            contact_stiffness: modulus / thickness,
            stress_scale: modulus,
            thickness,
            height: levels_below_surface(&p.mesh, 1.0).into_iter().map(|depth| 1.0 - depth).collect(),
            layout,
            linear,
        }
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.layout.unknowns()
    }

    /// Whether only the upper body is solved for.
    pub fn mirrored(&self) -> bool {
        self.layers.len() == 1
    }

    /// Bodies that stand for one another: 2 for a mirrored pair, else 1.
    fn copies(&self) -> f64 {
        2.0 / self.layers.len() as f64
    }

    /// The exact solution without motion and without contact.
    pub fn rest(&self, penetration_depth: f64) -> Vec<f64> {
        let mut unknowns = vec![0.0; self.unknowns()];
        for (gap, touching) in self.layout.gap.iter().zip(&self.touching_gap) {
            unknowns[*gap as usize] = touching - penetration_depth;
        }
        for layer in 0..self.layers.len() {
            let shift = -0.5 * self.layers[layer].side * penetration_depth;
            for number in self.layout.vertical[layer].iter().filter(|n| **n != FIXED) {
                unknowns[*number as usize] = shift;
            }
        }
        unknowns
    }

    /// Displacements and pressures of an element's nodes.
    pub fn local(&self, body: usize, element: usize, unknowns: &[f64], penetration_depth: f64) -> Local {
        self.gather(body, element, unknowns, -0.5 * self.layers[body].side * penetration_depth, 1.0)
    }

    /// Nodal values: unknowns, the bone's displacement, and the gap of the undeformed surfaces times `offset`.
    fn gather(&self, body: usize, element: usize, unknowns: &[f64], bone: f64, offset: f64) -> Local {
        let layout = &self.layout;
        let layer = &self.layers[body];
        let nodes = layer.mesh.element_nodes(element);
        let value = |number: u32| if number == FIXED { 0.0 } else { unknowns[number as usize] };
        let last = layer.mesh.levels() - 1;
        let mut local = [0.0; LOCAL];
        for (a, n) in nodes.into_iter().enumerate() {
            local[a] = value(layout.horizontal[body][n]);
            let level = n % (last + 1);
            local[NODES + a] = if level == 0 {
                let station = n / (last + 1);
                let opening = unknowns[layout.gap[station] as usize] - offset * self.touching_gap[station];
                layout.mean.get(station).map_or(0.0, |m| unknowns[*m as usize]) + 0.5 * layer.side * opening
            } else if level == last {
                bone
            } else {
                value(layout.vertical[body][n])
            };
            local[2 * NODES + a] = value(layout.pressure[body][n]);
        }
        local
    }

    /// Change of an element's nodal values with a change of the unknowns and of the penetration depth.
    pub fn local_change(&self, body: usize, element: usize, change: &[f64], penetration_depth: f64) -> Local {
        self.gather(body, element, change, -0.5 * self.layers[body].side * penetration_depth, 0.0)
    }

    fn film_local(&self, column: usize, unknowns: &[f64]) -> film::Local {
        let levels = self.layers[0].mesh.levels();
        std::array::from_fn(|i| {
            let station = 2 * column + i % 3;
            let number = if i < 3 { self.layout.gap[station] } else { self.layout.pressure[0][station * levels] };
            if number == FIXED { 0.0 } else { unknowns[number as usize] }
        })
    }

    fn film_length(&self, column: usize) -> f64 {
        self.stations[2 * column + 2] - self.stations[2 * column]
    }

    fn volume_rate(&self, rates: Option<&Rates>, body: usize, element: usize) -> VolumeRate {
        rates.map_or_else(VolumeRate::default, |r| VolumeRate { rate: r.rate, history: r.volume[body][element] })
    }

    fn mass_rate(&self, rates: Option<&Rates>, column: usize) -> MassRate {
        rates.map_or_else(MassRate::default, |r| MassRate { rate: r.rate, history: r.film[column] })
    }

    /// Adds local residual terms to the equations. Vertical equations of the surface go to the gap (halved, with the body's
    /// sign) and to the mean.
    fn scatter(&self, body: usize, element: usize, local: &Local, values: &mut [f64]) {
        let layout = &self.layout;
        let layer = &self.layers[body];
        let rows = layer.mesh.rows;
        let cell = &layout.cells[layout.cell(body, element)];
        for (value, number) in local.iter().zip(cell).filter(|(_, n)| **n != FIXED) {
            values[*number as usize] += value;
        }
        if element.is_multiple_of(rows) {
            for a in 0..3 {
                let force = local[NODES + a];
                values[cell[NODES + a] as usize] += (0.5 * layer.side - 1.0) * force;
                if let Some(mean) = layout.mean.get(2 * (element / rows) + a) {
                    values[*mean as usize] += force;
                }
            }
        }
    }

    /// Volumes and masses whose rates of change enter the balances.
    pub fn contents(&self, unknowns: &[f64], inputs: &Inputs) -> Contents {
        let volume = self.layers.iter().enumerate().map(|(body, layer)| {
            let element = |element| {
                let at = self.local(body, element, unknowns, inputs.penetration_depth);
                std::array::from_fn(|point| Tissue::strain(&layer.mesh, element, point, &at).volume_ratio())
            };
            (0..layer.mesh.elements()).map(element).collect()
        });
        let film = (0..self.layers[0].mesh.columns).map(|column| self.film.mass(&self.film_local(column, unknowns)));
        Contents { volume: volume.collect(), film: film.collect() }
    }

    /// Residual of all equations; contact enters by [`Self::apply_contact`].
    fn raw_residual(
        &self,
        unknowns: &[f64],
        inputs: &Inputs,
        rates: Option<&Rates>,
        values: &mut [f64],
    ) -> Result<(), Inverted> {
        values.fill(0.0);
        let speeds = surface_speeds(inputs);
        for (body, layer) in self.layers.iter().enumerate() {
            for element in 0..layer.mesh.elements() {
                let at = self.local(body, element, unknowns, inputs.penetration_depth);
                let mut local = [0.0; LOCAL];
                let rate = self.volume_rate(rates, body, element);
                let terms = ElementTerms { residual: Some(&mut local), by_speed: None, tangent: None };
                layer.tissue.element(&layer.mesh, element, &at, speeds[body], &rate, terms)?;
                if element.is_multiple_of(layer.mesh.rows) && layer.tissue.consistent {
                    let terms = ElementTerms { residual: Some(&mut local), by_speed: None, tangent: None };
                    tissue::surface_pressure(&layer.mesh, element, layer.side, &at, terms);
                }
                self.scatter(body, element, &local, values);
            }
        }
        let levels = self.layers[0].mesh.levels();
        for column in 0..self.layers[0].mesh.columns {
            let at = self.film_local(column, unknowns);
            let terms =
                self.film.element(self.film_length(column), &at, inputs.sliding_speed, &self.mass_rate(rates, column));
            for a in 0..3 {
                let number = self.layout.pressure[0][(2 * column + a) * levels];
                if number != FIXED {
                    values[number as usize] += terms.residual[a] / self.copies();
                }
            }
        }
        Ok(())
    }

    /// A mirrored pair has no boundary friction on the tissue: it would break the symmetry.
    fn friction(&self, inputs: &Inputs) -> (f64, [f64; 2]) {
        if self.mirrored() { (0.0, [0.0; 2]) } else { boundary_friction_with_slopes(&self.parameters, inputs) }
    }

    /// Residual at these unknowns, with the active set renewed from it. Returns whether the set changed.
    ///
    /// # Errors
    /// [`Inverted`] where an element is turned inside out.
    pub fn residual(
        &self,
        unknowns: &[f64],
        active: &mut [bool],
        inputs: &Inputs,
        rates: Option<&Rates>,
        residual: &mut Residual,
    ) -> Result<bool, Inverted> {
        let Residual { values, contact_forces } = residual;
        values.resize(self.unknowns(), 0.0);
        contact_forces.resize(self.stations.len(), 0.0);
        self.raw_residual(unknowns, inputs, rates, values)?;
        let mut changed = false;
        for (i, active) in active.iter_mut().enumerate() {
            let gap = self.layout.gap[i] as usize;
            contact_forces[i] = self.copies() * values[gap];
            let pressure = if *active { contact_forces[i] / self.weights[i] } else { 0.0 };
            // A station whose pressure and gap are both round-off keeps its status.
            let hysteresis = 1e-11 * self.stress_scale * if *active { 1.0 } else { -1.0 };
            let now = is_active(pressure + hysteresis, unknowns[gap], self.contact_stiffness);
            changed |= now != *active;
            *active = now;
        }
        let (share, _) = self.friction(inputs);
        for i in (0..active.len()).filter(|i| active[*i]) {
            let gap = self.layout.gap[i] as usize;
            self.add_friction(i, share * contact_forces[i], values);
            values[gap] = self.layout.gap_uses[i] * self.contact_diagonal() * unknowns[gap];
        }
        Ok(changed)
    }

    fn contact_diagonal(&self) -> f64 {
        self.stress_scale
    }

    /// Adds a tangential force at a station, along -x on the upper and +x on the lower body.
    fn add_friction(&self, station: usize, force: f64, values: &mut [f64]) {
        if force != 0.0 {
            let node = station * self.layers[0].mesh.levels();
            for (body, layer) in self.layers.iter().enumerate() {
                values[self.layout.horizontal[body][node] as usize] += layer.side * force;
            }
        }
    }

    /// Factorises on up to this many threads; a single one unless told otherwise. The results are the same bits.
    pub fn set_threads(&mut self, threads: usize) {
        self.linear.set_threads(threads);
    }

    /// Factorises the tangent at these unknowns.
    ///
    /// # Errors
    /// [`Singular`] where elimination breaks down.
    pub fn factorise(
        &mut self,
        unknowns: &[f64],
        active: &[bool],
        inputs: &Inputs,
        rates: Option<&Rates>,
    ) -> Result<(), Singular> {
        let Self { linear, .. } = self;
        // The factorisation is taken out while the rest of the system fills it.
        let mut linear = std::mem::replace(linear, Multifrontal::empty());
        let result = linear.factorise(&self.layout.cells, |cell, matrix| {
            self.cell_tangent(cell, unknowns, active, inputs, rates, matrix);
        });
        self.linear = linear;
        result
    }

    /// Solves with the last factorisation, in place, for any number of right-hand sides.
    ///
    /// # Errors
    /// [`Singular`] where the answer is not finite.
    pub fn solve(&self, right_hand_sides: &mut [f64]) -> Result<(), Singular> {
        self.linear.solve(right_hand_sides)
    }

    /// Tangent over an element's nodal values, before contact and the film.
    fn element_tangent(
        &self,
        body: usize,
        element: usize,
        at: &Local,
        inputs: &Inputs,
        rates: Option<&Rates>,
    ) -> [f64; LOCAL * LOCAL] {
        let layer = &self.layers[body];
        let mut tangent = [0.0; LOCAL * LOCAL];
        let rate = self.volume_rate(rates, body, element);
        let terms = ElementTerms { residual: None, by_speed: None, tangent: Some(&mut tangent) };
        // An inverted element was refused when the residual was formed.
        let inverted =
            layer.tissue.element(&layer.mesh, element, at, surface_speeds(inputs)[body], &rate, terms).is_err();
        if inverted {
            tangent.fill(f64::NAN);
        }
        if element.is_multiple_of(layer.mesh.rows) && layer.tissue.consistent {
            let terms = ElementTerms { residual: None, by_speed: None, tangent: Some(&mut tangent) };
            tissue::surface_pressure(&layer.mesh, element, layer.side, at, terms);
        }
        tangent
    }

    /// Derivative of an element's residual by the speed of its surface.
    fn element_by_speed(&self, body: usize, element: usize, at: &Local, inputs: &Inputs) -> Local {
        let layer = &self.layers[body];
        let mut by_speed = [0.0; LOCAL];
        let terms = ElementTerms { residual: None, by_speed: Some(&mut by_speed), tangent: None };
        let speed = surface_speeds(inputs)[body];
        if layer.tissue.element(&layer.mesh, element, at, speed, &VolumeRate::default(), terms).is_err() {
            by_speed.fill(f64::NAN);
        }
        by_speed
    }

    /// Matrix of a cell over its unknowns: tissue, film, and contact by rows and columns.
    fn cell_tangent(
        &self,
        cell: usize,
        unknowns: &[f64],
        active: &[bool],
        inputs: &Inputs,
        rates: Option<&Rates>,
        matrix: &mut [f64],
    ) {
        let (body, element) = self.layout.body_and_element(cell);
        let layer = &self.layers[body];
        let at = self.local(body, element, unknowns, inputs.penetration_depth);
        let tangent = self.element_tangent(body, element, &at, inputs, rates);
        let m = self.layout.cells[cell].len();
        for (column, values) in tangent.chunks_exact(LOCAL).enumerate() {
            matrix[column * m..column * m + LOCAL].copy_from_slice(values);
        }
        if element % layer.mesh.rows != 0 {
            return;
        }
        let column = element / layer.mesh.rows;
        let half = 0.5 * layer.side;
        let two_bodies = m > LOCAL;
        // Columns: the vertical displacement of a surface node is mean + side/2 gap.
        for a in 0..3 {
            for i in 0..LOCAL {
                let value = matrix[(NODES + a) * m + i];
                matrix[(NODES + a) * m + i] = half * value;
                if two_bodies {
                    matrix[(LOCAL + a) * m + i] = value;
                }
            }
        }
        // Rows likewise, then friction and the condition of contact.
        let (share, _) = self.friction(inputs);
        for j in 0..m {
            let values = &mut matrix[j * m..(j + 1) * m];
            for a in 0..3 {
                let value = values[NODES + a];
                values[NODES + a] = half * value;
                if two_bodies {
                    values[LOCAL + a] = value;
                    if active[2 * column + a] {
                        values[a] += layer.side * share * half * value;
                        values[LOCAL + 3 + a] -= layer.side * share * half * value;
                    }
                }
                if active[2 * column + a] {
                    values[NODES + a] = if j == NODES + a { self.contact_diagonal() } else { 0.0 };
                }
            }
        }
        if body == 0 {
            let at = self.film_local(column, unknowns);
            let terms =
                self.film.element(self.film_length(column), &at, inputs.sliding_speed, &self.mass_rate(rates, column));
            for a in 0..3 {
                for b in 0..3 {
                    matrix[(NODES + b) * m + 2 * NODES + a] += terms.tangent[a][b] / self.copies();
                    matrix[(2 * NODES + b) * m + 2 * NODES + a] += terms.tangent[a][3 + b] / self.copies();
                }
            }
        }
    }

    /// Derivatives of the unknowns by penetration depth, sliding speed and slide-to-roll ratio, from the last factorisation: three
    /// vectors, one after the other.
    ///
    /// # Errors
    /// [`Singular`] where the answer is not finite.
    pub fn sensitivities(
        &self,
        unknowns: &[f64],
        active: &[bool],
        inputs: &Inputs,
        rates: Option<&Rates>,
        contact_forces: &[f64],
    ) -> Result<Vec<f64>, Singular> {
        let n = self.unknowns();
        let mut columns = vec![0.0; 3 * n];
        for (k, direction) in input_directions(inputs).into_iter().enumerate() {
            if k == 2 && self.mirrored() {
                // Exchanging the bodies reverses the slide-to-roll ratio: what is mirror-symmetric does not change with it.
                continue;
            }
            let values = &mut columns[k * n..(k + 1) * n];
            let zero = vec![0.0; n];
            self.directional(unknowns, inputs, rates, &zero, &direction, 0..self.layers[0].mesh.rows, values);
            let (share, slopes) = self.friction(inputs);
            for i in (0..active.len()).filter(|i| active[*i]) {
                let gap = self.layout.gap[i] as usize;
                let change = share * self.copies() * values[gap]
                    + (slopes[0] * direction.speeds[0] + slopes[1] * direction.speeds[1]) * contact_forces[i];
                self.add_friction(i, change, values);
                values[gap] = 0.0;
            }
            values.iter_mut().for_each(|v| *v = -*v);
        }
        self.solve(&mut columns)?;
        Ok(columns)
    }

    /// Derivatives of the contact forces by the three inputs, given those of the unknowns.
    pub fn contact_force_sensitivities(
        &self,
        unknowns: &[f64],
        active: &[bool],
        inputs: &Inputs,
        rates: Option<&Rates>,
        sensitivities: &[f64],
    ) -> Vec<Vec<f64>> {
        let n = self.unknowns();
        let mut values = vec![0.0; n];
        input_directions(inputs)
            .into_iter()
            .enumerate()
            .map(|(k, direction)| {
                values.fill(0.0);
                if active.contains(&true) {
                    self.directional(
                        unknowns,
                        inputs,
                        rates,
                        &sensitivities[k * n..(k + 1) * n],
                        &direction,
                        0..1,
                        &mut values,
                    );
                }
                let force = |i: usize| self.copies() * values[self.layout.gap[i] as usize];
                (0..active.len()).map(|i| if active[i] { force(i) } else { 0.0 }).collect()
            })
            .collect()
    }

    /// Adds the derivative of the residual before contact along a change of unknowns and inputs, for some rows of elements.
    #[allow(clippy::too_many_arguments)]
    fn directional(
        &self,
        unknowns: &[f64],
        inputs: &Inputs,
        rates: Option<&Rates>,
        change: &[f64],
        direction: &Direction,
        rows: std::ops::Range<usize>,
        values: &mut [f64],
    ) {
        for (body, layer) in self.layers.iter().enumerate() {
            for element in 0..layer.mesh.elements() {
                let row = element % layer.mesh.rows;
                // Only the row at the bone feels the depth; all rows feel the speed.
                let relevant = direction.speeds != [0.0; 2] || rows.len() == 1 || row + 1 == layer.mesh.rows;
                if !rows.contains(&row) || !relevant {
                    continue;
                }
                let at = self.local(body, element, unknowns, inputs.penetration_depth);
                let local_change = self.local_change(body, element, change, direction.penetration_depth);
                let mut local = self.element_by_speed(body, element, &at, inputs).map(|v| v * direction.speeds[body]);
                if local_change.iter().any(|c| *c != 0.0) {
                    let tangent = self.element_tangent(body, element, &at, inputs, rates);
                    for (column, c) in tangent.chunks_exact(LOCAL).zip(local_change) {
                        if c != 0.0 {
                            local.iter_mut().zip(column).for_each(|(l, t)| *l += t * c);
                        }
                    }
                }
                self.scatter(body, element, &local, values);
            }
        }
        let levels = self.layers[0].mesh.levels();
        let sliding = direction.speeds[0] + direction.speeds[1];
        for column in 0..self.layers[0].mesh.columns {
            let at = self.film_local(column, unknowns);
            let local = self.film_local(column, change);
            let terms =
                self.film.element(self.film_length(column), &at, inputs.sliding_speed, &self.mass_rate(rates, column));
            for a in 0..3 {
                let number = self.layout.pressure[0][(2 * column + a) * levels];
                if number != FIXED {
                    let along: f64 = terms.tangent[a].iter().zip(local).map(|(t, c)| t * c).sum();
                    values[number as usize] += (along + terms.by_speed[a] * sliding) / self.copies();
                }
            }
        }
    }

    /// Fluid that flows from the bodies into the film at each station, V times weight [m^2/s], from the film's balance; and its
    /// derivative along a change of the unknowns and of the sliding speed.
    pub fn film_outflow(
        &self,
        unknowns: &[f64],
        inputs: &Inputs,
        rates: Option<&Rates>,
        change: &[f64],
        sliding: f64,
    ) -> Vec<[f64; 2]> {
        let mut outflow = vec![[0.0; 2]; self.stations.len()];
        for column in 0..self.layers[0].mesh.columns {
            let at = self.film_local(column, unknowns);
            let local = self.film_local(column, change);
            let terms =
                self.film.element(self.film_length(column), &at, inputs.sliding_speed, &self.mass_rate(rates, column));
            for a in 0..3 {
                let along: f64 = terms.tangent[a].iter().zip(local).map(|(t, c)| t * c).sum();
                outflow[2 * column + a][0] += terms.residual[a];
                outflow[2 * column + a][1] += along + terms.by_speed[a] * sliding;
            }
        }
        outflow
    }

    /// Weight of gaps against contact pressures [Pa/m].
    pub fn contact_stiffness(&self) -> f64 {
        self.contact_stiffness
    }

    /// Compresses the tissue evenly through its thickness by an approach of the bones [m], with the gap as it is.
    pub fn compress(&self, unknowns: &mut [f64], approach: f64) {
        for (layer, vertical) in self.layers.iter().zip(&self.layout.vertical) {
            for numbers in vertical.chunks_exact(self.height.len()) {
                for (number, height) in numbers.iter().zip(&self.height).filter(|(n, _)| **n != FIXED) {
                    unknowns[*number as usize] -= 0.5 * layer.side * approach * (1.0 - height);
                }
            }
        }
    }

    /// Subtracts an update from the unknowns. Where the film is thicker than `THIN_FILM` the gap closes to no less than a tenth
    /// and opens to no more than three times what it was: its conductance goes with the cube of it, so that a tangent says nothing
    /// about larger changes. The tissue below follows, less and less towards the bone, so that no element is turned inside out.
    pub fn apply(&self, unknowns: &mut [f64], update: &[f64], active: &[bool]) {
        let thin = THIN_FILM * self.thickness;
        let gaps: Vec<f64> = self.layout.gap.iter().map(|number| unknowns[*number as usize]).collect();
        unknowns.iter_mut().zip(update).for_each(|(z, d)| *z -= d);
        for (station, before) in gaps.into_iter().enumerate() {
            let gap = &mut unknowns[self.layout.gap[station] as usize];
            let smallest = if active[station] || before <= thin { f64::NEG_INFINITY } else { 0.1 * before };
            let limited = gap.min((3.0 * before).max(5.0 * thin)).max(smallest);
            let correction = limited - *gap;
            *gap = limited;
            if correction != 0.0 {
                for (layer, vertical) in self.layers.iter().zip(&self.layout.vertical) {
                    let column = &vertical[station * self.height.len()..(station + 1) * self.height.len()];
                    for (number, height) in column.iter().zip(&self.height).filter(|(n, _)| **n != FIXED) {
                        unknowns[*number as usize] += 0.5 * layer.side * correction * height;
                    }
                }
            }
        }
    }

    /// Size of an update relative to the fields: displacements and pressures to their largest values, gaps each to itself (and to
    /// `THIN_FILM` where the surfaces all but touch).
    pub fn relative_size(&self, unknowns: &[f64], update: &[f64]) -> f64 {
        // What is below a millionth of the layer's thickness or modulus is no displacement or pressure to speak of.
        let mut displacement = (1e-6 * self.thickness, 0.0_f64);
        let mut pressure = (1e-6 * self.stress_scale, 0.0_f64);
        let mut gap = 0.0_f64;
        for ((value, change), quantity) in unknowns.iter().zip(update).zip(&self.layout.quantities) {
            let (value, change) = (value.abs(), change.abs());
            // `max` would pass over a NaN.
            if !change.is_finite() {
                return f64::INFINITY;
            }
            match quantity {
                Quantity::Displacement => displacement = (displacement.0.max(value), displacement.1.max(change)),
                Quantity::Pressure => pressure = (pressure.0.max(value), pressure.1.max(change)),
                Quantity::Gap => gap = gap.max(change / (value + THIN_FILM * self.thickness)),
            }
        }
        (displacement.1 / displacement.0).max(pressure.1 / pressure.0).max(gap)
    }

    /// Entries of the factors, a measure of memory.
    pub fn factor_entries(&self) -> usize {
        self.linear.factor_entries()
    }
}

/// A change of the inputs.
struct Direction {
    penetration_depth: f64,
    speeds: [f64; 2],
}

/// Unit changes of penetration depth, sliding speed and slide-to-roll ratio.
fn input_directions(inputs: &Inputs) -> [Direction; 3] {
    let s = inputs.slide_to_roll_ratio;
    let half = 0.5 * inputs.sliding_speed;
    [
        Direction { penetration_depth: 1.0, speeds: [0.0; 2] },
        Direction { penetration_depth: 0.0, speeds: [0.5 * (1.0 + s), 0.5 * (1.0 - s)] },
        Direction { penetration_depth: 0.0, speeds: [half, -half] },
    ]
}
