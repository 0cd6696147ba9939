//! Steps, saved states, derivatives.

use std::ffi::c_int;
use std::ptr::null_mut;

use cartilage_contact::fmi::fmi2::*;

use crate::importer::*;

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
