//! All variables in one table, worked out by the compiler, and their value references.

use super::inputs::{INPUTS, InputRow};
use super::{Source, Variable};
use crate::outputs::{Get, RESULTS, ResultRow};
use crate::parameters::{Kind, PARAMETERS, Parameter};
use crate::units::Unit;

/// A variable that is no more. Its value reference is not used again.
pub(super) struct Retired {
    pub name: &'static str,
    pub reference: u32,
    /// What to do about it.
    pub hint: &'static str,
}

pub(super) static RETIRED: [Retired; 1] = [Retired {
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
    use super::super::{Type, View, find};
    use super::*;
    use crate::outputs::{Outputs, RealTime};
    use crate::parameters::{Inputs, Parameters, Value};

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
}
