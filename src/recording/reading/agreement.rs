//! Whether two sensors measure the same motion.

use crate::recording::channel::Channel;
use crate::recording::csv::{RawRun, RawSamples};
use crate::recording::cumulated::{Cumulated, TimeGrid};
use crate::recording::series::Series;
use crate::recording::statistics::{Moments, range};
use std::f64::consts::TAU;

/// Length of the windows of mean rates, and the largest delay, both in steps of the comparison.
const WINDOW_STEPS: f64 = 10.0;
const MAX_STEPS: isize = 10;
/// Fewer windows, or a weaker correlation, prove nothing.
const MIN_WINDOWS: f64 = 30.0;
const STRONG: f64 = 0.7;
/// Share of a strong correlation that the opposite sign may reach at another delay.
const OPPOSITE: f64 = 0.3;
/// Tolerance for the rounding of written numbers in a wrapped heading \[rad\].
const ROUNDING: f64 = 2e-3;

/// Correlation of two signals over all runs, at the delays that sensors have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// At the delay with the lowest correlation.
    lowest: Moments,
    /// At the delay with the highest correlation.
    highest: Moments,
}

impl Agreement {
    /// Compares pairs of signals, one pair per run, in steps of `step` seconds.
    pub fn of(pairs: &[(Cumulated, Cumulated)], step: f64) -> Option<Self> {
        let window = WINDOW_STEPS * step;
        let rates = |(a, b): &(Cumulated, Cumulated)| {
            let grid = TimeGrid::over(a, b, step)?;
            Some((a.mean_rates(&grid, window), b.mean_rates(&grid, window)))
        };
        let rates: Vec<_> = pairs.iter().filter_map(rates).collect();
        let at = |shift: isize| {
            let runs = rates
                .iter()
                .map(|(a, b)| Moments::shifted(a, b, shift, 0..b.len()));
            runs.fold(Moments::default(), Moments::and)
        };
        let moments: Vec<Moments> = (-MAX_STEPS..=MAX_STEPS).map(at).collect();
        let by_correlation =
            |a: &&Moments, b: &&Moments| a.correlation().total_cmp(&b.correlation());
        let lowest = *moments.iter().min_by(by_correlation)?;
        let highest = *moments.iter().max_by(by_correlation)?;
        let enough = lowest.count.min(highest.count) >= MIN_WINDOWS;
        enough.then_some(Self { lowest, highest })
    }

    fn extremes(&self) -> (f64, f64) {
        (self.lowest.correlation(), self.highest.correlation())
    }

    /// Whether both signals have the same sign, and at no delay the opposite sign as clearly.
    pub fn agrees(&self) -> bool {
        let (low, high) = self.extremes();
        high >= STRONG && -low < high
    }

    /// Whether both signals have opposite signs, and at no delay the same sign.
    pub fn contradicts(&self) -> bool {
        let (low, high) = self.extremes();
        -low >= STRONG && high <= OPPOSITE * -low
    }

    /// The strongest correlation of either sign, and the slope of the first signal over the second there.
    pub fn strongest(&self) -> (f64, f64) {
        let moments = self.clearest();
        (moments.correlation(), moments.slope())
    }

    /// Slopes of the first signal over the second, through the origin and through the mean. They are equal if the signals
    /// are proportional.
    pub fn ratios(&self) -> [f64; 2] {
        let moments = self.clearest();
        [moments.proportion(), moments.slope()]
    }

    fn clearest(&self) -> Moments {
        let (low, high) = self.extremes();
        if -low > high {
            self.lowest
        } else {
            self.highest
        }
    }

    /// Standard deviation of the second signal's mean rates.
    pub fn second_deviation(&self) -> f64 {
        self.highest.deviations().1
    }
}

/// Whether headings \[rad\] stay within a full turn; otherwise they are continuous already.
pub fn is_wrapped(headings: impl Iterator<Item = f64>) -> bool {
    let [min, max] = range(headings);
    max - min <= TAU + ROUNDING
}

/// A channel's integral, or the channel if it is an integral already; `None` with too few samples.
pub fn cumulated(run: &RawRun, channel: Channel) -> Option<Cumulated> {
    let mut series = run.series(channel);
    if channel == Channel::Heading && is_wrapped(series.value.iter().copied()) {
        let mut last = None;
        for value in &mut series.value {
            let before = last.unwrap_or(*value);
            *value += ((before - *value) / TAU).round() * TAU;
            last = Some(*value);
        }
    }
    let sum = match channel {
        Channel::Heading | Channel::X | Channel::Y => Cumulated::of_position(&series),
        _ => Cumulated::of_rate(&series),
    };
    (series.len() > 1).then_some(sum)
}

/// The heading as an accumulated angle.
pub fn heading(run: &RawRun) -> Option<Cumulated> {
    cumulated(run, Channel::Heading)
}

/// The integrated yaw rate.
pub fn gyro(run: &RawRun) -> Option<Cumulated> {
    cumulated(run, Channel::YawRate)
}

/// The integrated difference of the wheel speeds, right minus left.
pub fn wheel_difference(run: &RawRun) -> Option<Cumulated> {
    wheels(run, [-1.0, 1.0])
}

/// The integrated mean of the wheel speeds.
pub fn wheel_mean(run: &RawRun) -> Option<Cumulated> {
    wheels(run, [0.5, 0.5])
}

fn wheels(run: &RawRun, weights: [f64; 2]) -> Option<Cumulated> {
    let sides = [Channel::OmegaLeft, Channel::OmegaRight].map(|side| run.series(side));
    let sum = Series::weighted_sum([&sides[0], &sides[1]], weights);
    (sum.len() > 1).then(|| Cumulated::of_rate(&sum))
}

/// Compares two signals of each run.
pub fn compare(
    samples: &RawSamples,
    step: f64,
    a: impl Fn(&RawRun) -> Option<Cumulated>,
    b: impl Fn(&RawRun) -> Option<Cumulated>,
) -> Option<Agreement> {
    let pairs = samples
        .runs
        .iter()
        .filter_map(|run| Some((a(run)?, b(run)?)));
    Agreement::of(&pairs.collect::<Vec<_>>(), step)
}
