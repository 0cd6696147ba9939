//! Which call is legal when: the table in section 4.2.4 of FMI 2.0 and the state machines of FMI 3.0, as data.
//!
//! The standard's columns *stepInProgress* and *stepCanceled* are missing because steps are never asynchronous. Its
//! column *error* is missing because a refused call changes nothing here: the importer may restore, reset or free the
//! instance as the standard asks, or put the mistake right and go on.

use std::fmt;

use crate::fmi::standard::Standard;

/// Where an instance is in its life.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Phase {
    /// Made or reset; parameters and start values may be set.
    Instantiated,
    /// Inputs may be set and outputs asked for, in any order.
    Initialization,
    /// At a communication point.
    StepComplete,
    /// FMI 2 only: the last step did not converge; what can be read is the communication point before it.
    StepFailed,
    /// The run is over; results can still be read.
    Terminated,
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Instantiated => "before initialization mode",
            Self::Initialization => "in initialization mode",
            Self::StepComplete => "at a communication point",
            Self::StepFailed => "after a step that failed",
            Self::Terminated => "after the run was terminated",
        })
    }
}

/// The calls that depend on the phase. Calls with equal rows share one name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Call {
    SetupExperiment,
    EnterInitializationMode,
    ExitInitializationMode,
    Terminate,
    Get,
    Set,
    GetDirectionalDerivative,
    SetRealInputDerivatives,
    GetRealOutputDerivatives,
    DoStep,
    CancelStep,
    GetStatus,
    /// Everything that is legal from instantiation to the end: logging, reset, and the handling of states.
    Any,
}

impl Call {
    /// The phases in which it is legal.
    pub const fn phases(self, standard: Standard) -> &'static [Phase] {
        use Phase::{Initialization, Instantiated, StepComplete, StepFailed, Terminated};
        match self {
            // FMI 3: start values can be read back.
            Self::Get if matches!(standard, Standard::Fmi3) => Self::Any.phases(standard),
            Self::SetupExperiment | Self::EnterInitializationMode => &[Instantiated],
            Self::ExitInitializationMode => &[Initialization],
            Self::Terminate => &[StepComplete, StepFailed],
            Self::Get | Self::GetDirectionalDerivative => &[Initialization, StepComplete, StepFailed, Terminated],
            Self::Set | Self::SetRealInputDerivatives => &[Instantiated, Initialization, StepComplete],
            Self::GetRealOutputDerivatives => &[StepComplete, StepFailed, Terminated],
            Self::DoStep => &[StepComplete],
            Self::CancelStep => &[],
            Self::GetStatus => &[StepComplete, StepFailed, Terminated],
            Self::Any => &[Instantiated, Initialization, StepComplete, StepFailed, Terminated],
        }
    }
}
