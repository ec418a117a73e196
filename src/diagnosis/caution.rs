//! Limits of a verdict that its reader must know before acting on it.

use crate::inspection::Doubt;

/// A limit of the verdict.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Caution {
    /// The data are probably not what they claim, or some of them are left out.
    DoubtfulData {
        /// Name of the recording.
        recording: String,
        /// The doubt.
        doubt: Doubt,
    },
    /// The time limit ended the search early.
    TimeUp,
    /// The time limit allowed only some of the segments \[s\].
    Part {
        /// Seconds of driving that were used.
        used: f64,
        /// Seconds of driving in the recordings.
        of: f64,
    },
    /// There was no time for the held-out comparison.
    NotHeldOut,
}

impl Caution {
    /// The name in `diagnosis.json`.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::DoubtfulData { .. } => "doubtful_data",
            Self::TimeUp => "time_up",
            Self::Part { .. } => "part_of_recordings",
            Self::NotHeldOut => "not_held_out",
        }
    }

    /// Sentences for the reader: what happened, and what to do.
    #[must_use]
    pub fn text(&self) -> String {
        match self {
            Self::DoubtfulData { recording, doubt } => format!(
                "{recording}: {doubt} Probability that the data are wrong: {:.0} %.",
                100.0 * doubt.probability
            ),
            Self::TimeUp => "Time was up before all candidates were fitted. More may be missing than was found, and \
                             the probabilities compare only the fits done by then. Allow more time (--within)."
                .into(),
            Self::Part { used, of } => format!(
                "Time allowed only {:.0} % of the driving: {used:.0} s of {of:.0} s, in segments spread evenly. An effect \
                 that acts for some seconds may lie between them.",
                100.0 * used / of
            ),
            Self::NotHeldOut => {
                "There was no time to compare the models on held-out data.".into()
            }
        }
    }
}
