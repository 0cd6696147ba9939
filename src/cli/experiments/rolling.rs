//! Fluid load support over the Peclet number.

use cartilage_contact::error::Error;
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Body, Inputs, Mesh, Parameters, Preset};
use cartilage_contact::simulation::Simulation;

use super::{Row, pair, with_bar, with_error};
use crate::cli::figures::experiments::{Curve, Origin, Picture};
use crate::cli::figures::panel::Scale;
use crate::cli::format;

/// Moore and Burris (2014).
pub(super) fn peclet() -> Result<Row, Error> {
    let preset = Preset::BovineHumeralHead.parameters();
    let mesh = Mesh { columns: 48, rows: 6, ..preset.mesh };
    let body = Body { permeability: 1e3 * preset.upper.permeability, ..preset.upper };
    let base = pair(body, Parameters { mesh, ..preset });
    const SPEEDS: [f64; 9] = [4e-6, 1.2e-5, 4e-5, 1.2e-4, 4e-4, 1.2e-3, 4e-3, 1.2e-2, 4e-2];
    let sweep = |parameters: &Parameters| {
        let mut simulation = Simulation::new(parameters)?;
        let mut states: Vec<(f64, f64, f64, Outputs)> = Vec::new();
        for sliding_speed in SPEEDS {
            simulation.solve_steady(Inputs { penetration_depth: 50e-6, sliding_speed, ..Inputs::NONE })?;
            let (x, p) = (simulation.position(), &simulation.outputs().fluid_pressure);
            let pushing: f64 = x
                .windows(2)
                .zip(p.windows(2))
                .map(|(x, p)| 0.5 * (x[1] - x[0]) * (p[0].max(0.0) + p[1].max(0.0)))
                .sum();
            let outputs = simulation.outputs();
            states.push((sliding_speed, outputs.fluid_load_support, pushing / outputs.load, outputs.clone()));
        }
        Ok::<_, Error>(states)
    };
    let states = sweep(&base)?;
    let slope = |states: &[(f64, f64, f64, Outputs)], pushing: bool| {
        let value = |i: usize| if pushing { states[i].2 } else { states[i].1 };
        (value(2) / value(1)).ln() / (states[2].0 / states[1].0).ln()
    };
    let half_width = states[0].3.mesh_half_width;
    let pushing = with_error(&base, half_width, |parameters| Ok(slope(&sweep(parameters)?, true)))?;
    let net = with_error(&base, half_width, |parameters| Ok(slope(&sweep(parameters)?, false)))?;
    // Smooth surfaces whose film cavitates where it would pull: with roughness such a film is not modelled.
    let cavitating = Parameters { surface_roughness: 0.0, cavitation: true, cavitation_pressure: 0.0, ..base };
    let without_suction = sweep(&cavitating)?;
    let linear = with_error(&cavitating, half_width, |parameters| Ok(slope(&sweep(parameters)?, false)))?;
    let modulus = body.bulk_modulus + 4.0 / 3.0 * body.shear_modulus;
    let a = 0.5 * states[0].3.contact_length;
    let number = |speed: f64| 0.5 * speed * a * base.viscosity / (body.permeability * modulus);
    let curve = states.iter().map(|s| (number(s.0), s.1)).collect();
    Ok(Row {
        stem: "experiments_peclet",
        title: "Fluid load support over the Peclet number",
        case: format!(
            "Two equal layers (`bovine_humeral_head` with a thousand times its permeability) roll at a depth of 50 um, steady, at 4e-6 to \
             0.04 m/s; Pe = v a/(k H_A) with the surface speed v and a = {} mm.",
            format::number(1e3 * a, 3)
        ),
        published: "Moore and Burris (2014, PMC3889488): interstitial lubrication takes a large Peclet number (abstract); their model, as \
                    quoted, has the fraction Pe/(Pe + 1) of its limit, in proportion to Pe where that is small"
            .into(),
        ours: format!(
            "rises with Pe to the power {}; where the film cannot pull, to the power {}; {} at the highest speed",
            with_bar(net),
            with_bar(linear),
            format::number(states[states.len() - 1].1, 3)
        ),
        verdict: format!(
            "{}. A full film pulls: at small Pe the pressure is odd in x, above zero where tissue is squeezed on its way in and as much below \
             where it swells on its way out (k p'' = v dJ/dx, and J is even in x), and what it carries is of second order; the pressures \
             above zero alone rise with the power {}. Their model counts the half that pushes. With a film that cavitates at ambient \
             pressure (`cavitation`, smooth surfaces) that half is all there is, and the power is theirs.",
            if (linear.0 - 1.0).abs() < 0.1 { "agreement without suction, miss with it" } else { "miss" },
            with_bar(pushing)
        ),
        picture: Picture {
            title: "Fluid load support of rolling layers",
            axes: [("P\u{e9}clet number Pe [\u{2212}]", Scale::Logarithmic), ("fluid load support [\u{2212}]", Scale::Logarithmic)],
            curves: vec![
                Curve {
                    label: "Pe/(Pe + 1), Moore and Burris".into(),
                    origin: Origin::Published,
                    points: states.iter().map(|s| number(s.0)).map(|pe| (pe, pe / (pe + 1.0))).collect(),
                },
                Curve { label: "ours".into(), origin: Origin::Ours, points: curve },
                Curve {
                    label: "ours, no suction".into(),
                    origin: Origin::Variant,
                    points: without_suction.iter().map(|s| (number(s.0), s.1)).collect(),
                },
            ],
        },
    })
}
