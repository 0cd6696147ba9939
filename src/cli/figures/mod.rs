//! Figures. [`canvas`] draws and writes files, [`panel`] is a pair of axes; one file a figure beside them.

mod canvas;
mod panel;
pub mod press_and_release;
