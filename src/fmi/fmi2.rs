//! The 34 functions of FMI 2.0 for co-simulation, and 10 that refuse in [`model_exchange`]. The standard says what they do; [`Instance`] does
//! it.
//!
//! Enumerations of C arrive as integers, so that no value that C may pass is undefined in Rust.
//!
//! # Safety
//! What the standard asks of the importer: handles and states come from this FMU and are used by one thread at a time,
//! arrays are as long as their count says, strings end with NUL. Null handles and null pointers are answered with
//! `fmi2Error`.
#![allow(unsafe_code, clippy::missing_safety_doc)]

pub mod model_exchange;

use std::ffi::{CString, c_char, c_int, c_uint, c_void};

use crate::fmi::answer::{Answer, Refusal, refuse};
use crate::fmi::boundary::{
    Listener, Logger, Messenger, array, array_mut, create, guard, hand_out, handed_out, place, release,
    set_debug_logging, string, take_back, write_state,
};
use crate::fmi::description;
use crate::fmi::instance::Instance;
use crate::fmi::log::{Log, Status};
use crate::fmi::phase::Call;
use crate::fmi::standard::Standard;
use crate::fmi::state::SavedState;

/// `fmi2CallbackFunctions`. Of these only the logger is used: memory is Rust's own, and steps are synchronous.
#[repr(C)]
#[allow(non_camel_case_types)]
pub struct fmi2CallbackFunctions {
    /// The importer's message function.
    pub logger: Option<Logger>,
    /// Not used.
    pub allocate_memory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    /// Not used.
    pub free_memory: Option<unsafe extern "C" fn(*mut c_void)>,
    /// Not used.
    pub step_finished: Option<unsafe extern "C" fn(*mut c_void, c_uint)>,
    /// Passed through to the logger.
    pub component_environment: *mut c_void,
}

/// `fmi2Type`: fmi2CoSimulation.
const CO_SIMULATION: c_uint = 1;
/// `fmi2StatusKind`: fmi2LastSuccessfulTime.
const LAST_SUCCESSFUL_TIME: c_uint = 2;
/// `fmi2StatusKind`: fmi2Terminated.
const TERMINATED: c_uint = 3;

/// "default": the types of the standard's own header.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// "2.0".
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// Switches log categories on or off.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    component: *mut c_void,
    logging_on: c_int,
    count: usize,
    categories: *const *const c_char,
) -> c_uint {
    unsafe { guard(component, "fmi2SetDebugLogging", |it| set_debug_logging(it, logging_on != 0, count, categories)) }
}

/// Makes an instance; null, and a message why, where that is not possible.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    instance_name: *const c_char,
    fmu_type: c_uint,
    guid: *const c_char,
    resource_location: *const c_char,
    functions: *const fmi2CallbackFunctions,
    _visible: c_int,
    logging_on: c_int,
) -> *mut c_void {
    let Some(functions) = (unsafe { functions.as_ref() }) else { return std::ptr::null_mut() };
    let name = unsafe { string(instance_name) }.unwrap_or_default();
    let listener = Listener::Formatting(functions.logger, CString::new(name.as_str()).unwrap_or_default());
    let messenger = Messenger { listener, environment: functions.component_environment };
    let may = || may_instantiate(&name, fmu_type, unsafe { string(guid) });
    let resources = unsafe { string(resource_location) };
    create(Standard::Fmi2, "fmi2Instantiate", may, Log::new(logging_on != 0), messenger, resources)
}

fn may_instantiate(name: &str, fmu_type: c_uint, guid: Option<String>) -> Answer<()> {
    if name.is_empty() {
        return refuse("instanceName is missing or empty");
    }
    if fmu_type != CO_SIMULATION {
        return refuse(format!("fmuType = {fmu_type} is not allowed: this FMU is for co-simulation (1)"));
    }
    description::fmi2::check_token("fmuGUID", guid)
}

/// Ends an instance. Null is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(component: *mut c_void) {
    unsafe { release(component) }
}

/// Start and stop of the experiment.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    component: *mut c_void,
    tolerance_defined: c_int,
    tolerance: f64,
    start_time: f64,
    stop_time_defined: c_int,
    stop_time: f64,
) -> c_uint {
    let tolerance = (tolerance_defined != 0).then_some(tolerance);
    let stop_time = (stop_time_defined != 0).then_some(stop_time);
    unsafe { guard(component, "fmi2SetupExperiment", |it| it.setup_experiment(tolerance, start_time, stop_time)) }
}

/// From here inputs can be set and outputs asked for in any order.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterInitializationMode(component: *mut c_void) -> c_uint {
    unsafe { guard(component, "fmi2EnterInitializationMode", Instance::enter_initialization_mode) }
}

/// From here the parameters are fixed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2ExitInitializationMode(component: *mut c_void) -> c_uint {
    unsafe { guard(component, "fmi2ExitInitializationMode", Instance::exit_initialization_mode) }
}

/// Ends the run; results can still be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Terminate(component: *mut c_void) -> c_uint {
    unsafe { guard(component, "fmi2Terminate", Instance::terminate) }
}

/// As freshly instantiated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(component: *mut c_void) -> c_uint {
    unsafe { guard(component, "fmi2Reset", Instance::reset) }
}

/// Reads real variables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(
    component: *mut c_void,
    references: *const c_uint,
    count: usize,
    values: *mut f64,
) -> c_uint {
    unsafe {
        guard(component, "fmi2GetReal", |it| {
            it.get_real(array("vr", references, count)?, array_mut("value", values, count)?)
        })
    }
}

/// Reads integers and enumerations.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(
    component: *mut c_void,
    references: *const c_uint,
    count: usize,
    values: *mut c_int,
) -> c_uint {
    unsafe {
        guard(component, "fmi2GetInteger", |it| {
            it.get_integer(array("vr", references, count)?, array_mut("value", values, count)?)
        })
    }
}

/// Reads Boolean variables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBoolean(
    component: *mut c_void,
    references: *const c_uint,
    count: usize,
    values: *mut c_int,
) -> c_uint {
    unsafe {
        guard(component, "fmi2GetBoolean", |it| {
            it.get_boolean(array("vr", references, count)?, array_mut("value", values, count)?)
        })
    }
}

/// There are no string variables: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetString(
    component: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *mut *const c_char,
) -> c_uint {
    unsafe {
        guard(component, "fmi2GetString", |it| it.none_of_type(Call::Get, "String", array("vr", references, count)?))
    }
}

/// Sets real parameters and inputs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    component: *mut c_void,
    references: *const c_uint,
    count: usize,
    values: *const f64,
) -> c_uint {
    unsafe {
        guard(component, "fmi2SetReal", |it| {
            it.set_real(array("vr", references, count)?, array("value", values, count)?)
        })
    }
}

/// Sets integer and enumeration parameters.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(
    component: *mut c_void,
    references: *const c_uint,
    count: usize,
    values: *const c_int,
) -> c_uint {
    unsafe {
        guard(component, "fmi2SetInteger", |it| {
            it.set_integer(array("vr", references, count)?, array("value", values, count)?)
        })
    }
}

/// Sets Boolean parameters.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetBoolean(
    component: *mut c_void,
    references: *const c_uint,
    count: usize,
    values: *const c_int,
) -> c_uint {
    unsafe {
        guard(component, "fmi2SetBoolean", |it| {
            it.set_boolean(array("vr", references, count)?, array("value", values, count)?)
        })
    }
}

/// There are no string variables: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetString(
    component: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *const *const c_char,
) -> c_uint {
    unsafe {
        guard(component, "fmi2SetString", |it| it.none_of_type(Call::Set, "String", array("vr", references, count)?))
    }
}

/// Copies the state; into the memory of `*state` where that is not null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(component: *mut c_void, state: *mut *mut c_void) -> c_uint {
    unsafe { guard(component, "fmi2GetFMUstate", |it| hand_out(it.save()?, state)) }
}

/// Returns to a copied state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(component: *mut c_void, state: *mut c_void) -> c_uint {
    unsafe { guard(component, "fmi2SetFMUstate", |it| it.restore(handed_out(state)?)) }
}

/// Frees a copied state and sets it to null. Null is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(component: *mut c_void, state: *mut *mut c_void) -> c_uint {
    unsafe { guard(component, "fmi2FreeFMUstate", |_| take_back(state)) }
}

/// How many bytes fmi2SerializeFMUstate writes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
    component: *mut c_void,
    state: *mut c_void,
    size: *mut usize,
) -> c_uint {
    unsafe {
        guard(component, "fmi2SerializedFMUstateSize", |_| {
            *place("size", size)? = handed_out(state)?.to_bytes()?.len();
            Ok(())
        })
    }
}

/// Writes a copied state as bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    component: *mut c_void,
    state: *mut c_void,
    bytes: *mut c_char,
    size: usize,
) -> c_uint {
    unsafe { guard(component, "fmi2SerializeFMUstate", |_| write_state(state, bytes.cast(), size)) }
}

/// Reads a state from bytes; into the memory of `*state` where that is not null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    component: *mut c_void,
    bytes: *const c_char,
    size: usize,
    state: *mut *mut c_void,
) -> c_uint {
    unsafe {
        guard(component, "fmi2DeSerializeFMUstate", |_| {
            let read = SavedState::from_bytes(array("serializedState", bytes.cast(), size)?)?;
            hand_out(read, state)
        })
    }
}

/// Derivatives of outputs with respect to inputs, times a seed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDirectionalDerivative(
    component: *mut c_void,
    unknowns: *const c_uint,
    unknown_count: usize,
    knowns: *const c_uint,
    known_count: usize,
    seed: *const f64,
    values: *mut f64,
) -> c_uint {
    unsafe {
        guard(component, "fmi2GetDirectionalDerivative", |it| {
            let unknowns = array("vUnknown_ref", unknowns, unknown_count)?;
            let knowns = array("vKnown_ref", knowns, known_count)?;
            let seed = array("dvKnown", seed, known_count)?;
            it.directional_derivative(unknowns, knowns, seed, array_mut("dvUnknown", values, unknown_count)?)
        })
    }
}

/// Time derivatives of inputs during the next step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    component: *mut c_void,
    references: *const c_uint,
    count: usize,
    orders: *const c_int,
    values: *const f64,
) -> c_uint {
    unsafe {
        guard(component, "fmi2SetRealInputDerivatives", |it| {
            let (references, orders) = (array("vr", references, count)?, array("order", orders, count)?);
            it.set_input_derivatives(references, orders, array("value", values, count)?)
        })
    }
}

/// Time derivatives of outputs at the end of the last step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    component: *mut c_void,
    references: *const c_uint,
    count: usize,
    orders: *const c_int,
    values: *mut f64,
) -> c_uint {
    unsafe {
        guard(component, "fmi2GetRealOutputDerivatives", |it| {
            let (references, orders) = (array("vr", references, count)?, array("order", orders, count)?);
            it.output_derivatives(references, orders, array_mut("value", values, count)?)
        })
    }
}

/// One communication step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(
    component: *mut c_void,
    current_communication_point: f64,
    communication_step_size: f64,
    _no_set_fmu_state_prior_to_current_point: c_int,
) -> c_uint {
    unsafe { guard(component, "fmi2DoStep", |it| it.do_step(current_communication_point, communication_step_size)) }
}

/// Never legal: no step is asynchronous.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CancelStep(component: *mut c_void) -> c_uint {
    unsafe { guard(component, "fmi2CancelStep", |it| it.check(Call::CancelStep)) }
}

fn not_available(it: &Instance, kind: c_uint) -> Answer<()> {
    it.check(Call::GetStatus)?;
    let message = format!("status kind {kind} is not available here: steps of this FMU are never asynchronous");
    Err(Refusal { status: Status::Discard, message })
}

/// Never available: no step is asynchronous.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStatus(component: *mut c_void, kind: c_uint, _value: *mut c_uint) -> c_uint {
    unsafe { guard(component, "fmi2GetStatus", |it| not_available(it, kind)) }
}

/// The last communication point that was reached.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(component: *mut c_void, kind: c_uint, value: *mut f64) -> c_uint {
    unsafe {
        guard(component, "fmi2GetRealStatus", |it| {
            if kind != LAST_SUCCESSFUL_TIME {
                return not_available(it, kind);
            }
            *place("value", value)? = it.last_successful_time()?;
            Ok(())
        })
    }
}

/// Never available.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetIntegerStatus(component: *mut c_void, kind: c_uint, _value: *mut c_int) -> c_uint {
    unsafe { guard(component, "fmi2GetIntegerStatus", |it| not_available(it, kind)) }
}

/// Whether the FMU wants to end the run: it never does.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(component: *mut c_void, kind: c_uint, value: *mut c_int) -> c_uint {
    unsafe {
        guard(component, "fmi2GetBooleanStatus", |it| {
            if kind != TERMINATED {
                return not_available(it, kind);
            }
            it.check(Call::GetStatus)?;
            *place("value", value)? = 0;
            Ok(())
        })
    }
}

/// Never available: no step is asynchronous.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStringStatus(
    component: *mut c_void,
    kind: c_uint,
    _value: *mut *const c_char,
) -> c_uint {
    unsafe { guard(component, "fmi2GetStringStatus", |it| not_available(it, kind)) }
}
