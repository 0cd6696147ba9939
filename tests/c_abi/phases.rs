//! Every function in every phase, with null handles and null arrays, after a panic; and that there are no others.

use std::collections::BTreeSet;
use std::ffi::{CStr, c_uint, c_void};
use std::path::Path;
use std::process::Command;
use std::ptr::{null, null_mut};

use cartilage_contact::fmi::fmi2::*;
use cartilage_contact::fmi::{archive, boundary};

use crate::importer::*;

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
