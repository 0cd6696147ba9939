//! Errors of a real-time model at the states that it was compared with: how many are how large, and where they are.

use std::path::{Path, PathBuf};

use cartilage_contact::error::Error;
use cartilage_contact::parameters::Control;
use cartilage_contact::reduced::{Check, ReducedModel, Tolerance};
use plotters::style::text_anchor::{HPos, VPos};

use super::canvas::{self, Canvas, Lettering, palette};
use super::panel::{self, Axis, Frame, Line, Panel, range_of};

/// Percent, on the axis of the histograms: what is outside goes into the first or last bin.
const ERRORS: (f64, f64) = (1e-4, 10.0);
const BINS_A_DECADE: f64 = 3.0;
/// Points on the curve of first touch.
const CURVE: u32 = 200;

/// A result that is checked: its name, its error and what is allowed.
type Quantity = (&'static str, fn(&Check) -> f64, f64);

/// Writes the figure as SVG, PNG and PDF.
///
/// # Errors
/// [`Error::File`] naming the file that could not be written.
pub fn save(stem: &Path, model: &ReducedModel, tolerance: &Tolerance) -> Result<[PathBuf; 3], Error> {
    canvas::save(stem, (1800, 1130), &|canvas| draw(canvas, model, tolerance))
}

fn draw(canvas: &dyn Canvas, model: &ReducedModel, tolerance: &Tolerance) -> Result<(), String> {
    let title = Lettering { bold: true, ..Lettering::plain(28.0, HPos::Left, VPos::Top) };
    canvas.text("Errors of the real-time model", (40.0, 20.0), &title)?;
    let subtitle = Lettering { colour: palette::GREY, ..Lettering::plain(22.0, HPos::Left, VPos::Top) };
    let near = if model.checks().iter().any(|check| check.near_touch) { "; orange: near first touch" } else { "" };
    let text = format!(
        "at {} states of the full model that the table was not made from{near}; dotted: the error that is asked for, and the slowest speed of \
         the table",
        model.checks().len()
    );
    let follows = if model.parameters().control == Control::Load { "Penetration depth" } else { "Load" };
    canvas.text(&text, (40.0, 58.0), &subtitle)?;
    let results: [Quantity; 3] = [
        (follows, |check| check.load, tolerance.load),
        ("Least film thickness", |check| check.minimum_film_thickness, tolerance.minimum_film_thickness),
        ("Friction coefficient", |check| check.friction_coefficient, tolerance.friction_coefficient),
    ];
    for (column, result) in results.into_iter().enumerate() {
        let left = 110.0 + 585.0 * column as f64;
        histogram(canvas, (left, 140.0, left + 470.0, 480.0), model.checks(), result)?;
        map(canvas, (left, 610.0, left + 470.0, 1050.0), model, result)?;
    }
    Ok(())
}

fn histogram(
    canvas: &dyn Canvas,
    frame: Frame,
    checks: &[Check],
    (name, error, allowed): Quantity,
) -> Result<(), String> {
    let decades = (ERRORS.1 / ERRORS.0).log10();
    let bins = (decades * BINS_A_DECADE) as usize;
    let bin = |check: &&Check| {
        let place = (100.0 * error(check) / ERRORS.0).log10() * BINS_A_DECADE;
        place.clamp(0.0, bins as f64 - 1.0) as usize
    };
    let (mut all, mut near) = (vec![0_u32; bins], vec![0_u32; bins]);
    for check in checks {
        all[bin(&check)] += 1;
        near[bin(&check)] += u32::from(check.near_touch);
    }
    let most = all.iter().copied().max().unwrap_or(0);
    let panel = Panel {
        title: format!("{name}: {} of {} within {} %", within(checks, error, allowed), checks.len(), 100.0 * allowed),
        x: Axis::logarithmic("Error [%]; first bar: this and less", ERRORS),
        y: Axis::linear("States", range_of([0.0, f64::from(most.max(1))].into_iter(), panel::Scale::Linear)),
        label_x: true,
        bands: Vec::new(),
        marks: Vec::new(),
        lines: Vec::new(),
    };
    panel::draw(canvas, frame, &panel)?;
    // Over the grid, and below the mark.
    let edge = |i: usize| ERRORS.0 * 10_f64.powf(i as f64 / BINS_A_DECADE);
    for (counts, colour) in [(all, palette::BLUE), (near, palette::ORANGE)] {
        for (i, count) in counts.into_iter().enumerate().filter(|(_, count)| *count > 0) {
            let corners = [(edge(i), 0.0), (edge(i + 1), f64::from(count))].map(|(x, y)| panel.place(frame, x, y));
            if let [Some((left, bottom)), Some((right, top))] = corners {
                let bar = [(left + 1.5, bottom), (right - 1.5, bottom), (right - 1.5, top), (left + 1.5, top)];
                canvas.area(&bar, colour, 1.0)?;
            }
        }
    }
    let ends = [0.0, panel.y.range.1].map(|y| panel.place(frame, 100.0 * allowed, y));
    let [Some(low), Some(high)] = ends else { return Ok(()) };
    panel::dashed(canvas, &[low, high], palette::BLACK, 2.0, (3.0, 4.0))
}

fn within(checks: &[Check], error: fn(&Check) -> f64, allowed: f64) -> usize {
    checks.iter().filter(|check| error(check) <= allowed).count()
}

/// Where the errors are: areas of the dots are in proportion to them.
fn map(canvas: &dyn Canvas, frame: Frame, model: &ReducedModel, (_, error, allowed): Quantity) -> Result<(), String> {
    let range = model.range();
    let slowest = if range.speeds[0] > 0.0 { range.speeds[0] } else { 1e-2 * model.slowest_line() };
    let (first, last) = (slowest.ln(), range.speeds[1].ln());
    let scale = if model.parameters().control == Control::Load { 1e-3 } else { 1e6 };
    let ends = range.pressed.map(|end| scale * end);
    let curve = (0..=CURVE).filter_map(|i| {
        let speed = (first + (last - first) * f64::from(i) / f64::from(CURVE)).exp();
        Some((speed, scale * model.first_touch(speed)?))
    });
    let label = if model.parameters().surface_roughness > 0.0 { "film = roughness" } else { "first touch" };
    let line = Line { label: label.into(), points: curve.collect(), colour: palette::GREY, dashed: false };
    let panel = Panel {
        title: format!("Large dots: {} % or more", 100.0 * allowed),
        x: Axis::logarithmic("Sliding speed [m/s]", (slowest, range.speeds[1])),
        y: match model.parameters().control {
            Control::Depth => Axis::linear("Penetration depth [\u{b5}m]", (ends[0], ends[1])),
            Control::Load => Axis::logarithmic("Load [kN/m]", (ends[0], ends[1])),
        },
        label_x: true,
        bands: Vec::new(),
        marks: vec![(model.slowest_line(), palette::GREY)],
        lines: Some(line).filter(|line| !line.points.is_empty()).into_iter().collect(),
    };
    panel::draw(canvas, frame, &panel)?;
    for check in model.checks() {
        let Some(at) = panel.place(frame, check.sliding_speed.max(slowest), scale * check.pressed) else {
            continue;
        };
        let ratio = error(check) / allowed;
        let colour = if check.near_touch { palette::ORANGE } else { palette::BLUE };
        disc(canvas, at, 1.5 + 9.0 * ratio.min(1.0).sqrt(), if ratio > 1.0 { palette::VERMILION } else { colour })?;
    }
    Ok(())
}

fn disc(canvas: &dyn Canvas, (x, y): (f64, f64), radius: f64, colour: plotters::style::RGBColor) -> Result<(), String> {
    let corners: Vec<(f64, f64)> = (0..16)
        .map(|i| f64::from(i) * std::f64::consts::PI / 8.0)
        .map(|angle| (x + radius * angle.cos(), y + radius * angle.sin()))
        .collect();
    canvas.area(&corners, colour, 0.8)
}
