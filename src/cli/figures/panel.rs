//! One set of axes: scales, ticks, grid, shaded intervals and lines.

use plotters::style::RGBColor;
use plotters::style::text_anchor::{HPos, VPos};

use super::canvas::{Anchor, Canvas, Lettering, palette};

/// How values are spread along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps.
    Linear,
    /// Equal ratios; values that are not positive are left out.
    Logarithmic,
}

/// One axis.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Quantity and unit, such as `Time [s]`; empty for none.
    pub label: String,
    /// First and last value shown.
    pub range: (f64, f64),
    /// How values are spread.
    pub scale: Scale,
}

/// A curve.
#[derive(Debug, Clone)]
pub struct Line {
    /// Name in the legend; empty for none.
    pub label: String,
    /// The points. A point that is not finite, or not positive on a logarithmic axis, interrupts the curve.
    pub points: Vec<(f64, f64)>,
    /// Its colour.
    pub colour: RGBColor,
    /// Whether it is dashed.
    pub dashed: bool,
}

/// A shaded interval of x.
#[derive(Debug, Clone)]
pub struct Band {
    /// What it means, written inside; empty for nothing.
    pub label: String,
    /// First and last x.
    pub range: (f64, f64),
    /// Its colour, laid on thinly.
    pub colour: RGBColor,
}

/// Everything within one pair of axes.
#[derive(Debug, Clone)]
pub struct Panel {
    /// What is shown, in words.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Whether the horizontal axis carries numbers and its label (not where the panel below shares it).
    pub label_x: bool,
    /// Shaded intervals, below the curves.
    pub bands: Vec<Band>,
    /// Values of x marked by a dotted vertical line, with its colour.
    pub marks: Vec<(f64, RGBColor)>,
    /// The curves.
    pub lines: Vec<Line>,
}

impl Panel {
    /// Where a point of the plot lies within a frame; `None` where an axis cannot show it.
    pub fn place(&self, (left, top, right, bottom): Frame, x: f64, y: f64) -> Option<(f64, f64)> {
        Some((left + self.x.place(x)? * (right - left), bottom - self.y.place(y)? * (bottom - top)))
    }
}

/// A rectangle in points: left, top, right, bottom.
pub type Frame = (f64, f64, f64, f64);

// Between 6.5 and 8 points on a page 174 mm wide.
const TICK_SIZE: f64 = 22.0;
const LABEL_SIZE: f64 = 23.0;
const TITLE_SIZE: f64 = 24.0;
const LINE_WIDTH: f64 = 3.0;

impl Axis {
    /// An axis with equal steps.
    pub fn linear(label: &str, range: (f64, f64)) -> Self {
        Self { label: label.into(), range, scale: Scale::Linear }
    }

    /// An axis with equal ratios.
    pub fn logarithmic(label: &str, range: (f64, f64)) -> Self {
        Self { label: label.into(), range, scale: Scale::Logarithmic }
    }

    /// Place of a value, 0 at the start of the axis and 1 at its end; `None` where it has none.
    fn place(&self, value: f64) -> Option<f64> {
        let map = |v: f64| if self.scale == Scale::Logarithmic { v.log10() } else { v };
        let (first, last) = (map(self.range.0), map(self.range.1));
        let place = (map(value) - first) / (last - first);
        place.is_finite().then_some(place)
    }

    /// Values with a number, and those with a short tick only.
    pub fn ticks(&self) -> (Vec<f64>, Vec<f64>) {
        let (first, last) = self.range;
        let slack = 1e-9 * (last - first).abs();
        let inside = |v: &f64| *v >= first - slack && *v <= last + slack;
        match self.scale {
            Scale::Linear => {
                let step = nice_step(last - first, 5.0);
                let start = (first / step).ceil() as i64;
                let major = (start..start + 20).map(|i| i as f64 * step).filter(inside).collect();
                (major, Vec::new())
            }
            Scale::Logarithmic => {
                let decades = first.log10().floor() as i32..=last.log10().ceil() as i32;
                let every = (last / first).log10().ceil() as i32 / 6 + 1;
                let power = |i: i32| 10_f64.powi(i);
                let major: Vec<f64> = decades.clone().filter(|i| i % every == 0).map(power).filter(inside).collect();
                let minor =
                    decades.flat_map(|i| (2..10).map(move |k| f64::from(k) * 10_f64.powi(i))).filter(inside).collect();
                (major, minor)
            }
        }
    }
}

impl Axis {
    /// What stands at these ticks: powers of ten throughout where one of them needs it.
    fn labels(&self, ticks: &[f64]) -> Vec<String> {
        let labels: Vec<String> = ticks.iter().map(|value| tick_label(*value)).collect();
        if self.scale == Scale::Linear || labels.iter().all(|label| !label.contains('^')) {
            return labels;
        }
        let power = |value: &f64| match value.log10().round() {
            0.0 => "1".into(),
            exponent => format!("10^{exponent}").replace('-', "\u{2212}"),
        };
        ticks.iter().map(power).collect()
    }
}

/// A step of 1, 2 or 5 times a power of ten that gives about `count` intervals.
fn nice_step(span: f64, count: f64) -> f64 {
    let power = 10_f64.powf((span / count).log10().floor());
    let fraction = span / count / power;
    power
        * if fraction < 1.5 {
            1.0
        } else if fraction < 3.5 {
            2.0
        } else if fraction < 7.5 {
            5.0
        } else {
            10.0
        }
}

/// The next number of the form 1, 2 or 5 times a power of ten that is not below a positive value.
fn round_up(value: f64) -> f64 {
    let power = 10_f64.powf(value.log10().floor());
    let candidates = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
    candidates.into_iter().find(|candidate| *candidate >= value).unwrap_or(10.0 * power)
}

/// A round range that holds all finite (on a logarithmic axis: positive) values.
pub fn range_of(values: impl Iterator<Item = f64>, scale: Scale) -> (f64, f64) {
    let usable = |v: &f64| v.is_finite() && (scale == Scale::Linear || *v > 0.0);
    let (low, high) = values.filter(usable).fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)));
    match scale {
        _ if low > high => (1.0, 10.0),
        Scale::Logarithmic => {
            // Not above `low`, and not below `high`; at least a decade, so that a power of ten lies in it.
            let low = round_up(low * 5.0 * (1.0 + 1e-9)) / 10.0;
            (low, round_up(high * (1.0 - 1e-9)).max(10.0 * low))
        }
        Scale::Linear => {
            let step = nice_step((high - low).max(1e-12 * high.abs()).max(f64::MIN_POSITIVE), 5.0);
            let (low, high) = ((low / step).floor() * step, (high / step).ceil() * step);
            (low, if high > low { high } else { low + step })
        }
    }
}

/// A tick's number as people write it; what follows `^` is to be raised.
pub fn tick_label(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let size = value.abs();
    let text = if !(1e-3..1e5).contains(&size) {
        let exponent = size.log10().floor();
        let factor = (size / 10_f64.powf(exponent) * 1e6).round() / 1e6;
        let power = format!("10^{exponent}").replace('-', "\u{2212}");
        if factor == 1.0 { power } else { format!("{factor}\u{b7}{power}") }
    } else {
        format!("{}", (size * 1e6).round() / 1e6)
    };
    if value < 0.0 { format!("\u{2212}{text}") } else { text }
}

/// Draws a panel with its axes along the edges of `frame`; labels and the title lie outside.
pub fn draw(canvas: &dyn Canvas, frame: Frame, panel: &Panel) -> Result<(), String> {
    let (left, top, right, bottom) = frame;
    let at_x = |v: f64| panel.x.place(v).map(|p| left + p * (right - left));
    let at_y = |v: f64| panel.y.place(v).map(|p| bottom - p * (bottom - top));

    for band in &panel.bands {
        let edge = |v: f64| at_x(v).unwrap_or(left).clamp(left, right);
        let (a, b) = (edge(band.range.0), edge(band.range.1));
        canvas.area(&[(a, top), (b, top), (b, bottom), (a, bottom)], band.colour, 0.16)?;
        let style = Lettering { colour: palette::GREY, ..Lettering::plain(TICK_SIZE, HPos::Left, VPos::Top) };
        let lines = wrapped(canvas, &band.label, b - a - 12.0, &style);
        if lines.iter().any(|line| canvas.text_width(line, &style) > b - a - 4.0) {
            // Too narrow for its words: upwards.
            let upright = Lettering { upwards: true, anchor: Anchor(HPos::Center, VPos::Center), ..style };
            canvas.text(
                &band.label,
                (0.5 * (a + b), top + 10.0 + 0.5 * canvas.text_width(&band.label, &style)),
                &upright,
            )?;
            continue;
        }
        for (index, line) in lines.iter().enumerate() {
            canvas.text(line, (a + 8.0, top + 5.0 + 1.15 * TICK_SIZE * index as f64), &style)?;
        }
    }
    let grid = RGBColor(0xDD, 0xDD, 0xDD);
    let (major, minor) = panel.y.ticks();
    for (label, y) in panel.y.labels(&major).into_iter().zip(&major).filter_map(|(text, &v)| Some((text, at_y(v)?))) {
        canvas.line(&[(left, y), (right, y)], grid, 1.0)?;
        canvas.line(&[(left - 6.0, y), (left, y)], palette::BLACK, 1.2)?;
        let style = Lettering::plain(TICK_SIZE, HPos::Right, VPos::Center);
        number(canvas, &label, (left - 9.0, y), &style)?;
    }
    for y in minor.iter().filter_map(|&v| at_y(v)) {
        canvas.line(&[(left - 3.5, y), (left, y)], palette::BLACK, 1.0)?;
    }
    let (major, minor) = panel.x.ticks();
    let labels = panel.x.labels(&major);
    // Exponents stand above their numbers, and below the axis.
    let lower = if labels.iter().any(|label| label.contains('^')) { 5.0 } else { 0.0 };
    for (label, x) in labels.into_iter().zip(&major).filter_map(|(text, &v)| Some((text, at_x(v)?))) {
        canvas.line(&[(x, top), (x, bottom)], grid, 1.0)?;
        canvas.line(&[(x, bottom), (x, bottom + 6.0)], palette::BLACK, 1.2)?;
        if panel.label_x {
            let style = Lettering::plain(TICK_SIZE, HPos::Center, VPos::Top);
            number(canvas, &label, (x, bottom + 7.0 + lower), &style)?;
        }
    }
    for x in minor.iter().filter_map(|&v| at_x(v)) {
        canvas.line(&[(x, bottom), (x, bottom + 3.5)], palette::BLACK, 1.0)?;
    }
    for (x, colour) in panel.marks.iter().filter_map(|&(v, colour)| at_x(v).map(|x| (x, colour))) {
        dashed(canvas, &[(x, top), (x, bottom)], colour, 2.0, (3.0, 4.0))?;
    }
    for line in &panel.lines {
        for piece in pieces(line, frame, &at_x, &at_y) {
            if line.dashed {
                dashed(canvas, &piece, line.colour, LINE_WIDTH, (9.0, 6.0))?;
            } else {
                canvas.line(&piece, line.colour, LINE_WIDTH)?;
            }
        }
    }
    canvas.line(&[(left, top), (right, top), (right, bottom), (left, bottom), (left, top)], palette::BLACK, 1.2)?;

    let style = Lettering { bold: true, ..Lettering::plain(TITLE_SIZE, HPos::Left, VPos::Bottom) };
    canvas.text(&panel.title, (left, top - 7.0), &style)?;
    if panel.label_x {
        let style = Lettering::plain(LABEL_SIZE, HPos::Center, VPos::Top);
        canvas.text(&panel.x.label, (0.5 * (left + right), bottom + 34.0 + lower), &style)?;
    }
    let style = Lettering { upwards: true, ..Lettering::plain(LABEL_SIZE, HPos::Center, VPos::Bottom) };
    canvas.text(&panel.y.label, (left - 76.0, 0.5 * (top + bottom)), &style)?;
    legend(canvas, (right, top - 19.0), &panel.lines)
}

/// A text in lines that are no wider than this, if its words are not.
fn wrapped(canvas: &dyn Canvas, text: &str, width: f64, style: &Lettering) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let longer = lines.last().map(|line| format!("{line} {word}"));
        match (lines.last_mut(), longer) {
            (Some(line), Some(longer)) if canvas.text_width(&longer, style) <= width => *line = longer,
            _ => lines.push(word.into()),
        }
    }
    lines
}

/// A number with its exponent raised. (Few fonts have all superscript digits.)
fn number(canvas: &dyn Canvas, label: &str, (x, y): (f64, f64), style: &Lettering) -> Result<(), String> {
    let Some((base, exponent)) = label.split_once('^') else { return canvas.text(label, (x, y), style) };
    let small = Lettering { size: 0.75 * style.size, anchor: Anchor(HPos::Right, style.anchor.1), ..*style };
    let (base_width, width) = (canvas.text_width(base, style), canvas.text_width(exponent, &small));
    let right = match style.anchor.0 {
        HPos::Left => x + base_width + width,
        HPos::Center => x + 0.5 * (base_width + width),
        HPos::Right => x,
    };
    canvas.text(exponent, (right, y - 0.35 * style.size), &small)?;
    let base_style = Lettering { anchor: Anchor(HPos::Right, style.anchor.1), ..*style };
    canvas.text(base, (right - width - 1.0, y), &base_style)
}

/// Names of the curves in one row above the panel, ending at its right edge.
fn legend(canvas: &dyn Canvas, (right, y): (f64, f64), lines: &[Line]) -> Result<(), String> {
    const SAMPLE: f64 = 26.0;
    let mut x = right;
    for line in lines.iter().rev().filter(|line| !line.label.is_empty()) {
        let style = Lettering::plain(TICK_SIZE, HPos::Left, VPos::Center);
        // An SVG is shown with the fonts of the viewer, which may be wider.
        x -= 1.12 * canvas.text_width(&line.label, &style);
        canvas.text(&line.label, (x, y), &style)?;
        x -= SAMPLE + 7.0;
        let sample = [(x, y + 1.0), (x + SAMPLE, y + 1.0)];
        if line.dashed {
            dashed(canvas, &sample, line.colour, LINE_WIDTH, (9.0, 6.0))?;
        } else {
            canvas.line(&sample, line.colour, LINE_WIDTH)?;
        }
        x -= 13.0;
    }
    Ok(())
}

/// The parts of a curve that lie within the frame, in points.
fn pieces(
    line: &Line,
    (left, top, right, bottom): Frame,
    at_x: &dyn Fn(f64) -> Option<f64>,
    at_y: &dyn Fn(f64) -> Option<f64>,
) -> Vec<Vec<(f64, f64)>> {
    let places: Vec<_> = line.points.iter().map(|&(x, y)| Some((at_x(x)?, at_y(y)?))).collect();
    let mut result: Vec<Vec<(f64, f64)>> = Vec::new();
    for pair in places.windows(2) {
        let (Some(a), Some(b)) = (pair[0], pair[1]) else { continue };
        // Liang and Barsky: the part of the segment that every edge lets through.
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for (step, room) in [(-dx, a.0 - left), (dx, right - a.0), (-dy, a.1 - top), (dy, bottom - a.1)] {
            if step == 0.0 {
                if room < 0.0 {
                    leave = -1.0;
                }
            } else if step < 0.0 {
                enter = enter.max(room / step);
            } else {
                leave = leave.min(room / step);
            }
        }
        if enter > leave {
            continue;
        }
        let along = |t: f64| (a.0 + t * dx, a.1 + t * dy);
        match result.last_mut() {
            Some(piece) if piece.last() == Some(&along(enter)) => piece.push(along(leave)),
            _ => result.push(vec![along(enter), along(leave)]),
        }
    }
    result
}

/// A line of dashes; (length of a dash, of a gap).
pub fn dashed(
    canvas: &dyn Canvas,
    points: &[(f64, f64)],
    colour: RGBColor,
    width: f64,
    (dash, gap): (f64, f64),
) -> Result<(), String> {
    let mut position = 0.0;
    let mut current: Vec<(f64, f64)> = Vec::new();
    for pair in points.windows(2) {
        let length = (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1);
        let mut done = 0.0;
        while done < length {
            let phase = position % (dash + gap);
            let on = phase < dash;
            let step = (if on { dash - phase } else { dash + gap - phase }).max(1e-6).min(length - done);
            let at = |s: f64| {
                (pair[0].0 + (pair[1].0 - pair[0].0) * s / length, pair[0].1 + (pair[1].1 - pair[0].1) * s / length)
            };
            if on {
                if current.is_empty() {
                    current.push(at(done));
                }
                current.push(at(done + step));
            } else if !current.is_empty() {
                canvas.line(&current, colour, width)?;
                current.clear();
            }
            done += step;
            position += step;
        }
    }
    if current.len() > 1 { canvas.line(&current, colour, width) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(Axis::linear("", (-10.0, 30.0)).ticks().0, [-10.0, 0.0, 10.0, 20.0, 30.0]);
        let (major, minor) = Axis::logarithmic("", (0.1, 10.0)).ticks();
        assert_eq!(major, [0.1, 1.0, 10.0]);
        assert_eq!(minor.len(), 16);
        assert_eq!(tick_label(-0.5), "\u{2212}0.5");
        assert_eq!(tick_label(1e-4), "10^\u{2212}4");
        assert_eq!(tick_label(2e6), "2\u{b7}10^6");
        assert_eq!(tick_label(0.30000000000000004), "0.3");
    }

    #[test]
    fn ranges_hold_all_values_and_ignore_what_an_axis_cannot_show() {
        assert_eq!(range_of([3.0, 47.0].into_iter(), Scale::Linear), (0.0, 50.0));
        let close = |(a, b): (f64, f64), (c, d): (f64, f64)| (a / c - 1.0).abs() < 1e-9 && (b / d - 1.0).abs() < 1e-9;
        let range = |values: &[f64]| range_of(values.iter().copied(), Scale::Logarithmic);
        assert!(close(range(&[0.0, f64::NAN, 0.03, 700.0]), (0.02, 1000.0)));
        assert!(close(range(&[0.02, 10.1]), (0.02, 20.0)));
        assert!(close(range(&[0.019, 20.0]), (0.01, 20.0)));
        assert!(close(range(&[0.3, 0.4]), (0.2, 2.0)));
        assert_eq!(range_of([0.0, 0.0].into_iter(), Scale::Logarithmic), (1.0, 10.0));
        let (low, high) = range_of([2.0, 2.0].into_iter(), Scale::Linear);
        assert!(low <= 2.0 && high > low);
    }

    #[test]
    fn curves_are_cut_at_the_frame_and_at_gaps() {
        let line = Line {
            label: String::new(),
            points: vec![(-1.0, 0.0), (2.0, 0.0), (3.0, f64::NAN), (4.0, 1.0), (20.0, 1.0)],
            colour: palette::BLUE,
            dashed: false,
        };
        let pieces = pieces(&line, (0.0, 0.0, 10.0, 10.0), &|x| Some(x), &|y| y.is_finite().then_some(y));
        assert_eq!(pieces, [vec![(0.0, 0.0), (2.0, 0.0)], vec![(4.0, 1.0), (10.0, 1.0)]]);
    }
}
