//! When work has to end, whatever it has reached.
//!
//! Every prediction asks its deadline at each step of the integrator, and every loop around predictions asks it as well. Work
//! that meets its deadline fails with [`PredictionError::OutOfTime`](super::predictor::PredictionError::OutOfTime);
//! an optimiser gives the best point so far. A deadline that is not met changes no number.

use std::fmt;
use std::time::Duration;

/// A clock that also knows whether somebody wants the work to end.
pub trait Watch: Sync {
    /// Whether work that may last until `end`, counted from the clock's zero, has to end now.
    fn is_over(&self, end: Duration) -> bool;
}

/// The end of some work, by a clock.
#[derive(Clone, Copy)]
pub struct Deadline<'a> {
    watch: Option<&'a dyn Watch>,
    end: Duration,
}

impl<'a> Deadline<'a> {
    /// No end.
    pub const NEVER: Deadline<'static> = Deadline {
        watch: None,
        end: Duration::MAX,
    };

    /// An end by a clock.
    #[must_use]
    pub fn new(watch: &'a dyn Watch, end: Duration) -> Self {
        Self {
            watch: Some(watch),
            end,
        }
    }

    /// Whether work has to end now.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.watch.is_some_and(|watch| watch.is_over(self.end))
    }
}

impl fmt::Debug for Deadline<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.watch {
            Some(_) => write!(f, "Deadline({:?})", self.end),
            None => f.write_str("Deadline(never)"),
        }
    }
}
