//! Figures. [`canvas`] draws and writes files, [`panel`] is a pair of axes, [`colour_map`] a field in colours; one file a figure
//! beside them.

mod canvas;
mod colour_map;
pub mod experiments;
pub mod fields;
pub mod gait;
pub mod panel;
pub mod press_and_release;
pub mod reduced;
pub mod stribeck;
pub mod tornado;
