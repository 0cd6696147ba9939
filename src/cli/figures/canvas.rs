//! Where figures are drawn: lines, areas and text in points, written as SVG, as PNG and as PDF.
//!
//! The one place that knows the plotting library. Text is measured and, in the PNG, drawn with a font that is part of the
//! program, so that figures look alike on machines that have no fonts installed.

mod pdf;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use cartilage_contact::error::Error;
use cartilage_contact::files;
use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{PathElement, Polygon, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontFamily, FontStyle, FontTransform, RGBColor, ShapeStyle, TextStyle, WHITE};

/// Pixels a point, before the PNG is averaged down and the SVG is scaled down. The plotting library rounds to whole pixels
/// and does not smooth thick lines; this hides both.
const OVERSAMPLING: u32 = 3;

/// Colours that stay apart for colour-blind readers and in grey (Okabe and Ito).
pub mod palette {
    use super::RGBColor;
    pub const BLACK: RGBColor = RGBColor(0x22, 0x22, 0x22);
    pub const GREY: RGBColor = RGBColor(0x77, 0x77, 0x77);
    pub const BLUE: RGBColor = RGBColor(0x00, 0x72, 0xB2);
    pub const VERMILION: RGBColor = RGBColor(0xD5, 0x5E, 0x00);
    pub const GREEN: RGBColor = RGBColor(0x00, 0x9E, 0x73);
    pub const ORANGE: RGBColor = RGBColor(0xE6, 0x9F, 0x00);
}

/// Where a text's position lies relative to the text: horizontally, vertically.
#[derive(Clone, Copy)]
pub struct Anchor(pub HPos, pub VPos);

/// A drawing surface measured in points, the origin at the top left.
pub trait Canvas {
    /// A line through points.
    fn line(&self, points: &[(f64, f64)], colour: RGBColor, width: f64) -> Result<(), String>;
    /// A filled area.
    fn area(&self, points: &[(f64, f64)], colour: RGBColor, opacity: f64) -> Result<(), String>;
    /// A line of text of this height.
    fn text(&self, text: &str, at: (f64, f64), style: &Lettering) -> Result<(), String>;
    /// Width that a text will take.
    fn text_width(&self, text: &str, style: &Lettering) -> f64;
}

/// How a text looks.
#[derive(Clone, Copy)]
pub struct Lettering {
    /// Height in points.
    pub size: f64,
    /// Colour.
    pub colour: RGBColor,
    /// Bold or not.
    pub bold: bool,
    /// Whether it reads upwards.
    pub upwards: bool,
    /// What of the text is placed.
    pub anchor: Anchor,
}

impl Lettering {
    /// Plain dark text.
    pub fn plain(size: f64, horizontal: HPos, vertical: VPos) -> Self {
        Self { size, colour: palette::BLACK, bold: false, upwards: false, anchor: Anchor(horizontal, vertical) }
    }
}

struct Surface<'a, B: DrawingBackend> {
    area: &'a DrawingArea<B, Shift>,
}

impl<B: DrawingBackend> Surface<'_, B> {
    fn pixel((x, y): (f64, f64)) -> (i32, i32) {
        let scale = f64::from(OVERSAMPLING);
        ((x * scale).round() as i32, (y * scale).round() as i32)
    }

    fn style(lettering: &Lettering) -> TextStyle<'_> {
        let style = if lettering.bold { FontStyle::Bold } else { FontStyle::Normal };
        let Anchor(horizontal, vertical) = lettering.anchor;
        let style = TextStyle::from((FontFamily::SansSerif, lettering.size * f64::from(OVERSAMPLING), style))
            .pos(Pos::new(horizontal, vertical));
        let style = style.color(&lettering.colour);
        if lettering.upwards { style.transform(FontTransform::Rotate270) } else { style }
    }
}

impl<B: DrawingBackend> Canvas for Surface<'_, B> {
    fn line(&self, points: &[(f64, f64)], colour: RGBColor, width: f64) -> Result<(), String> {
        let points: Vec<_> = points.iter().map(|&p| Self::pixel(p)).collect();
        let width = (width * f64::from(OVERSAMPLING)).round().max(1.0) as u32;
        self.area.draw(&PathElement::new(points, colour.stroke_width(width))).map_err(|e| e.to_string())
    }

    fn area(&self, points: &[(f64, f64)], colour: RGBColor, opacity: f64) -> Result<(), String> {
        let points: Vec<_> = points.iter().map(|&p| Self::pixel(p)).collect();
        let style = ShapeStyle { color: colour.mix(opacity), filled: true, stroke_width: 0 };
        self.area.draw(&Polygon::new(points, style)).map_err(|e| e.to_string())
    }

    fn text(&self, text: &str, at: (f64, f64), style: &Lettering) -> Result<(), String> {
        if text.is_empty() {
            return Ok(());
        }
        let style = Self::style(style);
        self.area.draw(&Text::new(text.to_owned(), Self::pixel(at), style)).map_err(|e| e.to_string())
    }

    fn text_width(&self, text: &str, style: &Lettering) -> f64 {
        let size = self.area.estimate_text_size(text, &Self::style(style));
        size.map_or(0.0, |(width, _)| f64::from(width) / f64::from(OVERSAMPLING))
    }
}

fn register_fonts() {
    static ONCE: OnceLock<()> = OnceLock::new();
    ONCE.get_or_init(|| {
        // Fails only for bytes that are no font; these are part of the program, and a test draws with them.
        let _ = plotters::style::register_font("sans-serif", FontStyle::Normal, ttf_noto_sans::REGULAR);
        let _ = plotters::style::register_font("sans-serif", FontStyle::Bold, ttf_noto_sans::BOLD);
    });
}

/// What draws a figure onto a canvas.
pub type Draw<'a> = &'a dyn Fn(&dyn Canvas) -> Result<(), String>;

/// The figure as an SVG document.
pub fn to_svg((width, height): (u32, u32), draw: Draw<'_>) -> Result<String, String> {
    register_fonts();
    let pixels = (width * OVERSAMPLING, height * OVERSAMPLING);
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, pixels).into_drawing_area();
        area.fill(&WHITE).map_err(|e| e.to_string())?;
        draw(&Surface { area: &area })?;
        area.present().map_err(|e| e.to_string())?;
    }
    let large = format!("width=\"{}\" height=\"{}\"", pixels.0, pixels.1);
    let text = text.replacen(&large, &format!("width=\"{width}\" height=\"{height}\""), 1);
    // The font that text was measured with, then what is nearly as narrow.
    Ok(text.replace("font-family=\"sans-serif\"", "font-family=\"Noto Sans, Helvetica, Arial, sans-serif\""))
}

/// The figure as rows of RGB pixels, one a point.
fn to_pixels((width, height): (u32, u32), draw: Draw<'_>) -> Result<Vec<u8>, String> {
    register_fonts();
    let n = OVERSAMPLING as usize;
    let (columns, rows) = (width as usize, height as usize);
    let mut fine = vec![0_u8; columns * rows * 3 * n * n];
    {
        let size = (width * OVERSAMPLING, height * OVERSAMPLING);
        let area = BitMapBackend::with_buffer(&mut fine, size).into_drawing_area();
        area.fill(&WHITE).map_err(|e| e.to_string())?;
        draw(&Surface { area: &area })?;
        area.present().map_err(|e| e.to_string())?;
    }
    let average = |row: usize, column: usize, channel: usize| -> u8 {
        let sum: usize = (0..n * n)
            .map(|k| ((row * n + k / n) * columns * n + column * n + k % n) * 3 + channel)
            .map(|index| usize::from(fine[index]))
            .sum();
        (sum / (n * n)) as u8
    };
    Ok((0..rows * columns * 3).map(|i| average(i / 3 / columns, i / 3 % columns, i % 3)).collect())
}

/// Writes a figure as `stem.svg`, `stem.png` and `stem.pdf`, and returns the paths.
///
/// # Errors
/// [`Error::File`] naming the file that could not be written.
pub fn save(stem: &Path, size: (u32, u32), draw: Draw<'_>) -> Result<[PathBuf; 3], Error> {
    let [svg, png, pdf] = ["svg", "png", "pdf"].map(|ending| stem.with_extension(ending));
    let text = to_svg(size, draw).map_err(|message| files::unwritten(&svg, message))?;
    files::replace(&svg, text.as_bytes())?;
    let bytes = to_pixels(size, draw).and_then(|pixels| png_bytes(size, &pixels));
    files::replace(&png, &bytes.map_err(|message| files::unwritten(&png, message))?)?;
    let document = pdf::document(size, draw).map_err(|message| files::unwritten(&pdf, message))?;
    files::replace(&pdf, &document)?;
    Ok([svg, png, pdf])
}

fn png_bytes((width, height): (u32, u32), pixels: &[u8]) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().map_err(|e| e.to_string())?;
    writer.write_image_data(pixels).map_err(|e| e.to_string())?;
    writer.finish().map_err(|e| e.to_string())?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_is_part_of_the_program() {
        let draw = |canvas: &dyn Canvas| {
            let style = Lettering::plain(20.0, HPos::Left, VPos::Top);
            let (narrow, wide) = (canvas.text_width("i", &style), canvas.text_width("W", &style));
            assert!(narrow > 2.0 && wide > 2.0 * narrow, "{narrow} {wide}");
            canvas.text("Film thickness \u{b5}m", (5.0, 5.0), &style)
        };
        let pixels = to_pixels((200, 40), &draw).unwrap();
        assert_eq!(pixels.len(), 200 * 40 * 3);
        assert!(pixels.iter().filter(|&&value| value < 128).count() > 500, "text leaves ink");
        let svg = to_svg((200, 40), &draw).unwrap();
        assert!(svg.contains("width=\"200\" height=\"40\" viewBox=\"0 0 600 120\""), "{svg}");
        assert!(svg.contains("Film thickness"));
    }
}
