//! What is refused and how it is told: values, parameters, tokens, log categories.

use std::ffi::{CStr, c_uint};
use std::ptr::{null, null_mut};

use cartilage_contact::fmi::description::{fmi2::token, fmi3};
use cartilage_contact::fmi::fmi2::*;
use cartilage_contact::fmi::fmi3::*;
use cartilage_contact::fmi::standard::{Standard, TIME_REFERENCE};
use cartilage_contact::parameters::Preset;

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
fn instantiation_by_fmi3_says_why_it_fails() {
    for (name, token, events, intermediate, reason) in [
        (" ", fmi3::token(), false, &[][..], "instanceName"),
        ("contact", token(), false, &[], "instantiationToken"),
        ("contact", fmi3::token(), true, &[], "hasEventMode"),
        ("contact", fmi3::token(), false, &[3], "requiredIntermediateVariables"),
    ] {
        let fmu = Fmu::instantiate3(name, token, events, intermediate);
        assert!(fmu.handle.is_null());
        let message = fmu.message();
        assert!(message.starts_with("fmi3InstantiateCoSimulation: ") && message.contains(reason), "{message}");
    }
    unsafe {
        assert!(
            fmi3InstantiateCoSimulation(null(), null(), null(), 0, 0, 0, 0, null(), 0, null_mut(), None, None)
                .is_null()
        );
        assert!(absent::fmi3InstantiateModelExchange(null(), null(), null(), 0, 0, null_mut(), None).is_null());
    }
}

#[test]
fn a_refused_value_is_explained_in_one_line_and_changes_nothing() {
    for standard in BOTH {
        let fmu = Fmu::in_phase(standard, Phase::Initialization);
        let [real, integer, choice] = match standard {
            Standard::Fmi2 => ["Real", "Integer", "Integer"],
            Standard::Fmi3 => ["Float64", "Int32", "Int64"],
        };
        let refused: [(c_uint, &[&str]); 11] = [
            (fmu.set_real("penetration_depth", 0.5), &["penetration_depth", "0.5", "-1e-2 to 1e-2 m"]),
            (fmu.set_real("sliding_speed", f64::NAN), &["sliding_speed", "NaN", "-1e1 to 1e1 m/s"]),
            (fmu.set_real("upper.thickness", f64::INFINITY), &["upper.thickness", "inf", "1e-5 to 1e-1 m"]),
            (fmu.set_real("load", 1.0), &["load", "result"]),
            (fmu.set_real("formulation", 1.0), &["formulation", "Enumeration", choice]),
            (fmu.set_real("mesh.columns", 1.0), &["mesh.columns is no ", integer]),
            (fmu.set_choice("formulation", 3), &["formulation", "3", "1 (paper), 2 (consistent)"]),
            (fmu.set_choice("formulation", 0), &["formulation", "0", "1 (paper)"]),
            (fmu.set_integer("mesh.columns", 2001), &["mesh.columns", "2001", "0 to 2000"]),
            (fmu.set_integer("sliding_speed", 1), &["sliding_speed", real]),
            (fmu.set_reals(&[99_999], &[1.0]), &["99999", "unknown"]),
        ];
        let messages = fmu.take_messages();
        assert_eq!(messages.len(), refused.len());
        for ((status, parts), (_, category, message)) in refused.iter().zip(&messages) {
            assert_eq!((*status, category.as_str()), (ERROR, "logStatusError"));
            assert!(parts.iter().all(|part| message.contains(part)) && !message.contains('\n'), "{message}");
        }
        // The first value of an array is not kept if the second is refused.
        assert_eq!(fmu.set_reals(&[reference("sliding_speed"), reference("penetration_depth")], &[0.5, 1.0]), ERROR);
        assert_eq!(fmu.get_real("sliding_speed"), 0.2);
        assert_eq!(fmu.get_real("penetration_depth"), -10e-6);
        assert_eq!(fmu.exit_initialization(), OK);
        fmu.take_messages();
        assert_eq!(fmu.set_real("upper.thickness", 1.1e-3), ERROR);
        assert!(fmu.message().contains("upper.thickness = 0.0011 comes too late"));
    }
}

#[test]
fn parameters_that_do_not_fit_each_other_are_refused_before_initialization() {
    for standard in BOTH {
        let fmu = Fmu::in_phase(standard, Phase::Instantiated);
        assert_eq!(fmu.set_real("upper.outer_radius", 1e-3), OK);
        assert_eq!(fmu.enter_initialization(1.0), ERROR);
        assert!(fmu.message().contains("upper.thickness"));
        assert_eq!(fmu.set_real("upper.outer_radius", 0.1), OK);
        assert_eq!(fmu.enter_initialization(1.0), OK);
    }
}

#[test]
fn reset_brings_back_the_start_values() {
    for standard in BOTH {
        let fmu = Fmu::in_phase(standard, Phase::StepComplete);
        assert_eq!(fmu.step(0.0, -1.0), ERROR);
        assert_eq!(fmu.call(fmi2Reset, fmi3Reset), OK);
        assert_eq!(fmu.enter_initialization(1.0), OK);
        assert_eq!(fmu.get_integer("mesh.columns"), 120);
    }
}

#[test]
fn a_preset_sets_what_is_not_set_by_name_in_any_order() {
    let expected = Preset::HumanNormal.parameters();
    let number = 1 + Preset::HumanNormal as i32;
    for standard in BOTH {
        for preset_first in [true, false] {
            let fmu = Fmu::fresh(standard);
            let by_name = || {
                assert_eq!(fmu.set_integer("mesh.columns", 16), OK);
                // What the default is, and the preset not.
                assert_eq!(fmu.set_real("upper.thickness", 1e-3), OK);
                assert_eq!(fmu.set_real("sliding_speed", 0.1), OK);
            };
            if !preset_first {
                by_name();
            }
            assert_eq!(fmu.enter_initialization(1.0), OK);
            assert_eq!(fmu.set_choice("preset", number), OK);
            assert_eq!(fmu.get_real("lower.shear_modulus"), expected.lower.shear_modulus, "at once");
            if preset_first {
                by_name();
            }
            assert_eq!(fmu.get_integer("mesh.columns"), 16);
            assert_eq!(fmu.get_integer("mesh.rows"), expected.mesh.rows);
            assert_eq!(fmu.get_real("upper.thickness"), 1e-3);
            assert_eq!(fmu.get_real("lower.thickness"), expected.lower.thickness);
            assert_eq!(fmu.get_real("upper.permeability"), expected.upper.permeability);
            assert_eq!(fmu.get_real("sliding_speed"), 0.1);
            assert_eq!(fmu.exit_initialization(), OK);
            assert_eq!(fmu.set_choice("preset", 1), ERROR);
            assert!(fmu.message().contains("preset = \"paper\" comes too late"));
            assert_eq!(fmu.call(fmi2Reset, fmi3Reset), OK);
            assert_eq!(fmu.enter_initialization(1.0), OK);
            assert_eq!(fmu.get_integer("mesh.columns"), 120);
            assert_eq!(fmu.get_real("lower.shear_modulus"), 0.5e6);
            // Nothing is remembered of what was set by name before.
            assert_eq!(fmu.set_choice("preset", number), OK);
            assert_eq!(fmu.get_real("upper.thickness"), expected.upper.thickness);
            assert_eq!(fmu.set_choice("preset", 99), ERROR);
            assert!(fmu.message().contains("preset = 99 is not allowed: 1 (paper), 2 (human_tibial_plateau)"));
        }
    }
}

#[test]
fn what_was_set_by_name_is_part_of_a_saved_state() {
    for standard in BOTH {
        let (fmu, other) = (Fmu::fresh(standard), Fmu::fresh(standard));
        assert_eq!(fmu.set_integer("mesh.columns", 16), OK);
        let mut state = null_mut();
        assert_eq!(fmu.get_state(&mut state), OK);
        let (status, copy) = other.state_from(&fmu.bytes(state));
        assert_eq!((status, other.set_state(copy)), (OK, OK));
        fmu.free_state(state);
        other.free_state(copy);
        assert_eq!(other.set_choice("preset", 4), OK);
        assert_eq!(other.enter_initialization(1.0), OK);
        assert_eq!(other.get_integer("mesh.columns"), 16);
    }
}

#[test]
fn start_values_can_be_read_before_initialization_by_fmi3() {
    let fmu = Fmu::in_phase(Standard::Fmi3, Phase::Instantiated);
    assert_eq!(fmu.get_real("penetration_depth"), -10e-6);
    let mut load = 0.0;
    assert_eq!(unsafe { fmi3GetFloat64(fmu.handle, &reference("load"), 1, &mut load, 1) }, ERROR);
    assert!(fmu.message().contains("load has no value before initialization"));
}

#[test]
fn time_is_read_and_not_set() {
    let fmu = Fmu::in_phase(Standard::Fmi3, Phase::StepComplete);
    let mut time = f64::NAN;
    assert_eq!(fmu.step(0.0, 0.25), OK);
    assert_eq!(unsafe { fmi3GetFloat64(fmu.handle, &TIME_REFERENCE, 1, &mut time, 1) }, OK);
    assert_eq!(time, 0.25);
    assert_eq!(fmu.set_reals(&[TIME_REFERENCE], &[0.0]), ERROR);
    assert!(fmu.message().contains("time is the independent variable"));
}

#[test]
fn only_the_categories_that_are_switched_on_are_told() {
    for standard in BOTH {
        let fmu = Fmu::in_phase(standard, Phase::StepComplete);
        let switch = |on: bool, names: &[&CStr]| {
            let names: Vec<_> = names.iter().map(|name| name.as_ptr()).collect();
            match standard {
                Standard::Fmi2 => unsafe { fmi2SetDebugLogging(fmu.handle, on.into(), names.len(), names.as_ptr()) },
                Standard::Fmi3 => unsafe { fmi3SetDebugLogging(fmu.handle, on.into(), names.len(), names.as_ptr()) },
            }
        };
        assert_eq!(switch(true, &[c"logSolver"]), OK);
        assert_eq!(fmu.step(0.0, 0.1), OK);
        assert_eq!(fmu.take_messages()[0].1, "logSolver");
        assert_eq!(switch(false, &[c"logSolver"]), OK);
        assert_eq!(switch(true, &[c"logNothing"]), ERROR);
        assert!(fmu.message().contains("logNothing"));
        assert_eq!(switch(false, &[]), OK);
        assert_eq!(fmu.step(0.0, -1.0), ERROR);
        assert!(fmu.take_messages().is_empty());
    }
}
