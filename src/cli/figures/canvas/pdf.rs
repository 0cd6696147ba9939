//! A figure as PDF, as wide as a page of two columns.
//!
//! Text is drawn as outlines: it looks the same wherever the file is opened, and no font has to be embedded.

use std::cell::RefCell;

use ab_glyph::{Font, FontRef, OutlineCurve, Point};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref};
use plotters::style::RGBColor;
use plotters::style::text_anchor::{HPos, VPos};

use super::{Anchor, Canvas, Draw, Lettering};

/// 174 mm, the width of a page with two columns, in points.
const WIDTH: f64 = 174.0 / 25.4 * 72.0;

struct Page<'a> {
    content: RefCell<Content>,
    /// What areas let through, each used by its index.
    opacities: RefCell<Vec<f64>>,
    regular: FontRef<'a>,
    bold: FontRef<'a>,
}

fn name(index: usize) -> String {
    format!("a{index}")
}

fn components(RGBColor(r, g, b): RGBColor) -> [f32; 3] {
    [r, g, b].map(|part| f32::from(part) / 255.0)
}

impl Page<'_> {
    fn font(&self, style: &Lettering) -> (&FontRef<'_>, f64) {
        let font = if style.bold { &self.bold } else { &self.regular };
        (font, style.size / f64::from(font.height_unscaled()))
    }

    /// Makes this opacity the present one.
    fn fill_with(&self, colour: RGBColor, opacity: f64) {
        let mut opacities = self.opacities.borrow_mut();
        let index = opacities.iter().position(|known| *known == opacity).unwrap_or_else(|| {
            opacities.push(opacity);
            opacities.len() - 1
        });
        let [r, g, b] = components(colour);
        self.content.borrow_mut().set_parameters(Name(name(index).as_bytes())).set_fill_rgb(r, g, b);
    }
}

fn add_path(content: &mut Content, points: &[(f64, f64)]) {
    for (index, (x, y)) in points.iter().enumerate() {
        let (x, y) = (*x as f32, *y as f32);
        if index == 0 {
            content.move_to(x, y)
        } else {
            content.line_to(x, y)
        };
    }
}

impl Canvas for Page<'_> {
    fn line(&self, points: &[(f64, f64)], colour: RGBColor, width: f64) -> Result<(), String> {
        let [r, g, b] = components(colour);
        let mut content = self.content.borrow_mut();
        content.set_stroke_rgb(r, g, b).set_line_width(width as f32);
        add_path(&mut content, points);
        content.stroke();
        Ok(())
    }

    fn area(&self, points: &[(f64, f64)], colour: RGBColor, opacity: f64) -> Result<(), String> {
        self.fill_with(colour, opacity);
        let mut content = self.content.borrow_mut();
        add_path(&mut content, points);
        content.close_path();
        if opacity < 1.0 {
            content.fill_nonzero();
        } else {
            // Its edge too: viewers smooth edges, and a seam would show between neighbours.
            let [r, g, b] = components(colour);
            content.set_stroke_rgb(r, g, b).set_line_width(0.5).fill_nonzero_and_stroke();
        }
        Ok(())
    }

    fn text(&self, text: &str, (x, y): (f64, f64), style: &Lettering) -> Result<(), String> {
        let (font, scale) = self.font(style);
        let width = self.text_width(text, style);
        let Anchor(horizontal, vertical) = style.anchor;
        let mut along = match horizontal {
            HPos::Left => 0.0,
            HPos::Center => -0.5 * width,
            HPos::Right => -width,
        };
        let top = match vertical {
            VPos::Top => 0.0,
            VPos::Center => -0.5 * style.size,
            VPos::Bottom => -style.size,
        };
        let baseline = top + scale * f64::from(font.ascent_unscaled());
        self.fill_with(style.colour, 1.0);
        let mut content = self.content.borrow_mut();
        for letter in text.chars() {
            let glyph = font.glyph_id(letter);
            let place = |point: Point| {
                let (u, v) = (along + scale * f64::from(point.x), baseline - scale * f64::from(point.y));
                let (x, y) = if style.upwards { (x + v, y - u) } else { (x + u, y + v) };
                (x as f32, y as f32)
            };
            let mut end = None;
            for curve in font.outline(glyph).map(|outline| outline.curves).unwrap_or_default() {
                let (start, controls, last) = match curve {
                    OutlineCurve::Line(a, b) => (a, None, b),
                    OutlineCurve::Quad(a, c, b) => {
                        let towards = |p: Point| Point { x: (p.x + 2.0 * c.x) / 3.0, y: (p.y + 2.0 * c.y) / 3.0 };
                        (a, Some((towards(a), towards(b))), b)
                    }
                    OutlineCurve::Cubic(a, c, d, b) => (a, Some((c, d)), b),
                };
                if end != Some(start) {
                    let (x, y) = place(start);
                    content.move_to(x, y);
                }
                let (x, y) = place(last);
                match controls.map(|(c, d)| (place(c), place(d))) {
                    Some((c, d)) => content.cubic_to(c.0, c.1, d.0, d.1, x, y),
                    None => content.line_to(x, y),
                };
                end = Some(last);
            }
            content.fill_nonzero();
            along += scale * f64::from(font.h_advance_unscaled(glyph));
        }
        Ok(())
    }

    fn text_width(&self, text: &str, style: &Lettering) -> f64 {
        let (font, scale) = self.font(style);
        text.chars().map(|letter| scale * f64::from(font.h_advance_unscaled(font.glyph_id(letter)))).sum()
    }
}

/// The figure as a PDF of one page.
pub fn document((width, height): (u32, u32), draw: Draw<'_>) -> Result<Vec<u8>, String> {
    let font = |bytes| FontRef::try_from_slice(bytes).map_err(|error| error.to_string());
    let scale = (WIDTH / f64::from(width)) as f32;
    let size = [width, height].map(|length| scale * length as f32);
    let mut content = Content::new();
    // From the top down.
    content.transform([scale, 0.0, 0.0, -scale, 0.0, size[1]]);
    let page = Page {
        content: RefCell::new(content),
        opacities: RefCell::default(),
        regular: font(ttf_noto_sans::REGULAR)?,
        bold: font(ttf_noto_sans::BOLD)?,
    };
    draw(&page)?;
    let opacities = page.opacities.into_inner();
    let bytes = miniz_oxide::deflate::compress_to_vec_zlib(&page.content.into_inner().finish(), 6);

    let [catalog, pages, only, stream] = [1, 2, 3, 4].map(Ref::new);
    let state = |index: usize| Ref::new(5 + index as i32);
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([only]).count(1);
    let mut description = pdf.page(only);
    description.media_box(Rect::new(0.0, 0.0, size[0], size[1])).parent(pages).contents(stream);
    let mut resources = description.resources();
    let mut states = resources.ext_g_states();
    for index in 0..opacities.len() {
        states.pair(Name(name(index).as_bytes()), state(index));
    }
    states.finish();
    resources.finish();
    description.finish();
    for (index, opacity) in opacities.iter().enumerate() {
        pdf.ext_graphics(state(index)).non_stroking_alpha(*opacity as f32);
    }
    pdf.stream(stream, &bytes).filter(Filter::FlateDecode);
    Ok(pdf.finish())
}
