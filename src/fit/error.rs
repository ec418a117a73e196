//! Why nothing can be fitted.

use super::predictor::PredictionError;
use crate::recording::{RecordingFault, SameName};
use std::ops::RangeInclusive;
use thiserror::Error;

/// Less driving than this does not distinguish a soil from the noise \[s\].
pub const SHORTEST: f64 = 3.0;
/// Segments may be as long as this \[s\]: shorter ones determine nothing beside their starts, longer ones drift.
pub(crate) const LENGTHS: RangeInclusive<f64> = 2.0..=60.0;
/// Message about effects that depend on when a drive began.
pub(crate) const DEPENDS_ON_BEGINNING: &str =
    "effects over time or distance driven do not fit segments, which start anywhere";

/// Why there is no fit.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FitError {
    /// A recording without anything to compare with.
    #[error("{recording} has neither pose nor yaw rate nor velocities: nothing to compare with")]
    NothingMeasured {
        /// Its name.
        recording: String,
    },
    /// Wheels that never turn.
    #[error("the wheels stand still throughout: nothing to fit")]
    AtRest,
    /// Too little to fit \[s\].
    #[error("{seconds:.1} s of usable driving are too short: a fit needs {SHORTEST} s")]
    TooShort {
        /// Seconds with wheel speeds and samples.
        seconds: f64,
    },
    /// A model that cannot follow the wheel speeds from its initial values.
    #[error("the fit cannot start with this vehicle and terrain: {0}")]
    Start(#[source] PredictionError),
    /// Numbers that left the range of the machine.
    #[error("the fit's numbers are not finite")]
    NotFinite,
    /// Samples that are no series in time.
    #[error(transparent)]
    Recording(RecordingFault),
    /// Two recordings of one name: the sensors' parameters are called after it.
    #[error(transparent)]
    SameName(SameName),
    /// A length of segments \[s\] that is none, or too short or too long.
    #[error("segments of {0} s: expected {min} to {max} s", min = LENGTHS.start(), max = LENGTHS.end())]
    SegmentLength(f64),
    /// Effects that depend on when a drive began: segments start anywhere.
    #[error("{}", DEPENDS_ON_BEGINNING)]
    DependsOnBeginning,
    /// A parameter that is named twice.
    #[error("{name} is named twice")]
    Twice {
        /// Its name.
        name: String,
    },
    /// Another number of initial values than of parameters.
    #[error("{values} initial values for {parameters} parameters")]
    Values {
        /// Number of parameters.
        parameters: usize,
        /// Number of values.
        values: usize,
    },
}
