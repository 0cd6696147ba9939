//! The table of variables: the one source of what the FMU, the command line and the documentation call things.
//!
//! One row a variable, and the value reference of FMI is the index of the row. **Append only**: once released, new rows go
//! to the very end, so that the old ones keep their references. The parameters are the rows of [`PARAMETERS`]; their names, units, ranges and descriptions are not repeated here.

use std::sync::LazyLock;

use crate::error::Error;
use crate::outputs::{Outputs, Regime, STATIONS};
use crate::parameters::{Inputs, Kind, PARAMETERS, Parameter, Parameters, Value};
use crate::simulation::{Input, Simulation};
use crate::units::{DisplayUnit, Unit};

/// An input: the sign conventions are in its description.
pub struct InputRow {
    /// Which one.
    pub input: Input,
    /// Smallest allowed value. Zero is allowed for every input: some importers write it to what is not connected.
    pub minimum: f64,
    /// Largest allowed value.
    pub maximum: f64,
    access: fn(&mut Inputs) -> &mut f64,
}

/// What role a variable plays, and where its value is.
#[derive(Clone, Copy)]
pub enum Source {
    /// Set from outside at any time.
    Input(&'static InputRow),
    /// Set before the simulation starts, then fixed.
    Parameter(&'static Parameter),
    /// A continuous result.
    Result(fn(&Outputs) -> f64),
    /// [`Simulation::contact_stiffness`]: found only where it is asked for, and a derivative itself.
    Stiffness,
    /// Where profile station `.0` is.
    Position(usize),
    /// The value of a profile at station `.1`.
    Profile(fn(&Outputs) -> &[f64], usize),
    /// [`Outputs::lubrication_regime`].
    Regime,
    /// [`Outputs::newton_iterations`].
    Iterations,
}

/// FMI's data types. An enumeration travels as an integer that counts its items from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Type {
    /// A real number.
    Real,
    /// A whole number.
    Integer,
    /// true or false.
    Boolean,
    /// One of a few words, each with a description.
    Enumeration(&'static [(&'static str, &'static str)]),
}

/// One row of [`VARIABLES`].
pub struct Variable {
    /// Structured name, such as `upper.thickness` or `film_thickness[51]`.
    pub name: String,
    /// Unit of the value.
    pub unit: Unit,
    /// What it is, in one sentence.
    pub description: String,
    /// Order of magnitude (real variables only).
    pub nominal: f64,
    /// Role and place.
    pub source: Source,
}

/// Everything a variable can be read from.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// The parameters.
    pub parameters: &'a Parameters,
    /// The inputs.
    pub inputs: &'a Inputs,
    /// The results of the last solution.
    pub outputs: &'a Outputs,
    /// The contact stiffness [N/m].
    pub contact_stiffness: f64,
    /// The profile stations.
    pub position: &'a [f64],
}

impl<'a> View<'a> {
    /// Everything of a simulation, the contact stiffness included.
    ///
    /// # Errors
    /// [`Error::State`] where nothing was solved yet.
    pub fn new(simulation: &'a mut Simulation) -> Result<Self, Error> {
        let contact_stiffness = simulation.contact_stiffness()?;
        Ok(Self { contact_stiffness, ..Self::without_stiffness(simulation) })
    }

    /// With a contact stiffness of zero.
    pub fn without_stiffness(simulation: &'a Simulation) -> Self {
        Self {
            parameters: simulation.parameters(),
            inputs: simulation.inputs(),
            outputs: simulation.outputs(),
            contact_stiffness: 0.0,
            position: simulation.position(),
        }
    }
}

impl Variable {
    /// The present value. A regime or another choice is its word.
    pub fn get(&self, from: &View) -> Value {
        match self.source {
            Source::Input(row) => Value::Real(row.get(from.inputs)),
            Source::Parameter(row) => row.get(from.parameters),
            Source::Result(get) => Value::Real(get(from.outputs)),
            Source::Stiffness => Value::Real(from.contact_stiffness),
            Source::Position(station) => Value::Real(from.position.get(station).copied().unwrap_or(0.0)),
            Source::Profile(get, station) => Value::Real(get(from.outputs).get(station).copied().unwrap_or(0.0)),
            Source::Regime => Value::Text(from.outputs.lubrication_regime.name().into()),
            Source::Iterations => Value::Integer(i64::from(from.outputs.newton_iterations)),
        }
    }

    /// The value of an input or a parameter, where there is nothing else yet.
    pub fn given(&self, parameters: &Parameters, inputs: &Inputs) -> Value {
        let outputs = &Outputs::default();
        self.get(&View { parameters, inputs, outputs, contact_stiffness: 0.0, position: &[] })
    }

    /// Sets an input or a parameter, or says what would have been allowed. On an error nothing changes.
    ///
    /// # Errors
    /// [`Error::Value`] naming the variable, the value and the allowed range.
    pub fn set(&self, parameters: &mut Parameters, inputs: &mut Inputs, value: &Value) -> Result<(), Error> {
        match self.source {
            Source::Input(row) => {
                let number = match *value {
                    Value::Real(v) => v,
                    Value::Integer(v) => v as f64,
                    _ => f64::NAN,
                };
                if !(row.minimum..=row.maximum).contains(&number) {
                    return Err(Error::value(&self.name, value, self.allowed()));
                }
                *(row.access)(inputs) = number;
                Ok(())
            }
            Source::Parameter(row) => row.set(parameters, value),
            _ => Err(Error::value(&self.name, value, "it is a result and cannot be set")),
        }
    }

    /// What may be set, in words.
    pub fn allowed(&self) -> String {
        match self.source {
            Source::Input(InputRow { minimum, maximum, .. }) => {
                format!("a number from {minimum:e} to {maximum:e} {}", self.unit.name()).trim_end().into()
            }
            Source::Parameter(row) => row.allowed(),
            _ => "nothing: it is a result".into(),
        }
    }

    /// Rate of change with respect to one input, given [`Simulation::derivatives`] for it; `None` for what is no
    /// differentiable result.
    pub fn derivative(&self, derivatives: &Outputs) -> Option<f64> {
        match self.source {
            Source::Result(get) => Some(get(derivatives)),
            Source::Position(_) => Some(0.0),
            Source::Profile(get, station) => get(derivatives).get(station).copied(),
            _ => None,
        }
    }

    /// Its data type.
    pub fn data_type(&self) -> Type {
        match self.source {
            Source::Parameter(row) => match row.kind {
                Kind::Real { .. } => Type::Real,
                Kind::Integer { .. } => Type::Integer,
                Kind::Boolean { .. } => Type::Boolean,
                Kind::Choice { items, .. } => Type::Enumeration(items),
            },
            Source::Regime => Type::Enumeration(&Regime::ITEMS),
            Source::Iterations => Type::Integer,
            _ => Type::Real,
        }
    }

    /// Smallest and largest value that can be set; `None` for results, and for what has no order.
    pub fn range(&self) -> Option<(f64, f64)> {
        match self.source {
            Source::Input(row) => Some((row.minimum, row.maximum)),
            Source::Parameter(row) => match row.kind {
                Kind::Real { minimum, maximum, .. } => Some((minimum, maximum)),
                Kind::Integer { minimum, maximum, .. } => Some((f64::from(minimum), f64::from(maximum))),
                _ => None,
            },
            _ => None,
        }
    }

    /// The value before anything is set; `None` for results.
    pub fn start(&self) -> Option<Value> {
        match self.source {
            Source::Input(row) => Some(Value::Real(row.get(&Inputs::default()))),
            Source::Parameter(row) => Some(row.get(&Parameters::default())),
            _ => None,
        }
    }

    /// Whether it is a result.
    pub fn is_output(&self) -> bool {
        !matches!(self.source, Source::Input(_) | Source::Parameter(_))
    }

    /// Whether it is one number or word, rather than a station of a profile.
    pub fn is_scalar(&self) -> bool {
        !matches!(self.source, Source::Position(_) | Source::Profile(..))
    }

    /// The unit in which its order of magnitude reads closest to 1; `None` where that is the SI unit.
    pub fn display_unit(&self) -> Option<&'static DisplayUnit> {
        let distance = |factor: f64| (factor * self.nominal).log10().abs();
        let best = self.unit.display_units().iter().min_by(|a, b| distance(a.factor).total_cmp(&distance(b.factor)))?;
        (distance(best.factor) < distance(1.0)).then_some(best)
    }
}

impl InputRow {
    /// The present value.
    pub fn get(&self, inputs: &Inputs) -> f64 {
        let mut copy = *inputs;
        *(self.access)(&mut copy)
    }

    /// Sets the value, or as a rate its rate.
    pub fn put(&self, inputs: &mut Inputs, value: f64) {
        *(self.access)(inputs) = value;
    }
}

/// The variable with this name.
///
/// # Errors
/// [`Error::UnknownName`] with the nearest names there are.
pub fn find(name: &str) -> Result<&'static Variable, Error> {
    VARIABLES.iter().find(|row| row.name == name).ok_or_else(|| Error::UnknownName {
        name: match name.char_indices().nth(LONGEST_NAME) {
            Some((end, _)) => format!("{}...", &name[..end]),
            None => name.into(),
        },
        hint: match nearest(name) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "`cartilage-contact solve --help` lists the names".into(),
        },
    })
}

/// Sets an input or a parameter by its name. On an error nothing changes.
///
/// # Errors
/// [`Error::UnknownName`], or [`Error::Value`] with what is allowed.
pub fn set(parameters: &mut Parameters, inputs: &mut Inputs, name: &str, value: &Value) -> Result<(), Error> {
    find(name)?.set(parameters, inputs, value)
}

/// The results that are one number or word, in table order.
pub fn scalar_outputs() -> impl Iterator<Item = &'static Variable> {
    VARIABLES.iter().filter(|row| row.is_output() && row.is_scalar())
}

/// Longer names are no misspelt ones; comparing them with all others, or printing them, would take long.
const LONGEST_NAME: usize = 100;

/// The name that takes the fewest edits, if it takes few.
fn nearest(name: &str) -> Option<&'static str> {
    if name.chars().nth(LONGEST_NAME).is_some() {
        return None;
    }
    let (edits, near) = VARIABLES
        .iter()
        .map(|row| (edit_distance(name, &row.name), row.name.as_str()))
        .min_by_key(|(edits, _)| *edits)?;
    (edits <= 2 + name.chars().count() / 4).then_some(near)
}

/// Levenshtein's distance: insertions, deletions and replacements that turn `a` into `b`.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

static INPUTS: [(&str, Unit, f64, InputRow, &str); 5] = [
    (
        "penetration_depth",
        Unit::Metre,
        1e-5,
        InputRow {
            input: Input::PenetrationDepth,
            minimum: -1e-2,
            maximum: 1e-2,
            access: |i| &mut i.penetration_depth,
        },
        "Approach of the two bones past first touch of the undeformed surfaces; negative is clearance, positive presses",
    ),
    (
        "sliding_speed",
        Unit::MetrePerSecond,
        1.0,
        InputRow { input: Input::SlidingSpeed, minimum: -10.0, maximum: 10.0, access: |i| &mut i.sliding_speed },
        "Sum of the two surface speeds U1 + U2 (upper + lower), both positive along +x: twice the mean entrainment speed",
    ),
    // 0: equal speeds. +1 or -1: one surface at rest. Beyond: surfaces that move in opposite directions.
    (
        "slide_to_roll_ratio",
        Unit::One,
        1.0,
        InputRow {
            input: Input::SlideToRollRatio,
            minimum: -10.0,
            maximum: 10.0,
            access: |i| &mut i.slide_to_roll_ratio,
        },
        "(U1 - U2)/(U1 + U2): 0 where both surfaces move at the same speed, 1 where only the upper one moves",
    ),
    (
        "approach_speed",
        Unit::MetrePerSecond,
        1e-4,
        InputRow { input: Input::ApproachSpeed, minimum: -10.0, maximum: 10.0, access: |i| &mut i.approach_speed },
        "Rate of penetration_depth during a step, unless that input has a derivative of its own; positive closes",
    ),
    (
        "applied_load",
        Unit::NewtonPerMetre,
        1e3,
        InputRow { input: Input::AppliedLoad, minimum: -1e9, maximum: 1e9, access: |i| &mut i.applied_load },
        "Load per unit depth that presses the bodies together; used where control is load",
    ),
];

type ResultRow = (&'static str, Unit, f64, Source, &'static str);

#[rustfmt::skip]
static RESULTS: [ResultRow; 25] = [
    ("load", Unit::NewtonPerMetre, 1e3, Source::Result(|o| o.load), "Load per unit depth, fluid and solid together"),
    ("fluid_load", Unit::NewtonPerMetre, 1e3, Source::Result(|o| o.fluid_load), "Load per unit depth that fluid pressure carries"),
    ("solid_load", Unit::NewtonPerMetre, 1e3, Source::Result(|o| o.solid_load), "Load per unit depth that solid contact carries"),
    ("normal_force", Unit::Newton, 1e3, Source::Result(|o| o.normal_force), "Load times width; pushes the bodies apart"),
    ("upper_friction_force", Unit::Newton, 10.0, Source::Result(|o| o.upper_friction_force), "Drag on the upper body, positive along -x, times width"),
    ("lower_friction_force", Unit::Newton, 10.0, Source::Result(|o| o.lower_friction_force), "Traction on the lower body, positive along +x, times width"),
    ("friction_coefficient", Unit::One, 1e-2, Source::Result(|o| o.friction_coefficient), "Magnitude of the upper friction force over the normal force"),
    ("fluid_friction_coefficient", Unit::One, 1e-2, Source::Result(|o| o.fluid_friction_coefficient), "Magnitude of the fluid's friction on the upper body over the fluid load"),
    ("fluid_load_support", Unit::One, 1.0, Source::Result(|o| o.fluid_load_support), "Fluid load over load"),
    ("minimum_film_thickness", Unit::Metre, 1e-6, Source::Result(|o| o.minimum_film_thickness), "Least distance of the deformed surfaces; 0 in contact"),
    ("minimum_film_position", Unit::Metre, 1e-3, Source::Result(|o| o.minimum_film_position), "Where the film is thinnest, along x from the middle of the contact"),
    ("central_film_thickness", Unit::Metre, 1e-6, Source::Result(|o| o.central_film_thickness), "Distance of the deformed surfaces in the middle of the contact"),
    ("contact_length", Unit::Metre, 1e-3, Source::Result(|o| o.contact_length), "Length along x over which the solids touch"),
    ("maximum_fluid_pressure", Unit::Pascal, 1e4, Source::Result(|o| o.maximum_fluid_pressure), "Largest fluid pressure on the interface, above ambient"),
    ("minimum_fluid_pressure", Unit::Pascal, 1e4, Source::Result(|o| o.minimum_fluid_pressure), "Smallest fluid pressure on the interface, above ambient"),
    ("maximum_contact_pressure", Unit::Pascal, 1e4, Source::Result(|o| o.maximum_contact_pressure), "Largest pressure of solid on solid"),
    ("maximum_von_mises_stress", Unit::Pascal, 1e4, Source::Result(|o| o.maximum_von_mises_stress), "Largest von Mises stress of the tissue's solid part"),
    ("sommerfeld_number", Unit::One, 1e-7, Source::Result(|o| o.sommerfeld_number), "Viscosity times sliding speed over load per unit depth: abscissa of the Stribeck curve"),
    ("contact_stiffness", Unit::NewtonPerMetre, 1e8, Source::Stiffness, "Rate of change of the normal force with penetration depth"),
    ("fluid_exudation", Unit::SquareMetrePerSecond, 1e-6, Source::Result(|o| o.fluid_exudation), "Fluid that leaves the tissue into the film, per unit depth"),
    ("net_fluid_exudation", Unit::SquareMetrePerSecond, 1e-6, Source::Result(|o| o.net_fluid_exudation), "Fluid that leaves the tissue into the film less what it takes in, per unit depth"),
    ("penetration_depth_result", Unit::Metre, 1e-5, Source::Result(|o| o.penetration_depth), "Penetration depth of these results; where control is load, the depth at which the load is carried"),
    ("lubrication_regime", Unit::One, 1.0, Source::Regime, "Lubrication regime"),
    ("newton_iterations", Unit::One, 1.0, Source::Iterations, "Newton iterations of the last solution, all its sub-steps together"),
    ("cavitated_length", Unit::Metre, 1e-3, Source::Result(|o| o.cavitated_length), "Length along x over which the film is torn, to half an element; 0 unless cavitation is true"),
];

fn profiles() -> impl Iterator<Item = Variable> {
    type Profile = (&'static str, Unit, f64, fn(usize) -> Source, &'static str);
    const PROFILES: [Profile; 4] = [
        ("position", Unit::Metre, 1e-3, Source::Position, "Place along x from the middle of the contact"),
        ("film_thickness", Unit::Metre, 1e-6, |i| Source::Profile(|o| &o.film_thickness, i), "Film thickness"),
        ("fluid_pressure", Unit::Pascal, 1e4, |i| Source::Profile(|o| &o.fluid_pressure, i), "Fluid pressure"),
        (
            "contact_pressure",
            Unit::Pascal,
            1e4,
            |i| Source::Profile(|o| &o.contact_pressure, i),
            "Pressure of solid on solid",
        ),
    ];
    PROFILES.into_iter().flat_map(|(name, unit, nominal, source, description)| {
        (0..STATIONS).map(move |i| Variable {
            name: format!("{name}[{}]", i + 1),
            unit,
            description: format!("{description}, station {} of {STATIONS}", i + 1),
            nominal,
            source: source(i),
        })
    })
}

/// Every variable: inputs, scalar results, profiles, parameters. The index is FMI's value reference.
pub static VARIABLES: LazyLock<Vec<Variable>> = LazyLock::new(|| {
    let inputs = INPUTS.iter().map(|(name, unit, nominal, row, description)| Variable {
        name: (*name).into(),
        unit: *unit,
        description: (*description).into(),
        nominal: *nominal,
        source: Source::Input(row),
    });
    let results = RESULTS.iter().map(|&(name, unit, nominal, source, description)| Variable {
        name: name.into(),
        unit,
        description: description.into(),
        nominal,
        source,
    });
    let parameters = PARAMETERS.into_iter().map(|row| Variable {
        name: row.name.into(),
        unit: row.unit,
        description: row.description.into(),
        nominal: match row.kind {
            Kind::Real { nominal, .. } => nominal,
            _ => 1.0,
        },
        source: Source::Parameter(row),
    });
    inputs.chain(results).chain(profiles()).chain(parameters).collect()
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_start_values_are_allowed() {
        let mut names: Vec<_> = VARIABLES.iter().map(|row| &row.name).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), VARIABLES.len());
        let (mut parameters, mut inputs) = (Parameters::default(), Inputs::default());
        for row in VARIABLES.iter() {
            if let Some(start) = row.start() {
                row.set(&mut parameters, &mut inputs, &start).unwrap();
            }
        }
        assert_eq!((parameters, inputs), (Parameters::default(), Inputs::default()));
    }

    #[test]
    fn every_input_may_be_zero() {
        for (name, ..) in &INPUTS {
            set(&mut Parameters::default(), &mut Inputs::default(), name, &Value::Real(0.0)).unwrap();
        }
    }

    #[test]
    fn a_value_out_of_range_is_refused_with_the_range_and_changes_nothing() {
        for value in [0.011, f64::NAN, f64::INFINITY] {
            let mut inputs = Inputs::default();
            let error =
                set(&mut Parameters::default(), &mut inputs, "penetration_depth", &Value::Real(value)).unwrap_err();
            assert_eq!(
                error.to_string(),
                format!("penetration_depth = {value} is not allowed: a number from -1e-2 to 1e-2 m")
            );
            assert_eq!(inputs, Inputs::default());
        }
        let (mut parameters, mut inputs) = (Parameters::default(), Inputs::default());
        assert!(set(&mut parameters, &mut inputs, "load", &Value::Real(1.0)).is_err());
    }

    #[test]
    fn a_misspelt_name_is_answered_with_the_nearest() {
        for (wrong, right) in [("penetration_deptth", "penetration_depth"), ("upper.thicknes", "upper.thickness")] {
            let message = find(wrong).err().unwrap().to_string();
            assert!(message.contains(&format!("did you mean `{right}`?")), "{message}");
        }
        assert!(!find("temperature").err().unwrap().to_string().contains("did you mean"));
        let endless = find(&"a".repeat(5_000_000)).err().unwrap().to_string();
        assert!(endless.contains("aaa...") && endless.len() < 200, "{endless}");
    }

    #[test]
    fn lengths_are_shown_in_the_unit_people_use() {
        let shown = |name| find(name).unwrap().display_unit().map(|unit| unit.name);
        assert_eq!(shown("penetration_depth"), Some("um"));
        assert_eq!(shown("upper.thickness"), Some("mm"));
        assert_eq!(shown("width"), None);
        assert_eq!(shown("upper.bulk_modulus"), Some("MPa"));
        assert_eq!(shown("sector_half_angle"), Some("deg"));
        assert_eq!(shown("load"), None);
    }
}
