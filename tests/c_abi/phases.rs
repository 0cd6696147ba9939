//! Every function in every phase, with null handles and null arrays, after a panic; and that there are no others.

use std::collections::BTreeSet;
use std::ffi::{CStr, c_uint, c_void};
use std::path::Path;
use std::process::Command;
use std::ptr::{null, null_mut};

use cartilage_contact::fmi::fmi2::model_exchange::*;
use cartilage_contact::fmi::fmi2::*;
use cartilage_contact::fmi::fmi3::absent::*;
use cartilage_contact::fmi::fmi3::other_types::*;
use cartilage_contact::fmi::fmi3::*;
use cartilage_contact::fmi::standard::Standard;
use cartilage_contact::fmi::{archive, boundary};

use crate::importer::*;

type Function = (&'static str, &'static str, fn(*mut c_void) -> c_uint);

/// Every function that depends on the phase: in which of the phases (`i`nstantiated, initialization `m`ode, step
/// `c`omplete, step `f`ailed, `t`erminated) the standard allows it, and a call that is right but for the phase.
#[rustfmt::skip]
const FUNCTIONS: [Function; 41] = [
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
    ("fmi2GetFMUstate", "imcft", |c| with_state(Standard::Fmi2, c, |_, _| OK)),
    ("fmi2SetFMUstate", "imcft", |c| with_state(Standard::Fmi2, c, |c, state| unsafe { fmi2SetFMUstate(c, state) })),
    ("fmi2FreeFMUstate", "imcft", |c| unsafe { fmi2FreeFMUstate(c, &mut null_mut()) }),
    ("fmi2SerializedFMUstateSize", "imcft", |c| with_state(Standard::Fmi2, c, |c, state| unsafe { fmi2SerializedFMUstateSize(c, state, &mut 0) })),
    ("fmi2SerializeFMUstate", "imcft", |c| with_state(Standard::Fmi2, c, |c, state| if bytes(Standard::Fmi2, c, state).is_empty() { ERROR } else { OK })),
    ("fmi2DeSerializeFMUstate", "imcft", |c| with_state(Standard::Fmi2, c, |c, state| from_bytes(Standard::Fmi2, c, state))),
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
    // Of model exchange, for importers that look up every function.
    ("fmi2EnterEventMode", "", |c| unsafe { fmi2EnterEventMode(c) }),
    ("fmi2NewDiscreteStates", "", |c| unsafe { fmi2NewDiscreteStates(c, null_mut()) }),
    ("fmi2EnterContinuousTimeMode", "", |c| unsafe { fmi2EnterContinuousTimeMode(c) }),
    ("fmi2CompletedIntegratorStep", "", |c| unsafe { fmi2CompletedIntegratorStep(c, 0, null_mut(), null_mut()) }),
    ("fmi2SetTime", "", |c| unsafe { fmi2SetTime(c, 0.0) }),
    ("fmi2SetContinuousStates", "", |c| unsafe { fmi2SetContinuousStates(c, null(), 0) }),
    ("fmi2GetDerivatives", "", |c| unsafe { fmi2GetDerivatives(c, null_mut(), 0) }),
    ("fmi2GetEventIndicators", "", |c| unsafe { fmi2GetEventIndicators(c, null_mut(), 0) }),
    ("fmi2GetContinuousStates", "", |c| unsafe { fmi2GetContinuousStates(c, null_mut(), 0) }),
    ("fmi2GetNominalsOfContinuousStates", "", |c| unsafe { fmi2GetNominalsOfContinuousStates(c, null_mut(), 0) }),
    ("fmi2GetRealStatus(fmi2DoStepStatus)", "cft", |c| only_discard(unsafe { fmi2GetRealStatus(c, 0, &mut 0.0) })),
];

/// Likewise of FMI 3.0, where a step that failed is no phase of its own. The functions for what this FMU has not are
/// allowed nowhere.
#[rustfmt::skip]
const FUNCTIONS3: [Function; 70] = [
    ("fmi3SetDebugLogging", "imct", |c| unsafe { fmi3SetDebugLogging(c, 0, 0, null()) }),
    ("fmi3EnterInitializationMode", "i", |c| unsafe { fmi3EnterInitializationMode(c, 0, 0.0, 0.0, 0, 0.0) }),
    ("fmi3ExitInitializationMode", "m", |c| unsafe { fmi3ExitInitializationMode(c) }),
    ("fmi3Terminate", "c", |c| unsafe { fmi3Terminate(c) }),
    ("fmi3Reset", "imct", |c| unsafe { fmi3Reset(c) }),
    ("fmi3GetFloat64", "imct", |c| unsafe { fmi3GetFloat64(c, &reference("sliding_speed"), 1, &mut 0.0, 1) }),
    ("fmi3GetInt32", "imct", |c| unsafe { fmi3GetInt32(c, &reference("mesh.rows"), 1, &mut 0, 1) }),
    ("fmi3GetInt64", "imct", |c| unsafe { fmi3GetInt64(c, &reference("formulation"), 1, &mut 0, 1) }),
    ("fmi3GetBoolean", "imct", |c| unsafe { fmi3GetBoolean(c, &reference("boundary_friction_loads_tissue"), 1, &mut 0, 1) }),
    ("fmi3SetFloat64", "imc", |c| unsafe { fmi3SetFloat64(c, &reference("sliding_speed"), 1, &0.1, 1) }),
    ("fmi3SetInt32", "imc", |c| unsafe { fmi3SetInt32(c, null(), 0, null(), 0) }),
    ("fmi3SetInt64", "imc", |c| unsafe { fmi3SetInt64(c, null(), 0, null(), 0) }),
    ("fmi3SetBoolean", "imc", |c| unsafe { fmi3SetBoolean(c, null(), 0, null(), 0) }),
    ("fmi3GetFMUState", "imct", |c| with_state(Standard::Fmi3, c, |_, _| OK)),
    ("fmi3SetFMUState", "imct", |c| with_state(Standard::Fmi3, c, |c, state| unsafe { fmi3SetFMUState(c, state) })),
    ("fmi3FreeFMUState", "imct", |c| unsafe { fmi3FreeFMUState(c, &mut null_mut()) }),
    ("fmi3SerializedFMUStateSize", "imct", |c| with_state(Standard::Fmi3, c, |c, state| unsafe { fmi3SerializedFMUStateSize(c, state, &mut 0) })),
    ("fmi3SerializeFMUState", "imct", |c| with_state(Standard::Fmi3, c, |c, state| if bytes(Standard::Fmi3, c, state).is_empty() { ERROR } else { OK })),
    ("fmi3DeserializeFMUState", "imct", |c| with_state(Standard::Fmi3, c, |c, state| from_bytes(Standard::Fmi3, c, state))),
    ("fmi3GetDirectionalDerivative", "mct", |c| unsafe { fmi3GetDirectionalDerivative(c, &reference("load"), 1, &reference("sliding_speed"), 1, &1.0, 1, &mut 0.0, 1) }),
    ("fmi3GetAdjointDerivative", "mct", |c| unsafe { fmi3GetAdjointDerivative(c, &reference("load"), 1, &reference("sliding_speed"), 1, &1.0, 1, &mut 0.0, 1) }),
    ("fmi3GetOutputDerivatives", "ct", |c| unsafe { fmi3GetOutputDerivatives(c, &reference("load"), 1, &1, &mut 0.0, 1) }),
    ("fmi3DoStep", "c", |c| unsafe { fmi3DoStep(c, 0.0, 0.1, 1, &mut 0, &mut 0, &mut 0, &mut 0.0) }),
    ("fmi3GetFloat32", "imct", |c| unsafe { fmi3GetFloat32(c, null(), 0, null_mut(), 0) }),
    ("fmi3GetInt8", "imct", |c| unsafe { fmi3GetInt8(c, null(), 0, null_mut(), 0) }),
    ("fmi3GetUInt8", "imct", |c| unsafe { fmi3GetUInt8(c, null(), 0, null_mut(), 0) }),
    ("fmi3GetInt16", "imct", |c| unsafe { fmi3GetInt16(c, null(), 0, null_mut(), 0) }),
    ("fmi3GetUInt16", "imct", |c| unsafe { fmi3GetUInt16(c, null(), 0, null_mut(), 0) }),
    ("fmi3GetUInt32", "imct", |c| unsafe { fmi3GetUInt32(c, null(), 0, null_mut(), 0) }),
    ("fmi3GetUInt64", "imct", |c| unsafe { fmi3GetUInt64(c, null(), 0, null_mut(), 0) }),
    ("fmi3GetString", "imct", |c| unsafe { fmi3GetString(c, null(), 0, null_mut(), 0) }),
    ("fmi3GetBinary", "imct", |c| unsafe { fmi3GetBinary(c, null(), 0, null_mut(), null_mut(), 0) }),
    ("fmi3GetClock", "imct", |c| unsafe { fmi3GetClock(c, null(), 0, null_mut()) }),
    ("fmi3SetFloat32", "imc", |c| unsafe { fmi3SetFloat32(c, null(), 0, null(), 0) }),
    ("fmi3SetInt8", "imc", |c| unsafe { fmi3SetInt8(c, null(), 0, null(), 0) }),
    ("fmi3SetUInt8", "imc", |c| unsafe { fmi3SetUInt8(c, null(), 0, null(), 0) }),
    ("fmi3SetInt16", "imc", |c| unsafe { fmi3SetInt16(c, null(), 0, null(), 0) }),
    ("fmi3SetUInt16", "imc", |c| unsafe { fmi3SetUInt16(c, null(), 0, null(), 0) }),
    ("fmi3SetUInt32", "imc", |c| unsafe { fmi3SetUInt32(c, null(), 0, null(), 0) }),
    ("fmi3SetUInt64", "imc", |c| unsafe { fmi3SetUInt64(c, null(), 0, null(), 0) }),
    ("fmi3SetString", "imc", |c| unsafe { fmi3SetString(c, null(), 0, null(), 0) }),
    ("fmi3SetBinary", "imc", |c| unsafe { fmi3SetBinary(c, null(), 0, null(), null(), 0) }),
    ("fmi3SetClock", "imc", |c| unsafe { fmi3SetClock(c, null(), 0, null()) }),
    ("fmi3GetNumberOfVariableDependencies", "", |c| unsafe { fmi3GetNumberOfVariableDependencies(c, 0, null_mut()) }),
    ("fmi3GetVariableDependencies", "", |c| unsafe { fmi3GetVariableDependencies(c, 0, null_mut(), null_mut(), null_mut(), null_mut(), 0) }),
    ("fmi3EnterConfigurationMode", "", |c| unsafe { fmi3EnterConfigurationMode(c) }),
    ("fmi3ExitConfigurationMode", "", |c| unsafe { fmi3ExitConfigurationMode(c) }),
    ("fmi3GetIntervalDecimal", "", |c| unsafe { fmi3GetIntervalDecimal(c, null(), 0, null_mut(), null_mut()) }),
    ("fmi3GetIntervalFraction", "", |c| unsafe { fmi3GetIntervalFraction(c, null(), 0, null_mut(), null_mut(), null_mut()) }),
    ("fmi3GetShiftDecimal", "", |c| unsafe { fmi3GetShiftDecimal(c, null(), 0, null_mut()) }),
    ("fmi3GetShiftFraction", "", |c| unsafe { fmi3GetShiftFraction(c, null(), 0, null_mut(), null_mut()) }),
    ("fmi3SetIntervalDecimal", "", |c| unsafe { fmi3SetIntervalDecimal(c, null(), 0, null()) }),
    ("fmi3SetIntervalFraction", "", |c| unsafe { fmi3SetIntervalFraction(c, null(), 0, null(), null()) }),
    ("fmi3SetShiftDecimal", "", |c| unsafe { fmi3SetShiftDecimal(c, null(), 0, null()) }),
    ("fmi3SetShiftFraction", "", |c| unsafe { fmi3SetShiftFraction(c, null(), 0, null(), null()) }),
    ("fmi3EvaluateDiscreteStates", "", |c| unsafe { fmi3EvaluateDiscreteStates(c) }),
    ("fmi3UpdateDiscreteStates", "", |c| unsafe { fmi3UpdateDiscreteStates(c, null_mut(), null_mut(), null_mut(), null_mut(), null_mut(), null_mut()) }),
    ("fmi3EnterEventMode", "", |c| unsafe { fmi3EnterEventMode(c) }),
    ("fmi3EnterStepMode", "", |c| unsafe { fmi3EnterStepMode(c) }),
    ("fmi3EnterContinuousTimeMode", "", |c| unsafe { fmi3EnterContinuousTimeMode(c) }),
    ("fmi3CompletedIntegratorStep", "", |c| unsafe { fmi3CompletedIntegratorStep(c, 0, null_mut(), null_mut()) }),
    ("fmi3SetTime", "", |c| unsafe { fmi3SetTime(c, 0.0) }),
    ("fmi3SetContinuousStates", "", |c| unsafe { fmi3SetContinuousStates(c, null(), 0) }),
    ("fmi3GetContinuousStateDerivatives", "", |c| unsafe { fmi3GetContinuousStateDerivatives(c, null_mut(), 0) }),
    ("fmi3GetEventIndicators", "", |c| unsafe { fmi3GetEventIndicators(c, null_mut(), 0) }),
    ("fmi3GetContinuousStates", "", |c| unsafe { fmi3GetContinuousStates(c, null_mut(), 0) }),
    ("fmi3GetNominalsOfContinuousStates", "", |c| unsafe { fmi3GetNominalsOfContinuousStates(c, null_mut(), 0) }),
    ("fmi3GetNumberOfEventIndicators", "", |c| unsafe { fmi3GetNumberOfEventIndicators(c, null_mut()) }),
    ("fmi3GetNumberOfContinuousStates", "", |c| unsafe { fmi3GetNumberOfContinuousStates(c, null_mut()) }),
    ("fmi3ActivateModelPartition", "", |c| unsafe { fmi3ActivateModelPartition(c, 0, 0.0) }),
];

fn with_state(standard: Standard, c: *mut c_void, use_it: fn(*mut c_void, *mut c_void) -> c_uint) -> c_uint {
    let (fmu, mut state) = (Fmu::borrowed(standard, c), null_mut());
    let got = fmu.get_state(&mut state);
    if got != OK {
        return got;
    }
    let status = use_it(c, state);
    fmu.free_state(state);
    status
}

fn bytes(standard: Standard, c: *mut c_void, state: *mut c_void) -> Vec<u8> {
    Fmu::borrowed(standard, c).bytes(state)
}

fn from_bytes(standard: Standard, c: *mut c_void, state: *mut c_void) -> c_uint {
    let fmu = Fmu::borrowed(standard, c);
    fmu.read_bytes(&fmu.bytes(state))
}

fn only_discard(status: c_uint) -> c_uint {
    assert_ne!(status, OK);
    if status == DISCARD { OK } else { status }
}

fn table(standard: Standard) -> &'static [Function] {
    if standard == Standard::Fmi2 { &FUNCTIONS } else { &FUNCTIONS3 }
}

#[test]
fn every_function_is_allowed_in_the_phases_of_the_standard_and_in_no_other() {
    let phases = [
        (Phase::Instantiated, 'i'),
        (Phase::Initialization, 'm'),
        (Phase::StepComplete, 'c'),
        (Phase::Terminated, 't'),
    ];
    for standard in BOTH {
        for (phase, letter) in phases {
            for (name, allowed, call) in table(standard) {
                let fmu = Fmu::in_phase(standard, phase);
                let expected = if allowed.contains(letter) { OK } else { ERROR };
                assert_eq!(call(fmu.handle), expected, "{name} in {phase:?}: {:?}", fmu.take_messages());
                if expected == ERROR {
                    let message = fmu.message();
                    assert!(message.starts_with(name.split('(').next().unwrap()), "{message}");
                }
            }
        }
    }
}

#[test]
fn a_null_handle_is_an_error_for_every_function() {
    for (name, _, call) in BOTH.into_iter().flat_map(table) {
        assert_eq!(call(null_mut()), ERROR, "{name}");
    }
    unsafe { fmi2FreeInstance(null_mut()) };
    unsafe { fmi3FreeInstance(null_mut()) };
    unsafe {
        assert_eq!(CStr::from_ptr(fmi2GetVersion()), c"2.0");
        assert_eq!(CStr::from_ptr(fmi2GetTypesPlatform()), c"default");
        assert_eq!(CStr::from_ptr(fmi3GetVersion()), c"3.0");
    }
}

#[test]
fn null_arrays_are_fine_when_empty_and_refused_when_not() {
    let fmu = Fmu::in_phase(Standard::Fmi2, Phase::StepComplete);
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
fn null_arrays_of_fmi3_are_fine_when_empty_and_refused_when_not() {
    let fmu = Fmu::in_phase(Standard::Fmi3, Phase::StepComplete);
    let c = fmu.handle;
    for length in [0, 2] {
        let expected = if length == 0 { OK } else { ERROR };
        let statuses = unsafe {
            [
                fmi3GetFloat64(c, null(), length, null_mut(), length),
                fmi3SetFloat64(c, null(), length, null(), length),
                fmi3GetInt32(c, null(), length, null_mut(), length),
                fmi3GetInt64(c, null(), length, null_mut(), length),
                fmi3SetBoolean(c, null(), length, null(), length),
                fmi3GetString(c, null(), length, null_mut(), length),
                fmi3SetDebugLogging(c, 1, length, null()),
                fmi3GetOutputDerivatives(c, null(), length, null(), null_mut(), length),
                fmi3GetAdjointDerivative(c, null(), length, null(), length, null(), length, null_mut(), length),
            ]
        };
        assert_eq!(statuses, [expected; 9], "{:?}", fmu.take_messages());
    }
    unsafe {
        assert_eq!(fmi3GetFMUState(c, null_mut()), ERROR);
        assert_eq!(fmi3SetFMUState(c, null_mut()), ERROR);
        assert_eq!(fmi3DoStep(c, 0.0, 0.1, 1, null_mut(), &mut 0, &mut 0, &mut 0.0), ERROR);
        assert_eq!(fmi3DoStep(c, 0.0, 0.1, 1, &mut 0, &mut 0, &mut 0, null_mut()), ERROR);
    }
    assert_eq!(fmu.step(0.0, 0.1), OK);
}

#[test]
fn a_panic_does_not_cross_the_boundary_and_leaves_an_instance_that_can_only_be_freed() {
    for standard in BOTH {
        let fmu = Fmu::in_phase(standard, Phase::StepComplete);
        let status = unsafe { boundary::guard(fmu.handle, "DoStep", |_| panic!("index #3")) };
        assert_eq!(status, FATAL);
        let (status, category, message) = fmu.take_messages().remove(0);
        assert_eq!((status, category.as_str()), (FATAL, "logStatusFatal"));
        assert!(message.contains("index ##3"), "# must be doubled for the importer: {message}");
        for (name, _, call) in table(standard).iter().filter(|(name, ..)| !name.to_lowercase().contains("state")) {
            if !["fmi2GetStatus", "fmi2GetIntegerStatus", "fmi2GetStringStatus"].contains(name) && !name.contains('(') {
                assert_eq!(call(fmu.handle), FATAL, "{name}");
            }
        }
    }
}

#[test]
fn exactly_the_functions_of_the_standard_are_exported() {
    let library = archive::library_beside(Path::new(env!("CARGO_BIN_EXE_cartilage-contact")));
    let listed = Command::new("nm").args(["-D", "--defined-only", "--format=posix"]).arg(&library).output().unwrap();
    let listed = String::from_utf8(listed.stdout).unwrap();
    let exported: BTreeSet<&str> = listed.lines().filter_map(|line| line.split(' ').next()).collect();
    let tested = BOTH.into_iter().flat_map(table).map(|(name, ..)| *name).filter(|name| !name.contains('('));
    let others = [
        "fmi2GetTypesPlatform",
        "fmi2GetVersion",
        "fmi2Instantiate",
        "fmi2FreeInstance",
        "fmi3GetVersion",
        "fmi3InstantiateCoSimulation",
        "fmi3InstantiateModelExchange",
        "fmi3InstantiateScheduledExecution",
        "fmi3FreeInstance",
    ];
    assert_eq!(exported, tested.chain(others).collect());
    let of = |prefix| exported.iter().filter(|name| name.starts_with(prefix)).count();
    assert_eq!((of("fmi2"), of("fmi3")), (44, 75));
}
