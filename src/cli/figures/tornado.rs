//! Tornado plot: how far each parameter moves load, friction and film, at a few depths.

use std::path::{Path, PathBuf};

use cartilage_contact::error::Error;
use plotters::style::text_anchor::{HPos, VPos};

use super::canvas::{self, Canvas, Lettering, palette};
use super::panel::{Axis, Scale, range_of, tick_label};

const ROW: f64 = 25.0;
const NAMES: f64 = 190.0;

/// The results that are looked at, with their names among the variables.
pub const RESULTS: [(&str, &str); 3] =
    [("load", "Load"), ("friction_coefficient", "Friction coefficient"), ("minimum_film_thickness", "Thinnest film")];

/// One changed parameter.
pub struct Response {
    /// Name in a case.
    pub parameter: &'static str,
    /// What people call it.
    pub label: &'static str,
    /// Relative change of the parameter.
    pub change: f64,
    /// Relative changes of the three results at each depth; NaN where there is none, as of a film that is gone.
    pub results: Vec<[f64; 3]>,
}

/// Writes the figure as SVG, PNG and PDF.
///
/// # Errors
/// [`Error::File`] naming the file that could not be written.
pub fn save(stem: &Path, depths: &[f64], responses: &[Response]) -> Result<[PathBuf; 3], Error> {
    let labels = labels(depths, responses);
    let height = 150.0 + RESULTS.len() as f64 * (labels.len() as f64 * ROW + 80.0);
    canvas::save(stem, (1600, height as u32), &|canvas| draw(canvas, depths, responses, &labels))
}

/// The parameters, those first that move the load most.
fn labels<'a>(depths: &[f64], responses: &'a [Response]) -> Vec<&'a str> {
    let mut labels: Vec<&str> = responses.iter().map(|response| response.label).collect();
    labels.dedup();
    let size = |label: &&str| -> f64 {
        let own = responses.iter().filter(|response| response.label == *label);
        own.flat_map(|response| (0..depths.len()).map(|d| response.results[d][0].abs())).fold(0.0, f64::max)
    };
    labels.sort_by(|a, b| size(b).total_cmp(&size(a)));
    labels
}

fn draw(canvas: &dyn Canvas, depths: &[f64], responses: &[Response], labels: &[&str]) -> Result<(), String> {
    let title = Lettering { bold: true, ..Lettering::plain(28.0, HPos::Left, VPos::Top) };
    canvas.text("What a change of each parameter does", (40.0, 20.0), &title)?;
    let percent = |get: fn(f64, f64) -> f64| 100.0 * responses.iter().map(|r| r.change).fold(0.0, get);
    let text = format!(
        "Relative change [%] where a parameter is {} % less (blue) or {} % more (orange), less where its range ends before.",
        tick_label((-percent(f64::min) * 1e6).round() / 1e6),
        tick_label((percent(f64::max) * 1e6).round() / 1e6)
    );
    let subtitle = Lettering { colour: palette::GREY, ..Lettering::plain(22.0, HPos::Left, VPos::Top) };
    canvas.text(&text, (40.0, 58.0), &subtitle)?;
    let height = labels.len() as f64 * ROW;
    let width = (1560.0 - NAMES - 20.0) / depths.len() as f64;
    for (result, (_, name)) in RESULTS.iter().enumerate() {
        let top = 140.0 + result as f64 * (height + 80.0);
        for (row, label) in labels.iter().enumerate() {
            let style = Lettering::plain(20.0, HPos::Right, VPos::Center);
            canvas.text(label, (NAMES + 8.0, top + (row as f64 + 0.5) * ROW), &style)?;
        }
        for (column, depth) in depths.iter().enumerate() {
            let left = NAMES + 20.0 + column as f64 * width;
            let frame = (left, top, left + width - 34.0, top + height);
            let title = format!("{name}, d = {} \u{b5}m", tick_label((depth * 1e9).round() / 1e3));
            // Next to the onset of contact everything moves a hundred times more than elsewhere: each plot has its own scale.
            let all = responses.iter().map(|r| 100.0 * r.results[column][result].abs()).filter(|size| size.is_finite());
            let (_, most) = range_of(all.chain([0.0, 1.0]), Scale::Linear);
            bars(canvas, frame, &title, most, labels, &|label| {
                let own = responses.iter().filter(move |response| response.label == label);
                own.map(|response| (response.change > 0.0, 100.0 * response.results[column][result])).collect()
            })?;
        }
    }
    Ok(())
}

/// One plot: `of(parameter)` gives its bars, whether of an increase, and how long.
fn bars(
    canvas: &dyn Canvas,
    (left, top, right, bottom): (f64, f64, f64, f64),
    title: &str,
    most: f64,
    labels: &[&str],
    of: &dyn Fn(&str) -> Vec<(bool, f64)>,
) -> Result<(), String> {
    let at = |value: f64| 0.5 * (left + right) + 0.5 * (right - left) * value / most;
    let grid = plotters::style::RGBColor(0xDD, 0xDD, 0xDD);
    for value in Axis::linear("", (-most, most)).ticks().0 {
        canvas.line(&[(at(value), top), (at(value), bottom)], grid, 1.0)?;
        canvas.text(&tick_label(value), (at(value), bottom + 6.0), &Lettering::plain(20.0, HPos::Center, VPos::Top))?;
    }
    let mut drawn = false;
    for (row, label) in labels.iter().enumerate() {
        let y = top + row as f64 * ROW;
        for (more, value) in of(label).into_iter().filter(|(_, value)| value.is_finite()) {
            drawn = true;
            // Both bars of a parameter may lie on one side.
            let (a, b) = if more { (y + 0.5 * ROW, y + ROW - 3.0) } else { (y + 3.0, y + 0.5 * ROW) };
            let colour = if more { palette::ORANGE } else { palette::BLUE };
            canvas.area(&[(at(0.0), a), (at(value), a), (at(value), b), (at(0.0), b)], colour, 1.0)?;
        }
    }
    canvas.line(&[(left, top), (right, top), (right, bottom), (left, bottom), (left, top)], palette::BLACK, 1.2)?;
    if drawn {
        canvas.line(&[(at(0.0), top), (at(0.0), bottom)], palette::BLACK, 1.5)?;
    } else {
        let style = Lettering { colour: palette::GREY, ..Lettering::plain(17.0, HPos::Center, VPos::Center) };
        canvas.text("the solids touch", (0.5 * (left + right), 0.5 * (top + bottom)), &style)?;
    }
    let style = Lettering { bold: true, ..Lettering::plain(21.0, HPos::Left, VPos::Bottom) };
    canvas.text(title, (left, top - 6.0), &style)
}
