//! `cartilage-contact validate experiments`: what others measured or computed beside what the program finds; docs/experiments.md has
//! the same text. Nothing is fitted: tissues are presets, whose numbers come from other tests.

mod compression;
mod finite_strain;
mod friction;
mod joints;
mod layers;
mod relaxation;
mod rolling;

use std::path::Path;
use std::time::Instant;

use cartilage_contact::error::Error;
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Body, Control, Inputs, Mesh, Parameters, Preset, TimeIntegration};
use cartilage_contact::simulation::{Drive, Simulation};

use super::figures::experiments::{self, Picture};
use super::{Failure, format};

/// One comparison.
struct Row {
    /// Name of its picture's file.
    stem: &'static str,
    title: &'static str,
    case: String,
    published: String,
    ours: String,
    verdict: String,
    picture: Picture,
}

type Compare = fn() -> Result<Row, Error>;

/// The rows, by the name that `--row` takes.
const ROWS: [(&str, Compare); 10] = [
    ("undrained", layers::undrained),
    ("support", layers::pressed_at_rest),
    ("finite-strain", finite_strain::dry_contact),
    ("time-constant", relaxation::time_constant),
    ("friction", friction::on_glass),
    ("peclet", rolling::peclet),
    ("glass", compression::bovine_head_on_glass),
    ("patellofemoral", compression::human_patellofemoral_joint),
    ("ankle", joints::ankle),
    ("hip", joints::hip),
];

/// Compares all rows or the one of this name, writes their pictures into the folder and returns the Markdown.
pub fn run(folder: &Path, only: Option<&str>) -> Result<String, Failure> {
    if let Some(name) = only.filter(|name| ROWS.iter().all(|row| row.0 != *name)) {
        let names: Vec<_> = ROWS.iter().map(|row| row.0).collect();
        return Err(Error::value("--row", name, format!("one of {}", names.join(", "))).into());
    }
    std::fs::create_dir_all(folder).map_err(|error| Error::File {
        path: folder.display().to_string(),
        message: format!("could not make the folder of the pictures: {error}"),
    })?;
    let start = Instant::now();
    let results: Vec<_> = std::thread::scope(|scope| {
        let timed = |(name, row): (&'static str, Compare)| {
            let result = row();
            eprintln!("{name}: after {:.0} s", start.elapsed().as_secs_f64());
            (name, result)
        };
        let chosen = ROWS.into_iter().filter(|row| only.is_none_or(|name| row.0 == name));
        let threads: Vec<_> = chosen.map(|row| scope.spawn(move || timed(row))).collect();
        threads.into_iter().filter_map(|thread| thread.join().ok()).collect()
    });
    let mut table = "| comparison | published | ours | verdict |\n|---|---|---|---|\n".to_owned();
    let mut sections = String::new();
    for (name, result) in results {
        let Row { stem, title, case, published, ours, verdict, picture } = match result {
            Ok(row) => row,
            Err(error) => {
                table += &format!("| {name} | | not computed | {error} |\n");
                continue;
            }
        };
        experiments::save(&folder.join(stem), &picture)?;
        let short = verdict.split([':', '.']).next().unwrap_or_default();
        table += &format!("| {title} | {published} | {ours} | {short} |\n");
        sections += &format!(
            "\n## {title}\n\n![{}]({stem}.png)\n\n**Case.** {case}\n\n**Published.** {published}\n\n**Ours.** {ours}\n\n**Verdict.** {verdict}\n",
            picture.title
        );
    }
    Ok(table + &sections)
}

/// Both bodies with this tissue.
fn pair(body: Body, parameters: Parameters) -> Parameters {
    Parameters { upper: body, lower: body, ..parameters }
}

/// The calf's humeral head, in time, with a thousand times the permeability: what counts is time over thickness^2/(k H_A), which is
/// then ten seconds in place of hours.
fn quick_tissue() -> Parameters {
    let preset = Preset::BovineHumeralHead.parameters();
    let mesh = Mesh { columns: 48, rows: 6, ..preset.mesh };
    pair(
        Body { permeability: 1e3 * preset.upper.permeability, ..preset.upper },
        Parameters { mesh, time_integration: TimeIntegration::Transient, relative_tolerance: 3e-3, ..preset },
    )
}

/// t^2/(k H_A) \[s\].
fn consolidation_time(parameters: &Parameters) -> f64 {
    let body = &parameters.upper;
    let modulus = body.bulk_modulus + 4.0 / 3.0 * body.shear_modulus;
    body.thickness.powi(2) * parameters.viscosity / (body.permeability * modulus)
}

/// A value on the mesh of the case, with mesh, sector and the law of rough contact varied: value and largest difference to it.
fn with_error(
    parameters: &Parameters,
    half_width: f64,
    measure: impl Fn(&Parameters) -> Result<f64, Error>,
) -> Result<(f64, f64), Error> {
    let value = measure(parameters)?;
    let rougher = Parameters { surface_roughness: 2.0 * parameters.surface_roughness, ..*parameters };
    let stiffer = Parameters { core_pressure: 2.0 * parameters.core_pressure, ..*parameters };
    let mut largest = 0.0_f64;
    for variant in [finer(parameters), wider(parameters, half_width), rougher, stiffer] {
        largest = largest.max((measure(&variant)? - value).abs());
    }
    Ok((value, largest))
}

/// On a mesh that is one and a half times finer.
fn finer(parameters: &Parameters) -> Parameters {
    let [columns, rows] = parameters.elements();
    let mesh = Mesh { columns: columns * 3 / 2, rows: rows * 3 / 2, ..parameters.mesh };
    Parameters { mesh, ..*parameters }
}

/// On a sector that is 1.4 times wider, with as many columns more.
fn wider(parameters: &Parameters, half_width: f64) -> Parameters {
    let [columns, _] = parameters.elements();
    Parameters {
        sector_half_angle: (1.4 * half_width / parameters.upper.outer_radius).asin(),
        mesh: Mesh { columns: columns * 3 / 2, ..parameters.mesh },
        ..*parameters
    }
}

fn with_bar((value, error): (f64, f64)) -> String {
    format!("{} +- {}", format::number(value, 3), format::number(error, 2))
}

/// Goes from one state to another within some time, in ten steps, and stays there until `end`, in steps that grow; the states on the way.
fn ramp_and_hold(
    parameters: &Parameters,
    [from, to]: [Inputs; 2],
    ramp: f64,
    end: f64,
    steps: usize,
) -> Result<Vec<(f64, Outputs)>, Error> {
    const RAMP: usize = 10;
    let duration = ramp / RAMP as f64;
    let rates = from.combined(&to, |from, to| (to - from) / ramp);
    let mut simulation = Simulation::new(parameters)?;
    simulation.solve_steady(from)?;
    let mut states = Vec::new();
    for step in 0..RAMP {
        let inputs = from.combined(&rates, |value, rate| value + rate * duration * step as f64);
        simulation.advance(Drive { inputs, rates }, duration)?;
        states.push((duration * (step + 1) as f64, simulation.outputs().clone()));
    }
    let ratio = (end / ramp).powf(1.0 / steps as f64);
    let mut time = ramp;
    for _ in 0..steps {
        simulation.advance(Drive::constant(to), time * (ratio - 1.0))?;
        time *= ratio;
        states.push((time, simulation.outputs().clone()));
    }
    Ok(states)
}

/// Presses at rest from a clearance to a depth.
fn press(parameters: &Parameters, depth: f64, ramp: f64, end: f64, steps: usize) -> Result<Vec<(f64, Outputs)>, Error> {
    const CLEARANCE: f64 = 2e-6;
    let start = Inputs { penetration_depth: -CLEARANCE, sliding_speed: 0.0, ..Inputs::NONE };
    ramp_and_hold(parameters, [start, Inputs { penetration_depth: depth, ..start }], ramp, end, steps)
}

/// Loads from a fiftieth of the load, which is steady.
fn load(
    parameters: &Parameters,
    inputs: Inputs,
    ramp: f64,
    end: f64,
    steps: usize,
) -> Result<Vec<(f64, Outputs)>, Error> {
    let parameters = Parameters { control: Control::Load, ..*parameters };
    let start = Inputs { applied_load: 0.02 * inputs.applied_load, ..inputs };
    ramp_and_hold(&parameters, [start, inputs], ramp, end, steps)
}

/// Where a falling curve passes a level: x between two of its points, as a logarithm.
fn falls_to(level: f64, curve: &[(f64, f64)]) -> Option<f64> {
    curve.windows(2).find(|pair| pair[1].1 < level).map(|pair| {
        let part = (pair[0].1 - level) / (pair[0].1 - pair[1].1);
        pair[0].0 * (pair[1].0 / pair[0].0).powf(part)
    })
}

fn verdict(agrees: bool, why: &str) -> String {
    format!("{}: {why}.", if agrees { "agreement" } else { "miss" })
}
