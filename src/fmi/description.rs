//! The table of variables as `modelDescription.xml`: here what the versions of FMI have in common.

pub mod fmi2;
pub mod fmi3;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use uuid::Uuid;
use uuid::fmt::Hyphenated;

use crate::fmi::MODEL_IDENTIFIER;
use crate::fmi::answer::{Answer, refuse};
use crate::fmi::log::Category;
use crate::parameters::Value;
use crate::units::Unit;
use crate::variables::{Source, Type, VARIABLES, Variable};

/// The experiment that importers run unless told otherwise: start, stop and step \[s\].
pub const DEFAULT_EXPERIMENT: (f64, f64, f64) = (0.0, 1.0, 0.1);

/// When this version of the table was made; a fixed date keeps the FMU the same bytes from the same sources.
const GENERATION_DATE: &str = "2026-11-22T00:00:00Z";

/// Short text about the model, for importers and the documentation.
pub const SUMMARY: &str = "Lubrication of cartilage on cartilage in a line contact: fluid film, poroelastic layers, \
    solid contact and boundary friction, quasi-steady or in time";

/// FMI 2's GUID, FMI 3's instantiation token: a hash of everything else in `modelDescription.xml`, so that a library and a
/// description that do not belong together are found out.
struct Token([u8; Hyphenated::LENGTH]);

impl Token {
    fn new(body: &str) -> Self {
        let mut text = [0; Hyphenated::LENGTH];
        Uuid::new_v5(&Uuid::NAMESPACE_OID, body.as_bytes()).hyphenated().encode_lower(&mut text);
        Self(text)
    }

    fn text(&self) -> &str {
        std::str::from_utf8(&self.0).unwrap_or_default()
    }

    /// `modelDescription.xml`.
    fn document(&self, version: &str, name: &str, body: &str) -> String {
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription\n  fmiVersion=\"{version}\"\n  \
             modelName=\"{MODEL_IDENTIFIER}\"\n  {name}=\"{}\"\n{body}",
            self.text()
        )
    }

    /// Refuses an instance whose importer read another description.
    ///
    /// # Errors
    /// A message that says which token is right.
    fn check(&self, name: &str, given: Option<String>) -> Answer<()> {
        if given.as_deref() == Some(self.text()) {
            return Ok(());
        }
        let (given, token) = (given.unwrap_or_default(), self.text());
        refuse(format!("{name} = \"{given}\" is not allowed: modelDescription.xml of this library has {token}"))
    }
}

/// The attributes of the root element that do not depend on the version.
fn head(xml: &mut String) {
    for (key, value) in [
        ("description", SUMMARY),
        ("version", env!("CARGO_PKG_VERSION")),
        ("copyright", "The cartilage-contact developers"),
        ("license", env!("CARGO_PKG_LICENSE")),
        ("generationTool", concat!("cartilage-contact ", env!("CARGO_PKG_VERSION"))),
        ("generationDateAndTime", GENERATION_DATE),
        ("variableNamingConvention", "structured"),
    ] {
        let _ = writeln!(xml, "  {key}=\"{}\"", escape(value));
    }
}

/// The element that says what the FMU can do.
fn co_simulation(xml: &mut String, abilities: &[(&str, &str)]) {
    let _ = write!(xml, "  <CoSimulation\n    modelIdentifier=\"{MODEL_IDENTIFIER}\"");
    for (ability, value) in abilities {
        let _ = write!(xml, "\n    {ability}=\"{value}\"");
    }
    *xml += "/>\n\n";
}

fn log_categories_and_experiment(xml: &mut String) {
    *xml += "  <LogCategories>\n";
    for (name, description) in Category::ITEMS {
        let _ = writeln!(xml, "    <Category name=\"{name}\" description=\"{}\"/>", escape(description));
    }
    *xml += "  </LogCategories>\n\n";
    let (start, stop, step) = DEFAULT_EXPERIMENT;
    let _ = writeln!(xml, "  <DefaultExperiment startTime=\"{start}\" stopTime=\"{stop}\" stepSize=\"{step}\"/>\n");
}

fn units(xml: &mut String) {
    let mut used: Vec<Unit> =
        VARIABLES.iter().map(|variable| variable.unit).filter(|unit| *unit != Unit::One).collect();
    used.sort();
    used.dedup();
    *xml += "  <UnitDefinitions>\n";
    for unit in used {
        let _ = write!(xml, "    <Unit name=\"{}\">\n      <BaseUnit", unit.name());
        let (kg, m, s, rad) = unit.base();
        for (base, exponent) in [("kg", kg), ("m", m), ("s", s), ("rad", rad)] {
            if exponent != 0 {
                let _ = write!(xml, " {base}=\"{exponent}\"");
            }
        }
        *xml += "/>\n";
        for display in unit.display_units() {
            let _ =
                writeln!(xml, "      <DisplayUnit name=\"{}\" factor=\"{}\"/>", display.name, number(display.factor));
        }
        *xml += "    </Unit>\n";
    }
    *xml += "  </UnitDefinitions>\n\n";
}

/// The types of enumerations, each within the elements that a version of FMI puts around its items.
fn types(xml: &mut String, opening: fn(&str) -> String, closing: &str, indent: &str) {
    *xml += "  <TypeDefinitions>\n";
    let mut written = BTreeSet::new();
    for variable in VARIABLES.iter() {
        if let Type::Enumeration(items) = variable.data_type()
            && written.insert(type_name(variable))
        {
            *xml += &opening(&type_name(variable));
            for ((word, description), value) in items.iter().zip(1..) {
                let description = escape(description);
                let _ =
                    writeln!(xml, "{indent}<Item name=\"{word}\" value=\"{value}\" description=\"{description}\"/>");
            }
            *xml += closing;
        }
    }
    *xml += "  </TypeDefinitions>\n\n";
}

/// After the variable; both bodies share a type. Type and variable names share no namespace, but some importers make identifiers of
/// both.
fn type_name(variable: &Variable) -> String {
    let of_body = ["upper.", "lower."].into_iter().find_map(|body| variable.name.strip_prefix(body));
    format!("{}_type", of_body.unwrap_or(variable.name))
}

/// What FMI calls the role of a variable.
fn role(variable: &Variable) -> &'static str {
    match (variable.source, variable.data_type()) {
        (Source::Input(_), _) => "causality=\"input\" variability=\"continuous\"",
        (Source::Parameter(row), _) if row.is_tunable() => {
            "causality=\"parameter\" variability=\"tunable\" initial=\"exact\""
        }
        (Source::Parameter(_), _) => "causality=\"parameter\" variability=\"fixed\" initial=\"exact\"",
        (_, Type::Real) => "causality=\"output\" variability=\"continuous\" initial=\"calculated\"",
        _ => "causality=\"output\" variability=\"discrete\" initial=\"calculated\"",
    }
}

/// Whether an output depends on the inputs: all do but the stations.
fn depends_on_inputs(variable: &Variable) -> bool {
    !matches!(variable.source, Source::Position(_))
}

fn attributes(variable: &Variable) -> Vec<(&'static str, String)> {
    let mut found = Vec::new();
    match variable.data_type() {
        Type::Real if variable.unit != Unit::One => {
            found.push(("unit", variable.unit.name().to_owned()));
            found.extend(variable.display_unit().map(|unit| ("displayUnit", unit.name.to_owned())));
        }
        Type::Enumeration(_) => found.push(("declaredType", type_name(variable))),
        _ => {}
    }
    if let Some((minimum, maximum)) = variable.range() {
        // XML's integers have no exponent.
        let text = if variable.data_type() == Type::Real { number } else { |bound: f64| bound.to_string() };
        found.extend([("min", text(minimum)), ("max", text(maximum))]);
    }
    if variable.data_type() == Type::Real {
        found.push(("nominal", number(variable.nominal)));
    }
    if let Some(start) = variable.start() {
        found.push(("start", start_text(variable, &start)));
    }
    found
}

fn start_text(variable: &Variable, value: &Value) -> String {
    match (value, variable.data_type()) {
        (Value::Real(v), _) => number(*v),
        (Value::Text(word), Type::Enumeration(items)) => {
            (1 + items.iter().position(|(item, _)| item == word).unwrap_or(0)).to_string()
        }
        (other, _) => other.to_string(),
    }
}

/// The shortest text that reads back as the same number.
fn number(value: f64) -> String {
    let plain = value.to_string();
    let scientific = format!("{value:e}");
    if plain.len() <= scientific.len() { plain } else { scientific }
}

/// Text for XML and HTML.
pub fn escape(text: &str) -> String {
    let pairs: BTreeMap<char, &str> = [('&', "&amp;"), ('<', "&lt;"), ('>', "&gt;"), ('"', "&quot;")].into();
    text.chars().map(|c| pairs.get(&c).map_or_else(|| c.to_string(), |entity| (*entity).into())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variables_that_share_a_type_have_the_same_words() {
        let mut types: BTreeMap<String, &[(&str, &str)]> = BTreeMap::new();
        for variable in VARIABLES.iter() {
            if let Type::Enumeration(items) = variable.data_type() {
                assert_eq!(*types.entry(type_name(variable)).or_insert(items), items, "{}", variable.name);
            }
        }
    }
}
