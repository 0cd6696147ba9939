//! Numbers only, no physics: linear elimination, Newton's method, continuation.

pub mod continuation;
pub mod deadline;
pub mod linear;
pub mod newton;
pub mod runge_kutta;
