//! Figures 4 to 11 of de Boer et al. (2020): one state over both bodies, and along the interface.

use std::path::{Path, PathBuf};

use cartilage_contact::error::Error;
use cartilage_contact::fields::{BodyFields, Fields};
use plotters::style::text_anchor::{HPos, VPos};

use super::canvas::{self, Canvas, Lettering, palette};
use super::colour_map::ColourMap;
use super::panel::{self, Axis, Line, Panel, Scale, range_of, tick_label};

/// Which figure of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Picture {
    /// Pressure and von Mises stress over both deformed bodies.
    Bodies,
    /// Pressures, film thickness, flux and outflow along x.
    Interface,
}

/// Half the length of the interface that is shown \[mm\].
const HALF_LENGTH: f64 = 6.0;
/// Half the height of the enlarged film [micron].
const FILM_HEIGHT: f64 = 20.0;

/// Writes the figure as SVG, PNG and PDF.
///
/// # Errors
/// [`Error::File`] naming the file that could not be written.
pub fn save(stem: &Path, fields: &Fields, picture: Picture) -> Result<[PathBuf; 3], Error> {
    match picture {
        Picture::Bodies => canvas::save(stem, (1600, 900), &|canvas| bodies(canvas, fields)),
        Picture::Interface => canvas::save(stem, (1600, 1000), &|canvas| interface(canvas, fields)),
    }
}

fn heading(canvas: &dyn Canvas, title: &str, fields: &Fields, more: &str) -> Result<(), String> {
    let style = Lettering { bold: true, ..Lettering::plain(28.0, HPos::Left, VPos::Top) };
    let depth = tick_label((fields.inputs.penetration_depth * 1e9).round() / 1e3);
    canvas.text(&format!("{title}, d = {depth} \u{b5}m"), (40.0, 20.0), &style)?;
    let style = Lettering { colour: palette::GREY, ..Lettering::plain(22.0, HPos::Left, VPos::Top) };
    let speed = tick_label(fields.inputs.sliding_speed);
    canvas.text(&format!("Sliding speed {speed} m/s, both surfaces move to the right. {more}"), (40.0, 58.0), &style)
}

/// Smallest and largest value; what is hardly below zero counts as zero.
fn shown(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)));
    let low = if low.abs() < 0.02 * high { 0.0 } else { low };
    (low, if high > low { high } else { low + 1.0 })
}

fn bodies(canvas: &dyn Canvas, fields: &Fields) -> Result<(), String> {
    heading(canvas, "Pressure and stress in the two layers", fields, "Deformed heights over undeformed positions.")?;
    type Get = fn(&BodyFields) -> &Vec<f64>;
    let columns: [(&str, &str, Get); 2] = [
        ("(a) Fluid pressure", "p [kPa]", |b| &b.fluid_pressure),
        ("(b) Von Mises stress", "\u{3c3} [kPa]", |b| &b.von_mises_stress),
    ];
    let half_length = 1e-3 * HALF_LENGTH;
    let visible = |body: &BodyFields, node: usize| body.reference_position[node][0].abs() < half_length;
    let height = fields.bodies.iter().flat_map(|body| {
        (0..body.reference_position.len()).filter(|n| visible(body, *n)).map(|n| 1.05e3 * body.position(n)[1].abs())
    });
    let height = height.fold(0.0, f64::max);
    for (index, (title, label, get)) in columns.into_iter().enumerate() {
        let values = fields.bodies.iter().flat_map(|body| {
            get(body).iter().enumerate().filter(|(n, _)| visible(body, *n)).map(|(_, value)| 1e-3 * value)
        });
        let map = ColourMap { range: shown(values) };
        let left = 115.0 + 790.0 * index as f64;
        let right = left + 530.0;
        for (top, bottom, half_height, unit, title) in
            [(140.0, 420.0, height, "y [mm]", title), (500.0, 800.0, FILM_HEIGHT, "y [\u{b5}m]", "At the film")]
        {
            let frame = (left, top, right, bottom);
            let factor = if half_height == FILM_HEIGHT { 1e6 } else { 1e3 };
            // How many times as long a height is drawn as a length.
            let stretch = (bottom - top) * factor * HALF_LENGTH / ((right - left) * half_height * 1e3);
            let stretch = if stretch > 10.0 { stretch.round() } else { (10.0 * stretch).round() / 10.0 };
            let panel = Panel {
                title: format!("{title}, heights \u{d7} {stretch}"),
                x: Axis::linear("Position [mm]", (-HALF_LENGTH, HALF_LENGTH)),
                y: Axis::linear(unit, (-half_height, half_height)),
                label_x: factor == 1e6,
                bands: Vec::new(),
                marks: Vec::new(),
                lines: Vec::new(),
            };
            panel::draw(canvas, frame, &panel)?;
            let place = |x: f64, y: f64| {
                (
                    0.5 * (left + right) + 0.5 * (right - left) * 1e3 * x / HALF_LENGTH,
                    0.5 * (top + bottom) - 0.5 * (bottom - top) * factor * y / half_height,
                )
            };
            for body in &fields.bodies {
                let values: Vec<f64> = get(body).iter().map(|value| 1e-3 * value).collect();
                // The film belongs to places along the undeformed surfaces; over those, the gap is the film's thickness.
                let at = |node: usize| place(body.reference_position[node][0], body.position(node)[1]);
                map.fill(canvas, frame, body, &values, &at)?;
            }
            let outline = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
            canvas.line(&outline, palette::BLACK, 1.2)?;
        }
        map.bar(canvas, (right + 22.0, 140.0, right + 46.0, 420.0), label)?;
    }
    Ok(())
}

fn interface(canvas: &dyn Canvas, fields: &Fields) -> Result<(), String> {
    heading(canvas, "Along the interface", fields, "")?;
    for (index, panel) in interface_panels(fields).iter().enumerate() {
        let (left, top) = (120.0 + 785.0 * (index % 2) as f64, 132.0 + 430.0 * (index / 2) as f64);
        panel::draw(canvas, (left, top, left + 655.0, top + 345.0), panel)?;
    }
    Ok(())
}

fn interface_panels(fields: &Fields) -> [Panel; 4] {
    let f = &fields.interface;
    let curve = |values: &[f64], factor: f64, label: &str, colour, dashed| Line {
        label: label.into(),
        points: f.position.iter().zip(values).map(|(x, v)| (1e3 * x, factor * v)).collect(),
        colour,
        dashed,
    };
    let panel = |title: &str, label: &str, last, lines: Vec<Line>| {
        let (lowest, highest) =
            shown(lines.iter().flat_map(|line| &line.points).filter(|(x, _)| x.abs() <= HALF_LENGTH).map(|p| p.1));
        Panel {
            title: title.into(),
            x: Axis::linear("Position [mm]", (-HALF_LENGTH, HALF_LENGTH)),
            y: Axis::linear(label, range_of([lowest, highest].into_iter(), Scale::Linear)),
            label_x: last,
            bands: Vec::new(),
            marks: Vec::new(),
            lines,
        }
    };
    use palette::{BLACK, BLUE, GREEN, VERMILION};
    let touching: Vec<f64> = f.contact_pressure.iter().map(|p| if *p > 0.0 { *p } else { 0.0 }).collect();
    let bodies = if f.upper_outflow == f.lower_outflow {
        vec![curve(&f.upper_outflow, 1e6, "each body", GREEN, true)]
    } else {
        vec![
            curve(&f.upper_outflow, 1e6, "upper body", GREEN, true),
            curve(&f.lower_outflow, 1e6, "lower body", VERMILION, true),
        ]
    };
    let film = Panel {
        y: Axis::linear("h [\u{b5}m]", (0.0, 2.0 * FILM_HEIGHT)),
        ..panel("(c) Film thickness", "", true, vec![curve(&f.film_thickness, 1e6, "", BLACK, false)])
    };
    [
        panel(
            "(a) Pressures",
            "p, S [kPa]",
            false,
            vec![
                curve(&f.fluid_pressure, 1e-3, "fluid p", BLUE, false),
                curve(&touching, 1e-3, "contact S", VERMILION, false),
            ],
        ),
        panel("(b) Flux along the film", "Q [mm\u{b2}/s]", false, vec![curve(&f.film_flux, 1e6, "", BLACK, false)]),
        film,
        panel(
            "(d) Outflow of the tissue",
            "V [\u{b5}m/s]",
            true,
            std::iter::once(curve(&f.outflow, 1e6, "into the film", BLACK, false)).chain(bodies).collect(),
        ),
    ]
}
