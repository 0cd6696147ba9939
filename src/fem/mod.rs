//! Geometry and bookkeeping of the finite elements; no physics.

pub mod element;
pub mod mesh;
pub mod products;
