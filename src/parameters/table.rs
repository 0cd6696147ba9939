//! The table of parameters: names, units, ranges and descriptions, and how values are read and set by name.

use super::{Control, Fidelity, Formulation, PRESETS, Parameters, PermeabilityLaw, TimeIntegration, presets};
use crate::error::Error;
use crate::units::Unit;

/// How the value of a [`Parameter`] is stored, with its range.
pub enum Kind {
    /// A real number within `minimum..=maximum`.
    Real {
        /// Smallest allowed value.
        minimum: f64,
        /// Largest allowed value.
        maximum: f64,
        /// Order of magnitude.
        nominal: f64,
        /// Where it is kept.
        access: fn(&mut Parameters) -> &mut f64,
    },
    /// A whole number within `minimum..=maximum`.
    Integer {
        /// Smallest allowed value.
        minimum: i32,
        /// Largest allowed value.
        maximum: i32,
        /// Where it is kept.
        access: fn(&mut Parameters) -> &mut i32,
    },
    /// true or false.
    Boolean {
        /// Where it is kept.
        access: fn(&mut Parameters) -> &mut bool,
    },
    /// One word of a few.
    Choice {
        /// Allowed words, each with what it means; in FMI the first is 1.
        items: &'static [(&'static str, &'static str)],
        /// Index of the present choice.
        get: fn(&Parameters) -> usize,
        /// Choose by index.
        set: fn(&mut Parameters, usize),
    },
}

/// One row of [`PARAMETERS`].
pub struct Parameter {
    /// Name in case files, flags and the FMU, such as `upper.shear_modulus`.
    pub name: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// What it is, in one sentence.
    pub description: &'static str,
    /// Type, range and place.
    pub kind: Kind,
}

/// The value of a parameter or an input, as given by a user.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A real number.
    Real(f64),
    /// A whole number.
    Integer(i64),
    /// true or false.
    Boolean(bool),
    /// A word.
    Text(String),
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Real(v) => write!(f, "{v}"),
            Self::Integer(v) => write!(f, "{v}"),
            Self::Boolean(v) => write!(f, "{v}"),
            Self::Text(v) => write!(f, "\"{v}\""),
        }
    }
}

impl Parameter {
    /// The present value.
    pub fn get(&self, parameters: &Parameters) -> Value {
        let mut copy = *parameters;
        match &self.kind {
            Kind::Real { access, .. } => Value::Real(*access(&mut copy)),
            Kind::Integer { access, .. } => Value::Integer(i64::from(*access(&mut copy))),
            Kind::Boolean { access } => Value::Boolean(*access(&mut copy)),
            Kind::Choice { items, get, .. } => Value::Text(items[get(parameters)].0.into()),
        }
    }

    /// Sets the value, or says what would have been allowed. On an error nothing changes. A preset changes every parameter but
    /// those that were set before.
    pub fn set(&self, parameters: &mut Parameters, value: &Value) -> Result<(), Error> {
        let mut changed = *parameters;
        self.assign(&mut changed, value)?;
        let mut named = parameters.named;
        for (place, row) in PARAMETERS.into_iter().enumerate() {
            let bit = 1 << place;
            if self.name == PRESET && named.0 & bit != 0 {
                row.assign(&mut changed, &row.get(parameters))?;
            }
            if self.name != PRESET && row.name == self.name {
                named.0 |= bit;
            }
        }
        *parameters = Parameters { named, ..changed };
        Ok(())
    }

    fn assign(&self, parameters: &mut Parameters, value: &Value) -> Result<(), Error> {
        let refuse = || Err(Error::value(self.name, value, self.allowed()));
        match (&self.kind, value) {
            (Kind::Real { minimum, maximum, access, .. }, Value::Real(v)) => {
                if !(*minimum..=*maximum).contains(v) {
                    return refuse();
                }
                *access(parameters) = *v;
            }
            (Kind::Real { .. }, Value::Integer(v)) => return self.assign(parameters, &Value::Real(*v as f64)),
            (Kind::Integer { minimum, maximum, access }, Value::Integer(v)) => match i32::try_from(*v) {
                Ok(v) if (*minimum..=*maximum).contains(&v) => *access(parameters) = v,
                _ => return refuse(),
            },
            (Kind::Boolean { access }, Value::Boolean(v)) => *access(parameters) = *v,
            (Kind::Choice { items, set, .. }, Value::Text(v)) => match items.iter().position(|(word, _)| word == v) {
                Some(index) => set(parameters, index),
                None => return refuse(),
            },
            _ => return refuse(),
        }
        Ok(())
    }

    /// What is allowed, in words.
    pub fn allowed(&self) -> String {
        match &self.kind {
            Kind::Real { minimum, maximum, .. } => {
                format!("a number from {minimum:e} to {maximum:e} {}", self.unit.name()).trim_end().into()
            }
            Kind::Integer { minimum, maximum, .. } => format!("a whole number from {minimum} to {maximum}"),
            Kind::Boolean { .. } => "true or false".into(),
            Kind::Choice { items, .. } => {
                let words: Vec<_> = items.iter().map(|(word, _)| format!("\"{word}\"")).collect();
                format!("one of {}", words.join(", "))
            }
        }
    }
}

/// The row of [`PARAMETERS`] with this name.
pub fn find(name: &str) -> Option<&'static Parameter> {
    PARAMETERS.into_iter().find(|row| row.name == name)
}

macro_rules! body_rows {
    ($($field:ident, $unit:expr, $minimum:expr, $maximum:expr, $nominal:expr, $description:literal;)*) => {
        [$(
            Parameter {
                name: concat!("upper.", stringify!($field)),
                unit: $unit,
                description: concat!($description, " of the upper body"),
                kind: Kind::Real {
                    minimum: $minimum, maximum: $maximum, nominal: $nominal, access: |p| &mut p.upper.$field,
                },
            },
            Parameter {
                name: concat!("lower.", stringify!($field)),
                unit: $unit,
                description: concat!($description, " of the lower body"),
                kind: Kind::Real {
                    minimum: $minimum, maximum: $maximum, nominal: $nominal, access: |p| &mut p.lower.$field,
                },
            },
        )*]
    };
}

static BODY_ROWS: [Parameter; 12] = body_rows! {
    outer_radius, Unit::Metre, 1e-3, 1e3, 0.1, "Radius of the undeformed articular surface";
    thickness, Unit::Metre, 1e-5, 1e-1, 1e-3, "Thickness of the cartilage layer";
    shear_modulus, Unit::Pascal, 1e2, 1e10, 1e6, "Drained shear modulus";
    bulk_modulus, Unit::Pascal, 1e2, 1e10, 1e6, "Drained bulk modulus";
    permeability, Unit::SquareMetre, 1e-24, 1e-9, 1e-15, "Intrinsic permeability (hydraulic permeability times viscosity)";
    biot_coefficient, Unit::One, 0.0, 1.0, 1.0, "Biot-Willis coefficient";
};

static STRAIN_DEPENDENCE_ROWS: [Parameter; 6] = body_rows! {
    solid_volume_fraction, Unit::One, 0.0, 0.9, 0.1, "Volume fraction of the solid in the undeformed tissue (permeability_law holmes_mow)";
    permeability_exponent, Unit::One, 0.0, 10.0, 1.0, "Exponent L of the pore volume in the permeability (permeability_law holmes_mow)";
    permeability_strain_coefficient, Unit::One, 0.0, 10.0, 1.0, "Coefficient M of the exponential in the permeability (permeability_law holmes_mow)";
};

/// A row whose words stand for the variants of an enumeration, in this order.
macro_rules! choice {
    ($name:literal, $description:literal, $field:ident, [$($variant:path => ($word:literal, $meaning:literal)),* $(,)?]) => {
        Parameter {
            name: $name,
            unit: Unit::One,
            description: $description,
            kind: Kind::Choice {
                items: &[$(($word, $meaning)),*],
                get: |p| [$($variant),*].iter().position(|variant| *variant == p.$field).unwrap_or_default(),
                set: |p, index| {
                    if let Some(variant) = [$($variant),*].get(index) {
                        p.$field = *variant;
                    }
                },
            },
        }
    };
}

const fn real(
    name: &'static str,
    unit: Unit,
    [minimum, maximum, nominal]: [f64; 3],
    access: fn(&mut Parameters) -> &mut f64,
    description: &'static str,
) -> Parameter {
    Parameter { name, unit, description, kind: Kind::Real { minimum, maximum, nominal, access } }
}

const fn integer(
    name: &'static str,
    [minimum, maximum]: [i32; 2],
    access: fn(&mut Parameters) -> &mut i32,
    description: &'static str,
) -> Parameter {
    Parameter { name, unit: Unit::One, description, kind: Kind::Integer { minimum, maximum, access } }
}

static COMMON_ROWS: [Parameter; 20] = [
    real(
        "sector_half_angle",
        Unit::Radian,
        [1e-3, 0.7, 0.1],
        |p| &mut p.sector_half_angle,
        "Half the angle of the modelled sector of the body with the smaller radius",
    ),
    real(
        "width",
        Unit::Metre,
        [1e-6, 1e3, 1.0],
        |p| &mut p.width,
        "Extent of the contact out of the plane: forces are loads per unit depth times this",
    ),
    real("viscosity", Unit::PascalSecond, [1e-6, 1e3, 1e-3], |p| &mut p.viscosity, "Dynamic viscosity of the fluid"),
    real(
        "density",
        Unit::KilogramPerCubicMetre,
        [1.0, 1e5, 1e3],
        |p| &mut p.density,
        "Density of the fluid at ambient pressure",
    ),
    real(
        "fluid_compressibility",
        Unit::PerPascal,
        [0.0, 1e-7, 1e-10],
        |p| &mut p.fluid_compressibility,
        "Compressibility of the fluid",
    ),
    real(
        "boundary_friction_coefficient",
        Unit::One,
        [0.0, 2.0, 0.5],
        |p| &mut p.boundary_friction_coefficient,
        "Friction coefficient of drained solid on solid",
    ),
    Parameter {
        name: "boundary_friction_loads_tissue",
        unit: Unit::One,
        description: "Whether boundary friction acts on the tissue as a traction or is only reported",
        kind: Kind::Boolean { access: |p| &mut p.boundary_friction_loads_tissue },
    },
    real(
        "friction_regularisation_speed",
        Unit::MetrePerSecond,
        [1e-9, 1.0, 1e-3],
        |p| &mut p.friction_regularisation_speed,
        "Sliding velocity at which regularised Coulomb friction reaches 71 % of its full value (consistent formulation)",
    ),
    real(
        "shear_film_offset",
        Unit::Metre,
        [1e-9, 1e-4, 1e-7],
        |p| &mut p.shear_film_offset,
        "Length added to the film thickness in the Couette shear stress, so that it stays finite in contact",
    ),
    choice!(
        "formulation",
        "Which balance laws are solved",
        formulation,
        [
            Formulation::Paper => ("paper", "The equations of de Boer et al. (2020) as printed"),
            Formulation::Consistent => ("consistent", "Total-stress poroelasticity at finite strain, regularised Coulomb friction"),
        ]
    ),
    integer("mesh.columns", [8, 2000], |p| &mut p.mesh.columns, "Elements along the articular surface"),
    integer("mesh.rows", [1, 200], |p| &mut p.mesh.rows, "Elements through the thickness of a layer"),
    real(
        "mesh.column_grading",
        Unit::One,
        [0.0, 8.0, 1.0],
        |p| &mut p.mesh.column_grading,
        "Strength of the sinh grading of the columns towards the middle of the contact; 0 is uniform",
    ),
    real(
        "mesh.row_grading",
        Unit::One,
        [0.0, 8.0, 1.0],
        |p| &mut p.mesh.row_grading,
        "Strength of the sinh grading of the rows towards the articular surface; 0 is uniform",
    ),
    integer(
        "mesh.pressure_order",
        [1, 2],
        |p| &mut p.pressure_order,
        "Polynomial order of the pore pressure; use 1 at tissue permeability (1e-17 m2 and below)",
    ),
    real(
        "tolerance",
        Unit::One,
        [1e-12, 1e-2, 1e-6],
        |p| &mut p.tolerance,
        "Newton's method stops when its update, relative to the fields, is below this",
    ),
    choice!(
        "time_integration",
        "What time does to the layers",
        time_integration,
        [
            TimeIntegration::QuasiSteady => ("quasi_steady", "Every state is the steady one of its inputs"),
            TimeIntegration::Transient => ("transient", "Film is squeezed out and tissue drains in time, starting from the steady state of the first inputs"),
        ]
    ),
    choice!(
        "control",
        "Which of depth and load is given",
        control,
        [
            Control::Depth => ("depth", "penetration_depth and approach_speed are given, and the load follows"),
            Control::Load => ("load", "applied_load is given, and the depth follows: penetration_depth_result"),
        ]
    ),
    real(
        "relative_tolerance",
        Unit::One,
        [1e-6, 1e-1, 1e-3],
        |p| &mut p.relative_tolerance,
        "Allowed error of one internal step in time, relative to the fields (transient only)",
    ),
    real(
        "maximum_internal_step",
        Unit::Second,
        [1e-9, 1e6, 1.0],
        |p| &mut p.maximum_internal_step,
        "Longest internal step in time (transient only)",
    ),
];

/// The name of the one parameter that sets others.
const PRESET: &str = "preset";

static CHOICE_ROWS: [Parameter; 3] = [
    choice!(
        "fidelity",
        "Which model answers in the FMU",
        fidelity,
        [
            Fidelity::Full => ("full", "The equations are solved"),
            Fidelity::Reduced => ("reduced", "Real time: a table of solved states in the FMU's resources, for one set of parameters"),
        ]
    ),
    choice!(
        "permeability_law",
        "How permeability answers to strain",
        permeability_law,
        [
            PermeabilityLaw::Constant => ("constant", "Permeability does not depend on strain"),
            PermeabilityLaw::HolmesMow => ("holmes_mow", "It falls with compression: k = k0 ((J - s)/(1 - s))^L exp(M (J^2 - 1)/2), J volume ratio"),
        ]
    ),
    Parameter {
        name: PRESET,
        unit: Unit::One,
        description: "Values that all other parameters start from; those that are set by name win, whichever is set first",
        kind: Kind::Choice {
            items: &presets::ITEMS,
            get: |p| p.preset as usize,
            set: |p, index| {
                if let Some(row) = PRESETS.get(index) {
                    *p = row.preset.parameters();
                }
            },
        },
    },
];

static CAVITATION_ROWS: [Parameter; 2] = [
    Parameter {
        name: "cavitation",
        unit: Unit::One,
        description: "Whether the film tears where its pressure would fall below cavitation_pressure; mass is conserved",
        kind: Kind::Boolean { access: |p| &mut p.cavitation },
    },
    real(
        "cavitation_pressure",
        Unit::Pascal,
        [-1e9, 0.0, 1e5],
        |p| &mut p.cavitation_pressure,
        "Least pressure of the film, above ambient (where cavitation is true)",
    ),
];

static WORK_ROWS: [Parameter; 1] = [real(
    "maximum_solve_time",
    Unit::Second,
    [0.0, 1e9, 1e2],
    |p| &mut p.maximum_solve_time,
    "After so long a solution is given up and the last one kept; 0 is never",
)];

/// Every parameter, in the order in which the FMU lists them. Append only: the order fixes the value references.
pub static PARAMETERS: [&Parameter; 44] = {
    let parts: [&[Parameter]; 6] =
        [&BODY_ROWS, &COMMON_ROWS, &STRAIN_DEPENDENCE_ROWS, &CHOICE_ROWS, &CAVITATION_ROWS, &WORK_ROWS];
    let mut rows = [&BODY_ROWS[0]; 44];
    let (mut part, mut first, mut place) = (0, 0, 0);
    while place < rows.len() {
        if place - first == parts[part].len() {
            first = place;
            part += 1;
        }
        rows[place] = &parts[part][place - first];
        place += 1;
    }
    rows
};

/// [`Named`] has a bit for each.
const _: () = assert!(PARAMETERS.len() <= u64::BITS as usize);
