//! A table beside the full model.

use super::super::chart::Side;
use super::super::quantities::CENTRAL_FILM;
use super::super::{Accuracy, Check, Deviation, ReducedModel, pressed};
use super::{Builder, Sample, Tolerance};
use crate::error::Error;
use crate::outputs::Outputs;
use crate::parameters::{Control, Inputs};

/// Friction coefficients between rough surfaces below this are measured against it.
const SMALL_FRICTION: f64 = 1e-3;
/// Within this fraction of the range of depths friction is near first touch.
const NEAR_TOUCH: f64 = 1.0 / 40.0;

impl Builder<'_> {
    pub(super) fn compare(&self, model: &ReducedModel, sample: &Sample) -> Result<Comparison, Error> {
        let inputs = &sample.inputs;
        let side = if sample.touching { Side::Contact } else { Side::Film };
        let (full, full_slopes) = model.outputs(inputs, &sample.state, side);
        // Halfway states may lie beyond the range that is asked for, and first touch is where the table says.
        let chart = &model.content.chart;
        let speed = inputs.sliding_speed;
        let (state, side) = model.state(sample.depth, speed)?;
        let (table, table_slopes) = model.outputs(inputs, &state, side);
        let moving = speed.max(chart.slowest());
        let rms = self.parameters.surface_roughness;
        let thin_film = match chart.touch(moving) {
            Some([depth, _]) if rms == 0.0 => model.state(depth, moving)?.0[0][CENTRAL_FILM],
            _ => 0.1 * rms,
        };
        let near = NEAR_TOUCH * (self.asked[1] - self.asked[0]);
        Ok(Comparison {
            inputs: *inputs,
            near_touch: rms == 0.0 && chart.touch(speed).is_some_and(|[depth, _]| (sample.depth - depth).abs() < near),
            near_rest: speed < chart.slowest(),
            thin_film,
            small_friction: if rms > 0.0 { SMALL_FRICTION } else { 0.0 },
            control: self.parameters.control,
            stiffness: match self.parameters.control {
                Control::Depth => [full_slopes[0].load, table_slopes[0].load],
                Control::Load => [&full_slopes, &table_slopes].map(|slopes| 1.0 / slopes[0].penetration_depth),
            },
            full,
            table,
        })
    }
}

/// The table beside the full model.
pub(super) struct Comparison {
    full: Outputs,
    table: Outputs,
    /// dL/dd of both \[N/m^2\].
    stiffness: [f64; 2],
    inputs: Inputs,
    near_touch: bool,
    /// Whether it is slower than the slowest line.
    near_rest: bool,
    /// Film in the middle of the contact at first touch at this speed; a tenth of the roughness of rough surfaces.
    thin_film: f64,
    /// What friction coefficients below it are measured against.
    small_friction: f64,
    control: Control,
}

impl Comparison {
    /// |table - full| over the larger of |full| and a scale.
    fn relative(&self, of: fn(&Outputs) -> f64, scale: f64) -> f64 {
        deviation([of(&self.full), of(&self.table)], scale)
    }

    /// Of the load, or of the depth where that follows.
    fn load(&self) -> f64 {
        match self.control {
            Control::Depth => self.relative(|o| o.load, 0.0),
            Control::Load => self.relative(|o| o.penetration_depth, 0.0),
        }
    }

    fn film(&self) -> f64 {
        self.relative(|o| o.minimum_film_thickness, self.thin_film)
    }

    fn friction(&self) -> f64 {
        self.relative(|o| o.friction_coefficient, self.small_friction)
    }

    /// The largest error as a multiple of what is allowed.
    pub(super) fn excess(&self, tolerance: &Tolerance) -> f64 {
        let friction = if self.near_touch { 0.0 } else { self.friction() / tolerance.friction_coefficient };
        let load = if self.load_counts() { self.load() / tolerance.load } else { 0.0 };
        load.max(self.film() / tolerance.minimum_film_thickness)
            .max(self.fluid_pressure() / tolerance.fluid_pressure)
            .max(friction)
    }

    /// Towards rest the load at first touch vanishes, and a small load is measured against a smaller one.
    fn load_counts(&self) -> bool {
        !(self.near_touch && self.near_rest)
    }

    /// What is kept of it.
    pub(super) fn check(&self) -> Check {
        Check {
            pressed: pressed(self.control, &self.inputs).2,
            sliding_speed: self.inputs.sliding_speed,
            near_touch: self.near_touch,
            load: self.load(),
            minimum_film_thickness: self.film(),
            friction_coefficient: self.friction(),
        }
    }

    fn fluid_pressure(&self) -> f64 {
        self.profile(|o| &o.fluid_pressure, |_| true, self.full.maximum_fluid_pressure)
    }

    /// Root mean square difference of a profile over a scale, at the stations that `counts` says.
    fn profile(&self, of: fn(&Outputs) -> &[f64], counts: impl Fn(f64) -> bool, scale: f64) -> f64 {
        let stations = of(&self.full).iter().zip(of(&self.table)).filter(|(full, _)| counts(**full));
        let (sum, count) = stations.fold((0.0, 0.0), |(sum, count), (a, b)| (sum + (a - b).powi(2), count + 1.0));
        if sum == 0.0 { 0.0 } else { (sum / count).sqrt() / scale }
    }
}

fn deviation([full, table]: [f64; 2], scale: f64) -> f64 {
    if full == table { 0.0 } else { (table - full).abs() / full.abs().max(scale) }
}

pub(super) fn accuracy(comparisons: &[Comparison]) -> Accuracy {
    let of = |error: &dyn Fn(&Comparison) -> Option<f64>| {
        let errors: Vec<f64> = comparisons.iter().filter_map(error).collect();
        let mean = errors.iter().map(|e| e * e).sum::<f64>() / errors.len().max(1) as f64;
        Deviation { largest: errors.iter().copied().fold(0.0, f64::max), root_mean_square: mean.sqrt() }
    };
    Accuracy {
        states: comparisons.len(),
        load: of(&|c| c.load_counts().then(|| c.load())),
        load_near_touch_at_rest: of(&|c| (!c.load_counts()).then(|| c.load())),
        minimum_film_thickness: of(&|c| Some(c.film())),
        friction_coefficient: of(&|c| (!c.near_touch).then(|| c.friction())),
        friction_coefficient_near_touch: of(&|c| c.near_touch.then(|| c.friction())),
        film_thickness: of(&|c| {
            let scale = c.full.central_film_thickness.max(c.thin_film);
            Some(c.profile(|o| &o.film_thickness, |h| h < 10.0 * scale, scale))
        }),
        fluid_pressure: of(&|c| Some(c.fluid_pressure())),
        contact_pressure: of(&|c| {
            let scale = c.full.maximum_contact_pressure;
            (!c.near_touch && scale > 0.0).then(|| c.profile(|o| &o.contact_pressure, |_| true, scale))
        }),
        maximum_von_mises_stress: of(&|c| Some(c.relative(|o| o.maximum_von_mises_stress, 0.0))),
        contact_stiffness: of(&|c| (!c.near_touch).then(|| deviation(c.stiffness, 0.0))),
    }
}
