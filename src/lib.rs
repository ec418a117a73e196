//! Wheel–terrain model of a skid-steer UGV.

pub mod contact;
pub mod declaration;
#[cfg(feature = "fmu")]
pub mod fmu;
pub mod json;
#[cfg(feature = "cli")]
pub mod package;
pub mod parameter;
pub mod recording;
pub mod scalar;
pub mod simulation;
pub mod spelling;
pub mod terrain;
pub mod vehicle;
