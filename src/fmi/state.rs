//! Saved states: in memory for fmi2GetFMUstate and fmi3GetFMUState, as bytes for fmi2SerializeFMUstate and
//! fmi3SerializeFMUState.
//!
//! The bytes start with a check sum over the FMU's token, the crate's version and the payload. Bytes that were cut,
//! altered, or written by another FMU or version are refused before anything is read from them.

use uuid::Uuid;

use crate::error::Error;
use crate::fmi::description;
use crate::fmi::model::{Model, ModelState};
use crate::fmi::phase::Phase;
use crate::memory;
use crate::parameters::{Inputs, Parameters};

/// Everything about an instance that is not the solver's.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Settings {
    /// Where the instance is in its life.
    pub phase: Phase,
    /// Parameters as set so far.
    pub parameters: Parameters,
    /// Inputs as set so far; not always those of the last solution.
    pub inputs: Inputs,
    /// Time derivatives of the inputs for the next step.
    pub input_rates: Inputs,
    /// The communication point.
    pub time: f64,
    /// Where the experiment ends, if that was said.
    pub stop_time: Option<f64>,
    /// Whether the outputs belong to the inputs (in initialization mode), or there are any (later).
    pub solved: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            phase: Phase::Instantiated,
            parameters: Parameters::default(),
            inputs: Inputs::default(),
            input_rates: Inputs::NONE,
            time: 0.0,
            stop_time: None,
            solved: false,
        }
    }
}

/// The whole state of an instance.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SavedState {
    pub(super) settings: Settings,
    /// With the parameters that it was solved for: those of the settings may have been tuned since.
    pub(super) model: Option<(Parameters, ModelState)>,
}

const MAGIC: &[u8] = b"CartilageLineContact state ";
const CHECK_SUM_LENGTH: usize = 16;

impl SavedState {
    pub(super) fn new(settings: &Settings, model: Option<&Model>) -> Self {
        Self { settings: settings.clone(), model: model.map(|model| (*model.parameters(), model.save())) }
    }

    /// The bytes that [`SavedState::from_bytes`] reads.
    ///
    /// # Errors
    /// [`Error::Memory`] where it runs out.
    pub fn to_bytes(&self) -> Result<Vec<u8>, Error> {
        memory::reserve_little()?;
        let payload = postcard::to_stdvec(self).map_err(|error| Error::State(error.to_string()))?;
        Ok([MAGIC, check_sum(&payload).as_bytes(), &payload].concat())
    }

    /// Reads what [`SavedState::to_bytes`] wrote.
    ///
    /// # Errors
    /// [`Error::State`] saying what is wrong with the bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Error> {
        let refuse = |why: &str| Err(Error::State(why.into()));
        let Some(rest) = bytes.strip_prefix(MAGIC) else {
            return refuse("these bytes are no state of this FMU");
        };
        let Some((sum, payload)) = rest.split_at_checked(CHECK_SUM_LENGTH) else {
            return refuse("the bytes end too early");
        };
        if sum != check_sum(payload).as_bytes() {
            return refuse("the bytes were cut or altered, or another version of this FMU wrote them");
        }
        memory::reserve_little()?;
        let state: Self = postcard::from_bytes(payload).map_err(|error| Error::State(error.to_string()))?;
        state.settings.parameters.validate()?;
        Ok(state)
    }
}

/// The same in every version of FMI. Differs where the payload, the FMU's table of variables, or the version that wrote it differs.
fn check_sum(payload: &[u8]) -> Uuid {
    let writer = Uuid::new_v5(
        &Uuid::NAMESPACE_OID,
        format!("{} {}", description::fmi2::token(), env!("CARGO_PKG_VERSION")).as_bytes(),
    );
    Uuid::new_v5(&writer, payload)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fmi::instance::Instance;
    use crate::fmi::log::Log;
    use crate::fmi::standard::Standard;

    /// Bytes that were altered and then given the right check sum: refused, or a state that can be gone on from or refused.
    fn mutate(times: u32) {
        let mut instance = Instance::new(Standard::Fmi2, Log::new(false));
        (instance.settings.parameters.mesh.columns, instance.settings.parameters.mesh.rows) = (8, 1);
        instance.setup_experiment(None, 0.0, None).unwrap();
        instance.enter_initialization_mode().unwrap();
        instance.exit_initialization_mode().unwrap();
        let saved = instance.save().unwrap();
        let good = saved.to_bytes().unwrap();
        let start = MAGIC.len() + CHECK_SUM_LENGTH;
        let mut random = 1_u64;
        let mut next = |below: usize| {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 33) as usize % below
        };
        let (mut read, mut restored) = (0, 0);
        for _ in 0..times {
            let mut payload = good[start..].to_vec();
            for _ in 0..=next(3) {
                let place = next(payload.len());
                match next(4) {
                    0 => payload[place] = next(256) as u8,
                    1 => payload[place] ^= 1 << next(8),
                    2 => payload.truncate(place.max(1)),
                    _ => payload.insert(place, next(256) as u8),
                }
            }
            let bytes = [MAGIC, check_sum(&payload).as_bytes(), &payload].concat();
            let Ok(state) = SavedState::from_bytes(&bytes) else { continue };
            read += 1;
            // Another mesh would only take long.
            let meshes = [Some(state.settings.parameters.mesh), state.model.as_ref().map(|(solved, _)| solved.mesh)];
            let mesh = saved.settings.parameters.mesh;
            if meshes.into_iter().flatten().any(|other| other != mesh) || instance.restore(&state).is_err() {
                continue;
            }
            restored += 1;
            instance.settings.parameters.maximum_solve_time = 0.1;
            let time = instance.time();
            let _ = instance.do_step(time, 0.1);
            instance.restore(&saved).unwrap();
        }
        assert!(read > times / 20 && restored > times / 40, "{read} read, {restored} restored of {times}");
    }

    #[test]
    fn altered_states_are_refused_or_gone_on_from() {
        mutate(300);
    }

    #[test]
    #[ignore = "minutes"]
    fn many_altered_states_are_refused_or_gone_on_from() {
        mutate(100_000);
    }
}
