//! How long a contact keeps its fluid's pressure.

use cartilage_contact::error::Error;
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Body, Inputs, Parameters};

use super::{Row, consolidation_time, falls_to, finer, load, pair, press, quick_tissue, with_bar};
use crate::cli::figures::experiments::{Curve, Origin, Picture};
use crate::cli::figures::panel::Scale;
use crate::cli::format;

/// Time until the fluid load support has fallen to half of its largest value, and the contact's half-width at that time.
fn half_life(states: &[(f64, Outputs)]) -> (f64, f64) {
    let held = &states[9..];
    let most = held.iter().map(|state| state.1.fluid_load_support).fold(0.0, f64::max);
    let supports: Vec<_> = held.iter().map(|(time, o)| (*time, o.fluid_load_support)).collect();
    let time = falls_to(0.5 * most, &supports).unwrap_or(f64::NAN);
    let width = held.iter().find(|state| state.0 >= time).map_or(f64::NAN, |state| state.1.contact_length);
    (0.5 * width, time)
}

/// Half-width and time, where layers are pressed to a depth that is held.
fn depth_held(parameters: &Parameters, radius: f64) -> Result<(f64, f64), Error> {
    let parameters = pair(Body { outer_radius: radius, ..parameters.upper }, *parameters);
    let unit = consolidation_time(&parameters);
    Ok(half_life(&press(&parameters, 30e-6, 3e-3 * unit, 4.0 * (radius / 0.1) * unit, 30)?))
}

/// Half-width and time, where the load is held: the lower stress of the experiment over a width; radii at which contacts of that
/// width end equally deep.
fn load_held(parameters: &Parameters, width: f64) -> Result<(f64, f64), Error> {
    const STRESS: f64 = 0.127e6;
    const INDENTATION: f64 = 0.3e-3;
    let parameters =
        pair(Body { outer_radius: 0.25 * width * width / (2.0 * INDENTATION), ..parameters.upper }, *parameters);
    let unit = consolidation_time(&parameters);
    let inputs = Inputs { sliding_speed: 0.0, applied_load: STRESS * width, ..Inputs::NONE };
    Ok(half_life(&load(&parameters, inputs, 3e-3 * unit, 30.0 * (width / 4e-3).powi(2) * unit, 30)?))
}

/// Carter, Basalo and Ateshian (2007).
pub(super) fn time_constant() -> Result<Row, Error> {
    const WIDTHS: [f64; 3] = [4e-3, 8e-3, 16e-3];
    const RADII: [f64; 3] = [0.05, 0.1, 0.4];
    let base = quick_tissue();
    let exponent = |[from, to]: [(f64, f64); 2]| (to.1 / from.1).ln() / (to.0 / from.0).ln();
    let loads: Vec<_> = WIDTHS.iter().map(|width| load_held(&base, *width)).collect::<Result<_, _>>()?;
    let depths: Vec<_> = RADII.iter().map(|radius| depth_held(&base, *radius)).collect::<Result<_, _>>()?;
    let rougher = Parameters { surface_roughness: 2.0 * base.surface_roughness, ..base };
    let value = exponent([loads[0], loads[2]]);
    let mut error = 0.0_f64;
    for other in [finer(&base), rougher] {
        error = error.max((exponent([load_held(&other, WIDTHS[0])?, load_held(&other, WIDTHS[2])?]) - value).abs());
    }
    let neighbours: Vec<_> = depths.windows(2).map(|pair| format::number(exponent([pair[0], pair[1]]), 2)).collect();
    let in_millimetres = |points: &[(f64, f64)]| points.iter().map(|(a, time)| (1e3 * a, *time)).collect::<Vec<_>>();
    let (first, last) = (loads[0], loads[2]);
    Ok(Row {
        stem: "experiments_time",
        title: "Time constant and contact area",
        case: "Two equal layers at rest, a thousand times as permeable as `bovine_humeral_head`, carry 0.127 MPa over 4, 8 and 16 mm, their radii \
               such that all end equally deep; time until fluid load support has fallen to half, over the contact's half-width a at that time. \
               Beside it layers of radii 0.05, 0.1 and 0.4 m that are pressed by 15 um each and held."
            .into(),
        published: "Carter, Basalo and Ateshian (2007): the time constant of friction of cartilage discs 4, 6 and 8 mm wide on glass, at \
                    0.127 and 0.254 MPa, is in proportion to their area, R^2 0.892 and 0.979: exponent 2 of the width"
            .into(),
        ours: format!(
            "load held: exponent {} of the half-width between {} and {} mm",
            with_bar((value, error)),
            format::number(1e3 * first.0, 2),
            format::number(1e3 * last.0, 2)
        ),
        verdict: format!(
            "{}: a likely reason, not tested by itself: a parabola's contact grows while its tissue drains, a disc's does not, and a free disc is \
             not expressed by a bonded layer. Where the depth is held in place of the load the power \
             falls from neighbour to neighbour, {}. That is the theory of a thin bonded layer: of a pressure with wave number q the time \
             constant is t^2/(3 G k (1 + L t^2 q^2/(3 G))), L = K - 2G/3, at a held depth, which for wide contacts does not depend on the width (fluid \
             and solid spread together, against the bond), and 1/(k q^2 (L + 2 G/(1 + 2 t^2 q^2/3))) under a held load, in proportion to the \
             width's square",
            if (value - 2.0).abs() < error.max(0.2) { "agreement" } else { "miss" },
            neighbours.join(", ")
        ) + ".",
        picture: Picture {
            title: "Time until half of fluid load support is gone",
            axes: [("half-width a [mm]", Scale::Logarithmic), ("time [s]", Scale::Logarithmic)],
            curves: vec![
                Curve {
                    label: "a\u{b2}, Carter et al.".into(),
                    origin: Origin::Published,
                    points: loads.iter().map(|(a, _)| (1e3 * a, first.1 * (a / first.0).powi(2))).collect(),
                },
                Curve { label: "ours, load held".into(), origin: Origin::Ours, points: in_millimetres(&loads) },
                Curve { label: "ours, depth held".into(), origin: Origin::Variant, points: in_millimetres(&depths) },
            ],
        },
    })
}
