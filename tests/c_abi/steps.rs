//! Steps, saved states, derivatives: the same in both versions of FMI.

use std::ptr::null_mut;

use cartilage_contact::fmi::fmi2::*;
use cartilage_contact::fmi::fmi3::*;
use cartilage_contact::fmi::standard::{Standard, TIME_REFERENCE};
use cartilage_contact::outputs::STATIONS;

use crate::importer::*;

#[test]
fn a_step_that_is_none_is_refused_and_the_next_good_one_goes_on() {
    for standard in BOTH {
        let fmu = Fmu::in_phase(standard, Phase::StepComplete);
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
        let status = match standard {
            Standard::Fmi2 => unsafe { fmi2GetRealStatus(fmu.handle, 2, &mut last) },
            Standard::Fmi3 => unsafe { fmi3GetFloat64(fmu.handle, &TIME_REFERENCE, 1, &mut last, 1) },
        };
        assert_eq!((status, last), (OK, time));
        assert_eq!(fmu.step(time, size), ERROR);
    }
}

#[test]
fn a_step_without_a_solution_is_discarded_and_its_start_can_be_restored() {
    for standard in BOTH {
        let fmu = Fmu::in_phase(standard, Phase::StepComplete);
        assert_eq!(fmu.step(0.0, 0.25), OK);
        let load = fmu.get_real("load");
        let mut state = null_mut();
        assert_eq!(fmu.get_state(&mut state), OK);
        assert_eq!(fmu.set_real("penetration_depth", UNREACHABLE), OK);
        assert_eq!(fmu.step(0.25, 0.25), DISCARD);
        assert_eq!(fmu.take_messages()[0].1, "logStatusDiscard");
        if standard == Standard::Fmi2 {
            let (mut time, mut ended) = (f64::NAN, 1);
            assert_eq!(unsafe { fmi2GetRealStatus(fmu.handle, 2, &mut time) }, OK);
            assert_eq!(unsafe { fmi2GetBooleanStatus(fmu.handle, 3, &mut ended) }, OK);
            assert_eq!((time, ended), (0.25, 0));
        }
        assert_eq!(fmu.get_real("load").to_bits(), load.to_bits());
        assert_eq!(fmu.set_state(state), OK);
        fmu.free_state(state);
        assert_eq!(fmu.step(0.25, 0.25), OK);
    }
}

#[test]
fn after_a_discarded_step_fmi3_goes_on_at_once() {
    let fmu = Fmu::in_phase(Standard::Fmi3, Phase::StepComplete);
    assert_eq!(fmu.set_real("penetration_depth", UNREACHABLE), OK);
    assert_eq!(fmu.step(0.0, 0.25), DISCARD);
    assert_eq!(fmu.set_real("penetration_depth", -9e-6), OK);
    assert_eq!(fmu.step(0.0, 0.25), OK);
}

#[test]
fn a_state_that_fmi2_saved_after_a_discarded_step_goes_on_in_fmi3() {
    let two = Fmu::in_phase(Standard::Fmi2, Phase::StepFailed);
    let mut state = null_mut();
    assert_eq!(two.get_state(&mut state), OK);
    let three = Fmu::in_phase(Standard::Fmi3, Phase::Instantiated);
    let (status, copy) = three.state_from(&two.bytes(state));
    assert_eq!(status, OK);
    assert_eq!(three.set_state(copy), OK);
    assert_eq!(three.get_real("load").to_bits(), two.get_real("load").to_bits());
    assert_eq!(three.set_real("penetration_depth", -9e-6), OK);
    assert_eq!(three.step(0.0, 0.25), OK);
    two.free_state(state);
    three.free_state(copy);
}

#[test]
fn bytes_of_a_state_are_refused_when_cut_altered_or_foreign() {
    for standard in BOTH {
        let fmu = Fmu::in_phase(standard, Phase::StepComplete);
        let mut state = null_mut();
        assert_eq!(fmu.get_state(&mut state), OK);
        let good = fmu.bytes(state);
        fmu.free_state(state);
        assert_eq!(fmu.read_bytes(&good), OK);
        for cut in 0..good.len() {
            assert_eq!(fmu.read_bytes(&good[..cut]), ERROR, "{cut} bytes of {}", good.len());
        }
        for changed in 0..good.len() {
            let mut bytes = good.clone();
            bytes[changed] ^= 1;
            assert_eq!(fmu.read_bytes(&bytes), ERROR, "byte {changed} of {}", good.len());
        }
        assert_eq!(fmu.read_bytes(&[&good[..], b"more"].concat()), ERROR);
        assert!(fmu.take_messages().iter().all(|(_, _, message)| message.contains("state refused")));
    }
}

#[test]
fn a_state_brings_back_phase_parameters_inputs_and_time() {
    for standard in BOTH {
        let first = Fmu::in_phase(standard, Phase::Instantiated);
        assert_eq!(first.set_real("lower.thickness", 1.3e-3), OK);
        assert_eq!(first.enter_initialization(1.0), OK);
        assert_eq!(first.exit_initialization(), OK);
        assert_eq!(first.set_real("penetration_depth", -8e-6), OK);
        assert_eq!(first.step(0.0, 0.25), OK);
        let mut state = null_mut();
        assert_eq!(first.get_state(&mut state), OK);
        let (load, saved) = (first.get_real("load"), first.bytes(state));
        assert_eq!(first.set_real("penetration_depth", -6e-6), OK);
        assert_eq!(first.step(0.25, 0.25), OK);
        let later = first.get_real("load");
        assert_ne!(load, later);

        let second = Fmu::in_phase(standard, Phase::Instantiated);
        let (status, copy) = second.state_from(&saved);
        assert_eq!(status, OK);
        assert_eq!(second.set_state(copy), OK);
        assert_eq!(first.set_state(state), OK);
        second.free_state(copy);
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
        assert_eq!(first.get_state(&mut state), OK);
        assert_eq!(state, before);
        first.free_state(state);
    }
}

#[test]
fn input_derivatives_move_the_input_during_one_step() {
    let fmu = Fmu::in_phase(Standard::Fmi2, Phase::StepComplete);
    let (c, depth) = (fmu.handle, reference("penetration_depth"));
    unsafe {
        assert_eq!(fmi2SetRealInputDerivatives(c, &depth, 1, &2, &1e-6), ERROR);
        assert!(fmu.message().contains("order 2"));
        assert_eq!(fmi2SetRealInputDerivatives(c, &depth, 1, &1, &4e-6), OK);
    }
    assert_eq!(fmu.step(0.0, 0.5), OK);
    assert!((fmu.get_real("penetration_depth") + 8e-6).abs() < 1e-18);
    let (status, slope) = fmu.directional("load", "penetration_depth", 4e-6);
    assert_eq!(status, OK);
    let (status, rate) = fmu.output_rate("load", 1);
    assert_eq!(status, OK);
    assert!((rate - slope).abs() < 1e-12 * slope, "{rate} {slope}");
    assert_eq!(fmu.output_rate("load", 2), (OK, 0.0));
    assert_eq!(fmu.output_rate("load", 0).0, ERROR);
    assert_eq!(fmu.step(0.5, 0.5), OK);
    assert!((fmu.get_real("penetration_depth") + 8e-6).abs() < 1e-18, "a derivative is for one step");
    assert_eq!(fmu.output_rate("load", 1), (OK, 0.0));
}

#[test]
fn outputs_of_inputs_that_stand_still_have_no_rate() {
    for standard in BOTH {
        let fmu = Fmu::in_phase(standard, Phase::StepComplete);
        assert_eq!(fmu.step(0.0, 0.5), OK);
        assert_eq!(fmu.output_rate("load", 1), (OK, 0.0));
        assert_eq!(fmu.output_rate("load", 0).0, ERROR);
    }
}

#[test]
fn derivatives_are_refused_for_what_has_none() {
    for standard in BOTH {
        let fmu = Fmu::in_phase(standard, Phase::StepComplete);
        for (unknown, known) in [
            ("newton_iterations", "sliding_speed"),
            ("load", "upper.thickness"),
            ("load", "load"),
            ("sliding_speed", "sliding_speed"),
        ] {
            assert_eq!(fmu.directional(unknown, known, 1.0).0, ERROR);
            fmu.message();
        }
    }
}

#[test]
fn both_versions_give_the_same_derivatives() {
    let slopes = BOTH.map(|standard| {
        let fmu = Fmu::in_phase(standard, Phase::StepComplete);
        ["penetration_depth", "sliding_speed"].map(|known| fmu.directional("load", known, 1.0))
    });
    assert_eq!(slopes[0], slopes[1]);
    assert!(slopes[0].iter().all(|(status, slope)| *status == OK && *slope != 0.0));
}

#[test]
fn adjoint_and_directional_derivatives_are_one_matrix() {
    let fmu = Fmu::in_phase(Standard::Fmi3, Phase::StepComplete);
    let c = fmu.handle;
    let unknowns = ["load", "film_thickness[1]", "upper_friction_force"].map(reference);
    let knowns = ["penetration_depth", "sliding_speed", "slide_to_roll_ratio"].map(reference);
    let count = STATIONS + 2;
    let weights: Vec<f64> = (0..count).map(|i| 1.0 + (i as f64).sin()).collect();
    let mut adjoint = [f64::NAN; 3];
    let status = unsafe {
        let (u, k) = (unknowns.as_ptr(), knowns.as_ptr());
        fmi3GetAdjointDerivative(c, u, 3, k, 3, weights.as_ptr(), count, adjoint.as_mut_ptr(), 3)
    };
    assert_eq!(status, OK, "{:?}", fmu.take_messages());
    for (column, known) in knowns.iter().enumerate() {
        let mut slopes = vec![f64::NAN; count];
        let status = unsafe {
            fmi3GetDirectionalDerivative(c, unknowns.as_ptr(), 3, known, 1, &1.0, 1, slopes.as_mut_ptr(), count)
        };
        assert_eq!(status, OK);
        let expected: f64 = slopes.iter().zip(&weights).map(|(slope, weight)| slope * weight).sum();
        assert!((adjoint[column] - expected).abs() <= 1e-12 * expected.abs(), "{} {expected}", adjoint[column]);
    }
    // Seeds and sensitivities count the elements of arrays, not the arrays.
    let status = unsafe {
        let (u, k) = (unknowns.as_ptr(), knowns.as_ptr());
        fmi3GetAdjointDerivative(c, u, 3, k, 3, weights.as_ptr(), 3, adjoint.as_mut_ptr(), 3)
    };
    assert_eq!(status, ERROR);
    assert!(fmu.message().contains("nSeed = 3"));
}

#[test]
fn a_profile_is_one_array_in_fmi3_and_its_stations_are_variables_in_fmi2() {
    let fmu = Fmu::in_phase(Standard::Fmi3, Phase::StepComplete);
    let first = reference("film_thickness[1]");
    let mut profile = vec![f64::NAN; STATIONS + 1];
    let read = |reference, room, values: &mut Vec<f64>| unsafe {
        fmi3GetFloat64(fmu.handle, &reference, 1, values.as_mut_ptr(), room)
    };
    assert_eq!(read(first, STATIONS, &mut profile), OK);
    assert_eq!(read(first, STATIONS + 1, &mut profile), ERROR);
    assert!(fmu.message().contains("101 values"));
    assert_eq!(read(first + 1, 1, &mut profile), ERROR);
    assert!(fmu.message().contains(&format!("film_thickness[2] is of has {first}")));

    let scalars = Fmu::in_phase(Standard::Fmi2, Phase::StepComplete);
    for (station, value) in profile.iter().take(STATIONS).enumerate() {
        assert_eq!(scalars.get_real(&format!("film_thickness[{}]", station + 1)).to_bits(), value.to_bits());
    }
}

/// A tunable parameter is that of the next step, which starts from what film and tissue hold: the same as a run that had it from
/// before, where the state does not depend on it.
#[test]
fn tunable_parameters_are_those_of_the_next_step() {
    for standard in BOTH {
        let fmu = Fmu::in_phase(standard, Phase::StepComplete);
        assert_eq!(fmu.step(0.0, 0.1), OK);
        let [load, viscous, ratio] =
            ["load", "upper_friction_force", "friction_coefficient"].map(|name| fmu.get_real(name));
        let mut before = null_mut();
        assert_eq!(fmu.get_state(&mut before), OK);
        // Twice the viscosity and twice the permeability leave the tissue's drainage as it is, and the film carries more.
        for (name, factor) in [("viscosity", 2.0), ("upper.permeability", 2.0), ("lower.permeability", 2.0)] {
            assert_eq!(fmu.set_real(name, factor * fmu.get_real(name)), OK);
        }
        assert_eq!(fmu.get_real("load").to_bits(), load.to_bits(), "the step before had others");
        let mut pending = null_mut();
        assert_eq!(fmu.get_state(&mut pending), OK);
        assert_eq!(fmu.step(0.1, 0.1), OK);
        let tuned = ["load", "upper_friction_force", "friction_coefficient"].map(|name| fmu.get_real(name));
        assert!(tuned[0] > 1.5 * load && tuned[1] > 1.5 * viscous && tuned[2] != ratio, "{tuned:?}");
        // A run that had them from the start ends there too.
        let other = Fmu::in_phase(standard, Phase::Initialization);
        for name in ["viscosity", "upper.permeability", "lower.permeability"] {
            assert_eq!(other.set_real(name, 2.0 * other.get_real(name)), OK);
        }
        assert_eq!(other.exit_initialization(), OK);
        let expected = other.get_real("load");
        assert!((tuned[0] - expected).abs() < 1e-6 * expected, "{} {expected}", tuned[0]);
        // Saved between setting and step: the results of before, then the same bits.
        assert_eq!(fmu.set_state(pending), OK);
        assert_eq!(fmu.get_real("load").to_bits(), load.to_bits());
        assert_eq!(fmu.step(0.1, 0.1), OK);
        assert_eq!(fmu.get_real("load").to_bits(), tuned[0].to_bits());
        assert_eq!(fmu.set_state(before), OK);
        assert_eq!(fmu.get_real("viscosity"), 1e-3, "as it was");
        fmu.free_state(before);
        fmu.free_state(pending);
        // What does not fit is refused and can be put right.
        assert_eq!(fmu.set_real("surface_roughness", 1e-6), OK);
        assert_eq!(fmu.step(0.1, 0.1), ERROR);
        assert!(fmu.message().contains("rough surfaces stay rough"));
        assert_eq!(fmu.set_real("surface_roughness", 0.0), OK);
        assert_eq!(fmu.step(0.1, 0.1), OK);
        assert!((fmu.get_real("load") - load).abs() < 1e-6 * load);
    }
}
