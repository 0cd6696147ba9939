//! The functions of FMI 3.0 that a co-simulation FMU without events and clocks answers; [`other_types`] and [`absent`]
//! have the rest of the 75.
//! The standard says what they do; [`Instance`] does it.
//!
//! Enumerations and Booleans of C arrive as integers, so that no value that C may pass is undefined in Rust.
//!
//! # Safety
//! What the standard asks of the importer: handles and states come from this FMU and are used by one thread at a time,
//! arrays are as long as their count says, strings end with NUL. Null handles and null pointers are answered with
//! `fmi3Error`.
#![allow(unsafe_code, clippy::missing_safety_doc)]

pub mod absent;
pub mod other_types;

use std::ffi::{c_char, c_uint, c_void};

use crate::fmi::answer::{Answer, refuse};
use crate::fmi::boundary::{
    Listener, Messenger, PlainLogger, array, array_mut, create, guard, hand_out, handed_out, place, release,
    set_debug_logging, string, take_back, write_state,
};
use crate::fmi::description;
use crate::fmi::instance::Instance;
use crate::fmi::log::Log;
use crate::fmi::standard::Standard;
use crate::fmi::state::SavedState;

/// `bool` of C: one byte, of which any value but 0 is true.
#[allow(non_camel_case_types)]
pub type fmi3Boolean = u8;
/// The importer's message function.
#[allow(non_camel_case_types)]
pub type fmi3LogMessageCallback = Option<PlainLogger>;
/// Never called: no step has intermediate values.
#[allow(non_camel_case_types)]
pub type fmi3IntermediateUpdateCallback = Option<unsafe extern "C" fn()>;

/// "3.0".
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// Switches log categories on or off.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetDebugLogging(
    instance: *mut c_void,
    logging_on: fmi3Boolean,
    count: usize,
    categories: *const *const c_char,
) -> c_uint {
    unsafe { guard(instance, "fmi3SetDebugLogging", |it| set_debug_logging(it, logging_on != 0, count, categories)) }
}

/// Makes an instance; null, and a message why, where that is not possible.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    instance_name: *const c_char,
    instantiation_token: *const c_char,
    resource_path: *const c_char,
    _visible: fmi3Boolean,
    logging_on: fmi3Boolean,
    event_mode_used: fmi3Boolean,
    _early_return_allowed: fmi3Boolean,
    _required_intermediate_variables: *const c_uint,
    required_intermediate_variable_count: usize,
    instance_environment: *mut c_void,
    log_message: fmi3LogMessageCallback,
    _intermediate_update: fmi3IntermediateUpdateCallback,
) -> *mut c_void {
    let messenger = Messenger { listener: Listener::Plain(log_message), environment: instance_environment };
    let texts = unsafe { (string(instance_name), string(instantiation_token)) };
    let may = || may_instantiate(texts, event_mode_used != 0, required_intermediate_variable_count);
    let resources = unsafe { string(resource_path) };
    create(Standard::Fmi3, "fmi3InstantiateCoSimulation", may, Log::new(logging_on != 0), messenger, resources)
}

fn may_instantiate(
    (name, token): (Option<String>, Option<String>),
    events: bool,
    intermediate_variables: usize,
) -> Answer<()> {
    if name.unwrap_or_default().trim().is_empty() {
        return refuse("instanceName is missing or empty");
    }
    if events {
        return refuse(absent::EVENTS);
    }
    if intermediate_variables != 0 {
        return refuse("requiredIntermediateVariables are not allowed: providesIntermediateUpdate is false");
    }
    description::fmi3::check_token("instantiationToken", token)
}

/// Ends an instance. Null is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: *mut c_void) {
    unsafe { release(instance) }
}

/// Start and stop of the experiment; from here inputs can be set and outputs asked for in any order.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: *mut c_void,
    tolerance_defined: fmi3Boolean,
    tolerance: f64,
    start_time: f64,
    stop_time_defined: fmi3Boolean,
    stop_time: f64,
) -> c_uint {
    let tolerance = (tolerance_defined != 0).then_some(tolerance);
    let stop_time = (stop_time_defined != 0).then_some(stop_time);
    unsafe {
        guard(instance, "fmi3EnterInitializationMode", |it| {
            it.setup_experiment(tolerance, start_time, stop_time)?;
            it.enter_initialization_mode()
        })
    }
}

/// From here the parameters are fixed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ExitInitializationMode(instance: *mut c_void) -> c_uint {
    unsafe { guard(instance, "fmi3ExitInitializationMode", Instance::exit_initialization_mode) }
}

/// Ends the run; results can still be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Terminate(instance: *mut c_void) -> c_uint {
    unsafe { guard(instance, "fmi3Terminate", Instance::terminate) }
}

/// As freshly instantiated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Reset(instance: *mut c_void) -> c_uint {
    unsafe { guard(instance, "fmi3Reset", Instance::reset) }
}

/// Reads real variables; of a profile, all its stations.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFloat64(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    values: *mut f64,
    value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetFloat64", |it| {
            let references = array("valueReferences", references, count)?;
            it.get_real(references, array_mut("values", values, value_count)?)
        })
    }
}

/// Reads integers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetInt32(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    values: *mut i32,
    value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetInt32", |it| {
            let references = array("valueReferences", references, count)?;
            it.get_integer(references, array_mut("values", values, value_count)?)
        })
    }
}

/// Reads enumerations, whose items count from 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetInt64(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    values: *mut i64,
    value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetInt64", |it| {
            let references = array("valueReferences", references, count)?;
            it.get_enumeration(references, array_mut("values", values, value_count)?)
        })
    }
}

/// Reads Boolean variables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetBoolean(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    values: *mut fmi3Boolean,
    value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetBoolean", |it| {
            let references = array("valueReferences", references, count)?;
            it.get_boolean(references, array_mut("values", values, value_count)?)
        })
    }
}

/// Sets real parameters and inputs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFloat64(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    values: *const f64,
    value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3SetFloat64", |it| {
            let references = array("valueReferences", references, count)?;
            it.set_real(references, array("values", values, value_count)?)
        })
    }
}

/// Sets integer parameters.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetInt32(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    values: *const i32,
    value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3SetInt32", |it| {
            let references = array("valueReferences", references, count)?;
            it.set_integer(references, array("values", values, value_count)?)
        })
    }
}

/// Sets enumeration parameters, whose items count from 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetInt64(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    values: *const i64,
    value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3SetInt64", |it| {
            let references = array("valueReferences", references, count)?;
            it.set_enumeration(references, array("values", values, value_count)?)
        })
    }
}

/// Sets Boolean parameters.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetBoolean(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    values: *const fmi3Boolean,
    value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3SetBoolean", |it| {
            let references = array("valueReferences", references, count)?;
            it.set_boolean(references, array("values", values, value_count)?)
        })
    }
}

/// Copies the state; into the memory of `*state` where that is not null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(instance: *mut c_void, state: *mut *mut c_void) -> c_uint {
    unsafe { guard(instance, "fmi3GetFMUState", |it| hand_out(it.save()?, state)) }
}

/// Returns to a copied state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(instance: *mut c_void, state: *mut c_void) -> c_uint {
    unsafe { guard(instance, "fmi3SetFMUState", |it| it.restore(handed_out(state)?)) }
}

/// Frees a copied state and sets it to null. Null is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(instance: *mut c_void, state: *mut *mut c_void) -> c_uint {
    unsafe { guard(instance, "fmi3FreeFMUState", |_| take_back(state)) }
}

/// How many bytes fmi3SerializeFMUState writes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializedFMUStateSize(
    instance: *mut c_void,
    state: *mut c_void,
    size: *mut usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3SerializedFMUStateSize", |_| {
            *place("size", size)? = handed_out(state)?.to_bytes()?.len();
            Ok(())
        })
    }
}

/// Writes a copied state as bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    instance: *mut c_void,
    state: *mut c_void,
    bytes: *mut u8,
    size: usize,
) -> c_uint {
    unsafe { guard(instance, "fmi3SerializeFMUState", |_| write_state(state, bytes, size)) }
}

/// Reads a state from bytes; into the memory of `*state` where that is not null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    instance: *mut c_void,
    bytes: *const u8,
    size: usize,
    state: *mut *mut c_void,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3DeserializeFMUState", |_| {
            hand_out(SavedState::from_bytes(array("serializedState", bytes, size)?)?, state)
        })
    }
}

/// Derivatives of outputs with respect to inputs, times a seed of the inputs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetDirectionalDerivative(
    instance: *mut c_void,
    unknowns: *const c_uint,
    unknown_count: usize,
    knowns: *const c_uint,
    known_count: usize,
    seed: *const f64,
    seed_count: usize,
    sensitivity: *mut f64,
    sensitivity_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetDirectionalDerivative", |it| {
            let unknowns = array("unknowns", unknowns, unknown_count)?;
            let (knowns, seed) = (array("knowns", knowns, known_count)?, array("seed", seed, seed_count)?);
            let sensitivity = array_mut("sensitivity", sensitivity, sensitivity_count)?;
            it.directional_derivative(unknowns, knowns, seed, sensitivity)
        })
    }
}

/// A seed of the outputs, times their derivatives with respect to inputs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetAdjointDerivative(
    instance: *mut c_void,
    unknowns: *const c_uint,
    unknown_count: usize,
    knowns: *const c_uint,
    known_count: usize,
    seed: *const f64,
    seed_count: usize,
    sensitivity: *mut f64,
    sensitivity_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetAdjointDerivative", |it| {
            let unknowns = array("unknowns", unknowns, unknown_count)?;
            let (knowns, seed) = (array("knowns", knowns, known_count)?, array("seed", seed, seed_count)?);
            let sensitivity = array_mut("sensitivity", sensitivity, sensitivity_count)?;
            it.adjoint_derivative(unknowns, knowns, seed, sensitivity)
        })
    }
}

/// Time derivatives of outputs at the end of the last step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetOutputDerivatives(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    orders: *const i32,
    values: *mut f64,
    value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetOutputDerivatives", |it| {
            let references = array("valueReferences", references, count)?;
            let orders = array("orders", orders, count)?;
            it.output_derivatives(references, orders, array_mut("values", values, value_count)?)
        })
    }
}

/// One communication step. It is done whole or not at all.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    instance: *mut c_void,
    current_communication_point: f64,
    communication_step_size: f64,
    _no_set_fmu_state_prior_to_current_point: fmi3Boolean,
    event_handling_needed: *mut fmi3Boolean,
    terminate_simulation: *mut fmi3Boolean,
    early_return: *mut fmi3Boolean,
    last_successful_time: *mut f64,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3DoStep", |it| {
            *place("eventHandlingNeeded", event_handling_needed)? = 0;
            *place("terminateSimulation", terminate_simulation)? = 0;
            *place("earlyReturn", early_return)? = 0;
            place("lastSuccessfulTime", last_successful_time)?;
            let done = it.do_step(current_communication_point, communication_step_size);
            *place("lastSuccessfulTime", last_successful_time)? = it.time();
            done
        })
    }
}
