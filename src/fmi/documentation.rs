//! `documentation/index.html`: prose from `modelDescription/documentation/index.html`, facts from the table of variables.

use std::fmt::Write;

use crate::fmi::description::{DEFAULT_EXPERIMENT, escape};
use crate::parameters::Value;
use crate::variables::{Source, Type, VARIABLES, Variable};

const PROSE: &str = include_str!("../../modelDescription/documentation/index.html");

/// The page, with its tables filled in.
pub fn html() -> String {
    let (start, stop, step) = DEFAULT_EXPERIMENT;
    let fillings = [
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("experiment", format!("from {start} s to {stop} s in steps of {step} s")),
        ("inputs", settable(|variable| matches!(variable.source, Source::Input(_)))),
        ("outputs", results()),
        ("profiles", profiles()),
        ("parameters", settable(|variable| matches!(variable.source, Source::Parameter(_)))),
        ("choices", choices()),
        ("tunable", tunable()),
    ];
    fillings.iter().fold(PROSE.to_owned(), |page, (name, text)| page.replace(&format!("{{{{{name}}}}}"), text))
}

fn table(header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let cells =
        |tag: &str, row: &[String]| -> String { row.iter().map(|cell| format!("<{tag}>{cell}</{tag}>")).collect() };
    let header: Vec<String> = header.iter().map(ToString::to_string).collect();
    let mut html = format!("<table>\n<tr>{}</tr>\n", cells("th", &header));
    for row in rows {
        let _ = writeln!(html, "<tr>{}</tr>", cells("td", &row));
    }
    html + "</table>"
}

fn code(text: &str) -> String {
    format!("<code>{}</code>", escape(text))
}

fn readable(value: f64) -> String {
    let digits = (value * 1e6).round() / 1e6;
    if value == 0.0 || (1e-3..1e4).contains(&value.abs()) { digits.to_string() } else { format!("{value:e}") }
}

fn settable(wanted: fn(&Variable) -> bool) -> String {
    let start = |variable: &Variable| match variable.start() {
        Some(Value::Real(v)) => readable(v),
        Some(Value::Text(word)) => word,
        Some(value) => value.to_string(),
        None => String::new(),
    };
    table(
        &["Name", "Unit", "Start", "Range", "Meaning"],
        VARIABLES.iter().filter(|variable| wanted(variable)).map(|variable| {
            let range = match variable.range() {
                Some((low, high)) => format!("{} to {}", readable(low), readable(high)),
                None => escape(&variable.allowed()),
            };
            let meaning = escape(&variable.full_description());
            vec![code(variable.name), variable.unit.name().into(), start(variable), range, meaning]
        }),
    )
}

fn tunable() -> String {
    let names =
        VARIABLES.iter().filter(|variable| matches!(variable.source, Source::Parameter(row) if row.is_tunable()));
    names.map(|variable| code(variable.name)).collect::<Vec<_>>().join(", ")
}

fn results() -> String {
    table(
        &["Name", "Unit", "Meaning"],
        VARIABLES.iter().filter(|variable| variable.is_output() && variable.is_scalar()).map(|variable| {
            vec![code(variable.name), variable.unit.name().into(), escape(&variable.full_description())]
        }),
    )
}

fn profiles() -> String {
    table(
        &["Name", "Unit", "Meaning of the first"],
        VARIABLES.iter().filter(|variable| variable.name.ends_with("[1]")).map(|variable| {
            vec![code(variable.name), variable.unit.name().into(), escape(&variable.full_description())]
        }),
    )
}

fn choices() -> String {
    let rows = VARIABLES.iter().filter_map(|variable| match variable.data_type() {
        Type::Enumeration(items) => Some((variable, items)),
        _ => None,
    });
    table(
        &["Variable", "Number", "Word", "Meaning"],
        rows.flat_map(|(variable, items)| {
            items.iter().zip(1..).map(|((word, meaning), number): (_, i32)| {
                vec![code(variable.name), number.to_string(), code(word), escape(meaning)]
            })
        }),
    )
}
