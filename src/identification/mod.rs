//! How well a model predicts a recorded drive.
//!
//! A recording is cut into windows. Each starts at the recorded state; a model gets the recorded wheel speeds of the window
//! and predicts the pose at its end. First the constant latencies of pose and wheels are estimated and removed. A model is
//! judged on other windows than those it is fitted on.

mod error;
mod gyro;
mod kinematics;
mod latency;
mod prediction;
mod signals;
mod split;
mod start;
mod windows;

pub use error::IdentificationError;
pub use gyro::{GyroScale, with_true_gyro};
pub use kinematics::{FittedKinematics, Kinematics, KinematicsForm};
pub use latency::{Latencies, Latency, heading_noise};
pub use prediction::{ErrorSummary, MotionModel, PoseError, common, summarise};
pub use signals::{HeadingSource, Signals};
pub use split::{DataSplit, fitted_part, split};
pub use windows::{PredictionWindow, Rejected, WindowOptions, WindowSet, cut};
