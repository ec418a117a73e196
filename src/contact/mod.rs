//! Stresses and forces under one wheel (equations (2) to (18) of the paper).
//!
//! Everything here happens in the frame of one wheel: `forward` and `lateral` are the
//! velocity of its centre along the body's X and Y, and the contact arc is measured by
//! theta from the wheel's lowest point, positive towards the side that compacts soil.

mod law;
mod patch;
mod quadrature;
mod wheel;

pub use law::{ContactArc, Wheel, WheelLaw, WheelMemory, WheelMotion};
pub(crate) use law::{MOST_INPUTS, REACH};
pub use quadrature::Resolution;
pub(crate) use wheel::FORCE_COUNT;
pub use wheel::{Detail, Regularisation, WheelContact, WheelForces};
