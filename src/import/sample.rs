//! A measured value with its times, and the clock that counts.

/// A value with its two times \[ns\] since 1970.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StampedSample<T> {
    /// Time of measurement; zero if the publisher did not set it.
    pub stamp: i64,
    /// Time of logging.
    pub logged: i64,
    pub value: T,
}

/// The clock of the samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Clock {
    /// The time of measurement, in each message's header
    #[default]
    Header,
    /// The time of logging
    Log,
}

impl Clock {
    /// Name for the user.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Header => "header",
            Self::Log => "log",
        }
    }

    pub(super) fn of<T>(self, sample: &StampedSample<T>) -> i64 {
        match self {
            Self::Header => sample.stamp,
            Self::Log => sample.logged,
        }
    }
}
