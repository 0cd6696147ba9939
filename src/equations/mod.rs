//! The weak forms, one a file, and the discrete system that they make up.

pub mod contact;
pub mod facing;
pub mod film;
pub mod film_end;
pub mod grid;
pub mod inflow;
pub mod layout;
pub mod load;
pub mod surface;
pub mod system;
pub mod tissue;
