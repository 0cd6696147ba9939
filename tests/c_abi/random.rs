//! Random calls of both C interfaces, in any order and with any values: every call returns, none is fatal, and what comes with OK is a
//! finite number.

use std::ffi::c_uint;
use std::ptr::null_mut;
use std::time::{Duration, Instant};

use cartilage_contact::fmi::fmi2::*;
use cartilage_contact::fmi::fmi3::*;
use cartilage_contact::fmi::standard::Standard;
use cartilage_contact::variables::VARIABLES;

use crate::importer::*;

pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % count
    }

    pub fn fraction(&mut self) -> f64 {
        self.below(1 << 20) as f64 / f64::from(1 << 20)
    }

    /// A reference, mostly of a variable.
    fn reference(&mut self) -> c_uint {
        let some = [0, 1, 2, 3, 4, 5, VARIABLES.len() - 1 - self.below(44)];
        match self.below(8) {
            0 => self.below(2 * VARIABLES.len()) as c_uint,
            1 => c_uint::MAX,
            _ => some[self.below(some.len())] as c_uint,
        }
    }

    /// A value, often one that the variable may have.
    fn value(&mut self, reference: c_uint) -> f64 {
        const ODD: [f64; 10] =
            [0.0, -0.0, 1e-300, -1e300, 1.7e308, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1.0, f64::MIN_POSITIVE];
        let range = VARIABLES.get(reference as usize).and_then(|variable| variable.range());
        match (self.below(4), range) {
            (0, _) | (_, None) => ODD[self.below(ODD.len())],
            (1, Some((least, most))) => [least, most][self.below(2)],
            (_, Some((least, most))) if least > 0.0 => least * (most / least).powf(self.fraction()),
            // Small ones are what people use.
            (_, Some((least, most))) => {
                (least + (most - least) * self.fraction()) * 10_f64.powi(-(self.below(6) as i32))
            }
        }
    }
}

/// One life of an instance.
fn live(seed: u64, calls: usize) {
    let mut random = Random(seed);
    let standard = BOTH[random.below(2)];
    let fmu = Fmu::fresh(standard);
    let small = |fmu: &Fmu| {
        for (name, value) in [("mesh.columns", 8), ("mesh.rows", 1)] {
            fmu.set_integer(name, value);
        }
        // Every solution ends soon.
        fmu.set_real("maximum_solve_time", 0.05);
    };
    small(&fmu);
    let (mut state, mut bytes, mut time) = (null_mut(), Vec::new(), 0.0);
    let kept = ["mesh.columns", "mesh.rows", "maximum_solve_time"].map(reference);
    for call in 0..calls {
        let (a, b) = (random.reference(), random.reference());
        let (of_a, of_b) = (random.value(a), random.value(b));
        let (mut found, c) = ([0.0; 2], fmu.handle);
        let kind = random.below(22);
        let status = match kind {
            0 => {
                let stop = [0.3, 1e6, 1e6, of_a][random.below(4)];
                match standard {
                    Standard::Fmi2 => unsafe {
                        let status = fmi2SetupExperiment(c, 0, 0.0, 0.0, 1, stop);
                        status.max(fmi2EnterInitializationMode(c))
                    },
                    Standard::Fmi3 => unsafe { fmi3EnterInitializationMode(c, 0, 0.0, 0.0, 1, stop) },
                }
            }
            1 | 2 => fmu.exit_initialization(),
            3 | 4 if !kept.contains(&a) => fmu.set_reals(&[a], &[of_a]),
            5 if !kept.contains(&a) && !kept.contains(&b) => fmu.set_reals(&[a, b], &[of_a, of_b]),
            6 | 7 => {
                let size = [0.1, 1e-3, 1e-12, 10.0, 0.0, -1.0, f64::NAN, 1e300][random.below(8)];
                let status = match standard {
                    Standard::Fmi2 => unsafe { fmi2DoStep(c, time, size, 1) },
                    Standard::Fmi3 => {
                        let mut flags = [1_u8; 3];
                        let [f, g, h] = &mut flags;
                        let mut last = 0.0;
                        let status = unsafe { fmi3DoStep(c, time, size, 1, f, g, h, &mut last) };
                        assert!(last.is_finite());
                        status
                    }
                };
                if status == OK {
                    time += size;
                }
                status
            }
            8 | 9 => match standard {
                Standard::Fmi2 => unsafe { fmi2GetReal(c, [a, b].as_ptr(), 2, found.as_mut_ptr()) },
                Standard::Fmi3 => unsafe { fmi3GetFloat64(c, [a, b].as_ptr(), 2, found.as_mut_ptr(), 2) },
            },
            10 | 11 => match standard {
                Standard::Fmi2 => unsafe { fmi2GetDirectionalDerivative(c, &a, 1, &b, 1, &of_a, found.as_mut_ptr()) },
                Standard::Fmi3 => unsafe {
                    fmi3GetDirectionalDerivative(c, &a, 1, &b, 1, &of_a, 1, found.as_mut_ptr(), 1)
                },
            },
            12 | 13 if standard == Standard::Fmi3 => {
                let (knowns, seeds) = ([b], [of_a, of_b]);
                let (u, k, s) = ([a, a], knowns.as_ptr(), seeds.as_ptr());
                unsafe { fmi3GetAdjointDerivative(c, u.as_ptr(), 2, k, 1, s, 2, found.as_mut_ptr(), 1) }
            }
            14 if standard == Standard::Fmi2 => {
                let order = random.below(4) as i32 - 1;
                unsafe { fmi2SetRealInputDerivatives(c, &a, 1, &order, &of_a) }
            }
            15 => match standard {
                Standard::Fmi2 => unsafe { fmi2GetRealOutputDerivatives(c, &a, 1, &1, found.as_mut_ptr()) },
                Standard::Fmi3 => unsafe { fmi3GetOutputDerivatives(c, &a, 1, &1, found.as_mut_ptr(), 1) },
            },
            16 => fmu.get_state(&mut state),
            17 if !state.is_null() => {
                bytes = fmu.bytes(state);
                let status = fmu.set_state(state);
                if status == OK {
                    // Its time is that of the state; steps from elsewhere are refused.
                    time = 0.0;
                }
                status
            }
            18 if !bytes.is_empty() => {
                let mut altered = bytes.clone();
                let place = random.below(altered.len());
                altered[place] ^= 1 << random.below(8);
                altered.truncate(altered.len() - random.below(3));
                fmu.read_bytes(&altered)
            }
            19 => {
                let status = fmu.set_choice(VARIABLES[VARIABLES.len() - 1 - random.below(44)].name, 2);
                small(&fmu);
                status
            }
            20 if random.below(10) == 0 => fmu.call(fmi2Terminate, fmi3Terminate),
            21 if random.below(5) == 0 => {
                let status = fmu.call(fmi2Reset, fmi3Reset);
                small(&fmu);
                time = 0.0;
                status
            }
            _ => continue,
        };
        assert!(
            [OK, DISCARD, ERROR].contains(&status),
            "seed {seed}, call {call} of kind {kind}: {status} {:?}",
            fmu.take_messages()
        );
        assert!(
            status != OK || found.iter().all(|v| v.is_finite()),
            "seed {seed}, call {call} of kind {kind}: {found:?}"
        );
        fmu.take_messages();
    }
    fmu.free_state(state);
}

fn live_for(time: Duration) {
    let start = Instant::now();
    let mut lives = 0;
    while start.elapsed() < time {
        live(lives, 60);
        lives += 1;
    }
    println!("{lives} instances, {} calls", 60 * lives);
}

#[test]
fn random_calls_are_answered() {
    live_for(Duration::from_secs(4));
}

#[test]
#[ignore = "ten minutes, or RANDOM_SECONDS"]
fn very_many_random_calls_are_answered() {
    let seconds = std::env::var("RANDOM_SECONDS").map_or(600, |text| text.parse().unwrap());
    live_for(Duration::from_secs(seconds));
}

#[test]
fn a_seed_that_is_too_large_is_refused() {
    let fmu = Fmu::in_phase(Standard::Fmi3, Phase::StepComplete);
    let (unknowns, known, mut found) = ([reference("load"); 2], reference("penetration_depth"), 0.0);
    let seeds = [1e305; 2];
    let (u, s) = (unknowns.as_ptr(), seeds.as_ptr());
    let status = unsafe { fmi3GetAdjointDerivative(fmu.handle, u, 2, &known, 1, s, 2, &mut found, 1) };
    assert_eq!((status, found), (ERROR, 0.0));
    assert!(fmu.message().contains("the derivative of load is too large"));
}

#[test]
fn a_derivative_has_time_of_its_own() {
    for standard in BOTH {
        let fmu = Fmu::in_phase(standard, Phase::Instantiated);
        assert_eq!((fmu.set_choice("time_integration", 2), fmu.set_real("maximum_solve_time", 5.0)), (OK, OK));
        assert_eq!((fmu.enter_initialization(1.0), fmu.exit_initialization()), (OK, OK));
        assert_eq!((fmu.set_real("penetration_depth", -9e-6), fmu.step(0.0, 0.1)), (OK, OK));
        std::thread::sleep(Duration::from_millis(5100));
        // It takes the step once more.
        let (status, slope) = fmu.directional("load", "penetration_depth", 1.0);
        assert!(status == OK && slope > 0.0, "{:?}", fmu.take_messages());
    }
}
