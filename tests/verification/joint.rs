//! The tissue of a joint (human femoral condyle, k = 1.18e-15 m^4/(N s), U = 0.2 m/s): fresh tissue at the inflow, undrained layers,
//! rough surfaces, and the mesh that the program chooses.
//!
//! - Inflow: tissue enters unstrained, with no flux through the end; load at d = 10 micron 14.89 N/m by two independent codes, 0.5 %.
//!   As kappa -> 0 the load has a limit. Varied: permeability (1e-18 to 1e-24 m^2, 0.1 %), order of the pressure (1 %), sense and
//!   slide-to-roll ratio. Fluid mass of each body: flux out of its boundary = -alpha oint (J - 1) v.n.
//! - Undrained bonded layer under a parabola (Meijers; Jaffar), nu = 1/2: W R/(G a^2), p0 R/(G a), delta R/a^2; delta = (d + h)/2.
//! - Rough surfaces: load, support, least film and pressure of a one-purpose code; sigma -> 0 is the smooth film; what is carried by the
//!   fluid does not depend on the core of the asperities' law, h/sigma does; order of the film's scheme where it is thick (Martin).
//! - A mesh that goes with the contact in time, against one that stays: load 1 %, least film 3 %.
//! - Automatic mesh: twice the columns, rows and sector change the load by 1 %, film and friction by 2 %.

use approx::assert_relative_eq;
use cartilage_contact::equations::film::Film;
use cartilage_contact::laws::fluid::Fluid;
use cartilage_contact::laws::roughness::{AsperityLaw, Roughness};
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{
    Body, Control, Inputs, Mesh, MeshDistribution, Parameters, Preset, TimeIntegration,
};
use cartilage_contact::simulation::{Drive, Input, Simulation};

use crate::line::{Line, film};
use crate::pair::Pair;
use crate::strip::orders;

const U: f64 = 0.2;

/// The condyle on the preset's rows, with this many columns.
fn condyle(columns: i32) -> Parameters {
    let preset = Preset::HumanFemoralCondyle.parameters();
    Parameters {
        surface_roughness: 0.0,
        mesh_distribution: MeshDistribution::Graded,
        sector_half_angle: std::f64::consts::PI / 36.0,
        mesh: Mesh { columns, rows: 14, column_grading: 2.5, row_grading: 5.0 },
        ..preset
    }
}

/// The condyle with rough surfaces on the program's mesh.
fn rough(rms: f64) -> Parameters {
    Parameters {
        surface_roughness: rms,
        mesh_distribution: MeshDistribution::Contact,
        sector_half_angle: 0.0,
        mesh: Mesh { columns: 0, rows: 0, ..Parameters::default().mesh },
        ..condyle(0)
    }
}

fn with_both(parameters: Parameters, change: impl Fn(Body) -> Body) -> Parameters {
    Parameters { upper: change(parameters.upper), lower: change(parameters.lower), ..parameters }
}

fn inputs(micron: f64, sliding_speed: f64, slide_to_roll_ratio: f64) -> Inputs {
    Inputs { penetration_depth: 1e-6 * micron, sliding_speed, slide_to_roll_ratio, ..Inputs::NONE }
}

fn solved(parameters: &Parameters, inputs: Inputs) -> Outputs {
    let mut simulation = Simulation::new(parameters).unwrap();
    simulation.solve_steady(inputs).unwrap();
    let o = simulation.outputs();
    println!(
        "{inputs}, rms {:e}, {} x {}, {} mm: L {:.6} support {:.5} h_min {:.5e} p_max {:.5e} T {:.5e}, {} iterations",
        parameters.surface_roughness,
        o.mesh_columns,
        o.mesh_rows,
        1e3 * o.mesh_half_width,
        o.load,
        o.fluid_load_support,
        o.minimum_film_thickness,
        o.maximum_fluid_pressure,
        o.upper_friction_force,
        o.newton_iterations
    );
    o.clone()
}

#[test]
fn the_load_of_tissue_that_enters_fresh() {
    let load = |parameters: &Parameters| solved(parameters, inputs(10.0, U, 0.0)).load;
    let reference = load(&condyle(120));
    assert_relative_eq!(reference, 14.89, max_relative = 5e-3);
    let tight = |permeability: f64| load(&with_both(condyle(120), |body| Body { permeability, ..body }));
    let loads = [1e-18, 1e-20, 1e-22, 1e-24].map(tight);
    loads.iter().for_each(|load| assert_relative_eq!(*load, loads[0], max_relative = 1e-3));
    let second = load(&Parameters { pressure_order: 2, ..condyle(240) });
    assert_relative_eq!(load(&condyle(240)), second, max_relative = 1e-2);
}

#[test]
fn tissue_enters_at_the_other_end_when_the_speed_turns() {
    for ratio in [0.0, 1.5, -1.5] {
        let [a, b] = [U, -U].map(|speed| solved(&condyle(120), inputs(10.0, speed, ratio)));
        assert_relative_eq!(a.load, 14.89, max_relative = 5e-3);
        assert_relative_eq!(a.load, b.load, max_relative = 1e-5);
        assert_relative_eq!(a.minimum_film_position, -b.minimum_film_position, max_relative = 1e-3);
        for i in 0..101 {
            assert!((a.film_thickness[i] - b.film_thickness[100 - i]).abs() < 1e-5 * a.film_thickness[i]);
            assert!((a.fluid_pressure[i] - b.fluid_pressure[100 - i]).abs() < 1e-5 * a.maximum_fluid_pressure);
        }
    }
}

/// What the film takes from a body, and what flows through its ends, is what the tissue's volume gives on its way: with a slide-to-roll
/// ratio of 1.5 the bodies move against each other.
#[test]
fn fluid_of_each_body_is_conserved() {
    for (permeability, ratio) in [(1e-18, 0.0), (1e-15, 1.5), (1e-18, 1.5), (1e-18, -1.5)] {
        let parameters = Parameters {
            tolerance: 1e-10,
            fluid_compressibility: 0.0,
            pressure_order: 2,
            mesh: Mesh { columns: 60, rows: 6, column_grading: 2.5, row_grading: 4.0 },
            ..with_both(condyle(60), |body| Body { permeability, ..body })
        };
        let mut pair = Pair::new(&parameters, false);
        let at = inputs(5.0, U, ratio);
        [-10.0, 0.0, 5.0].iter().for_each(|d| pair.go(Inputs { penetration_depth: 1e-6 * d, ..at }));
        let levels = pair.levels();
        let speeds = [0.5 * U * (1.0 + ratio), 0.5 * U * (1.0 - ratio)];
        let mut given = 0.0;
        for (body, speed) in speeds.into_iter().enumerate() {
            let reactions = pair.reactions(body, speed);
            let exuded: f64 = reactions[2].iter().step_by(levels).map(|reaction| -reaction).sum();
            let size: f64 = reactions[2].iter().step_by(levels).map(|reaction| reaction.abs()).sum();
            let carried = pair.carried_out(body, speed);
            println!(
                "kappa {permeability:e} ratio {ratio} body {body}: exuded {exuded:e}, carried out {carried:e} of {size:e}"
            );
            assert!((exuded + carried).abs() < 1e-7 * size, "{exuded} and {carried} of {size}");
            given += exuded;
        }
        let through: f64 = pair.beyond(&parameters).iter().map(|end| end.outflow.abs()).sum();
        let out: f64 = pair.beyond(&parameters).iter().map(|end| end.outflow).sum();
        assert!((given - out).abs() < 1e-8 * through, "{given} and {out} of {through}");
    }
}

/// In time, from 0.01 to -0.01 m/s in 0.1 s. Second differences of the load fall with the square of the step where the
/// way is smooth, in proportion to it at a kink, and not at all at a jump. Varied: 20 and 40 steps.
#[test]
fn a_speed_through_zero_makes_no_jump() {
    let parameters = Parameters {
        time_integration: TimeIntegration::Transient,
        relative_tolerance: 1e-5,
        mesh: Mesh { columns: 60, rows: 6, column_grading: 2.5, row_grading: 4.0 },
        ..condyle(60)
    };
    let bends = [20, 40].map(|steps: i32| {
        let step = 0.1 / f64::from(steps);
        let mut simulation = Simulation::new(&parameters).unwrap();
        let loads: Vec<f64> = (0..steps)
            .map(|k| {
                let sliding_speed = 0.01 * (1.0 - 2.0 * f64::from(k) / f64::from(steps));
                let now = inputs(5.0, sliding_speed, 0.0);
                let rates = Inputs { sliding_speed: -0.2, ..Inputs::NONE };
                simulation.advance(Drive { inputs: now, rates }, step).unwrap();
                simulation.outputs().load
            })
            .collect();
        let middle = steps as usize / 2;
        let bend = |k: usize| (loads[k - 1] - 2.0 * loads[k] + loads[k + 1]).abs();
        let largest = (middle - 3..middle + 3).map(bend).fold(0.0, f64::max);
        println!("{steps} steps: {largest:e} of {}, {:?}", loads[middle], &loads[middle - 3..middle + 3]);
        assert!(largest < 1e-2 * loads[middle].abs());
        largest
    });
    assert!(bends[1] < 0.45 * bends[0], "{bends:?}");
}

/// Layers of nu = 1/2 under contacts of 1 and 2 thicknesses (4: ignored), 1 %. The film adds to the indentation, 7 % of it at a/t = 1 and
/// 0.2 % at 4: W and p0 are those of delta = (d + h)/2, by the logarithmic slopes of the table, dlnW/dln(delta) and dln(p0)/dln(delta).
/// Strains stay small (d/2t = 0.2 to 2 %). Lubricated with 1e-4 Pa s between surfaces of 0.2 micron roughness.
fn undrained(ratio: f64, load: [f64; 2], pressure: [f64; 2], depth: f64) {
    let (radius, thickness, modulus) = (1.0, 5e-3, 1e6);
    let parameters = Parameters {
        viscosity: 1e-4,
        fluid_compressibility: 0.0,
        ..with_both(rough(0.2e-6), |body| Body {
            outer_radius: radius,
            thickness,
            shear_modulus: modulus,
            bulk_modulus: modulus,
            permeability: 1e-24,
            ..body
        })
    };
    let a: f64 = ratio * thickness;
    let o = solved(&parameters, inputs(1e6 * 2.0 * depth * a * a / radius, U, 0.0));
    let indented = 1.0 + o.central_film_thickness / o.penetration_depth;
    let top = (0..101).map(|i| o.fluid_pressure[i] + o.contact_pressure[i]).fold(0.0, f64::max);
    let (carried, highest) = (o.load * radius / (modulus * a * a), top * radius / (modulus * a));
    println!("a/t {ratio}: W R/(G a^2) {carried}, p0 R/(G a) {highest}, of the indentation {indented} of its table's");
    assert_relative_eq!(carried / indented.powf(load[1]), load[0], max_relative = 1e-2);
    assert_relative_eq!(highest / indented.powf(pressure[1]), pressure[0], max_relative = 1e-2);
}

#[test]
fn an_undrained_layer_carries_what_an_incompressible_one_does() {
    undrained(1.0, [5.9807, 1.93], [4.0052, 1.38], 0.4384);
    undrained(2.0, [12.72, 2.03], [9.21, 1.49], 0.3323);
}

#[test]
#[ignore = "half a minute"]
fn a_thin_undrained_layer_carries_what_an_incompressible_one_does() {
    undrained(4.0, [37.681, 2.14], [29.229, 1.60], 0.2635);
}

/// Depths, loads and bands of the one-purpose code, which has no columns of ours: load 0.6 % (0.3 % of the depth), least film and pressure
/// 2 %. The fraction of the fluid is that of a resolved mesh only, see `rough_states_on_twice_the_mesh`. That code has the film on the undeformed
/// surfaces, where the fluid carries 0.909; on the deformed ones it carries 0.008 less.
#[test]
fn a_rough_joint_of_ten_kilonewton_per_metre() {
    let o = solved(&rough(1e-6), inputs(454.1, U, 0.0));
    assert_relative_eq!(o.load, 10e3, max_relative = 6e-3);
    assert_relative_eq!(o.minimum_film_thickness, 0.474e-6, max_relative = 2e-2);
    assert_relative_eq!(o.maximum_fluid_pressure, 0.741e6, max_relative = 2e-2);
    assert!(o.fluid_load_support > 0.898 && o.fluid_load_support < 0.922);
}

/// That code has the film on the undeformed surfaces. On the deformed ones the fluid carries less, by the fourth number, and the film is thinner by
/// up to 1.6 %.
#[test]
#[ignore = "a minute and a half"]
fn rough_states_on_twice_the_mesh() {
    for (rms, micron, load, stretched, support, film, pressure) in [
        (1e-6, 454.1, 10e3, 0.008, (0.909, 0.003), (0.474e-6, 2e-2), Some(0.741e6)),
        (0.3e-6, 454.0, 10e3, 0.010, (0.923, 0.006), (0.144e-6, 2e-2), None),
        (1e-6, 918.2, 50e3, 0.004, (0.9355, 0.003), (0.382e-6, 2e-2), Some(2.669e6)),
    ] {
        let mesh = Mesh { columns: 192, rows: 20, ..Parameters::default().mesh };
        let o = solved(&Parameters { mesh, ..rough(rms) }, inputs(micron, U, 0.0));
        assert_relative_eq!(o.load, load, max_relative = 6e-3);
        println!("{rms} {load}: {} {:e}", o.fluid_load_support, o.minimum_film_thickness);
        assert!((o.fluid_load_support + stretched - support.0).abs() < support.1, "{}", o.fluid_load_support);
        assert_relative_eq!(o.minimum_film_thickness, film.0, max_relative = film.1);
        if let Some(pressure) = pressure {
            assert_relative_eq!(o.maximum_fluid_pressure, pressure, max_relative = 1e-2);
        }
    }
}

/// Martin's film, two hundred times as thick as the roughness: pressures of the nodes. What moves upstream goes with the third power of
/// the elements' length, and Q is exact but for that.
#[test]
fn the_scheme_of_rough_films_is_of_second_order_where_they_are_thick() {
    let (h0, r, eta) = (10e-6, 0.05, 1e-3);
    let roughness = Roughness {
        rms: 0.05e-6,
        law: AsperityLaw::Exponential,
        asperity_pressure: 20e3,
        asperity_decay: 0.5,
        core_pressure: 10e6,
        core_decay: 0.1,
    };
    let exact = |x: f64| -2.0 * eta * U * x / (h0 + x * x / (2.0 * r)).powi(2);
    for order in [1, 2] {
        for speed in [U, -U] {
            let error = |columns: usize| {
                let film = Film { rough: Some((roughness, 0.3e6)), ..film(Fluid::Newtonian(eta), order) };
                let half = 5.0 * f64::sqrt(2.0 * r * h0);
                let stations: Vec<f64> = (0..=2 * columns).map(|i| half * (i as f64 / columns as f64 - 1.0)).collect();
                let mut line = Line::new(film, stations, |x| h0 + x * x / (2.0 * r), speed);
                let exact = |x: f64| exact(x) * speed.signum();
                for end in [0, 2 * columns] {
                    line.pressure[end] = exact(line.stations[end]);
                }
                line.solve();
                let nodes = (0..line.stations.len()).step_by(2);
                nodes.map(|i| (line.pressure[i] - exact(line.stations[i])).abs()).fold(0.0, f64::max)
            };
            let errors = [40, 80, 160, 320].map(error);
            let observed = orders(&errors);
            println!("order {order}, U {speed}: {observed:?} of {errors:?}");
            // Of third order as long as the flow factor's fraction of the error is smaller.
            assert!(observed[..2].iter().all(|observed| *observed > 1.75), "order {order}: {observed:?} of {errors:?}");
        }
    }
}

/// Where the surfaces do not touch, roughness vanishes from the answer. Varied: sigma = 2 to 0.25 micron at h_min = 1.9 micron. What is
/// left of the film is the difference of the two schemes.
#[test]
#[ignore = "a minute"]
fn rough_surfaces_approach_smooth_ones() {
    let fixed = Parameters { sector_half_angle: 0.17, ..condyle(360) };
    let at = |rms: f64| solved(&Parameters { surface_roughness: rms, ..fixed }, inputs(50.0, U, 0.0));
    let smooth = at(0.0);
    let [coarse, fine, finest] = [2e-6, 1e-6, 0.25e-6].map(|rms| {
        let o = at(rms);
        [o.load / smooth.load - 1.0, o.minimum_film_thickness / smooth.minimum_film_thickness - 1.0].map(f64::abs)
    });
    for quantity in 0..2 {
        assert!(fine[quantity] < 0.6 * coarse[quantity] && finest[quantity] < fine[quantity]);
    }
    assert!(finest[0] < 2e-3 && finest[1] < 3e-2, "{finest:?}");
}

#[test]
#[ignore = "a minute"]
fn the_fluid_s_share_does_not_depend_on_the_core() {
    let at = |core_pressure: f64, core_decay: f64| {
        solved(&Parameters { core_pressure, core_decay, ..rough(0.3e-6) }, inputs(454.0, U, 0.0))
    };
    let reference = at(10e6, 0.1);
    for (pressure, decay) in [(3e6, 0.1), (30e6, 0.1), (10e6, 0.07), (10e6, 0.15)] {
        let o = at(pressure, decay);
        assert_relative_eq!(o.fluid_load_support, reference.fluid_load_support, max_relative = 1e-2);
        let film = (o.minimum_film_thickness / reference.minimum_film_thickness - 1.0).abs();
        assert!(film > 0.1, "{film}");
    }
}

/// Load, least film and friction on the program's mesh and on one of twice the columns and rows, and on twice the sector.
#[test]
fn the_automatic_mesh_is_fine_enough() {
    finer_and_wider(0.3e-6, 10.0);
}

#[test]
#[ignore = "a minute"]
fn the_automatic_mesh_is_fine_enough_at_a_tenth_of_a_millimetre() {
    finer_and_wider(0.3e-6, 107.0);
}

#[test]
#[ignore = "does not hold yet: friction"]
fn the_automatic_mesh_is_fine_enough_for_smooth_surfaces() {
    finer_and_wider(0.0, 10.0);
}

#[test]
#[ignore = "does not hold yet: rolling friction; a minute"]
fn the_automatic_mesh_is_fine_enough_for_a_joint_s_load() {
    finer_and_wider(0.3e-6, 454.0);
}

fn finer_and_wider(rms: f64, micron: f64) {
    let parameters = rough(rms);
    let at = inputs(micron, U, 0.0);
    let automatic = solved(&parameters, at);
    let mesh = Mesh { columns: 2 * automatic.mesh_columns, rows: 2 * automatic.mesh_rows, ..parameters.mesh };
    let finer = solved(&Parameters { mesh, ..parameters }, at);
    let half_width = 2.0 * automatic.mesh_half_width;
    let wider = Parameters {
        sector_half_angle: (half_width / parameters.upper.outer_radius).asin(),
        mesh: Mesh { columns: 3 * automatic.mesh_columns / 2, ..parameters.mesh },
        ..parameters
    };
    let wider = solved(&wider, at);
    for other in [finer, wider] {
        assert_relative_eq!(other.load, automatic.load, max_relative = 1e-2);
        assert_relative_eq!(other.minimum_film_thickness, automatic.minimum_film_thickness, max_relative = 2e-2);
        assert_relative_eq!(other.upper_friction_force, automatic.upper_friction_force, max_relative = 2e-2);
    }
}

/// A sector of the contact and half a thickness more changes the depth under a load, and says so; the program's own does not.
#[test]
fn a_sector_that_ends_near_the_pressure_is_told_of() {
    let warnings = |sector_half_angle: f64| {
        let parameters = Parameters { sector_half_angle, ..rough(1e-6) };
        let mut joint = Simulation::new(&parameters).unwrap();
        joint.solve_steady(inputs(30.0, U, 0.0)).unwrap();
        (joint.outputs().clone(), joint.warnings().to_vec())
    };
    let (automatic, nothing) = warnings(0.0);
    assert!(!nothing.iter().any(|warning| warning.contains("sector")), "{nothing:?}");
    let thickness = Preset::HumanFemoralCondyle.parameters().upper.thickness;
    let pressed = automatic.contact_length.max(2e-3);
    // From the edge of the contact, which the pressure passes by half a thickness.
    for (thicknesses, words) in
        [(0.5, "reaches the end of the sector"), (1.2, "within 2.5 thicknesses"), (2.5, "within 2.5 thicknesses")]
    {
        let (narrow, told) = warnings(((0.5 * pressed + thicknesses * thickness) / 0.1).asin());
        println!("{thicknesses}: {} of {} N/m, {told:?}", narrow.load, automatic.load);
        assert!((narrow.load / automatic.load - 1.0).abs() > 0.02);
        assert!(told.iter().any(|warning| warning.contains(words)), "{told:?}");
    }
    // Enough for 1 %.
    let (wide, nothing) = warnings(((0.5 * pressed + 4.0 * thickness) / 0.1).asin());
    assert_relative_eq!(wide.load, automatic.load, max_relative = 1e-2);
    assert!(!nothing.iter().any(|warning| warning.contains("sector")), "{nothing:?}");
}

/// Under load: the depth follows, and the state is that of the depth.
#[test]
fn rough_surfaces_under_a_load() {
    let loaded = Parameters { control: Control::Load, ..rough(1e-6) };
    let o = solved(&loaded, Inputs { applied_load: 10e3, sliding_speed: U, ..Inputs::NONE });
    assert_relative_eq!(o.penetration_depth, 454.1e-6, max_relative = 3e-3);
}

/// Ten kilonewtons a metre from rest, with fibres that make the tissue several times stiffer too.
#[test]
fn every_tissue_is_loaded_from_rest() {
    for preset in [
        Preset::HumanTibialPlateau,
        Preset::HumanNormal,
        Preset::BovineHumeralHead,
        Preset::Osteoarthritic,
        Preset::HumanFemoralCondyleFibres,
        Preset::BovineHumeralHeadFibres,
        Preset::BovineLayered,
    ] {
        let loaded = Parameters { control: Control::Load, ..preset.parameters() };
        let o = solved(&loaded, Inputs { applied_load: 10e3, sliding_speed: U, ..Inputs::NONE });
        assert!(o.newton_iterations < 300, "{preset:?}: {}", o.newton_iterations);
        assert_relative_eq!(o.load, 10e3, max_relative = 1e-4);
    }
}

/// From rest, with a stiffness that is the slope of load over depth between neighbouring states on meshes of their own.
#[test]
fn body_weight_is_carried_from_rest() {
    let loaded = Parameters { control: Control::Load, ..rough(0.3e-6) };
    for load in [1e3, 100e3] {
        let mut joint = Simulation::new(&loaded).unwrap();
        let given = |load: f64| Inputs { applied_load: load, sliding_speed: U, ..Inputs::NONE };
        joint.solve_steady(given(load)).unwrap();
        assert!(joint.outputs().newton_iterations < 200, "{}", joint.outputs().newton_iterations);
        assert_relative_eq!(joint.outputs().load, load, max_relative = 1e-4);
        let (depth, stiffness) = (joint.outputs().penetration_depth, joint.contact_stiffness().unwrap());
        joint.solve_steady(given(1.01 * load)).unwrap();
        assert!(joint.outputs().newton_iterations < 60, "{}", joint.outputs().newton_iterations);
        let slope = 0.01 * load / (joint.outputs().penetration_depth - depth);
        assert_relative_eq!(stiffness, slope, max_relative = 2e-2);
    }
}

/// 30 % of the layers' thickness by depth, and 100 kN/m on stiff tissue: reached from less, not at once.
#[test]
fn thirty_per_cent_of_compression_is_reached_from_rest() {
    let condyle = Preset::HumanFemoralCondyle.parameters();
    let bovine = Parameters { control: Control::Load, ..Preset::BovineHumeralHead.parameters() };
    let deep = Inputs { penetration_depth: 0.6 * condyle.upper.thickness, sliding_speed: U, ..Inputs::NONE };
    for (parameters, given) in
        [(condyle, deep), (bovine, Inputs { applied_load: 100e3, sliding_speed: U, ..Inputs::NONE })]
    {
        let mut joint = Simulation::new(&parameters).unwrap();
        joint.solve_steady(given).unwrap();
        let o = joint.outputs();
        let compression = 0.5 * o.penetration_depth / parameters.upper.thickness;
        println!("{compression}: {} N/m, {} iterations", o.load, o.newton_iterations);
        assert!(compression > 0.23 && o.load > 90e3 && o.fluid_load_support > 0.9, "{compression} {o:?}");
    }
}

/// Deep in the contact of undrained tissue the pressure is smooth from column to column: 7e-5 of it alternates, and without the upstream
/// weight 2e-4.
#[test]
fn the_pressure_of_undrained_tissue_does_not_alternate() {
    let mut joint = Simulation::new(&rough(0.3e-6)).unwrap();
    joint.solve_steady(inputs(900.0, U, 0.0)).unwrap();
    let interface = joint.fields().unwrap().interface;
    let largest = joint.outputs().maximum_fluid_pressure;
    let columns: Vec<f64> = interface.fluid_pressure.iter().copied().step_by(2).collect();
    // Amplitude of what alternates, apart from curvature, under the middle of the contact.
    let p = |i: usize| columns[i];
    let alternating = |i: usize| (p(i - 2) - 4.0 * p(i - 1) + 6.0 * p(i) - 4.0 * p(i + 1) + p(i + 2)).abs() / 16.0;
    let middle: Vec<usize> = (2..columns.len() - 2).filter(|i| p(*i) > 0.85 * largest).collect();
    assert!(middle.len() > 6, "{}", middle.len());
    let ripple = middle.into_iter().map(alternating).fold(0.0, f64::max) / largest;
    println!("{ripple:e}");
    assert!(ripple < 1.4e-4, "{ripple}");
}

/// The mesh goes with the contact in time; what tissue and film hold stays where it is. Against a mesh that stays and is fine all over.
/// Two bodies, one faster than the other; depth there and back.
#[test]
fn a_mesh_that_moves_carries_nothing_along() {
    let wide = Parameters {
        mesh_distribution: MeshDistribution::Graded,
        sector_half_angle: 0.2,
        mesh: Mesh { columns: 300, rows: 10, column_grading: 2.0, row_grading: 5.0 },
        ..rough(0.3e-6)
    };
    let pressed = |parameters: &Parameters, ratio: f64| {
        let parameters =
            Parameters { time_integration: TimeIntegration::Transient, relative_tolerance: 1e-3, ..*parameters };
        let mut simulation = Simulation::new(&parameters).unwrap();
        let mut found = Vec::new();
        const STEP: f64 = 2.5e-3;
        for step in 0..16 {
            let depth = |step: f64| 22e-6 - 18e-6 * (std::f64::consts::PI * step / 8.0).cos();
            let [from, to] = [depth(f64::from(step)), depth(f64::from(step + 1))];
            let inputs = inputs(1e6 * from, 0.1, ratio);
            let rates = Inputs { penetration_depth: (to - from) / STEP, ..Inputs::NONE };
            simulation.advance(Drive { inputs, rates }, STEP).unwrap();
            let o = simulation.outputs();
            println!(
                "{} x {} ratio {ratio} d {:.2} um: L {:.4} support {:.4} h_min {:.4e} T {:.5e} exudation {:.4e}, {} iterations",
                o.mesh_columns,
                o.mesh_rows,
                1e6 * to,
                o.load,
                o.fluid_load_support,
                o.minimum_film_thickness,
                o.upper_friction_force,
                o.net_fluid_exudation,
                o.newton_iterations
            );
            found.push(o.clone());
        }
        found
    };
    let [moves, stays] = [&rough(0.3e-6), &wide].map(|parameters| pressed(parameters, 0.8));
    for (moves, stays) in moves.iter().zip(&stays) {
        assert!((moves.load - stays.load).abs() < 1e-2 * stays.load + 0.1);
        assert_relative_eq!(moves.minimum_film_thickness, stays.minimum_film_thickness, max_relative = 3e-2);
    }
}

/// While the mesh goes along with a growing load. Against differences of the step, by a ten-thousandth of the load.
#[test]
fn a_step_has_its_derivatives_while_the_mesh_moves() {
    const STEP: f64 = 1e-3;
    let parameters = Parameters {
        control: Control::Load,
        time_integration: TimeIntegration::Transient,
        tolerance: 1e-9,
        ..rough(0.3e-6)
    };
    let mut simulation = Simulation::new(&parameters).unwrap();
    let rates = Inputs { applied_load: 1e4, ..Inputs::NONE };
    let at = |step: i32| Inputs { applied_load: 500.0 + 10.0 * f64::from(step), ..inputs(0.0, U, 0.0) };
    for step in 0..4 {
        simulation.advance(Drive { inputs: at(step), rates }, STEP).unwrap();
    }
    let before = simulation.snapshot();
    let mut with = |change: f64| {
        simulation.restore(&before).unwrap();
        let inputs = Inputs { applied_load: at(4).applied_load + change, ..at(4) };
        simulation.advance(Drive { inputs, rates }, STEP).unwrap();
        simulation.outputs().clone()
    };
    let [more, less] = [0.05, -0.05].map(&mut with);
    with(0.0);
    let slope = simulation.derivatives(Input::AppliedLoad).unwrap();
    println!("{:e} {:e}", slope.penetration_depth, slope.central_film_thickness);
    type Get = fn(&Outputs) -> f64;
    let results: [Get; 3] = [|o| o.penetration_depth, |o| o.central_film_thickness, |o| o.upper_friction_force];
    for result in results {
        assert_relative_eq!(result(slope), (result(&more) - result(&less)) / 0.1, max_relative = 1e-5);
    }
}
