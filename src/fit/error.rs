//! Why nothing can be fitted.

use super::predictor::PredictionError;
use std::fmt;

/// Less driving than this cannot tell a soil from the noise \[s\].
pub const SHORTEST: f64 = 3.0;
/// Why there is no fit.
#[derive(Debug, Clone, PartialEq)]
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
        }
    }
}

impl std::error::Error for FitError {}
