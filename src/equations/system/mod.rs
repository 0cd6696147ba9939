//! The discrete system: two poroelastic layers, the film between them and their contact, as one set of equations.

mod film_gap;
mod laws;
mod load;
mod local;
mod pairing;
mod prediction;
mod problem;
mod rates;
mod residual;
mod rubbing;
mod state;
mod tangent;
mod transfer;
mod update;

pub use laws::{Layer, fluid};
pub use load::Loads;
pub use problem::{ReusableTangent, Slope, Task};
pub use state::{Rates, Solved, State, StoredVolumes};
pub use tangent::{Change, Direction, Perturbation};

use crate::equations::contact::{Contact, ContactLaw, Rubbing};
use crate::equations::film::{self, Film, MassRate};
use crate::equations::film_end::{FilmEnd, Outflow};
use crate::equations::grid::{self, Grid};
use crate::equations::layout::{Layout, Quantity};
use crate::equations::surface::Surface;
use crate::fem::element::SIMPSON;
use crate::parameters::{Formulation, Inputs, Parameters};
use crate::solver::linear::{FIXED, Multifrontal};
pub use laws::roughness;
use laws::{body, boundary_friction, mobility, sector};
use problem::Tangent;

/// The discrete equations of a pair of layers, with the factorisation of their last tangent.
#[derive(Debug)]
pub struct System {
    /// The upper body, and the lower one unless it is the upper one's mirror image or rigid.
    pub layers: Vec<Layer>,
    /// What contact the mesh is made for, see [`crate::equations::grid::contact_half_width`] \[m\].
    contact_half_width: f64,
    shifts: Vec<f64>,
    /// See [`Task::distance_counts`].
    distance_counts: bool,
    thickening: f64,
    /// x of the interface nodes \[m\].
    pub stations: Vec<f64>,
    /// Positions of the interface nodes along the arc of the film \[m\].
    pub arc: Vec<f64>,
    /// Cosine of the angle of that arc with the x axis, at the interface nodes.
    pub cosine: Vec<f64>,
    /// Simpson weights of the interface nodes \[m\].
    pub weights: Vec<f64>,
    /// Distance of the undeformed surfaces at first touch, across the arc \[m\].
    pub touching_gap: Vec<f64>,
    /// The unknowns.
    pub layout: Layout,
    film: Film,
    /// The film beyond the sector; none where it ends there with p = 0.
    film_ends: Option<[FilmEnd; 2]>,
    parameters: Parameters,
    /// Weight of gaps against contact pressures, and of void against fluid pressures \[Pa/m\].
    contact_stiffness: f64,
    stress_scale: f64,
    thickness: f64,
    /// Height of the levels above the bone, as a fraction of the thickness, of each body.
    height: Vec<Vec<f64>>,
    linear: Multifrontal,
    tangent: Tangent,
}

/// Whether anything moves the fluid of the film: walls or time.
fn moves(inputs: &Inputs, rates: Option<&Rates>) -> bool {
    inputs.sliding_speed != 0.0 || rates.is_some()
}

impl System {
    /// Meshes and numbers a case. `mirrored` solves for the upper body only and takes the lower one as its mirror image.
    /// The mesh is made for a contact of this half-width, see [`crate::equations::grid::contact_half_width`].
    pub fn new(parameters: &Parameters, mirrored: bool, contact_half_width: f64) -> Self {
        let p = parameters;
        let grid = Grid::new(p, contact_half_width, &[]);
        let mut layers = vec![Layer::new(p, 1.0, &grid)];
        if !mirrored && !p.rigid_lower {
            layers.push(Layer::new(p, -1.0, &grid));
        }
        let meshes: Vec<_> = layers.iter().map(|layer| &layer.mesh).collect();
        let consistent = p.formulation == Formulation::Consistent;
        // Smooth surfaces in contact, and those of the paper, face each other as they do undeformed.
        let rises = consistent && meshes.len() == 2 && p.surface_roughness > 0.0;
        let layout = Layout::new(&meshes, p.cavitation, consistent, rises);
        let copies = if mirrored { 2.0 } else { 1.0 };
        let modulus = layers.iter().map(|layer| layer.tissue.solid.aggregate_modulus()).fold(0.0, f64::max);
        let thickness = if p.rigid_lower { p.upper.thickness } else { p.upper.thickness.max(p.lower.thickness) };
        let mobility = layers.iter().map(|layer| layer.tissue.mobility).fold(0.0, f64::max);
        // Both bodies give way to a ripple of pressure.
        let shear_modulus = 2.0 / layers.iter().map(|layer| copies / layer.tissue.solid.shear_modulus()).sum::<f64>();
        // One micron of displacement goes with this much pressure; rows are scaled to match.
        let (length, pressure) = (1e-6, 1e-6 * modulus / thickness);
        let column_scale = layout.quantities.iter().map(|q| match q {
            Quantity::Pressure => pressure,
            Quantity::Displacement | Quantity::Gap | Quantity::Void => length,
        });
        let row_scale = layout.quantities.iter().map(|q| match q {
            Quantity::Pressure => 1.0 / (mobility * pressure),
            // Heavy, so that a known pressure is eliminated by its own equation: in the film's balance the conductance of a wide gap
            // would drown the void.
            Quantity::Void => 1e15 / pressure,
            Quantity::Displacement | Quantity::Gap => 1.0 / (modulus * length),
        });
        let linear = Multifrontal::new(&layout.cells, &layout.clusters(), row_scale.collect(), column_scale.collect());
        let heights = |depths: &Vec<f64>| depths.iter().map(|depth| 1.0 - depth).collect();
        let height = grid.depths.iter().map(heights).collect();
        let mut system = Self {
            layers,
            contact_half_width,
            shifts: Vec::new(),
            distance_counts: true,
            thickening: 1.0,
            stations: Vec::new(),
            arc: Vec::new(),
            cosine: Vec::new(),
            weights: Vec::new(),
            touching_gap: Vec::new(),
            film: Film {
                fluid: fluid(p),
                shear_film_offset: p.shear_film_offset,
                fluid_compressibility: p.fluid_compressibility,
                pressure_order: p.pressure_order,
                cavitates: p.cavitation,
                rough: roughness(p).map(|rough| (rough, shear_modulus)),
            },
            film_ends: None,
            parameters: *parameters,
            contact_stiffness: modulus / thickness,
            stress_scale: modulus,
            thickness,
            height,
            layout,
            linear,
            tangent: Tangent::default(),
        };
        system.take_interface(grid);
        system
    }

    /// Takes the mesh along to a contact of this half-width, and the fluid's viscosity, in film and pores, to so many times its own;
    /// what was factorised stays as it was.
    pub fn fit(&mut self, contact_half_width: f64, shifts: &[f64], thickening: f64) {
        if self.contact_half_width != contact_half_width || self.shifts != shifts {
            self.contact_half_width = contact_half_width;
            self.shifts = shifts.to_vec();
            let grid = Grid::new(&self.parameters, contact_half_width, shifts);
            for layer in &mut self.layers {
                layer.mesh = sector(&self.parameters, layer.side, &grid);
            }
            self.take_interface(grid);
        }
        self.thickening = thickening;
        self.film.fluid = fluid(&self.parameters).thickened(thickening);
        self.film_ends.iter_mut().flatten().for_each(|end| end.fluid = self.film.fluid);
        for layer in &mut self.layers {
            layer.tissue.mobility = mobility(&self.parameters, layer.side) / thickening;
        }
    }

    /// How many times its own viscosity the fluid has at present.
    pub fn thickening(&self) -> f64 {
        self.thickening
    }

    fn take_interface(&mut self, grid: Grid) {
        let Grid { stations, arc, cosine, touching_gap, .. } = grid;
        self.weights = vec![0.0; stations.len()];
        for first in (0..stations.len() - 1).step_by(2) {
            let length = stations[first + 2] - stations[first];
            for (a, weight) in SIMPSON.into_iter().enumerate() {
                self.weights[first + a] += weight * length;
            }
        }
        let p = &self.parameters;
        if p.formulation == Formulation::Consistent && !p.cavitation {
            let x = stations[stations.len() - 1];
            let sum = |f: &dyn Fn(f64) -> f64| f(p.upper.curvature()) + f(p.lower.curvature());
            // Of a circle: y' = x/R / sqrt(1 - (x/R)^2); across the arc of the film, and along it.
            let along_y = sum(&|curvature| x * curvature / (1.0 - (x * curvature).powi(2)).sqrt());
            let (last, arc) = (stations.len() - 1, grid::film_curvature(p));
            let slope = cosine[last] * (cosine[last] * along_y) - touching_gap[last] * x * arc.powi(2) / cosine[last];
            let curvature = sum(&|curvature| curvature);
            self.film_ends = Some([-1.0, 1.0].map(|side| FilmEnd { side, slope, curvature, fluid: self.film.fluid }));
        }
        (self.stations, self.arc, self.cosine, self.touching_gap) = (stations, arc, cosine, touching_gap);
    }

    /// The case.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.layout.unknowns()
    }

    /// The film.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// The surface of a body in a column.
    fn surface(&self, body: usize, column: usize) -> Surface {
        let parts = [0, 1, 2].map(|a| self.surface_part(body, 2 * column + a));
        Surface::new(parts, self.layers.len() == 2, !self.layout.rise.is_empty())
    }

    /// What the surface of a body takes along y of an opening of the gap at a station, with its sign.
    fn surface_part(&self, body: usize, station: usize) -> f64 {
        self.part(&self.layers[body]) / self.cosine[station]
    }

    /// Cosine of the angle of a body's undeformed surface at a station.
    fn surface_cosine(&self, body: usize, station: usize) -> f64 {
        let curvature = self::body(&self.parameters, self.layers[body].side).curvature();
        let levels = self.layers[body].mesh.levels();
        (1.0 - (self.layers[body].mesh.nodes[station * levels][0] * curvature).powi(2)).sqrt()
    }

    /// Whether stations can be in one state or another: in contact or not, cavitated or not.
    pub fn has_discrete_state(&self) -> bool {
        self.film.cavitates || !self.contact_law().follows_from_gap()
    }

    /// How gap and pressure of the solids go together.
    pub fn contact_law(&self) -> ContactLaw {
        match self.film.rough {
            Some((roughness, _)) => ContactLaw::Rough(roughness),
            None => ContactLaw::Smooth { stiffness: self.contact_stiffness, modulus: self.stress_scale },
        }
    }

    /// Contact in a column with this rubbing.
    fn contact(&self, rubbing: Rubbing) -> Contact {
        Contact { law: self.contact_law(), rubbing, solid_fraction: self.parameters.solid_fraction }
    }

    /// Whether boundary friction pulls the two bodies apart sideways; if so, they are not mirror images.
    pub fn drags(&self, state: &State) -> bool {
        (state.touches() || self.contact_law().follows_from_gap())
            && boundary_friction(&self.parameters, &state.inputs) != 0.0
    }

    /// Half the width of the interface \[m\].
    pub fn half_width(&self) -> f64 {
        self.stations[self.stations.len() - 1]
    }

    /// What contact the mesh is made for, see [`crate::equations::grid::contact_half_width`] \[m\].
    pub fn contact_half_width(&self) -> f64 {
        self.contact_half_width
    }

    /// Whether the lower body is the mirror image of the upper one.
    pub fn mirrored(&self) -> bool {
        self.layers.len() == 1 && !self.parameters.rigid_lower
    }

    /// Bodies that stand for one another: 2 for a mirrored pair, else 1.
    pub fn copies(&self) -> f64 {
        if self.mirrored() { 2.0 } else { 1.0 }
    }

    /// Part of an approach and of an opening that each layer takes, with its sign along y: a rigid counterface stays where it is.
    fn part(&self, layer: &Layer) -> f64 {
        grid::part(&self.parameters) * layer.side
    }

    /// The exact solution without motion and without contact, on the present mesh.
    pub fn rest(&self, inputs: Inputs) -> State {
        let mut unknowns = vec![0.0; self.unknowns()];
        for ((gap, touching), cosine) in self.layout.gap.iter().zip(&self.touching_gap).zip(&self.cosine) {
            unknowns[*gap as usize] = touching - inputs.penetration_depth * cosine;
        }
        for layer in 0..self.layers.len() {
            let shift = -self.part(&self.layers[layer]) * inputs.penetration_depth;
            for number in self.layout.vertical[layer].iter().filter(|n| **n != FIXED) {
                unknowns[*number as usize] = shift;
            }
        }
        State {
            inputs: Inputs { sliding_speed: 0.0, ..inputs },
            rates: None,
            mirrored: self.mirrored(),
            contact_half_width: self.contact_half_width,
            shifts: self.shifts.clone(),
            thickening: self.thickening,
            unknowns,
            mobilised: Vec::new(),
            active: vec![false; self.stations.len()],
            contact_forces: vec![0.0; self.stations.len()],
        }
    }

    /// What a column of the film gives in a state.
    pub fn film_terms(&self, column: usize, at: &State) -> film::Terms {
        let rate = self.mass_rate(at.rates.as_ref(), column);
        let local = self.film_local(column, &at.unknowns);
        self.film.element(&self.film_element(column), &local, at.inputs.surface_speeds(), &rate)
    }

    /// Mean flux of the film in a column along +x \[m^2/s\].
    pub fn film_flux(&self, column: usize, at: &State) -> f64 {
        let local = self.film_local(column, &at.unknowns);
        let still = MassRate::default();
        let rows = self.film.element(&self.film_element(column), &local, at.inputs.surface_speeds(), &still).rows;
        // Tested with the straight line from 1 to 0, whose slope is one over the length.
        rows[0] + 0.5 * rows[1]
    }

    /// Pressure and thickness of the void where there is either.
    fn pressure_and_void(&self, station: usize, unknowns: &[f64]) -> [f64; 2] {
        let node = station * self.layers[0].mesh.levels();
        [self.layout.pressure[0][node], self.layout.void[station]].map(|number| unknowns[number as usize])
    }

    /// Whether there is void at a station that may have some: the primal-dual active set of complementarity between void and
    /// pressure above that of cavitation. Void of a film that nothing moves would be undetermined, and there is none.
    fn is_cavitated(&self, station: usize, unknowns: &[f64], moves: bool) -> bool {
        let [pressure, void] = self.pressure_and_void(station, unknowns);
        moves && pressure - self.parameters.cavitation_pressure < self.contact_stiffness * void
    }

    /// Whether complementarity of void and pressure changes sides anywhere between two states, by more than round-off.
    pub fn void_changes(&self, before: &State, after: &State) -> bool {
        let excess = |i: usize, state: &State| {
            let [pressure, void] = self.pressure_and_void(i, &state.unknowns);
            pressure - self.parameters.cavitation_pressure - self.contact_stiffness * void
        };
        let least = 1e-9 * self.stress_scale;
        (0..self.stations.len()).filter(|i| self.layout.void[*i] != FIXED).any(|i| {
            let [before, after] = [before, after].map(|state| excess(i, state));
            (before < 0.0) != (after < 0.0) && before.abs().min(after.abs()) > least
        })
    }

    /// Stations where the film is cavitated.
    pub fn cavitated(&self, state: &State) -> Vec<bool> {
        let moves = moves(&state.inputs, state.rates.as_ref());
        let cavitated =
            |i: usize| !state.active[i] && self.layout.void[i] != FIXED && self.is_cavitated(i, &state.unknowns, moves);
        (0..self.stations.len()).map(cavitated).collect()
    }

    /// What leaves through the ends of the film: station, and flux with its derivatives. Ends that move with the mesh pass by some.
    fn film_outflows(
        &self,
        unknowns: &[f64],
        inputs: &Inputs,
        rates: Option<&Rates>,
    ) -> impl Iterator<Item = (usize, Outflow)> {
        let ends =
            [self.film_mesh_speeds(rates, 0)[0], self.film_mesh_speeds(rates, self.layers[0].mesh.columns - 1)[1]];
        let last = self.stations.len() - 1;
        let speeds = inputs.surface_speeds();
        self.film_ends.iter().flatten().zip([0, last]).zip(ends).map(move |((end, station), mesh)| {
            let gap = unknowns[self.layout.gap[station] as usize];
            let pressure = self.layout.pressure[0][station * self.layers[0].mesh.levels()];
            let mut outflow = end.outflow(gap, unknowns[pressure as usize], speeds);
            let (thickness, slope) = self.film.thickness(gap);
            outflow.value -= end.side * mesh * thickness;
            outflow.by_gap -= end.side * mesh * slope;
            (station, outflow)
        })
    }

    /// A column of the undeformed film.
    pub fn film_element(&self, column: usize) -> film::Element {
        let ends = [2 * column, 2 * column + 2];
        let levels = self.layers[0].mesh.levels();
        let width = self.stations[ends[1]] - self.stations[ends[0]];
        let surface = |body: usize| {
            let nodes = &self.layers[body].mesh.nodes;
            (nodes[ends[1] * levels][0] - nodes[ends[0] * levels][0]) / width
        };
        film::Element {
            length: self.arc[ends[1]] - self.arc[ends[0]],
            width,
            surfaces: if self.layers.len() == 2 { [surface(0), surface(1)] } else { [1.0; 2] },
            deforms: self.layers[0].tissue.consistent,
        }
    }

    /// Thickness of the thicker layer \[m\].
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// Entries of the factors, a measure of memory.
    pub fn factor_entries(&self) -> usize {
        self.linear.factor_entries()
    }
}
