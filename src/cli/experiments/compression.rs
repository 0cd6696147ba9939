//! How far fast loading compresses a layer, isotropic and with fibres.

use cartilage_contact::equations::grid;
use cartilage_contact::error::Error;
use cartilage_contact::parameters::{Body, Control, Inputs, Mesh, Parameters, Preset};
use cartilage_contact::simulation::Simulation;

use super::{Row, finer, pair, with_bar};
use crate::cli::figures::experiments::{Curve, Origin, Picture};
use crate::cli::figures::panel::Scale;
use crate::cli::format;

/// What was measured: mean contact stress \[Pa\] and least and largest compression \[%\].
struct Measured {
    stress: f64,
    compression: [f64; 2],
}

/// The preset's layer, pressed onto its mirror image.
fn layer(preset: Preset) -> Parameters {
    let preset = preset.parameters();
    let body = Body { outer_radius: 0.025, ..preset.upper };
    pair(body, Parameters { mesh: Mesh { columns: 48, rows: 6, ..preset.mesh }, control: Control::Load, ..preset })
}

/// Mean pressure over the contact \[MPa\] and compression in its middle \[%\] at rising loads, until the pressure is reached or no further
/// state is found. In motion fresh tissue is pressed within a/v = 0.1 s and drains no deeper than sqrt(k H_A a/v), some micron.
fn pressed(parameters: &Parameters, stress: f64) -> Result<Vec<(f64, f64)>, Error> {
    let mut simulation = Simulation::new(parameters)?;
    let mut states: Vec<(f64, f64)> = Vec::new();
    let mut load = 100.0;
    while states.last().is_none_or(|state| state.0 < 1e-6 * stress) && load < 2e5 {
        let inputs = Inputs { sliding_speed: 0.05, applied_load: load, ..Inputs::NONE };
        if simulation.solve_steady(inputs).is_err() {
            break;
        }
        let o = simulation.outputs();
        let inputs = Inputs { penetration_depth: o.penetration_depth, ..inputs };
        let a = grid::contact_half_width(parameters, &inputs, Control::Depth);
        let depth = o.penetration_depth + o.central_film_thickness;
        states.push((1e-6 * load / (2.0 * a), 50.0 * depth / parameters.upper.thickness));
        load *= 1.25;
    }
    Ok(states)
}

fn at_stress(states: &[(f64, f64)], stress: f64) -> Option<f64> {
    states.windows(2).find(|pair| pair[1].0 >= stress).map(|pair| {
        let part = (stress - pair[0].0) / (pair[1].0 - pair[0].0);
        pair[0].1 + part * (pair[1].1 - pair[0].1)
    })
}

/// Both tissues: text, whether one of them is within what was measured, and the curves.
fn compare(measured: &Measured, presets: [Preset; 2]) -> Result<(String, bool, Vec<Curve>), Error> {
    let stress = 1e-6 * measured.stress;
    let [least, most] = measured.compression;
    let mut curves = vec![Curve {
        label: format!("{least} to {most} %"),
        origin: Origin::Published,
        points: vec![(stress, least), (stress, most)],
    }];
    let (mut texts, mut agrees) = (Vec::new(), false);
    for (preset, (name, origin)) in
        presets.into_iter().zip([("isotropic", Origin::Ours), ("with fibres", Origin::Variant)])
    {
        let parameters = layer(preset);
        let states = pressed(&parameters, measured.stress)?;
        let finer = pressed(&finer(&parameters), measured.stress)?;
        texts.push(match (at_stress(&states, stress), at_stress(&finer, stress), states.last()) {
            (Some(strain), Some(other), _) => {
                agrees |= (least..=most).contains(&strain);
                format!("{name} {} %", with_bar((strain, (strain - other).abs())))
            }
            (Some(strain), None, _) => format!("{name} {} %", format::number(strain, 3)),
            (None, _, Some((pressure, strain))) => format!(
                "{name} {} % at {} MPa, where the last solution is",
                format::number(*strain, 3),
                format::number(*pressure, 2)
            ),
            (None, _, None) => format!("{name} not solved"),
        });
        curves.push(Curve { label: name.into(), origin, points: states });
    }
    Ok((texts.join(", "), agrees, curves))
}

const WHY: &str = "Isotropic tissue is too soft in fast loading, as is known, and fibres that were measured in tension make it several times \
                   stiffer; a line contact of one radius stands for a surface in three dimensions, and the radius is assumed.";

/// PMC2633100: bovine humeral heads pressed on glass. By symmetry one of two equal layers is a layer on smooth glass.
pub(super) fn bovine_head_on_glass() -> Result<Row, Error> {
    let measured = Measured { stress: 1.7e6, compression: [7.2, 13.6] };
    let (ours, agrees, curves) = compare(&measured, [Preset::BovineHumeralHead, Preset::BovineHumeralHeadFibres])?;
    Ok(Row {
        stem: "experiments_glass",
        title: "Compression of a bovine humeral head on glass",
        case: "A layer of `bovine_humeral_head`, 1.5 mm thick, without and with fibres, on a radius of 25 mm (not given in the abstract), \
               against its mirror image, rolling at 0.05 m/s so that fresh tissue is pressed and does not drain, as in their 5 s; compression of the \
               layer in the middle over the mean pressure."
            .into(),
        published: "PMC2633100: 12 bovine humeral heads on glass, 5 s, mean contact stress about 1.7 MPa: thickness -10.4 +- 3.2 %".into(),
        ours,
        verdict: format!("{}: on either side of the measurement. {WHY}", if agrees { "agreement" } else { "miss" }),
        picture: Picture {
            title: "Compression of the layer",
            axes: [("mean pressure [MPa]", Scale::Linear), ("compression [%]", Scale::Linear)],
            curves,
        },
    })
}

/// PMC2980285: human patellofemoral joints.
pub(super) fn human_patellofemoral_joint() -> Result<Row, Error> {
    let measured = Measured { stress: 3.3e6, compression: [3.4, 12.0] };
    let (ours, agrees, curves) = compare(&measured, [Preset::HumanFemoralCondyle, Preset::HumanFemoralCondyleFibres])?;
    Ok(Row {
        stem: "experiments_patellofemoral",
        title: "Compression in the human patellofemoral joint",
        case: "Two equal layers of `human_femoral_condyle`, without and with fibres (whose tensile modulus is assumed, not measured), 2.3 mm thick on \
               radii of 25 mm (not given in the abstract), rolling at 0.05 m/s so that nothing drains, as in their 0.5 s."
            .into(),
        published: "PMC2980285: six human joints, 0.5 s, mean contact stress about 3.3 MPa: thickness of the patella's layer -9.0 +- 3.0 %, \
                    of the femur's -7.2 +- 3.8 %"
            .into(),
        ours,
        verdict: format!(
            "{}{WHY} Patellar cartilage is thicker, and its joint fits more closely.",
            if agrees { "agreement with fibres, miss without: " } else { "miss: " }
        ),
        picture: Picture {
            title: "Compression of the layers",
            axes: [("mean pressure [MPa]", Scale::Linear), ("compression [%]", Scale::Linear)],
            curves,
        },
    })
}
