//! Fields in colours: the map from values to colours, its bar, and the bodies filled with it.

use cartilage_contact::fem::element::{quadratic, tensor};
use cartilage_contact::fields::BodyFields;
use plotters::style::RGBColor;
use plotters::style::text_anchor::{HPos, VPos};

use super::canvas::{Canvas, Lettering, palette};
use super::panel::{Axis, Frame, tick_label};

/// Colours that grow lighter evenly and stay apart for colour-blind readers (viridis, Smith and van der Walt, CC0).
const VIRIDIS: [[u8; 3]; 11] = [
    [68, 1, 84],
    [72, 36, 117],
    [65, 68, 135],
    [53, 95, 141],
    [42, 120, 142],
    [33, 145, 140],
    [34, 168, 132],
    [66, 190, 113],
    [122, 209, 81],
    [189, 223, 38],
    [253, 231, 37],
];
/// Shades of the map.
const SHADES: usize = 40;
/// Strips that an element is cut into along the surface, and parts of its thickness that a strip is cut into.
const PARTS: (usize, usize) = (5, 6);

/// Left and right end of a level across a strip.
type Level = [(f64, f64); 2];

/// Values from the first to the last colour.
#[derive(Clone, Copy)]
pub struct ColourMap {
    /// Value of the first and of the last colour.
    pub range: (f64, f64),
}

impl ColourMap {
    fn shade(&self, value: f64) -> usize {
        let fraction = (value - self.range.0) / (self.range.1 - self.range.0);
        ((fraction * SHADES as f64).floor().max(0.0) as usize).min(SHADES - 1)
    }

    fn colour(shade: usize) -> RGBColor {
        let place = (shade as f64 + 0.5) / SHADES as f64 * (VIRIDIS.len() - 1) as f64;
        let (index, rest) = (place as usize, place.fract());
        let [a, b] = [VIRIDIS[index], VIRIDIS[(index + 1).min(VIRIDIS.len() - 1)]];
        let mix = |k: usize| (f64::from(a[k]) + rest * (f64::from(b[k]) - f64::from(a[k]))).round() as u8;
        RGBColor(mix(0), mix(1), mix(2))
    }

    /// An upright bar with round numbers and a label.
    pub fn bar(&self, canvas: &dyn Canvas, (left, top, right, bottom): Frame, label: &str) -> Result<(), String> {
        let at = |fraction: f64| bottom - fraction * (bottom - top);
        for shade in 0..SHADES {
            // Down to the bottom, so that no seam shows where the next shade begins.
            let upper = at((SHADES - shade) as f64 / SHADES as f64);
            let corners = [(left, upper), (right, upper), (right, bottom), (left, bottom)];
            canvas.area(&corners, Self::colour(SHADES - 1 - shade), 1.0)?;
        }
        canvas.line(&[(left, top), (right, top), (right, bottom), (left, bottom), (left, top)], palette::BLACK, 1.2)?;
        let (low, high) = self.range;
        for value in Axis::linear("", self.range).ticks().0 {
            let y = at((value - low) / (high - low));
            canvas.line(&[(right, y), (right + 5.0, y)], palette::BLACK, 1.2)?;
            let number = tick_label(value);
            canvas.text(&number, (right + 8.0, y), &Lettering::plain(21.0, HPos::Left, VPos::Center))?;
        }
        let style = Lettering { upwards: true, ..Lettering::plain(21.0, HPos::Center, VPos::Bottom) };
        canvas.text(label, (right + 80.0, 0.5 * (top + bottom)), &style)
    }

    /// A body filled with a nodal field. `at` says where a node is on the canvas; nothing is drawn outside `frame`.
    ///
    /// Neighbouring parts of one shade become one area, and each area reaches a little under the next one.
    pub fn fill(
        &self,
        canvas: &dyn Canvas,
        frame: Frame,
        body: &BodyFields,
        values: &[f64],
        at: &dyn Fn(usize) -> (f64, f64),
    ) -> Result<(), String> {
        let (strips, parts) = PARTS;
        for column in 0..body.columns {
            for strip in 0..strips {
                let edge = |k: usize| 2.0 * (strip + k) as f64 / strips as f64 - 1.0;
                let sample = |row: usize, s: f64, t: f64| {
                    let nodes = body.element_nodes(column * body.rows + row);
                    let shape = tensor(quadratic(s), quadratic(t));
                    let mut result = [0.0; 3];
                    for (node, f) in nodes.into_iter().zip(shape) {
                        let (x, y) = at(node);
                        result[0] += f * x;
                        result[1] += f * y;
                        result[2] += f * values[node];
                    }
                    result
                };
                // Down the strip: left and right edge of every level, and the shade below it.
                let mut runs: Vec<(usize, Vec<Level>)> = Vec::new();
                for part in 0..body.rows * parts {
                    let (row, within) = (part / parts, part % parts);
                    let t = |k: usize| 2.0 * (within + k) as f64 / parts as f64 - 1.0;
                    let ends = |t: f64| {
                        [0, 1].map(|k| {
                            let [x, y, _] = sample(row, edge(k), t);
                            (x, y)
                        })
                    };
                    let shade = self.shade(sample(row, 0.5 * (edge(0) + edge(1)), 0.5 * (t(0) + t(1)))[2]);
                    let (first, last) = (ends(t(0)), ends(t(1)));
                    match runs.last_mut() {
                        Some((same, levels)) if *same == shade => levels.push(last),
                        _ => runs.push((shade, vec![first, last])),
                    }
                }
                for (shade, levels) in &runs {
                    let left = levels.iter().map(|[left, _]| *left);
                    let right = levels.iter().rev().map(|[_, right]| (right.0 + 0.7, right.1));
                    let area = clipped(left.chain(right).collect(), frame);
                    if area.len() > 2 {
                        canvas.area(&area, Self::colour(*shade), 1.0)?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// The part of a polygon within a frame (Sutherland and Hodgman).
fn clipped(mut polygon: Vec<(f64, f64)>, (left, top, right, bottom): Frame) -> Vec<(f64, f64)> {
    type Inside<'a> = &'a dyn Fn((f64, f64)) -> f64;
    let edges: [Inside; 4] = [&|(x, _)| x - left, &|(x, _)| right - x, &|(_, y)| y - top, &|(_, y)| bottom - y];
    for inside in edges {
        let mut result = Vec::with_capacity(polygon.len());
        for (index, &b) in polygon.iter().enumerate() {
            let a = polygon[(index + polygon.len() - 1) % polygon.len()];
            let (from, to) = (inside(a), inside(b));
            if (from < 0.0) != (to < 0.0) {
                let t = from / (from - to);
                result.push((a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1)));
            }
            if to >= 0.0 {
                result.push(b);
            }
        }
        polygon = result;
    }
    polygon
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_are_cut_at_the_frame() {
        let frame = (0.0, 0.0, 10.0, 10.0);
        let square = vec![(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)];
        let mut cut = clipped(square, frame);
        cut.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(cut, [(0.0, 0.0), (0.0, 5.0), (5.0, 0.0), (5.0, 5.0)]);
        assert!(clipped(vec![(20.0, 1.0), (21.0, 1.0), (21.0, 2.0)], frame).is_empty());
    }

    #[test]
    fn values_out_of_range_have_the_outermost_colours() {
        let map = ColourMap { range: (0.0, 1.0) };
        assert_eq!((map.shade(-1.0), map.shade(0.0), map.shade(1.0), map.shade(7.0)), (0, 0, SHADES - 1, SHADES - 1));
    }
}
