//! The flow between rough surfaces, where the film has the thickness, the flow factor phi and the storage of [`Roughness`].
//!
//! Pressure and its test function are straight lines from node to node, and Q is one number on the segment between two nodes, from
//! Reynolds' equation integrated over its length l:
//!
//! Q = U h_c/2 - (p_2 - p_1) / (12 int c dx),   h_c = int c h dx / int c dx,   c = eta/(phi h^3)
//!
//! The lubricant is sheared at the mean rate (U_1 - U_2) <1/h>, and a viscosity that depends on the rate is that of the mean gradient
//! of pressure.
//!
//! Where the film is so thin that pressure cannot follow the surfaces from node to node, h_c moves upstream, by Pe/(1 + Pe) of the way
//! to the node there, with the segment's Peclet number Pe = 6 eta |U| l^2/(2 pi G h_c^3): the surfaces' answer to a ripple of pressure of
//! that length against the flow it drives. It vanishes with l^2, so that the scheme is of second order where the film is resolved.
//!
//! What pressure drives drags either wall along with the force h_c/2 (p_1 - p_2), and dissipates the power (p_2 - p_1)^2 / (12 int c dx).

use super::{DISSIPATION, DRAG, Element, Film, Gradient, Local, MassRate, SIDEWAYS, Stretch, Terms, sum};
use crate::fem::element::{GAUSS, GAUSS_WEIGHTS, SIMPSON, quadratic};
use crate::laws::fluid::relative_density;
use crate::laws::roughness::Roughness;

/// What the flow on a segment depends on, behind the gaps of the three nodes: the difference of pressure, the stretch of the film, and sum and
/// difference of the surfaces' speeds.
const PRESSURE_DIFFERENCE: usize = 3;
const STRETCH: usize = 4;
const SPEED_SUM: usize = 5;
const SPEED_DIFFERENCE: usize = 6;

/// Derivatives with respect to these.
type Slopes = [f64; 7];

/// A number with its derivatives.
#[derive(Default)]
struct Differentiated {
    value: f64,
    by: Slopes,
}

/// Thickness of the fluid along an element. Its logarithm is quadratic: at the edge of a contact it grows tenfold within a column, and a
/// parabola through such values would close the film.
struct Profile {
    /// At the nodes, with its derivatives with respect to the gaps.
    nodes: [(f64, f64); 3],
    logarithms: [f64; 3],
}

impl Profile {
    fn new(rough: &Roughness, at: &Local) -> Self {
        let nodes: [(f64, f64); 3] = std::array::from_fn(|b| rough.thickness(at[b]));
        Self { nodes, logarithms: nodes.map(|(thickness, _)| thickness.ln()) }
    }

    /// At a place in the element -1..=1, with its derivatives with respect to the three gaps.
    fn thickness(&self, place: f64) -> (f64, [f64; 3]) {
        let shape = quadratic(place);
        let h = sum(&shape, &self.logarithms).exp();
        (h, std::array::from_fn(|b| h * shape[b] * self.nodes[b].1 / self.nodes[b].0))
    }
}

/// The part of an element between two neighbouring nodes with a pressure of their own.
struct Segment {
    /// These nodes.
    from: usize,
    to: usize,
    /// Its length over the element's.
    fraction: f64,
    /// In its middle.
    stretch: Stretch,
    /// Along the deformed film \[m\].
    length: f64,
    /// p_2 - p_1 \[Pa\].
    pressure_difference: f64,
    /// Speeds of the surfaces with respect to the mesh, were they not stretched \[m/s\].
    unstretched: [f64; 2],
    /// Sum of the speeds of the surfaces with respect to the mesh \[m/s\].
    sliding_speed: f64,
    /// Difference of the speeds \[m/s\].
    speed_difference: f64,
}

impl Segment {
    fn new([from, to]: [usize; 2], element: &Element, at: &Local, speeds: [f64; 2], mass_rate: &MassRate) -> Self {
        let fraction = 0.5 * (to - from) as f64;
        let middle = from as f64 - 1.0 + fraction;
        let stretch = element.stretch(middle, at);
        let unstretched = mass_rate.relative(speeds, middle);
        Self {
            from,
            to,
            fraction,
            length: fraction * element.length * stretch.film,
            pressure_difference: at[3 + to] - at[3 + from],
            unstretched,
            sliding_speed: unstretched[0] * stretch.surfaces[0] + unstretched[1] * stretch.surfaces[1],
            speed_difference: speeds[0] - speeds[1],
            stretch,
        }
    }

    /// The place in the element of one in the segment, both -1..=1.
    fn place(&self, s: f64) -> f64 {
        self.from as f64 - 1.0 + self.fraction * (1.0 + s)
    }

    /// Means of the shape functions of the three nodes.
    fn shape_means(&self) -> [f64; 3] {
        match [self.from, self.to] {
            [0, 1] => [5.0 / 12.0, 8.0 / 12.0, -1.0 / 12.0],
            [1, 2] => [-1.0 / 12.0, 8.0 / 12.0, 5.0 / 12.0],
            _ => SIMPSON,
        }
    }

    /// Derivatives with respect to the values of the element and to the speeds.
    fn gradient(&self, by: &Slopes) -> Gradient {
        let Self { from, to, stretch, .. } = self;
        let mut gradient = Gradient::default();
        gradient.values[..3].copy_from_slice(&by[..3]);
        (gradient.values[3 + from], gradient.values[3 + to]) = (-by[PRESSURE_DIFFERENCE], by[PRESSURE_DIFFERENCE]);
        let sideways = stretch.by_sideways(by[STRETCH], self.unstretched.map(|u| by[SPEED_SUM] * u));
        gradient.values[SIDEWAYS..].copy_from_slice(&sideways);
        gradient.speeds = [
            by[SPEED_SUM] * stretch.surfaces[0] + by[SPEED_DIFFERENCE],
            by[SPEED_SUM] * stretch.surfaces[1] - by[SPEED_DIFFERENCE],
        ];
        gradient
    }
}

/// Means over a segment.
#[derive(Default)]
struct Means {
    c: Differentiated,
    /// Of c h.
    ch: Differentiated,
    viscosity: Differentiated,
}

impl Means {
    fn new(film: &Film, rough: &Roughness, profile: &Profile, segment: &Segment) -> Self {
        let Segment { pressure_difference, speed_difference, length, .. } = *segment;
        let gradient = pressure_difference / length;
        let mut means = Self::default();
        for (s, w) in GAUSS.into_iter().zip(GAUSS_WEIGHTS) {
            let (h, by_gaps) = profile.thickness(segment.place(s));
            let (phi, phi_slope) = rough.flow_factor(h);
            let (inverse, inverse_slope) = rough.inverse_thickness(h);
            let fluid = film.fluid.sheared(speed_difference * inverse, 0.5 * h * gradient);
            let viscosity_by_h = fluid.viscosity_by_rate * speed_difference * inverse_slope
                + fluid.viscosity_by_difference * 0.5 * gradient;
            let viscosity_by_differences =
                [fluid.viscosity_by_difference * 0.5 * h / length, fluid.viscosity_by_rate * inverse];
            let add = |mean: &mut Differentiated, value: f64, by_h: f64, by_viscosity: f64| {
                mean.value += value;
                for (by, by_gap) in mean.by.iter_mut().zip(by_gaps) {
                    *by += by_h * by_gap;
                }
                for (k, viscosity_by) in
                    [PRESSURE_DIFFERENCE, SPEED_DIFFERENCE].into_iter().zip(viscosity_by_differences)
                {
                    mean.by[k] += by_viscosity * viscosity_by;
                }
            };
            let weight = 0.5 * w;
            let factor = weight / (phi * h.powi(3));
            let c = factor * fluid.viscosity;
            let c_slope = factor * viscosity_by_h - c * (3.0 / h + phi_slope / phi);
            add(&mut means.c, c, c_slope, factor);
            add(&mut means.ch, c * h, c_slope * h + c, factor * h);
            add(&mut means.viscosity, weight * fluid.viscosity, weight * viscosity_by_h, weight);
        }
        for mean in [&mut means.c, &mut means.ch, &mut means.viscosity] {
            // The gradient falls as the segment grows.
            mean.by[STRETCH] = -pressure_difference / segment.stretch.film * mean.by[PRESSURE_DIFFERENCE];
        }
        means
    }

    /// The thickness that the walls carry along, h_c moved upstream \[m\].
    fn carried(&self, profile: &Profile, shear_modulus: f64, segment: &Segment) -> Differentiated {
        let Self { c, ch, viscosity } = self;
        let Segment { sliding_speed, .. } = *segment;
        let mean = ch.value / c.value;
        let up = if sliding_speed < 0.0 { segment.to } else { segment.from };
        let (upstream, upstream_slope) = profile.nodes[up];
        let stiffness = 2.0 * std::f64::consts::PI * shear_modulus;
        let peclet_per_speed = 6.0 * viscosity.value * segment.length.powi(2) / (stiffness * mean.powi(3));
        let peclet = peclet_per_speed * sliding_speed.abs();
        let moved = peclet / (1.0 + peclet);
        let by = std::array::from_fn(|k| {
            let by_mean = (ch.by[k] - mean * c.by[k]) / c.value;
            let mut by_peclet = peclet * (viscosity.by[k] / viscosity.value - 3.0 * by_mean / mean);
            match k {
                STRETCH => by_peclet += 2.0 * peclet / segment.stretch.film,
                SPEED_SUM => by_peclet += peclet_per_speed * sliding_speed.signum(),
                _ => {}
            }
            let by_upstream = if k == up { moved * upstream_slope } else { 0.0 };
            by_mean * (1.0 - moved) + by_upstream + (upstream - mean) * by_peclet / (1.0 + peclet).powi(2)
        });
        Differentiated { value: mean + moved * (upstream - mean), by }
    }

    /// What a difference of pressure drives, over that difference \[m^3/(Pa s) / m\].
    fn conductance(&self, segment: &Segment) -> Differentiated {
        let value = 1.0 / (12.0 * self.c.value * segment.length);
        let by = std::array::from_fn(|k| {
            let by_length = if k == STRETCH { 1.0 / segment.stretch.film } else { 0.0 };
            -value * (self.c.by[k] / self.c.value + by_length)
        });
        Differentiated { value, by }
    }
}

impl Film {
    /// Adds the flow between rough surfaces over tissue of a shear modulus.
    pub(super) fn add_rough_flow(
        &self,
        (rough, shear_modulus): &(Roughness, f64),
        element: &Element,
        at: &Local,
        speeds: [f64; 2],
        mass_rate: &MassRate,
        terms: &mut Terms,
    ) {
        let chi = self.fluid_compressibility;
        let profile = Profile::new(rough, at);
        for nodes in self.segments() {
            let segment = Segment::new(*nodes, element, at, speeds, mass_rate);
            let Segment { from, to, pressure_difference, sliding_speed, .. } = segment;
            let means = Means::new(self, rough, &profile, &segment);
            let (carried, conductance) =
                (means.carried(&profile, *shear_modulus, &segment), means.conductance(&segment));
            // Of what goes with the two, and with the difference of pressure and the sum of speeds itself.
            let spread = |by_carried: f64, by_conductance: f64, by_pressure_difference: f64, by_speed_sum: f64| {
                let mut by: Slopes =
                    std::array::from_fn(|k| by_carried * carried.by[k] + by_conductance * conductance.by[k]);
                by[PRESSURE_DIFFERENCE] += by_pressure_difference;
                by[SPEED_SUM] += by_speed_sum;
                segment.gradient(&by)
            };
            let density = relative_density(chi, 0.5 * (at[3 + to] + at[3 + from]));
            let flux = 0.5 * sliding_speed * carried.value - conductance.value * pressure_difference;
            let mut by = spread(0.5 * sliding_speed, -pressure_difference, -conductance.value, 0.5 * carried.value);
            for node in [from, to] {
                by.values[3 + node] += 0.5 * chi * flux;
            }
            terms.add(from, density, flux, &by);
            terms.add(to, -density, flux, &by);
            let drag = 0.5 * carried.value * pressure_difference;
            let by = spread(0.5 * pressure_difference, 0.0, 0.5 * carried.value, 0.0);
            for (row, shape) in DRAG.zip(segment.shape_means()) {
                terms.add(row, shape, drag, &by);
            }
            let power = conductance.value * pressure_difference * pressure_difference;
            let by = spread(
                0.0,
                pressure_difference * pressure_difference,
                2.0 * conductance.value * pressure_difference,
                0.0,
            );
            terms.add(DISSIPATION, 1.0, power, &by);
        }
    }
}
