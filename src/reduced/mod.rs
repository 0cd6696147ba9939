//! The real-time model: a table of solved steady states over penetration depth, or applied load where that is given, and sliding speed at
//! one slide-to-roll ratio, and cubic polynomials between them, with a measured error.
//!
//! A step takes microseconds instead of a tenth of a second. The table is refined until states of the full model between its
//! own are met. `quantities.rs` says what is interpolated; how that goes along with first touch and the powers of speed is in
//! `patch.rs`.
//!
//! Loads are interpolated by their logarithm: where the load is given, the *depths* of grid and chart are that. Reversing the speed mirrors the
//! contact, so only rest and positive speeds are solved.

mod chart;
mod curves;
mod making;
mod patch;
mod quantities;

use num_dual::Dual64;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

use crate::equations::grid::{contact_half_width, half_width, moves};
use crate::equations::system::roughness;
use crate::error::Error;
use crate::laws::contact::mobilised_friction;
use crate::outputs::{Derived, Direct, Outputs, RESULTS, STATIONS, profile_stations};
use crate::parameters::{Control, Inputs, PARAMETERS, Parameters};
use chart::{Chart, Side};
pub use making::{Progress, Tolerance};
use patch::{Grid, Manner, Patch, positive};
use quantities::{LOWER_FRICTION, PENETRATION_DEPTH, SCALARS, State, UPPER_FRICTION, mirrored};

/// The inputs that a table covers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Range {
    /// Least and largest penetration depth \[m\]; under [`Control::Load`] least and largest load \[N/m\].
    pub pressed: [f64; 2],
    /// Slowest and fastest speed in either direction \[m/s\]. With 0 the table goes down to rest; else the state of the slowest speed is held below
    /// it.
    pub speeds: [f64; 2],
    /// The one slide-to-roll ratio \[1\].
    pub slide_to_roll_ratio: f64,
}

impl Default for Range {
    fn default() -> Self {
        Self { pressed: [-20e-6, 60e-6], speeds: [0.0, 0.5], slide_to_roll_ratio: 0.0 }
    }
}

/// The input that says how far or how hard the bodies are pressed together: its name, its unit and its value.
fn pressed(control: Control, inputs: &Inputs) -> (&'static str, &'static str, f64) {
    match control {
        Control::Depth => ("penetration_depth", "m", inputs.penetration_depth),
        Control::Load => ("applied_load", "N/m", inputs.applied_load),
    }
}

/// What is interpolated by, from how far or how hard the bodies are pressed together.
fn coordinate(control: Control, pressed: f64) -> f64 {
    match control {
        Control::Depth => pressed,
        Control::Load => pressed.ln(),
    }
}

impl Range {
    /// Refuses inputs that it does not cover.
    fn check(&self, control: Control, inputs: &Inputs) -> Result<(), Error> {
        let [least, most] = self.pressed;
        let ([_, fastest], ratio) = (self.speeds, self.slide_to_roll_ratio);
        let (name, unit, value) = pressed(control, inputs);
        let refuse = |name, value: f64, allowed| {
            Err(Error::value(
                name,
                value,
                format!("{allowed}, which the reduced model covers; fidelity = full has more"),
            ))
        };
        if !(least..=most).contains(&value) {
            return refuse(name, value, format!("a number from {least:e} to {most:e} {unit}"));
        }
        if !(-fastest..=fastest).contains(&inputs.sliding_speed) {
            let allowed = format!("a number from {} to {fastest} m/s", -fastest);
            return refuse("sliding_speed", inputs.sliding_speed, allowed);
        }
        if inputs.slide_to_roll_ratio != ratio {
            return refuse("slide_to_roll_ratio", inputs.slide_to_roll_ratio, format!("{ratio}, the one"));
        }
        Ok(())
    }
}

/// The errors at one state that a finished table was compared with, relative; see [`Accuracy`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// Penetration depth \[m\], or load \[N/m\].
    pub pressed: f64,
    /// Sliding speed \[m/s\].
    pub sliding_speed: f64,
    /// Whether it is near first touch.
    pub near_touch: bool,
    /// Of the load.
    pub load: f64,
    /// Of the least film thickness.
    pub minimum_film_thickness: f64,
    /// Of the friction coefficient.
    pub friction_coefficient: f64,
}

/// Largest and root mean square of an error.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Deviation {
    /// Largest.
    pub largest: f64,
    /// Root mean square.
    pub root_mean_square: f64,
}

/// How far the table is from the full model, measured at states that it was not made from. Where the load is given, what is said of the load is said of
/// the depth.
///
/// The error of a profile is its root mean square over the stations. *Near first touch* of smooth surfaces is within 1/40 of the range of depths. A
/// film is measured against that in the middle of the contact at first touch where it is thinner; at speeds between rest and
/// [`ReducedModel::slowest_line`], against that at the latter's first touch; and between rough surfaces against a tenth of their roughness. Their
/// rolling friction changes its sign: a friction coefficient below 1e-3 is measured against that.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Accuracy {
    /// How many states were compared.
    pub states: usize,
    /// Of the load, relative; but for the next.
    pub load: Deviation,
    /// Of the load near first touch at speeds between rest and [`ReducedModel::slowest_line`], relative.
    pub load_near_touch_at_rest: Deviation,
    /// Of the least film thickness, relative.
    pub minimum_film_thickness: Deviation,
    /// Of the friction coefficient away from first touch, relative.
    pub friction_coefficient: Deviation,
    /// Of the friction coefficient near first touch, relative.
    pub friction_coefficient_near_touch: Deviation,
    /// Of the film profile where it is less than ten times the film in the middle of the contact, relative to that.
    pub film_thickness: Deviation,
    /// Of the profile of the fluid pressure, relative to the largest fluid pressure of the state.
    pub fluid_pressure: Deviation,
    /// Of the profile of the contact pressure away from first touch, relative to the largest contact pressure of the state.
    pub contact_pressure: Deviation,
    /// Of the largest von Mises stress, relative.
    pub maximum_von_mises_stress: Deviation,
    /// Of the contact stiffness away from first touch, relative.
    pub contact_stiffness: Deviation,
}

/// What the bytes hold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Content {
    parameters: Parameters,
    range: Range,
    accuracy: Accuracy,
    checks: Vec<Check>,
    chart: Chart,
    grids: Vec<Grid>,
}

/// The real-time model of one case.
#[derive(Debug, Clone, PartialEq)]
pub struct ReducedModel {
    content: Content,
    patches: Vec<Patch>,
}

const MAGIC: &[u8] = b"CartilageLineContact reduced model 2 ";
const CHECK_SUM_LENGTH: usize = 16;

/// Of the bytes, and of what this version takes them for: names of parameters and results are not among them.
fn check_sum(payload: &[u8]) -> Uuid {
    let names = PARAMETERS.iter().map(|row| row.name).chain(RESULTS.iter().map(|row| row.name));
    let names: String = names.flat_map(|name| [" ", name]).collect();
    let writer = Uuid::new_v5(&Uuid::NAMESPACE_OID, (env!("CARGO_PKG_VERSION").to_owned() + &names).as_bytes());
    Uuid::new_v5(&writer, payload)
}

impl ReducedModel {
    fn new(content: Content) -> Self {
        let p = &content.parameters;
        let manner =
            Manner { logarithmic: positive(&content.grids), stations_move: moves(p), rough: p.surface_roughness > 0.0 };
        let patches = content.grids.iter().map(|grid| Patch::new(grid, &content.chart, manner)).collect();
        Self { content, patches }
    }

    /// The case that it was made from.
    pub fn parameters(&self) -> &Parameters {
        &self.content.parameters
    }

    /// The inputs that it covers.
    pub fn range(&self) -> &Range {
        &self.content.range
    }

    /// Its measured error.
    pub fn accuracy(&self) -> &Accuracy {
        &self.content.accuracy
    }

    /// The states that it was compared with, and the errors there.
    pub fn checks(&self) -> &[Check] {
        &self.content.checks
    }

    /// The slowest speed above 0 at which states were solved \[m/s\]. Between it and rest, the table follows even and odd powers of
    /// the speed.
    pub fn slowest_line(&self) -> f64 {
        self.content.chart.slowest()
    }

    /// Whether the measured error is within a tolerance.
    pub fn keeps(&self, tolerance: &Tolerance) -> bool {
        let Accuracy { load, minimum_film_thickness, friction_coefficient, fluid_pressure, .. } =
            &self.content.accuracy;
        load.largest <= tolerance.load
            && minimum_film_thickness.largest <= tolerance.minimum_film_thickness
            && friction_coefficient.largest <= tolerance.friction_coefficient
            && fluid_pressure.largest <= tolerance.fluid_pressure
    }

    /// How many solved states it has.
    pub fn states(&self) -> usize {
        let chart = &self.content.chart;
        let lines = chart.log_speeds.len() + usize::from(chart.rest.is_some());
        self.content.grids.iter().map(|grid| grid.stations.len() * lines).sum()
    }

    /// The stations of the profiles at these inputs \[m\], ascending: they go with a mesh that goes with the contact.
    pub fn position(&self, inputs: &Inputs) -> Vec<f64> {
        let p = &self.content.parameters;
        profile_stations(half_width(p, contact_half_width(p, inputs, p.control)))
    }

    /// Penetration depth \[m\] or load \[N/m\] at which smooth surfaces first touch at a speed, or at which the film of rough ones is as thin as they are
    /// rough; `None` where that is not in the table.
    pub fn first_touch(&self, sliding_speed: f64) -> Option<f64> {
        let [touch, _] = self.content.chart.touch(sliding_speed.abs())?;
        Some(match self.parameters().control {
            Control::Depth => touch,
            Control::Load => touch.exp(),
        })
    }

    /// What is doubtful about the outputs at these inputs, one sentence each; none where all is well, or where the table does not cover them.
    pub fn warnings(&self, inputs: &Inputs) -> Vec<String> {
        let Content { parameters: Parameters { control, .. }, range, .. } = &self.content;
        let ([slowest, _], speed) = (range.speeds, inputs.sliding_speed.abs());
        let mut warnings = Vec::new();
        if speed < slowest {
            warnings.push(format!(
                "the reduced model has no speeds below {slowest} m/s: the state at that speed is held, and what turns round with the motion goes \
                 through zero"
            ));
        }
        let depth = coordinate(*control, pressed(*control, inputs).2);
        if range.check(*control, inputs).is_ok() && self.is_unresolved(depth, speed) {
            warnings.push(
                "mesh or sector do not resolve a state of the reduced model near these inputs; `cartilage-contact solve` says what is not".into(),
            );
        }
        warnings
    }

    /// Whether their mesh does not resolve a state between which a depth and a speed of 0 or more are.
    fn is_unresolved(&self, depth: f64, speed: f64) -> bool {
        let chart = &self.content.chart;
        let (side, station) = chart.station(self.patches[0].side, depth, speed);
        let patch = self.patches.iter().find(|patch| patch.side == side);
        patch.is_some_and(|patch| patch.is_unresolved(chart, station, speed))
    }

    /// Outputs, and their derivatives with respect to penetration depth (where the load is given, with respect to that), sliding speed and
    /// slide-to-roll ratio.
    ///
    /// Those by the first two are exactly the derivatives of the outputs returned here. The one by the ratio, which is fixed, is
    /// that of the full model, interpolated linearly.
    ///
    /// # Errors
    /// [`Error::Value`] where the table does not cover the inputs, with what it covers.
    pub fn evaluate(&self, inputs: &Inputs) -> Result<(Outputs, [Outputs; 3]), Error> {
        let control = self.parameters().control;
        self.content.range.check(control, inputs)?;
        let depth = coordinate(control, pressed(control, inputs).2);
        let (mut state, side) = self.state(depth, inputs.sliding_speed.abs())?;
        if inputs.sliding_speed < 0.0 {
            state = state.map(|values| mirrored(&values));
            state[2] = state[2].map(|by_speed| -by_speed);
        }
        let (mut outputs, derivatives) = self.outputs(inputs, &state, side);
        outputs.well_resolved = self.warnings(inputs).is_empty();
        Ok((outputs, derivatives))
    }

    /// What is interpolated at a depth and a speed of 0 or more, and on which side of first touch that is.
    fn state(&self, depth: f64, speed: f64) -> Result<(State, Side), Error> {
        let chart = &self.content.chart;
        let (side, station) = chart.station(self.patches[0].side, depth, speed);
        let Some(patch) = self.patches.iter().find(|patch| patch.side == side) else {
            return Err(Error::State("the reduced model has no states there".into()));
        };
        Ok((patch.state(chart, station, speed), side))
    }

    /// Outputs and derivatives from what is interpolated.
    fn outputs(&self, inputs: &Inputs, state: &State, side: Side) -> (Outputs, [Outputs; 3]) {
        let boundary = boundary_friction(&self.content.parameters, inputs);
        let [depth, speed, ratio] = [0, 1, 2].map(|k| self.along(inputs, state, side, k, boundary));
        let values = speed.map(|dual| dual.re);
        (values, [depth, speed, ratio].map(|along| along.map(|dual| dual.eps)))
    }

    /// Outputs with their derivative with respect to one input.
    fn along(&self, inputs: &Inputs, state: &State, side: Side, input: usize, boundary: [f64; 4]) -> Outputs<Dual64> {
        let p = &self.content.parameters;
        // From the slope by the logarithm of the load.
        let scale = if input == 0 && p.control == Control::Load { 1.0 / inputs.applied_load } else { 1.0 };
        let dual = |q: usize| Dual64::new(state[0][q], scale * state[1 + input][q]);
        let along = |value: f64, index: usize| Dual64::new(value, if input == index { 1.0 } else { 0.0 });
        let (mut number, mut profile) = (0, SCALARS);
        let mut direct = Direct::interpolated(
            || {
                number += 1;
                dual(number - 1)
            },
            || {
                profile += STATIONS;
                (profile - STATIONS..profile).map(dual).collect()
            },
        );
        let depth = match p.control {
            Control::Depth => along(inputs.penetration_depth, 0),
            Control::Load => {
                // What is given is kept.
                direct.fluid_load = along(inputs.applied_load, 0) - direct.solid_load;
                dual(PENETRATION_DEPTH)
            }
        };
        let solid_friction = direct.solid_load * Dual64::new(boundary[0], boundary[1 + input]);
        let fluid_friction = [dual(UPPER_FRICTION), dual(LOWER_FRICTION)];
        let speed_and_depth = [along(inputs.sliding_speed, 1), depth];
        let touching = match roughness(p) {
            None => side == Side::Contact,
            Some(rough) => direct.minimum_film_thickness.re < rough.mixed_film(),
        };
        let derived = Derived::new(p, speed_and_depth, &direct, touching, fluid_friction, solid_friction);
        Outputs::new(direct, derived)
    }

    /// The bytes that [`ReducedModel::from_bytes`] reads.
    ///
    /// # Errors
    /// [`Error::State`] where memory runs out.
    pub fn to_bytes(&self) -> Result<Vec<u8>, Error> {
        let payload = postcard::to_stdvec(&self.content).map_err(|error| Error::State(error.to_string()))?;
        Ok([MAGIC, check_sum(&payload).as_bytes(), &payload].concat())
    }

    /// Reads what [`ReducedModel::to_bytes`] wrote.
    ///
    /// # Errors
    /// [`Error::State`] saying what is wrong with the bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Error> {
        let refuse = |why: &str| Err(Error::State(format!("{why}; make it anew with `cartilage-contact reduce`")));
        let Some((sum, payload)) = bytes.strip_prefix(MAGIC).and_then(|rest| rest.split_at_checked(CHECK_SUM_LENGTH))
        else {
            return refuse("these bytes are no reduced model");
        };
        if sum != check_sum(payload).as_bytes() {
            return refuse("the bytes of the reduced model were cut or altered, or another version wrote them");
        }
        let content: Content = postcard::from_bytes(payload).map_err(|error| Error::State(error.to_string()))?;
        let lines = content.chart.log_speeds.len();
        let chart_fits = lines >= 2 && [0, lines].contains(&content.chart.touch.len());
        if !chart_fits || content.grids.is_empty() || !content.grids.iter().all(|grid| grid.fits(&content.chart)) {
            return refuse("the reduced model is incomplete");
        }
        content.parameters.validate()?;
        Ok(Self::new(content))
    }
}

/// What it covers and its measured error, in a line.
impl std::fmt::Display for ReducedModel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (Content { range, accuracy, grids, .. }, percent) = (&self.content, |d: Deviation| 100.0 * d.largest);
        let unresolved = grids.iter().flat_map(|grid| &grid.unresolved).filter(|unresolved| **unresolved).count();
        let control = self.parameters().control;
        let (name, unit, _) = pressed(control, &Inputs::NONE);
        let follows = if control == Control::Load { "penetration depth" } else { "load" };
        write!(
            f,
            "reduced model of {} states: {name} {:e} to {:e} {unit}, sliding_speed {} to {} m/s either way, \
             slide_to_roll_ratio {}; largest errors at {} other states: {follows} {:.2} %, minimum film \
             thickness {:.2} %, friction coefficient {:.2} %, {:.0} % near first touch; pressure profile {:.1} % of its maximum",
            self.states(),
            range.pressed[0],
            range.pressed[1],
            range.speeds[0],
            range.speeds[1],
            range.slide_to_roll_ratio,
            accuracy.states,
            percent(accuracy.load),
            percent(accuracy.minimum_film_thickness),
            percent(accuracy.friction_coefficient),
            percent(accuracy.friction_coefficient_near_touch),
            percent(accuracy.fluid_pressure),
        )?;
        if unresolved > 0 {
            write!(f, "; {unresolved} of its states carry a warning that mesh or sector do not resolve them")?;
        }
        if range.speeds[0] > 0.0 {
            return Ok(());
        }
        let slow = percent(accuracy.load_near_touch_at_rest);
        write!(f, "; load near first touch below {:.1e} m/s {slow:.0} %", self.slowest_line())
    }
}

/// Friction of solid on solid over the solid load, and its derivatives with respect to the three inputs.
fn boundary_friction(p: &Parameters, inputs: &Inputs) -> [f64; 4] {
    let (mobilised, slopes) =
        mobilised_friction(p.formulation, inputs.surface_speeds(), p.friction_regularisation_speed);
    let (u, s) = (inputs.sliding_speed, inputs.slide_to_roll_ratio);
    let by_speed = 0.5 * ((1.0 + s) * slopes[0] + (1.0 - s) * slopes[1]);
    let by_ratio = 0.5 * u * (slopes[0] - slopes[1]);
    [mobilised, 0.0, by_speed, by_ratio].map(|value| value * p.boundary_friction_coefficient)
}

#[cfg(test)]
mod tests {
    use std::sync::LazyLock;

    use proptest::collection;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    use super::*;
    use crate::parameters::Mesh;

    /// The smallest table there is.
    static PAYLOAD: LazyLock<Vec<u8>> = LazyLock::new(|| {
        let mesh = Mesh { columns: 12, rows: 1, ..Parameters::default().mesh };
        let range = Range { pressed: [-9e-6, -8e-6], speeds: [0.1, 0.2], slide_to_roll_ratio: 0.0 };
        let parameters = Parameters { mesh, ..Parameters::default() };
        let model = ReducedModel::build(&parameters, range, Tolerance::default(), 1, &|_| ()).unwrap();
        model.to_bytes().unwrap()[MAGIC.len() + CHECK_SUM_LENGTH..].to_vec()
    });

    proptest! {
        // As many as PROPTEST_CASES says.
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(15), ..ProptestConfig::default() })]
        #[test]
        fn altered_tables_are_refused_or_evaluated(edits in collection::vec((0.0..1.0, any::<u8>(), 0..5_usize), 1..4)) {
            let mut payload = PAYLOAD.clone();
            for (fraction, byte, kind) in edits {
                // Sizes and ranges are at the start.
                let place = (f64::powi(fraction, 4) * payload.len() as f64) as usize;
                match kind {
                    0 => payload[place] = byte,
                    1 => payload[place] ^= 1 << (byte % 8),
                    2 => payload.truncate(place.max(1)),
                    3 => { payload.remove(place); }
                    _ => payload.insert(place, byte),
                }
                if payload.is_empty() { break; }
            }
            let bytes = [MAGIC, check_sum(&payload).as_bytes(), &payload].concat();
            if let Ok(model) = ReducedModel::from_bytes(&bytes) {
                for penetration_depth in [-9e-6, -8.5e-6, -8e-6, 0.0] {
                    for sliding_speed in [0.0, -0.1, 0.15, 0.2] {
                        let _ = model.evaluate(&Inputs { penetration_depth, sliding_speed, ..Inputs::NONE });
                    }
                }
                prop_assert!(!model.to_string().is_empty());
            }
        }
    }
}
