//! The table of variables: the one source of what the FMU, the command line and the documentation call things.
//!
//! Inputs are declared in `inputs`, results in [`crate::outputs::RESULTS`], parameters in [`crate::parameters::PARAMETERS`]. Each row says
//! its value reference in FMI, which it keeps for good; a new row takes a new number and may stand anywhere. A number that is used twice
//! does not compile.

mod inputs;
mod table;

pub use self::inputs::InputRow;
use self::table::RETIRED;
pub use self::table::{VARIABLES, referred};
use crate::error::Error;
use crate::outputs::{Outputs, STATIONS};
use crate::parameters::{Inputs, Kind, Parameter, Parameters, Value};
use crate::simulation::Simulation;
use crate::units::{DisplayUnit, Unit};

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
    /// A result that is a whole number.
    Integer(fn(&Outputs) -> i32),
    /// A result that is true or false.
    Boolean(fn(&Outputs) -> bool),
    /// A result that is one of a few words, by its index.
    Choice(&'static [(&'static str, &'static str)], fn(&Outputs) -> usize),
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
#[derive(Clone, Copy)]
pub struct Variable {
    /// Value reference in FMI.
    pub reference: u32,
    /// Structured name, such as `upper.thickness` or `film_thickness[51]`.
    pub name: &'static str,
    /// Unit of the value.
    pub unit: Unit,
    /// What it is, in one sentence; of a station, what the profile is.
    pub description: &'static str,
    /// Order of magnitude (real variables only).
    pub nominal: f64,
    /// Role, and where its value is.
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
    /// The contact stiffness \[N/m\].
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
            Source::Integer(get) => Value::Integer(i64::from(get(from.outputs))),
            Source::Boolean(get) => Value::Boolean(get(from.outputs)),
            Source::Choice(items, get) => Value::Text(items[get(from.outputs)].0.into()),
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
                    return Err(Error::value(self.name, value, self.allowed()));
                }
                row.put(inputs, number);
                Ok(())
            }
            Source::Parameter(row) => row.set(parameters, value),
            _ => Err(Error::value(self.name, value, "it is a result and cannot be set")),
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
            Source::Integer(_) => Type::Integer,
            Source::Boolean(_) => Type::Boolean,
            Source::Choice(items, _) => Type::Enumeration(items),
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

    /// The description, which for a station says which one.
    pub fn full_description(&self) -> String {
        match self.source {
            Source::Position(station) | Source::Profile(_, station) => {
                format!("{}, station {} of {STATIONS}", self.description, station + 1)
            }
            _ => self.description.into(),
        }
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
        hint: match (RETIRED.iter().find(|row| row.name == name), nearest(name)) {
            (Some(retired), _) => retired.hint.into(),
            (_, Some(near)) => format!("did you mean `{near}`?"),
            _ => "`cartilage-contact solve --help` lists the names".into(),
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
    let (edits, near) =
        VARIABLES.iter().map(|row| (edit_distance(name, row.name), row.name)).min_by_key(|(edits, _)| *edits)?;
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

#[cfg(test)]
mod tests {
    use super::inputs::INPUTS;
    use super::*;

    #[test]
    fn names_are_unique_and_start_values_are_allowed() {
        let mut names: Vec<_> = VARIABLES.iter().map(|row| row.name).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), VARIABLES.len());
        assert_eq!(find("film_thickness[101]").unwrap().full_description(), "Film thickness, station 101 of 101");
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
        for row in &INPUTS {
            set(&mut Parameters::default(), &mut Inputs::default(), row.name, &Value::Real(0.0)).unwrap();
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
        assert_eq!(shown("upper.outer_radius"), Some("mm"));
        assert_eq!(shown("load"), Some("kN/m"));
    }

    #[test]
    fn the_si_unit_is_shown_where_values_read_best_in_it() {
        let mut in_si: Vec<_> = VARIABLES
            .iter()
            .filter(|row| row.data_type() == Type::Real && row.unit != Unit::One && row.display_unit().is_none())
            .map(|row| (row.unit.name(), row.name))
            .collect();
        in_si.sort();
        let expected = [
            ("N", "lower_force_x"),
            ("N", "lower_friction_force"),
            ("N", "upper_force_x"),
            ("N", "upper_friction_force"),
            ("N.m", "lower_moment"),
            ("N.m", "upper_moment"),
            ("N.m/m", "load_moment"),
            ("N/m", "tangential_load"),
            ("Pa.s", "zero_shear_viscosity"),
            ("m", "width"),
            ("m/s", "sliding_speed"),
            ("s", "maximum_internal_step"),
            ("s", "maximum_solve_time"),
            ("s", "relaxation_time"),
        ];
        assert_eq!(in_si, expected);
    }
}
