//! The table of variables as `modelDescription.xml`.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::LazyLock;

use uuid::Uuid;

use crate::fmi::MODEL_IDENTIFIER;
use crate::fmi::log::Category;
use crate::parameters::Value;
use crate::units::Unit;
use crate::variables::{Source, Type, VARIABLES, Variable};

/// The experiment that importers run unless told otherwise: start, stop and step [s].
pub const DEFAULT_EXPERIMENT: (f64, f64, f64) = (0.0, 1.0, 0.1);

/// When this version of the table was made; a fixed date keeps the FMU the same bytes from the same sources.
const GENERATION_DATE: &str = "2026-11-22T00:00:00Z";

/// Short text about the model, for importers and the documentation.
pub const SUMMARY: &str = "Lubrication of cartilage on cartilage in a line contact: fluid film, poroelastic layers, \
    solid contact and boundary friction, quasi-steady";

static XML: LazyLock<(String, String)> = LazyLock::new(|| {
    let body = body();
    let token = Uuid::new_v5(&Uuid::NAMESPACE_OID, body.as_bytes()).to_string();
    let head = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription\n  fmiVersion=\"2.0\"\n  \
         modelName=\"{MODEL_IDENTIFIER}\"\n  guid=\"{token}\"\n"
    );
    (head + &body, token)
});

/// `modelDescription.xml`.
pub fn xml() -> &'static str {
    &XML.0
}

/// The GUID: a hash of everything else in `modelDescription.xml`, so that a library and a description that do not belong
/// together are found out.
pub fn token() -> &'static str {
    &XML.1
}

fn body() -> String {
    let (start, stop, step) = DEFAULT_EXPERIMENT;
    let mut xml = String::new();
    for (key, value) in [
        ("description", SUMMARY),
        ("version", env!("CARGO_PKG_VERSION")),
        ("copyright", "The cartilage-contact developers"),
        ("license", env!("CARGO_PKG_LICENSE")),
        ("generationTool", concat!("cartilage-contact ", env!("CARGO_PKG_VERSION"))),
        ("generationDateAndTime", GENERATION_DATE),
        ("variableNamingConvention", "structured"),
        ("numberOfEventIndicators", "0"),
    ] {
        let _ = writeln!(xml, "  {key}=\"{}\"", escape(value));
    }
    xml.pop();
    let _ = write!(
        xml,
        ">\n\n  <CoSimulation\n    modelIdentifier=\"{MODEL_IDENTIFIER}\"\n    canHandleVariableCommunicationStepSize=\"true\"\n    \
         canInterpolateInputs=\"true\"\n    maxOutputDerivativeOrder=\"1\"\n    canNotUseMemoryManagementFunctions=\"true\"\n    \
         canGetAndSetFMUstate=\"true\"\n    canSerializeFMUstate=\"true\"\n    providesDirectionalDerivative=\"true\"/>\n\n"
    );
    units(&mut xml);
    types(&mut xml);
    xml += "  <LogCategories>\n";
    for (name, description) in Category::ITEMS {
        let _ = writeln!(xml, "    <Category name=\"{name}\" description=\"{}\"/>", escape(description));
    }
    xml += "  </LogCategories>\n\n";
    let _ = writeln!(xml, "  <DefaultExperiment startTime=\"{start}\" stopTime=\"{stop}\" stepSize=\"{step}\"/>\n");
    xml += "  <ModelVariables>\n";
    VARIABLES.iter().enumerate().for_each(|(reference, variable)| scalar_variable(&mut xml, reference, variable));
    xml += "  </ModelVariables>\n\n";
    structure(&mut xml);
    xml += "</fmiModelDescription>\n";
    xml
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

/// An enumeration type has the name of the (one) variable that has it.
fn types(xml: &mut String) {
    *xml += "  <TypeDefinitions>\n";
    for variable in VARIABLES.iter() {
        if let Type::Enumeration(items) = variable.data_type() {
            let _ = writeln!(xml, "    <SimpleType name=\"{}\">\n      <Enumeration>", type_name(variable));
            for ((word, description), value) in items.iter().zip(1..) {
                let description = escape(description);
                let _ =
                    writeln!(xml, "        <Item name=\"{word}\" value=\"{value}\" description=\"{description}\"/>");
            }
            *xml += "      </Enumeration>\n    </SimpleType>\n";
        }
    }
    *xml += "  </TypeDefinitions>\n\n";
}

/// Type and variable names share no namespace, but some importers make identifiers of both.
fn type_name(variable: &Variable) -> String {
    format!("{}_type", variable.name)
}

fn scalar_variable(xml: &mut String, reference: usize, variable: &Variable) {
    let role = match (variable.source, variable.data_type()) {
        (Source::Input(_), _) => "causality=\"input\" variability=\"continuous\"",
        (Source::Parameter(_), _) => "causality=\"parameter\" variability=\"fixed\" initial=\"exact\"",
        (_, Type::Real) => "causality=\"output\" variability=\"continuous\" initial=\"calculated\"",
        _ => "causality=\"output\" variability=\"discrete\" initial=\"calculated\"",
    };
    let _ = writeln!(
        xml,
        "    <ScalarVariable name=\"{}\" valueReference=\"{reference}\" {role}\n      description=\"{}\">",
        variable.name,
        escape(&variable.description)
    );
    *xml += match variable.data_type() {
        Type::Real => "      <Real",
        Type::Integer => "      <Integer",
        Type::Boolean => "      <Boolean",
        Type::Enumeration(_) => "      <Enumeration",
    };
    for (key, value) in attributes(variable) {
        let _ = write!(xml, " {key}=\"{value}\"");
    }
    *xml += "/>\n    </ScalarVariable>\n";
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

/// Every output depends on all inputs, except the stations, which depend on none.
fn structure(xml: &mut String) {
    let indices = |wanted: fn(&Variable) -> bool| {
        let found = VARIABLES.iter().zip(1..).filter(move |(variable, _)| wanted(variable));
        found.map(|(_, index): (_, usize)| index.to_string()).collect::<Vec<_>>()
    };
    let inputs = indices(|variable| matches!(variable.source, Source::Input(_))).join(" ");
    let stations = indices(|variable| matches!(variable.source, Source::Position(_)));
    *xml += "  <ModelStructure>\n";
    for list in ["Outputs", "InitialUnknowns"] {
        let _ = writeln!(xml, "    <{list}>");
        for index in indices(Variable::is_output) {
            let dependencies = if stations.contains(&index) { "" } else { &inputs };
            let _ = writeln!(xml, "      <Unknown index=\"{index}\" dependencies=\"{dependencies}\"/>");
        }
        let _ = writeln!(xml, "    </{list}>");
    }
    *xml += "  </ModelStructure>\n\n";
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
