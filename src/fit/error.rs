//! Why nothing can be fitted.

use super::predictor::PredictionError;
use crate::recording::{RecordingFault, SameName};
use std::error::Error;
use std::fmt;
use std::ops::RangeInclusive;

/// Less driving than this cannot tell a soil from the noise \[s\].
pub const SHORTEST: f64 = 3.0;
/// Segments may be as long as this \[s\]: shorter ones tell nothing beside their starts, longer ones drift.
pub(crate) const LENGTHS: RangeInclusive<f64> = 2.0..=60.0;
/// What is said of effects that depend on when a drive began.
pub(crate) const DEPENDS_ON_BEGINNING: &str = "effects over the time or the distance driven do not fit segments, each with a beginning of its own";

/// Says that segments are too short or too long.
pub(crate) fn segment_length(length: f64, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let (least, most) = (LENGTHS.start(), LENGTHS.end());
    write!(f, "segments of {length} s: expected {least} to {most} s")
}

/// Why there is no fit.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum FitError {
    /// A recording without anything to compare with.
    NothingMeasured {
        /// Its name.
        recording: String,
    },
    /// Wheels that never turn.
    AtRest,
    /// Too little to fit \[s\].
    TooShort {
        /// Seconds with wheel speeds and samples.
        seconds: f64,
    },
    /// A model that cannot drive along the wheel speeds to begin with.
    Start(PredictionError),
    /// Numbers that left the range of the machine.
    NotFinite,
    /// Samples that are no series in time.
    Recording(RecordingFault),
    /// Two recordings of one name: the sensors' parameters are called after it.
    SameName(SameName),
    /// A length of segments \[s\] that is none, or too short or too long.
    SegmentLength(f64),
    /// Effects that depend on when a drive began: segments begin anywhere.
    DependsOnBeginning,
    /// A parameter that is named twice.
    Twice {
        /// Its name.
        name: String,
    },
    /// As many values to begin with as parameters are needed.
    Values {
        /// Number of parameters.
        parameters: usize,
        /// Number of values.
        values: usize,
    },
}

impl fmt::Display for FitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NothingMeasured { recording } => write!(
                f,
                "{recording} has neither pose nor yaw rate nor velocities: nothing to compare with"
            ),
            Self::AtRest => f.write_str("the wheels stand still throughout: nothing to fit"),
            Self::TooShort { seconds } => write!(
                f,
                "{seconds:.1} s of usable driving are too short: a fit needs {SHORTEST} s"
            ),
            Self::Start(error) => write!(
                f,
                "the fit cannot begin with this vehicle and terrain: {error}"
            ),
            Self::NotFinite => f.write_str("the fit's numbers are not finite"),
            Self::Recording(fault) => fault.fmt(f),
            Self::SameName(error) => error.fmt(f),
            Self::SegmentLength(length) => segment_length(*length, f),
            Self::DependsOnBeginning => f.write_str(DEPENDS_ON_BEGINNING),
            Self::Twice { name } => write!(f, "{name} is named twice"),
            Self::Values { parameters, values } => {
                write!(
                    f,
                    "{values} values to begin with for {parameters} parameters"
                )
            }
        }
    }
}

impl Error for FitError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Start(error) => Some(error),
            Self::Recording(fault) => Some(fault),
            Self::SameName(error) => Some(error),
            _ => None,
        }
    }
}
