//! What tests of cartilage report in place of the model's parameters: other pairs of moduli, and hydraulic permeability.
//!
//! Case files and flags take these names for a body, `upper.`, `lower.` or `both.`. One source, a file or all flags together, gives
//! one pair of moduli for a body; order does not matter.

use crate::error::Error;
use crate::parameters::{Parameters, Value};
use crate::units::Unit;

/// A quantity that stands for parameters of a body.
#[derive(Debug)]
pub struct Measured {
    /// Name after `upper.` and the like.
    pub name: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// What it is, in one sentence.
    pub description: &'static str,
    minimum: f64,
    maximum: f64,
    /// Parameters of the body that follow from it.
    stands_for: &'static [&'static str],
}

const MODULI: &[&str] = &["shear_modulus", "bulk_modulus"];
const PERMEABILITY: &[&str] = &["permeability"];

/// Every such quantity.
pub static MEASURED: [Measured; 4] = [
    Measured {
        name: "aggregate_modulus",
        unit: Unit::Pascal,
        description: "Drained modulus of confined compression; with poisson_ratio, in place of shear_modulus and bulk_modulus",
        minimum: 1e2,
        maximum: 1e10,
        stands_for: MODULI,
    },
    Measured {
        name: "young_modulus",
        unit: Unit::Pascal,
        description: "Drained Young's modulus; with poisson_ratio, in place of shear_modulus and bulk_modulus",
        minimum: 1e2,
        maximum: 1e10,
        stands_for: MODULI,
    },
    Measured {
        name: "poisson_ratio",
        unit: Unit::One,
        description: "Drained Poisson's ratio; with aggregate_modulus or young_modulus",
        minimum: -0.99,
        maximum: 0.499,
        stands_for: MODULI,
    },
    Measured {
        name: "hydraulic_permeability",
        unit: Unit::MetreToTheFourthPerNewtonSecond,
        description: "Permeability over viscosity of the fluid in the pores, in place of permeability",
        minimum: 1e-21,
        maximum: 1e-6,
        stands_for: PERMEABILITY,
    },
];

const AGGREGATE: usize = 0;
const YOUNG: usize = 1;
const POISSON: usize = 2;
const HYDRAULIC: usize = 3;

const BODIES: [&str; 2] = ["upper", "lower"];

impl Measured {
    /// The quantity with a full name such as `upper.poisson_ratio`.
    pub fn find(full: &str) -> Option<&'static Self> {
        place(full).map(|[_, row]| &MEASURED[row])
    }

    /// What is allowed, in words.
    pub fn allowed(&self) -> String {
        format!("a number from {:e} to {:e} {}", self.minimum, self.maximum, self.unit.name()).trim_end().into()
    }

    /// Whether the parameter with the full name `parameter` follows from the quantity with the full name `given`.
    pub fn decides(given: &str, parameter: &str) -> bool {
        let (Some(row), Some((body, _))) = (Self::find(given), given.split_once('.')) else { return false };
        row.stands_for.iter().any(|name| parameter.split_once('.') == Some((body, name)))
    }
}

/// Body and row of a full name.
fn place(full: &str) -> Option<[usize; 2]> {
    let (body, name) = full.split_once('.')?;
    let body = BODIES.iter().position(|known| *known == body)?;
    Some([body, MEASURED.iter().position(|row| row.name == name)?])
}

/// What one source gives of the quantities and of the parameters that they stand for.
#[derive(Debug, Default)]
pub struct Given {
    /// Value, and which assignment it is from, by body and row.
    values: [[Option<(f64, usize)>; MEASURED.len()]; 2],
    /// Whether these parameters of each body were given: moduli, permeability.
    direct: [[bool; 2]; 2],
}

impl Given {
    /// Takes note of an assignment; whether it was that of a quantity, which is set by [`Self::resolve`].
    ///
    /// # Errors
    /// [`Error::Value`] where the value is out of range.
    pub fn note(&mut self, full: &str, value: &Value, assignment: usize) -> Result<bool, Error> {
        if let Some([body, row]) = place(full) {
            let measured = &MEASURED[row];
            let number = match value {
                Value::Real(v) => *v,
                Value::Integer(v) => *v as f64,
                _ => f64::NAN,
            };
            if !(measured.minimum..=measured.maximum).contains(&number) {
                return Err(Error::value(full, value, measured.allowed()));
            }
            self.values[body][row] = Some((number, assignment));
            return Ok(true);
        }
        if let Some((body, name)) = full.split_once('.')
            && let Some(body) = BODIES.iter().position(|known| *known == body)
        {
            self.direct[body][0] |= MODULI.contains(&name);
            self.direct[body][1] |= PERMEABILITY.contains(&name);
        }
        Ok(false)
    }

    /// The parameters that follow, with their values, for `set`; on an error also which assignment is wrong.
    ///
    /// # Errors
    /// [`Error::Value`] where quantities contradict each other, or one lacks its partner.
    pub fn resolve(
        &self,
        parameters: &mut Parameters,
        mut set: impl FnMut(&mut Parameters, &str, f64) -> Result<(), Error>,
    ) -> Result<(), (usize, Error)> {
        for ((body, values), direct) in BODIES.iter().zip(&self.values).zip(&self.direct) {
            let refuse = |row: usize, (value, assignment): (f64, usize), allowed: String| {
                Err((assignment, Error::value(&format!("{body}.{}", MEASURED[row].name), value, allowed)))
            };
            let pairs = "one pair: aggregate_modulus and poisson_ratio, young_modulus and poisson_ratio, or shear_modulus and \
                         bulk_modulus";
            let first = (AGGREGATE..=POISSON).find_map(|row| values[row].map(|given| (row, given)));
            if let (Some((row, given)), true) = (first, direct[0]) {
                let other = format!("where {body}.shear_modulus or {body}.bulk_modulus is given too; give {pairs}");
                return refuse(row, given, other);
            }
            let pair = match (values[AGGREGATE], values[YOUNG], values[POISSON]) {
                (Some(_), Some(young), _) => {
                    return refuse(YOUNG, young, format!("beside {body}.aggregate_modulus; give {pairs}"));
                }
                (Some(given), None, None) => {
                    return refuse(AGGREGATE, given, format!("without {body}.poisson_ratio; give {pairs}"));
                }
                (None, Some(given), None) => {
                    return refuse(YOUNG, given, format!("without {body}.poisson_ratio; give {pairs}"));
                }
                (None, None, Some(given)) => {
                    let partner = format!("without {body}.aggregate_modulus or {body}.young_modulus; give {pairs}");
                    return refuse(POISSON, given, partner);
                }
                (Some((aggregate, assignment)), None, Some((nu, _))) => {
                    let shear = aggregate * (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu));
                    Some((shear, aggregate * (1.0 + nu) / (3.0 * (1.0 - nu)), assignment))
                }
                (None, Some((young, assignment)), Some((nu, _))) => {
                    Some((young / (2.0 * (1.0 + nu)), young / (3.0 * (1.0 - 2.0 * nu)), assignment))
                }
                (None, None, None) => None,
            };
            if let Some((shear, bulk, assignment)) = pair {
                for (name, value) in MODULI.iter().zip([shear, bulk]) {
                    set(parameters, &format!("{body}.{name}"), value).map_err(|error| (assignment, error))?;
                }
            }
            if let Some(given) = values[HYDRAULIC] {
                if direct[1] {
                    return refuse(HYDRAULIC, given, format!("beside {body}.permeability; give one of them"));
                }
                let (hydraulic, assignment) = given;
                let intrinsic = hydraulic * parameters.viscosity_in_pores();
                set(parameters, &format!("{body}.permeability"), intrinsic).map_err(|error| (assignment, error))?;
            }
        }
        Ok(())
    }
}
