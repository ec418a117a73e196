//! How far one sensor trails another, by cross-correlation of mean rates over short windows.
//!
//! Rates are compared within blocks (a run, or a dozen seconds of one), less the block's mean;
//! the blocks' sums add up to one correlation for each delay, whose highest point is the
//! estimate. Its interval comes from drawing blocks anew: they are long against what noise and
//! delays remember, so nothing has to be white.

use super::resample::draws;
use super::{Interval, Signal};
use crate::recording::{Cumulated, Grid, Moments, Run};

/// Windows of the mean rates \[s\]: some samples of a slow pose, and short against a turn.
const WINDOW: f64 = 0.5;
/// Step of the delays that are tried \[s\], and the first and last of them in steps.
const STEP: f64 = 0.02;
const SHIFTS: std::ops::RangeInclusive<isize> = -40..=60;
/// Longest block \[s\], the most of them, and the fewest that tell an interval.
const BLOCK: f64 = 12.0;
const MOST_BLOCKS: f64 = 200.0;
const FEWEST_BLOCKS: usize = 4;
/// Fewer times in a block do not count.
const FEWEST_TIMES: f64 = 25.0;
/// Data sets drawn for the interval.
const DRAWS: usize = 400;
/// Correlations that make a delay clear, and that leave it in the dark.
const CLEAR: f64 = 0.9;
const DARK: f64 = 0.5;
/// A wider interval than this is not clear, and one that tells nothing \[s\].
const NARROW: f64 = 0.2;
const WIDEST: f64 = 0.8;

/// A correlation that bends at a delay of 0 so many times as much as so many steps aside does so
/// because of what it is made of, not of a delay.
const KINK: (usize, f64) = (3, 4.0);

/// Two signals that tell the same motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// The one whose delay is asked for.
    pub of: Signal,
    /// The one that it trails.
    pub behind: Signal,
}

impl Pair {
    /// The pairs that are looked at.
    pub const ALL: [Self; 5] = [
        Self::new(Signal::WheelDifference, Signal::YawRate),
        Self::new(Signal::Heading, Signal::YawRate),
        Self::new(Signal::Heading, Signal::WheelDifference),
        Self::new(Signal::Way, Signal::WheelMean),
        Self::new(Signal::Velocity, Signal::WheelMean),
    ];

    const fn new(of: Signal, behind: Signal) -> Self {
        Self { of, behind }
    }
}

/// What an estimated delay is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quality {
    /// Both signals tell the same motion.
    Clear,
    /// They do roughly, or the delay is not the same throughout.
    Weak,
    /// They do not, or the motion has nothing to tell a delay by.
    Unknown,
}

/// By how much one signal trails another.
#[derive(Debug, Clone, PartialEq)]
pub struct Delay {
    /// Which signals.
    pub pair: Pair,
    /// The delay \[s\], positive where the first trails the second. On slippery ground it holds
    /// what the vehicle takes to respond to its wheels, too.
    pub seconds: Interval,
    /// By how much the first grows with the second, in their units.
    pub scale: Interval,
    /// Correlation at the delay.
    pub correlation: f64,
    /// Number of blocks.
    pub blocks: usize,
    /// What it is worth.
    pub quality: Quality,
    /// Whether the signals go against each other more clearly than together.
    pub contradicts: bool,
    /// Correlation over delay \[s\].
    pub curve: Vec<(f64, f64)>,
}

impl Delay {
    /// Of a pair, from all runs; `None` where one of both was not measured, or for too short
    /// a time.
    #[must_use]
    pub fn of(runs: &[Run], pair: Pair) -> Option<Self> {
        let signals = |run: &Run| Some((pair.of.of(run)?, pair.behind.of(run)?));
        let signals: Vec<_> = runs.iter().filter_map(signals).collect();
        let spans = signals.iter().filter_map(|(a, b)| Grid::over(a, b, STEP));
        let total: f64 = spans.map(|grid| grid.count as f64 * STEP).sum();
        // Short recordings in short blocks, long ones in not too many.
        let length = (total / MOST_BLOCKS).max(BLOCK.min(total / 6.0).max(4.0 * WINDOW));
        let blocks: Vec<Vec<Moments>> = signals
            .iter()
            .flat_map(|(a, b)| blocks_of(a, b, length))
            .collect();
        if blocks.len() < FEWEST_BLOCKS {
            return None;
        }
        let all = sum(&blocks, &vec![1; blocks.len()]);
        let curve = SHIFTS
            .zip(&all)
            .map(|(shift, moments)| (shift as f64 * STEP, moments.correlation()));
        let curve: Vec<(f64, f64)> = curve.collect();
        let best = Peak::of(&all)?;
        let drawn = draws(blocks.len(), DRAWS);
        let drawn: Vec<Peak> = drawn
            .iter()
            .filter_map(|weights| Peak::of(&sum(&blocks, weights)))
            .collect();
        let seconds =
            Interval::from_resampled(best.delay, drawn.iter().map(|peak| peak.delay).collect());
        let lowest = curve
            .iter()
            .map(|point| point.1)
            .fold(f64::INFINITY, f64::min);
        let quality = match best.correlation {
            _ if best.is_at_the_end || best.is_kink || seconds.width() > WIDEST => Quality::Unknown,
            found if found >= CLEAR && seconds.width() <= NARROW => Quality::Clear,
            found if found >= DARK => Quality::Weak,
            _ => Quality::Unknown,
        };
        Some(Self {
            pair,
            seconds,
            scale: Interval::from_resampled(
                best.slope,
                drawn.iter().map(|peak| peak.slope).collect(),
            ),
            correlation: best.correlation,
            blocks: blocks.len(),
            quality,
            contradicts: lowest < -DARK && -lowest > best.correlation,
            curve,
        })
    }
}

/// The moments of each block of a run, for each delay.
fn blocks_of(a: &Cumulated, b: &Cumulated, length: f64) -> Vec<Vec<Moments>> {
    let Some(grid) = Grid::over(a, b, STEP) else {
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
    let enough = |block: &Vec<Moments>| block.iter().all(|moments| moments.count >= FEWEST_TIMES);
    let blocks = (0..count).map(block).filter(enough);
    blocks
        .map(|block| block.into_iter().map(Moments::centred).collect())
        .collect()
}

/// Forgets the second signal where the first is not known at every delay from 0 on: the curve
/// of a short run would otherwise fall with the number of times it rests on. Negative delays, of
/// which there are few, make do with what is left.
fn keep_where_later_is_known(a: &[Option<f64>], b: &mut [Option<f64>]) {
    let mut known = 0;
    for index in (0..b.len()).rev() {
        known = if a[index].is_some() { known + 1 } else { 0 };
        if known <= *SHIFTS.end() {
            b[index] = None;
        }
    }
}

/// Blocks added up, each as often as its weight says.
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
    /// Whether it comes from the data that negative delays have to do without.
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
        let aside = if is_at_the_end {
            0.0
        } else {
            let bend = r[top - 1] - 2.0 * r[top] + r[top + 1];
            if bend < 0.0 {
                (r[top - 1] - r[top + 1]) / (2.0 * bend)
            } else {
                0.0
            }
        };
        let bend = |at: usize| r[at - 1] - 2.0 * r[at] + r[at + 1];
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
