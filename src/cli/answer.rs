//! What a command finds, for a caller that writes no files.

use crate::fit::deadline::{Deadline, Watch};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Who asks.
pub struct Caller<'a> {
    /// Hears of each step at its start.
    pub step: &'a (dyn Fn(&str) + Sync),
    /// True where the work is to end soon.
    pub stop: &'a AtomicBool,
}

/// What a command found.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Texts by the names of the files that the tool would write.
    pub texts: Vec<(&'static str, String)>,
    /// What the user has to know.
    pub notes: Vec<String>,
}

impl Caller<'_> {
    /// The end of work that this caller may stop.
    pub fn deadline(&self) -> Deadline<'_> {
        Deadline::new(self, Duration::MAX)
    }
}

impl Watch for Caller<'_> {
    fn is_over(&self, _end: Duration) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}
