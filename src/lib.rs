//! Lubrication of cartilage on cartilage.

pub mod equations;
pub mod error;
pub mod fem;
pub mod fields;
pub mod fmi;
pub mod io;
pub mod laws;
pub mod outputs;
pub mod parameters;
pub mod simulation;
pub mod solver;
pub mod units;
pub mod variables;
