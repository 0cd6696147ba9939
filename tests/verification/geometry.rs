//! Shapes of the bodies: concave and flat ones, and a rigid counterface.
//!
//! - Bodies whose curvatures k have the same sum have the same gap to first order. They differ by the next order of the gap,
//!   (k1^3 + k2^3) x^4/8, and of the layers' width, which to second order in angles go with (k1 - k2)^2.
//! - A shaft in a bearing of 60 degrees to either side (Sommerfeld; Cameron): h = c - e cos(angle), p' = 6 eta U (h - h*)/h^3 along the arc with
//!   h* = int h^-2 / int h^-3, wall shear h p'/2 + eta (U1 - U2)/h, and the moment of the shear about the shaft's axis.
//! - A rigid, impermeable counterface is the limit of a second layer that is stiff and tight.
//! - Against a flat counterface without motion a layer is drained, and carries at a depth what a pair of such layers does at twice that.

use approx::assert_relative_eq;
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Body, Formulation, Inputs, Mesh, Parameters};
use cartilage_contact::simulation::Simulation;

fn case() -> Parameters {
    Parameters {
        formulation: Formulation::Consistent,
        tolerance: 1e-9,
        mesh: Mesh { columns: 60, rows: 5, column_grading: 2.5, row_grading: 2.5 },
        ..Parameters::default()
    }
}

fn at(parameters: &Parameters, depths: &[f64], sliding_speed: f64, slide_to_roll_ratio: f64) -> Outputs {
    let mut simulation = Simulation::new(parameters).unwrap();
    for depth in depths {
        let inputs = Inputs { penetration_depth: depth * 1e-6, sliding_speed, slide_to_roll_ratio, ..Inputs::NONE };
        simulation.solve_steady(inputs).unwrap();
    }
    simulation.outputs().clone()
}

/// Layers of 1 mm with a sum of curvatures of 20 1/m, in a full film over 3.2 mm to both sides: equal ones, a flat one, and concave ones up
/// to 0.69 rad at the end. What they differ by grows as the square of the difference of the curvatures, for small angles exactly so.
#[test]
fn equal_gaps_carry_alike_at_small_angles_and_part_at_large_ones() {
    let half_width = 3.2e-3_f64;
    let loads = [10.0, 20.0, 30.0, 100.0, 200.0].map(|upper: f64| {
        let base = case();
        let of = |curvature: f64| if curvature == 0.0 { 0.0 } else { 1.0 / curvature };
        let [upper, lower] = [upper, 20.0 - upper].map(|k| Body { outer_radius: of(k), ..base.upper });
        let smaller = upper.curvature().abs().max(lower.curvature().abs());
        let sector_half_angle = (half_width * smaller).asin();
        let parameters = Parameters { upper, lower, sector_half_angle, ..base };
        let o = at(&parameters, &[0.0, 8.0], 0.2, 0.0);
        assert!(o.solid_load == 0.0);
        o.load
    });
    // Over the square of the difference of curvatures.
    let apart = [20.0_f64, 40.0, 180.0, 380.0].map(|difference| difference.powi(2));
    let apart: Vec<f64> = loads[1..].iter().zip(apart).map(|(load, square)| (load / loads[0] - 1.0) / square).collect();
    println!("{loads:?} N/m, {apart:?} m2");
    assert!((loads[1] / loads[0] - 1.0).abs() < 2e-3 && (loads[4] / loads[0] - 1.0).abs() > 0.02);
    assert_relative_eq!(apart[0], apart[1], max_relative = 0.05);
    assert_relative_eq!(apart[0], apart[2], max_relative = 0.3);
}

/// Stiff bodies with a clearance of 25 micron and a film of 5 micron in the middle.
#[test]
fn a_film_lies_along_the_arc_of_a_bearing() {
    let (radius, clearance, least) = (0.025, 25e-6, 5e-6);
    let base = Parameters { formulation: Formulation::Paper, ..case() };
    let stiff = Body { shear_modulus: 1e10, bulk_modulus: 1e10, permeability: 1e-17, thickness: 1e-3, ..base.upper };
    let end = 1.04_f64;
    let mesh = Mesh { columns: 60, column_grading: 0.0, ..base.mesh };
    let (upper, lower) = (Body { outer_radius: radius, ..stiff }, Body { outer_radius: -radius - clearance, ..stiff });
    let parameters = Parameters { upper, lower, sector_half_angle: end, shear_film_offset: 1e-9, mesh, ..base };
    let (speed, ratio) = (0.1, 0.8);
    let o = at(&parameters, &[-1e6 * least], speed, ratio);

    // The arc halfway between the surfaces, by the midpoint rule.
    let (eta, middle) = (parameters.viscosity, radius + 0.5 * clearance);
    let last = (radius * end.sin() / middle).asin();
    const COUNT: usize = 20_000;
    let step = 2.0 * last / COUNT as f64;
    let thickness: Vec<f64> =
        (0..COUNT).map(|i| clearance - (clearance - least) * ((i as f64 + 0.5) * step - last).cos()).collect();
    let integral = |f: &dyn Fn(f64) -> f64| thickness.iter().map(|h| f(*h) * middle * step).sum::<f64>();
    let carried = integral(&|h| h.powi(-2)) / integral(&|h| h.powi(-3));
    let slope = |h: f64| 6.0 * eta * speed * (h - carried) / h.powi(3);
    let mut pressure = 0.0;
    let largest = thickness.iter().fold(0.0, |largest: f64, h| {
        pressure += slope(*h) * middle * step;
        largest.max(pressure.abs())
    });
    let [rolling, sliding] =
        [integral(&|h| 0.5 * h * slope(h)), integral(&|h| eta * speed * ratio / (h + parameters.shear_film_offset))]
            .map(|force| force * parameters.width);
    println!(
        "p {} {largest}, T {} {} of {rolling} + {sliding}",
        o.maximum_fluid_pressure, o.upper_friction_force, o.lower_friction_force
    );
    assert_relative_eq!(o.maximum_fluid_pressure, largest, max_relative = 2e-3);
    assert_relative_eq!(-o.minimum_fluid_pressure, largest, max_relative = 2e-3);
    assert_relative_eq!(o.upper_friction_force, rolling + sliding, max_relative = 2e-3);
    assert_relative_eq!(o.lower_friction_force, sliding - rolling, max_relative = 2e-3);
    // About the middle of the contact; about the shaft's axis, a radius above, the pressures have no moment.
    assert_relative_eq!(o.upper_moment + middle * o.upper_force_x, -middle * sliding, max_relative = 1e-2);
}

#[test]
fn a_rigid_counterface_is_the_limit_of_a_stiff_tight_layer() {
    let base = case();
    let body = Body { outer_radius: 0.2, ..base.upper };
    let glass = Body {
        outer_radius: -0.5,
        shear_modulus: 1e10,
        bulk_modulus: 1e10,
        permeability: 1e-22,
        thickness: 1e-3,
        ..body
    };
    let sector_half_angle = 0.05;
    let pair = Parameters { upper: body, lower: glass, sector_half_angle, pore_viscosity: 2e-3, ..base };
    for (rms, depths) in [(0.0, &[-5.0, 2.0, 8.0, 12.0, 16.0][..]), (0.5e-6, &[0.0, 8.0])] {
        for ratio in [0.0, 1.0, -1.0] {
            let pair = Parameters { surface_roughness: rms, ..pair };
            let rigid = Parameters { rigid_lower: true, ..pair };
            for end in 2..=depths.len() {
                let [a, b] = [&pair, &rigid].map(|case| at(case, &depths[..end], 0.1, ratio));
                println!(
                    "{ratio} {rms} {}: {} {} N/m, h {} {}",
                    depths[end - 1],
                    a.load,
                    b.load,
                    a.minimum_film_thickness,
                    b.minimum_film_thickness
                );
                // The stretch along the surface is the mean of both bodies', and here that of the one. Rough surfaces of two layers are paired
                // as they are deformed, those against a counterface are not.
                let unlike = if rms > 0.0 { 3.0 } else { 1.0 };
                assert_relative_eq!(a.load, b.load, max_relative = unlike * 1e-2);
                assert_relative_eq!(
                    a.minimum_film_thickness,
                    b.minimum_film_thickness,
                    max_relative = unlike * 5e-3,
                    epsilon = 1e-9
                );
                assert_relative_eq!(
                    a.upper_friction_force,
                    b.upper_friction_force,
                    max_relative = 2e-2,
                    epsilon = 1e-4
                );
                assert_relative_eq!(a.upper_force_x, b.upper_force_x, max_relative = 2e-2, epsilon = 1e-3);
                assert_relative_eq!(a.upper_moment, b.upper_moment, max_relative = 2e-2, epsilon = 1e-5);
                assert_relative_eq!(a.stored_elastic_energy, b.stored_elastic_energy, max_relative = unlike * 5e-3);
            }
        }
    }
}

#[test]
fn a_flat_rigid_counterface_is_half_a_pair_at_rest() {
    let base = case();
    let flat = Body { outer_radius: 0.0, ..base.upper };
    let rigid = Parameters { lower: flat, rigid_lower: true, ..base };
    let [half, pair] = [(&rigid, 10.0), (&base, 20.0)].map(|(case, depth)| at(case, &[0.5 * depth, depth], 0.0, 0.0));
    assert!(half.solid_load > 1.0);
    assert_relative_eq!(half.solid_load, pair.solid_load, max_relative = 1e-6);
    // To where between two nodes the contact ends.
    assert_relative_eq!(half.contact_length, pair.contact_length, max_relative = 2e-2);
}
