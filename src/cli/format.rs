//! Numbers and units as people read them.

use std::path::Path;

use cartilage_contact::error::Error;
use cartilage_contact::files;
use cartilage_contact::parameters::Value;
use cartilage_contact::variables::{VARIABLES, Variable};

/// A number with this many significant digits, without trailing zeros.
pub fn number(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let scientific = format!("{:.*e}", digits.saturating_sub(1), value);
    let exponent = scientific.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok()).unwrap_or(0);
    if !(-4..7).contains(&exponent) {
        let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
        return format!("{}e{exponent}", trim(mantissa));
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    trim(&format!("{value:.decimals$}")).into()
}

fn trim(number: &str) -> &str {
    if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number }
}

/// A value in the unit that people read it in, and that unit.
pub fn shown(variable: &Variable, value: &Value) -> (String, &'static str) {
    let (factor, unit) = match variable.display_unit() {
        Some(unit) => (unit.factor, unit.name),
        None => (1.0, variable.unit.name()),
    };
    match value {
        Value::Real(value) => (number(value * factor, 5), unit),
        Value::Text(word) => (word.clone(), ""),
        other => (other.to_string(), ""),
    }
}

/// The unit of a column of a table; 1 for none.
pub fn unit(column: &str) -> &'static str {
    let known = VARIABLES.iter().find(|variable| variable.name == column).map(|variable| variable.unit.name());
    match (column, known) {
        ("time", _) => "s",
        ("cumulative_net_fluid_exudation", _) => "m2",
        (_, None | Some("")) => "1",
        (_, Some(name)) => name,
    }
}

/// Units and meanings of a table's columns in a file beside it: `stribeck.units.csv` for `stribeck.csv`.
///
/// # Errors
/// [`Error::File`] naming the file that could not be written.
pub fn write_units<'a>(table: &Path, columns: impl Iterator<Item = &'a str>) -> Result<(), Error> {
    let path = table.with_extension("units.csv");
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut rows = vec![["column", "unit", "description"]];
    rows.extend(columns.map(|column| {
        let found = VARIABLES.iter().find(|variable| variable.name == column);
        [column, unit(column), found.map_or("", |variable| variable.description)]
    }));
    rows.iter().try_for_each(|row| writer.write_record(row)).map_err(|error| files::unwritten(&path, error))?;
    let bytes = writer.into_inner().map_err(|error| files::unwritten(&path, error))?;
    files::replace(&path, &bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_significant_digits_only() {
        for (value, text) in [
            (0.0, "0"),
            (12.0, "12"),
            (1.0 / 3.0, "0.3333"),
            (-1326.4, "-1326"),
            (2.5e-9, "2.5e-9"),
            (6.4641e7, "6.464e7"),
            (0.0099999, "0.01"),
        ] {
            assert_eq!(number(value, 4), text);
        }
    }
}
