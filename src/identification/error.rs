//! Why a recording cannot be judged.

use crate::display::number;
use crate::recording::Channel;
use thiserror::Error;

/// Why a model cannot be judged by a recording.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum IdentificationError {
    /// Pose channels without a sample in any run.
    #[error(
        "{recording}: no sample of {}: a prediction is compared with the recorded pose",
        names(missing)
    )]
    NoPose {
        /// Name of the recording.
        recording: String,
        /// The missing channels.
        missing: Vec<Channel>,
    },
    /// No run is as long as the horizon.
    #[error(
        "{recording}: pose and wheel speeds together last {longest:.1} s at the longest, less than the horizon of \
         {horizon} s"
    )]
    TooShort {
        /// Name of the recording.
        recording: String,
        /// Longest duration of pose and wheel speeds together \[s\].
        longest: f64,
        /// Horizon of the prediction \[s\].
        horizon: f64,
    },
    /// Every window stands still or has a gap in its pose.
    #[error(
        "{recording}: no window to judge: in {standing} the vehicle stands still, in {gaps} the pose has a gap"
    )]
    NoWindows {
        /// Name of the recording.
        recording: String,
        /// Windows in which the vehicle stands.
        standing: usize,
        /// Windows with a gap in the pose.
        gaps: usize,
    },
    /// No windows for fitting in addition to those for judging.
    #[error("{recording}: too short to be fitted on one half and judged on the other")]
    TooShortToSplit {
        /// Name of the recording.
        recording: String,
    },
    /// A setting outside its range.
    #[error("{what} = {}: it must be {range}", number(*value))]
    Setting {
        /// Its name.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The valid range.
        range: &'static str,
    },
}

fn names(channels: &[Channel]) -> String {
    let names: Vec<&str> = channels.iter().map(|channel| channel.name()).collect();
    names.join(", ")
}
