//! Runs the FMUs of FMI 2.0 and FMI 3.0 in fmi-rs, and compares what they answer.
//!
//! ```sh
//! cargo run --release                                                    # writes the FMUs
//! cargo run --manifest-path examples/importer_fmi_rs/Cargo.toml -- \
//!     target/fmu/CartilageLineContact.fmu target/fmu/CartilageLineContact.fmi3.fmu
//! ```
//!
//! Both are validated, initialised, stepped, differentiated, rolled back and serialised. Where an answer is not what it
//! has to be, the program says so and ends with exit code 1.

use std::fmt::Debug;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use fmi_rs::fmi2::builder::FMU2Builder;
use fmi_rs::fmi2::types::fmi2Status;
use fmi_rs::fmi2::{self, FMU2};
use fmi_rs::fmi3::FMU3;
use fmi_rs::fmi3::builder::FMU3Builder;
use fmi_rs::fmi3::types::fmi3Status;

type Answer<T> = Result<T, String>;

const OUTPUTS: [&str; 4] = ["load", "normal_force", "minimum_film_thickness", "friction_coefficient"];
const STEP: f64 = 0.1;

/// What is asked of an FMU, whatever its version.
trait Contact {
    /// Coarse mesh, initialised at the start values.
    fn begin(&self) -> Answer<()>;
    /// A step to the penetration depth [m].
    fn step(&self, time: f64, depth: f64) -> Answer<()>;
    /// The values of [`OUTPUTS`].
    fn outputs(&self) -> Answer<[f64; 4]>;
    /// Rate of change of the load with the penetration depth [Pa].
    fn slope(&self) -> Answer<f64>;
    /// Saves the state, takes the step and goes back; the saved state as bytes.
    fn step_and_return(&self, time: f64, depth: f64) -> Answer<Vec<u8>>;
    /// Continues from serialised bytes.
    fn resume(&self, bytes: &[u8]) -> Answer<()>;
}

fn check<S: Debug + PartialEq>(call: &str, status: S, ok: S) -> Answer<()> {
    if status == ok { Ok(()) } else { Err(format!("{call}: {status:?}")) }
}

/// Value references by name.
struct References {
    depth: u32,
    mesh: [u32; 2],
    outputs: [u32; 4],
}

impl References {
    fn new(known: &[(&str, u32)]) -> Answer<Self> {
        let find = |name: &str| {
            known.iter().find(|(n, _)| *n == name).map(|(_, r)| *r).ok_or_else(|| format!("no variable {name}"))
        };
        let mut outputs = [0; 4];
        for (reference, name) in outputs.iter_mut().zip(OUTPUTS) {
            *reference = find(name)?;
        }
        Ok(Self { depth: find("penetration_depth")?, mesh: [find("mesh.columns")?, find("mesh.rows")?], outputs })
    }
}

struct Two(Arc<FMU2<fmi2::CS>>, References);
struct Three(Arc<FMU3>, References);

const OK2: fmi2Status = fmi2Status::Ok;
const OK3: fmi3Status = fmi3Status::Ok;
const MESH: [i32; 2] = [16, 2];

impl Contact for Two {
    fn begin(&self) -> Answer<()> {
        let Self(fmu, references) = self;
        check("fmi2SetInteger", fmu.setInteger(&references.mesh, &MESH), OK2)?;
        check("fmi2SetupExperiment", fmu.setupExperiment(None, 0.0, None), OK2)?;
        check("fmi2EnterInitializationMode", fmu.enterInitializationMode(), OK2)?;
        check("fmi2ExitInitializationMode", fmu.exitInitializationMode(), OK2)
    }

    fn step(&self, time: f64, depth: f64) -> Answer<()> {
        let Self(fmu, references) = self;
        check("fmi2SetReal", fmu.setReal(&[references.depth], &[depth]), OK2)?;
        check("fmi2DoStep", fmu.doStep(time, STEP, 0), OK2)
    }

    fn outputs(&self) -> Answer<[f64; 4]> {
        let mut values = [0.0; 4];
        check("fmi2GetReal", self.0.getReal(&self.1.outputs, &mut values), OK2)?;
        Ok(values)
    }

    fn slope(&self) -> Answer<f64> {
        let Self(fmu, references) = self;
        let mut slope = [0.0];
        let status = fmu.getDirectionalDerivative(&references.outputs[..1], &[references.depth], &[1.0], &mut slope);
        check("fmi2GetDirectionalDerivative", status, OK2)?;
        Ok(slope[0])
    }

    fn step_and_return(&self, time: f64, depth: f64) -> Answer<Vec<u8>> {
        let fmu = &self.0;
        let (mut state, mut size) = (std::ptr::null_mut(), 0);
        check("fmi2GetFMUstate", fmu.getFMUstate(&mut state), OK2)?;
        check("fmi2SerializedFMUstateSize", fmu.serializedFMUstateSize(state, &mut size), OK2)?;
        let mut bytes = vec![0; size];
        check("fmi2SerializeFMUstate", fmu.serializeFMUstate(state, &mut bytes), OK2)?;
        self.step(time, depth)?;
        check("fmi2SetFMUstate", fmu.setFMUstate(state), OK2)?;
        check("fmi2FreeFMUstate", fmu.freeFMUstate(&mut state), OK2)?;
        Ok(bytes)
    }

    fn resume(&self, bytes: &[u8]) -> Answer<()> {
        let fmu = &self.0;
        let mut state = std::ptr::null_mut();
        check("fmi2DeSerializeFMUstate", fmu.deSerializeFMUstate(bytes, &mut state), OK2)?;
        check("fmi2SetFMUstate", fmu.setFMUstate(state), OK2)?;
        check("fmi2FreeFMUstate", fmu.freeFMUstate(&mut state), OK2)
    }
}

impl Contact for Three {
    fn begin(&self) -> Answer<()> {
        let Self(fmu, references) = self;
        check("fmi3SetInt32", fmu.setInt32(&references.mesh, &MESH), OK3)?;
        check("fmi3EnterInitializationMode", fmu.enterInitializationMode(None, 0.0, None), OK3)?;
        check("fmi3ExitInitializationMode", fmu.exitInitializationMode(), OK3)
    }

    fn step(&self, time: f64, depth: f64) -> Answer<()> {
        let Self(fmu, references) = self;
        check("fmi3SetFloat64", fmu.setFloat64(&[references.depth], &[depth]), OK3)?;
        let (mut event, mut terminate, mut early, mut last) = (true, true, true, 0.0);
        let status = fmu.doStep(time, STEP, false, &mut event, &mut terminate, &mut early, &mut last);
        check("fmi3DoStep", status, OK3)?;
        if event || terminate || early || (last - time - STEP).abs() > 1e-12 {
            return Err(format!("fmi3DoStep: event {event}, terminate {terminate}, early return {early}, at {last} s"));
        }
        Ok(())
    }

    fn outputs(&self) -> Answer<[f64; 4]> {
        let mut values = [0.0; 4];
        check("fmi3GetFloat64", self.0.getFloat64(&self.1.outputs, &mut values), OK3)?;
        Ok(values)
    }

    fn slope(&self) -> Answer<f64> {
        let Self(fmu, references) = self;
        let (load, depth) = (&references.outputs[..1], [references.depth]);
        let (mut slope, mut adjoint) = ([0.0], [0.0]);
        let status = fmu.getDirectionalDerivative(load, &depth, &[1.0], &mut slope);
        check("fmi3GetDirectionalDerivative", status, OK3)?;
        check("fmi3GetAdjointDerivative", fmu.getAdjointDerivative(load, &depth, &[1.0], &mut adjoint), OK3)?;
        if slope != adjoint {
            return Err(format!("directional derivative {}, adjoint {}", slope[0], adjoint[0]));
        }
        Ok(slope[0])
    }

    fn step_and_return(&self, time: f64, depth: f64) -> Answer<Vec<u8>> {
        let fmu = &self.0;
        let (mut state, mut size) = (std::ptr::null_mut(), 0);
        check("fmi3GetFMUState", fmu.getFMUState(&mut state), OK3)?;
        check("fmi3SerializedFMUStateSize", fmu.serializedFMUStateSize(state, &mut size), OK3)?;
        let mut bytes = vec![0; size];
        check("fmi3SerializeFMUState", fmu.serializeFMUState(state, &mut bytes), OK3)?;
        self.step(time, depth)?;
        check("fmi3SetFMUState", fmu.setFMUState(state), OK3)?;
        check("fmi3FreeFMUState", fmu.freeFMUState(&mut state), OK3)?;
        Ok(bytes)
    }

    fn resume(&self, bytes: &[u8]) -> Answer<()> {
        let fmu = &self.0;
        let mut state = std::ptr::null_mut();
        check("fmi3DeserializeFMUState", fmu.deserializeFMUState(bytes, &mut state), OK3)?;
        check("fmi3SetFMUState", fmu.setFMUState(state), OK3)?;
        check("fmi3FreeFMUState", fmu.freeFMUState(&mut state), OK3)
    }
}

/// The outputs after each step of one run, and the state before its last step as bytes.
fn drive(contact: &dyn Contact, other: &dyn Contact) -> Answer<Vec<[f64; 4]>> {
    contact.begin()?;
    other.begin()?;
    let depths = [-9e-6, -7e-6, -5e-6, -3e-6];
    let mut rows = Vec::new();
    for (index, depth) in depths.into_iter().enumerate() {
        let time = index as f64 * STEP;
        let bytes = contact.step_and_return(time, 0.0)?;
        contact.step(time, depth)?;
        let outputs = contact.outputs()?;
        other.resume(&bytes)?;
        other.step(time, depth)?;
        if other.outputs()? != outputs {
            return Err(format!("after the step at {time} s the resumed instance has other outputs"));
        }
        rows.push(outputs);
    }
    let (end, change) = (depths.len() as f64 * STEP, 1e-7);
    let slope = contact.slope()?;
    contact.step(end, depths[3] + change)?;
    let (rise, expected) = (contact.outputs()?[0] - rows[3][0], 0.5 * (slope + contact.slope()?) * change);
    if (rise / expected - 1.0).abs() > 1e-3 {
        return Err(format!("load rises by {rise} N/m, its derivative says {expected}"));
    }
    Ok(rows)
}

fn run(paths: &[PathBuf]) -> Answer<()> {
    let [two, three] = paths else { return Err("needs two files: the FMU of FMI 2.0 and that of FMI 3.0".into()) };
    let failed = |error: fmi_rs::sim::SimulationError| error.to_string();

    let builder = FMU2Builder::new(two).map_err(failed)?;
    let variables = &builder.model_description.modelVariables;
    let known: Vec<_> = variables.iter().map(|v| (v.name.as_str(), v.valueReference)).collect();
    let make = |name| Answer::Ok(Two(builder.instantiate_cs(name).map_err(failed)?, References::new(&known)?));
    let mut problems: Vec<_> = builder.model_description.validate().into_iter().map(|p| p.message).collect();
    let by_two = drive(&make("first")?, &make("second")?)?;

    let mut builder = FMU3Builder::new(three).map_err(failed)?;
    // The default asks for an event mode, which this FMU does not have.
    builder.eventModeUsed = false;
    let variables = &builder.model_description.modelVariables;
    let known: Vec<_> = variables.iter().map(|v| (v.name.as_str(), v.valueReference)).collect();
    let make = |name| Answer::Ok(Three(builder.instantiate_cs(name).map_err(failed)?, References::new(&known)?));
    problems.extend(builder.model_description.validate().into_iter().map(|p| p.message));
    let by_three = drive(&make("first")?, &make("second")?)?;

    println!("time [s]  {}", OUTPUTS.join("  "));
    for (index, [load, force, film, friction]) in by_two.iter().enumerate() {
        println!("{:8.1}  {load:.6e}  {force:.6e}  {film:.6e}  {friction:.6e}", (index + 1) as f64 * STEP);
    }
    if by_two != by_three {
        problems.push(format!("FMI 3.0 answers {by_three:?}"));
    }
    if problems.is_empty() { Ok(()) } else { Err(problems.join("\n")) }
}

fn main() -> ExitCode {
    match run(&std::env::args_os().skip(1).map(PathBuf::from).collect::<Vec<_>>()) {
        Ok(()) => {
            println!("FMI 2.0 and FMI 3.0 agree to the last bit; states, serialised states and derivatives pass");
            ExitCode::SUCCESS
        }
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}
