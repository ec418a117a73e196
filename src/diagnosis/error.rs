//! Reasons why a diagnosis is impossible.

use crate::fit::error::{DEPENDS_ON_BEGINNING, LENGTHS};
use crate::fit::predictor::PredictionError;
use crate::recording::{RecordingFault, SameName};
use thiserror::Error;

/// Upper bound of the position's drift at rest \[m\].
const DRIFT: f64 = 5.0;

/// Why there is no diagnosis.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum DiagnosisError {
    /// No recording was given.
    #[error("no recording to diagnose")]
    NoRecording,
    /// A recording without pose, yaw rate and velocities.
    #[error("{recording} has neither pose nor yaw rate nor velocities: nothing to compare with")]
    NothingMeasured {
        /// Its name.
        recording: String,
    },
    /// Wheels that never turn.
    #[error("{}", at_rest(*moved))]
    AtRest {
        /// Extent of the recorded positions \[m\].
        moved: f64,
    },
    /// Too little driving.
    #[error("{seconds:.1} s of usable driving are too short: a diagnosis needs {needed} s")]
    TooShort {
        /// Seconds with wheel speeds and samples.
        seconds: f64,
        /// Seconds that are needed.
        needed: f64,
    },
    /// The given model cannot follow the wheel speeds.
    #[error(
        "the given vehicle on the given terrain cannot follow most of the recording: {0}; check both"
    )]
    Undrivable(#[source] PredictionError),
    /// Overflow or an undefined result.
    #[error("the diagnosis stopped at a number that is not finite")]
    NotFinite,
    /// The caller ended it: see [`Progress::stopped_by`](super::Progress::stopped_by).
    #[error("the diagnosis was stopped")]
    Stopped,
    /// The time limit ended the work before the first screening: see
    /// [`Progress::within`](super::Progress::within).
    #[error(
        "time was up before the recordings could be compared with any candidate; allow more time (--within) or give fewer recordings"
    )]
    OutOfTime,
    /// Samples that are not ordered in time.
    #[error(transparent)]
    Recording(RecordingFault),
    /// A segment length outside its range \[s\].
    #[error("segments of {0} s: expected {min} to {max} s", min = LENGTHS.start(), max = LENGTHS.end())]
    SegmentLength(f64),
    /// The given model has effects that depend on when a drive started; segments start anywhere.
    #[error("{}", DEPENDS_ON_BEGINNING)]
    DependsOnBeginning,
    /// Two recordings have one name; findings refer to recordings by name.
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
