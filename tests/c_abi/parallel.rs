//! Many instances at once.

use cartilage_contact::fmi::standard::Standard;
use cartilage_contact::variables;

use crate::importer::*;

const INSTANCES: usize = 16;
const STEPS: usize = 3;

/// An instance of its own case: quasi-steady and in time, by both standards, in full film and in contact, sliding and rolling.
fn instance(index: usize) -> Fmu {
    let fmu = Fmu::fresh(if index.is_multiple_of(2) { Standard::Fmi2 } else { Standard::Fmi3 });
    assert_eq!((fmu.set_integer("mesh.columns", 12 + index as i32), fmu.set_integer("mesh.rows", 1)), (OK, OK));
    assert_eq!(fmu.set_real("relative_tolerance", 1e-2), OK);
    assert_eq!(fmu.set_choice("time_integration", 1 + (index / 4 % 2) as i32), OK);
    assert_eq!(fmu.set_real("slide_to_roll_ratio", 0.2 * (index % 3) as f64), OK);
    assert_eq!(fmu.set_real("penetration_depth", depth(index, 0)), OK);
    assert_eq!((fmu.enter_initialization(1e3), fmu.exit_initialization()), (OK, OK));
    fmu
}

fn depth(index: usize, step: usize) -> f64 {
    -9e-6 + 0.7e-6 * index as f64 + 0.5e-6 * step as f64
}

/// The bits of all results after a step.
fn step(fmu: &Fmu, index: usize, step: usize) -> Vec<u64> {
    assert_eq!(fmu.set_real("penetration_depth", depth(index, step + 1)), OK);
    assert_eq!(fmu.step(0.01 * step as f64, 0.01), OK, "{index}: {:?}", fmu.take_messages());
    let reals = variables::scalar_outputs().filter(|row| row.data_type() == variables::Type::Real);
    reals.map(|row| fmu.get_real(row.name).to_bits()).collect()
}

#[test]
fn instances_on_several_threads_give_the_same_bits_as_one_after_the_other() {
    let serial: Vec<Vec<Vec<u64>>> = (0..INSTANCES)
        .map(|index| {
            let fmu = instance(index);
            (0..STEPS).map(|number| step(&fmu, index, number)).collect()
        })
        .collect();
    std::thread::scope(|scope| {
        for thread in 0..4 {
            let serial = &serial;
            scope.spawn(move || {
                // Four instances a thread, in turn.
                let mine: Vec<_> = (thread..INSTANCES).step_by(4).map(|index| (index, instance(index))).collect();
                for number in 0..STEPS {
                    for (index, fmu) in &mine {
                        let found = step(fmu, *index, number);
                        assert_eq!(Some(&found), serial[*index].get(number), "instance {index}, step {number}");
                    }
                }
            });
        }
    });
    assert!(serial.windows(2).all(|pair| pair[0] != pair[1]));
}
