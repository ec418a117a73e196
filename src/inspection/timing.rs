//! Sampling times.

use crate::recording::{Series, nearest_rank};

/// An interval longer than this multiple of the median one is a gap.
const GAP: f64 = 3.0;

/// Number and intervals of a channel's samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Number of samples.
    pub samples: usize,
    /// Median interval between samples \[s\].
    pub interval: f64,
    /// 5 % and 95 % quantiles of the intervals, whose spread is the jitter \[s\].
    pub usual: (f64, f64),
    /// The longest interval \[s\].
    pub longest: f64,
    /// Start of the longest interval \[s\], and index of its series.
    pub longest_at: (f64, usize),
    /// Share of the time in gaps: intervals longer than three median ones.
    pub in_gaps: f64,
}

impl Timing {
    /// From one channel in several runs; `None` with fewer than two samples in each.
    #[must_use]
    pub fn of<'a>(runs: impl IntoIterator<Item = &'a Series>) -> Option<Self> {
        let mut samples = 0;
        let mut intervals = Vec::new();
        let mut longest = (f64::NEG_INFINITY, (0.0, 0));
        for (index, series) in runs.into_iter().enumerate() {
            samples += series.len();
            intervals.extend(series.intervals());
            if let Some((at, length)) = series.largest_gap()
                && length > longest.0
            {
                longest = (length, (at, index));
            }
        }
        intervals.sort_by(f64::total_cmp);
        let total: f64 = intervals.iter().sum();
        let quantile = |share| nearest_rank(&intervals, share);
        let interval = quantile(0.5)?;
        let gaps = intervals.iter().filter(|length| **length > GAP * interval);
        // A sum of nothing is -0.
        let in_gaps = 0.0 + gaps.sum::<f64>() / total;
        Some(Self {
            samples,
            interval,
            usual: (quantile(0.05)?, quantile(0.95)?),
            longest: longest.0,
            longest_at: longest.1,
            in_gaps,
        })
    }

    /// Samples per second, by the median interval \[Hz\].
    #[must_use]
    pub fn rate(&self) -> f64 {
        1.0 / self.interval
    }
}
