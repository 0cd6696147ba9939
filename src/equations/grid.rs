//! Where the nodes are: the extent of the sector, columns along the surface, rows through the thickness.
//!
//! A mesh by the gradings that were set stays where it is. One made for the contact goes with it: its columns gather at the edges of the
//! contact, where film and tissue change within some hundredths of its half-width, and its sector ends where nothing deforms any more.

use crate::fem::mesh::{graded, quadratic_stations};
use crate::parameters::{Body, Control, Inputs, MeshDistribution, Parameters};
use crate::solver::root;

/// The nodes of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// x of the interface nodes \[m\].
    pub stations: Vec<f64>,
    /// x of the surface nodes of the undeformed upper and lower body \[m\].
    pub surfaces: [Vec<f64>; 2],
    /// Depths of the levels below the surface over the thickness, of the upper and the lower body.
    pub depths: [Vec<f64>; 2],
    /// Places of the interface nodes along the arc of the film \[m\].
    pub arc: Vec<f64>,
    /// Cosine of the angle of that arc with the x axis, at the interface nodes.
    pub cosine: Vec<f64>,
    /// Distance of these nodes at first touch, across the arc \[m\].
    pub touching_gap: Vec<f64>,
}

/// Whether the nodes go with the contact.
pub fn moves(parameters: &Parameters) -> bool {
    parameters.sector_half_angle == 0.0 || parameters.mesh_distribution == MeshDistribution::Contact
}

/// Sum of the two curvatures \[1/m\].
fn curvature(parameters: &Parameters) -> f64 {
    parameters.upper.curvature() + parameters.lower.curvature()
}

/// Curvature of the arc along which the film lies \[1/m\]: halfway between the undeformed surfaces, or on the rigid counterface.
pub fn film_curvature(parameters: &Parameters) -> f64 {
    let [upper, lower] = [parameters.upper.curvature(), -parameters.lower.curvature()];
    if parameters.rigid_lower { lower } else { 0.5 * (upper + lower) }
}

/// Distance of the undeformed surfaces at first touch, along y \[m\].
fn touching_gap(parameters: &Parameters, x: f64) -> f64 {
    height(&parameters.upper, x) + height(&parameters.lower, x)
}

/// Distance of a body's surface from its tangent at first touch, along y \[m\].
fn height(body: &Body, x: f64) -> f64 {
    let sine = x * body.curvature();
    x * sine / (1.0 + (1.0 - sine * sine).sqrt())
}

/// The length by which shifts are multiplied \[m\]: they go as the indentation does, with the square of the contact's half-width, over the
/// curvature.
pub fn shift_scale(parameters: &Parameters, contact: f64) -> f64 {
    if moves(parameters) { contact.powi(2) * curvature(parameters).abs() } else { half_width(parameters, contact) }
}

/// c a^2 of the parabola that has the gap of the two circles at x = a \[m\]: what parabolas of curvature c carry, circles do about as well.
/// Where the surfaces between which the layers are pressed are steep, an approach d closes only d cos of what it does in the middle.
/// Beyond the end of a circle it goes on growing.
fn curved(parameters: &Parameters, a: f64) -> f64 {
    let inside = a.min(LARGEST_ANGLE.sin() * radius(parameters));
    let flat = 2.0 * touching_gap(parameters, inside) * (a / inside).powi(2);
    let sine = 0.5 * (parameters.upper.curvature() - parameters.lower.curvature()) * inside;
    flat / (1.0 - 2.0 * (1.0 - (1.0 - sine * sine).sqrt()) * relative_indentation(parameters, a))
}

/// d/(c a^2), with the depth d at which the half-width is a and the sum of curvatures c, of the table for Poisson's ratio 1/2 at a/t = 1, 2,
/// 4, within 2 %; 1/6 is the limit of a thin layer.
fn relative_indentation(parameters: &Parameters, a: f64) -> f64 {
    1.0 / 6.0 + 0.27 * (thickness(parameters) / a).powf(0.74)
}

/// Of the more curved of the two surfaces \[m\].
fn radius(parameters: &Parameters) -> f64 {
    1.0 / parameters.upper.curvature().abs().max(parameters.lower.curvature().abs())
}

/// The depth at which the contact's half-width is a \[m\]. Surfaces that are steep there are pressed across, and their gap is less so.
fn indentation(parameters: &Parameters, a: f64) -> f64 {
    let sine = (film_curvature(parameters) * a).abs().min(LARGEST_ANGLE.sin());
    curved(parameters, a) * (1.0 - sine * sine).sqrt() * relative_indentation(parameters, a)
}

/// About what a contact in motion is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// How deep the bones are pressed together \[m\].
    pub depth: f64,
    /// Half the width over which they are pressed \[m\].
    pub half_width: f64,
    /// What that carries, per unit of width \[N/m\].
    pub load: f64,
}

impl Expected {
    /// At the depth or under the load of these inputs; of bones apart, what there is at first touch.
    pub fn new(parameters: &Parameters, inputs: &Inputs, control: Control) -> Self {
        let half_width = match control {
            Control::Depth => root(|a| indentation(parameters, a), inputs.penetration_depth),
            Control::Load => root(|a| carried(parameters, a), inputs.applied_load.max(0.0)),
        };
        Self { depth: indentation(parameters, half_width), half_width, load: carried(parameters, half_width) }
    }
}

/// Load \[N/m\] that is carried at a half-width a: W R/(G a^2) of the same table within a tenth up to a/t = 2, and as computed at finite
/// strain up to a/t = 6.
fn carried(parameters: &Parameters, a: f64) -> f64 {
    let lower = if parameters.rigid_lower { 0.0 } else { 1.0 / parameters.lower.mean_shear_modulus() };
    let modulus = 2.0 / (1.0 / parameters.upper.mean_shear_modulus() + lower);
    let ratio = a / thickness(parameters);
    0.5 * curved(parameters, a) * modulus * (4.68 * ratio.powf(0.8) + 0.714 * ratio.powf(2.5))
}

/// Mean thickness of the layers \[m\].
fn thickness(parameters: &Parameters) -> f64 {
    let upper = parameters.upper.thickness;
    if parameters.rigid_lower { upper } else { 0.5 * (upper + parameters.lower.thickness) }
}

/// Part of the approach that a layer takes: half, or all against a rigid counterface.
pub fn part(parameters: &Parameters) -> f64 {
    if parameters.rigid_lower { 1.0 } else { 0.5 }
}

/// Half the width, in the undeformed layers, of the contact that these inputs are expected to make, by their depth or by their load \[m\]; where the bones are apart, the
/// width over which the film builds up pressure. 0 where the mesh stays.
///
/// By the theory of thin bonded layers (Meijers 1968; Jaffar 1989) for undrained tissue, with the spreading of tissue that is pressed
/// flat. It says where columns are dense: that need not be exact.
pub fn contact_half_width(parameters: &Parameters, inputs: &Inputs, control: Control) -> f64 {
    if !moves(parameters) {
        return 0.0;
    }
    let curvature = curvature(parameters);
    // While bones are nearer than this to first touch, a film of some micron sets the width.
    const FILM: f64 = 1e-5;
    let (pressed, apart) = match control {
        Control::Depth => {
            let depth = inputs.penetration_depth;
            let smooth = depth.hypot(FILM);
            (root(|a| indentation(parameters, a), 0.5 * (smooth + depth)), (smooth - depth) / curvature)
        }
        Control::Load => (Expected::new(parameters, inputs, control).half_width, FILM / curvature),
    };
    /// Of the edges of the contact in undeformed layers, where the film's pressure begins: computed at finite strain, 10 to 50 % compression.
    const SPREADING: f64 = 0.57;
    let flattened = part(parameters) * indentation(parameters, pressed) / thickness(parameters);
    (pressed / (1.0 + SPREADING * flattened)).hypot(apart.sqrt())
}

/// Where an increasing function of a length, 0 at 0, has this value \[m\].
fn root(f: impl Fn(f64) -> f64, value: f64) -> f64 {
    let (mut low, mut high) = (1e-9_f64, 1.0_f64);
    for _ in 0..60 {
        let middle = (low * high).sqrt();
        if f(middle) < value { low = middle } else { high = middle }
    }
    low
}

/// Half the width of the interface for a contact of this half-width \[m\].
pub fn half_width(parameters: &Parameters, contact: f64) -> f64 {
    /// Beyond the contact, in its half-widths and in thicknesses.
    const BEYOND: [f64; 2] = [1.0, 6.0];
    let radius = radius(parameters);
    if parameters.sector_half_angle > 0.0 {
        return radius * parameters.sector_half_angle.sin();
    }
    let thickness = match parameters.rigid_lower {
        true => parameters.upper.thickness,
        false => parameters.upper.thickness.max(parameters.lower.thickness),
    };
    (contact * (1.0 + BEYOND[0]) + BEYOND[1] * thickness).min(LARGEST_ANGLE.sin() * radius)
}

/// Half the angle of the widest sector \[rad\].
pub const LARGEST_ANGLE: f64 = 1.05;

/// Ends of `columns` elements between -half_width and half_width, dense at the edges of the contact.
fn column_ends(columns: usize, half_width: f64, contact: f64) -> Vec<f64> {
    /// Fraction of the columns at the two edges, and the width of these clusters over the contact's half-width; fraction of those spread
    /// over the contact and around it. The rest is uniform.
    const EDGES: (f64, f64) = (0.4, 0.03);
    const CONTACT: (f64, f64) = (0.5, 2.0);
    // A step of this width at a place, and its slope.
    let step = |x: f64, width: f64| {
        let x = x / width;
        (x.atan(), 1.0 / (width * (1.0 + x * x)))
    };
    let edge = |x: f64| {
        let [(left, left_slope), (right, right_slope)] = [x + contact, x - contact].map(|x| step(x, EDGES.1 * contact));
        (left + right, left_slope + right_slope)
    };
    let around = |x: f64| step(x, CONTACT.1 * contact);
    let [at_edges, at_contact] = [EDGES.0 / edge(half_width).0, CONTACT.0 / around(half_width).0];
    let uniform = (1.0 - EDGES.0 - CONTACT.0) / half_width;
    let fraction = |x: f64| {
        let [(edge, edge_slope), (around, around_slope)] = [edge(x), around(x)];
        let value = at_edges * edge + at_contact * around + uniform * x;
        (value, at_edges * edge_slope + at_contact * around_slope + uniform)
    };
    // Symmetric to the last bit.
    let mut end = -half_width;
    let right: Vec<f64> = (0..=columns / 2)
        .map(|i| {
            let wanted = 2.0 * i as f64 / columns as f64 - 1.0;
            if i > 0 && 2 * i < columns {
                end = root::increasing([end, 0.0], end, |x| {
                    let (value, slope) = fraction(x);
                    (value - wanted, slope)
                });
            }
            if 2 * i == columns { 0.0 } else { -end }
        })
        .collect();
    (0..=columns).map(|i| if 2 * i <= columns { -right[i] } else { right[columns - i] }).collect()
}

/// Thickness of the layer below the surface within which fluid flows while the tissue passes the contact, sqrt(k M l/v), over that of
/// the whole layer; l = three thicknesses, v = 0.1 m/s.
fn surface_layer(parameters: &Parameters, body: &Body) -> f64 {
    let permeability = parameters.hydraulic_permeability(body) * body.surface.permeability;
    let consolidation = permeability * body.surface_aggregate_modulus();
    (consolidation * 3.0 / (0.1 * body.thickness)).sqrt()
}

/// Grading of the rows so that the first one is a third of the surface layer.
fn row_grading(parameters: &Parameters, body: &Body, rows: i32) -> f64 {
    let wanted = (surface_layer(parameters, body) / 3.0).max(5e-4);
    let (mut low, mut high) = (1.0, 9.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if graded(1.0 / f64::from(rows), middle) > wanted { low = middle } else { high = middle }
    }
    low
}

impl Grid {
    /// The nodes for a contact of this half-width, see [`contact_half_width`], and with the surface nodes of the upper body shifted along x
    /// against those of the lower one: by these multiples of [`shift_scale`] at the ends of the columns, or not.
    pub fn new(parameters: &Parameters, contact: f64, shifts: &[f64]) -> Self {
        let p = parameters;
        let half_width = half_width(p, contact);
        let [columns, rows] = p.elements();
        let by_contact = p.mesh_distribution == MeshDistribution::Contact;
        let count = columns as usize;
        let stations = if by_contact {
            let ends = column_ends(count, half_width, contact.min(0.9 * half_width));
            quadratic_stations(count, |i| ends[i])
        } else {
            let fraction = |i: usize| 2.0 * i as f64 / f64::from(columns) - 1.0;
            quadratic_stations(count, |i| half_width * graded(fraction(i), p.mesh.column_grading))
        };
        let depths = [&p.upper, &p.lower].map(|body| {
            let grading = if by_contact { row_grading(p, body, rows) } else { p.mesh.row_grading };
            quadratic_stations(rows as usize, |j| graded(j as f64 / f64::from(rows), grading))
        });
        let curvature = film_curvature(p);
        let cosine = |x: f64| (1.0 - (x * curvature).powi(2)).sqrt();
        let scale = shift_scale(p, contact);
        let surfaces = [0.5, -0.5].map(|side| {
            let shift = |i: usize| shifts.get(i).map_or(0.0, |shift| side * scale * shift);
            quadratic_stations(count, |i| stations[2 * i] + shift(i))
        });
        let distance = |i: usize| height(&p.upper, surfaces[0][i]) + height(&p.lower, surfaces[1][i]);
        Self {
            arc: stations
                .iter()
                .map(|x| if curvature == 0.0 { *x } else { (x * curvature).asin() / curvature })
                .collect(),
            cosine: stations.iter().map(|x| cosine(*x)).collect(),
            touching_gap: stations.iter().enumerate().map(|(i, x)| distance(i) * cosine(*x)).collect(),
            stations,
            surfaces,
            depths,
        }
    }
}
