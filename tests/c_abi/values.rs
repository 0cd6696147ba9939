//! What is refused and how it is told: values, parameters, tokens, log categories.

use std::ffi::{CStr, c_uint};
use std::ptr::null;

use cartilage_contact::fmi::description::token;
use cartilage_contact::fmi::fmi2::*;

use crate::importer::*;

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
