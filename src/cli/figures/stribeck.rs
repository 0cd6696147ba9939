//! Figure 3 of de Boer et al. (2020): friction, lengths, pressures and loads against the Sommerfeld number.

use std::path::{Path, PathBuf};

use cartilage_contact::error::Error;
use cartilage_contact::outputs::Regime;
use plotters::style::RGBColor;
use plotters::style::text_anchor::{HPos, VPos};

use super::canvas::{self, Canvas, Lettering, palette};
use super::panel::{self, Axis, Band, Line, Panel, Scale, range_of, tick_label};
use crate::cli::table::Table;

const SIZE: (u32, u32) = (1600, 1130);
const REGIME_COLOURS: [RGBColor; 4] = [palette::GREEN, palette::BLUE, palette::ORANGE, palette::VERMILION];
const SPEED_COLOURS: [RGBColor; 6] =
    [palette::BLACK, palette::BLUE, palette::VERMILION, palette::GREEN, palette::ORANGE, palette::GREY];
/// Nothing that is drawn here is smaller, in SI units; what is, is zero, and has no place on a logarithmic axis.
const SMALLEST: f64 = 1e-9;

/// A curve's points: Sommerfeld number and value.
type Points = Vec<(f64, f64)>;

/// Writes the figure as SVG, PNG and PDF. `radius` is that of the bodies \[m\], for the length over which undeformed circles overlap.
///
/// # Errors
/// [`Error::File`] naming the file that could not be written.
pub fn save(stem: &Path, table: &Table, radius: f64) -> Result<[PathBuf; 3], Error> {
    canvas::save(stem, SIZE, &|canvas| draw(canvas, table, radius))
}

fn draw(canvas: &dyn Canvas, table: &Table, radius: f64) -> Result<(), String> {
    let mut speeds = table.numbers("sliding_speed");
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    let title = Lettering { bold: true, ..Lettering::plain(28.0, HPos::Left, VPos::Top) };
    canvas.text("Stribeck analysis of two sliding cartilage layers", (40.0, 20.0), &title)?;
    let subtitle = Lettering { colour: palette::GREY, ..Lettering::plain(22.0, HPos::Left, VPos::Top) };
    let depth = table.numbers("penetration_depth").into_iter().map(|d| 1e6 * d);
    let depth = depth.fold((f64::MAX, f64::MIN), |(a, b), d| (a.min(d), b.max(d)));
    let shown = |values: &[f64]| values.iter().map(|v| tick_label(*v)).collect::<Vec<_>>().join(", ");
    let text = format!(
        "Sliding speed {} m/s; penetration depth d from {} \u{b5}m (right) to {} \u{b5}m (left), steady states.",
        shown(&speeds),
        tick_label(depth.0),
        tick_label(depth.1)
    );
    canvas.text(&text, (40.0, 58.0), &subtitle)?;
    let panels = if speeds.len() == 1 { one_speed(table, radius) } else { many_speeds(table, &speeds) };
    for (index, panel) in panels.iter().enumerate() {
        let (left, top) = (115.0 + 785.0 * (index % 2) as f64, 138.0 + 500.0 * (index / 2) as f64);
        panel::draw(canvas, (left, top, left + 660.0, top + 400.0), panel)?;
    }
    Ok(())
}

/// Points of a column over the Sommerfeld number, for the states that `keep` holds of.
fn points(table: &Table, values: &[f64], keep: impl Fn(usize) -> bool) -> Points {
    let sommerfeld = table.numbers("sommerfeld_number");
    let mut points: Points = (0..values.len()).filter(|i| keep(*i)).map(|i| (sommerfeld[i], values[i])).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

/// The paper's four panels.
fn one_speed(table: &Table, radius: f64) -> Vec<Panel> {
    let [friction, fluid_friction, fluid, solid] =
        ["friction_coefficient", "fluid_friction_coefficient", "fluid_load", "solid_load"].map(|n| table.numbers(n));
    let ratio: Vec<f64> = fluid.iter().zip(&solid).map(|(f, s)| if *s > 0.0 { f / s } else { f64::NAN }).collect();
    let [depth, film, contact] =
        ["penetration_depth", "minimum_film_thickness", "contact_length"].map(|n| table.numbers(n));
    let overlap: Vec<f64> =
        depth.iter().map(|d| if *d > 0.0 { (d * (4.0 * radius - d)).sqrt() } else { f64::NAN }).collect();
    let approach: Vec<f64> = depth.iter().map(|d| d.abs()).collect();
    let [pressure, stress, von_mises] =
        ["maximum_fluid_pressure", "maximum_contact_pressure", "maximum_von_mises_stress"].map(|n| table.numbers(n));
    let bands = regimes(table);
    let curve = |values: &[f64], factor: f64, label: &str, colour, dashed| {
        let scaled: Vec<f64> = values.iter().map(|v| if *v > SMALLEST { v * factor } else { f64::NAN }).collect();
        Line { label: label.into(), points: points(table, &scaled, |_| true), colour, dashed }
    };
    use palette::{BLACK, BLUE, GREEN, VERMILION};
    let panel = |title: &str, label: &str, last, lines: Vec<Line>| {
        let mut panel = plain(title, label, last, lines);
        // Room for the names of the regimes above the curves.
        panel.y.range.1 *= (panel.y.range.1 / panel.y.range.0).powf(0.28);
        Panel { bands: bands.clone(), ..panel }
    };
    shared_abscissa(vec![
        panel(
            "(a) Friction",
            "\u{3bc}, \u{393} [\u{2212}]",
            false,
            vec![
                curve(&friction, 1.0, "\u{3bc}", BLACK, false),
                curve(&fluid_friction, 1.0, "\u{3bc} of the fluid", BLUE, true),
                curve(&ratio, 1.0, "\u{393} = fluid / solid load", VERMILION, false),
            ],
        ),
        panel(
            "(b) Lengths",
            "b, h, \u{b1}d [\u{b5}m]",
            false,
            vec![
                curve(&contact, 1e6, "contact b", BLACK, false),
                curve(&overlap, 1e6, "overlap", GREEN, true),
                curve(&film, 1e6, "film h", BLUE, false),
                curve(&approach, 1e6, "depth \u{b1}d", VERMILION, true),
            ],
        ),
        panel(
            "(c) Largest stresses",
            "p, \u{3c3}, S [kPa]",
            true,
            vec![
                curve(&pressure, 1e-3, "fluid p", BLUE, false),
                curve(&von_mises, 1e-3, "von Mises \u{3c3}", BLACK, true),
                curve(&stress, 1e-3, "contact S", VERMILION, false),
            ],
        ),
        panel(
            "(d) Loads",
            "L [N/m]",
            true,
            vec![curve(&fluid, 1.0, "fluid", BLUE, false), curve(&solid, 1.0, "solid", VERMILION, false)],
        ),
    ])
}

/// One curve a speed.
fn many_speeds(table: &Table, speeds: &[f64]) -> Vec<Panel> {
    let speed = table.numbers("sliding_speed");
    let panel = |title: &str, label: &str, name: &str, factor: f64, last: bool| {
        let values: Vec<f64> =
            table.numbers(name).iter().map(|v| if *v > SMALLEST { v * factor } else { f64::NAN }).collect();
        let curve = |(index, u): (usize, &f64)| Line {
            label: if name == "friction_coefficient" { format!("{} m/s", tick_label(*u)) } else { String::new() },
            points: points(table, &values, |i| speed[i] == *u),
            colour: SPEED_COLOURS[index % SPEED_COLOURS.len()],
            dashed: index >= SPEED_COLOURS.len(),
        };
        plain(title, label, last, speeds.iter().enumerate().map(curve).collect())
    };
    shared_abscissa(vec![
        panel("(a) Friction", "\u{3bc} [\u{2212}]", "friction_coefficient", 1.0, false),
        panel("(b) Least film thickness", "h [\u{b5}m]", "minimum_film_thickness", 1e6, false),
        panel("(c) Largest fluid pressure", "p [kPa]", "maximum_fluid_pressure", 1e-3, true),
        panel("(d) Contact length", "b [mm]", "contact_length", 1e3, true),
    ])
}

/// The same stretch of the abscissa for all panels, of which only the lower ones have its numbers.
fn shared_abscissa(mut panels: Vec<Panel>) -> Vec<Panel> {
    let range = panels.iter().map(|panel| panel.x.range).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    for panel in &mut panels {
        panel.x.range = range.unwrap_or(panel.x.range);
    }
    panels
}

fn plain(title: &str, label: &str, last: bool, lines: Vec<Line>) -> Panel {
    let all = || lines.iter().flat_map(|line| &line.points).filter(|(_, y)| y.is_finite());
    let log = Scale::Logarithmic;
    Panel {
        title: title.into(),
        x: Axis::logarithmic(
            "Sommerfeld number \u{3b7}U/L [\u{2212}]; load grows to the left",
            range_of(all().map(|p| p.0), log),
        ),
        y: Axis::logarithmic(label, range_of(all().map(|p| p.1), log)),
        label_x: last,
        bands: Vec::new(),
        marks: Vec::new(),
        lines,
    }
}

/// The intervals of the regimes, which meet halfway between states.
fn regimes(table: &Table) -> Vec<Band> {
    let sommerfeld = table.numbers("sommerfeld_number");
    let mut states: Vec<_> =
        sommerfeld.iter().zip(table.words("lubrication_regime")).filter(|(s, _)| **s > 0.0).collect();
    states.sort_by(|a, b| a.0.total_cmp(b.0));
    let mut bands: Vec<Band> = Vec::new();
    for (index, (s, word)) in states.iter().enumerate() {
        let Some(regime) = Regime::ITEMS.iter().position(|(name, _)| name == word) else { continue };
        let end = states.get(index + 1).map_or(**s, |next| (*s * next.0).sqrt());
        let label = word.replace('_', " ");
        match bands.last_mut() {
            Some(band) if band.label == label => band.range.1 = end,
            _ => {
                let start = bands.last().map_or(**s, |band| band.range.1);
                bands.push(Band { label, range: (start, end), colour: REGIME_COLOURS[regime] });
            }
        }
    }
    bands
}
