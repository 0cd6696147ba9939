//! What the program does without arguments: builds the FMU, presses two layers together with it and lets go.

use std::path::Path;

use cartilage_contact::error::Error;
use cartilage_contact::fields::InterfaceFields;
use cartilage_contact::files;
use cartilage_contact::fmi::archive;
use cartilage_contact::fmi::importer::Importer;
use cartilage_contact::outputs::Regime;
use cartilage_contact::parameters::{Inputs, Parameters};
use cartilage_contact::simulation::Simulation;
use cartilage_contact::variables::{self, Type};
use indicatif::{ProgressBar, ProgressStyle};

use super::figures::press_and_release::{Film, Profile};
use super::{Failure, figures, format, package, print};

/// Clearance at the start, and depth at the end of pressing, in steps of a micron.
const FIRST: i32 = -10;
const LAST: i32 = 30;
/// Seconds that a micron takes. Slow enough for the steady states that the FMU computes.
const STEP: f64 = 1.0;
/// Sliding speed \[m/s\].
const SPEED: f64 = 0.2;
/// Depths whose profiles are drawn [micron]: undeformed surfaces that just touch, nearly solid contact, solid contact.
const PROFILED: [i32; 3] = [0, 12, 30];
/// Depths of the table that is printed [micron].
const PRINTED: [i32; 9] = [-10, -5, 0, 5, 10, 12, 13, 20, 30];

/// Everything that was recorded, one row a communication point.
struct Recording {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
    regimes: Vec<&'static str>,
    profiles: Vec<Profile>,
}

impl Recording {
    fn column(&self, name: &str) -> Vec<f64> {
        let index = self.names.iter().position(|column| column == name);
        self.rows.iter().map(|row| index.map_or(f64::NAN, |index| row[index])).collect()
    }
}

/// Builds, runs, prints, writes.
pub fn run() -> Result<(), Failure> {
    let fmu = Path::new(package::DEFAULT_OUTPUT);
    for path in package::package(&[], None, fmu)? {
        let size = std::fs::metadata(&path).map_or(0, |data| data.len());
        print(&format!("Built {} ({:.1} MB)\n", path.display(), size as f64 / 1e6))?;
    }

    let recording = record(&archive::outputs(fmu)[1]).map_err(Failure::Failed)?;
    print(&table(&recording))?;

    let stem = fmu.with_file_name("press_and_release");
    let csv = stem.with_extension("csv");
    files::replace(&csv, &to_csv(&recording).map_err(|error| files::unwritten(&csv, error))?)?;
    format::write_units(&csv, recording.names.iter().map(String::as_str).chain(["lubrication_regime"]))?;
    let film = Film {
        time: recording.column("time"),
        depth: recording.column("penetration_depth"),
        load: recording.column("load"),
        fluid_load: recording.column("fluid_load"),
        solid_load: recording.column("solid_load"),
        friction: recording.column("friction_coefficient"),
        fluid_friction: recording.column("fluid_friction_coefficient"),
        minimum_film: recording.column("minimum_film_thickness"),
        central_film: recording.column("central_film_thickness"),
        contact_length: recording.column("contact_length"),
        profiles: recording.profiles,
    };
    let [svg, png, pdf] = figures::press_and_release::save(&stem, &film)?;
    print(&format!("\nWrote {}, {}, {} and {}\n", csv.display(), svg.display(), png.display(), pdf.display()))
}

/// Drives the FMU through its C interface.
fn record(fmu: &Path) -> Result<Recording, String> {
    let scalars = |wanted: Type| variables::scalar_outputs().filter(move |row| row.data_type() == wanted);
    let inputs = ["penetration_depth", "sliding_speed", "slide_to_roll_ratio"].map(str::to_owned);
    let reals: Vec<String> = inputs.into_iter().chain(scalars(Type::Real).map(|row| row.name.to_owned())).collect();
    let integers: Vec<String> = scalars(Type::Integer).map(|row| row.name.to_owned()).collect();
    let booleans: Vec<String> = scalars(Type::Boolean).map(|row| row.name.to_owned()).collect();
    let depths: Vec<i32> = (FIRST..=LAST).chain((FIRST..LAST).rev()).collect();

    let importer = Importer::open(fmu)?;
    let mut recording = Recording {
        names: std::iter::once("time".to_owned())
            .chain(reals.iter().cloned())
            .chain(integers.iter().cloned())
            .chain(booleans.iter().cloned())
            .collect(),
        rows: Vec::new(),
        regimes: Vec::new(),
        profiles: Vec::new(),
    };
    let bar = ProgressBar::new(depths.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("{msg} {bar:40} {pos}/{len} steps, {eta} left") {
        bar.set_style(style);
    }
    // Drawn again with every state: a clock of its own would be a thread, and the program ends where the system refuses one.
    bar.tick();

    for (index, &depth) in depths.iter().enumerate() {
        bar.set_message(format!(
            "{} at {depth:3} um",
            if index as i32 <= LAST - FIRST { "Pressing" } else { "Releasing" }
        ));
        let metres = f64::from(depth) * 1e-6;
        let time = index as f64 * STEP;
        let result = if index == 0 {
            let stop = (depths.len() - 1) as f64 * STEP;
            importer.start(stop, &[("penetration_depth", metres), ("sliding_speed", SPEED)])
        } else {
            importer.set(&[("penetration_depth", metres)]).and_then(|()| importer.step(time - STEP, STEP))
        };
        result.map_err(|error| format!("the FMU stopped at a penetration depth of {depth} um: {error}"))?;

        let mut row = vec![time];
        for name in &reals {
            row.push(importer.real(name)?);
        }
        for name in &integers {
            row.push(f64::from(importer.integer(name)?));
        }
        for name in &booleans {
            row.push(f64::from(u8::from(importer.boolean(name)?)));
        }
        recording.rows.push(row);
        let regime = importer.enumeration("lubrication_regime")?;
        let regime = usize::try_from(regime - 1).ok().and_then(|index| Regime::ITEMS.get(index));
        recording.regimes.push(regime.map_or("unknown", |(name, _)| name));
        if index as i32 <= LAST - FIRST && PROFILED.contains(&depth) {
            recording.profiles.push(profile(metres, time).map_err(|error| error.to_string())?);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(recording)
}

/// At the nodes of the mesh, which the FMU's stations are too few to show.
fn profile(depth: f64, time: f64) -> Result<Profile, Error> {
    let mut simulation = Simulation::new(&Parameters::default())?;
    simulation.solve_steady(Inputs { penetration_depth: depth, sliding_speed: SPEED, ..Inputs::default() })?;
    let InterfaceFields { position, film_thickness, fluid_pressure, contact_pressure, .. } =
        simulation.fields().map(|fields| fields.interface).unwrap_or_default();
    Ok(Profile { depth, time, position, film_thickness, fluid_pressure, contact_pressure })
}

/// A few lines of the press, and where the solids first touched.
fn table(recording: &Recording) -> String {
    let [depth, load, friction, film, contact] =
        ["penetration_depth", "load", "friction_coefficient", "minimum_film_thickness", "contact_length"]
            .map(|name| recording.column(name));
    let mut text = String::from(
        "\n  depth      load    friction    thinnest    regime\n     um       N/m           1     film um\n",
    );
    for index in (0..recording.rows.len()).take((LAST - FIRST) as usize + 1) {
        if PRINTED.contains(&((depth[index] * 1e6).round() as i32)) {
            text += &format!(
                "{:>7}{:>10}{:>12}{:>12}    {}\n",
                format::number(depth[index] * 1e6, 3),
                format::number(load[index], 4),
                format::number(friction[index], 3),
                format::number(film[index] * 1e6, 3),
                recording.regimes[index].replace('_', " "),
            );
        }
    }
    if let Some(first) = contact.iter().position(|&length| length > 0.0).filter(|&index| index > 0) {
        let [before, after] = [first - 1, first].map(|index| format::number(depth[index] * 1e6, 3));
        text += &format!("\nThe solids first touch between {before} and {after} um.\n");
    }
    text
}

fn to_csv(recording: &Recording) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(recording.names.iter().map(String::as_str).chain(["lubrication_regime"]))?;
    for (row, regime) in recording.rows.iter().zip(&recording.regimes) {
        writer.write_record(row.iter().map(f64::to_string).chain([(*regime).to_owned()]))?;
    }
    writer.into_inner().map_err(|error| error.into_error().into())
}
