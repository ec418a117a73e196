//! The samples of one channel.

use super::statistics::upper_median;

/// Samples over time, without the missing ones. Times increase strictly: [`Series::check`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Time of each sample \[s\].
    pub time: Vec<f64>,
    /// Value of each sample, in the channel's unit.
    pub value: Vec<f64>,
}

impl Series {
    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether there is no sample.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Time of the first sample \[s\].
    #[must_use]
    pub fn start(&self) -> Option<f64> {
        self.time.first().copied()
    }

    /// Time of the last sample \[s\].
    #[must_use]
    pub fn end(&self) -> Option<f64> {
        self.time.last().copied()
    }

    /// From the first sample to the last \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        match (self.start(), self.end()) {
            (Some(start), Some(end)) => end - start,
            _ => 0.0,
        }
    }

    /// The value at a time \[s\], linear between samples; `None` before the first and after the last.
    #[must_use]
    pub fn at(&self, time: f64) -> Option<f64> {
        let after = self.time.partition_point(|sample| *sample <= time);
        match (after.checked_sub(1), self.time.get(after)) {
            (Some(before), Some(next)) => {
                let (from, to) = (self.value[before], self.value[after]);
                let share = (time - self.time[before]) / (next - self.time[before]);
                Some(from + share * (to - from))
            }
            (Some(last), None) if self.time[last] == time => Some(self.value[last]),
            _ => None,
        }
    }

    /// Seconds from each sample to the next.
    pub fn intervals(&self) -> impl Iterator<Item = f64> + '_ {
        self.time.windows(2).map(|pair| pair[1] - pair[0])
    }

    /// Median of the intervals \[s\]; `None` with fewer than two samples.
    #[must_use]
    pub fn median_interval(&self) -> Option<f64> {
        upper_median(self.intervals().collect())
    }

    /// The largest interval: its start and its length \[s\].
    #[must_use]
    pub fn largest_gap(&self) -> Option<(f64, f64)> {
        let gaps = self.time.iter().copied().zip(self.intervals());
        gaps.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Intervals longer than this \[s\], from a sample to the next.
    pub fn gaps(&self, longest: f64) -> impl Iterator<Item = [f64; 2]> + '_ {
        let pairs = self.time.windows(2).map(|pair| [pair[0], pair[1]]);
        pairs.filter(move |[from, to]| to - from > longest)
    }

    /// A weighted sum of two series, at the times of the first at which the second is known.
    #[must_use]
    pub fn weighted_sum([a, b]: [&Self; 2], weights: [f64; 2]) -> Self {
        a.samples()
            .filter_map(|(time, value)| Some((time, weights[0] * value + weights[1] * b.at(time)?)))
            .collect()
    }

    /// Samples as pairs of time and value.
    pub fn samples(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.time.iter().copied().zip(self.value.iter().copied())
    }
}

impl FromIterator<(f64, f64)> for Series {
    fn from_iter<I: IntoIterator<Item = (f64, f64)>>(samples: I) -> Self {
        let (time, value) = samples.into_iter().unzip();
        Self { time, value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Series {
        [(1.0, 10.0), (2.0, 20.0), (4.0, 0.0)].into_iter().collect()
    }

    #[test]
    fn values_between_samples_are_linear_and_there_are_none_outside() {
        let series = ramp();
        for (time, value) in [
            (1.0, 10.0),
            (1.5, 15.0),
            (2.0, 20.0),
            (3.0, 10.0),
            (4.0, 0.0),
        ] {
            assert_eq!(series.at(time), Some(value), "{time}");
        }
        for time in [0.999, 4.001, f64::NAN] {
            assert_eq!(series.at(time), None, "{time}");
        }
        assert_eq!(Series::default().at(0.0), None);
    }

    #[test]
    fn intervals_are_summed_up() {
        let series = ramp();
        assert_eq!((series.start(), series.end()), (Some(1.0), Some(4.0)));
        assert_eq!((series.len(), series.duration()), (3, 3.0));
        assert_eq!(series.median_interval(), Some(2.0));
        assert_eq!(series.largest_gap(), Some((2.0, 2.0)));
        let one: Series = [(1.0, 2.0)].into_iter().collect();
        assert_eq!((one.median_interval(), one.largest_gap()), (None, None));
        assert_eq!(one.at(1.0), Some(2.0));
    }
}
