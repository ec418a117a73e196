//! Delay of one sensor behind another, by cross-correlation of mean rates over short windows.
//!
//! Rates are compared within blocks (a run, or a dozen seconds of one), less the block's mean. The sums of all blocks give
//! one correlation per delay; its maximum is the estimate. The interval comes from resampled blocks, which are long against
//! the correlation times of noise and delays, so the noise need not be white.

use super::signals::MotionSignal;
use crate::recording::{Cumulated, IntervalEstimate, Moments, Run, SplitMix64, TimeGrid};

/// Window of the mean rates \[s\]: several samples of a slow pose, and short against a turn.
const WINDOW: f64 = 0.5;
/// Step of the delays \[s\], and their range in steps.
const STEP: f64 = 0.02;
const SHIFTS: std::ops::RangeInclusive<isize> = -40..=60;
/// Maximum length of a block \[s\], maximum number of blocks, and minimum number for an interval.
const BLOCK: f64 = 12.0;
const MAX_BLOCKS: f64 = 200.0;
const MIN_BLOCKS: usize = 4;
/// Minimum number of times in a block.
const MIN_TIMES: f64 = 25.0;
/// Number of resampled data sets, and the seed.
const DRAWS: usize = 400;
const SEED: u64 = 0x9e37_79b9_7f4a_7c15;
/// Minimum correlation of a clear and of a weak delay.
const CLEAR: f64 = 0.9;
const WEAK: f64 = 0.5;
/// Maximum width of the interval of a clear and of a weak delay \[s\].
const NARROW: f64 = 0.2;
const WIDE: f64 = 0.8;

/// Steps aside of a delay of 0, and ratio of the curvatures there, from which a maximum at 0 is an artefact of the data
/// that negative delays lack.
const KINK: (usize, f64) = (3, 4.0);

/// Two signals of the same motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// The delayed signal.
    pub of: MotionSignal,
    /// The reference.
    pub behind: MotionSignal,
}

impl Pair {
    /// The compared pairs.
    pub const ALL: [Self; 5] = [
        Self::new(MotionSignal::WheelDifference, MotionSignal::YawRate),
        Self::new(MotionSignal::Heading, MotionSignal::YawRate),
        Self::new(MotionSignal::Heading, MotionSignal::WheelDifference),
        Self::new(MotionSignal::Distance, MotionSignal::WheelMean),
        Self::new(MotionSignal::Velocity, MotionSignal::WheelMean),
    ];

    const fn new(of: MotionSignal, behind: MotionSignal) -> Self {
        Self { of, behind }
    }
}

/// Quality of an estimated delay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quality {
    /// Both signals show the same motion.
    Clear,
    /// They do so roughly, or the delay varies.
    Weak,
    /// They do not, or the motion does not determine the delay.
    Unknown,
}

/// Delay of one signal behind another.
#[derive(Debug, Clone, PartialEq)]
pub struct Delay {
    /// The signals.
    pub pair: Pair,
    /// The delay \[s\], positive if the first signal is late. On slippery ground it includes the response time of the vehicle
    /// to its wheels.
    pub seconds: IntervalEstimate,
    /// Slope of the first signal over the second, in their units.
    pub scale: IntervalEstimate,
    /// Correlation at the delay.
    pub correlation: f64,
    /// Number of blocks.
    pub blocks: usize,
    /// Its quality.
    pub quality: Quality,
    /// Whether opposite signs fit more clearly than equal ones.
    pub contradicts: bool,
    /// Correlation over delay \[s\].
    pub curve: Vec<(f64, f64)>,
}

impl Delay {
    /// The delay of a pair, from all runs; `None` if a signal is missing or too short.
    #[must_use]
    pub fn of(runs: &[Run], pair: Pair) -> Option<Self> {
        let signals = |run: &Run| Some((pair.of.of(run)?, pair.behind.of(run)?));
        let signals: Vec<_> = runs.iter().filter_map(signals).collect();
        let spans = signals
            .iter()
            .filter_map(|(a, b)| TimeGrid::over(a, b, STEP));
        let total: f64 = spans.map(|grid| grid.count as f64 * STEP).sum();
        // Short blocks for short recordings, a limited number for long ones.
        let length = (total / MAX_BLOCKS).max(BLOCK.min(total / 6.0).max(4.0 * WINDOW));
        let blocks: Vec<Vec<Moments>> = signals
            .iter()
            .flat_map(|(a, b)| blocks_of(a, b, length))
            .collect();
        if blocks.len() < MIN_BLOCKS {
            return None;
        }
        let all = sum(&blocks, &vec![1; blocks.len()]);
        let curve = SHIFTS
            .zip(&all)
            .map(|(shift, moments)| (shift as f64 * STEP, moments.correlation()));
        let curve: Vec<(f64, f64)> = curve.collect();
        let best = Peak::of(&all)?;
        let mut random = SplitMix64(SEED);
        let drawn = (0..DRAWS).filter_map(|_| {
            let mut weights = vec![0; blocks.len()];
            for _ in 0..blocks.len() {
                weights[random.below(blocks.len())] += 1;
            }
            Peak::of(&sum(&blocks, &weights))
        });
        let drawn: Vec<Peak> = drawn.collect();
        let seconds = IntervalEstimate::from_resampled(
            best.delay,
            drawn.iter().map(|peak| peak.delay).collect(),
        );
        let lowest = curve
            .iter()
            .map(|point| point.1)
            .fold(f64::INFINITY, f64::min);
        let quality = match best.correlation {
            _ if best.is_at_the_end || best.is_kink || seconds.width() > WIDE => Quality::Unknown,
            found if found >= CLEAR && seconds.width() <= NARROW => Quality::Clear,
            found if found >= WEAK => Quality::Weak,
            _ => Quality::Unknown,
        };
        Some(Self {
            pair,
            seconds,
            scale: IntervalEstimate::from_resampled(
                best.slope,
                drawn.iter().map(|peak| peak.slope).collect(),
            ),
            correlation: best.correlation,
            blocks: blocks.len(),
            quality,
            contradicts: lowest < -WEAK && -lowest > best.correlation,
            curve,
        })
    }
}

/// The moments of each block of a run, for each delay.
fn blocks_of(a: &Cumulated, b: &Cumulated, length: f64) -> Vec<Vec<Moments>> {
    let Some(grid) = TimeGrid::over(a, b, STEP) else {
        return Vec::new();
    };
    let (a, mut b) = (a.mean_rates(&grid, WINDOW), b.mean_rates(&grid, WINDOW));
    keep_where_later_is_known(&a, &mut b);
    let count = (grid.count as f64 * STEP / length).round().max(1.0) as usize;
    let block = |index: usize| {
        let indices = index * grid.count / count..(index + 1) * grid.count / count;
        let at = |shift| Moments::shifted(&a, &b, shift, indices.clone());
        SHIFTS.map(at).collect::<Vec<Moments>>()
    };
    let enough = |block: &Vec<Moments>| block.iter().all(|moments| moments.count >= MIN_TIMES);
    let blocks = (0..count).map(block).filter(enough);
    blocks
        .map(|block| block.into_iter().map(Moments::centred).collect())
        .collect()
}

/// Drops the second signal at times at which the first is not known for every delay from 0 on. Otherwise the curve of a
/// short run would fall with its number of times. The few negative delays have fewer times.
fn keep_where_later_is_known(a: &[Option<f64>], b: &mut [Option<f64>]) {
    let mut known = 0;
    for index in (0..b.len()).rev() {
        known = if a[index].is_some() { known + 1 } else { 0 };
        if known <= *SHIFTS.end() {
            b[index] = None;
        }
    }
}

/// Sum of the blocks, each repeated by its weight.
fn sum(blocks: &[Vec<Moments>], weights: &[u32]) -> Vec<Moments> {
    let mut total = vec![Moments::default(); SHIFTS.count()];
    for (block, &weight) in blocks.iter().zip(weights) {
        for _ in 0..weight {
            for (total, moments) in total.iter_mut().zip(block) {
                *total = total.and(*moments);
            }
        }
    }
    total
}

/// The highest point of a correlation over delays.
struct Peak {
    delay: f64,
    correlation: f64,
    slope: f64,
    is_at_the_end: bool,
    /// Whether it is an artefact of the data that negative delays lack.
    is_kink: bool,
}

impl Peak {
    fn of(moments: &[Moments]) -> Option<Self> {
        let r: Vec<f64> = moments
            .iter()
            .map(|moments| moments.correlation())
            .collect();
        let top = (0..r.len()).max_by(|a, b| r[*a].total_cmp(&r[*b]))?;
        let is_at_the_end = top == 0 || top + 1 == r.len();
        // The top of the parabola through the highest point and its neighbours.
        let bend = |at: usize| r[at - 1] - 2.0 * r[at] + r[at + 1];
        let aside = if is_at_the_end || bend(top) >= 0.0 {
            0.0
        } else {
            (r[top - 1] - r[top + 1]) / (2.0 * bend(top))
        };
        let is_kink = top as isize == -SHIFTS.start() && {
            let around = bend(top - KINK.0).min(bend(top + KINK.0));
            bend(top) < KINK.1 * around.min(0.0)
        };
        Some(Self {
            is_kink,
            delay: (*SHIFTS.start() as f64 + top as f64 + aside) * STEP,
            correlation: r[top],
            slope: moments[top].slope(),
            is_at_the_end,
        })
    }
}
