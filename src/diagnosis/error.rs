//! Why nothing can be diagnosed.

use crate::fit::error::{DEPENDS_ON_BEGINNING, LENGTHS};
use crate::fit::predictor::PredictionError;
use crate::recording::{RecordingFault, SameName};
use thiserror::Error;

/// The position of a vehicle at rest drifts about as far \[m\].
const DRIFT: f64 = 5.0;

/// Why there is no diagnosis.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum DiagnosisError {
    /// No recording at all.
    #[error("no recording to diagnose")]
    NoRecording,
    /// A recording without anything to compare with.
    #[error("{recording} has neither pose nor yaw rate nor velocities: nothing to compare with")]
    NothingMeasured {
        /// Its name.
        recording: String,
    },
    /// Wheels that never turn.
    #[error("{}", at_rest(*moved))]
    AtRest {
        /// How far the recorded positions reach all the same \[m\].
        moved: f64,
    },
    /// Too little to say anything.
    #[error("{seconds:.1} s of usable driving are too short: a diagnosis needs {needed} s")]
    TooShort {
        /// Seconds with wheel speeds and samples.
        seconds: f64,
        /// Seconds that are needed.
        needed: f64,
    },
    /// A model that cannot follow the wheel speeds to begin with.
    #[error("the given vehicle on the given terrain cannot follow most of the recording: {0}")]
    Undrivable(#[source] PredictionError),
    /// Numbers that left the range of the machine.
    #[error("the diagnosis' numbers are not finite")]
    NotFinite,
    /// Somebody wanted it to end: see [`Progress::stopped_by`](super::Progress::stopped_by).
    #[error("the diagnosis was stopped")]
    Stopped,
    /// The time limit was met before there was anything to judge: see
    /// [`Progress::within`](super::Progress::within).
    #[error(
        "time was up before the recordings could be compared with any candidate; give more time (--within), or fewer recordings"
    )]
    OutOfTime,
    /// Samples that are no series in time.
    #[error(transparent)]
    Recording(RecordingFault),
    /// A length of segments \[s\] that is none, or too short or too long.
    #[error("segments of {0} s: expected {min} to {max} s", min = LENGTHS.start(), max = LENGTHS.end())]
    SegmentLength(f64),
    /// Effects of the given model that depend on when a drive began: segments begin anywhere.
    #[error("{}", DEPENDS_ON_BEGINNING)]
    DependsOnBeginning,
    /// Two recordings of one name: findings name the recording.
    #[error(transparent)]
    SameName(SameName),
}

fn at_rest(moved: f64) -> String {
    if moved > DRIFT {
        format!(
            "the wheel speeds are zero throughout, but the positions reach over {moved:.0} m: the vehicle was towed, or \
             its wheel speeds were not recorded"
        )
    } else {
        "the wheels stand still throughout: nothing to diagnose".into()
    }
}
