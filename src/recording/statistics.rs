//! Statistics of samples: moments of pairs, quantiles, bootstrap intervals.

/// Resamples of a bootstrap: with more, the 5 % quantile no longer moves visibly.
const RESAMPLES: usize = 500;
/// Seed of the bootstrap: equal data give equal intervals.
const SEED: u64 = 0x5eed;
/// Fewer blocks do not show how much they scatter.
pub(crate) const MIN_BLOCKS: usize = 4;
/// Standard normal quantile of 95 %: bounds of a 90 % interval.
const NORMAL_95: f64 = 1.644_853_6;

/// An estimate with its 90 % confidence interval, which is infinite if the data are too few.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IntervalEstimate {
    /// The estimate.
    pub value: f64,
    /// Lower bound of the interval.
    pub low: f64,
    /// Upper bound of the interval.
    pub high: f64,
}

impl IntervalEstimate {
    /// From a value and its standard error, for normal errors.
    #[must_use]
    pub fn normal(value: f64, standard_error: f64) -> Self {
        let reach = NORMAL_95 * standard_error;
        Self {
            value,
            low: value - reach,
            high: value + reach,
        }
    }

    /// From a statistic of all blocks and of resampled blocks. The block bootstrap allows for dependence within a block.
    pub fn bootstrap(blocks: usize, mut statistic: impl FnMut(&[usize]) -> f64) -> Self {
        let all: Vec<usize> = (0..blocks).collect();
        let value = statistic(&all);
        if blocks < MIN_BLOCKS {
            return Self::normal(value, f64::INFINITY);
        }
        let mut random = SplitMix64(SEED);
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

    /// Around an estimate, from the estimates of resampled data; the interval includes the estimate.
    #[must_use]
    pub fn from_resampled(value: f64, mut resampled: Vec<f64>) -> Self {
        resampled.sort_by(f64::total_cmp);
        let bound = |share| nearest_rank(&resampled, share).unwrap_or(value);
        Self {
            value,
            low: bound(0.05).min(value),
            high: bound(0.95).max(value),
        }
    }

    /// Width of the interval.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.high - self.low
    }
}

/// Quantile of sorted values, linear between them; NaN without values.
#[must_use]
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return f64::NAN;
    };
    let place = share * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// The sorted value nearest to a quantile; `None` without values.
#[must_use]
pub fn nearest_rank(sorted: &[f64], share: f64) -> Option<f64> {
    let rank = share * (sorted.len() as f64 - 1.0);
    sorted.get(rank.round() as usize).copied()
}

/// Median of values in any order; NaN without values.
#[must_use]
pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    quantile(values, 0.5)
}

/// The larger of the two values in the middle; `None` without values.
#[must_use]
pub fn upper_median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    let some = !values.is_empty();
    some.then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Minimum and maximum; (inf, -inf) without values.
#[must_use]
pub fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[min, max], value| {
        [value.min(min), value.max(max)]
    })
}

/// The generator `SplitMix64` of Steele, Lea and Flood (2014), with the same draws on every platform.
pub struct SplitMix64(pub u64);

impl SplitMix64 {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A whole number below a bound; the bias is negligible for bounds far below 2^64.
    pub fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound as u64) as usize
    }
}

/// Number, sums and sums of products of pairs (a, b).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moments {
    /// Number of pairs.
    pub count: f64,
    a: f64,
    b: f64,
    aa: f64,
    bb: f64,
    ab: f64,
}

impl Moments {
    /// Adds a pair.
    pub fn push(&mut self, a: f64, b: f64) {
        self.count += 1.0;
        self.a += a;
        self.b += b;
        self.aa += a * a;
        self.bb += b * b;
        self.ab += a * b;
    }

    /// From the known pairs (a delayed by `shift` grid steps, b); `indices` are those of b.
    #[must_use]
    pub fn shifted(
        a: &[Option<f64>],
        b: &[Option<f64>],
        shift: isize,
        indices: std::ops::Range<usize>,
    ) -> Self {
        let mut moments = Self::default();
        for index in indices {
            let later = index.checked_add_signed(shift).and_then(|at| *a.get(at)?);
            if let (Some(a), Some(b)) = (later, b[index]) {
                moments.push(a, b);
            }
        }
        moments
    }

    /// The moments of both sets of pairs.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            a: self.a + other.a,
            b: self.b + other.b,
            aa: self.aa + other.aa,
            bb: self.bb + other.bb,
            ab: self.ab + other.ab,
        }
    }

    /// The moments about the means, so that a sum over several sets compares only the variation within each set.
    #[must_use]
    pub fn centred(self) -> Self {
        let count = self.count.max(1.0);
        Self {
            count: self.count,
            a: 0.0,
            b: 0.0,
            aa: (self.aa - self.a * self.a / count).max(0.0),
            bb: (self.bb - self.b * self.b / count).max(0.0),
            ab: self.ab - self.a * self.b / count,
        }
    }

    /// Pearson's correlation; 0 if a or b does not vary.
    #[must_use]
    pub fn correlation(self) -> f64 {
        let Self { aa, bb, ab, .. } = self.centred();
        let scale = (aa * bb).sqrt();
        // The variance of a constant is rounding.
        let varies = aa > 1e-12 * self.aa && bb > 1e-12 * self.bb && scale > 0.0;
        if varies { ab / scale } else { 0.0 }
    }

    /// Slope of a over b; 0 if b does not vary.
    #[must_use]
    pub fn slope(self) -> f64 {
        let Self { bb, ab, .. } = self.centred();
        if bb > 0.0 { ab / bb } else { 0.0 }
    }

    /// Slope of a over b through the origin; 0 if b is 0.
    #[must_use]
    pub fn proportion(self) -> f64 {
        if self.bb > 0.0 {
            self.ab / self.bb
        } else {
            0.0
        }
    }

    /// Standard deviations of a and b.
    #[must_use]
    pub fn deviations(self) -> (f64, f64) {
        let Self { count, aa, bb, .. } = self.centred();
        let count = count.max(1.0);
        ((aa / count).sqrt(), (bb / count).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_is_recovered() {
        let b: Vec<Option<f64>> = (0..50).map(|k| Some((0.3 * f64::from(k)).sin())).collect();
        let a: Vec<Option<f64>> = (0..50)
            .map(|k| (k > 2).then(|| 4.0 - 3.0 * (0.3 * f64::from(k - 3)).sin()))
            .collect();
        let moments = Moments::shifted(&a, &b, 3, 0..50);
        assert_eq!(moments.count, 47.0);
        assert!((moments.slope() + 3.0).abs() < 1e-12);
        assert!((moments.correlation() + 1.0).abs() < 1e-12);
        let through_origin = (4.0 * moments.b - 3.0 * moments.bb) / moments.bb;
        assert!((moments.proportion() - through_origin).abs() < 1e-12);
        let (da, db) = moments.deviations();
        assert!((da - 3.0 * db).abs() < 1e-12);
        let twice = moments.centred().and(moments.centred());
        assert!((twice.slope() + 3.0).abs() < 1e-12);
    }

    #[test]
    fn constants_do_not_correlate() {
        let mut moments = Moments::default();
        for k in 0..9 {
            moments.push(0.1, f64::from(k));
        }
        assert_eq!(moments.correlation(), 0.0);
        assert_eq!(Moments::default().correlation(), 0.0);
    }

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
        let estimate = IntervalEstimate::bootstrap(values.len(), mean);
        assert_eq!(estimate.value, 9.5);
        // Standard deviation 5.766, so the interval is 2 * 1.645 * 0.2883 wide.
        assert!((estimate.width() - 0.9485).abs() < 0.1, "{estimate:?}");
        assert_eq!(estimate, IntervalEstimate::bootstrap(values.len(), mean));
    }

    #[test]
    fn too_few_blocks_give_no_bounds() {
        let estimate = IntervalEstimate::bootstrap(3, |drawn| drawn.len() as f64);
        assert_eq!((estimate.value, estimate.width()), (3.0, f64::INFINITY));
    }

    #[test]
    fn generator_gives_its_published_numbers() {
        let mut random = SplitMix64(1_234_567);
        assert_eq!(random.next(), 6_457_827_717_110_365_317);
        assert_eq!(random.next(), 3_203_168_211_198_807_973);
    }
}
