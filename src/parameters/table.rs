//! The table of parameters: names, units, ranges and descriptions, and how values are read and set by name.

use super::{
    AsperityLaw, Control, Fidelity, FluidLaw, Formulation, MeshDistribution, PRESETS, Parameters, PermeabilityLaw,
    SolidLaw, TimeIntegration, presets,
};
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
    /// Value reference in FMI.
    pub reference: u32,
    /// Name in case files, flags and the FMU, such as `upper.shear_modulus`.
    pub name: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// What it is, in one sentence.
    pub description: &'static str,
    /// Type, range and place.
    pub kind: Kind,
}

/// Parameters that may change during a run: of the fluid, of friction, and of how tissue and surfaces let fluid pass. The next step
/// uses them, and what tissue and film hold is kept.
const TUNABLE: [&str; 5] =
    ["viscosity", "boundary_friction_coefficient", "upper.permeability", "lower.permeability", "surface_roughness"];

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
            let bit = 1_u128 << place;
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

    /// Whether it may change during a run.
    pub fn is_tunable(&self) -> bool {
        TUNABLE.contains(&self.name)
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

/// A [`Kind`] for what is kept at a place of [`Parameters`], as its row says it.
macro_rules! kind {
    (real($unit:expr, $minimum:expr, $maximum:expr, $nominal:expr), $($place:ident).+) => {
        Kind::Real { minimum: $minimum, maximum: $maximum, nominal: $nominal, access: |p| &mut p.$($place).+ }
    };
    (integer($minimum:expr, $maximum:expr), $($place:ident).+) => {
        Kind::Integer { minimum: $minimum, maximum: $maximum, access: |p| &mut p.$($place).+ }
    };
    (boolean, $($place:ident).+) => {
        Kind::Boolean { access: |p| &mut p.$($place).+ }
    };
    // The words stand for the variants of an enumeration, in this order; one without a word does not compile.
    (choice($($variant:path => $word:literal: $meaning:literal),+ $(,)?), $($place:ident).+) => {
        Kind::Choice {
            items: &[$(($word, $meaning)),+],
            get: |p| {
                let ($($variant)|+) = p.$($place).+;
                [$($variant),+].iter().position(|variant| *variant == p.$($place).+).unwrap_or_default()
            },
            set: |p, index| {
                if let Some(variant) = [$($variant),+].get(index) {
                    p.$($place).+ = *variant;
                }
            },
        }
    };
}

macro_rules! unit {
    (real($unit:expr, $($range:expr),+)) => {
        $unit
    };
    ($($other:tt)+) => {
        Unit::One
    };
}

/// Rows `reference name at place: type, "description"`, where a name that is a field is its own place.
macro_rules! rows {
    ($($reference:literal $name:tt $(at $($place:ident).+)?: $kind:ident $(($($range:tt)*))?, $description:literal;)*) => {
        [$(
            Parameter {
                reference: $reference,
                name: rows!(@name $name),
                unit: unit!($kind $(($($range)*))?),
                description: $description,
                kind: rows!(@kind $name [$($($place).+)?] $kind $(($($range)*))?),
            },
        )*]
    };
    (@name $name:ident) => { stringify!($name) };
    (@name $name:literal) => { $name };
    (@kind $name:ident [] $($kind:tt)+) => { kind!($($kind)+, $name) };
    (@kind $name:tt [$($place:tt)+] $($kind:tt)+) => { kind!($($kind)+, $($place)+) };
}

/// Two rows each, one a body: `[reference of upper, of lower] name at place: type, "description"`, where a name that is a field of
/// the body is its own place.
macro_rules! body_rows {
    ($([$upper:literal, $lower:literal] $field:ident $(at $($place:ident).+)?: $kind:ident $(($($range:tt)*))?, $description:literal;)*) => {
        [$(
            Parameter {
                reference: $upper,
                name: concat!("upper.", stringify!($field)),
                unit: unit!($kind $(($($range)*))?),
                description: concat!($description, " of the upper body"),
                kind: body_rows!(@kind upper $field [$($($place).+)?] $kind $(($($range)*))?),
            },
            Parameter {
                reference: $lower,
                name: concat!("lower.", stringify!($field)),
                unit: unit!($kind $(($($range)*))?),
                description: concat!($description, " of the lower body"),
                kind: body_rows!(@kind lower $field [$($($place).+)?] $kind $(($($range)*))?),
            },
        )*]
    };
    (@kind $body:ident $field:ident [] $($kind:tt)+) => { kind!($($kind)+, $body.$field) };
    (@kind $body:ident $field:ident [$($place:tt)+] $($kind:tt)+) => { kind!($($kind)+, $body.$($place)+) };
}

static BODY_ROWS: [Parameter; 12] = body_rows! {
    [434, 435] outer_radius: real(Unit::Metre, -1e3, 1e3, 0.03),
        "Radius of the undeformed articular surface, below 0 for a concave and 0 for a flat one,";
    [436, 437] thickness: real(Unit::Metre, 1e-5, 1e-1, 1e-3), "Thickness of the cartilage layer";
    [438, 439] shear_modulus: real(Unit::Pascal, 1e2, 1e10, 1e6), "Drained shear modulus";
    [440, 441] bulk_modulus: real(Unit::Pascal, 1e2, 1e10, 1e6), "Drained bulk modulus";
    [442, 443] permeability: real(Unit::SquareMetre, 1e-24, 1e-9, 1e-15),
        "Intrinsic permeability (hydraulic permeability times viscosity)";
    [444, 445] biot_coefficient: real(Unit::One, 0.0, 1.0, 1.0), "Biot-Willis coefficient";
};

static COMMON_ROWS: [Parameter; 19] = rows! {
    446 sector_half_angle: real(Unit::Radian, 0.0, 1.05, 0.1),
        "Half the angle of the modelled sector of the body with the smaller radius; 0: it goes with the contact";
    447 width: real(Unit::Metre, 1e-6, 1e3, 1.0),
        "Extent of the contact out of the plane: forces are loads per unit depth times this";
    448 viscosity: real(Unit::PascalSecond, 1e-6, 1e3, 1e-3),
        "Dynamic viscosity of the fluid; with fluid_law carreau that at high shear rates, and that in the pores";
    450 fluid_compressibility: real(Unit::PerPascal, 0.0, 1e-7, 1e-10), "Compressibility of the fluid";
    451 boundary_friction_coefficient: real(Unit::One, 0.0, 2.0, 0.5), "Friction coefficient of drained solid on solid";
    452 boundary_friction_loads_tissue: boolean,
        "Whether boundary friction acts on the tissue as a traction or is only reported";
    453 friction_regularisation_speed: real(Unit::MetrePerSecond, 1e-6, 1.0, 1e-3),
        "Sliding velocity of the deformed surfaces at which regularised Coulomb friction reaches 71 % of its full value (consistent formulation)";
    454 shear_film_offset: real(Unit::Metre, 1e-9, 1e-4, 1e-7),
        "Length added to the film thickness in the Couette shear stress, so that it stays finite in contact";
    455 formulation: choice(
        Formulation::Paper => "paper": "The equations of de Boer et al. (2020) as printed",
        Formulation::Consistent => "consistent": "Total-stress poroelasticity at finite strain, regularised Coulomb friction",
    ), "Which balance laws are solved";
    456 "mesh.columns" at mesh.columns: integer(0, 2000),
        "Elements along the articular surface; 0 leaves the number to the program";
    457 "mesh.rows" at mesh.rows: integer(0, 200),
        "Elements through the thickness of a layer; 0 leaves the number to the program";
    458 "mesh.column_grading" at mesh.column_grading: real(Unit::One, 0.0, 8.0, 1.0),
        "Strength of the sinh grading of the columns towards the middle of the contact; 0 is uniform";
    459 "mesh.row_grading" at mesh.row_grading: real(Unit::One, 0.0, 8.0, 1.0),
        "Strength of the sinh grading of the rows towards the articular surface; 0 is uniform";
    460 "mesh.pressure_order" at pressure_order: integer(1, 2),
        "Polynomial order of the pore pressure; use 1 at tissue permeability (1e-17 m2 and below)";
    461 tolerance: real(Unit::One, 1e-12, 1e-2, 1e-6),
        "Newton's method stops when its update, relative to the fields, is below this";
    462 time_integration: choice(
        TimeIntegration::QuasiSteady => "quasi_steady": "Every state is the steady one of its inputs",
        TimeIntegration::Transient =>
            "transient": "Film is squeezed out and tissue drains in time, starting from the steady state of the first inputs",
    ), "What time does to the layers";
    463 control: choice(
        Control::Depth => "depth": "penetration_depth and approach_speed are given, and the load follows",
        Control::Load => "load": "applied_load is given, and the depth follows: penetration_depth_result",
    ), "Which of depth and load is given";
    464 relative_tolerance: real(Unit::One, 1e-6, 1e-1, 1e-3),
        "Allowed error of one internal step in time, relative to the fields (transient only)";
    465 maximum_internal_step: real(Unit::Second, 1e-9, 1e6, 1.0), "Longest internal step in time (transient only)";
};

static STRAIN_DEPENDENCE_ROWS: [Parameter; 6] = body_rows! {
    [466, 467] solid_volume_fraction: real(Unit::One, 0.0, 0.9, 0.1),
        "Volume fraction of the solid in the undeformed tissue (permeability_law holmes_mow)";
    [468, 469] permeability_exponent: real(Unit::One, 0.0, 10.0, 1.0),
        "Exponent L of the pore volume in the permeability (permeability_law holmes_mow)";
    [470, 471] permeability_strain_coefficient: real(Unit::One, 0.0, 10.0, 1.0),
        "Coefficient M of the exponential in the permeability (permeability_law holmes_mow)";
};

static CHOICE_ROWS: [Parameter; 2] = rows! {
    472 fidelity: choice(
        Fidelity::Full => "full": "The equations are solved",
        Fidelity::Reduced =>
            "reduced": "Real time: a table of solved states in the FMU's resources, for one set of parameters",
    ), "Which model answers in the FMU";
    473 permeability_law: choice(
        PermeabilityLaw::Constant => "constant": "Permeability does not depend on strain",
        PermeabilityLaw::HolmesMow =>
            "holmes_mow": "It falls with compression: k = k0 ((J - s)/(1 - s))^L exp(M (J^2 - 1)/2), J volume ratio",
    ), "How permeability answers to strain";
};

/// The name of the one parameter that sets others.
const PRESET: &str = "preset";

static PRESET_ROW: [Parameter; 1] = [Parameter {
    reference: 474,
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
}];

static CAVITATION_ROWS: [Parameter; 2] = rows! {
    475 cavitation: boolean,
        "Whether the film cavitates where its pressure would fall below cavitation_pressure; mass is conserved";
    476 cavitation_pressure: real(Unit::Pascal, -1e9, 0.0, 1e5),
        "Least pressure of the film, above ambient (where cavitation is true)";
};

static SOLID_ROWS: [Parameter; 10] = body_rows! {
    [540, 541] solid_law: choice(
        SolidLaw::NeoHookean => "neo_hookean": "Neo-Hookean solid",
        SolidLaw::HolmesMow => "holmes_mow": "Exponential solid of Holmes and Mow: it stiffens as it is strained (consistent formulation)",
    ), "Law of the drained solid, whose moduli are those at small strain,";
    [542, 543] stiffening_coefficient: real(Unit::One, 0.0, 20.0, 1.0),
        "Coefficient of the exponential in the strain energy (solid_law holmes_mow)";
    [544, 545] fibre_modulus: real(Unit::Pascal, 0.0, 1e10, 1e6),
        "Modulus of fibres in all directions that only pull, 0 for none (consistent formulation),";
    [546, 547] fibre_exponent: real(Unit::One, 2.0, 10.0, 1.0), "Exponent of the fibres' strain energy";
    [548, 549] fibre_exponential_coefficient: real(Unit::One, 0.0, 1e3, 1.0),
        "Coefficient of the exponential in the fibres' strain energy, 0 for a power law,";
};

static FLUID_ROWS: [Parameter; 4] = rows! {
    550 fluid_law: choice(
        FluidLaw::Newtonian => "newtonian": "The viscosity is constant",
        FluidLaw::Carreau =>
            "carreau": "Shear thins the film: eta = viscosity + (zero_shear_viscosity - viscosity) (1 + (relaxation_time rate)^2)^((flow_index - 1)/2)",
    ), "How the viscosity of the film depends on the shear rate; in the pores it is constant";
    551 zero_shear_viscosity: real(Unit::PascalSecond, 1e-6, 1e3, 1.0),
        "Viscosity of the film at low shear rates (fluid_law carreau)";
    552 relaxation_time: real(Unit::Second, 1e-9, 1e6, 1.0),
        "One over the shear rate at which the film begins to thin (fluid_law carreau)";
    553 flow_index: real(Unit::One, 0.1, 1.0, 1.0),
        "Exponent of the shear stress over the shear rate where the film thins (fluid_law carreau)";
};

static WORK_ROWS: [Parameter; 3] = rows! {
    509 pore_viscosity: real(Unit::PascalSecond, 0.0, 1e3, 1e-3),
        "Dynamic viscosity of the fluid in the pores of the tissue; 0 is that of the film (fluid_law carreau: at high shear rates)";
    510 "lower.rigid" at rigid_lower: boolean,
        "Whether the lower body is rigid and impermeable, such as glass: only its outer_radius counts";
    508 maximum_solve_time: real(Unit::Second, 0.0, 1e9, 1e2),
        "After so long a solution is given up and the last one kept; 0 is never";
};

static JOINT_ROWS: [Parameter; 8] = rows! {
    500 "mesh.distribution" at mesh_distribution: choice(
        MeshDistribution::Graded => "graded": "By mesh.column_grading and mesh.row_grading, on a mesh that stays",
        MeshDistribution::Contact =>
            "contact": "Dense at the edges of the contact and below the surface; goes with the contact between steady states",
    ), "Where the nodes of the mesh are";
    501 surface_roughness: real(Unit::Metre, 0.0, 1e-4, 1e-6),
        "Combined root mean square roughness of the two surfaces; 0 is smooth, with contact where the film is gone";
    502 asperity_law: choice(
        AsperityLaw::Exponential => "exponential": "exp(-h/(c sigma)) of self-affine surfaces (Persson 2007)",
        AsperityLaw::GreenwoodTripp => "greenwood_tripp": "F_5/2(h/sigma) of Gaussian summits (Greenwood and Tripp 1970)",
    ), "How the pressure of asperities falls with the distance of rough surfaces";
    503 asperity_pressure: real(Unit::Pascal, 0.0, 1e9, 1e4),
        "Pressure of the asperities where the mean planes of rough surfaces meet";
    504 asperity_decay: real(Unit::One, 1e-2, 10.0, 1.0),
        "Decay length of the asperities' pressure over surface_roughness (asperity_law exponential)";
    505 core_pressure: real(Unit::Pascal, 1e3, 1e10, 1e7),
        "Pressure of the stiff core of rough surfaces where the mean planes meet, on top of asperity_pressure";
    506 core_decay: real(Unit::One, 1e-2, 10.0, 0.1), "Decay length of the core's pressure over surface_roughness";
    507 solid_fraction: real(Unit::One, 0.0, 1.0, 0.1),
        "Fraction of the fluid's pressure in real contact that boundary friction feels as well (phi of Ateshian; rough surfaces)";
};

static DEPTH_ROWS: [Parameter; 26] = body_rows! {
    [560, 561] tangential_permeability_ratio: real(Unit::One, 1e-2, 1e2, 1.0),
        "Permeability along the articular surface over that through the depth";
    [580, 581] middle_zone_start: real(Unit::One, 0.0, 1.0, 0.1),
        "Depth over thickness where the middle zone begins, for which moduli and permeability are given,";
    [582, 583] middle_zone_end: real(Unit::One, 0.0, 1.0, 0.1), "Depth over thickness where the middle zone ends";
    [584, 585] surface_shear_modulus_ratio at surface.shear_modulus: real(Unit::One, 1e-2, 1e2, 1.0),
        "Shear modulus at the surface over shear_modulus";
    [586, 587] deep_shear_modulus_ratio at deep.shear_modulus: real(Unit::One, 1e-2, 1e2, 1.0),
        "Shear modulus at the bone over shear_modulus";
    [588, 589] surface_bulk_modulus_ratio at surface.bulk_modulus: real(Unit::One, 1e-2, 1e2, 1.0),
        "Bulk modulus at the surface over bulk_modulus";
    [590, 591] deep_bulk_modulus_ratio at deep.bulk_modulus: real(Unit::One, 1e-2, 1e2, 1.0),
        "Bulk modulus at the bone over bulk_modulus";
    [592, 593] surface_fibre_modulus_ratio at surface.fibre_modulus: real(Unit::One, 0.0, 1e2, 1.0),
        "Modulus of the fibres at the surface over fibre_modulus";
    [594, 595] deep_fibre_modulus_ratio at deep.fibre_modulus: real(Unit::One, 0.0, 1e2, 1.0),
        "Modulus of the fibres at the bone over fibre_modulus";
    [596, 597] surface_permeability_ratio at surface.permeability: real(Unit::One, 1e-3, 1e3, 1.0),
        "Permeability at the surface over permeability";
    [598, 599] deep_permeability_ratio at deep.permeability: real(Unit::One, 1e-3, 1e3, 1.0),
        "Permeability at the bone over permeability";
    [600, 601] surface_solid_fraction_ratio at surface.solid_volume_fraction: real(Unit::One, 0.0, 1e1, 1.0),
        "Volume fraction of the solid at the surface over solid_volume_fraction";
    [602, 603] deep_solid_fraction_ratio at deep.solid_volume_fraction: real(Unit::One, 0.0, 1e1, 1.0),
        "Volume fraction of the solid at the bone over solid_volume_fraction";
};

const PARTS: [&[Parameter]; 11] = [
    &BODY_ROWS,
    &COMMON_ROWS,
    &STRAIN_DEPENDENCE_ROWS,
    &CHOICE_ROWS,
    &PRESET_ROW,
    &CAVITATION_ROWS,
    &JOINT_ROWS,
    &SOLID_ROWS,
    &DEPTH_ROWS,
    &FLUID_ROWS,
    &WORK_ROWS,
];

const COUNT: usize = {
    let (mut count, mut part) = (0, 0);
    while part < PARTS.len() {
        count += PARTS[part].len();
        part += 1;
    }
    count
};

/// Every parameter, in the order in which they are listed.
pub static PARAMETERS: [&Parameter; COUNT] = {
    let mut rows = [&PARTS[0][0]; COUNT];
    let (mut part, mut first, mut place) = (0, 0, 0);
    while place < rows.len() {
        if place - first == PARTS[part].len() {
            first = place;
            part += 1;
        }
        rows[place] = &PARTS[part][place - first];
        place += 1;
    }
    rows
};

/// [`Named`](super::Named) has a bit for each.
const _: () = assert!(COUNT <= u128::BITS as usize);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_row_makes_a_choice_for_each_body() {
        static ROWS: [Parameter; 2] = body_rows! {
            [900, 901] solid_law: choice(
                SolidLaw::NeoHookean => "soft": "It gives way",
                SolidLaw::HolmesMow => "stiff": "It stiffens",
            ), "Stiffness";
        };
        let names = ROWS.each_ref().map(|row| (row.reference, row.name, row.description));
        let lower = (901, "lower.solid_law", "Stiffness of the lower body");
        assert_eq!(names, [(900, "upper.solid_law", "Stiffness of the upper body"), lower]);
        let mut parameters = Parameters::default();
        for (row, word) in ROWS.iter().zip(["soft", "stiff"]) {
            row.set(&mut parameters, &Value::Text(word.into())).unwrap();
            assert_eq!(row.get(&parameters), Value::Text(word.into()));
        }
        assert_eq!(
            (parameters.upper.solid_law, parameters.lower.solid_law),
            (SolidLaw::NeoHookean, SolidLaw::HolmesMow)
        );
        let error = ROWS[1].set(&mut parameters, &Value::Text("firm".into())).unwrap_err().to_string();
        assert!(error.starts_with("lower.solid_law = \"firm\" is not allowed: one of \"soft\", \"stiff\""), "{error}");
    }
}
