//! The C interface, called as an importer calls it.
#![allow(unsafe_code, clippy::unwrap_used)]

mod importer;
mod phases;
mod steps;
mod values;
