//! Fitting soil, vehicle and sensor parameters to recordings: [`fit_model`].
//!
//! Multiple shooting: recordings are cut into segments of some seconds, each with a start of
//! its own ([`segment`]); a model predicts each ([`predictor`], [`exact`]), sensors report of it
//! ([`observation`]), and the parameters that all segments share are found by
//! Levenberg–Marquardt with the starts eliminated ([`optimiser`], [`bounded`], [`normal`]). The noise of
//! each channel, white and coloured, comes from the data ([`noise`], [`noise_estimate`]),
//! heavy tails by weights ([`robust`]). What the data determine, and how well, is in
//! [`uncertainty`] and [`identifiability`]; [`starts`] asks whether there is another answer, [`restart`] whether
//! a segment's start is in a wrong minimum.
//!
//! Segments are computed side by side and summed in their order: the result does not depend
//! on the number of threads.

pub mod bounded;
pub mod catalogue;
pub mod deadline;
mod descent;
pub mod error;
pub mod estimate;
pub mod exact;
pub mod identifiability;
pub mod linearised;
mod model;
pub mod noise;
pub mod noise_estimate;
pub mod noise_model;
pub mod normal;
pub mod observation;
pub mod optimiser;
mod options;
pub mod parameter;
pub mod predictor;
pub mod problem;
pub mod restart;
pub mod robust;
pub mod segment;
pub mod sensor;
pub mod signal;
pub mod starts;
pub mod uncertainty;

pub use error::FitError;
pub use estimate::{Estimate, Fit, fit};
pub use model::{Fitted, fit_model, fit_model_until};
pub use noise_model::NoiseEstimate;
pub use options::{Options, Stage};
