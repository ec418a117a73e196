//! Scatter of samples about the line between their neighbours.

use super::motion::rest_spans;
use crate::recording::{Channel, IntervalEstimate, Run, Series, upper_median};

/// Minimum number of differences.
const MIN_DIFFERENCES: usize = 20;
/// Half width of the 90 % interval times the root of the number of differences. The factors: 1.645 for 90 %, 1.17 for a
/// standard deviation from a median, 1.4 because neighbouring differences share samples.
const WIDTH: f64 = 1.645 * 1.17 * 1.4;
/// Standard deviation of a normal distribution over its median magnitude.
const PER_MEDIAN: f64 = 1.4826;

/// Standard deviation of white noise on a channel, in the channel's unit. It is the median difference of the samples from
/// the line between their neighbours (second differences), which is robust against outliers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// The estimate with its 90 % interval. It is 0, without meaning, if over half of the samples lie on the line: values that
    /// are held, or coarsely quantised.
    pub deviation: IntervalEstimate,
    /// Number of differences.
    pub count: usize,
}

impl Noise {
    /// Noise of a channel over all runs: at rest, and in motion.
    #[must_use]
    pub fn of(runs: &[Run], channel: Channel) -> [Option<Self>; 2] {
        let (mut still, mut moving) = (Vec::new(), Vec::new());
        for run in runs {
            let Some(series) = run.series(channel) else {
                continue;
            };
            let spans = rest_spans(run);
            for (middle, [from, to], size) in differences(series) {
                let next = spans.partition_point(|(_, end)| *end < middle);
                match spans.get(next).filter(|(start, _)| *start <= middle) {
                    None => moving.push(size),
                    Some((start, end)) if *start <= from && to <= *end => still.push(size),
                    Some(_) => {}
                }
            }
        }
        [still, moving].map(Self::from_differences)
    }

    fn from_differences(sizes: Vec<f64>) -> Option<Self> {
        let count = sizes.len();
        if count < MIN_DIFFERENCES {
            return None;
        }
        let value = PER_MEDIAN * upper_median(sizes)?;
        let width = WIDTH / (count as f64).sqrt();
        Some(Self {
            deviation: IntervalEstimate {
                value,
                low: value * (1.0 - width).max(0.0),
                high: value * (1.0 + width),
            },
            count,
        })
    }
}

/// For each sample between two others: its time, their times, and its distance from the line between them, divided by the
/// standard deviation of that distance for white noise of deviation 1.
fn differences(series: &Series) -> impl Iterator<Item = (f64, [f64; 2], f64)> + '_ {
    let time = &series.time;
    let value = &series.value;
    (1..series.len().saturating_sub(1)).map(move |middle| {
        let (from, to) = (time[middle - 1], time[middle + 1]);
        let share = (time[middle] - from) / (to - from);
        let line = value[middle - 1] + share * (value[middle + 1] - value[middle - 1]);
        let spread = (1.0 + share * share + (1.0 - share) * (1.0 - share)).sqrt();
        (
            time[middle],
            [from, to],
            (value[middle] - line).abs() / spread,
        )
    })
}
