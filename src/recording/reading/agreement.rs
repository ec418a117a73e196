//! Whether two sensors tell the same motion.

use super::turns::is_wrapped;
use crate::recording::csv::{RawRun, Samples};
use crate::recording::{Channel, Cumulated, Grid, Moments, Series};
use std::f64::consts::TAU;

/// Rates are means over so many steps, looked at every step, at delays of up to so many steps.
const WINDOW_STEPS: f64 = 10.0;
const MOST_STEPS: isize = 10;
/// Fewer windows, or a weaker correlation, prove nothing.
const FEWEST_WINDOWS: f64 = 30.0;
const STRONG: f64 = 0.7;
/// Share of a strong correlation that the opposite sign may reach at another delay.
const OPPOSITE: f64 = 0.3;

/// How one signal goes with another, over all runs and at the delays that sensors have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// At the delay with the lowest correlation.
    lowest: Moments,
    /// At the delay with the highest.
    highest: Moments,
}

impl Agreement {
    /// Compares pairs of signals, one pair per run, in steps of so many seconds.
    pub fn of(pairs: &[(Cumulated, Cumulated)], step: f64) -> Option<Self> {
        let window = WINDOW_STEPS * step;
        let rates = |(a, b): &(Cumulated, Cumulated)| {
            let grid = Grid::over(a, b, step)?;
            Some((a.mean_rates(&grid, window), b.mean_rates(&grid, window)))
        };
        let rates: Vec<_> = pairs.iter().filter_map(rates).collect();
        let at = |shift: isize| {
            let runs = rates
                .iter()
                .map(|(a, b)| Moments::shifted(a, b, shift, 0..b.len()));
            runs.fold(Moments::default(), Moments::and)
        };
        let moments: Vec<Moments> = (-MOST_STEPS..=MOST_STEPS).map(at).collect();
        let by_correlation =
            |a: &&Moments, b: &&Moments| a.correlation().total_cmp(&b.correlation());
        let lowest = *moments.iter().min_by(by_correlation)?;
        let highest = *moments.iter().max_by(by_correlation)?;
        let enough = lowest.count.min(highest.count) >= FEWEST_WINDOWS;
        enough.then_some(Self { lowest, highest })
    }

    fn extremes(&self) -> (f64, f64) {
        (self.lowest.correlation(), self.highest.correlation())
    }

    /// Whether both go together, and at no delay against each other as clearly.
    pub fn agrees(&self) -> bool {
        let (low, high) = self.extremes();
        high >= STRONG && -low < high
    }

    /// Whether both go against each other, and at no delay together.
    pub fn contradicts(&self) -> bool {
        let (low, high) = self.extremes();
        -low >= STRONG && high <= OPPOSITE * -low
    }

    /// The strongest correlation of either sign, and how much the first signal changes with the
    /// second there.
    pub fn strongest(&self) -> (f64, f64) {
        let moments = self.clearest();
        (moments.correlation(), moments.slope())
    }

    /// How much the first signal is by the second, and how much it changes with it: the same where it is none without it,
    /// and nothing else changed meanwhile.
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

fn series(run: &RawRun, channel: Channel) -> Series {
    let samples = run.channels[channel.index()].iter();
    samples.map(|sample| (sample.time, sample.value)).collect()
}

/// A channel's integral, or its values where it is itself one; `None` with too few samples.
pub fn cumulated(run: &RawRun, channel: Channel) -> Option<Cumulated> {
    let mut series = series(run, channel);
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

/// The integral of a sum of both wheel speeds with these weights.
pub fn wheels(run: &RawRun, weights: [f64; 2]) -> Option<Cumulated> {
    let sides = [Channel::OmegaLeft, Channel::OmegaRight].map(|side| series(run, side));
    let other = &sides[1];
    let sum = sides[0]
        .samples()
        .filter_map(|(time, left)| Some((time, weights[0] * left + weights[1] * other.at(time)?)));
    let sum: Series = sum.collect();
    (sum.len() > 1).then(|| Cumulated::of_rate(&sum))
}

/// Compares two signals of each run.
pub fn compare(
    samples: &Samples,
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
