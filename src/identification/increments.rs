//! Changes of two quantities over the same second, one of them read late.

use super::Estimate;
use crate::recording::{Series, stretches};

/// Length of an increment \[s\]: long against the sensors' intervals, short against a turn.
const LENGTH: f64 = 1.0;
/// Seconds from one increment to the next.
const SPACING: f64 = 0.1;
/// Seconds over which increments count as dependent.
const BLOCK: f64 = 2.0;
/// Changes of the reference that are smaller (RMS) tell nothing \[rad\].
const LEAST_CHANGE: f64 = 0.05;
/// The lag is told where the worst one costs so many times as much as the best.
const TELLING: f64 = 2.0;

/// Changes of a reference and of a series that trails it, at several lags.
pub(super) struct Increments {
    /// The lags \[s\].
    lags: Vec<f64>,
    /// Per block and lag the pairs of changes: reference, trailing series.
    blocks: Vec<Vec<Vec<(f64, f64)>>>,
}

/// What a block adds to a cost at one lag.
pub(super) trait Cost {
    /// Sums over pairs of changes.
    type Sums: Copy;
    /// The sums of a block's pairs.
    fn sums(&self, pairs: &[(f64, f64)]) -> Self::Sums;
    /// The cost of several blocks together.
    fn total(&self, blocks: impl Iterator<Item = Self::Sums>) -> f64;
}

impl Increments {
    /// The changes at lags on a grid. At every lag the same ones, so that costs compare.
    pub fn over_lags<'a>(
        pairs: impl Iterator<Item = (&'a Series, &'a Series)>,
        lags: Vec<f64>,
    ) -> Self {
        let (least, most) = (lags[0], lags[lags.len() - 1]);
        let mut blocks = Vec::new();
        for (reference, trailing) in pairs {
            let times = common_times(reference, trailing, least, most);
            let in_block = |time: &f64| (time / BLOCK).floor();
            for times in times.chunk_by(|a, b| in_block(a) == in_block(b)) {
                let at = |lag: &f64| changes(reference, trailing, times, *lag);
                blocks.push(lags.iter().map(at).collect());
            }
        }
        Self { lags, blocks }
    }

    /// All pairs of changes, at all lags.
    pub fn pairs(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.blocks.iter().flatten().flatten().copied()
    }

    /// The pairs of changes at one lag.
    pub fn at_lag<'a>(
        pairs: impl Iterator<Item = (&'a Series, &'a Series)>,
        lag: f64,
    ) -> Vec<(f64, f64)> {
        let all = Self::over_lags(pairs, vec![lag]);
        all.blocks.into_iter().flatten().flatten().collect()
    }

    /// The lag of the least cost, with the interval of a bootstrap over blocks; `None` where
    /// little changes or all lags cost about the same.
    pub fn best_lag<C: Cost>(&self, cost: &C) -> Option<Estimate> {
        let changes = || {
            self.blocks
                .iter()
                .flat_map(|lags| &lags[0])
                .map(|pair| pair.0)
        };
        let squares: f64 = changes().map(|change| change * change).sum();
        let change = (squares / changes().count() as f64).sqrt();
        // Without any pair it is not a number.
        if change.is_nan() || change < LEAST_CHANGE {
            return None;
        }
        let sums = |block: &Vec<Vec<(f64, f64)>>| -> Vec<C::Sums> {
            block.iter().map(|pairs| cost.sums(pairs)).collect()
        };
        let sums: Vec<Vec<C::Sums>> = self.blocks.iter().map(sums).collect();
        let costs = |drawn: &[usize]| -> Vec<f64> {
            let at = |lag: usize| cost.total(drawn.iter().map(|block| sums[*block][lag]));
            (0..self.lags.len()).map(at).collect()
        };
        let all: Vec<usize> = (0..sums.len()).collect();
        let (least, most) = costs(&all)
            .into_iter()
            .fold((f64::INFINITY, 0.0_f64), |(l, m), cost| {
                (cost.min(l), cost.max(m))
            });
        if most < TELLING * least {
            return None;
        }
        let best = |drawn: &[usize]| {
            let costs = costs(drawn).into_iter().enumerate();
            let least = costs.min_by(|a, b| a.1.total_cmp(&b.1));
            least.map_or(f64::NAN, |(lag, _)| self.lags[lag])
        };
        Some(Estimate::bootstrap(sums.len(), best))
    }
}

/// Times at which changes of both are known at every lag from the least to the most. What lies between two samples
/// far apart is not known.
fn common_times(reference: &Series, trailing: &Series, least: f64, most: f64) -> Vec<f64> {
    let (own, late) = (stretches(reference), stretches(trailing));
    let mut times = Vec::new();
    let mut next = 0;
    for [start, end] in own {
        // Those that end before this one begins end before all that follow.
        next += late[next..].partition_point(|[_, late_end]| late_end - most < start);
        for [late_start, late_end] in &late[next..] {
            let first = start.max(late_start - least);
            if first > end {
                break;
            }
            let last = end.min(late_end - most) - LENGTH;
            let count = ((last - first) / SPACING).floor();
            let steps = (0..=count as i64).take_while(|_| count >= 0.0);
            times.extend(steps.map(|k| first + SPACING * k as f64));
        }
    }
    times
}

fn changes(reference: &Series, trailing: &Series, times: &[f64], lag: f64) -> Vec<(f64, f64)> {
    let change = |series: &Series, time: f64| Some(series.at(time + LENGTH)? - series.at(time)?);
    let pair = |time: &f64| Some((change(reference, *time)?, change(trailing, *time + lag)?));
    times.iter().filter_map(pair).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_known_between_samples_far_apart() {
        // Ten seconds at 20 Hz, and as much again after the clock was set.
        let turning = |late: f64, pause: f64| -> Series {
            let sample = |k: i32| {
                let time = 0.05 * f64::from(k % 200) + f64::from(k / 200) * pause;
                (time, (time - late).sin())
            };
            (0..400).map(sample).collect()
        };
        for pause in [20.0, 1.7e9] {
            let (reference, trailing) = (turning(0.0, pause), turning(0.3, pause));
            let times = common_times(&reference, &trailing, -0.5, 0.5);
            assert!((150..180).contains(&times.len()), "{}", times.len());
            let within = |time: &f64| (0.0..10.0).contains(&(time % pause));
            assert!(times.iter().all(within));
            assert!(times.is_sorted());
        }
        // Lags may overlap two stretches, times never twice.
        let gaps = turning(0.0, 10.7);
        let times = common_times(&gaps, &gaps, -1.0, 1.0);
        assert!(
            times
                .windows(2)
                .all(|pair| pair[1] - pair[0] > 0.5 * SPACING)
        );
    }
}
