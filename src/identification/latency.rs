//! Latencies of pose and wheel speeds against the yaw rate, from changes of angles over a second.

use super::signals::{Signals, wrapped};
use crate::recording::{IntervalEstimate, Moments, Series, median, range, stretches};

/// Length of an increment \[s\]: long against the sensors' intervals, short against a turn.
const LENGTH: f64 = 1.0;
/// Seconds from one increment to the next.
const SPACING: f64 = 0.1;
/// Seconds over which increments count as dependent.
const BLOCK: f64 = 2.0;
/// Minimum RMS change of the reference \[rad\].
const MIN_CHANGE: f64 = 0.05;
/// Minimum ratio of the highest cost to the lowest for a lag.
const MIN_CONTRAST: f64 = 2.0;
/// Step of the search \[s\].
const STEP: f64 = 0.01;
/// Lags of the pose that are searched \[s\].
const POSE: (f64, f64) = (-0.3, 1.3);
/// Lags of the wheel speeds that are searched \[s\]. None is negative: on slippery ground the vehicle turns later than its
/// wheels, which is physics and must stay.
const WHEELS: (f64, f64) = (0.0, 0.5);
/// Maximum width of the interval of a known latency \[s\].
const MAX_WIDTH: f64 = 0.5;
/// Larger differences between changes of heading count linearly \[rad\], because lidar odometry fails at times.
const OUTLIER: f64 = 0.1;

/// A constant latency \[s\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Latency {
    /// Estimated from the recording.
    Estimated(IntervalEstimate),
    /// Not determined by the drive, which has too few turns: none is removed.
    Unknown,
    /// The reference of the other latencies.
    Reference,
}

impl Latency {
    /// The latency to remove \[s\].
    #[must_use]
    pub fn value(&self) -> f64 {
        match self {
            Self::Estimated(estimate) => estimate.value,
            Self::Unknown | Self::Reference => 0.0,
        }
    }

    /// The result of a search between these lags. An optimum at a bound is rejected, because the true one may lie beyond;
    /// only the lower bound of the wheels is a valid result.
    fn from_search(estimate: Option<IntervalEstimate>, (min, max): (f64, f64)) -> Self {
        let is_inside = |lag: f64| (min >= 0.0 || lag > min + STEP / 2.0) && lag < max - STEP / 2.0;
        match estimate {
            Some(estimate) if estimate.width() <= MAX_WIDTH && is_inside(estimate.value) => {
                Self::Estimated(estimate)
            }
            _ => Self::Unknown,
        }
    }
}

/// The constant latencies of a recording against its yaw rate; without a yaw rate, of the pose against the wheel speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Latencies {
    /// Latency of x, y and heading.
    pub pose: Latency,
    /// Latency of the wheel speeds.
    pub wheels: Latency,
    /// Bias of the gyro against the changes of the heading \[rad/s\]; 0 without a gyro.
    pub gyro_bias: f64,
}

impl Signals {
    /// Removes the latencies of pose and wheel speeds, and the bias of the yaw rate.
    pub fn remove(&mut self, latencies: &Latencies) {
        let Latencies {
            pose,
            wheels,
            gyro_bias,
        } = latencies;
        self.correct([pose.value(), wheels.value()], *gyro_bias);
    }
}

impl Latencies {
    /// Estimates them from all runs together: the lags at which the changes of heading over a second agree best.
    #[must_use]
    pub fn estimate(runs: &[Signals]) -> Self {
        let twists: Vec<Series> = runs.iter().map(Signals::twist).collect();
        let gyros = || runs.iter().map(Signals::turned_series);
        let headings = || runs.iter().map(Signals::heading_series);
        if gyros().all(|gyro| gyro.is_none()) {
            let pairs = Increments::over_lags(twists.iter().zip(headings()), grid(POSE));
            return Self {
                pose: Latency::from_search(pairs.best_lag(moments, unexplained), POSE),
                wheels: Latency::Reference,
                gyro_bias: 0.0,
            };
        }
        let pose = gyros().zip(headings()).filter_map(|(g, h)| Some((g?, h)));
        let wheels = gyros().zip(&twists).filter_map(|(g, t)| Some((g?, t)));
        let pose = Increments::over_lags(pose, grid(POSE));
        // The median over all lags: a bias would raise the cost at every lag and hide the minimum.
        let bias = gyro_bias(pose.pairs());
        let pose = pose.best_lag(|pairs| huber_loss(pairs, bias), |blocks| blocks.sum());
        let wheels = Increments::over_lags(wheels, grid(WHEELS)).best_lag(moments, unexplained);
        let pose = Latency::from_search(pose, POSE);
        let pairs = gyros().zip(headings()).filter_map(|(g, h)| Some((g?, h)));
        let changes = Increments::at_lag(pairs, pose.value());
        Self {
            pose,
            wheels: Latency::from_search(wheels, WHEELS),
            gyro_bias: gyro_bias(changes.into_iter()),
        }
    }
}

fn grid((min, max): (f64, f64)) -> Vec<f64> {
    let count = ((max - min) / STEP).round() as usize;
    (0..=count).map(|k| min + STEP * k as f64).collect()
}

/// Median difference between the changes of gyro and heading over a second \[rad/s\]; 0 without changes.
fn gyro_bias(changes: impl Iterator<Item = (f64, f64)>) -> f64 {
    let mut differences: Vec<f64> = changes.map(|(gyro, pose)| wrapped(gyro - pose)).collect();
    if differences.is_empty() {
        return 0.0;
    }
    median(&mut differences)
}

/// Cost of equal changes except for a bias: Huber's loss of the difference.
fn huber_loss(pairs: &[(f64, f64)], bias: f64) -> f64 {
    let loss = |(gyro, pose): &(f64, f64)| {
        let difference = wrapped(gyro - pose - bias).abs();
        if difference < OUTLIER {
            difference * difference
        } else {
            OUTLIER * (2.0 * difference - OUTLIER)
        }
    };
    pairs.iter().map(loss).sum()
}

fn moments(pairs: &[(f64, f64)]) -> Moments {
    let mut moments = Moments::default();
    for (a, b) in pairs {
        moments.push(*a, *b);
    }
    moments
}

/// Cost of proportional changes, with an unknown factor and bias: the unexplained share of the variance.
fn unexplained(blocks: &mut dyn Iterator<Item = Moments>) -> f64 {
    let all = blocks.fold(Moments::default(), Moments::and);
    1.0 - all.correlation().powi(2)
}

/// RMS difference between the changes of the recorded heading over a second and those of the gyro, less its bias \[rad\];
/// `None` without a yaw rate.
#[must_use]
pub fn heading_noise(runs: &[Signals]) -> Option<f64> {
    let lag = runs.first()?.pose_latency();
    let pairs = runs
        .iter()
        .filter_map(|run| Some((run.turned_series()?, run.heading_series())));
    let increments = Increments::at_lag(pairs, lag);
    let bias = gyro_bias(increments.iter().copied());
    let squares: f64 = increments
        .iter()
        .map(|(gyro, pose)| wrapped(gyro - pose - bias).powi(2))
        .sum();
    (!increments.is_empty()).then(|| (squares / increments.len() as f64).sqrt())
}

/// Changes of a reference and of a late series over the same second, at several lags.
struct Increments {
    /// The lags \[s\].
    lags: Vec<f64>,
    /// Per block and lag the pairs of changes: reference, late series.
    blocks: Vec<Vec<Vec<(f64, f64)>>>,
}

impl Increments {
    /// The changes at several lags, over the same times so that costs are comparable.
    fn over_lags<'a>(
        pairs: impl Iterator<Item = (&'a Series, &'a Series)>,
        lags: Vec<f64>,
    ) -> Self {
        let (min, max) = (lags[0], lags[lags.len() - 1]);
        let mut blocks = Vec::new();
        for (reference, trailing) in pairs {
            let times = common_times(reference, trailing, min, max);
            let in_block = |time: &f64| (time / BLOCK).floor();
            for times in times.chunk_by(|a, b| in_block(a) == in_block(b)) {
                let at = |lag: &f64| changes(reference, trailing, times, *lag);
                blocks.push(lags.iter().map(at).collect());
            }
        }
        Self { lags, blocks }
    }

    /// All pairs of changes, at all lags.
    fn pairs(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.blocks.iter().flatten().flatten().copied()
    }

    /// The pairs of changes at one lag.
    fn at_lag<'a>(
        pairs: impl Iterator<Item = (&'a Series, &'a Series)>,
        lag: f64,
    ) -> Vec<(f64, f64)> {
        let all = Self::over_lags(pairs, vec![lag]);
        all.blocks.into_iter().flatten().flatten().collect()
    }

    /// The lag of the minimum cost, with a bootstrap interval over blocks; `None` if the changes are small or all lags cost
    /// about the same.
    ///
    /// `sums` are those of a block's pairs, `total` is the cost of several blocks.
    fn best_lag<S: Copy>(
        &self,
        sums: impl Fn(&[(f64, f64)]) -> S,
        total: impl Fn(&mut dyn Iterator<Item = S>) -> f64,
    ) -> Option<IntervalEstimate> {
        let changes = || {
            self.blocks
                .iter()
                .flat_map(|lags| &lags[0])
                .map(|pair| pair.0)
        };
        let squares: f64 = changes().map(|change| change * change).sum();
        let change = (squares / changes().count() as f64).sqrt();
        // NaN without any pair.
        if change.is_nan() || change < MIN_CHANGE {
            return None;
        }
        let of_block = |block: &Vec<Vec<(f64, f64)>>| -> Vec<S> {
            block.iter().map(|pairs| sums(pairs)).collect()
        };
        let sums: Vec<Vec<S>> = self.blocks.iter().map(of_block).collect();
        let costs = |drawn: &[usize]| -> Vec<f64> {
            let at = |lag: usize| total(&mut drawn.iter().map(|block| sums[*block][lag]));
            (0..self.lags.len()).map(at).collect()
        };
        let all: Vec<usize> = (0..sums.len()).collect();
        let [min, max] = range(costs(&all).into_iter());
        if max < MIN_CONTRAST * min {
            return None;
        }
        let best = |drawn: &[usize]| {
            let costs = costs(drawn).into_iter().enumerate();
            let best = costs.min_by(|a, b| a.1.total_cmp(&b.1));
            best.map_or(f64::NAN, |(lag, _)| self.lags[lag])
        };
        Some(IntervalEstimate::bootstrap(sums.len(), best))
    }
}

/// Times at which changes of both are known at every lag from `min` to `max`. Between two samples far apart they are
/// unknown.
fn common_times(reference: &Series, trailing: &Series, min: f64, max: f64) -> Vec<f64> {
    let (own, late) = (stretches(reference), stretches(trailing));
    let mut times = Vec::new();
    let mut next = 0;
    for [start, end] in own {
        // A stretch that ends before the start of this one ends before all following ones.
        next += late[next..].partition_point(|[_, late_end]| late_end - max < start);
        for [late_start, late_end] in &late[next..] {
            let first = start.max(late_start - min);
            if first > end {
                break;
            }
            let last = end.min(late_end - max) - LENGTH;
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
    fn changes_are_unknown_between_samples_far_apart() {
        // Ten seconds at 20 Hz, and ten more after the clock was set.
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
