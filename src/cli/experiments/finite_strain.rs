//! Dry contact of biphasic tissue at finite strain beside another program.

use cartilage_contact::error::Error;
use cartilage_contact::parameters::{Body, Inputs, Mesh, Parameters, Preset, TimeIntegration};
use cartilage_contact::simulation::{Drive, Simulation};

use super::{Row, finer};
use crate::cli::figures::experiments::{Curve, Origin, Picture};
use crate::cli::figures::panel::Scale;
use crate::cli::format;

/// Time over t^2/(k H_A) and load \[N/m\] by benches/dry_contact_ngsolve.py.
const PEER: [[f64; 2]; 7] =
    [[0.01, 9739.3], [0.02, 4521.1], [0.05, 2448.1], [0.1, 1657.5], [0.2, 1213.7], [0.5, 1079.3], [1.0, 1077.7]];

/// A curved layer pressed onto flat rigid glass by a fifth of its thickness, within a hundredth of t^2/(k H_A), and held; the film is so thin a
/// fluid that the surface is drained. Time, as above, and load.
fn pressed(parameters: &Parameters) -> Result<Vec<(f64, f64)>, Error> {
    const DEPTH: f64 = 0.3e-3;
    const CLEARANCE: f64 = 5e-6;
    const STEPS: u32 = 10;
    let body = &parameters.upper;
    let modulus = body.bulk_modulus + 4.0 / 3.0 * body.shear_modulus;
    let unit = body.thickness.powi(2) / (parameters.hydraulic_permeability(body) * modulus);
    let ramp = PEER[0][0] * unit;
    let start = Inputs { penetration_depth: -CLEARANCE, sliding_speed: 0.0, ..Inputs::NONE };
    let rates = Inputs { penetration_depth: (DEPTH + CLEARANCE) / ramp, ..Inputs::NONE };
    let mut simulation = Simulation::new(parameters)?;
    simulation.solve_steady(start)?;
    let step = ramp / f64::from(STEPS);
    for k in 0..STEPS {
        let inputs = start.combined(&rates, |value, rate| value + rate * step * f64::from(k));
        simulation.advance(Drive { inputs, rates }, step)?;
    }
    let mut states = vec![(PEER[0][0], simulation.outputs().load)];
    let held = Drive::constant(Inputs { penetration_depth: DEPTH, ..start });
    for pair in PEER.windows(2) {
        simulation.advance(held, (pair[1][0] - pair[0][0]) * unit)?;
        states.push((pair[1][0], simulation.outputs().load));
    }
    Ok(states)
}

pub(super) fn dry_contact() -> Result<Row, Error> {
    let preset = Preset::BovineHumeralHead.parameters();
    let body = Body { outer_radius: 0.05, ..preset.upper };
    let parameters = Parameters {
        upper: body,
        lower: Body { outer_radius: 0.0, ..body },
        rigid_lower: true,
        viscosity: 1e-6,
        pore_viscosity: 1e-3,
        surface_roughness: 3e-6,
        boundary_friction_loads_tissue: false,
        mesh: Mesh { columns: 48, rows: 12, ..preset.mesh },
        time_integration: TimeIntegration::Transient,
        ..preset
    };
    let states = pressed(&parameters)?;
    let finer = pressed(&finer(&parameters))?;
    let mut texts = Vec::new();
    let mut largest = 0.0_f64;
    for ((row, (_, load)), (_, other)) in PEER.iter().zip(&states).zip(&finer) {
        largest = largest.max((other / row[1] - 1.0).abs());
        texts.push(format!("{} ({})", format::number(*other, 4), format::number((other - load).abs(), 1)));
    }
    let listed = |values: Vec<String>| values.join(", ");
    Ok(Row {
        stem: "experiments_dry",
        title: "Dry contact at finite strain, by another program",
        case: "A layer of `bovine_humeral_head`, 1.5 mm thick, radius 50 mm, bonded to bone, is pressed onto flat rigid glass by 0.3 mm within a \
               hundredth of t^2/(k H_A) = 9712 s and held, drained at its surface (viscosity of the film 1e-6 Pa s, roughness 3 um). Loads in N/m at \
               0.01, 0.02, 0.05, 0.1, 0.2, 0.5 and 1 of that time, on 72 x 12 elements, in brackets the difference to 48 x 8."
            .into(),
        published: format!(
            "[benches/dry_contact_ngsolve.py](../benches/dry_contact_ngsolve.py), written for NGSolve (quadrilaterals, automatic linearisation, BDF2): {}",
            listed(PEER.iter().map(|row| format::number(row[1], 4)).collect())
        ),
        ours: listed(texts),
        verdict: format!(
            "{}: {} % apart at most; 32 x 7 elements and ten steps in place of sixteen change the peer's by 0.9 % at most.",
            if largest < 0.01 { "agreement" } else { "miss" },
            format::number(100.0 * largest, 2)
        ),
        picture: Picture {
            title: "Load of a layer on glass, held",
            axes: [("time \u{b7} k H_A / thickness\u{b2} [\u{2212}]", Scale::Logarithmic), ("load [N/m]", Scale::Logarithmic)],
            curves: vec![
                Curve { label: "NGSolve".into(), origin: Origin::Published, points: PEER.iter().map(|r| (r[0], r[1])).collect() },
                Curve { label: "ours".into(), origin: Origin::Ours, points: finer },
            ],
        },
    })
}
