//! How well a model predicts what was recorded.
//!
//! A recording is cut into windows. Each begins at the recorded state; a model gets the recorded
//! wheel speeds of the window and says where the vehicle will be at its end. The constant
//! latencies of pose and wheels are estimated and removed first, and what is fitted is fitted on
//! other windows than it is judged on.

mod error;
mod estimate;
mod halves;
mod increments;
mod kinematics;
mod latency;
mod predict;
mod rolled;
mod score;
mod signals;
mod start;
mod windows;

pub use error::IdentificationError;
pub use estimate::Estimate;
pub use halves::{Halves, split};
pub use kinematics::{FittedKinematics, Kinematics, KinematicsForm};
pub use latency::{Latencies, Latency};
pub use predict::Predictor;
pub use score::{PredictionError, Summary, common, summarise};
pub use signals::{HeadingSource, Signals, heading_noise};
pub use windows::{Cut, Rejected, Window, WindowSet, cut};
