//! Estimates with their intervals.

/// An estimate and the interval that holds the truth in nine of ten cases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The estimate.
    pub value: f64,
    /// Lower end of the 90 % interval.
    pub low: f64,
    /// Upper end of the 90 % interval.
    pub high: f64,
}

impl Interval {
    /// Around an estimate, from those of resampled data.
    #[must_use]
    pub fn from_resampled(value: f64, mut resampled: Vec<f64>) -> Self {
        resampled.sort_by(f64::total_cmp);
        let quantile = |share: f64| {
            let index = share * (resampled.len() as f64 - 1.0);
            resampled
                .get(index.round() as usize)
                .copied()
                .unwrap_or(value)
        };
        Self {
            value,
            low: quantile(0.05).min(value),
            high: quantile(0.95).max(value),
        }
    }

    /// From the lower end to the upper.
    #[must_use]
    pub fn width(self) -> f64 {
        self.high - self.low
    }
}

/// How often each of so many blocks is drawn, in so many draws with replacement; the same ones
/// in every call (splitmix64).
pub(super) fn draws(blocks: usize, count: usize) -> Vec<Vec<u32>> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    };
    let mut draw = || {
        let mut weights = vec![0; blocks];
        for _ in 0..blocks {
            weights[(next() % blocks as u64) as usize] += 1;
        }
        weights
    };
    (0..count).map(|_| draw()).collect()
}
