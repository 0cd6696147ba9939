//! The versions of FMI, and what differs between them: how types are called, and what a value reference stands for.

use crate::fmi::answer::{Answer, refuse};
use crate::outputs::STATIONS;
use crate::variables::{Source, Type, VARIABLES, Variable, referred};

/// A version of FMI that the library speaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standard {
    /// FMI 2.0: every station of a profile is a variable of its own.
    Fmi2,
    /// FMI 3.0: a profile is one array, known by the value reference of its first station.
    Fmi3,
}

/// FMI 3's value reference of time, which FMI 2 does not list: far above those of the table.
pub const TIME_REFERENCE: u32 = 1_000_000;

/// One number of what a value reference stands for.
#[derive(Clone, Copy)]
pub enum Element {
    /// The independent variable.
    Time,
    /// A row of the table.
    Row(&'static Variable),
}

impl Element {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Row(variable) => variable.name,
        }
    }

    /// Its data type.
    pub fn data_type(self) -> Type {
        match self {
            Self::Time => Type::Real,
            Self::Row(variable) => variable.data_type(),
        }
    }

    /// The row of the table, which time has not.
    pub fn row(self) -> Answer<&'static Variable> {
        match self {
            Self::Time => refuse("time is the independent variable: it is moved by steps, and has no derivative"),
            Self::Row(variable) => Ok(variable),
        }
    }
}

impl Standard {
    /// What these value references stand for, one after the other.
    pub fn elements(self, references: &[u32]) -> Answer<Vec<Element>> {
        let mut elements = Vec::with_capacity(references.len());
        for &reference in references {
            if self == Self::Fmi3 && reference == TIME_REFERENCE {
                elements.push(Element::Time);
                continue;
            }
            let Some(variable) = referred(reference) else {
                return refuse(format!(
                    "value reference {reference} is unknown; modelDescription.xml lists those there are"
                ));
            };
            let length = match (self, station(variable)) {
                (Self::Fmi2, _) | (_, None) => 1,
                (_, Some(0)) => STATIONS as u32,
                (_, Some(station)) => {
                    let whole = reference - station as u32;
                    return refuse(format!(
                        "value reference {reference} is unknown; the profile that {} is of has {whole}",
                        variable.name
                    ));
                }
            };
            elements.extend((reference..reference + length).filter_map(referred).map(Element::Row));
        }
        Ok(elements)
    }

    /// The rows of the table that have a value reference, with how many values each stands for.
    pub fn variables(self) -> impl Iterator<Item = (u32, &'static Variable, usize)> {
        VARIABLES.iter().filter_map(move |variable| match (self, station(variable)) {
            (Self::Fmi2, _) | (_, None) => Some((variable.reference, variable, 1)),
            (_, Some(0)) => Some((variable.reference, variable, STATIONS)),
            _ => None,
        })
    }

    /// What its functions for a type are called after.
    pub fn functions(self, data_type: Type) -> &'static str {
        match (self, data_type) {
            (Self::Fmi2, Type::Real) => "Real",
            (Self::Fmi2, Type::Integer | Type::Enumeration(_)) => "Integer",
            (Self::Fmi3, Type::Real) => "Float64",
            (Self::Fmi3, Type::Integer) => "Int32",
            (Self::Fmi3, Type::Enumeration(_)) => "Int64",
            (_, Type::Boolean) => "Boolean",
        }
    }

    /// Why a variable cannot be got or set as `wanted`.
    pub fn wrong_type(self, element: Element, wanted: &str) -> String {
        let functions = self.functions(element.data_type());
        let actual = if matches!(element.data_type(), Type::Enumeration(_)) { "Enumeration" } else { functions };
        let article = if actual.starts_with(['I', 'E']) { "an" } else { "a" };
        format!("{} is no {wanted} but {article} {actual}: use the functions for {functions}", element.name())
    }
}

/// Which station of a profile a variable is, from 0.
fn station(variable: &Variable) -> Option<usize> {
    match variable.source {
        Source::Position(station) | Source::Profile(_, station) => Some(station),
        _ => None,
    }
}
