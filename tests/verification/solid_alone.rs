//! The poroelastic layer alone, by manufactured solutions.
//!
//! A smooth displacement and pressure are chosen on a curved, moving layer; what the strong form of the balance laws makes of
//! them (section 2.2 of de Boer et al. 2020) is the source that is put in:
//!
//! paper:       f = -Div P_eff + alpha grad p,             m = Div(-k grad p) + alpha v . grad J
//! consistent:  f = -Div(P_eff - alpha p J F^-T),          m = Div(-J F^-1 k F^-T grad p) + alpha v . grad J
//!
//! with the divergences by central differences of the laws at the exact fields. The layer's own closed forms (uniaxial strain and
//! stress, shear) are unit tests of the law. Varied: mesh 4 x 2 to 32 x 16, formulation, order of the
//! pressure, permeability k constant or of Holmes and Mow, tissue uniform or with moduli and permeability that change with depth and
//! three times the permeability along the layers. Expected in L2:
//! order 3 of displacements and pressures where the pressure's shape functions are of order 2. Where they are of order 1 its error
//! is of order 2 in every norm, and loads the displacement: order 2 of both.

use std::f64::consts::PI;

use cartilage_contact::equations::tissue::Tissue;
use cartilage_contact::fem::element::{NODES, POINTS};
use cartilage_contact::fem::mesh::{LayerMesh, quadratic_stations};
use cartilage_contact::laws::darcy::HolmesMow;
use cartilage_contact::laws::depth::{DepthProfile, Factors};
use cartilage_contact::laws::kinematics::Strain;
use cartilage_contact::laws::solid::NeoHookean;
use nalgebra::{Matrix2, Vector2};

use crate::strip::{Condition, P, Strip, X, Y, orders};

const LENGTH: f64 = 4e-3;
const THICKNESS: f64 = 1e-3;
const SPEED: f64 = 0.01;

fn wave(x: [f64; 2]) -> (f64, f64) {
    (PI * x[0] / LENGTH, PI * x[1] / THICKNESS)
}

fn displacement(x: [f64; 2]) -> [f64; 2] {
    let (a, b) = wave(x);
    [6e-5 * (a + 0.3).sin() * (0.7 * b).cos(), 4e-5 * (a - 0.5).cos() * (0.8 * b + 0.4).sin()]
}

fn displacement_gradient(x: [f64; 2]) -> Matrix2<f64> {
    let (a, b) = wave(x);
    let (l, t) = (PI / LENGTH, PI / THICKNESS);
    Matrix2::new(
        6e-5 * l * (a + 0.3).cos() * (0.7 * b).cos(),
        -6e-5 * 0.7 * t * (a + 0.3).sin() * (0.7 * b).sin(),
        -4e-5 * l * (a - 0.5).sin() * (0.8 * b + 0.4).sin(),
        4e-5 * 0.8 * t * (a - 0.5).cos() * (0.8 * b + 0.4).cos(),
    )
}

fn pressure(x: [f64; 2]) -> f64 {
    let (a, b) = wave(x);
    5e4 * (1.2 * a + 0.2).cos() * (0.6 * b - 0.3).cos()
}

fn pressure_gradient(x: [f64; 2]) -> Vector2<f64> {
    let (a, b) = wave(x);
    Vector2::new(
        -5e4 * 1.2 * PI / LENGTH * (1.2 * a + 0.2).sin() * (0.6 * b - 0.3).cos(),
        -5e4 * 0.6 * PI / THICKNESS * (1.2 * a + 0.2).cos() * (0.6 * b - 0.3).sin(),
    )
}

/// Derivative along x and y of a function of place, of fourth order.
fn differentiate<T>(f: impl Fn([f64; 2]) -> T, x: [f64; 2]) -> [T; 2]
where
    T: std::ops::Sub<Output = T> + std::ops::Mul<f64, Output = T>,
{
    [0, 1].map(|k| {
        let step = 1e-6;
        let at = |s: f64| {
            let mut y = x;
            y[k] += s * step;
            f(y)
        };
        (at(1.0) - at(-1.0)) * (2.0 / 3.0 / step) - (at(2.0) - at(-2.0)) * (1.0 / 12.0 / step)
    })
}

/// A tight circle, so that the elements are truly curved.
const RADIUS: f64 = 5e-3;

/// Depth below the surface of the circle around (0, -R), as a fraction of the thickness.
fn depth(x: [f64; 2]) -> f64 {
    (RADIUS - x[0].hypot(x[1] + RADIUS)) / THICKNESS
}

/// Along the layers.
fn along(x: [f64; 2]) -> Vector2<f64> {
    Vector2::new(RADIUS + x[1], -x[0])
}

/// Body force \[N/m^3\] and source of fluid \[1/s\] that belong to the chosen fields; `velocity` is that of the moving tissue.
fn sources(tissue: &Tissue, x: [f64; 2], velocity: [f64; 2]) -> ([f64; 2], f64) {
    let alpha = tissue.biot_coefficient;
    let stress = |x| {
        let strain = Strain::new(displacement_gradient(x));
        let effective = tissue.at_depth(depth(x)).solid.stress(&strain);
        if tissue.consistent { effective - strain.cofactor * (alpha * pressure(x)) } else { effective }
    };
    let flux = |x| {
        let strain = Strain::new(displacement_gradient(x));
        let mobility = tissue.at_depth(depth(x)).mobility_at(&strain, &along(x)).0;
        -(mobility.conductance(&strain, tissue.consistent) * pressure_gradient(x))
    };
    let volume = |x| Strain::new(displacement_gradient(x)).volume_change;
    let [sx, sy] = differentiate(stress, x);
    let mut force = -(sx.column(0) + sy.column(1));
    if !tissue.consistent {
        force += pressure_gradient(x) * alpha;
    }
    let [qx, qy] = differentiate(flux, x);
    let [jx, jy] = differentiate(volume, x);
    ([force.x, force.y], qx.x + qy.y + alpha * SPEED * (velocity[0] * jx + velocity[1] * jy))
}

/// Errors in L2 of displacement and pressure, relative to the fields.
fn errors(
    refinement: usize,
    consistent: bool,
    order: i32,
    strain_dependence: Option<HolmesMow>,
    layered: bool,
) -> [f64; 2] {
    let stations = quadratic_stations(4 * refinement, |i| LENGTH * (i as f64 / (4 * refinement) as f64 - 0.5));
    let depths = quadratic_stations(2 * refinement, |j| THICKNESS * j as f64 / (2 * refinement) as f64);
    let mesh = LayerMesh::sector(&stations, &depths, RADIUS, -1.0, order);
    let tissue = Tissue {
        solid: NeoHookean { shear_modulus: 0.45e6, bulk_modulus: 0.5e6 }.into(),
        biot_coefficient: 0.9,
        mobility: 1e-12,
        tangential_ratio: if layered { 3.0 } else { 1.0 },
        // Linear over the whole depth, where the fields stay smooth.
        profile: layered.then_some(DepthProfile {
            surface: Factors {
                shear_modulus: 0.5,
                bulk_modulus: 2.0,
                permeability: 3.0,
                solid_volume_fraction: 0.5,
                fibre_modulus: 1.0,
            },
            deep: Factors::NONE,
            middle_zone: [1.0, 1.0],
        }),
        strain_dependence,
        fluid_compressibility: 0.0,
        consistent,
    };
    let (last, deepest) = (stations.len() - 1, depths.len() - 1);
    let mut strip = Strip::new(mesh, tissue, [1e-5, 1e4], |_, i, j| {
        if i == 0 || i == last || j == 0 || j == deepest { Condition::Fixed } else { Condition::Free }
    });
    strip.speed = SPEED;
    for (n, x) in strip.mesh.nodes.clone().into_iter().enumerate() {
        [strip.prescribed[X][n], strip.prescribed[Y][n]] = displacement(x);
        displacement(x).into_iter().enumerate().for_each(|(field, u)| strip.start_from(field, n, u));
        // Linear pressures have no unknown in the middle of the sides.
        let (i, j) = (n / (deepest + 1), n % (deepest + 1));
        strip.prescribed[P][n] = if order == 1 && (i % 2 == 1 || j % 2 == 1) { 0.0 } else { pressure(x) };
    }
    let place = |strip: &Strip, e: usize, q: usize| -> [f64; 2] {
        let nodes = strip.mesh.element_nodes(e);
        [0, 1].map(|k| (0..NODES).map(|a| strip.mesh.shape[q][a] * strip.mesh.nodes[nodes[a]][k]).sum())
    };
    for e in 0..strip.mesh.elements() {
        let nodes = strip.mesh.element_nodes(e);
        for q in 0..POINTS {
            let point = strip.mesh.points(e)[q];
            let (force, fluid) = sources(&tissue, place(&strip, e, q), point.velocity);
            for (a, n) in nodes.into_iter().enumerate() {
                let shape = strip.mesh.shape[q][a] * point.weight;
                strip.sources[X][n] += shape * force[0];
                strip.sources[Y][n] += shape * force[1];
                strip.sources[P][n] += strip.mesh.pressure_shape[q][a] * point.weight * fluid;
            }
        }
    }
    strip.solve();
    let (mut error, mut size) = ([0.0; 2], [0.0; 2]);
    for e in 0..strip.mesh.elements() {
        let at = strip.solution(e);
        for q in 0..POINTS {
            let x = place(&strip, e, q);
            let sum =
                |shape: &[f64; NODES], f: usize| -> f64 { (0..NODES).map(|a| shape[a] * at[f * NODES + a]).sum() };
            let weight = strip.mesh.points(e)[q].weight;
            let exact = displacement(x);
            for (k, exact) in exact.into_iter().enumerate() {
                error[0] += weight * (sum(&strip.mesh.shape[q], k) - exact).powi(2);
                size[0] += weight * exact.powi(2);
            }
            error[1] += weight * (sum(&strip.mesh.pressure_shape[q], P) - pressure(x)).powi(2);
            size[1] += weight * pressure(x).powi(2);
        }
    }
    [(error[0] / size[0]).sqrt(), (error[1] / size[1]).sqrt()]
}

#[test]
fn manufactured_solutions_converge_with_the_expected_order() {
    let law = Some(HolmesMow { solid_volume_fraction: 0.2, exponent: 2.0, strain_coefficient: 2.2 });
    for (consistent, order, law, layered) in [
        (false, 2, None, false),
        (true, 2, None, false),
        (false, 1, None, false),
        (true, 1, None, false),
        (false, 2, law, false),
        (true, 2, law, false),
        (true, 1, law, false),
        (false, 2, law, true),
        (true, 2, law, true),
        (true, 1, None, true),
    ] {
        let all = [2, 4, 8].map(|refinement| errors(refinement, consistent, order, law, layered));
        let displacement = orders(&all.map(|e| e[0]));
        let pressure = orders(&all.map(|e| e[1]));
        println!(
            "consistent {consistent}, pressure order {order}, {law:?}, layered {layered}: {all:?}, orders {displacement:?} {pressure:?}"
        );
        assert!(displacement[1] > f64::from(order) + 0.8, "displacement: orders {displacement:?} of {all:?}");
        assert!(pressure[1] > f64::from(order) + 0.8, "pressure: orders {pressure:?} of {all:?}");
        assert!(all[2][0] < if order == 2 { 1e-4 } else { 1e-3 });
    }
}
