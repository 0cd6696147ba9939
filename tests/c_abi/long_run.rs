//! A master that goes on for ever: many steps in time, with states saved and brought back on the way.

use std::ptr::null_mut;

use cartilage_contact::fmi::fmi2::*;
use cartilage_contact::fmi::standard::Standard;

use crate::importer::*;

/// Communication steps in a cycle of load and speed.
const CYCLE: u32 = 20;
/// Length of one of them \[s\]; a cycle takes longer than the tissue to drain.
const STEP: f64 = 0.05;
/// Cycles until the start is forgotten.
const WARM_UP: u32 = 5;

/// Load and speed in cycles, the speed to and fro and the film closing and opening: steps in time under a given load. Once a cycle
/// a state is saved as bytes and brought back after a step that is not wanted. Each cycle after the first ones has to repeat;
/// `visit` is told the number of cycles done.
fn walk(standard: Standard, cycles: u32, mut visit: impl FnMut(u32)) {
    let fmu = Fmu::fresh(standard);
    assert_eq!((fmu.set_integer("mesh.columns", 16), fmu.set_integer("mesh.rows", 1)), (OK, OK));
    assert_eq!((fmu.set_choice("formulation", 2), fmu.set_real("relative_tolerance", 1e-2)), (OK, OK));
    assert_eq!((fmu.set_choice("time_integration", 2), fmu.set_choice("control", 2)), (OK, OK));
    let given = ["applied_load", "sliding_speed"].map(reference);
    let at = |step: u32| {
        let angle = 2.0 * std::f64::consts::PI * f64::from(step % CYCLE) / f64::from(CYCLE);
        [60.0 + 40.0 * angle.sin(), 0.2 * angle.cos()]
    };
    // FMI 2 is told how the inputs move during a step; in FMI 3 they jump.
    let set = |step: u32| match standard {
        Standard::Fmi2 => {
            let (from, to) = (at(step), at(step + 1));
            let rates = [(to[0] - from[0]) / STEP, (to[1] - from[1]) / STEP];
            assert_eq!(fmu.set_reals(&given, &from), OK);
            let (orders, rates) = ([1, 1].as_ptr(), rates.as_ptr());
            assert_eq!(unsafe { fmi2SetRealInputDerivatives(fmu.handle, given.as_ptr(), 2, orders, rates) }, OK);
        }
        Standard::Fmi3 => assert_eq!(fmu.set_reals(&given, &at(step + 1)), OK),
    };
    assert_eq!(fmu.set_reals(&given, &at(0)), OK);
    assert_eq!(fmu.enter_initialization(f64::from(cycles * CYCLE + 1) * STEP), OK);
    assert_eq!(fmu.exit_initialization(), OK);
    let names = ["penetration_depth_result", "fluid_load", "solid_load", "upper_friction_force"];
    let mut expected: Vec<[f64; 4]> = Vec::new();
    let (mut time, mut worst) = (0.0, 0.0_f64);
    for cycle in 0..cycles {
        for step in 0..CYCLE {
            if step == cycle % CYCLE {
                let mut state = null_mut();
                assert_eq!(fmu.get_state(&mut state), OK);
                let bytes = fmu.bytes(state);
                fmu.free_state(state);
                assert_eq!(fmu.set_reals(&given, &[10.0, 0.3]), OK);
                assert_eq!(fmu.step(time, STEP), OK, "{cycle} {step} {:?}", fmu.take_messages());
                let (status, state) = fmu.state_from(&bytes);
                assert_eq!((status, fmu.set_state(state)), (OK, OK));
                fmu.free_state(state);
            }
            set(step);
            assert_eq!(fmu.step(time, STEP), OK, "{:?}", fmu.take_messages());
            time += STEP;
            let found = names.map(|name| fmu.get_real(name));
            if cycle + 1 == WARM_UP {
                expected.push(found);
            }
            if cycle >= WARM_UP {
                for (name, (found, expected)) in names.iter().zip(found.iter().zip(&expected[step as usize])) {
                    let size = if *name == "penetration_depth_result" { 1e-5 } else { 100.0 };
                    worst = worst.max((found - expected).abs() / size);
                    assert!(worst < 1e-6, "cycle {cycle}, step {step}: {name} = {found}, before {expected}");
                }
            }
        }
        visit(cycle + 1);
    }
    println!("{} steps: cycles differ by {worst:e}", cycles * CYCLE);
    assert!(expected.iter().any(|now| now[2] > 0.0) && expected.iter().any(|now| now[2] == 0.0));
    assert!(fmu.take_messages().iter().all(|message| message.0 <= WARNING));
}

#[test]
fn cycles_repeat() {
    for standard in BOTH {
        walk(standard, WARM_UP + 5, |_| {});
    }
}

/// Resident memory of this process [kB]; none where the system does not say.
fn resident() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    line.trim().strip_suffix("kB")?.trim().parse().ok()
}

/// To be run alone, for other tests take memory too.
fn stay_flat(steps: u32) {
    let mut warm = None;
    walk(Standard::Fmi2, steps / CYCLE, |cycle| {
        let now = resident();
        if cycle == WARM_UP {
            warm = now;
        }
        if cycle % 250 == 0 {
            println!("{} steps: {now:?} kB", cycle * CYCLE);
        }
        if let (Some(warm), Some(now)) = (warm, now) {
            assert!(now < warm + 512, "cycle {cycle}: {now} kB resident, {warm} kB after {WARM_UP} cycles");
        }
    });
}

#[test]
#[ignore = "two minutes, alone: cargo test --release --test c_abi -- --ignored twenty_thousand"]
fn twenty_thousand_steps_take_no_more_memory() {
    stay_flat(20_000);
}

#[test]
#[ignore = "ten minutes, alone: cargo test --release --test c_abi -- --ignored hundred_thousand"]
fn a_hundred_thousand_steps_take_no_more_memory() {
    stay_flat(100_000);
}
