//! The contact as a Functional Mock-up Unit.
//!
//! | Module | Role |
//! |---|---|
//! | [`standard`] | what differs between the versions of FMI |
//! | [`phase`] | which call is legal when |
//! | [`log`] | which messages the importer wants |
//! | [`answer`] | what a call answers: a value, or why not |
//! | [`instance`] | one instance: inputs, outputs, steps; knows nothing of C |
//! | [`model`] | what it asks for outputs: the full or the real-time model |
//! | [`resources`] | the table of the real-time model in the unpacked FMU |
//! | [`derivatives`] | of outputs with respect to inputs and time |
//! | [`state`] | saved states and their bytes |
//! | [`description`] | `modelDescription.xml` |
//! | [`slim`] | the same for importers that know a part of the standard |
//! | [`documentation`] | `documentation/index.html` |
//! | [`archive`] | the `.fmu` files |
//! | `importer` | the other side of the interface, for the command line |
//! | [`boundary`] | handles, slices and strings from C, panics |
//! | [`fmi2`] | the 44 functions of FMI 2.0: 34 for co-simulation, and 10 for model exchange, which refuse |
//! | [`fmi3`] | the 75 functions of FMI 3.0 |

pub mod answer;
pub mod archive;
pub mod boundary;
pub mod derivatives;
pub mod description;
pub mod documentation;
pub mod fmi2;
pub mod fmi3;
#[cfg(feature = "cli")]
pub mod importer;
pub mod instance;
pub mod log;
pub mod model;
pub mod phase;
pub mod resources;
pub mod slim;
pub mod standard;
pub mod state;

/// Name of the FMU, its library and its file.
pub const MODEL_IDENTIFIER: &str = "CartilageLineContact";
