//! What the parts of a solution cost, on the default mesh with one mirrored body: `cargo bench`.

#![allow(missing_docs, unsafe_code, clippy::unwrap_used)]

use std::hint::black_box;
use std::ptr::{null, null_mut};

use cartilage_contact::equations::system::{State, System};
use cartilage_contact::equations::tissue::{ElementTerms, LOCAL, VolumeRate};
use cartilage_contact::fmi::description::fmi2;
use cartilage_contact::fmi::fmi2::*;
use cartilage_contact::parameters::{Inputs, Mesh, Parameters};
use cartilage_contact::reduced::{Range, ReducedModel, Tolerance};
use cartilage_contact::simulation::Simulation;
use cartilage_contact::variables::VARIABLES;
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};

fn parameters() -> Parameters {
    Parameters { boundary_friction_loads_tissue: false, ..Parameters::default() }
}

fn at_depth(micron: f64) -> Inputs {
    Inputs { penetration_depth: micron * 1e-6, ..Inputs::default() }
}

fn element(criterion: &mut Criterion) {
    let system = System::new(&parameters(), true, 0.0);
    let inputs = Inputs::default();
    let layer = &system.layers[0];
    let at = system.local(0, 100, &system.rest(inputs).unknowns, inputs.penetration_depth);
    let rate = VolumeRate::default();
    criterion.bench_function("element residual", |bencher| {
        bencher.iter(|| {
            let mut residual = [0.0; LOCAL];
            let terms = ElementTerms { residual: Some(&mut residual), by_speed: None, tangent: None };
            layer.tissue.element(&layer.mesh, 100, black_box(&at), [0.1; 2], &rate, terms).map(|()| residual)
        });
    });
    criterion.bench_function("element tangent", |bencher| {
        bencher.iter(|| {
            let mut tangent = [0.0; LOCAL * LOCAL];
            let terms = ElementTerms { residual: None, by_speed: None, tangent: Some(&mut tangent) };
            layer.tissue.element(&layer.mesh, 100, black_box(&at), [0.1; 2], &rate, terms).map(|()| tangent)
        });
    });
}

fn system(criterion: &mut Criterion) {
    let inputs = Inputs::default();
    let mut system = System::new(&parameters(), true, 0.0);
    let mut state = State { inputs, ..system.rest(inputs) };
    let mut residual = Vec::new();
    criterion.bench_function("residual", |bencher| {
        bencher.iter(|| system.residual_at(black_box(&mut state), &mut residual));
    });
    for threads in [1, 2] {
        system.set_threads(threads);
        criterion.bench_function(&format!("tangent and factorisation, {threads} threads"), |bencher| {
            bencher.iter(|| system.factorise_at(black_box(&state)));
        });
    }
    for columns in [1, 3] {
        let right_hand_sides = residual.repeat(columns);
        criterion.bench_function(&format!("solution, {columns} right-hand sides"), |bencher| {
            bencher.iter_batched_ref(
                || right_hand_sides.clone(),
                |right_hand_sides| system.solve(right_hand_sides),
                BatchSize::SmallInput,
            );
        });
    }
}

fn points(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("simulation");
    group.sample_size(10);
    group.bench_function("a micron further, and back", |bencher| {
        let mut simulation = Simulation::new(&parameters()).unwrap();
        simulation.solve_steady(at_depth(5.0)).unwrap();
        bencher.iter(|| {
            simulation.solve_steady(at_depth(6.0)).unwrap();
            simulation.solve_steady(at_depth(5.0)).unwrap();
        });
    });
    group.bench_function("111 points", |bencher| {
        bencher.iter(|| {
            let mut simulation = Simulation::new(&parameters()).unwrap();
            (-10..=100).for_each(|micron| simulation.solve_steady(at_depth(f64::from(micron))).unwrap());
        });
    });
    group.finish();
}

/// Steps of a millisecond through the C interface; the depth goes up and down by 5 microns once a second.
fn do_step(criterion: &mut Criterion) {
    let reference = |name: &str| VARIABLES.iter().find(|variable| variable.name == name).unwrap().reference;
    let token = std::ffi::CString::new(fmi2::token()).unwrap();
    let callbacks = fmi2CallbackFunctions {
        logger: None,
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        component_environment: null_mut(),
    };
    let depth = reference("penetration_depth");
    for (name, time_integration) in [("quasi-steady", 1), ("transient", 2)] {
        criterion.bench_function(&format!("fmi2DoStep, 1 kHz, {name}"), |bencher| unsafe {
            let contact = fmi2Instantiate(c"contact".as_ptr(), 1, token.as_ptr(), null(), &callbacks, 0, 0);
            assert_eq!(fmi2SetInteger(contact, &reference("time_integration"), 1, &time_integration), 0);
            assert_eq!(fmi2SetupExperiment(contact, 0, 0.0, 0.0, 0, 0.0), 0);
            assert_eq!(fmi2EnterInitializationMode(contact), 0);
            assert_eq!(fmi2SetReal(contact, &depth, 1, &0.0), 0);
            assert_eq!(fmi2ExitInitializationMode(contact), 0);
            let mut step = 0;
            bencher.iter(|| {
                let time = 1e-3 * f64::from(step);
                let at = |time: f64| 5e-6 * (std::f64::consts::TAU * time).sin();
                let rate = (at(time + 1e-3) - at(time)) / 1e-3;
                assert_eq!(fmi2SetReal(contact, &depth, 1, &at(time)), 0);
                assert_eq!(fmi2SetRealInputDerivatives(contact, &depth, 1, &1, &rate), 0);
                assert_eq!(fmi2DoStep(contact, time, 1e-3, 0), 0);
                step += 1;
            });
            fmi2FreeInstance(contact);
        });
    }
}

fn reduced(criterion: &mut Criterion) {
    // What a state costs does not depend on the mesh that the table was made on.
    let mesh = Mesh { columns: 40, rows: 2, ..Parameters::default().mesh };
    let parameters = Parameters { mesh, sector_half_angle: 0.04, ..parameters() };
    let range = Range { pressed: [-5e-6, 5e-6], speeds: [0.15, 0.25], slide_to_roll_ratio: 0.0 };
    let tolerance =
        Tolerance { load: 0.1, minimum_film_thickness: 0.2, friction_coefficient: 0.2, fluid_pressure: 0.2 };
    let model = ReducedModel::build(&parameters, range, tolerance, 2, &|_| ()).unwrap();
    criterion.bench_function("reduced model, state and derivatives", |bencher| {
        bencher.iter(|| model.evaluate(black_box(&at_depth(3.0))));
    });
}

criterion_group!(benches, element, system, points, do_step, reduced);
criterion_main!(benches);
