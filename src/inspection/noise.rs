//! Scatter of samples about the line between their neighbours.

use super::{Interval, rest_spans};
use crate::recording::{Channel, Run, Series};

/// Fewer differences give no estimate.
const FEWEST: usize = 20;
/// Half width of the 90 % interval, times the root of the number of differences: 1.645 times
/// 1.17 of a standard deviation that is estimated by a median, and 1.4 because neighbouring
/// differences share samples.
const WIDTH: f64 = 1.645 * 1.17 * 1.4;
/// The standard deviation of a normal distribution by its median magnitude.
const PER_MEDIAN: f64 = 1.4826;

/// Standard deviation of white noise on a channel, in the channel's unit: from each sample's
/// difference to the line between its neighbours (a second difference), by the median, so that
/// outliers do not count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// The estimate with its 90 % interval; 0 where over half of the samples lie on the line, as
    /// values do that are held, or quantised coarsely: it then says nothing.
    pub deviation: Interval,
    /// Number of differences.
    pub count: usize,
}

impl Noise {
    /// Of a channel over all runs: at rest, and in motion.
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

    fn from_differences(mut sizes: Vec<f64>) -> Option<Self> {
        let count = sizes.len();
        if count < FEWEST {
            return None;
        }
        let (_, median, _) = sizes.select_nth_unstable_by(count / 2, f64::total_cmp);
        let value = PER_MEDIAN * *median;
        let width = WIDTH / (count as f64).sqrt();
        Some(Self {
            deviation: Interval {
                value,
                low: value * (1.0 - width).max(0.0),
                high: value * (1.0 + width),
            },
            count,
        })
    }
}

/// For each sample between two others: its time, theirs, and how far it is from the line
/// between them, as a share of white noise's standard deviation there.
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
