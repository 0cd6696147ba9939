//! What the surfaces carry, and how it changes.

use num_dual::{Dual64, DualNum};

use super::{Change, State, System};
use crate::equations::grid;
use crate::fem::element::{GAUSS, GAUSS_WEIGHTS, SIMPSON, pressure, quadratic, quadratic_derivative};
use crate::laws::chain;
use crate::solver::linear::FIXED;

/// What the fluid and what the solid carries, or a change of both, per unit depth \[N/m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loads {
    /// Of the fluid's pressure.
    pub fluid: Dual64,
    /// Of solid contact.
    pub solid: Dual64,
    /// Integral of real contact's fraction times all pressure.
    pub in_real_contact: Dual64,
}

impl Loads {
    /// Both together.
    pub fn total(&self) -> Dual64 {
        self.fluid + self.solid
    }
}

impl System {
    /// Pressure of solid on solid at every station, with its change \[Pa\].
    pub fn contact_pressure(&self, at: &State, change: &Change) -> Vec<Dual64> {
        let law = self.contact_law();
        let pressure = |i: usize| {
            let by_gap = chain(law.pressure(at.gap(self, i)), self.gap_change(change, i));
            match at.active[i] {
                true => by_gap + Dual64::new(at.contact_forces[i], change.contact_forces[i]) / self.weights[i],
                false => by_gap,
            }
        };
        (0..self.stations.len()).map(pressure).collect()
    }

    fn gap_change(&self, change: &Change, station: usize) -> f64 {
        change.unknowns[self.layout.gap[station] as usize]
    }

    /// What the surfaces carry, with its change: vertical forces of pressure and of what rubs on slopes, over the surfaces of the weak
    /// forms, of both bodies on the mean. The fluid of the paper's formulation presses on the undeformed surfaces, that of the consistent
    /// one and rough solids on the deformed ones.
    pub fn loads(&self, at: &State, change: &Change) -> Loads {
        let zero = Dual64::from(0.0);
        let mut loads = Loads { fluid: zero, solid: zero, in_real_contact: zero };
        let law = self.contact_law();
        let height = self.mean_height(at, change);
        let levels = self.layers[0].mesh.levels();
        let value = |number: u32| match number {
            FIXED => zero,
            number => Dual64::new(at.unknowns[number as usize], change.unknowns[number as usize]),
        };
        for first in (0..self.stations.len() - 1).step_by(2) {
            let nodal =
                |numbers: &[u32]| -> [Dual64; 3] { std::array::from_fn(|a| value(numbers[(first + a) * levels])) };
            let fluid = nodal(&self.layout.pressure[0]);
            let length = 0.5 * (self.stations[first + 2] - self.stations[first]);
            // dx/ds of the surfaces.
            let sideways: Vec<[Dual64; 3]> = self.layout.horizontal.iter().map(|numbers| nodal(numbers)).collect();
            let stretch = |s: f64, deformed: bool| -> Dual64 {
                let slope = quadratic_derivative(s);
                let change: Dual64 = sideways.iter().map(|u| (0..3).map(|a| u[a] * slope[a]).sum::<Dual64>()).sum();
                if deformed { change / self.layers.len() as f64 + length } else { Dual64::from(length) }
            };
            let rubs = self.rubbing_along(first / 2, at, change, &self.rubbing_on_tissue(first / 2, at));
            let order = self.layers[0].mesh.pressure_order;
            let interpolated = |s: f64| -> Dual64 { pressure(order, s).iter().zip(&fluid).map(|(n, p)| *p * *n).sum() };
            for (s, w) in GAUSS.into_iter().zip(GAUSS_WEIGHTS) {
                loads.fluid += interpolated(s) * stretch(s, self.layers[0].tissue.consistent) * w;
            }
            for (a, simpson) in SIMPSON.into_iter().enumerate() {
                let (s, i) = (a as f64 - 1.0, first + a);
                let gap = (at.gap(self, i), self.gap_change(change, i));
                let weight = stretch(s, true) * (2.0 * simpson);
                let solid = chain(law.pressure(gap.0), gap.1) * weight;
                let fluid = interpolated(s) * weight;
                let real = chain(law.real_contact_fraction(gap.0), gap.1);
                loads.solid += solid;
                // Friction along sloping surfaces.
                let rise: Dual64 = (0..3).map(|b| height[first + b] * quadratic_derivative(s)[b]).sum();
                let rubbing =
                    chain(law.pressure(gap.0), gap.1) + real * interpolated(s) * self.parameters.solid_fraction;
                loads.solid -= rubs.friction * rubbing * rise * (2.0 * simpson);
                loads.in_real_contact += real * (solid + fluid);
            }
        }
        let forces = at.contact_forces.iter().zip(&change.contact_forces).zip(&at.active);
        for ((force, change), _) in forces.filter(|(_, active)| **active) {
            loads.solid += Dual64::new(*force, *change);
        }
        loads
    }
}

impl System {
    /// What the film beyond the ends of the sector adds to the two parts of the friction forces, see equation 15.
    pub fn film_end_shear(&self, at: &State, change: &Change) -> Vec<[Dual64; 2]> {
        let last = self.stations.len() - 1;
        let levels = self.layers[0].mesh.levels();
        let speeds = at.inputs.surface_speeds().into_iter().zip(change.inputs.surface_speeds(&at.inputs));
        let speeds: Vec<_> = speeds.map(|(speed, change)| Dual64::new(speed, change)).collect();
        let ends = self.film_ends.iter().flatten().zip([0, last]).map(|(end, station)| {
            let value = |number: u32| Dual64::new(at.unknowns[number as usize], change.unknowns[number as usize]);
            end.shear(
                value(self.layout.gap[station]),
                value(self.layout.pressure[0][station * levels]),
                [speeds[0], speeds[1]],
            )
        });
        ends.collect()
    }
}

/// What pressure and friction on one of the surfaces pass on beside the load, per unit depth. Of the lower body: the opposite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnBody {
    /// Moment of the pressures about the middle of the contact, counter-clockwise \[N\].
    pub moment: Dual64,
    /// Boundary friction along x \[N/m\].
    pub friction_along_x: Dual64,
    /// Its moment about the middle of the contact, clockwise \[N\].
    pub friction_moment: Dual64,
}

/// What the pressures on the surfaces pass on beside the load, per unit depth; see [`System::resultant`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resultant {
    /// Force along +x on the upper body of the pressures on sloping surfaces \[N/m\].
    pub on_slopes: Dual64,
    /// Integral of boundary friction along the surfaces: of the pressure of solids, and of the fluid's in real contact as far as friction feels it, times the
    /// friction there \[N/m\].
    pub boundary_friction: Dual64,
    /// Power that boundary friction takes \[W/m\].
    pub boundary_dissipation: Dual64,
    /// On the upper and on the lower body.
    pub bodies: [OnBody; 2],
}

impl Resultant {
    /// The mean of both bodies.
    pub fn mean(&self, get: impl Fn(&OnBody) -> Dual64) -> Dual64 {
        (get(&self.bodies[0]) + get(&self.bodies[1])) * 0.5
    }
}

impl System {
    /// Height of the middle of the deformed film at every station \[m\]; zero between mirror images.
    pub fn mean_height(&self, at: &State, change: &Change) -> Vec<Dual64> {
        let levels = self.layers[0].mesh.levels();
        let value = |number: u32| Dual64::new(at.unknowns[number as usize], change.unknowns[number as usize]);
        let surface = |body: usize, i: usize| self.layers[body].mesh.nodes[i * levels][1];
        let height = |i: usize| match self.layout.mean.get(i) {
            Some(number) => value(*number) + 0.5 * (surface(0, i) + surface(1, i)),
            None if self.mirrored() => Dual64::from(0.0),
            // Above a rigid counterface, which has come up by half the depth.
            None => {
                let depth = Dual64::new(at.inputs.penetration_depth, change.inputs.penetration_depth);
                let counterface = surface(0, i) - self.touching_gap[i] / self.cosine[i];
                value(self.layout.gap[i]) / self.cosine[i] * 0.5 + depth * 0.5 + counterface
            }
        };
        (0..self.stations.len()).map(height).collect()
    }

    /// Height of a station less that at which its tangent to the arc of the film passes x = 0 \[m\]: the lever that a force along the arc
    /// loses by its part along y, per unit of its part along x.
    pub fn tangent_fall(&self, station: usize) -> f64 {
        let sine = self.stations[station] * grid::film_curvature(&self.parameters);
        self.stations[station] * sine / self.cosine[station]
    }

    /// Forces and moments of the pressures and of friction on each body, over the surfaces of [`System::loads`]. Of nodes that are
    /// paired as they are deformed the moments are the same; else they part where the nodes move apart along the surfaces.
    pub fn resultant(&self, at: &State, change: &Change) -> Resultant {
        let zero = Dual64::from(0.0);
        let none = OnBody { moment: zero, friction_along_x: zero, friction_moment: zero };
        let mut sum =
            Resultant { on_slopes: zero, boundary_friction: zero, boundary_dissipation: zero, bodies: [none; 2] };
        let (law, levels) = (self.contact_law(), self.layers[0].mesh.levels());
        let height = self.mean_height(at, change);
        let value = |number: u32| match number {
            FIXED => zero,
            number => Dual64::new(at.unknowns[number as usize], change.unknowns[number as usize]),
        };
        let consistent = self.layers[0].tissue.consistent;
        // Coordinates of the surface nodes of a body, along x of the deformed or of the undeformed surface.
        let coordinates = |body: usize, i: usize, deformed: bool| -> [Dual64; 2] {
            let [x, y] = self.layers[body].mesh.nodes[i * levels];
            let rise = self.layout.rise.get(i).map_or(zero, |number| value(*number));
            let opening = value(self.layout.gap[i]) + rise - self.touching_gap[i];
            // Against a rigid counterface the unknowns are seen from there; both bones come half the way.
            let mean = match self.layout.mean.get(i) {
                Some(number) => value(*number),
                None if self.mirrored() => zero,
                None => Dual64::new(at.inputs.penetration_depth, change.inputs.penetration_depth) * 0.5,
            };
            let sideways = if deformed { value(self.layout.horizontal[body][i * levels]) } else { zero };
            [sideways + x, mean + opening * self.surface_part(body, i) + y]
        };
        let order = self.layers[0].mesh.pressure_order;
        for first in (0..self.stations.len() - 1).step_by(2) {
            let heights = [0, 1, 2].map(|a| height[first + a]);
            let fluid = [0, 1, 2].map(|a| value(self.layout.pressure[0][(first + a) * levels]));
            let surfaces = |deformed: bool| -> Vec<[[Dual64; 3]; 2]> {
                let of_body = |body: usize| {
                    let nodes = [0, 1, 2].map(|a| coordinates(body, first + a, deformed));
                    [nodes.map(|node| node[0]), nodes.map(|node| node[1])]
                };
                (0..self.layers.len()).map(of_body).collect()
            };
            let wetted = surfaces(consistent);
            let half = |body: usize| {
                let nodes = &self.layers[body].mesh.nodes;
                0.5 * (nodes[(first + 2) * levels][0] - nodes[first * levels][0])
            };
            let dot = |f: [f64; 3], v: &[Dual64; 3]| v[0] * f[0] + v[1] * f[1] + v[2] * f[2];
            let press = |sum: &mut Resultant, surfaces: &[[[Dual64; 3]; 2]], s: f64, pressure: Dual64| {
                let slope = quadratic_derivative(s);
                sum.on_slopes -= pressure * dot(slope, &heights);
                let (here, along) = (|of: &[Dual64; 3]| dot(quadratic(s), of), |of: &[Dual64; 3]| dot(slope, of));
                for (body, sum) in sum.bodies.iter_mut().take(surfaces.len()).enumerate() {
                    let [x, y] = &surfaces[body];
                    // Of nodes that are paired as they are deformed half the derivative of x_upper x_lower: the same on both bodies.
                    let (other, y) = match self.pairs_deformed() {
                        true => (&surfaces[1 - body][0], &heights),
                        false => (x, y),
                    };
                    let moment = (here(x) * along(other) + here(other) * along(x)) * 0.5 + here(y) * along(y);
                    sum.moment += pressure * moment;
                }
            };
            for (s, w) in GAUSS.into_iter().zip(GAUSS_WEIGHTS) {
                press(&mut sum, &wetted, s, dot(pressure(order, s), &fluid) * w);
            }
            let rubs = self.rubbing_along(first / 2, at, change, &self.rubbing(first / 2, at));
            // Multipliers rub along x.
            for i in (first..=first + 2).filter(|i| at.active[*i]) {
                let force = Dual64::new(at.contact_forces[i], change.contact_forces[i]);
                let a = i - first;
                let force = force * self.part_of(i, first / 2);
                let slope = quadratic_derivative(a as f64 - 1.0);
                let friction = force * rubs.friction;
                sum.boundary_friction += friction / self.cosine[i];
                for (k, side) in [1.0, -1.0].into_iter().enumerate() {
                    let body = k.min(self.layers.len() - 1);
                    let stretch = match k == body || self.mirrored() {
                        true => dot(slope, &wetted[body][0]) * (self.surface_cosine(body, i) / half(body)),
                        false => Dual64::from(1.0 / self.cosine[i]),
                    };
                    let moves = stretch * rubs.relative[k] + rubs.nodes[k] * self.cosine[i];
                    sum.boundary_dissipation += friction * moves * side;
                }
                for (body, sum) in sum.bodies.iter_mut().take(self.layers.len()).enumerate() {
                    sum.moment += force * wetted[body][0][a];
                    sum.friction_along_x += friction;
                    sum.friction_moment += friction * (height[i] - self.tangent_fall(i));
                }
            }
            // All else is zero of smooth surfaces.
            if !law.follows_from_gap() {
                continue;
            }
            let touching = surfaces(true);
            for (a, simpson) in SIMPSON.into_iter().enumerate() {
                let s = a as f64 - 1.0;
                let gap = (at.gap(self, first + a), self.gap_change(change, first + a));
                let solid = chain(law.pressure(gap.0), gap.1) * (2.0 * simpson);
                press(&mut sum, &touching, s, solid);
                let real = chain(law.real_contact_fraction(gap.0), gap.1);
                let rubbing =
                    solid + real * dot(pressure(order, s), &fluid) * (2.0 * simpson * self.parameters.solid_fraction);
                let friction = rubbing * rubs.friction;
                let slope = quadratic_derivative(s);
                let along = |body: usize| touching[body].each_ref().map(|values| dot(slope, values));
                for (k, side) in [1.0, -1.0].into_iter().enumerate() {
                    let body = k.min(self.layers.len() - 1);
                    let [x, y] = along(body);
                    let length = x * x + y * y;
                    sum.boundary_friction += friction * length.sqrt() * 0.5;
                    // Of a rigid counterface each part of the arc is as long as it was.
                    let moves = match k == body || self.mirrored() {
                        true => length * (self.surface_cosine(body, first + a) / half(body)),
                        false => length.sqrt(),
                    };
                    let power = moves * rubs.relative[k] + x * rubs.nodes[k] * self.cosine[first + a];
                    sum.boundary_dissipation += friction * power * side;
                }
                for (body, [x, y]) in touching.iter().enumerate() {
                    let [along_x, along_y] = along(body);
                    let sum = &mut sum.bodies[body];
                    sum.friction_along_x += friction * along_x;
                    sum.friction_moment += friction * (y[a] * along_x - x[a] * along_y);
                }
            }
        }
        if self.layers.len() == 1 {
            // A mirror image is on the other side of the middle; a rigid counterface feels the same.
            sum.bodies[1] = sum.bodies[0];
            if self.mirrored() {
                sum.bodies[1].friction_moment = -sum.bodies[0].friction_moment;
            }
        }
        sum
    }
}

impl System {
    /// Power of the pressure on what leaves the ends of the film relative to the moving walls, e p (Q - U h/2) with e of
    /// [`crate::equations::film_end`] \[W/m\].
    pub fn film_end_power(&self, at: &State, change: &Change) -> Dual64 {
        let levels = self.layers[0].mesh.levels();
        let speed = Dual64::new(at.inputs.sliding_speed, change.inputs.sliding_speed);
        let value = |number: u32| Dual64::new(at.unknowns[number as usize], change.unknowns[number as usize]);
        let speeds = change.inputs.surface_speeds(&at.inputs);
        self.film_outflows(&at.unknowns, &at.inputs, None)
            .map(|(station, outflow)| {
                let (gap, pressure) =
                    (value(self.layout.gap[station]), value(self.layout.pressure[0][station * levels]));
                let along = outflow.by_gap * gap.eps
                    + outflow.by_pressure * pressure.eps
                    + outflow.by_speeds[0] * speeds[0]
                    + outflow.by_speeds[1] * speeds[1];
                let side = if station == 0 { -0.5 } else { 0.5 };
                pressure * (Dual64::new(outflow.value, along) - speed * gap * side)
            })
            .sum()
    }
}

impl System {
    /// Fluid that a column of the film takes from the tissue at those of its stations where it is closed, of both bodies \[m^2/s\]: only a column that is
    /// open elsewhere does, and the less the shorter it is.
    pub fn exchange_in_contact(&self, at: &State, column: usize) -> f64 {
        self.film_terms(column, at)
            .residual()
            .iter()
            .zip(&at.active[2 * column..])
            .filter(|(_, active)| **active)
            .map(|(flux, _)| flux)
            .sum()
    }
}
