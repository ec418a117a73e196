//! A doubt about a recording, and what the searches for doubts share.

use crate::recording::{Channel, Run, range};
use std::fmt;

/// From this probability on a doubt goes before the names of physics.
pub const PROBABLE: f64 = 0.5;
/// Wheels slower than this share of their largest speed stand.
const STANDING_SHARE: f64 = 0.1;

/// What may be wrong with a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum DoubtKind {
    /// The pose, or a part of it, was computed from the wheel speeds.
    OwnOdometry,
    /// A side counts backwards.
    MirroredSide,
    /// Only the magnitude of a velocity was recorded.
    Unsigned,
    /// Wheel speeds and distance do not belong together: radius, gear ratio, ticks, unit.
    RollingRatio,
    /// Wheel difference and turning do not belong together: track.
    TurningRatio,
    /// The position is in another unit than metres.
    PositionUnit,
    /// Heading and yaw rate differ by a factor.
    HeadingFactor,
    /// A channel repeats one value for seconds.
    Frozen,
    /// Missing values were written as 0.
    Dropout,
    /// A channel is cut off at its largest value.
    Saturated,
    /// A channel has coarse steps.
    Quantised,
    /// The pose jumps.
    Jump,
    /// The wheel speeds are commands, not measurements.
    Commanded,
    /// Times are wrong.
    Clock,
    /// The importer doubted a source.
    Source,
}

impl DoubtKind {
    /// The name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::OwnOdometry => "own_odometry",
            Self::MirroredSide => "mirrored_side",
            Self::Unsigned => "unsigned",
            Self::RollingRatio => "rolling_ratio",
            Self::TurningRatio => "turning_ratio",
            Self::PositionUnit => "position_unit",
            Self::HeadingFactor => "heading_factor",
            Self::Frozen => "frozen",
            Self::Dropout => "dropout",
            Self::Saturated => "saturated",
            Self::Quantised => "quantised",
            Self::Jump => "jump",
            Self::Commanded => "commanded",
            Self::Clock => "clock",
            Self::Source => "source",
        }
    }
}

/// A time interval of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Index of the run.
    pub run: usize,
    /// Time of the first sample concerned \[s\].
    pub start: f64,
    /// Time of the last one \[s\].
    pub end: f64,
}

/// A hypothesis about the data that competes with physics.
#[derive(Debug, Clone, PartialEq)]
pub struct Doubt {
    /// What may be wrong.
    pub kind: DoubtKind,
    /// The channels concerned; none if it concerns times or sources.
    pub channels: Vec<Channel>,
    /// Where, if it concerns a part only.
    pub span: Option<Span>,
    /// Probability that this is wrong with the data.
    pub probability: f64,
    /// Where fit, score and diagnosis leave these channels out.
    pub left_out: Vec<Span>,
    /// The evidence, in a sentence.
    pub evidence: String,
    /// What to check or do, in a sentence.
    pub remedy: String,
}

impl Doubt {
    /// Whether it concerns samples that are not used.
    #[must_use]
    pub fn is_left_out(&self) -> bool {
        !self.left_out.is_empty()
    }
}

/// The same doubt in several runs becomes one, about where it is first.
pub fn joined(doubts: Vec<Doubt>) -> Vec<Doubt> {
    let mut joined: Vec<(Doubt, usize)> = Vec::new();
    for doubt in doubts {
        let is_same = |other: &Doubt| {
            doubt.span.is_some()
                && other.span.is_some()
                && other.kind == doubt.kind
                && other.channels == doubt.channels
                && other.is_left_out() == doubt.is_left_out()
        };
        match joined.iter_mut().find(|(other, _)| is_same(other)) {
            Some((other, more)) => {
                other.left_out.extend(doubt.left_out);
                other.probability = other.probability.max(doubt.probability);
                *more += 1;
            }
            None => joined.push((doubt, 0)),
        }
    }
    let each = joined.into_iter().map(|(mut doubt, more)| {
        match more {
            0 => {}
            1 => doubt.evidence.push_str("; and so in 1 more run"),
            more => doubt
                .evidence
                .push_str(&format!("; and so in {more} more runs")),
        }
        doubt
    });
    each.collect()
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            evidence, remedy, ..
        } = self;
        write!(f, "{evidence}. {remedy}.")
    }
}

/// Wheel speed below which wheels stand \[rad/s\]: the usual one, or a share of the largest. Speeds behind a gear, or in m/s,
/// are small throughout.
pub fn standing(runs: &[Run], usual: f64) -> f64 {
    let sides = [Channel::OmegaLeft, Channel::OmegaRight];
    let series = runs
        .iter()
        .flat_map(|run| sides.into_iter().filter_map(|side| run.series(side)));
    let [low, high] = range(series.flat_map(|series| series.value.iter().copied()));
    usual.min(STANDING_SHARE * high.max(-low))
}

/// Probability of a fault from how far a measure exceeds its limit, in units of the limit's width: 0.5 at the limit.
pub fn logistic(excess: f64) -> f64 {
    1.0 / (1.0 + (-excess).exp())
}
