//! A measured value with its times.

/// A value with its two times \[ns\] since 1970.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StampedSample<T> {
    /// Time of measurement; zero if the publisher did not set it.
    pub stamp: i64,
    /// Time of logging.
    pub logged: i64,
    pub value: T,
}
