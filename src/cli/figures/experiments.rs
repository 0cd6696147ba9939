//! One pair of axes with what was published and what the program finds.

use std::path::{Path, PathBuf};

use cartilage_contact::error::Error;
use plotters::style::RGBColor;

use super::canvas::{self, palette};
use super::panel::{self, Axis, Line, Panel, Scale, range_of};

/// What a curve is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// Measured or computed by others.
    Published,
    /// Ours.
    Ours,
    /// Ours, with something else in it.
    Variant,
}

/// A named curve.
pub struct Curve {
    /// Name in the legend.
    pub label: String,
    /// What it is.
    pub origin: Origin,
    /// Its points, as drawn.
    pub points: Vec<(f64, f64)>,
}

/// A picture: title, labels of both axes with their scales, and the curves.
pub struct Picture {
    /// What is shown, in words.
    pub title: &'static str,
    /// Labels and scales of the horizontal and the vertical axis.
    pub axes: [(&'static str, Scale); 2],
    /// The curves.
    pub curves: Vec<Curve>,
}

/// Writes the figure as SVG and PNG.
///
/// # Errors
/// [`Error::File`] naming the file that could not be written.
pub fn save(stem: &Path, picture: &Picture) -> Result<[PathBuf; 3], Error> {
    let axis = |k: usize| {
        let (label, scale) = picture.axes[k];
        let values = picture.curves.iter().flat_map(|curve| curve.points.iter());
        let range = range_of(values.map(|point| if k == 0 { point.0 } else { point.1 }), scale);
        Axis { label: label.into(), range, scale }
    };
    let colours: [RGBColor; 3] = [palette::BLACK, palette::BLUE, palette::VERMILION];
    let line = |curve: &Curve| Line {
        label: curve.label.clone(),
        points: curve.points.clone(),
        colour: colours[curve.origin as usize],
        dashed: curve.origin == Origin::Published,
    };
    let panel = Panel {
        title: picture.title.into(),
        x: axis(0),
        y: axis(1),
        label_x: true,
        bands: Vec::new(),
        marks: Vec::new(),
        lines: picture.curves.iter().map(line).collect(),
    };
    canvas::save(stem, (1100, 700), &|canvas| panel::draw(canvas, (110.0, 60.0, 1060.0, 610.0), &panel))
}
