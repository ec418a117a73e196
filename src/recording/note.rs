//! Changes that the reader made to the data, so that none is silent.

use super::channel::Channel;
use std::fmt;

/// Kinds of changes and findings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum NoteKind {
    /// A column of another name or unit was taken.
    Column,
    /// A wrapped heading was unwrapped.
    Unwrapped,
    /// Cells with `nan` or `null` were taken as missing.
    NotANumber,
    /// Samples that repeat a time stamp were dropped.
    Repeated,
    /// A clock that restarts under the same label was taken as the start of another run.
    Restarted,
    /// Rows that are late in the file were sorted in.
    Reordered,
    /// Times in another unit were converted to seconds.
    TimeUnit,
    /// Values in another unit were converted to the channel's.
    Unit,
    /// An error of a sensor's scale was put right.
    Scale,
    /// Impossible values were dropped.
    Outlier,
    /// Left and right wheel speeds were swapped.
    SwappedWheels,
    /// x and y were swapped.
    SwappedPosition,
    /// The sign of a channel was inverted.
    Sign,
    /// Something looks wrong, but the evidence is too weak for a correction.
    Suspicion,
}

impl NoteKind {
    /// Whether the user should check the file: every kind except those of good files.
    #[must_use]
    pub fn is_warning(self) -> bool {
        !matches!(self, Self::Unwrapped | Self::NotANumber | Self::Restarted)
    }
}

/// A change that the reader made, or a finding that it reports.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// Its kind.
    pub kind: NoteKind,
    /// The channel; none if the note concerns times.
    pub channel: Option<Channel>,
    /// Number of samples, rows or jumps.
    pub count: usize,
    /// Line of the file with the first of them, from 1.
    pub line: usize,
    /// The change and its evidence, in a sentence.
    pub text: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = self.channel.map_or("time", Channel::name);
        write!(f, "{place}: {} (from line {} on)", self.text, self.line)
    }
}
