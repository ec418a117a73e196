//! Why nothing can be diagnosed.

use crate::fit::error::{DEPENDS_ON_BEGINNING, segment_length};
use crate::fit::predictor::PredictionError;
use crate::recording::{RecordingFault, SameName};
use std::error::Error;
use std::fmt;

/// The position of a vehicle at rest drifts about as far \[m\].
const DRIFT: f64 = 5.0;

/// Why there is no diagnosis.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum DiagnosisError {
    /// No recording at all.
    NoRecording,
    /// A recording without anything to compare with.
    NothingMeasured {
        /// Its name.
        recording: String,
    },
    /// Wheels that never turn.
    AtRest {
        /// How far the recorded positions reach all the same \[m\].
        moved: f64,
    },
    /// Too little to say anything.
    TooShort {
        /// Seconds with wheel speeds and samples.
        seconds: f64,
        /// Seconds that are needed.
        needed: f64,
    },
    /// A model that cannot follow the wheel speeds to begin with.
    Undrivable(PredictionError),
    /// Numbers that left the range of the machine.
    NotFinite,
    /// Somebody wanted it to end: see [`Progress::stopped_by`](super::Progress::stopped_by).
    Stopped,
    /// The time limit was met before there was anything to judge: see
    /// [`Progress::within`](super::Progress::within).
    OutOfTime,
    /// Samples that are no series in time.
    Recording(RecordingFault),
    /// A length of segments \[s\] that is none, or too short or too long.
    SegmentLength(f64),
    /// Effects of the given model that depend on when a drive began: segments begin anywhere.
    DependsOnBeginning,
    /// Two recordings of one name: findings name the recording.
    SameName(SameName),
}

impl fmt::Display for DiagnosisError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoRecording => f.write_str("no recording to diagnose"),
            Self::NothingMeasured { recording } => write!(
                f,
                "{recording} has neither pose nor yaw rate nor velocities: nothing to compare with"
            ),
            Self::AtRest { moved } if *moved > DRIFT => write!(
                f,
                "the wheel speeds are zero throughout, but the positions reach over {moved:.0} m: the vehicle was \
                 towed, or its wheel speeds were not recorded"
            ),
            Self::AtRest { .. } => {
                f.write_str("the wheels stand still throughout: nothing to diagnose")
            }
            Self::TooShort { seconds, needed } => write!(
                f,
                "{seconds:.1} s of usable driving are too short: a diagnosis needs {needed} s"
            ),
            Self::Undrivable(error) => write!(
                f,
                "the given vehicle on the given terrain cannot follow most of the recording: {error}"
            ),
            Self::NotFinite => f.write_str("the diagnosis' numbers are not finite"),
            Self::Stopped => f.write_str("the diagnosis was stopped"),
            Self::OutOfTime => f.write_str(
                "time was up before the recordings could be compared with any candidate; give more time (--within), or fewer recordings",
            ),
            Self::Recording(fault) => fault.fmt(f),
            Self::SegmentLength(length) => segment_length(*length, f),
            Self::DependsOnBeginning => f.write_str(DEPENDS_ON_BEGINNING),
            Self::SameName(error) => error.fmt(f),
        }
    }
}

impl Error for DiagnosisError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Undrivable(error) => Some(error),
            Self::Recording(fault) => Some(fault),
            Self::SameName(error) => Some(error),
            _ => None,
        }
    }
}
