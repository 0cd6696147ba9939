//! Files that people write and read.

pub mod case;
pub mod measured;
pub mod vtu;
