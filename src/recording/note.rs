//! What the reader did to the data, so that nothing happens silently.

use super::Channel;
use std::fmt;

/// The kinds of things that the reader does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum NoteKind {
    /// Full turns were taken out of a wrapped heading.
    Unwrapped,
    /// Cells that say `nan` or `null` were taken as missing.
    NotANumber,
    /// Samples that repeat a time stamp were left out.
    Repeated,
    /// A clock that starts anew under the same label was taken for another run.
    Restarted,
    /// Rows that stood late in the file were put where they belong.
    Reordered,
    /// Times were in another unit than seconds.
    TimeUnit,
    /// Values were in another unit than the channel's.
    Unit,
    /// Values that cannot be were left out.
    Outlier,
    /// Left and right wheel speeds were swapped.
    SwappedWheels,
    /// x and y were swapped.
    SwappedPosition,
    /// A channel had the other sign.
    Sign,
    /// Something looks wrong, but not so clearly that it could be put right.
    Suspicion,
}

impl NoteKind {
    /// Whether somebody should look at the file: everything but what happens in good files.
    #[must_use]
    pub fn is_warning(self) -> bool {
        !matches!(self, Self::Unwrapped | Self::NotANumber | Self::Restarted)
    }
}

/// Something that the reader did, or that it wants known.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// What kind of thing.
    pub kind: NoteKind,
    /// The channel; none where it concerns times.
    pub channel: Option<Channel>,
    /// Number of samples, rows or jumps.
    pub count: usize,
    /// Line of the file with the first of them, from 1.
    pub line: usize,
    /// What was done and how one sees that it had to be, in a sentence.
    pub text: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = self.channel.map_or("time", Channel::name);
        write!(f, "{place}: {} (from line {} on)", self.text, self.line)
    }
}
