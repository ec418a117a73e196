//! By how much pose and wheel speeds trail the yaw rate.

use super::estimate::median;
use super::increments::{Cost, Increments};
use super::signals::wrapped;
use super::{Estimate, Signals};
use crate::recording::{Moments, Series};

/// Step of the search \[s\].
const STEP: f64 = 0.01;
/// Lags at which the pose is looked for \[s\].
const POSE: (f64, f64) = (-0.3, 1.3);
/// Lags at which the wheel speeds are looked for \[s\]. None below zero: on slippery ground the
/// vehicle turns later than its wheels, which is physics and must stay in.
const WHEELS: (f64, f64) = (0.0, 0.5);
/// An interval wider than this says that the drive tells nothing about the latency \[s\].
const WIDEST: f64 = 0.5;
/// Changes of heading over a second that stray further count linearly \[rad\]: lidar
/// odometry loses its way at times.
const OUTLIER: f64 = 0.1;

/// A constant latency \[s\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Latency {
    /// Estimated from the recording.
    Estimated(Estimate),
    /// The drive does not tell it, for want of turns: none is removed.
    Unknown,
    /// The clock that the others are compared with.
    Reference,
}

impl Latency {
    /// What is removed \[s\].
    #[must_use]
    pub fn value(&self) -> f64 {
        match self {
            Self::Estimated(estimate) => estimate.value,
            Self::Unknown | Self::Reference => 0.0,
        }
    }

    /// What a search found that looked between these lags: the best at an end of them may be the end of something beyond,
    /// but for the wheels' least one, which is meant.
    fn from_search(estimate: Option<Estimate>, (least, most): (f64, f64)) -> Self {
        let is_inside =
            |lag: f64| (least >= 0.0 || lag > least + STEP / 2.0) && lag < most - STEP / 2.0;
        match estimate {
            Some(estimate) if estimate.width() <= WIDEST && is_inside(estimate.value) => {
                Self::Estimated(estimate)
            }
            _ => Self::Unknown,
        }
    }
}

/// The constant latencies of a recording, against its yaw rate; where there is none, of the
/// pose against the wheel speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Latencies {
    /// By how much x, y and heading trail.
    pub pose: Latency,
    /// By how much the wheel speeds trail.
    pub wheels: Latency,
    /// What the gyro shows beyond the changes of the heading \[rad/s\]; 0 without a gyro.
    pub gyro_bias: f64,
}

impl Latencies {
    /// Estimates them from all runs together: the lag at which changes of heading over a
    /// second agree best.
    #[must_use]
    pub fn estimate(runs: &[Signals]) -> Self {
        let twists: Vec<Series> = runs.iter().map(Signals::twist).collect();
        let gyros = || runs.iter().map(Signals::turned_series);
        let headings = || runs.iter().map(Signals::heading_series);
        if gyros().all(|gyro| gyro.is_none()) {
            let pairs = Increments::over_lags(twists.iter().zip(headings()), grid(POSE));
            return Self {
                pose: Latency::from_search(pairs.best_lag(&Proportional), POSE),
                wheels: Latency::Reference,
                gyro_bias: 0.0,
            };
        }
        let pose = gyros().zip(headings()).filter_map(|(g, h)| Some((g?, h)));
        let wheels = gyros().zip(&twists).filter_map(|(g, t)| Some((g?, t)));
        let pose = Increments::over_lags(pose, grid(POSE));
        // In the middle at all lags: a bias would cost alike at every lag and hide the best one.
        let bias = gyro_bias(pose.pairs());
        let pose = pose.best_lag(&Equal { bias });
        let wheels = Increments::over_lags(wheels, grid(WHEELS)).best_lag(&Proportional);
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

fn grid((least, most): (f64, f64)) -> Vec<f64> {
    let count = ((most - least) / STEP).round() as usize;
    (0..=count).map(|k| least + STEP * k as f64).collect()
}

/// By how much more the gyro's integral changes over a second than the heading, in the middle of these changes of both
/// \[rad/s\]; 0 where there is none.
pub(super) fn gyro_bias(changes: impl Iterator<Item = (f64, f64)>) -> f64 {
    let mut strays: Vec<f64> = changes.map(|(gyro, pose)| wrapped(gyro - pose)).collect();
    if strays.is_empty() {
        return 0.0;
    }
    median(&mut strays)
}

/// Both change by the same angle but for a bias: Huber's loss of the difference.
struct Equal {
    bias: f64,
}

impl Cost for Equal {
    type Sums = f64;

    fn sums(&self, pairs: &[(f64, f64)]) -> f64 {
        let loss = |(gyro, pose): &(f64, f64)| {
            let stray = wrapped(gyro - pose - self.bias).abs();
            if stray < OUTLIER {
                stray * stray
            } else {
                OUTLIER * (2.0 * stray - OUTLIER)
            }
        };
        pairs.iter().map(loss).sum()
    }

    fn total(&self, blocks: impl Iterator<Item = f64>) -> f64 {
        blocks.sum()
    }
}

/// One changes in proportion to the other, by a factor and a bias that are not known: the share of
/// its variance that the best ones leave.
struct Proportional;

impl Cost for Proportional {
    type Sums = Moments;

    fn sums(&self, pairs: &[(f64, f64)]) -> Moments {
        let mut moments = Moments::default();
        for (a, b) in pairs {
            moments.push(*a, *b);
        }
        moments
    }

    fn total(&self, blocks: impl Iterator<Item = Moments>) -> f64 {
        1.0 - blocks
            .fold(Moments::default(), Moments::and)
            .correlation()
            .powi(2)
    }
}
