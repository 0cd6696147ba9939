//! The functions of FMI 2.0 for model exchange, which this FMU has not. The standard does not ask for them in a library for
//! co-simulation, but some importers look up all functions of FMI 2.0 as they load a library. Each tells why it returns `fmi2Error`.
//!
//! # Safety
//! As for [`fmi2`](super).
#![allow(unsafe_code, clippy::missing_safety_doc)]

use std::ffi::{c_int, c_uint, c_void};

use crate::fmi::answer::refuse;
use crate::fmi::boundary::guard;

/// Not filled in: there are no events.
#[allow(non_camel_case_types)]
pub type fmi2EventInfo = c_void;

unsafe fn never(component: *mut c_void, function: &str) -> c_uint {
    unsafe { guard(component, function, |_| refuse("this FMU is for co-simulation, not for model exchange")) }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterEventMode(component: *mut c_void) -> c_uint {
    unsafe { never(component, "fmi2EnterEventMode") }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2NewDiscreteStates(component: *mut c_void, _event_info: *mut fmi2EventInfo) -> c_uint {
    unsafe { never(component, "fmi2NewDiscreteStates") }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterContinuousTimeMode(component: *mut c_void) -> c_uint {
    unsafe { never(component, "fmi2EnterContinuousTimeMode") }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CompletedIntegratorStep(
    component: *mut c_void,
    _no_set_fmu_state_prior_to_current_point: c_int,
    _enter_event_mode: *mut c_int,
    _terminate_simulation: *mut c_int,
) -> c_uint {
    unsafe { never(component, "fmi2CompletedIntegratorStep") }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetTime(component: *mut c_void, _time: f64) -> c_uint {
    unsafe { never(component, "fmi2SetTime") }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetContinuousStates(component: *mut c_void, _states: *const f64, _count: usize) -> c_uint {
    unsafe { never(component, "fmi2SetContinuousStates") }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDerivatives(component: *mut c_void, _derivatives: *mut f64, _count: usize) -> c_uint {
    unsafe { never(component, "fmi2GetDerivatives") }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetEventIndicators(
    component: *mut c_void,
    _indicators: *mut f64,
    _count: usize,
) -> c_uint {
    unsafe { never(component, "fmi2GetEventIndicators") }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetContinuousStates(component: *mut c_void, _states: *mut f64, _count: usize) -> c_uint {
    unsafe { never(component, "fmi2GetContinuousStates") }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetNominalsOfContinuousStates(
    component: *mut c_void,
    _nominals: *mut f64,
    _count: usize,
) -> c_uint {
    unsafe { never(component, "fmi2GetNominalsOfContinuousStates") }
}
