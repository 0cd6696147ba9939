//! Numbers only, no physics: linear elimination, Newton's method, continuation, steps in time, ways to a steady state through time.

pub mod continuation;
pub mod deadline;
pub mod linear;
pub mod newton;
pub mod predictor;
pub mod pseudo_transient;
pub mod root;
pub mod runge_kutta;
pub mod time_stepping;
