//! `modelDescription.xml` of FMI 2.0.

use std::fmt::Write;
use std::sync::LazyLock;

use super::{
    Token, attributes, co_simulation, depends_on_inputs, escape, head, log_categories_and_experiment, role, types,
    units,
};
use crate::fmi::answer::Answer;
use crate::variables::{Source, Type, VARIABLES, Variable};

// Only the token is kept: what a static holds stays behind when the library is unloaded.
static TOKEN: LazyLock<Token> = LazyLock::new(|| Token::new(&body()));

/// `modelDescription.xml`.
pub fn xml() -> String {
    TOKEN.document("2.0", "guid", &body())
}

/// The GUID.
pub fn token() -> &'static str {
    TOKEN.text()
}

/// Refuses another GUID.
pub fn check_token(name: &str, given: Option<String>) -> Answer<()> {
    TOKEN.check(name, given)
}

fn body() -> String {
    let mut xml = String::new();
    head(&mut xml);
    xml += "  numberOfEventIndicators=\"0\">\n\n";
    let abilities = [
        ("canHandleVariableCommunicationStepSize", "true"),
        ("canInterpolateInputs", "true"),
        ("maxOutputDerivativeOrder", "1"),
        ("canNotUseMemoryManagementFunctions", "true"),
        ("canGetAndSetFMUstate", "true"),
        ("canSerializeFMUstate", "true"),
        ("providesDirectionalDerivative", "true"),
    ];
    co_simulation(&mut xml, &abilities);
    units(&mut xml);
    let opening = |name: &str| format!("    <SimpleType name=\"{name}\">\n      <Enumeration>\n");
    types(&mut xml, opening, "      </Enumeration>\n    </SimpleType>\n", "        ");
    log_categories_and_experiment(&mut xml);
    xml += "  <ModelVariables>\n";
    VARIABLES.iter().for_each(|variable| scalar_variable(&mut xml, variable));
    xml += "  </ModelVariables>\n\n";
    structure(&mut xml);
    xml += "</fmiModelDescription>\n";
    xml
}

fn scalar_variable(xml: &mut String, variable: &Variable) {
    let _ = writeln!(
        xml,
        "    <ScalarVariable name=\"{}\" valueReference=\"{}\" {}\n      description=\"{}\">",
        variable.name,
        variable.reference,
        role(variable),
        escape(&variable.full_description())
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

/// Unknowns are known by their place in the list of variables, from 1.
fn structure(xml: &mut String) {
    let places =
        |wanted: fn(&Variable) -> bool| (1_usize..).zip(VARIABLES.iter()).filter(move |(_, variable)| wanted(variable));
    let inputs = places(|variable| matches!(variable.source, Source::Input(_)));
    let inputs = inputs.map(|(place, _)| place.to_string()).collect::<Vec<_>>().join(" ");
    *xml += "  <ModelStructure>\n";
    for list in ["Outputs", "InitialUnknowns"] {
        let _ = writeln!(xml, "    <{list}>");
        for (place, variable) in places(Variable::is_output) {
            let dependencies = if depends_on_inputs(variable) { &inputs } else { "" };
            let _ = writeln!(xml, "      <Unknown index=\"{place}\" dependencies=\"{dependencies}\"/>");
        }
        let _ = writeln!(xml, "    </{list}>");
    }
    *xml += "  </ModelStructure>\n\n";
}
