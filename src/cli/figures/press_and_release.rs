//! Friction, film and load while two layers are pressed together and released, and profiles at a few depths.

use std::path::{Path, PathBuf};

use cartilage_contact::error::Error;
use plotters::style::text_anchor::{HPos, VPos};

use super::canvas::{self, Canvas, Lettering, palette};
use super::panel::{self, Axis, Band, Line, Panel, Scale, range_of};

/// State along the interface at one depth, at the nodes of the mesh, SI.
pub struct Profile {
    /// Penetration depth.
    pub depth: f64,
    /// When the press came through it.
    pub time: f64,
    /// Stations along x.
    pub position: Vec<f64>,
    /// Film thickness at the stations.
    pub film_thickness: Vec<f64>,
    /// Fluid pressure at the stations.
    pub fluid_pressure: Vec<f64>,
    /// Contact pressure at the stations.
    pub contact_pressure: Vec<f64>,
}

/// What is drawn, SI; one value a communication point, and a few profiles.
#[allow(missing_docs)]
pub struct Film {
    pub time: Vec<f64>,
    pub depth: Vec<f64>,
    pub load: Vec<f64>,
    pub fluid_load: Vec<f64>,
    pub solid_load: Vec<f64>,
    pub friction: Vec<f64>,
    pub fluid_friction: Vec<f64>,
    pub minimum_film: Vec<f64>,
    pub central_film: Vec<f64>,
    pub contact_length: Vec<f64>,
    pub profiles: Vec<Profile>,
}

const SIZE: (u32, u32) = (1600, 1000);
const PROFILE_COLOURS: [plotters::style::RGBColor; 3] = [palette::ORANGE, palette::GREEN, palette::BLUE];
/// Half the length of the interface that the profiles show \[mm\].
const HALF_LENGTH: f64 = 3.0;

/// Writes the figure as SVG, PNG and PDF.
///
/// # Errors
/// [`Error::File`] naming the file that could not be written.
pub fn save(stem: &Path, film: &Film) -> Result<[PathBuf; 3], Error> {
    canvas::save(stem, SIZE, &|canvas| draw(canvas, film))
}

fn draw(canvas: &dyn Canvas, film: &Film) -> Result<(), String> {
    let title = Lettering { bold: true, ..Lettering::plain(28.0, HPos::Left, VPos::Top) };
    canvas.text("Two cartilage layers pressed together and released while they slide", (40.0, 22.0), &title)?;
    let subtitle = Lettering { colour: palette::GREY, ..Lettering::plain(22.0, HPos::Left, VPos::Top) };
    canvas.text(
        "Quasi-steady, 0.2 m/s, layers 1 mm thick of 100 mm radius (de Boer et al., 2020). Depth d: approach of the bones past first touch.",
        (40.0, 62.0),
        &subtitle,
    )?;
    let histories = histories(film);
    let (first, last, gap) = (136.0, 930.0, 46.0);
    // The depth needs less height than the others.
    let unit = (last - first - 3.0 * gap) / 3.7;
    let mut top = first;
    for (index, history) in histories.iter().enumerate() {
        let height = if index == 0 { 0.7 * unit } else { unit };
        panel::draw(canvas, (110.0, top, 830.0, top + height), history)?;
        top += height + gap;
    }
    let height = (last - first - 64.0) / 2.0;
    for (index, profile) in profiles(film).iter().enumerate() {
        let top = first + index as f64 * (height + 64.0);
        panel::draw(canvas, (970.0, top, 1570.0, top + height), profile)?;
    }
    Ok(())
}

/// Depth, load, friction and film against time.
fn histories(film: &Film) -> Vec<Panel> {
    let curve = |values: &[f64], factor: f64, label: &str, colour, dashed| Line {
        label: label.into(),
        points: film.time.iter().zip(values).map(|(&t, &v)| (t, factor * v)).collect(),
        colour,
        dashed,
    };
    let all = |columns: &[&[f64]], factor: f64, scale| {
        range_of(columns.iter().flat_map(|column| column.iter().map(|v| v * factor)), scale)
    };
    let touching = film.time.iter().zip(&film.contact_length).filter(|&(_, &length)| length > 0.0).map(|(&t, _)| t);
    let (start, end) = touching.fold((f64::MAX, f64::MIN), |(a, b), t| (a.min(t), b.max(t)));
    let time = (film.time.first().copied().unwrap_or(0.0), film.time.last().copied().unwrap_or(1.0));
    let panel = |title: &str, y: Axis, lines: Vec<Line>, last: bool, named: bool| Panel {
        title: title.into(),
        x: Axis::linear("Time [s]", time),
        y,
        label_x: last,
        bands: Vec::from_iter((start <= end).then(|| Band {
            label: if named { "solids touch".into() } else { String::new() },
            range: (start, end),
            colour: palette::VERMILION,
        })),
        marks: film.profiles.iter().zip(PROFILE_COLOURS).map(|(profile, colour)| (profile.time, colour)).collect(),
        lines,
    };
    let log = Scale::Logarithmic;
    // Down to a hundredth of a micron; what touches has no film, and its curve leaves the axis.
    let shown = |values: &[f64], least: f64| values.iter().map(|h| h.max(least)).collect::<Vec<f64>>();
    let thickness = [shown(&film.minimum_film, 1e-8), shown(&film.central_film, 1e-8)];
    let [thinnest, middle] = [shown(&film.minimum_film, 1e-12), shown(&film.central_film, 1e-12)];
    vec![
        panel(
            "Penetration depth",
            Axis::linear("d [\u{b5}m]", all(&[&film.depth], 1e6, Scale::Linear)),
            vec![curve(&film.depth, 1e6, "", palette::BLACK, false)],
            false,
            false,
        ),
        panel(
            "Load per unit width",
            Axis::logarithmic("L [N/m]", all(&[&film.load], 1.0, log)),
            vec![
                curve(&film.load, 1.0, "total", palette::BLACK, false),
                curve(&film.fluid_load, 1.0, "fluid", palette::BLUE, true),
                curve(&film.solid_load, 1.0, "solid", palette::VERMILION, false),
            ],
            false,
            false,
        ),
        panel(
            "Friction coefficient",
            Axis::logarithmic("\u{3bc} [\u{2212}]", all(&[&film.friction, &film.fluid_friction], 1.0, log)),
            vec![
                curve(&film.friction, 1.0, "total", palette::BLACK, false),
                curve(&film.fluid_friction, 1.0, "fluid alone", palette::BLUE, true),
            ],
            false,
            false,
        ),
        panel(
            "Film thickness",
            Axis::logarithmic("h [\u{b5}m]", all(&[&thickness[0], &thickness[1]], 1e6, log)),
            vec![
                curve(&thinnest, 1e6, "thinnest", palette::BLACK, false),
                curve(&middle, 1e6, "in the middle", palette::BLUE, true),
            ],
            true,
            true,
        ),
    ]
}

/// Pressure and film along the interface.
fn profiles(film: &Film) -> [Panel; 2] {
    let curve = |profile: &Profile, values: &[f64], factor: f64, label: String, index: usize, dashed| Line {
        label,
        points: profile.position.iter().zip(values).map(|(&x, &v)| (1e3 * x, factor * v)).collect(),
        colour: PROFILE_COLOURS[index % PROFILE_COLOURS.len()],
        dashed,
    };
    let mut pressure = Vec::new();
    let mut thickness = Vec::new();
    for (index, profile) in film.profiles.iter().enumerate() {
        let label = format!("d = {} \u{b5}m", panel::tick_label((profile.depth * 1e7).round() / 10.0));
        pressure.push(curve(profile, &profile.fluid_pressure, 1e-3, label.clone(), index, false));
        thickness.push(curve(profile, &profile.film_thickness, 1e6, label.clone(), index, false));
        if profile.contact_pressure.iter().any(|&p| p > 0.0) {
            // Zero outside the contact says nothing.
            let values: Vec<f64> =
                profile.contact_pressure.iter().map(|&p| if p > 0.0 { p } else { f64::NAN }).collect();
            pressure.push(curve(profile, &values, 1e-3, "solid".into(), index, true));
        }
    }
    let range = range_of(pressure.iter().flat_map(|line| line.points.iter().map(|point| point.1)), Scale::Linear);
    let x = Axis::linear("Position [mm]; both surfaces move to the right", (-HALF_LENGTH, HALF_LENGTH));
    let panel = |title: &str, y, lines, last| Panel {
        title: title.into(),
        x: x.clone(),
        y,
        label_x: last,
        bands: Vec::new(),
        marks: Vec::new(),
        lines,
    };
    [
        panel("Pressure", Axis::linear("p [kPa]", range), pressure, false),
        panel("Film thickness", Axis::linear("h [\u{b5}m]", (0.0, 20.0)), thickness, true),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_figure_names_its_quantities_and_units() {
        let film = Film {
            time: vec![0.0, 1.0, 2.0],
            depth: vec![-1e-5, 3e-5, -1e-5],
            load: vec![0.3, 200.0, 0.3],
            fluid_load: vec![0.3, 150.0, 0.3],
            solid_load: vec![0.0, 50.0, 0.0],
            friction: vec![0.2, 0.1, 0.2],
            fluid_friction: vec![0.2, 0.002, 0.2],
            minimum_film: vec![1e-5, 0.0, 1e-5],
            central_film: vec![1e-5, 0.0, 1e-5],
            contact_length: vec![0.0, 1e-3, 0.0],
            profiles: vec![Profile {
                depth: 3e-5,
                time: 1.0,
                position: vec![-1e-3, 0.0, 1e-3],
                film_thickness: vec![1e-5, 0.0, 1e-5],
                fluid_pressure: vec![0.0, 5e4, 0.0],
                contact_pressure: vec![0.0, 2e4, 0.0],
            }],
        };
        let svg = canvas::to_svg(SIZE, &|canvas| draw(canvas, &film)).unwrap();
        for text in [
            "Load per unit width",
            "[N/m]",
            "Friction coefficient",
            "solids touch",
            "d = 30 \u{b5}m",
            "[kPa]",
            "Time [s]",
        ] {
            assert!(svg.contains(text), "{text} is missing");
        }
    }
}
