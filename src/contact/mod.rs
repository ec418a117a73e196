//! Stresses and forces under one wheel (equations (2) to (18) of the paper).
//!
//! Everything here happens in the frame of one wheel: `forward` and `lateral` are the
//! velocity of its centre along the body's X and Y, and the contact arc is measured by
//! theta from the wheel's lowest point, positive towards the side that compacts soil.

mod altered;
mod patch;
mod quadrature;
mod sums;
mod wheel;

pub use altered::{ContactArc, WheelLaw, WheelMemory};
pub use quadrature::Resolution;
pub(crate) use wheel::FORCE_COUNT;
pub use wheel::{Detail, Regularisation, WheelContact, WheelForces, WheelMotion};
