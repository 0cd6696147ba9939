//! The model description for importers that know a part of the standard: all outputs are real numbers, none of them an array, and
//! whatever has a start value has a number.
//!
//! The library does not change, and neither do value references and token.

use std::collections::BTreeMap;

use crate::fmi::standard::Standard;

/// Leaves out the variables that narrow importers stumble over, and what the model structure says of them.
pub fn slim(standard: Standard, xml: &str) -> String {
    let (end_of_variable, key) = match standard {
        Standard::Fmi2 => ("    </ScalarVariable>\n", "index"),
        Standard::Fmi3 => ("", "valueReference"),
    };
    let Some((head, (variables, structure))) = xml
        .split_once("  <ModelVariables>\n")
        .and_then(|(head, rest)| Some((head, rest.split_once("  </ModelVariables>\n")?)))
    else {
        return xml.into();
    };
    let mut kept = String::new();
    // What the structure calls a variable: its place from 1 in FMI 2, which moves; its value reference in FMI 3.
    let mut names = BTreeMap::new();
    for (index, variable) in elements(variables, end_of_variable).into_iter().enumerate() {
        let profile =
            variable.contains("<Dimension") || attribute(variable, "name").is_some_and(|name| name.contains('['));
        let real = ["<Real", "<Float64"].iter().any(|element| variable.contains(element));
        let other_output = variable.contains("causality=\"output\"") && !real;
        if profile || other_output {
            continue;
        }
        // XML has both spellings; some tools make a number of every start value.
        kept += &variable.replace(" start=\"true\"", " start=\"1\"").replace(" start=\"false\"", " start=\"0\"");
        let (before, after) = match standard {
            Standard::Fmi2 => ((index + 1).to_string(), (names.len() + 1).to_string()),
            Standard::Fmi3 => {
                [(); 2].map(|()| attribute(variable, "valueReference").unwrap_or_default().to_owned()).into()
            }
        };
        names.insert(before, after);
    }
    let mut rest = String::new();
    for line in structure.split_inclusive('\n') {
        match attribute(line, key) {
            Some(name) => {
                if let Some(after) = names.get(name) {
                    let dependencies = attribute(line, "dependencies").unwrap_or_default();
                    let moved: Vec<_> = dependencies.split(' ').filter_map(|name| names.get(name)).cloned().collect();
                    rest += &line
                        .replace(&format!("{key}=\"{name}\""), &format!("{key}=\"{after}\""))
                        .replace(&format!("=\"{dependencies}\""), &format!("=\"{}\"", moved.join(" ")));
                }
            }
            None => rest += line,
        }
    }
    format!("{head}  <ModelVariables>\n{kept}  </ModelVariables>\n{rest}")
}

/// The variables one by one: up to this end, or up to the line that closes an element.
fn elements<'a>(variables: &'a str, end: &str) -> Vec<&'a str> {
    let mut found = Vec::new();
    let mut start = 0;
    let mut place = 0;
    for line in variables.split_inclusive('\n') {
        place += line.len();
        let closes = match end {
            // Its own closing line, or an element without content; `<Dimension .../>` is deeper.
            "" => {
                line.starts_with("    </") || (line.ends_with("/>\n") && !line.trim_start().starts_with("<Dimension"))
            }
            end => line == end,
        };
        if closes {
            found.push(&variables[start..place]);
            start = place;
        }
    }
    found
}

/// The value of an attribute; the first of that name.
fn attribute<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(&format!(" {name}=\""))?;
    rest.split_once('"').map(|(value, _)| value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fmi::description::{fmi2, fmi3};
    use crate::variables::{Type, VARIABLES, Variable};

    fn stays(variable: &&Variable) -> bool {
        variable.is_scalar() && !(variable.is_output() && variable.data_type() != Type::Real)
    }

    #[test]
    fn real_scalars_stay_and_the_structure_speaks_of_them_only() {
        let outputs = VARIABLES.iter().filter(stays).filter(|row| row.is_output()).count();
        for (standard, xml) in [(Standard::Fmi2, fmi2::xml()), (Standard::Fmi3, fmi3::xml())] {
            let slim = slim(standard, &xml);
            for variable in VARIABLES.iter().filter(|row| row.is_scalar()) {
                let there = slim.contains(&format!("name=\"{}\" valueReference", variable.name));
                assert_eq!(there, stays(&variable), "{} {standard:?}", variable.name);
            }
            assert!(!slim.contains("<Dimension") && !slim.contains("film_thickness[1]"));
            let unknowns = if standard == Standard::Fmi2 { "<Unknown index" } else { "<Output value" };
            let lists = if standard == Standard::Fmi2 { 2 } else { 1 };
            assert_eq!(slim.matches(unknowns).count(), lists * outputs);
            let starts = slim.split(" start=\"").skip(1).filter_map(|rest| rest.split('"').next());
            assert!(
                starts.clone().count() > 20 && starts.clone().all(|start| start.parse::<f64>().is_ok()),
                "{standard:?}"
            );
        }
    }

    #[test]
    fn places_of_fmi_2_are_those_of_the_outputs() {
        let slim = slim(Standard::Fmi2, &fmi2::xml());
        let variables: Vec<_> = slim.lines().filter(|line| line.contains("<ScalarVariable name")).collect();
        let indices = slim.lines().filter_map(|line| attribute(line, "index"));
        for index in indices {
            let line = variables[index.parse::<usize>().unwrap() - 1];
            assert!(line.contains("causality=\"output\""), "{index}: {line}");
        }
    }
}
