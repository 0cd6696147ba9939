//! The weak forms, one a file, and the discrete system that they make up.

pub mod film;
pub mod layout;
pub mod system;
pub mod tissue;
