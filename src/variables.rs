//! The table of variables: the one source of what the FMU, the command line and the documentation call things.
//!
//! Inputs are declared here, results in [`RESULTS`], parameters in [`PARAMETERS`]. Each row says its value reference in FMI, which it
//! keeps for good; a new row takes a new number and may stand anywhere. A number that is used twice does not compile.

use crate::error::Error;
use crate::outputs::{Get, Outputs, RESULTS, ResultRow, STATIONS};
use crate::parameters::{Inputs, Kind, PARAMETERS, Parameter, Parameters, Value};
use crate::simulation::{Input, Simulation};
use crate::units::{DisplayUnit, Unit};

/// An input: the sign conventions are in its description.
pub struct InputRow {
    name: &'static str,
    reference: u32,
    unit: Unit,
    nominal: f64,
    description: &'static str,
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
                *(row.access)(inputs) = number;
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

static INPUTS: [InputRow; 5] = [
    InputRow {
        name: "penetration_depth",
        reference: 0,
        unit: Unit::Metre,
        nominal: 1e-5,
        description: "Approach of the two bones past first touch of the undeformed surfaces; negative is clearance, positive presses",
        input: Input::PenetrationDepth,
        minimum: -1e-2,
        maximum: 1e-2,
        access: |i| &mut i.penetration_depth,
    },
    InputRow {
        name: "sliding_speed",
        reference: 1,
        unit: Unit::MetrePerSecond,
        nominal: 1.0,
        description: "Sum of the two surface speeds U1 + U2 (upper + lower), both positive along +x: twice the mean entrainment speed",
        input: Input::SlidingSpeed,
        minimum: -10.0,
        maximum: 10.0,
        access: |i| &mut i.sliding_speed,
    },
    // 0: equal speeds. +1 or -1: one surface at rest. Beyond: surfaces that move in opposite directions.
    InputRow {
        name: "slide_to_roll_ratio",
        reference: 2,
        unit: Unit::One,
        nominal: 1.0,
        description: "(U1 - U2)/(U1 + U2): 0 where both surfaces move at the same speed, 1 where only the upper one moves",
        input: Input::SlideToRollRatio,
        minimum: -10.0,
        maximum: 10.0,
        access: |i| &mut i.slide_to_roll_ratio,
    },
    InputRow {
        name: "approach_speed",
        reference: 3,
        unit: Unit::MetrePerSecond,
        nominal: 1e-4,
        description: "Rate of penetration_depth during a step, unless that input has a derivative of its own; positive closes",
        input: Input::ApproachSpeed,
        minimum: -10.0,
        maximum: 10.0,
        access: |i| &mut i.approach_speed,
    },
    InputRow {
        name: "applied_load",
        reference: 4,
        unit: Unit::NewtonPerMetre,
        nominal: 1e3,
        description: "Load per unit depth that presses the bodies together; used where control is load",
        input: Input::AppliedLoad,
        minimum: -1e9,
        maximum: 1e9,
        access: |i| &mut i.applied_load,
    },
];

/// A variable that is no more. Its value reference is not used again.
struct Retired {
    name: &'static str,
    reference: u32,
    /// What to do about it.
    hint: &'static str,
}

static RETIRED: [Retired; 1] = [Retired {
    name: "density",
    reference: 449,
    hint: "it acted on nothing and was taken out: leave it away; what compresses the fluid is fluid_compressibility",
}];

/// How many blocks of value references there are: one a row.
const BLOCKS: usize = INPUTS.len() + RESULTS.len() + PARAMETERS.len() + RETIRED.len();

/// The value references of each row: the first, and how many.
const REFERENCES: [(u32, u32); BLOCKS] = {
    let mut all = [(0, 1); BLOCKS];
    let (mut place, mut i) = (0, 0);
    while i < INPUTS.len() {
        all[place].0 = INPUTS[i].reference;
        (place, i) = (place + 1, i + 1);
    }
    i = 0;
    while i < RESULTS.len() {
        all[place] = (RESULTS[i].reference, RESULTS[i].length());
        (place, i) = (place + 1, i + 1);
    }
    i = 0;
    while i < PARAMETERS.len() {
        all[place].0 = PARAMETERS[i].reference;
        (place, i) = (place + 1, i + 1);
    }
    i = 0;
    while i < RETIRED.len() {
        all[place].0 = RETIRED[i].reference;
        (place, i) = (place + 1, i + 1);
    }
    all
};

/// Whether no value reference is in two blocks.
const fn are_distinct(blocks: &[(u32, u32)]) -> bool {
    let mut i = 0;
    while i < blocks.len() {
        let mut j = 0;
        while j < i {
            let ((a, in_a), (b, in_b)) = (blocks[i], blocks[j]);
            if a < b + in_b && b < a + in_a {
                return false;
            }
            j += 1;
        }
        i += 1;
    }
    true
}

const _: () = assert!(are_distinct(&REFERENCES), "two rows have the same value reference; new rows take new numbers");

/// How many variables there are.
const COUNT: usize = {
    let (mut count, mut i) = (INPUTS.len() + PARAMETERS.len(), 0);
    while i < RESULTS.len() {
        count += RESULTS[i].length() as usize;
        i += 1;
    }
    count
};

/// Room for the name of a station.
const NAME_LENGTH: usize = 40;

/// The names of stations, such as `film_thickness[51]`, each at its variable's place; the others are empty. All is worked out by the
/// compiler: what were made at run time would stay in the host's memory when it unloads the library.
static STATION_NAMES: [([u8; NAME_LENGTH], usize); COUNT] = {
    let mut names = [([0; NAME_LENGTH], 0); COUNT];
    let (mut place, mut i) = (INPUTS.len(), 0);
    while i < RESULTS.len() {
        let mut station = 0;
        while station < RESULTS[i].length() as usize {
            if RESULTS[i].length() > 1 {
                names[place] = station_name(RESULTS[i].name, station + 1);
            }
            (place, station) = (place + 1, station + 1);
        }
        i += 1;
    }
    names
};

/// The name of a station with its number in brackets, and its length.
const fn station_name(profile: &str, number: usize) -> ([u8; NAME_LENGTH], usize) {
    let (mut text, mut length) = ([0; NAME_LENGTH], profile.len());
    let mut i = 0;
    while i < length {
        text[i] = profile.as_bytes()[i];
        i += 1;
    }
    text[length] = b'[';
    length += 1;
    let mut unit = 1;
    while unit <= number / 10 {
        unit *= 10;
    }
    while unit > 0 {
        text[length] = b'0' + (number / unit % 10) as u8;
        (length, unit) = (length + 1, unit / 10);
    }
    text[length] = b']';
    (text, length + 1)
}

/// The variable of a result that stands at this place: the only one, or that of a station.
const fn of_result(row: &'static ResultRow, station: usize, place: usize) -> Variable {
    let source = match row.get {
        Get::Real(get) => Source::Result(get),
        Get::Integer(get) => Source::Integer(get),
        Get::Boolean(get) => Source::Boolean(get),
        Get::Choice(items, get) => Source::Choice(items, get),
        Get::Profile(get) => Source::Profile(get, station),
        Get::Position => Source::Position(station),
        Get::Stiffness => Source::Stiffness,
    };
    let (mut name, reference) = (row.name, row.reference + station as u32);
    if row.length() > 1 {
        let (text, length) = &STATION_NAMES[place];
        if let Ok(text) = str::from_utf8(text.split_at(*length).0) {
            name = text;
        }
    }
    Variable { reference, name, unit: row.unit, description: row.description, nominal: row.nominal, source }
}

/// Every variable: inputs, results, parameters, in the order in which they are listed.
pub static VARIABLES: [Variable; COUNT] = {
    let source = Source::Stiffness;
    let mut all = [Variable { reference: 0, name: "", unit: Unit::One, description: "", nominal: 1.0, source }; COUNT];
    let (mut place, mut i) = (0, 0);
    while i < INPUTS.len() {
        let InputRow { name, reference, unit, nominal, description, .. } = INPUTS[i];
        let source = Source::Input(&INPUTS[i]);
        all[place] = Variable { reference, name, unit, description, nominal, source };
        (place, i) = (place + 1, i + 1);
    }
    i = 0;
    while i < RESULTS.len() {
        let mut station = 0;
        while station < RESULTS[i].length() as usize {
            all[place] = of_result(&RESULTS[i], station, place);
            (place, station) = (place + 1, station + 1);
        }
        i += 1;
    }
    i = 0;
    while i < PARAMETERS.len() {
        let Parameter { name, reference, unit, description, .. } = *PARAMETERS[i];
        let nominal = match PARAMETERS[i].kind {
            Kind::Real { nominal, .. } => nominal,
            _ => 1.0,
        };
        all[place] = Variable { reference, name, unit, description, nominal, source: Source::Parameter(PARAMETERS[i]) };
        (place, i) = (place + 1, i + 1);
    }
    all
};

/// One more than the largest value reference.
const END: usize = {
    let (mut end, mut i) = (0, 0);
    while i < REFERENCES.len() {
        let (first, count) = REFERENCES[i];
        if end < first + count {
            end = first + count;
        }
        i += 1;
    }
    end as usize
};

/// For each value reference one more than the place of its variable; 0 where there is none.
static PLACES: [u16; END] = {
    assert!(COUNT < u16::MAX as usize);
    let (mut places, mut i) = ([0; END], 0);
    while i < COUNT {
        places[VARIABLES[i].reference as usize] = i as u16 + 1;
        i += 1;
    }
    places
};

/// The variable with this value reference, if there is one.
pub fn referred(reference: u32) -> Option<&'static Variable> {
    let place = PLACES.get(reference as usize)?.checked_sub(1)?;
    VARIABLES.get(usize::from(place))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outputs::RealTime;

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
    fn a_value_reference_stands_for_one_variable() {
        assert!(are_distinct(&[(0, 1), (132, 1), (1, 101), (131, 1), (102, 29)]));
        for overlapping in [[(7, 1), (7, 1)], [(1, 101), (101, 1)], [(101, 1), (1, 101)]] {
            assert!(!are_distinct(&overlapping), "{overlapping:?}");
        }
        for variable in VARIABLES.iter() {
            assert_eq!(referred(variable.reference).unwrap().name, variable.name);
        }
        assert!(referred(END as u32).is_none() && referred(u32::MAX).is_none());
        assert!(RETIRED.iter().all(|row| referred(row.reference).is_none() && find(row.name).is_err()));
    }

    /// Importers keep these numbers in models that were set up with an earlier version.
    #[test]
    fn value_references_stay() {
        for (name, reference) in [
            ("penetration_depth", 0),
            ("applied_load", 4),
            ("load", 5),
            ("contact_stiffness", 23),
            ("penetration_depth_result", 26),
            ("cavitated_length", 29),
            ("position[1]", 30),
            ("film_thickness[1]", 131),
            ("fluid_pressure[101]", 332),
            ("contact_pressure[51]", 383),
            ("upper.outer_radius", 434),
            ("lower.biot_coefficient", 445),
            ("sector_half_angle", 446),
            ("fluid_compressibility", 450),
            ("lower.permeability_strain_coefficient", 471),
            ("cavitation_pressure", 476),
        ] {
            assert_eq!(find(name).unwrap().reference, reference, "{name}");
        }
    }

    #[test]
    fn results_may_be_of_any_type() {
        static ROWS: [ResultRow; 2] = {
            let (unit, nominal, description, real_time) = (Unit::One, 1.0, "", RealTime::Absent);
            [
                ResultRow {
                    name: "count",
                    reference: 901,
                    unit,
                    nominal,
                    description,
                    real_time,
                    get: Get::Integer(|o| o.newton_iterations),
                },
                ResultRow {
                    name: "flag",
                    reference: 902,
                    unit,
                    nominal,
                    description,
                    real_time,
                    get: Get::Boolean(|o| o.load > 1.0),
                },
            ]
        };
        let outputs = &Outputs { load: 2.0, newton_iterations: 3, ..Outputs::default() };
        let (parameters, inputs) = (&Parameters::default(), &Inputs::default());
        let view = View { parameters, inputs, outputs, contact_stiffness: 0.0, position: &[] };
        let rows = [of_result(&ROWS[0], 0, 0), of_result(&ROWS[1], 0, 0)];
        let found: Vec<_> = rows.iter().map(|row| (row.data_type(), row.get(&view))).collect();
        assert_eq!(found, [(Type::Integer, Value::Integer(3)), (Type::Boolean, Value::Boolean(true))]);
        assert!(rows.iter().all(|row| row.is_output() && row.derivative(outputs).is_none()));
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
        assert_eq!(shown("load"), None);
    }
}
