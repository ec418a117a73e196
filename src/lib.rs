//! Wheel–terrain model of a skid-steer UGV.

pub mod contact;
pub mod parameter;
pub mod scalar;
pub mod simulation;
pub mod terrain;
pub mod vehicle;
