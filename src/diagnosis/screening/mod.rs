//! What the linearised problem shows: which candidates explain what re-tuning the soil cannot, where, and how sure.

pub mod locate;
pub mod noise;
pub mod regime;
pub mod region;
pub mod residual_model;
pub mod scan;
pub mod screen;
pub mod sensitivity;
pub mod slow;
pub mod system;
pub mod time_bins;
pub mod wrench;
