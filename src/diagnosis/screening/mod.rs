//! Screening of all candidates on the linearised problem: evidence, region and uncertainty.

pub mod identifiable;
pub mod locate;
pub mod noise;
pub mod regime;
pub mod region;
pub mod replacement;
pub mod residual_model;
pub mod scan;
pub mod screen;
pub mod sensitivity;
pub mod shape;
pub mod slow;
pub mod system;
pub mod time_bins;
pub mod wrench;
