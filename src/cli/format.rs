//! Numbers and units as people read them.

use cartilage_contact::parameters::Value;
use cartilage_contact::variables::Variable;

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
