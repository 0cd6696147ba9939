//! Undrained layers: what a bonded layer carries, and how much of that its fluid.

use cartilage_contact::error::Error;
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Body, Inputs, Mesh, Parameters, Preset};
use cartilage_contact::simulation::Simulation;

use super::{Row, consolidation_time, pair, press, quick_tissue, verdict, with_bar, with_error};
use crate::cli::figures::experiments::{Curve, Origin, Picture};
use crate::cli::figures::panel::Scale;
use crate::cli::format;

/// The bonded incompressible layer, as fast as possible: nothing drains.
pub(super) fn undrained() -> Result<Row, Error> {
    let preset = Preset::BovineHumeralHead.parameters();
    let mesh = Mesh { columns: 64, rows: 8, ..preset.mesh };
    let (radius, thickness, modulus) = (1.0, 5e-3, preset.upper.shear_modulus);
    let body = Body { outer_radius: radius, thickness, permeability: 1e-24, ..preset.upper };
    let parameters = pair(body, Parameters { viscosity: 1e-4, mesh, ..preset });
    // a/t, W R/(G a^2) and the power of the depth with which it rises, delta R/a^2
    const TABLE: [[f64; 4]; 2] = [[1.0, 5.9807, 1.93, 0.4384], [2.0, 12.72, 2.03, 0.3323]];
    let carried = |parameters: &Parameters, [ratio, _, power, depth]: [f64; 4]| {
        let a = ratio * thickness;
        let depth = 2.0 * depth * a * a / radius;
        let mut simulation = Simulation::new(parameters)?;
        simulation.solve_steady(Inputs { penetration_depth: depth, sliding_speed: 0.2, ..Inputs::NONE })?;
        let outputs = simulation.outputs();
        let indented: f64 = 1.0 + outputs.central_film_thickness / depth;
        Ok::<_, Error>((outputs.load * radius / (modulus * a * a) / indented.powf(power), outputs.mesh_half_width))
    };
    let mut points = Vec::new();
    let mut ours = Vec::new();
    for row in TABLE {
        let (value, half_width) = carried(&parameters, row)?;
        points.push((row[0], value));
        let result = with_error(&parameters, half_width, |parameters| Ok(carried(parameters, row)?.0))?;
        ours.push((row, result));
    }
    let agrees = ours.iter().all(|(row, (value, error))| (value - row[1]).abs() < error.max(0.01 * row[1]));
    let text: Vec<_> = ours.iter().map(|(row, result)| format!("{} at a/t = {}", with_bar(*result), row[0])).collect();
    Ok(Row {
        stem: "experiments_undrained",
        title: "Undrained layer under a parabola",
        case: format!(
            "Two layers of shear modulus {} MPa roll at 0.2 m/s with a permeability of 1e-24 m^2, so that no fluid moves in them; depth of the \
             table's contact half-width a over thickness t. The film's thickness is part of the indentation.",
            format::number(1e-6 * modulus, 3)
        ),
        published: "W R/(G a^2) = 5.98 at a/t = 1, 12.72 at a/t = 2 (bonded layer, Poisson's ratio 1/2: Meijers 1968, Jaffar 1989, computed)".into(),
        ours: text.join(", "),
        verdict: verdict(agrees, "the limit of vanishing permeability is that of an incompressible layer"),
        picture: Picture {
            title: "Load of an undrained layer",
            axes: [("contact half-width a over thickness t [\u{2212}]", Scale::Linear), ("load W R/(G a\u{b2}) [\u{2212}]", Scale::Linear)],
            curves: vec![
                Curve {
                    label: "bonded layer".into(),
                    origin: Origin::Published,
                    points: TABLE.iter().map(|row| (row[0], row[1])).collect(),
                },
                Curve { label: "ours".into(), origin: Origin::Ours, points },
            ],
        },
    })
}

/// What the fluid carries of a parabolic pressure on a bonded layer before anything drains. Where a pressure cos(q x) presses an
/// incompressible layer without shear, the solid has 2 Q^2/(cosh 2Q + 1 + 2 Q^2) of it at the surface, Q = q t: the layer below is
/// pressed flat and spreads, at the surface most. Summed over the contact, ratio = a/t.
fn undrained_support(ratio: f64) -> f64 {
    const STEP: f64 = 0.01;
    let solid = |z: f64| {
        let q = z / ratio;
        2.0 * q * q / ((2.0 * q).cosh() + 1.0 + 2.0 * q * q) * (z.sin() - z * z.cos()) * z.sin() / z.powi(4)
    };
    let end = (40.0 * ratio / STEP) as usize;
    1.0 - 6.0 / std::f64::consts::PI * STEP * (0..end).map(|i| solid((i as f64 + 0.5) * STEP)).sum::<f64>()
}

/// Kelkar and Ateshian (1999).
pub(super) fn pressed_at_rest() -> Result<Row, Error> {
    let parameters = quick_tissue();
    let unit = consolidation_time(&parameters);
    let last = |parameters: &Parameters, [radius, depth]: [f64; 2]| {
        let body = Body { outer_radius: radius, ..parameters.upper };
        let states = press(&pair(body, *parameters), depth, 3e-3 * unit, 2e-2 * unit, 8)?;
        Ok::<_, Error>(states.last().map(|state| state.1.clone()).unwrap_or_default())
    };
    let mut points = Vec::new();
    let mut widest = Outputs::default();
    const CASES: [[f64; 2]; 5] = [[0.1, 40e-6], [0.1, 120e-6], [0.1, 300e-6], [0.4, 120e-6], [0.4, 300e-6]];
    for case in CASES {
        let outputs = last(&parameters, case)?;
        points.push((0.5 * outputs.contact_length / parameters.upper.thickness, outputs.fluid_load_support));
        widest = outputs;
    }
    let result = with_error(
        &pair(Body { outer_radius: 0.4, ..parameters.upper }, parameters),
        widest.mesh_half_width,
        |parameters| Ok(last(parameters, CASES[CASES.len() - 1])?.fluid_load_support),
    )?;
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let rises = points.windows(2).all(|pair| pair[1].1 > pair[0].1);
    let (widest, most) = points[points.len() - 1];
    let from_theory =
        points.iter().map(|(ratio, support)| (support - undrained_support(*ratio)).abs()).fold(0.0, f64::max);
    let theory = (1..=80).map(|i| 0.1 * f64::from(i)).filter(|ratio| *ratio <= widest.max(6.0));
    Ok(Row {
        stem: "experiments_support",
        title: "Fluid load support after a fast press",
        case: format!(
            "Two equal layers at rest (moduli and thickness of `bovine_humeral_head`, radius 0.1 and 0.4 m) are pressed within 0.3 % of \
             t^2/(k H_A) = {} s and held until 2 % of it; depths 40 to 300 um.",
            format::number(unit, 3)
        ),
        published: "Kelkar and Ateshian (1999): under a step load the fluid supports upward of 96 % in more congruent joints, two equal \
                    cylindrical layers without film (abstract); the support rises to 1 with a/t"
            .into(),
        ours: format!(
            "{} at a/t = {}, {} with a/t from {}",
            with_bar(result),
            format::number(widest, 2),
            if rises { "rising" } else { "not rising" },
            format::number(points[0].0, 2)
        ),
        verdict: verdict(
            rises && most + result.1 > 0.96,
            &format!(
                "an undrained layer says the same. By its closed form (dashed) the support is 1 for narrow contacts too, least (0.80) where the contact \
                 is as wide as two thicknesses, 0.94 at a/t = 4 and 0.96 at 5.4, since the surface of a bonded layer spreads where it \
                 is pressed flat; our values differ from it by {} at most. Rough surfaces take the pressure of that solid part and add nothing to it: \
                 asperities and core a hundred times softer changed the support by 0.006 at a/t = 1.6 and by 0.001 at 2.6",
                format::number(from_theory, 2)
            ),
        ),
        picture: Picture {
            title: "Fluid load support after a fast press",
            axes: [("contact half-width a over thickness t [\u{2212}]", Scale::Linear), ("fluid load support [\u{2212}]", Scale::Linear)],
            curves: vec![
                Curve {
                    label: "undrained layer".into(),
                    origin: Origin::Published,
                    points: theory.map(|ratio| (ratio, undrained_support(ratio))).collect(),
                },
                Curve {
                    label: "0.96, Kelkar and Ateshian".into(),
                    origin: Origin::Variant,
                    points: vec![(0.0, 0.96), (widest.max(6.0), 0.96)],
                },
                Curve { label: "ours".into(), origin: Origin::Ours, points },
            ],
        },
    })
}
