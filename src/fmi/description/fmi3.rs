//! `modelDescription.xml` and `terminalsAndIcons.xml` of FMI 3.0.

use std::fmt::Write;
use std::sync::LazyLock;

use super::{
    Token, attributes, co_simulation, depends_on_inputs, escape, head, log_categories_and_experiment, role, types,
    units,
};
use crate::fmi::answer::Answer;
use crate::fmi::standard::{Standard, TIME_REFERENCE};
use crate::units::Unit;
use crate::variables::{Source, Type, VARIABLES, Variable};

/// The version, as both files name it.
const VERSION: &str = "3.0";

// Only the token is kept: what a static holds stays behind when the library is unloaded.
static TOKEN: LazyLock<Token> = LazyLock::new(|| Token::new(&body()));

/// `modelDescription.xml`.
pub fn xml() -> String {
    TOKEN.document(VERSION, "instantiationToken", &body())
}

/// The instantiation token.
pub fn token() -> &'static str {
    TOKEN.text()
}

/// Refuses another token.
pub fn check_token(name: &str, given: Option<String>) -> Answer<()> {
    TOKEN.check(name, given)
}

fn body() -> String {
    let mut xml = String::new();
    head(&mut xml);
    xml.pop();
    xml += ">\n\n";
    let abilities = [
        ("canHandleVariableCommunicationStepSize", "true"),
        ("maxOutputDerivativeOrder", "1"),
        ("canGetAndSetFMUState", "true"),
        ("canSerializeFMUState", "true"),
        ("providesDirectionalDerivatives", "true"),
        ("providesAdjointDerivatives", "true"),
    ];
    co_simulation(&mut xml, &abilities);
    units(&mut xml);
    let opening = |name: &str| format!("    <EnumerationType name=\"{name}\">\n");
    types(&mut xml, opening, "    </EnumerationType>\n", "      ");
    log_categories_and_experiment(&mut xml);
    xml += "  <ModelVariables>\n";
    for (reference, row, length) in Standard::Fmi3.variables() {
        variable(&mut xml, reference, row, length);
    }
    let _ = writeln!(
        xml,
        "    <Float64 name=\"time\" valueReference=\"{TIME_REFERENCE}\" causality=\"independent\" variability=\"continuous\"\n      \
         description=\"Time\"/>"
    );
    xml += "  </ModelVariables>\n\n";
    structure(&mut xml);
    xml += "</fmiModelDescription>\n";
    xml
}

fn variable(xml: &mut String, reference: u32, variable: &Variable, length: usize) {
    let element = match variable.data_type() {
        Type::Real => "Float64",
        Type::Integer => "Int32",
        Type::Boolean => "Boolean",
        Type::Enumeration(_) => "Enumeration",
    };
    let (mut name, mut description) = (variable.name, variable.full_description());
    if length > 1 {
        // A profile has the name of its first station, without what that says of the station.
        name = name.split('[').next().unwrap_or(name);
        description = format!("{} at {length} stations", variable.description);
    }
    let _ = write!(
        xml,
        "    <{element} name=\"{name}\" valueReference=\"{reference}\" {}\n      description=\"{}\"",
        role(variable),
        escape(&description)
    );
    for (key, value) in attributes(variable) {
        let _ = write!(xml, " {key}=\"{value}\"");
    }
    if length > 1 {
        let _ = writeln!(xml, ">\n      <Dimension start=\"{length}\"/>\n    </{element}>");
    } else {
        *xml += "/>\n";
    }
}

/// Unknowns are known by their value references.
fn structure(xml: &mut String) {
    let inputs = Standard::Fmi3.variables().filter(|(_, variable, _)| matches!(variable.source, Source::Input(_)));
    let inputs = inputs.map(|(reference, ..)| reference.to_string()).collect::<Vec<_>>().join(" ");
    *xml += "  <ModelStructure>\n";
    for element in ["Output", "InitialUnknown"] {
        for (reference, variable, _) in Standard::Fmi3.variables().filter(|(_, variable, _)| variable.is_output()) {
            let dependencies = if depends_on_inputs(variable) { &inputs } else { "" };
            let _ = writeln!(xml, "    <{element} valueReference=\"{reference}\" dependencies=\"{dependencies}\"/>");
        }
    }
    *xml += "  </ModelStructure>\n\n";
}

/// `terminalsAndIcons.xml`: what a mechanical model connects to belongs to one terminal, all inputs, all forces and moments.
pub fn terminals() -> String {
    let mut xml = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiTerminalsAndIcons fmiVersion=\"{VERSION}\">\n  <Terminals>\n    \
         <Terminal name=\"contact\" matchingRule=\"bus\"\n      \
         description=\"The two bodies in contact: how they move, and the forces between them\">\n"
    );
    for variable in VARIABLES.iter() {
        let force =
            variable.is_output() && variable.is_scalar() && matches!(variable.unit, Unit::Newton | Unit::NewtonMetre);
        if force || matches!(variable.source, Source::Input(_)) {
            let name = variable.name;
            let _ = writeln!(
                xml,
                "      <TerminalMemberVariable variableName=\"{name}\" memberName=\"{name}\" variableKind=\"signal\"/>"
            );
        }
    }
    xml += "    </Terminal>\n  </Terminals>\n</fmiTerminalsAndIcons>\n";
    xml
}
