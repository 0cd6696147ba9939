//! The C interface, called as an importer calls it.
#![allow(unsafe_code, clippy::unwrap_used)]

mod importer;
mod long_run;
mod parallel;
mod phases;
mod random;
mod steps;
mod values;
mod walk;
