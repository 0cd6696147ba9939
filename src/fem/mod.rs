//! Geometry and bookkeeping of the finite elements; no physics.

pub mod assembly;
pub mod element;
pub mod mesh;
