//! What must hold for every solution, to round-off or to Newton's tolerance, on any mesh.
//!
//! - Mirror: U -> -U mirrors every field in x; the half model is the full one.
//! - Film energy (steady, equal speeds): (U/2) int l h p' dx = int h^3 p'^2/(12 eta) dx - int p V dx + sum p_e Q_e over the deformed film, with
//!   its stretch l and the flux Q_e out of the ends of the sector (consistent; in the paper's formulation l = 1 and p_e = 0).
//! - Fluid mass: at every station the two bodies give what the film takes, int V dx = sum Q_e; per body the reactions of the fluid
//!   balances add up to what tissue carries out, int alpha (J - 1) v.n over the end where it leaves: as much more or less fluid left
//!   the body. In the paper's formulation they cancel. Q_e is Reynolds' equation out to p = 0 at infinity.
//! - Equilibrium of each body: consistent, bone reaction = int p n da over the deformed surface + L_s, the total stress being the
//!   effective one less alpha p J F^-T; paper (effective stress only, Div P_eff = alpha grad p), effective bone reaction =
//!   alpha L_f + L_s - alpha int p n over the bone: with the pore pressure alpha p on the bone it carries alpha L_f + L_s, not L.
//! - Work: what the bones put in is what film, pores, friction and the tissue that leaves take, each bone against what its own tissue feels.
//! - Bones: half the difference of the two bones' reactions is the reported force and moment, but for the mean shear of the film, which the
//!   tissue does not feel; over both bodies the forces add up to those on the ends of the film (consistent: pressure and its shear act on the
//!   tissue).
//! - Equation 13: T_1 - T_2 = int h p' dx, in a full film [h p] - int p h' dx; T_1 + T_2 = 2 (boundary friction + sliding shear); with the
//!   film beyond the sector.
//! - Units: in mm, g and s pressures keep their numbers and the loads are 1000 times as large.

use approx::assert_relative_eq;
use cartilage_contact::fem::element::{GAUSS, GAUSS_WEIGHTS, pressure, quadratic_derivative};
use cartilage_contact::io::case::Case;
use cartilage_contact::parameters::{Body, Control, Formulation, Inputs, Mesh, Parameters, Preset};
use cartilage_contact::simulation::Simulation;

use crate::pair::Pair;

const U: f64 = 0.2;

fn coarse(formulation: Formulation) -> Parameters {
    Parameters {
        formulation,
        tolerance: 1e-10,
        fluid_compressibility: 0.0,
        mesh: Mesh { columns: 60, rows: 4, column_grading: 2.5, row_grading: 2.0 },
        ..Parameters::default()
    }
}

fn inputs(micron: f64, sliding_speed: f64, slide_to_roll_ratio: f64) -> Inputs {
    Inputs { penetration_depth: micron * 1e-6, sliding_speed, slide_to_roll_ratio, ..Inputs::NONE }
}

/// A pair at these depths one after the other.
fn pair_at(parameters: &Parameters, mirrored: bool, depths: &[f64]) -> Pair {
    let mut pair = Pair::new(parameters, mirrored);
    depths.iter().for_each(|d| pair.go(inputs(*d, U, 0.0)));
    pair
}

/// Depths one after the other; the last ones are in contact in both formulations.
const PATH: [f64; 9] = [-10.0, 0.0, 8.0, 12.0, 16.0, 20.0, 24.0, 27.0, 30.0];

#[test]
fn reversing_the_speed_mirrors_the_fields() {
    for formulation in [Formulation::Paper, Formulation::Consistent] {
        for ratio in [0.0, 0.3] {
            let mut forwards = Simulation::new(&coarse(formulation)).unwrap();
            let mut backwards = Simulation::new(&coarse(formulation)).unwrap();
            for d in PATH {
                forwards.solve_steady(inputs(d, U, ratio)).unwrap();
                backwards.solve_steady(inputs(d, -U, ratio)).unwrap();
                let (a, b) = (forwards.outputs(), backwards.outputs());
                for i in 0..101 {
                    let p = a.maximum_fluid_pressure;
                    assert!(
                        (a.film_thickness[i] - b.film_thickness[100 - i]).abs()
                            < 1e-8 * a.film_thickness[i].abs() + 1e-15
                    );
                    assert!((a.fluid_pressure[i] - b.fluid_pressure[100 - i]).abs() < 1e-7 * p);
                    assert!((a.contact_pressure[i] - b.contact_pressure[100 - i]).abs() < 1e-6 * p);
                }
                assert_relative_eq!(a.load, b.load, max_relative = 1e-8);
                assert_relative_eq!(a.upper_friction_force, -b.upper_friction_force, max_relative = 1e-6);
                assert_relative_eq!(a.lower_friction_force, -b.lower_friction_force, max_relative = 1e-6);
            }
            assert!(forwards.outputs().solid_load > 0.1);
        }
    }
}

/// Equal bodies without friction: u1x = u2x, u1y = -u2y, p1 = p2 everywhere.
#[test]
fn half_a_pair_is_half_of_the_pair() {
    for formulation in [Formulation::Paper, Formulation::Consistent] {
        let parameters = Parameters { boundary_friction_loads_tissue: false, ..coarse(formulation) };
        let half = pair_at(&parameters, true, &PATH);
        let full = pair_at(&parameters, false, &PATH);
        assert!(full.state.active.contains(&true) && half.state.active == full.state.active);
        for node in 0..half.system.layers[0].mesh.nodes.len() {
            let [x, y] = half.displacement(0, node);
            for (body, sign) in [(0, 1.0), (1, -1.0)] {
                let [fx, fy] = full.displacement(body, node);
                assert!((fx - x).abs() < 1e-13 && (sign * fy - y).abs() < 1e-13, "{fx} {x} {fy} {y}");
                assert!((half.pressure(0, node) - full.pressure(body, node)).abs() < 1e-2);
            }
        }
    }
}

/// In film, contact, and contact with friction; both formulations.
#[test]
fn energy_and_mass_of_the_film() {
    for formulation in [Formulation::Paper, Formulation::Consistent] {
        for friction in [false, true] {
            let parameters = Parameters { boundary_friction_loads_tissue: friction, ..coarse(formulation) };
            for depths in [&PATH[..1], &PATH[..3], &PATH[..]] {
                let pair = pair_at(&parameters, false, depths);
                let bodies = [0, 1].map(|body| pair.reactions(body, 0.5 * U));
                let levels = pair.levels();
                let film = pair.system.film_outflow(&pair.state, &pair.no_change());
                let beyond = pair.beyond(&parameters);
                // V times weight at the stations, and what the film makes of it.
                let outflow = |i: usize| -bodies[0][2][i * levels] - bodies[1][2][i * levels];
                let last = film.len() - 1;
                let size = film.iter().map(|f| f[0].abs()).sum::<f64>();
                // In the paper's formulation the pressure of the ends is given, and there is no balance.
                let balanced = if beyond.is_empty() { 1..last } else { 0..last + 1 };
                for i in balanced.clone() {
                    assert!(
                        (outflow(i) - film[i][0]).abs() < 1e-8 * size,
                        "station {i}: {} {}",
                        outflow(i),
                        film[i][0]
                    );
                }
                let total: f64 = balanced.map(outflow).sum();
                if !beyond.is_empty() {
                    let out: f64 = beyond.iter().map(|end| end.outflow).sum();
                    let through = beyond.iter().map(|end| end.outflow.abs()).sum::<f64>();
                    assert!((total - out).abs() < 1e-8 * through, "{total} and {out} of {through}");
                }
                for (body, reactions) in bodies.iter().enumerate() {
                    let carried = if beyond.is_empty() { 0.0 } else { pair.carried_out(body, 0.5 * U) };
                    let all: f64 = reactions[2].iter().sum();
                    assert!((all - carried).abs() < 1e-9 * size, "{all} and {carried} of {size}");
                }
                let places = pair.interface_points();
                let integral = |f: &dyn Fn(&crate::pair::InterfacePoint) -> f64| -> f64 {
                    places.iter().map(|p| p.weight * f(p)).sum()
                };
                let eta = parameters.viscosity;
                let driven = integral(&|p| 0.5 * U * p.stretch * p.film_thickness.max(0.0) * p.pressure_gradient);
                let lost =
                    integral(&|p| p.film_thickness.max(0.0).powi(3) * p.pressure_gradient.powi(2) / (12.0 * eta));
                let given: f64 = (0..=last).map(|i| pair.pressure(0, i * levels) * outflow(i)).sum();
                let left: f64 = beyond.iter().map(|end| end.pressure * end.outflow).sum();
                println!(
                    "{formulation:?} friction {friction} d {}: {driven} = {lost} - {given} + {left}",
                    depths[depths.len() - 1]
                );
                assert!((driven - lost + given - left).abs() < 1e-8 * driven.abs().max(lost));
            }
        }
    }
}

/// Forces of the bone on the upper and lower body against the loads.
#[test]
fn equilibrium_of_each_body() {
    for formulation in [Formulation::Paper, Formulation::Consistent] {
        let parameters = coarse(formulation);
        let alpha = parameters.upper.biot_coefficient;
        for depths in [&PATH[..1], &PATH[..3], &PATH[..]] {
            let pair = pair_at(&parameters, false, depths);
            let levels = pair.levels();
            let solid: f64 = (0..pair.state.active.len())
                .filter(|i| pair.state.active[*i])
                .map(|i| pair.state.contact_forces[i])
                .sum();
            let fluid: f64 = pair.interface_points().iter().map(|p| p.weight * p.pressure).sum();
            for body in 0..2 {
                let layer = &pair.system.layers[body];
                let reactions = pair.reactions(body, 0.5 * U);
                // Downwards on the upper body, upwards on the lower one.
                let bone: f64 =
                    (0..pair.system.stations.len()).map(|i| -layer.side * reactions[1][i * levels + levels - 1]).sum();
                // int p dx over a line of nodes, deformed or not, by Gauss's rule.
                let along = |level: usize, deformed: f64| -> f64 {
                    (0..layer.mesh.columns)
                        .flat_map(|column| {
                            let nodes = [0, 1, 2].map(|a| (2 * column + a) * levels + level);
                            let pressures = nodes.map(|n| pair.pressure(body, n));
                            let x = nodes.map(|n| layer.mesh.nodes[n][0] + deformed * pair.displacement(body, n)[0]);
                            let sum = |f: [f64; 3], v: [f64; 3]| f[0] * v[0] + f[1] * v[1] + f[2] * v[2];
                            GAUSS
                                .into_iter()
                                .zip(GAUSS_WEIGHTS)
                                .map(move |(s, w)| w * sum(pressure(2, s), pressures) * sum(quadratic_derivative(s), x))
                        })
                        .sum()
                };
                let expected = match formulation {
                    Formulation::Paper => alpha * fluid + solid - alpha * along(levels - 1, 0.0),
                    Formulation::Consistent => along(0, 1.0) + solid,
                };
                println!("{formulation:?} body {body}: bone {bone}, expected {expected}, L_f {fluid}, L_s {solid}");
                assert_relative_eq!(bone, expected, max_relative = 1e-7, epsilon = 1e-9);
            }
        }
    }
}

/// Forces and moments of the bones on tissue that balances the total stress, against what is reported: half the difference of the two
/// bodies' bone reactions, and the mean shear that the tissue does not feel. The sum over both bodies is what presses on the ends of the film.
#[test]
fn what_the_bones_carry_is_what_is_reported() {
    let base = coarse(Formulation::Consistent);
    let lower = Body { outer_radius: 0.15, thickness: 1.3e-3, shear_modulus: 0.8e6, ..base.upper };
    for lower in [base.upper, lower] {
        let parameters = Parameters { lower, width: 0.02, ..base };
        for ratio in [0.0, 0.4, -1.5] {
            let mut pair = Pair::new(&parameters, false);
            // Such long steps in contact of unlike bodies, or of much sliding ones, are beyond a plain Newton method.
            let all = lower == base.upper && ratio > -1.0;
            for d in PATH.into_iter().filter(|d| all || *d <= 8.0) {
                pair.go(inputs(d, U, ratio));
                let o = pair.solved().outputs().0;
                let levels = pair.levels();
                let bones = [0, 1].map(|body| {
                    let layer = &pair.system.layers[body];
                    let reactions = pair.reactions(body, 0.0);
                    let mut sum = [0.0; 3];
                    for node in (0..pair.system.stations.len()).map(|i| i * levels + levels - 1) {
                        let [[x, y], [ux, uy]] = [layer.mesh.nodes[node], pair.displacement(body, node)];
                        let [fx, fy] = [-reactions[0][node], -reactions[1][node]];
                        sum = [sum[0] + fx, sum[1] + fy, sum[2] + (x + ux) * fy - (y + uy) * fx];
                    }
                    sum
                });
                let half: [f64; 3] = std::array::from_fn(|k| 0.5 * (bones[0][k] - bones[1][k]));
                let boundary = pair.boundary_friction(&parameters);
                let [upper, lower] = [o.upper_friction_force, o.lower_friction_force].map(|t| t / parameters.width);
                let sliding = 0.5 * (upper + lower) - boundary;
                // The pressure of the film beyond the sector on each body's slopes.
                let last = pair.system.stations.len() - 1;
                let at_ends: f64 = pair
                    .beyond(&parameters)
                    .iter()
                    .zip([(0, -1.0), (last, 1.0)])
                    .map(|(end, (i, side))| {
                        side * end.pressure * pair.state.unknowns[pair.system.layout.gap[i] as usize]
                    })
                    .sum();
                let ends = at_ends + pair.beyond(&parameters).iter().map(|end| end.shear[0]).sum::<f64>();
                let [r1, r2] = [parameters.upper.outer_radius, parameters.lower.outer_radius];
                let beyond = 0.5 * (r2 - r1) / (r2 + r1) * ends;
                let size = upper.abs().max(lower.abs());
                let all = bones[0][0] + bones[1][0] + at_ends;
                // Shear lies along the arc of the film: its part along x is less by half the square of the angle.
                let curvature = 0.5 * (1.0 / parameters.upper.outer_radius - 1.0 / parameters.lower.outer_radius);
                let inclined = 1e-7 + 0.5 * (pair.system.half_width() * curvature).powi(2);
                // Between nodes in contact the film's thickness is cut off at zero.
                let bound = if o.contact_length > 0.0 { 1e-2 } else { inclined };
                assert!(all.abs() < bound * size, "{d} {ratio}: sum {all} of {size}");
                assert!(
                    (half[0] - sliding + beyond - o.tangential_load).abs() < inclined * size,
                    "{d} {ratio} {half:?} {o:?}"
                );
                assert_relative_eq!(half[1], o.load, max_relative = 1e-7, epsilon = 1e-9);
                // What pressure drives drags the walls half a film from its middle: the tissue feels that moment, which is left out.
                let dragged: f64 = pair
                    .interface_points()
                    .iter()
                    .map(|p| p.weight * p.pressure_gradient * (0.5 * p.film_thickness.max(0.0)).powi(2))
                    .sum();
                // Over a lever arm of a millimetre; the mean shear of the film, some 10 micron from the middle, is not in the sums above.
                let bound = 1e-3 * (1e-7 * o.load.abs() + 0.02 * (sliding.abs() + boundary.abs())) + 1e-12;
                assert!(
                    (half[2] - dragged - o.load_moment).abs() < bound,
                    "{d} {ratio}: {} {}",
                    half[2],
                    o.load_moment
                );
                assert_eq!(o.upper_force_x + o.lower_force_x, 0.0);
                assert_relative_eq!(o.upper_force_y, parameters.width * o.load);
                assert_relative_eq!(o.lower_moment, -parameters.width * o.load_moment);
            }
            assert!(pair.state.active.contains(&true) || !all);
        }
    }
}

/// The moment of the bone's reactions and that of the pressures by the trapezoidal rule between nodes differ by the square of their
/// distance.
#[test]
fn the_moment_is_that_of_the_surface_pressures() {
    let errors = [40, 80].map(|columns| {
        let base = coarse(Formulation::Consistent);
        let parameters = Parameters { mesh: Mesh { columns, ..base.mesh }, ..base };
        let pair = pair_at(&parameters, true, &[-10.0, 0.0, 6.0]);
        let o = pair.solved().outputs().0;
        let levels = pair.levels();
        let nodes: Vec<[f64; 2]> = (0..pair.system.stations.len())
            .map(|i| {
                let x = pair.system.stations[i] + pair.displacement(0, i * levels)[0];
                [x, x * pair.pressure(0, i * levels)]
            })
            .collect();
        let trapezoids: f64 = nodes.windows(2).map(|w| 0.5 * (w[0][1] + w[1][1]) * (w[1][0] - w[0][0])).sum();
        println!("{columns} columns: {} and {trapezoids} N", o.load_moment);
        (trapezoids / o.load_moment - 1.0).abs()
    });
    assert!(errors[0] > 3.0 * errors[1] && errors[1] < 1e-2, "{errors:?}");
}

/// In the paper's formulation the fluid presses on the undeformed surfaces and the asperities on the deformed ones, in their moment as in
/// their load: by Simpson's rule, which is exact for the fluid's load. 1e-5 of the moment: the squared slope of the surface is not.
#[test]
fn load_and_moment_of_the_papers_rough_surfaces_are_of_the_same_surfaces() {
    let parameters = Parameters { surface_roughness: 0.5e-6, asperity_pressure: 2e5, ..coarse(Formulation::Paper) };
    let pair = pair_at(&parameters, true, &[-10.0, 0.0, 8.0, 16.0]);
    let o = pair.solved().outputs().0;
    let contact = pair.system.contact_pressure(&pair.state, &pair.no_change());
    // Load and moment of pressures on the surface as it was, or as it is.
    let carried = |deformed: f64, pressure: &dyn Fn(usize) -> f64| {
        let point = |station: usize| {
            let node = station * pair.levels();
            let ([x, y], [ux, uy]) = (pair.system.layers[0].mesh.nodes[node], pair.displacement(0, node));
            [x + deformed * ux, y + uy]
        };
        let mut sum = [0.0; 2];
        for first in (0..pair.system.stations.len() - 1).step_by(2) {
            let nodes = [0, 1, 2].map(|a| point(first + a));
            for (a, weight) in [1.0 / 3.0, 4.0 / 3.0, 1.0 / 3.0].into_iter().enumerate() {
                let slope = quadratic_derivative(a as f64 - 1.0);
                let [dx, dy] = [0, 1].map(|k| (0..3).map(|b| slope[b] * nodes[b][k]).sum::<f64>());
                let force = weight * pressure(first + a);
                sum = [sum[0] + force * dx, sum[1] + force * (nodes[a][0] * dx + nodes[a][1] * dy)];
            }
        }
        sum
    };
    let fluid = |station: usize| pair.pressure(0, station * pair.levels());
    let ([wet, by_fluid], [dry, by_solid]) = (carried(0.0, &fluid), carried(1.0, &|station| contact[station].re));
    assert_relative_eq!(o.fluid_load, wet, max_relative = 1e-12);
    assert_relative_eq!(o.solid_load, dry, max_relative = 1e-12);
    assert_relative_eq!(o.load_moment, by_fluid + by_solid, max_relative = 1e-5);
    let elsewhere = carried(1.0, &fluid)[1];
    assert!((elsewhere / by_fluid - 1.0).abs() > 1e-3, "{elsewhere} {by_fluid}");
}

/// Steady: the power of the turning bones is what film, pores, friction and the moving tissue take, up to the elements' size.
#[test]
fn the_power_of_the_bones_is_accounted_for() {
    let base = coarse(Formulation::Consistent);
    for (lower, ratio) in
        [(base.upper, 0.0), (Body { outer_radius: 0.15, thickness: 1.3e-3, shear_modulus: 0.8e6, ..base.upper }, 0.4)]
    {
        let missing = [(60, 4), (120, 8)].map(|(columns, rows)| {
            let mesh = Mesh { columns, rows, ..base.mesh };
            let mut simulation = Simulation::new(&Parameters { lower, mesh, ..base }).unwrap();
            [0.0, 12.0, 28.0].map(|d| {
                simulation.solve_steady(inputs(d, U, ratio)).unwrap();
                let o = simulation.outputs();
                let taken =
                    [o.film_dissipation, o.pore_flow_dissipation, o.boundary_friction_dissipation, o.carried_power];
                let missing = 1.0 - taken.iter().sum::<f64>() / o.rotation_power;
                println!("{columns} {ratio} {d}: {} W/m, {taken:?}, missing {missing:.2e}", o.rotation_power);
                missing
            })
        });
        for (k, bound) in [1e-3, 1e-3, 3e-3].into_iter().enumerate() {
            assert!(missing[1][k].abs() < bound && missing[0][k].abs() < 0.02, "{missing:?}");
        }
    }
}

/// The same where rough surfaces slide under the load of a joint: friction works along the deformed surfaces, at the speed of tissue that is stretched
/// by a tenth and more, and the power is that of the forces and moments that are passed on to the bones. A hip's film, in which most of its work is
/// lost, lies along the arc of the undeformed surfaces.
#[test]
fn the_work_of_sliding_at_a_joint_s_load_is_accounted_for() {
    let condyle = Preset::HumanFemoralCondyle.parameters();
    let [hip, knee] = ["hip", "knee"].map(|name| {
        let file = format!("examples/{name}.toml");
        Case::load(file.as_ref()).unwrap().parameters
    });
    for (parameters, applied_load, slide_to_roll_ratio, bound) in
        [(condyle, 10e3, 0.5, 3e-3), (condyle, 50e3, 0.5, 3e-3), (knee, 30e3, 0.5, 3e-3), (hip, 30e3, 0.9, 1.2e-2)]
    {
        let mut simulation = Simulation::new(&Parameters { control: Control::Load, ..parameters }).unwrap();
        simulation
            .solve_steady(Inputs { applied_load, sliding_speed: 0.1, slide_to_roll_ratio, ..Inputs::NONE })
            .unwrap();
        let o = simulation.outputs();
        let taken = [o.film_dissipation, o.pore_flow_dissipation, o.boundary_friction_dissipation, o.carried_power];
        let missing = 1.0 - taken.iter().sum::<f64>() / o.rotation_power;
        println!("{applied_load} N/m: {} W, {taken:?}, missing {missing:.2e}", o.rotation_power);
        assert!(missing.abs() < bound && taken[0] + taken[2] > 0.9 * o.rotation_power, "{missing} {taken:?}");
        assert!(!simulation.warnings().iter().any(|warning| warning.contains("bones")), "{:?}", simulation.warnings());
    }
}

/// Exchanging the bodies turns the contact by half a turn: friction coefficients stay, and so do forces and moments on each bone.
#[test]
fn bodies_may_change_places() {
    for formulation in [Formulation::Paper, Formulation::Consistent] {
        let base = coarse(formulation);
        let lower = Body { outer_radius: 0.15, thickness: 1.3e-3, ..base.upper };
        let cases = [Parameters { lower, ..base }, Parameters { upper: lower, ..base }];
        for ratio in [0.0, 0.5, -1.0] {
            let [mut first, mut second] = cases.map(|case| Simulation::new(&case).unwrap());
            for d in PATH {
                first.solve_steady(inputs(d, U, ratio)).unwrap();
                second.solve_steady(inputs(d, U, -ratio)).unwrap();
                let (a, b) = (first.outputs(), second.outputs());
                // The paper's boundary friction goes with the sum of the speeds, whichever body is faster.
                if formulation == Formulation::Consistent || a.solid_load + b.solid_load == 0.0 {
                    assert_relative_eq!(a.load, b.load, max_relative = 1e-7);
                    assert_relative_eq!(a.friction_coefficient, b.friction_coefficient, max_relative = 1e-6);
                    assert_relative_eq!(a.upper_friction_force, -b.lower_friction_force, max_relative = 1e-5);
                    let size = a.load * a.friction_coefficient;
                    assert!((a.upper_force_x - b.lower_force_x).abs() < 1e-6 * size);
                    assert!((a.upper_moment + b.lower_moment).abs() < 1e-6 * size * 1e-3 + 1e-7 * a.load * 1e-3);
                    assert_relative_eq!(
                        a.fluid_friction_coefficient,
                        b.fluid_friction_coefficient,
                        max_relative = 1e-6
                    );
                }
            }
        }
    }
}

/// Sliding and rolling, film and contact.
#[test]
fn equation_13() {
    for formulation in [Formulation::Paper, Formulation::Consistent] {
        let parameters = coarse(formulation);
        for ratio in [0.0, 0.4] {
            let mut pair = Pair::new(&parameters, false);
            let mut simulation = Simulation::new(&parameters).unwrap();
            for d in PATH {
                pair.go(inputs(d, U, ratio));
                simulation.solve_steady(inputs(d, U, ratio)).unwrap();
                let o = simulation.outputs();
                let places = pair.interface_points();
                let beyond = pair.beyond(&parameters);
                let rolling: f64 =
                    places.iter().map(|p| p.weight * p.film_thickness.max(0.0) * p.pressure_gradient).sum::<f64>()
                        + beyond.iter().map(|end| end.shear[0]).sum::<f64>();
                let far: f64 = beyond.iter().map(|end| parameters.viscosity * ratio * U * end.shear[1]).sum();
                let shear: f64 = places
                    .iter()
                    .map(|p| {
                        p.weight * parameters.viscosity * ratio * U
                            / (p.film_thickness.max(0.0) + parameters.shear_film_offset)
                    })
                    .sum::<f64>()
                    + far;
                let boundary = pair.boundary_friction(&parameters);
                assert_relative_eq!(o.upper_friction_force - o.lower_friction_force, rolling, max_relative = 1e-6);
                let sum = o.upper_friction_force + o.lower_friction_force;
                assert_relative_eq!(sum, 2.0 * (shear + boundary), max_relative = 1e-6, epsilon = 1e-12);
                if o.solid_load == 0.0 {
                    // The film's momentum: wall shear against pressure on the slopes of the surfaces, -int p h' dx, and at the ends.
                    let last = pair.system.stations.len() - 1;
                    let at_end = |station: usize| {
                        let gap = pair.state.unknowns[pair.system.layout.gap[station] as usize];
                        gap * pair.pressure(0, station * pair.levels())
                    };
                    let slopes: f64 = places.iter().map(|p| p.weight * p.film_slope * p.pressure).sum();
                    let beyond: f64 = beyond.iter().map(|end| end.shear[0]).sum();
                    let pushed = at_end(last) - at_end(0) - slopes + beyond;
                    assert_relative_eq!(o.upper_friction_force - o.lower_friction_force, pushed, max_relative = 1e-6);
                }
            }
        }
    }
}

#[test]
fn millimetres_and_grams() {
    let si = coarse(Formulation::Consistent);
    let body = Body { outer_radius: 100.0, thickness: 1.0, permeability: 1e-9, ..si.upper };
    let scaled = Parameters {
        upper: body,
        lower: body,
        width: 1000.0,
        friction_regularisation_speed: 1.0,
        shear_film_offset: 1e-4,
        ..si
    };
    let (mut a, mut b) = (Pair::new(&si, false), Pair::new(&scaled, false));
    b.rest_at(-10e-3);
    for d in PATH {
        let now = inputs(d, U, 0.2);
        a.go(now);
        b.go(Inputs { penetration_depth: 1e3 * now.penetration_depth, sliding_speed: 1e3 * U, ..now });
    }
    assert!(a.state.active == b.state.active && a.state.active.contains(&true));
    for (p, q) in a.interface_points().iter().zip(b.interface_points()) {
        assert_relative_eq!(1e3 * p.film_thickness, q.film_thickness, max_relative = 1e-7, epsilon = 1e-12);
        assert_relative_eq!(p.pressure, q.pressure, max_relative = 1e-7, epsilon = 1e-3);
    }
    for (p, q) in a
        .state
        .contact_forces
        .iter()
        .zip(&b.state.contact_forces)
        .zip(&a.state.active)
        .filter(|(_, a)| **a)
        .map(|(f, _)| f)
    {
        assert_relative_eq!(1e3 * p, *q, max_relative = 1e-6, epsilon = 1e-6);
    }
}

/// On the automatic mesh a condyle that rolls under 10 kN/m loses a third of its power to the mesh, which is said; one under 1 kN/m 1.5 %.
#[test]
fn power_that_goes_nowhere_is_said() {
    for (applied_load, lost) in [(10e3, true), (1e3, false)] {
        let parameters = Parameters { control: Control::Load, ..Preset::HumanFemoralCondyle.parameters() };
        let mut condyle = Simulation::new(&parameters).unwrap();
        condyle.solve_steady(Inputs { applied_load, sliding_speed: U, ..Inputs::NONE }).unwrap();
        let o = condyle.outputs();
        let taken = o.film_dissipation + o.pore_flow_dissipation + o.boundary_friction_dissipation + o.carried_power;
        let said = condyle.warnings().iter().any(|warning| warning.contains("goes nowhere"));
        println!("{applied_load} N/m: {} and {taken} W, {:?}", o.rotation_power, condyle.warnings());
        assert_eq!((o.rotation_power / taken - 1.0).abs() > 0.1, lost);
        assert_eq!(said, lost);
    }
}
