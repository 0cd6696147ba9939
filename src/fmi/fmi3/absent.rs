//! The functions of FMI 3.0 for what this FMU has not: events, clocks, model exchange, scheduled execution. The standard wants all of them in the library; each tells why it returns `fmi3Error`.
//!
//! # Safety
//! As for [`fmi3`](super).
#![allow(unsafe_code, clippy::missing_safety_doc)]

use std::ffi::{c_char, c_uint, c_void};

use super::{fmi3Boolean, fmi3LogMessageCallback};
use crate::fmi::answer::refuse;
use crate::fmi::boundary::{Listener, Messenger, create, guard};
use crate::fmi::log::Log;
use crate::fmi::standard::Standard;

/// Why there are no events.
pub const EVENTS: &str = "there is no event mode: hasEventMode is false";
const CLOCKS: &str = "there are no clocks";
const MODEL_EXCHANGE: &str = "this FMU is for co-simulation, not for model exchange";
const SCHEDULED_EXECUTION: &str = "this FMU is for co-simulation, not for scheduled execution";
const CONFIGURATION: &str = "there are no structural parameters to configure";
const DEPENDENCIES: &str = "providesPerElementDependencies is false; modelDescription.xml has the dependencies";

/// Called by clocks, of which there are none.
#[allow(non_camel_case_types)]
pub type fmi3ClockUpdateCallback = Option<unsafe extern "C" fn(*mut c_void)>;
/// Not called.
#[allow(non_camel_case_types)]
pub type fmi3LockPreemptionCallback = Option<unsafe extern "C" fn()>;
/// Not called.
#[allow(non_camel_case_types)]
pub type fmi3UnlockPreemptionCallback = Option<unsafe extern "C" fn()>;

unsafe fn never(instance: *mut c_void, function: &str, why: &str) -> c_uint {
    unsafe { guard(instance, function, |_| refuse(why)) }
}

fn no_instance(
    function: &str,
    why: &str,
    environment: *mut c_void,
    log_message: fmi3LogMessageCallback,
) -> *mut c_void {
    let messenger = Messenger { listener: Listener::Plain(log_message), environment };
    create(Standard::Fmi3, function, || refuse(why), Log::new(false), messenger, None)
}

/// Tells that there is no model exchange.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    _instance_name: *const c_char,
    _instantiation_token: *const c_char,
    _resource_path: *const c_char,
    _visible: fmi3Boolean,
    _logging_on: fmi3Boolean,
    instance_environment: *mut c_void,
    log_message: fmi3LogMessageCallback,
) -> *mut c_void {
    no_instance("fmi3InstantiateModelExchange", MODEL_EXCHANGE, instance_environment, log_message)
}

/// Tells that there is no scheduled execution.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    _instance_name: *const c_char,
    _instantiation_token: *const c_char,
    _resource_path: *const c_char,
    _visible: fmi3Boolean,
    _logging_on: fmi3Boolean,
    instance_environment: *mut c_void,
    log_message: fmi3LogMessageCallback,
    _clock_update: fmi3ClockUpdateCallback,
    _lock_preemption: fmi3LockPreemptionCallback,
    _unlock_preemption: fmi3UnlockPreemptionCallback,
) -> *mut c_void {
    no_instance("fmi3InstantiateScheduledExecution", SCHEDULED_EXECUTION, instance_environment, log_message)
}

/// Dependencies of single elements are not provided.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfVariableDependencies(
    instance: *mut c_void,
    _reference: c_uint,
    _dependency_count: *mut usize,
) -> c_uint {
    unsafe { never(instance, "fmi3GetNumberOfVariableDependencies", DEPENDENCIES) }
}

/// Dependencies of single elements are not provided.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetVariableDependencies(
    instance: *mut c_void,
    _dependent: c_uint,
    _elements_of_dependent: *mut usize,
    _independents: *mut c_uint,
    _elements_of_independents: *mut usize,
    _kinds: *mut c_uint,
    _count: usize,
) -> c_uint {
    unsafe { never(instance, "fmi3GetVariableDependencies", DEPENDENCIES) }
}

/// There is nothing to configure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterConfigurationMode(instance: *mut c_void) -> c_uint {
    unsafe { never(instance, "fmi3EnterConfigurationMode", CONFIGURATION) }
}

/// There is nothing to configure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ExitConfigurationMode(instance: *mut c_void) -> c_uint {
    unsafe { never(instance, "fmi3ExitConfigurationMode", CONFIGURATION) }
}

/// There are no clocks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetIntervalDecimal(
    instance: *mut c_void,
    _references: *const c_uint,
    _count: usize,
    _intervals: *mut f64,
    _qualifiers: *mut c_uint,
) -> c_uint {
    unsafe { never(instance, "fmi3GetIntervalDecimal", CLOCKS) }
}

/// There are no clocks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetIntervalFraction(
    instance: *mut c_void,
    _references: *const c_uint,
    _count: usize,
    _counters: *mut u64,
    _resolutions: *mut u64,
    _qualifiers: *mut c_uint,
) -> c_uint {
    unsafe { never(instance, "fmi3GetIntervalFraction", CLOCKS) }
}

/// There are no clocks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetShiftDecimal(
    instance: *mut c_void,
    _references: *const c_uint,
    _count: usize,
    _shifts: *mut f64,
) -> c_uint {
    unsafe { never(instance, "fmi3GetShiftDecimal", CLOCKS) }
}

/// There are no clocks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetShiftFraction(
    instance: *mut c_void,
    _references: *const c_uint,
    _count: usize,
    _counters: *mut u64,
    _resolutions: *mut u64,
) -> c_uint {
    unsafe { never(instance, "fmi3GetShiftFraction", CLOCKS) }
}

/// There are no clocks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetIntervalDecimal(
    instance: *mut c_void,
    _references: *const c_uint,
    _count: usize,
    _intervals: *const f64,
) -> c_uint {
    unsafe { never(instance, "fmi3SetIntervalDecimal", CLOCKS) }
}

/// There are no clocks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetIntervalFraction(
    instance: *mut c_void,
    _references: *const c_uint,
    _count: usize,
    _counters: *const u64,
    _resolutions: *const u64,
) -> c_uint {
    unsafe { never(instance, "fmi3SetIntervalFraction", CLOCKS) }
}

/// There are no clocks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetShiftDecimal(
    instance: *mut c_void,
    _references: *const c_uint,
    _count: usize,
    _shifts: *const f64,
) -> c_uint {
    unsafe { never(instance, "fmi3SetShiftDecimal", CLOCKS) }
}

/// There are no clocks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetShiftFraction(
    instance: *mut c_void,
    _references: *const c_uint,
    _count: usize,
    _counters: *const u64,
    _resolutions: *const u64,
) -> c_uint {
    unsafe { never(instance, "fmi3SetShiftFraction", CLOCKS) }
}

/// There is no event mode.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EvaluateDiscreteStates(instance: *mut c_void) -> c_uint {
    unsafe { never(instance, "fmi3EvaluateDiscreteStates", EVENTS) }
}

/// There is no event mode.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3UpdateDiscreteStates(
    instance: *mut c_void,
    _discrete_states_need_update: *mut fmi3Boolean,
    _terminate_simulation: *mut fmi3Boolean,
    _nominals_changed: *mut fmi3Boolean,
    _values_changed: *mut fmi3Boolean,
    _next_event_time_defined: *mut fmi3Boolean,
    _next_event_time: *mut f64,
) -> c_uint {
    unsafe { never(instance, "fmi3UpdateDiscreteStates", EVENTS) }
}

/// There is no event mode.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterEventMode(instance: *mut c_void) -> c_uint {
    unsafe { never(instance, "fmi3EnterEventMode", EVENTS) }
}

/// There is no event mode.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterStepMode(instance: *mut c_void) -> c_uint {
    unsafe { never(instance, "fmi3EnterStepMode", EVENTS) }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterContinuousTimeMode(instance: *mut c_void) -> c_uint {
    unsafe { never(instance, "fmi3EnterContinuousTimeMode", MODEL_EXCHANGE) }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3CompletedIntegratorStep(
    instance: *mut c_void,
    _no_set_fmu_state_prior_to_current_point: fmi3Boolean,
    _enter_event_mode: *mut fmi3Boolean,
    _terminate_simulation: *mut fmi3Boolean,
) -> c_uint {
    unsafe { never(instance, "fmi3CompletedIntegratorStep", MODEL_EXCHANGE) }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetTime(instance: *mut c_void, _time: f64) -> c_uint {
    unsafe { never(instance, "fmi3SetTime", MODEL_EXCHANGE) }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetContinuousStates(instance: *mut c_void, _states: *const f64, _count: usize) -> c_uint {
    unsafe { never(instance, "fmi3SetContinuousStates", MODEL_EXCHANGE) }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetContinuousStateDerivatives(
    instance: *mut c_void,
    _derivatives: *mut f64,
    _count: usize,
) -> c_uint {
    unsafe { never(instance, "fmi3GetContinuousStateDerivatives", MODEL_EXCHANGE) }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetEventIndicators(instance: *mut c_void, _indicators: *mut f64, _count: usize) -> c_uint {
    unsafe { never(instance, "fmi3GetEventIndicators", MODEL_EXCHANGE) }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetContinuousStates(instance: *mut c_void, _states: *mut f64, _count: usize) -> c_uint {
    unsafe { never(instance, "fmi3GetContinuousStates", MODEL_EXCHANGE) }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNominalsOfContinuousStates(
    instance: *mut c_void,
    _nominals: *mut f64,
    _count: usize,
) -> c_uint {
    unsafe { never(instance, "fmi3GetNominalsOfContinuousStates", MODEL_EXCHANGE) }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfEventIndicators(instance: *mut c_void, _count: *mut usize) -> c_uint {
    unsafe { never(instance, "fmi3GetNumberOfEventIndicators", MODEL_EXCHANGE) }
}

/// For model exchange only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfContinuousStates(instance: *mut c_void, _count: *mut usize) -> c_uint {
    unsafe { never(instance, "fmi3GetNumberOfContinuousStates", MODEL_EXCHANGE) }
}

/// For scheduled execution only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ActivateModelPartition(
    instance: *mut c_void,
    _clock: c_uint,
    _activation_time: f64,
) -> c_uint {
    unsafe { never(instance, "fmi3ActivateModelPartition", SCHEDULED_EXECUTION) }
}
