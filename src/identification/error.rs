//! Why a recording cannot be judged.

use crate::display::number;
use crate::recording::Channel;
use std::fmt;

/// Why a model cannot be judged by a recording.
#[derive(Debug, Clone, PartialEq)]
pub enum IdentificationError {
    /// Pose channels without a sample in any run.
    NoPose {
        /// Name of the recording.
        recording: String,
        /// What is missing.
        missing: Vec<Channel>,
    },
    /// No run is as long as the horizon.
    TooShort {
        /// Name of the recording.
        recording: String,
        /// Time for which the longest run has pose and wheel speeds \[s\].
        longest: f64,
        /// Horizon of the prediction \[s\].
        horizon: f64,
    },
    /// Every window stands still or has a gap in its pose.
    NoWindows {
        /// Name of the recording.
        recording: String,
        /// Windows in which the vehicle stands.
        standing: usize,
        /// Windows with a gap in the pose.
        gaps: usize,
    },
    /// No windows for fitting beside those for judging.
    TooShortToPart {
        /// Name of the recording.
        recording: String,
    },
    /// A setting outside its range.
    Setting {
        /// Which one.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
}

impl fmt::Display for IdentificationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPose { recording, missing } => {
                let names: Vec<&str> = missing.iter().map(|channel| channel.name()).collect();
                write!(
                    f,
                    "{recording}: no sample of {}: a prediction is compared with the recorded pose",
                    names.join(", ")
                )
            }
            Self::TooShort {
                recording,
                longest,
                horizon,
            } => write!(
                f,
                "{recording}: pose and wheel speeds together last {longest:.1} s at the longest, \
                 less than the horizon of {horizon} s"
            ),
            Self::NoWindows {
                recording,
                standing,
                gaps,
            } => write!(
                f,
                "{recording}: no window to judge: in {standing} the vehicle stands still, in \
                 {gaps} the pose has a gap"
            ),
            Self::TooShortToPart { recording } => write!(
                f,
                "{recording}: too short to be fitted on one half and judged on the other"
            ),
            Self::Setting { what, value, range } => {
                write!(f, "{what} = {}: it must be {range}", number(*value))
            }
        }
    }
}

impl std::error::Error for IdentificationError {}
