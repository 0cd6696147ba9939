//! A walking cycle, in time and quasi-steady: what is given, and what film, friction and tissue make of it.

use std::path::{Path, PathBuf};

use cartilage_contact::error::Error;
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::Inputs;
use plotters::style::RGBColor;
use plotters::style::text_anchor::{HPos, VPos};

use super::canvas::{self, Canvas, Lettering, palette};
use super::panel::{self, Axis, Line, Panel, Scale, range_of};

/// An estimated error of the film above this is a film that the mesh does not resolve.
pub const RESOLVED: f64 = 0.1;

/// The least film thickness where the mesh resolves it \[m\].
pub fn resolved_film(outputs: &Outputs) -> Option<f64> {
    Some(outputs.minimum_film_thickness).filter(|_| outputs.estimated_film_error <= RESOLVED)
}

const SIZE: (u32, u32) = (1600, 1510);

/// One communication point.
#[derive(Clone)]
pub struct State {
    /// From the start of the first cycle \[s\].
    pub time: f64,
    /// From the start of its own cycle \[s\].
    pub phase: f64,
    /// What was given.
    pub inputs: Inputs,
    /// What came of it.
    pub outputs: Outputs,
    /// Fluid that left the tissue since the start of its cycle, less what the tissue took in, per unit depth \[m^2\].
    pub exchange: f64,
}

/// Writes the figure as SVG, PNG and PDF.
///
/// # Errors
/// [`Error::File`] naming the file that could not be written.
pub fn save(stem: &Path, transient: &[State], steady: &[State]) -> Result<[PathBuf; 3], Error> {
    canvas::save(stem, SIZE, &|canvas| draw(canvas, transient, steady))
}

fn draw(canvas: &dyn Canvas, transient: &[State], steady: &[State]) -> Result<(), String> {
    let title = Lettering { bold: true, ..Lettering::plain(28.0, HPos::Left, VPos::Top) };
    canvas.text("A walking cycle", (40.0, 22.0), &title)?;
    let subtitle = Lettering { colour: palette::GREY, ..Lettering::plain(22.0, HPos::Left, VPos::Top) };
    let text = "Load and speed are given, depth follows: in time, when the cycle repeats; and as steady states. \
                Dotted: sliding turns.";
    canvas.text(text, (40.0, 62.0), &subtitle)?;
    let panels = panels(transient, steady);
    let (first, last, gap) = (140.0, 1435.0, 50.0);
    let rows = panels.len() / 2;
    let height = (last - first - gap * (rows as f64 - 1.0)) / rows as f64;
    for (index, content) in panels.iter().enumerate() {
        let left = if index % 2 == 0 { 110.0 } else { 910.0 };
        let top = first + (index / 2) as f64 * (height + gap);
        panel::draw(canvas, (left, top, left + 660.0, top + height), content)?;
    }
    Ok(())
}

/// One line through the states.
fn line(states: &[State], label: &str, colour: RGBColor, dashed: bool, get: impl Fn(&State) -> f64) -> Line {
    let points = states.iter().map(|state| (state.phase, get(state))).collect();
    Line { label: label.into(), points, colour, dashed }
}

/// A line with gaps where there is no state for longer than a step.
fn broken(line: Line, step: f64) -> Line {
    let mut points: Vec<(f64, f64)> = Vec::new();
    for point in line.points {
        if let Some(last) = points.last().filter(|last| point.0 - last.0 > 1.5 * step) {
            points.push((last.0, f64::NAN));
        }
        points.push(point);
    }
    Line { points, ..line }
}

fn panels(transient: &[State], steady: &[State]) -> Vec<Panel> {
    let period = transient.last().map_or(1.0, |state| state.phase);
    // Where the speed changes its sign, between two states.
    let turns: Vec<_> = transient
        .windows(2)
        .filter(|pair| (pair[0].inputs.sliding_speed < 0.0) != (pair[1].inputs.sliding_speed < 0.0))
        .map(|pair| {
            let [a, b] = [&pair[0], &pair[1]];
            let fraction = a.inputs.sliding_speed / (a.inputs.sliding_speed - b.inputs.sliding_speed);
            (a.phase + fraction * (b.phase - a.phase), palette::GREY)
        })
        .collect();
    let panel = |title: &str, label: &str, scale: Scale, lines: Vec<Line>| {
        let values = lines.iter().flat_map(|line| line.points.iter().map(|point| point.1));
        let range = range_of(values, scale);
        Panel {
            title: title.into(),
            x: Axis::linear("Time since heel strike [s]", (0.0, period)),
            y: Axis { label: label.into(), range, scale },
            label_x: false,
            bands: Vec::new(),
            marks: turns.clone(),
            lines,
        }
    };
    let both = |get: &dyn Fn(&State) -> f64| {
        let dashed = line(steady, "quasi-steady", palette::VERMILION, true, get);
        let dashed = broken(dashed, period / (transient.len().max(2) - 1) as f64);
        let lines = vec![dashed, line(transient, "in time", palette::BLUE, false, get)];
        lines.into_iter().filter(|line| !line.points.is_empty()).collect()
    };
    let result =
        |title: &str, label: &str, scale: Scale, get: &dyn Fn(&State) -> f64| panel(title, label, scale, both(get));
    let largest = transient.iter().map(|state| state.outputs.friction_coefficient).fold(0.0, f64::max);
    fn carried(states: &[State], label: &str, colour: RGBColor, dashed: bool, get: fn(&Outputs) -> f64) -> Line {
        line(states, label, colour, dashed, move |state| get(&state.outputs))
    }
    use Scale::{Linear, Logarithmic};
    let mut panels = vec![
        panel(
            "Load per unit width",
            "L [N/m]",
            Linear,
            vec![
                carried(transient, "total", palette::BLACK, false, |o| o.load),
                carried(transient, "fluid, in time", palette::GREEN, true, |o| o.fluid_load),
                carried(transient, "solid, in time", palette::ORANGE, false, |o| o.solid_load),
            ],
        ),
        panel(
            "Sliding speed",
            "U [m/s]",
            Linear,
            vec![line(transient, "", palette::BLACK, false, |state| state.inputs.sliding_speed)],
        ),
        result("Thinnest film", "h [\u{b5}m]", Linear, &|state| {
            resolved_film(&state.outputs).map_or(f64::NAN, |film| 1e6 * film)
        }),
        result("Penetration depth", "d [\u{b5}m]", Linear, &|state| 1e6 * state.outputs.penetration_depth),
        result("Friction coefficient", "\u{3bc} [\u{2212}]", Logarithmic, &|state| {
            // Where sliding turns there is none, and a logarithm would show little else.
            Some(state.outputs.friction_coefficient).filter(|friction| *friction > 1e-2 * largest).unwrap_or(f64::NAN)
        }),
        result("Fluid load support", "[\u{2212}]", Linear, &|state| state.outputs.fluid_load_support),
        result("Contact length", "b [mm]", Linear, &|state| 1e3 * state.outputs.contact_length),
        result("Fluid given off by the tissue", "[mm\u{b2}]", Linear, &|state| 1e6 * state.exchange),
        result("Power put in by the turning bones", "[mW]", Linear, &|state| 1e3 * state.outputs.rotation_power),
        panel(
            "Where the work goes",
            "[mW]",
            Linear,
            vec![
                carried(transient, "film, in time", palette::BLUE, false, |o| 1e3 * o.film_dissipation),
                carried(transient, "pores", palette::GREEN, true, |o| 1e3 * o.pore_flow_dissipation),
                carried(transient, "boundary friction", palette::ORANGE, false, |o| {
                    1e3 * o.boundary_friction_dissipation
                }),
            ],
        ),
    ];
    let upper = panels.len() - 2;
    for lower in &mut panels[upper..] {
        lower.label_x = true;
    }
    panels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_figure_names_its_quantities_and_marks_where_sliding_turns() {
        let state = |phase: f64| State {
            time: phase,
            phase,
            inputs: Inputs { sliding_speed: 0.5 - phase, ..Inputs::NONE },
            outputs: Outputs { load: 10.0, friction_coefficient: 0.1, ..Outputs::default() },
            exchange: 0.0,
        };
        let states: Vec<State> = (0..=4).map(|i| state(0.3 * f64::from(i))).collect();
        assert!(
            panels(&states, &states)
                .iter()
                .all(|panel| matches!(panel.marks[..], [(at, _)] if (at - 0.5).abs() < 1e-12))
        );
        let svg = canvas::to_svg(SIZE, &|canvas| draw(canvas, &states, &states)).unwrap();
        for text in [
            "Load per unit width",
            "Sliding speed",
            "Thinnest film",
            "Fluid load support",
            "Where the work goes",
            "quasi-steady",
            "heel strike [s]",
        ] {
            assert!(svg.contains(text), "{text} is missing");
        }
    }
}
