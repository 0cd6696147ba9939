//! What a call answers: what was asked for, or why not.

use crate::error::Error;
use crate::fmi::log::Status;

/// Why a call did not do what it was asked.
#[derive(Debug, Clone, PartialEq)]
pub struct Refusal {
    /// `Error`, or `Discard` where another step size or input may succeed.
    pub status: Status,
    /// Which variable, which value, what is allowed.
    pub message: String,
}

/// Outcome of a call.
pub type Answer<T> = Result<T, Refusal>;

/// Refuses with the status `Error`.
pub fn refuse<T>(message: impl Into<String>) -> Answer<T> {
    Err(Refusal { status: Status::Error, message: message.into() })
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        let status = if matches!(error, Error::NotConverged { .. }) { Status::Discard } else { Status::Error };
        Self { status, message: error.to_string() }
    }
}
