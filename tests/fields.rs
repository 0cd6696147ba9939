//! Fields against the outputs of the same state, and against the balance of fluid.

#![allow(clippy::unwrap_used)]

use approx::assert_relative_eq;
use cartilage_contact::fields::Fields;
use cartilage_contact::parameters::{Inputs, Parameters, Preset};
use cartilage_contact::simulation::Simulation;

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
        assert_relative_eq!(largest(&interface.fluid_pressure), outputs.maximum_fluid_pressure, max_relative = 0.02);
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
    // In contact and out of it; equal bodies and unequal ones; a cavitated film.
    for (depth, thickness, cavitation) in
        [(5e-6, 1e-3, false), (5e-6, 1.3e-3, false), (20e-6, 1e-3, false), (5e-6, 1.3e-3, true)]
    {
        let (simulation, fields) = solved(depth, |p| {
            p.upper.thickness = thickness;
            (p.cavitation, p.cavitation_pressure) = (cavitation, -1e3);
        });
        assert_eq!(simulation.outputs().cavitated_length > 0.0, cavitation);
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

/// The pressure of rough surfaces over the interface is what the solids carry: over x before deformation, which differs by the
/// tissue's stretch along the surface, below 2 % at 50 micron.
#[test]
fn rough_surfaces_have_their_pressure() {
    let parameters = Parameters { surface_roughness: 2e-6, ..Preset::HumanNormal.parameters() };
    let mut simulation = Simulation::new(&parameters).unwrap();
    simulation.solve_steady(Inputs { penetration_depth: 50e-6, sliding_speed: 0.1, ..Inputs::NONE }).unwrap();
    let interface = simulation.fields().unwrap().interface;
    let (x, p) = (&interface.position, &interface.contact_pressure);
    let simpson = |i: usize| (x[i + 2] - x[i]) / 6.0 * (p[i] + 4.0 * p[i + 1] + p[i + 2]);
    let carried: f64 = (0..x.len() - 2).step_by(2).map(simpson).sum();
    let load = simulation.outputs().solid_load;
    assert!(load > 1.0 && (carried / load - 1.0).abs() < 0.02, "{carried} {load}");
}

/// What the outflows of both bodies add up to is Reynolds' flux with the flow factor of N. Patir and H. S. Cheng (1978), by differences of the
/// fields, where the film is about as thick as the surfaces are rough. Without the factor what pressure drives would be half as much again.
#[test]
fn film_flux_between_rough_surfaces_has_the_flow_factor() {
    const ROUGHNESS: f64 = 2e-6;
    for order in [1, 2] {
        let (simulation, fields) = solved(0.0, |p| {
            (p.surface_roughness, p.pressure_order, p.mesh.columns) = (ROUGHNESS, order, 120);
        });
        let f = &fields.interface;
        let speed: f64 = fields.inputs.surface_speeds().iter().sum();
        let (mut stations, mut largest, mut off) = (0, 0.0_f64, 0.0_f64);
        for i in (1..f.position.len() - 1).step_by(2) {
            let [pressure, length] = [&f.fluid_pressure, &f.position].map(|values| values[i + 1] - values[i - 1]);
            let h = f.film_thickness[i];
            let flow_factor = 1.0 - 0.9 * (-0.56 * h / ROUGHNESS).exp();
            if flow_factor < 0.8 {
                let driven = -flow_factor * h.powi(3) / (12.0 * simulation.parameters().viscosity) * pressure / length;
                stations += 1;
                largest = largest.max(driven.abs());
                off = off.max((0.5 * speed * h + driven - f.film_flux[i]).abs());
            }
        }
        assert!(stations > 10 && off < 0.05 * largest, "order {order}: {off:e} of {largest:e} at {stations} stations");
    }
}
