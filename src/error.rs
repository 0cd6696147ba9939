//! The one error type. Every variant names what was given, what was allowed and, where it helps, what to do.

use thiserror::Error;

/// Everything that can go wrong in this crate.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Error {
    /// A parameter or an input has a value that the model cannot take.
    #[error("{name} = {value} is not allowed: {allowed}")]
    Value {
        /// Name of the variable, as in the table of variables.
        name: String,
        /// The value as it was given.
        value: String,
        /// What would have been accepted.
        allowed: String,
    },
    /// A name that no variable has.
    #[error("unknown variable `{name}`; {hint}")]
    UnknownName {
        /// The name as it was given.
        name: String,
        /// The closest names, or where to find the list.
        hint: String,
    },
    /// The solver could not reach the requested inputs. The state before the call is kept.
    #[error(
        "no converged solution at {requested}: reached {reached}, then {reason}; \
         take smaller steps, or refine the mesh"
    )]
    NotConverged {
        /// The inputs asked for.
        requested: String,
        /// The last inputs that were solved on the way.
        reached: String,
        /// How far along the way from the old inputs to the requested ones, 0 to 1.
        fraction: f64,
        /// What Newton's method stopped on.
        reason: String,
    },
    /// Memory that a solution needs and that is not there.
    #[error("{0}")]
    Memory(String),
    /// Bytes or a snapshot that do not belong to this simulation.
    #[error("state refused: {0}")]
    State(String),
    /// A case file with a mistake.
    #[error("{file}:{line}: {message}")]
    Case {
        /// Path of the file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Which key, what value, what was allowed.
        message: String,
    },
    /// A file that could not be read or written.
    #[error("{path}: {message}")]
    File {
        /// Path of the file.
        path: String,
        /// What the operating system or the format says, and what to do.
        message: String,
    },
}

impl Error {
    /// A value outside what is allowed.
    pub fn value(name: &str, value: impl ToString, allowed: impl Into<String>) -> Self {
        Self::Value { name: name.into(), value: value.to_string(), allowed: allowed.into() }
    }
}
