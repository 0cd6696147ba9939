//! Lubrication of cartilage on cartilage.

pub mod error;
pub mod fmi;
pub mod io;
pub mod outputs;
pub mod parameters;
pub mod simulation;
pub mod units;
pub mod variables;
