//! Quality of a recording before any fit: doubts about its data, sampling rates and gaps, delays between sensors, and
//! noise. Nothing is read or drawn here.

mod delay;
pub mod doubts;
mod motion;
mod noise;
mod signals;
mod timing;

pub use delay::{Delay, Pair, Quality};
pub use doubts::{Doubt, DoubtKind, Fitness, SHORTEST, Span};
pub use motion::{MotionSummary, rest_spans};
pub use noise::Noise;
pub use signals::{MotionSignal, heading_rate, wheel_mean};
pub use timing::Timing;

use crate::recording::{Channel, Recording};
use crate::vehicle::Vehicle;

/// One channel over all runs.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelReport {
    /// The channel.
    pub channel: Channel,
    /// Sampling times.
    pub timing: Timing,
    /// Noise while all wheels stand still; `None` with too few such samples.
    pub noise_at_rest: Option<Noise>,
    /// Noise while they turn: an upper bound, because it includes the motion.
    pub noise_in_motion: Option<Noise>,
}

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub struct RunReport {
    /// The run's label, or its number from 1 where several have that label.
    pub label: String,
    /// Time of its first sample \[s\].
    pub start: f64,
    /// Its motion.
    pub motion: MotionSummary,
    /// Sampling times of each channel with samples.
    pub timing: Vec<(Channel, Timing)>,
}

/// A whole recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Inspection {
    /// Whether the recording can be diagnosed, and why not, in a clause.
    pub fitness: (Fitness, String),
    /// Doubts about its data, the likeliest first.
    pub doubts: Vec<Doubt>,
    /// All runs together.
    pub motion: MotionSummary,
    /// Each channel with samples.
    pub channels: Vec<ChannelReport>,
    /// Delays between signals, from all runs together.
    pub delays: Vec<Delay>,
    /// Each run.
    pub runs: Vec<RunReport>,
}

/// Inspects a recording of a vehicle; `None` for the vehicle of its metadata.
#[must_use]
pub fn inspect(recording: &Recording, vehicle: Option<&Vehicle>) -> Inspection {
    let doubts = doubts::doubts(recording, vehicle);
    let runs = (0..recording.runs.len()).map(|run| inspect_run(recording, run));
    let runs: Vec<RunReport> = runs.collect();
    let motion = runs
        .iter()
        .map(|run| run.motion)
        .fold(MotionSummary::default(), MotionSummary::and);
    Inspection {
        fitness: doubts::fitness(recording, &doubts),
        doubts,
        motion,
        channels: Channel::ALL
            .into_iter()
            .filter_map(|channel| inspect_channel(recording, channel))
            .collect(),
        delays: Pair::ALL
            .into_iter()
            .filter_map(|pair| Delay::of(&recording.runs, pair))
            .collect(),
        runs,
    }
}

fn inspect_run(recording: &Recording, index: usize) -> RunReport {
    let run = &recording.runs[index];
    let timing = |(channel, series)| Some((channel, Timing::of([series])?));
    RunReport {
        label: match recording.runs.len() {
            1 => run.label.clone(),
            _ => recording.label_of(index),
        },
        start: run.start(),
        motion: MotionSummary::of(run),
        timing: run.channels().filter_map(timing).collect(),
    }
}

fn inspect_channel(recording: &Recording, channel: Channel) -> Option<ChannelReport> {
    let [noise_at_rest, noise_in_motion] = Noise::of(&recording.runs, channel);
    Some(ChannelReport {
        channel,
        timing: Timing::of(recording.runs.iter().filter_map(|run| run.series(channel)))?,
        noise_at_rest,
        noise_in_motion,
    })
}

#[cfg(test)]
mod tests;
