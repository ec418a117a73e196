//! Mean rates over windows, which make sensors of different rates and noise comparable. A pose is never differentiated
//! from sample to sample; a rate is integrated first.

use super::series::Series;

/// An interval is a gap if it exceeds both this multiple of the median interval and this duration \[s\].
const GAP: (f64, f64) = (5.0, 0.6);

/// The longest interval that is not a gap \[s\].
#[must_use]
pub fn longest_interval(series: &Series) -> f64 {
    let median = series.median_interval().unwrap_or(0.0);
    (GAP.0 * median).max(GAP.1)
}

/// First and last time \[s\] of each stretch without a gap.
#[must_use]
pub fn stretches(series: &Series) -> Vec<[f64; 2]> {
    let limit = longest_interval(series);
    let whole = series.time.chunk_by(|a, b| b - a <= limit);
    whole
        .map(|times| [times[0], times[times.len() - 1]])
        .collect()
}

/// A quantity that has accumulated over time: a position, an angle, or the integral of a rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Cumulated {
    time: Vec<f64>,
    sum: Vec<f64>,
    /// Total duration of the gaps before each sample \[s\].
    gaps: Vec<f64>,
}

impl Cumulated {
    /// A position or an angle, as sampled.
    #[must_use]
    pub fn of_position(series: &Series) -> Self {
        let limit = longest_interval(series);
        let mut total = 0.0;
        let gaps = series.intervals().map(|interval| {
            total += if interval > limit { interval } else { 0.0 };
            total
        });
        Self {
            gaps: std::iter::once(0.0).chain(gaps).collect(),
            time: series.time.clone(),
            sum: series.value.clone(),
        }
    }

    /// The integral of a rate, linear between its samples.
    #[must_use]
    pub fn of_rate(series: &Series) -> Self {
        let mut total = 0.0;
        let pairs = series.value.windows(2).zip(series.intervals());
        let sums = pairs.map(|(pair, interval)| {
            total += interval * (pair[0] + pair[1]) / 2.0;
            total
        });
        Self {
            sum: std::iter::once(0.0)
                .chain(sums)
                .take(series.len())
                .collect(),
            ..Self::of_position(series)
        }
    }

    /// First and last time \[s\].
    #[must_use]
    pub fn span(&self) -> Option<(f64, f64)> {
        Some((*self.time.first()?, *self.time.last()?))
    }

    /// Intervals without samples that are longer than a hole \[s\], including those before the first sample and after the
    /// last.
    fn silences(&self) -> Vec<[f64; 2]> {
        let pairs = self.time.windows(2).zip(self.gaps.windows(2));
        let long = pairs.filter(|(time, gaps)| time[1] - time[0] > HOLE.0 && gaps[1] > gaps[0]);
        let between = long.map(|(time, _)| [time[0], time[1]]);
        let ends = self.span().into_iter();
        let before = ends.clone().map(|(start, _)| [f64::NEG_INFINITY, start]);
        let after = ends.map(|(_, end)| [end, f64::INFINITY]);
        before.chain(between).chain(after).collect()
    }

    /// Sum and gaps up to a time.
    fn at(&self, time: f64) -> Option<(f64, f64)> {
        let after = self.time.partition_point(|sample| *sample <= time);
        let before = after.checked_sub(1)?;
        let Some(next) = self.time.get(after) else {
            return (self.time[before] == time).then(|| (self.sum[before], self.gaps[before]));
        };
        let share = (time - self.time[before]) / (next - self.time[before]);
        let between = |values: &[f64]| values[before] + share * (values[after] - values[before]);
        Some((between(&self.sum), between(&self.gaps)))
    }

    /// Mean rate over a window \[1/s\]; `None` if the window reaches beyond the samples or overlaps a gap.
    #[must_use]
    pub fn mean_rate(&self, centre: f64, window: f64) -> Option<f64> {
        let (from, gaps_before) = self.at(centre - window / 2.0)?;
        let (to, gaps_after) = self.at(centre + window / 2.0)?;
        (gaps_after <= gaps_before).then(|| (to - from) / window)
    }

    /// Mean rates over windows around times on a grid.
    #[must_use]
    pub fn mean_rates(&self, grid: &TimeGrid, window: f64) -> Vec<Option<f64>> {
        let rate = |index| self.mean_rate(grid.time(index), window);
        (0..grid.count).map(rate).collect()
    }
}

/// Step in which delays between sensors are compared \[s\], and the delays that sensors have, in such steps.
pub(crate) const DELAY_STEP: f64 = 0.05;
pub(crate) const SENSOR_DELAYS: std::ops::RangeInclusive<isize> = -12..=20;

/// Equidistant times that skip long holes.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeGrid {
    /// First time \[s\].
    pub start: f64,
    /// Step from one time to the next \[s\].
    pub step: f64,
    /// Number of times.
    pub count: usize,
    /// From this index on, this many steps are skipped.
    skipped: Vec<(usize, f64)>,
}

/// Times beyond this number are ignored.
const MAX_TIMES: f64 = 4e6;
/// Common holes longer than the first value \[s\] are skipped, except for the second value at either end. That margin is
/// longer than windows and delays. So a night between two drives costs nothing and does not thin out the blocks that are
/// compared.
const HOLE: (f64, f64) = (60.0, 10.0);

impl TimeGrid {
    /// From the earlier start to the later end of both, in steps of `step` seconds.
    #[must_use]
    pub fn over(a: &Cumulated, b: &Cumulated, step: f64) -> Option<Self> {
        let ((a_start, a_end), (b_start, b_end)) = (a.span()?, b.span()?);
        let (start, end) = (a_start.min(b_start), a_end.max(b_end));
        let mut total = 0.0;
        let mut skipped = Vec::new();
        for [from, to] in shared(&a.silences(), &b.silences()) {
            let first = ((from + HOLE.1 - start) / step).ceil();
            let next = ((to - HOLE.1 - start) / step).floor();
            // A clock that is not in seconds yet can have steps as long as the hole.
            if next > first {
                let index = (first - total) as usize;
                total += next - first;
                skipped.push((index, total));
            }
        }
        let steps = ((end - start) / step).floor() - total;
        let count = steps.min(MAX_TIMES) as usize + 1;
        Some(Self {
            start,
            step,
            count,
            skipped,
        })
    }

    /// A time of the grid \[s\].
    #[must_use]
    pub fn time(&self, index: usize) -> f64 {
        let holes = self.skipped.partition_point(|(first, _)| *first <= index);
        let skipped = holes
            .checked_sub(1)
            .map_or(0.0, |last| self.skipped[last].1);
        self.start + (index as f64 + skipped) * self.step
    }
}

/// Intersections of two ordered lists of intervals that are longer than a hole.
fn shared(a: &[[f64; 2]], b: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut both = Vec::new();
    let (mut i, mut j) = (0, 0);
    while let (Some(one), Some(other)) = (a.get(i), b.get(j)) {
        let (from, to) = (one[0].max(other[0]), one[1].min(other[1]));
        if to - from > HOLE.0 && from.is_finite() && to.is_finite() {
            both.push([from, to]);
        }
        if one[1] < other[1] {
            i += 1;
        } else {
            j += 1;
        }
    }
    both
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_means_over_windows() {
        let rate: Series = (0..=10)
            .map(|k| (0.1 * f64::from(k), 2.0 * f64::from(k)))
            .collect();
        let sum = Cumulated::of_rate(&rate);
        // A rate of 20 t: its mean is that at the middle.
        for centre in [0.3, 0.55] {
            let mean = sum.mean_rate(centre, 0.2).unwrap();
            assert!((mean - 20.0 * centre).abs() < 1e-9, "{centre}: {mean}");
        }
        assert_eq!(sum.mean_rate(0.05, 0.2), None);
        assert_eq!(sum.mean_rate(0.95, 0.2), None);
        let position: Series = [(0.0, 1.0), (1.0, 3.0), (2.0, 3.0)].into_iter().collect();
        assert_eq!(
            Cumulated::of_position(&position).mean_rate(1.0, 1.0),
            Some(1.0)
        );
        assert_eq!(Cumulated::of_rate(&Series::default()).span(), None);
    }

    #[test]
    fn gaps_give_no_rate() {
        let times = (0..20).chain(60..80).map(|k| 0.1 * f64::from(k));
        let sum = Cumulated::of_rate(&times.map(|time| (time, 1.0)).collect());
        assert_eq!(sum.mean_rate(1.95, 0.2), None);
        assert_eq!(sum.mean_rate(4.0, 0.2), None);
        assert!(sum.mean_rate(1.5, 0.5).is_some() && sum.mean_rate(7.0, 0.5).is_some());
    }

    #[test]
    fn long_common_holes_are_skipped_by_the_grid() {
        let hole = 1e6;
        let of = |start: f64, count: i32| {
            let times = (0..count).map(move |k| start + 0.1 * f64::from(k));
            times.chain((0..300).map(move |k| start + hole + 0.1 * f64::from(k)))
        };
        let sum = |times: &mut dyn Iterator<Item = f64>| {
            Cumulated::of_rate(&times.map(|time| (time, 1.0)).collect())
        };
        let (a, b) = (sum(&mut of(5.0, 300)), sum(&mut of(7.0, 600)));
        let grid = TimeGrid::over(&a, &b, 0.02).unwrap();
        let times: Vec<f64> = (0..grid.count).map(|index| grid.time(index)).collect();
        let jumps: Vec<_> = times
            .windows(2)
            .filter(|pair| pair[1] - pair[0] > 0.021)
            .collect();
        // The samples of b end at 66.9 s; a continues first.
        assert_eq!(jumps.len(), 1);
        assert!(
            (jumps[0][0] - 76.9).abs() < 0.1 && (jumps[0][1] - (5.0 + hole - 10.0)).abs() < 0.1,
            "{jumps:?}"
        );
        assert_eq!(times[0], 5.0);
        assert!((times[times.len() - 1] - (7.0 + hole + 29.9)).abs() < 0.1);
        let known = |sum: &Cumulated| sum.mean_rates(&grid, 0.5).iter().flatten().count();
        // All but the edges of what was sampled.
        assert!(
            (known(&a) as f64 - 2.0 * 29.4 * 50.0).abs() < 5.0,
            "{}",
            known(&a)
        );
        assert!(
            (known(&b) as f64 - (59.4 + 29.4) * 50.0).abs() < 5.0,
            "{}",
            known(&b)
        );
        // A clock in nanoseconds before its conversion, and a hole of more steps than can be counted.
        let nanoseconds = |offset: f64, from: f64, to: f64| {
            let times = (0..600).map(move |k| offset + 5e7 * f64::from(k));
            sum(&mut times.filter(move |time| *time <= from || *time >= to))
        };
        let (a, b) = (
            nanoseconds(0.0, 1e10, 1.1e10),
            nanoseconds(2e7, 1.097e10, 1.202e10),
        );
        let grid = TimeGrid::over(&a, &b, 5e7).unwrap();
        assert!((grid.time(grid.count - 1) - (599.0 * 5e7 + 2e7)).abs() <= 5e7);
        let far = sum(&mut (0..70)
            .map(|k| 0.1 * f64::from(k))
            .chain((0..50).map(|k| 1e19 + 4096.0 * f64::from(k))));
        let grid = TimeGrid::over(&far, &far, 0.1).unwrap();
        assert!(grid.time(grid.count - 1) >= 1e19);
        // Shorter holes stay, and so do those of one quantity alone.
        let whole = sum(&mut (0..1000).map(|k| 0.1 * f64::from(k)));
        let cut = sum(&mut of(0.0, 300).filter(|time| *time < 100.0).chain([99.9]));
        let grid = TimeGrid::over(&whole, &cut, 0.1).unwrap();
        assert!((0..grid.count).all(|index| grid.time(index) == index as f64 * 0.1));
    }
}
