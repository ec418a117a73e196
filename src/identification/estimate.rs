//! Values with their intervals.

/// Resamples of a bootstrap: enough for a 5 % quantile that no longer moves visibly.
const RESAMPLES: usize = 500;
/// Seed of the bootstrap: equal data give equal intervals.
const SEED: u64 = 0x5eed;
/// With fewer blocks a bootstrap does not know how much they scatter.
pub(super) const FEWEST_BLOCKS: usize = 4;
/// Standard normal quantile of 95 %: bounds of a 90 % interval.
const NORMAL_95: f64 = 1.644_853_6;

/// A value with its 90 % interval, which is without bounds where the data are too few to tell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Lower bound of the interval.
    pub low: f64,
    /// Upper bound of the interval.
    pub high: f64,
}

impl Estimate {
    /// From a value and its standard error, errors being normal.
    #[must_use]
    pub fn normal(value: f64, standard_error: f64) -> Self {
        let reach = NORMAL_95 * standard_error;
        Self {
            value,
            low: value - reach,
            high: value + reach,
        }
    }

    /// A value of all data, with the bounds of the same statistic over resampled blocks
    /// (block bootstrap: what is within a block may depend on each other).
    pub fn bootstrap(blocks: usize, mut statistic: impl FnMut(&[usize]) -> f64) -> Self {
        let all: Vec<usize> = (0..blocks).collect();
        let value = statistic(&all);
        if blocks < FEWEST_BLOCKS {
            return Self::normal(value, f64::INFINITY);
        }
        let mut random = SplitMix(SEED);
        let mut drawn = vec![0; blocks];
        let mut values: Vec<f64> = (0..RESAMPLES)
            .map(|_| {
                drawn.fill_with(|| random.below(blocks));
                statistic(&drawn)
            })
            .collect();
        values.sort_by(f64::total_cmp);
        Self {
            value,
            low: quantile(&values, 0.05),
            high: quantile(&values, 0.95),
        }
    }

    /// Width of the interval.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.high - self.low
    }
}

/// Quantile of sorted values, linear between them; NaN without values.
pub(super) fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return f64::NAN;
    };
    let place = share * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// Median of values in any order; NaN without values.
pub(super) fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    quantile(values, 0.5)
}

/// The generator `SplitMix64` of Steele, Lea and Flood (2014): a few draws that are the same
/// everywhere.
struct SplitMix(u64);

impl SplitMix {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A whole number below a bound; the bias at bounds far below 2^64 does not matter.
    fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound as u64) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_linear_between_the_values() {
        let sorted = [1.0, 2.0, 4.0, 8.0];
        for (share, expected) in [(0.0, 1.0), (0.5, 3.0), (0.95, 7.4), (1.0, 8.0)] {
            assert!(
                (quantile(&sorted, share) - expected).abs() < 1e-12,
                "{share}"
            );
        }
        assert_eq!(quantile(&[3.0], 0.95), 3.0);
        assert!(quantile(&[], 0.5).is_nan());
        assert_eq!(median(&mut [5.0, 1.0, 2.0]), 2.0);
    }

    #[test]
    fn bootstrap_of_a_mean_has_its_standard_error() {
        let values: Vec<f64> = (0..400).map(|k| f64::from(k % 20)).collect();
        let mean =
            |drawn: &[usize]| drawn.iter().map(|k| values[*k]).sum::<f64>() / drawn.len() as f64;
        let estimate = Estimate::bootstrap(values.len(), mean);
        assert_eq!(estimate.value, 9.5);
        // Standard deviation 5.766, so the interval is 2 * 1.645 * 0.2883 wide.
        assert!((estimate.width() - 0.9485).abs() < 0.1, "{estimate:?}");
        assert_eq!(estimate, Estimate::bootstrap(values.len(), mean));
    }

    #[test]
    fn too_few_blocks_give_no_bounds() {
        let estimate = Estimate::bootstrap(3, |drawn| drawn.len() as f64);
        assert_eq!((estimate.value, estimate.width()), (3.0, f64::INFINITY));
    }

    #[test]
    fn generator_gives_its_published_numbers() {
        let mut random = SplitMix(1_234_567);
        assert_eq!(random.next(), 6_457_827_717_110_365_317);
        assert_eq!(random.next(), 3_203_168_211_198_807_973);
    }
}
