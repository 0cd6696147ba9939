//! The contact as a Functional Mock-up Unit.
//!
//! | Module | Role |
//! |---|---|
//! | [`phase`] | which call is legal when |
//! | [`log`] | which messages the importer wants |
//! | [`instance`] | one instance: inputs, outputs, steps; knows nothing of C |
//! | [`derivatives`] | of outputs with respect to inputs and time |
//! | [`state`] | saved states and their bytes |
//! | [`description`] | `modelDescription.xml` |
//! | [`documentation`] | `documentation/index.html` |
//! | [`archive`] | the `.fmu` file |
//! | [`boundary`] | handles, slices and strings from C, panics |
//! | [`fmi2`] | the 34 functions of FMI 2.0 for co-simulation |

pub mod archive;
pub mod boundary;
pub mod derivatives;
pub mod description;
pub mod documentation;
pub mod fmi2;
pub mod instance;
pub mod log;
pub mod phase;
pub mod state;

/// Name of the FMU, its library and its file.
pub const MODEL_IDENTIFIER: &str = "CartilageLineContact";
