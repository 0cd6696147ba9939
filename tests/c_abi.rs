//! The C interface, called as an importer calls it: every function in every phase, null pointers, panics, messages.
#![allow(unsafe_code)]

use std::collections::BTreeSet;
use std::ffi::{CStr, CString, c_char, c_int, c_uint, c_void};
use std::path::Path;
use std::process::Command;
use std::ptr::{null, null_mut};
use std::sync::Mutex;

use cartilage_contact::fmi::archive;
use cartilage_contact::fmi::boundary;
use cartilage_contact::fmi::description::token;
use cartilage_contact::fmi::fmi2::*;
use cartilage_contact::variables::VARIABLES;

const OK: c_uint = 0;
const DISCARD: c_uint = 2;
const ERROR: c_uint = 3;
const FATAL: c_uint = 4;

/// A depth [m] at which the bones of two layers of 1 mm have gone through each other.
const UNREACHABLE: f64 = 3e-3;

type Messages = Mutex<Vec<(c_uint, String, String)>>;

/// Keeps what it is told. Rust cannot define a variadic function; on this platform one with enough arguments is the same.
unsafe extern "C" fn keep(
    environment: *mut c_void,
    _instance: *const c_char,
    status: c_uint,
    category: *const c_char,
    format: *const c_char,
    text: *const c_char,
) {
    let read = |text| unsafe { CStr::from_ptr(text) }.to_str().unwrap().to_owned();
    assert_eq!(read(format), "%s", "a message must not be used as a format");
    let messages = unsafe { &*environment.cast::<Messages>() };
    messages.lock().unwrap().push((status, read(category), read(text)));
}

/// An instance with its messages.
struct Fmu {
    handle: *mut c_void,
    messages: Box<Messages>,
}

impl Fmu {
    fn instantiate(name: &str, kind: c_uint, guid: &str) -> Self {
        let messages: Box<Messages> = Box::default();
        let callbacks = fmi2CallbackFunctions {
            logger: Some(unsafe { std::mem::transmute::<*const (), boundary::Logger>(keep as *const ()) }),
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            component_environment: std::ptr::from_ref(messages.as_ref()).cast_mut().cast(),
        };
        let (name, guid) = (CString::new(name).unwrap(), CString::new(guid).unwrap());
        let handle = unsafe { fmi2Instantiate(name.as_ptr(), kind, guid.as_ptr(), null(), &callbacks, 0, 0) };
        Self { handle, messages }
    }

    fn in_phase(phase: Phase) -> Self {
        let fmu = Self::instantiate("contact", 1, token());
        let c = fmu.handle;
        unsafe {
            // Few elements: these tests are about calls, not about numbers.
            assert_eq!(fmu.set_integer("mesh.columns", 16), OK);
            assert_eq!(fmu.set_integer("mesh.rows", 2), OK);
            if phase != Phase::Instantiated {
                assert_eq!(fmi2SetupExperiment(c, 0, 0.0, 0.0, 1, 1.0), OK);
                assert_eq!(fmi2EnterInitializationMode(c), OK);
            }
            if ![Phase::Instantiated, Phase::Initialization].contains(&phase) {
                assert_eq!(fmi2ExitInitializationMode(c), OK);
            }
            if phase == Phase::StepFailed {
                assert_eq!(fmu.set_real("penetration_depth", UNREACHABLE), OK);
                assert_eq!(fmu.step(0.0, 0.1), DISCARD);
            }
            if phase == Phase::Terminated {
                assert_eq!(fmi2Terminate(c), OK);
            }
        }
        fmu.take_messages();
        fmu
    }

    fn take_messages(&self) -> Vec<(c_uint, String, String)> {
        std::mem::take(&mut self.messages.lock().unwrap())
    }

    /// The one message of a refused call.
    fn message(&self) -> String {
        let messages = self.take_messages();
        assert_eq!(messages.len(), 1, "{messages:?}");
        messages[0].2.clone()
    }

    fn set_real(&self, name: &str, value: f64) -> c_uint {
        unsafe { fmi2SetReal(self.handle, &reference(name), 1, &value) }
    }

    fn set_integer(&self, name: &str, value: c_int) -> c_uint {
        unsafe { fmi2SetInteger(self.handle, &reference(name), 1, &value) }
    }

    fn get_real(&self, name: &str) -> f64 {
        let mut value = f64::NAN;
        assert_eq!(unsafe { fmi2GetReal(self.handle, &reference(name), 1, &mut value) }, OK);
        value
    }

    fn step(&self, from: f64, size: f64) -> c_uint {
        unsafe { fmi2DoStep(self.handle, from, size, 1) }
    }
}

impl Drop for Fmu {
    fn drop(&mut self) {
        unsafe { fmi2FreeInstance(self.handle) }
    }
}

fn reference(name: &str) -> c_uint {
    VARIABLES.iter().position(|variable| variable.name == name).unwrap() as c_uint
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    Instantiated,
    Initialization,
    StepComplete,
    StepFailed,
    Terminated,
}

type Function = (&'static str, &'static str, fn(*mut c_void) -> c_uint);

/// Every function that depends on the phase: in which of the phases (`i`nstantiated, initialization `m`ode, step
/// `c`omplete, step `f`ailed, `t`erminated) the standard allows it, and a call that is right but for the phase.
#[rustfmt::skip]
const FUNCTIONS: [Function; 31] = [
    ("fmi2SetDebugLogging", "imcft", |c| unsafe { fmi2SetDebugLogging(c, 0, 0, null()) }),
    ("fmi2SetupExperiment", "i", |c| unsafe { fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0) }),
    ("fmi2EnterInitializationMode", "i", |c| unsafe { fmi2EnterInitializationMode(c) }),
    ("fmi2ExitInitializationMode", "m", |c| unsafe { fmi2ExitInitializationMode(c) }),
    ("fmi2Terminate", "cf", |c| unsafe { fmi2Terminate(c) }),
    ("fmi2Reset", "imcft", |c| unsafe { fmi2Reset(c) }),
    ("fmi2GetReal", "mcft", |c| unsafe { fmi2GetReal(c, &reference("load"), 1, &mut 0.0) }),
    ("fmi2GetInteger", "mcft", |c| unsafe { fmi2GetInteger(c, &reference("lubrication_regime"), 1, &mut 0) }),
    ("fmi2GetBoolean", "mcft", |c| unsafe { fmi2GetBoolean(c, &reference("boundary_friction_loads_tissue"), 1, &mut 0) }),
    ("fmi2GetString", "mcft", |c| unsafe { fmi2GetString(c, null(), 0, null_mut()) }),
    ("fmi2SetReal", "imc", |c| unsafe { fmi2SetReal(c, &reference("sliding_speed"), 1, &0.1) }),
    ("fmi2SetInteger", "imc", |c| unsafe { fmi2SetInteger(c, null(), 0, null()) }),
    ("fmi2SetBoolean", "imc", |c| unsafe { fmi2SetBoolean(c, null(), 0, null()) }),
    ("fmi2SetString", "imc", |c| unsafe { fmi2SetString(c, null(), 0, null()) }),
    ("fmi2GetFMUstate", "imcft", |c| with_state(c, |_, _| OK)),
    ("fmi2SetFMUstate", "imcft", |c| with_state(c, |c, state| unsafe { fmi2SetFMUstate(c, state) })),
    ("fmi2FreeFMUstate", "imcft", |c| unsafe { fmi2FreeFMUstate(c, &mut null_mut()) }),
    ("fmi2SerializedFMUstateSize", "imcft", |c| with_state(c, |c, state| unsafe { fmi2SerializedFMUstateSize(c, state, &mut 0) })),
    ("fmi2SerializeFMUstate", "imcft", |c| with_state(c, |c, state| if bytes(c, state).is_empty() { ERROR } else { OK })),
    ("fmi2DeSerializeFMUstate", "imcft", |c| with_state(c, |c, state| from_bytes(c, &bytes(c, state)))),
    ("fmi2GetDirectionalDerivative", "mcft", |c| unsafe { fmi2GetDirectionalDerivative(c, &reference("load"), 1, &reference("sliding_speed"), 1, &1.0, &mut 0.0) }),
    ("fmi2SetRealInputDerivatives", "imc", |c| unsafe { fmi2SetRealInputDerivatives(c, &reference("sliding_speed"), 1, &1, &0.1) }),
    ("fmi2GetRealOutputDerivatives", "cft", |c| unsafe { fmi2GetRealOutputDerivatives(c, &reference("load"), 1, &1, &mut 0.0) }),
    ("fmi2DoStep", "c", |c| unsafe { fmi2DoStep(c, 0.0, 0.1, 1) }),
    ("fmi2CancelStep", "", |c| unsafe { fmi2CancelStep(c) }),
    ("fmi2GetRealStatus", "cft", |c| unsafe { fmi2GetRealStatus(c, 2, &mut 0.0) }),
    ("fmi2GetBooleanStatus", "cft", |c| unsafe { fmi2GetBooleanStatus(c, 3, &mut 0) }),
    // Steps are never pending: where these are allowed, the answer is fmi2Discard.
    ("fmi2GetStatus", "cft", |c| only_discard(unsafe { fmi2GetStatus(c, 0, &mut 0) })),
    ("fmi2GetIntegerStatus", "cft", |c| only_discard(unsafe { fmi2GetIntegerStatus(c, 0, &mut 0) })),
    ("fmi2GetStringStatus", "cft", |c| only_discard(unsafe { fmi2GetStringStatus(c, 1, &mut null()) })),
    ("fmi2GetRealStatus(fmi2DoStepStatus)", "cft", |c| only_discard(unsafe { fmi2GetRealStatus(c, 0, &mut 0.0) })),
];

fn only_discard(status: c_uint) -> c_uint {
    assert_ne!(status, OK);
    if status == DISCARD { OK } else { status }
}

fn with_state(c: *mut c_void, use_it: fn(*mut c_void, *mut c_void) -> c_uint) -> c_uint {
    let mut state = null_mut();
    unsafe {
        let got = fmi2GetFMUstate(c, &mut state);
        if got != OK {
            return got;
        }
        let status = use_it(c, state);
        assert_eq!(fmi2FreeFMUstate(c, &mut state), OK);
        assert!(state.is_null());
        status
    }
}

fn bytes(c: *mut c_void, state: *mut c_void) -> Vec<u8> {
    let mut size = 0;
    unsafe {
        assert_eq!(fmi2SerializedFMUstateSize(c, state, &mut size), OK);
        let mut bytes = vec![0_u8; size];
        assert_eq!(fmi2SerializeFMUstate(c, state, bytes.as_mut_ptr().cast(), size), OK);
        bytes
    }
}

fn from_bytes(c: *mut c_void, bytes: &[u8]) -> c_uint {
    let mut state = null_mut();
    unsafe {
        let status = fmi2DeSerializeFMUstate(c, bytes.as_ptr().cast(), bytes.len(), &mut state);
        assert_eq!(fmi2FreeFMUstate(c, &mut state), OK);
        status
    }
}

#[test]
fn every_function_is_allowed_in_the_phases_of_the_standard_and_in_no_other() {
    let phases = [
        (Phase::Instantiated, 'i'),
        (Phase::Initialization, 'm'),
        (Phase::StepComplete, 'c'),
        (Phase::Terminated, 't'),
    ];
    for (phase, letter) in phases {
        for (name, allowed, call) in FUNCTIONS {
            let fmu = Fmu::in_phase(phase);
            let expected = if allowed.contains(letter) { OK } else { ERROR };
            assert_eq!(call(fmu.handle), expected, "{name} in {phase:?}: {:?}", fmu.take_messages());
            if expected == ERROR {
                let message = fmu.message();
                assert!(message.starts_with(name.split('(').next().unwrap()), "{message}");
            }
        }
    }
}

#[test]
fn a_null_handle_is_an_error_for_every_function() {
    for (name, _, call) in FUNCTIONS {
        assert_eq!(call(null_mut()), ERROR, "{name}");
    }
    unsafe { fmi2FreeInstance(null_mut()) };
    unsafe {
        assert_eq!(CStr::from_ptr(fmi2GetVersion()), c"2.0");
        assert_eq!(CStr::from_ptr(fmi2GetTypesPlatform()), c"default");
    }
}

#[test]
fn null_arrays_are_fine_when_empty_and_refused_when_not() {
    let fmu = Fmu::in_phase(Phase::StepComplete);
    let c = fmu.handle;
    for length in [0, 2] {
        let expected = if length == 0 { OK } else { ERROR };
        let statuses = unsafe {
            [
                fmi2GetReal(c, null(), length, null_mut()),
                fmi2SetReal(c, null(), length, null()),
                fmi2GetInteger(c, null(), length, null_mut()),
                fmi2SetInteger(c, null(), length, null()),
                fmi2GetBoolean(c, null(), length, null_mut()),
                fmi2SetBoolean(c, null(), length, null()),
                fmi2GetString(c, null(), length, null_mut()),
                fmi2SetString(c, null(), length, null()),
                fmi2SetDebugLogging(c, 1, length, null()),
                fmi2SetRealInputDerivatives(c, null(), length, null(), null()),
                fmi2GetRealOutputDerivatives(c, null(), length, null(), null_mut()),
                fmi2GetDirectionalDerivative(c, null(), length, null(), length, null(), null_mut()),
            ]
        };
        assert_eq!(statuses, [expected; 12], "{:?}", fmu.take_messages());
    }
    unsafe {
        assert_eq!(fmi2GetFMUstate(c, null_mut()), ERROR);
        assert_eq!(fmi2SetFMUstate(c, null_mut()), ERROR);
        assert_eq!(fmi2SerializeFMUstate(c, null_mut(), null_mut(), 0), ERROR);
        assert_eq!(fmi2DeSerializeFMUstate(c, null(), 0, null_mut()), ERROR);
        assert_eq!(fmi2GetRealStatus(c, 2, null_mut()), ERROR);
        assert_eq!(fmi2GetBooleanStatus(c, 3, null_mut()), ERROR);
        assert_eq!(fmi2FreeFMUstate(c, null_mut()), OK);
    }
}

#[test]
fn a_panic_does_not_cross_the_boundary_and_leaves_an_instance_that_can_only_be_freed() {
    let fmu = Fmu::in_phase(Phase::StepComplete);
    let status = unsafe { boundary::guard(fmu.handle, "fmi2DoStep", |_| panic!("index #3")) };
    assert_eq!(status, FATAL);
    let (status, category, message) = fmu.take_messages().remove(0);
    assert_eq!((status, category.as_str()), (FATAL, "logStatusFatal"));
    assert!(message.contains("index ##3"), "# must be doubled for the importer: {message}");
    for (name, _, call) in FUNCTIONS.iter().filter(|(name, ..)| !name.contains("State") && !name.contains("FMUstate")) {
        if !["fmi2GetStatus", "fmi2GetIntegerStatus", "fmi2GetStringStatus"].contains(name) {
            assert_eq!(call(fmu.handle), FATAL, "{name}");
        }
    }
}

#[test]
fn instantiation_says_why_it_fails() {
    for (name, kind, guid, reason) in [
        ("", 1, token(), "instanceName"),
        ("contact", 0, token(), "fmuType = 0"),
        ("contact", 1, "{8c4e810f-3df3-4a00-8276-176fa3c9f9e0}", "fmuGUID = \"{8c4e810f"),
    ] {
        let fmu = Fmu::instantiate(name, kind, guid);
        assert!(fmu.handle.is_null());
        let message = fmu.message();
        assert!(message.contains(reason), "{message}");
    }
    assert!(unsafe { fmi2Instantiate(c"contact".as_ptr(), 1, null(), null(), null(), 0, 0) }.is_null());
}

#[test]
fn a_refused_value_is_explained_in_one_line_and_changes_nothing() {
    let fmu = Fmu::in_phase(Phase::Initialization);
    let refused: [(c_uint, &[&str]); 10] = [
        (fmu.set_real("penetration_depth", 0.5), &["penetration_depth", "0.5", "-1e-2 to 1e-2 m"]),
        (fmu.set_real("sliding_speed", f64::NAN), &["sliding_speed", "NaN", "-1e1 to 1e1 m/s"]),
        (fmu.set_real("upper.thickness", f64::INFINITY), &["upper.thickness", "inf", "1e-5 to 1e-1 m"]),
        (fmu.set_real("load", 1.0), &["load", "result"]),
        (fmu.set_real("formulation", 1.0), &["formulation", "Enumeration", "Integer"]),
        (fmu.set_integer("formulation", 3), &["formulation", "3", "1 (paper), 2 (consistent)"]),
        (fmu.set_integer("formulation", 0), &["formulation", "0", "1 (paper)"]),
        (fmu.set_integer("mesh.columns", 7), &["mesh.columns", "7", "8 to 2000"]),
        (fmu.set_integer("sliding_speed", 1), &["sliding_speed", "Real"]),
        (unsafe { fmi2SetReal(fmu.handle, &99_999, 1, &1.0) }, &["99999", "unknown"]),
    ];
    let messages = fmu.take_messages();
    assert_eq!(messages.len(), refused.len());
    for ((status, parts), (_, category, message)) in refused.iter().zip(&messages) {
        assert_eq!((*status, category.as_str()), (ERROR, "logStatusError"));
        assert!(parts.iter().all(|part| message.contains(part)) && !message.contains('\n'), "{message}");
    }
    // The first value of an array is not kept if the second is refused.
    let (references, values) = ([reference("sliding_speed"), reference("penetration_depth")], [0.5, 1.0]);
    assert_eq!(unsafe { fmi2SetReal(fmu.handle, references.as_ptr(), 2, values.as_ptr()) }, ERROR);
    assert_eq!(fmu.get_real("sliding_speed"), 0.2);
    assert_eq!(fmu.get_real("penetration_depth"), -10e-6);
    assert_eq!(unsafe { fmi2ExitInitializationMode(fmu.handle) }, OK);
    fmu.take_messages();
    assert_eq!(fmu.set_real("upper.thickness", 1.1e-3), ERROR);
    assert!(fmu.message().contains("upper.thickness = 0.0011 comes too late"));
}

#[test]
fn parameters_that_do_not_fit_each_other_are_refused_before_initialization() {
    let fmu = Fmu::in_phase(Phase::Instantiated);
    assert_eq!(fmu.set_real("upper.outer_radius", 1e-3), OK);
    assert_eq!(unsafe { fmi2EnterInitializationMode(fmu.handle) }, ERROR);
    assert!(fmu.message().contains("upper.thickness"));
    assert_eq!(fmu.set_real("upper.outer_radius", 0.1), OK);
    assert_eq!(unsafe { fmi2EnterInitializationMode(fmu.handle) }, OK);
}

#[test]
fn a_step_that_is_none_is_refused_and_the_next_good_one_goes_on() {
    let fmu = Fmu::in_phase(Phase::StepComplete);
    for (from, size, part) in [
        (0.0, -0.1, "communicationStepSize = -0.1"),
        (0.0, 0.0, "communicationStepSize = 0"),
        (0.0, f64::NAN, "communicationStepSize = NaN"),
        (0.1, 0.1, "the instance is at 0"),
        (-0.1, 0.1, "the instance is at 0"),
        (0.0, 1.0 + 1e-6, "stopTime is 1"),
    ] {
        assert_eq!(fmu.step(from, size), ERROR, "{from} {size}");
        let message = fmu.message();
        assert!(message.contains(part), "{message}");
    }
    let (mut time, size) = (0.0, 0.1);
    for _ in 0..10 {
        assert_eq!(fmu.step(time, size), OK);
        time += size;
    }
    let mut last = 0.0;
    assert_eq!(unsafe { fmi2GetRealStatus(fmu.handle, 2, &mut last) }, OK);
    assert_eq!(last, time);
    assert_eq!(fmu.step(time, size), ERROR);
}

#[test]
fn a_step_without_a_solution_is_discarded_and_its_start_can_be_restored() {
    let fmu = Fmu::in_phase(Phase::StepComplete);
    let c = fmu.handle;
    assert_eq!(fmu.step(0.0, 0.25), OK);
    let load = fmu.get_real("load");
    let (mut state, mut time, mut ended) = (null_mut(), f64::NAN, 1);
    unsafe {
        assert_eq!(fmi2GetFMUstate(c, &mut state), OK);
        assert_eq!(fmu.set_real("penetration_depth", UNREACHABLE), OK);
        assert_eq!(fmu.step(0.25, 0.25), DISCARD);
        assert_eq!(fmu.take_messages()[0].1, "logStatusDiscard");
        assert_eq!(fmi2GetRealStatus(c, 2, &mut time), OK);
        assert_eq!(fmi2GetBooleanStatus(c, 3, &mut ended), OK);
        assert_eq!((time, ended), (0.25, 0));
        assert_eq!(fmu.get_real("load").to_bits(), load.to_bits());
        assert_eq!(fmi2SetFMUstate(c, state), OK);
        assert_eq!(fmi2FreeFMUstate(c, &mut state), OK);
    }
    assert_eq!(fmu.step(0.25, 0.25), OK);
}

#[test]
fn bytes_of_a_state_are_refused_when_cut_altered_or_foreign() {
    let fmu = Fmu::in_phase(Phase::StepComplete);
    let c = fmu.handle;
    let mut state = null_mut();
    assert_eq!(unsafe { fmi2GetFMUstate(c, &mut state) }, OK);
    let good = bytes(c, state);
    assert_eq!(unsafe { fmi2FreeFMUstate(c, &mut state) }, OK);
    assert_eq!(from_bytes(c, &good), OK);
    for cut in 0..good.len() {
        assert_eq!(from_bytes(c, &good[..cut]), ERROR, "{cut} bytes of {}", good.len());
    }
    for changed in 0..good.len() {
        let mut bytes = good.clone();
        bytes[changed] ^= 1;
        assert_eq!(from_bytes(c, &bytes), ERROR, "byte {changed} of {}", good.len());
    }
    assert_eq!(from_bytes(c, &[&good[..], b"more"].concat()), ERROR);
    assert!(fmu.take_messages().iter().all(|(_, _, message)| message.contains("state refused")));
}

#[test]
fn a_state_brings_back_phase_parameters_inputs_and_time() {
    let first = Fmu::in_phase(Phase::Instantiated);
    let c = first.handle;
    assert_eq!(first.set_real("lower.thickness", 1.3e-3), OK);
    unsafe {
        assert_eq!(fmi2EnterInitializationMode(c), OK);
        assert_eq!(fmi2ExitInitializationMode(c), OK);
    }
    assert_eq!(first.set_real("penetration_depth", -8e-6), OK);
    assert_eq!(first.step(0.0, 0.25), OK);
    let mut state = null_mut();
    assert_eq!(unsafe { fmi2GetFMUstate(c, &mut state) }, OK);
    let (load, saved) = (first.get_real("load"), bytes(c, state));
    assert_eq!(first.set_real("penetration_depth", -6e-6), OK);
    assert_eq!(first.step(0.25, 0.25), OK);
    let later = first.get_real("load");
    assert_ne!(load, later);

    let second = Fmu::in_phase(Phase::Instantiated);
    let mut copy = null_mut();
    unsafe {
        assert_eq!(fmi2DeSerializeFMUstate(second.handle, saved.as_ptr().cast(), saved.len(), &mut copy), OK);
        assert_eq!(fmi2SetFMUstate(second.handle, copy), OK);
        assert_eq!(fmi2SetFMUstate(c, state), OK);
        assert_eq!(fmi2FreeFMUstate(second.handle, &mut copy), OK);
    }
    for fmu in [&first, &second] {
        assert_eq!(fmu.get_real("lower.thickness"), 1.3e-3);
        assert_eq!(fmu.get_real("penetration_depth"), -8e-6);
        assert_eq!(fmu.get_real("load").to_bits(), load.to_bits());
        assert_eq!(fmu.set_real("penetration_depth", -6e-6), OK);
        assert_eq!(fmu.step(0.25, 0.25), OK);
        assert_eq!(fmu.get_real("load").to_bits(), later.to_bits());
    }
    // The memory of a state is used again.
    let before = state;
    unsafe {
        assert_eq!(fmi2GetFMUstate(c, &mut state), OK);
        assert_eq!(state, before);
        assert_eq!(fmi2FreeFMUstate(c, &mut state), OK);
    }
}

#[test]
fn input_derivatives_move_the_input_during_one_step() {
    let fmu = Fmu::in_phase(Phase::StepComplete);
    let (c, depth) = (fmu.handle, reference("penetration_depth"));
    unsafe {
        assert_eq!(fmi2SetRealInputDerivatives(c, &depth, 1, &2, &1e-6), ERROR);
        assert!(fmu.message().contains("order 2"));
        assert_eq!(fmi2SetRealInputDerivatives(c, &depth, 1, &1, &4e-6), OK);
    }
    assert_eq!(fmu.step(0.0, 0.5), OK);
    assert!((fmu.get_real("penetration_depth") + 8e-6).abs() < 1e-18);
    let rate = |order: c_int| {
        let mut value = f64::NAN;
        let status = unsafe { fmi2GetRealOutputDerivatives(c, &reference("load"), 1, &order, &mut value) };
        (status, value)
    };
    let mut slope = 0.0;
    unsafe {
        assert_eq!(fmi2GetDirectionalDerivative(c, &reference("load"), 1, &depth, 1, &4e-6, &mut slope), OK);
    }
    assert_eq!(rate(1), (OK, slope));
    assert_eq!(rate(2), (OK, 0.0));
    assert_eq!(rate(0).0, ERROR);
    assert_eq!(fmu.step(0.5, 0.5), OK);
    assert!((fmu.get_real("penetration_depth") + 8e-6).abs() < 1e-18, "a derivative is for one step");
    assert_eq!(rate(1), (OK, 0.0));
}

#[test]
fn derivatives_are_refused_for_what_has_none() {
    let fmu = Fmu::in_phase(Phase::StepComplete);
    for (unknown, known) in [
        ("newton_iterations", "sliding_speed"),
        ("load", "upper.thickness"),
        ("load", "load"),
        ("sliding_speed", "sliding_speed"),
    ] {
        let (unknown, known) = (reference(unknown), reference(known));
        assert_eq!(unsafe { fmi2GetDirectionalDerivative(fmu.handle, &unknown, 1, &known, 1, &1.0, &mut 0.0) }, ERROR);
        fmu.message();
    }
}

#[test]
fn exactly_the_functions_of_the_standard_are_exported() {
    let library = archive::library_beside(Path::new(env!("CARGO_BIN_EXE_cartilage-contact")));
    let listed = Command::new("nm").args(["-D", "--defined-only", "--format=posix"]).arg(&library).output().unwrap();
    let listed = String::from_utf8(listed.stdout).unwrap();
    let exported: BTreeSet<&str> = listed.lines().filter_map(|line| line.split(' ').next()).collect();
    let tested = FUNCTIONS.iter().map(|(name, ..)| *name).filter(|name| !name.contains('('));
    let others = ["fmi2GetTypesPlatform", "fmi2GetVersion", "fmi2Instantiate", "fmi2FreeInstance"];
    assert_eq!(exported, tested.chain(others).collect());
    assert_eq!(exported.len(), 34);
}

#[test]
fn reset_brings_back_the_start_values() {
    let fmu = Fmu::in_phase(Phase::StepComplete);
    assert_eq!(fmu.step(0.0, -1.0), ERROR);
    assert_eq!(unsafe { fmi2Reset(fmu.handle) }, OK);
    assert_eq!(unsafe { fmi2EnterInitializationMode(fmu.handle) }, OK);
    let mut columns = 0;
    assert_eq!(unsafe { fmi2GetInteger(fmu.handle, &reference("mesh.columns"), 1, &mut columns) }, OK);
    assert_eq!(columns, 120);
}

#[test]
fn only_the_categories_that_are_switched_on_are_told() {
    let fmu = Fmu::in_phase(Phase::StepComplete);
    let switch = |on, name: &CStr| unsafe { fmi2SetDebugLogging(fmu.handle, on, 1, &name.as_ptr()) };
    assert_eq!(switch(1, c"logSolver"), OK);
    assert_eq!(fmu.step(0.0, 0.1), OK);
    assert_eq!(fmu.take_messages()[0].1, "logSolver");
    assert_eq!(switch(0, c"logSolver"), OK);
    assert_eq!(switch(1, c"logNothing"), ERROR);
    assert!(fmu.message().contains("logNothing"));
    assert_eq!(unsafe { fmi2SetDebugLogging(fmu.handle, 0, 0, null()) }, OK);
    assert_eq!(fmu.step(0.0, -1.0), ERROR);
    assert!(fmu.take_messages().is_empty());
}
