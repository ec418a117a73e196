//! Two signals of one motion, over the same windows.

use crate::inspection::signals::MotionSignal;
use crate::recording::{Cumulated, DELAY_STEP, Moments, Run, SENSOR_DELAYS, TimeGrid};
use std::ops::RangeInclusive;

/// Window of the mean rates \[s\].
const WINDOW: f64 = 1.0;
/// Parts of a step in which the best delay is refined.
const FINE: isize = 5;
/// Fewer windows, which overlap, prove nothing.
const MIN_WINDOWS: usize = 160;

/// Mean rates of two signals over the same windows.
#[derive(Debug, Clone, Default)]
pub struct Pairs {
    /// Rates of the first and of the second signal.
    pub values: Vec<(f64, f64)>,
    /// Delay of the first behind the second \[s\].
    pub delay: f64,
}

/// Relation of two signals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ratio {
    /// First over second, through the origin.
    pub value: f64,
    /// Correlation.
    pub correlation: f64,
    /// Deviation from that ratio, as a share of the first signal's standard deviation.
    pub unexplained: f64,
    /// The same as a share of its root mean square.
    pub scatter: f64,
    /// Standard deviation of the second signal as a share of its root mean square.
    pub variety: f64,
}

impl Pairs {
    /// Of all runs; `None` if a signal is missing or too short.
    pub fn of(runs: &[Run], a: MotionSignal, b: MotionSignal) -> Option<Self> {
        Self::within(runs, a, b, SENSOR_DELAYS)
    }

    /// As [`Pairs::of`] with a delay within this range, in steps.
    pub fn within(
        runs: &[Run],
        a: MotionSignal,
        b: MotionSignal,
        delays: RangeInclusive<isize>,
    ) -> Option<Self> {
        let integrals = runs.iter().filter_map(|run| Some((a.of(run)?, b.of(run)?)));
        Self::between(&integrals.collect::<Vec<_>>(), delays)
    }

    /// The step of a delay \[s\].
    pub fn steps(delay: f64) -> isize {
        (delay / DELAY_STEP).round() as isize
    }

    fn between(
        integrals: &[(Cumulated, Cumulated)],
        delays: RangeInclusive<isize>,
    ) -> Option<Self> {
        let rates = |(a, b): &(Cumulated, Cumulated)| {
            let grid = TimeGrid::over(a, b, DELAY_STEP)?;
            Some((a.mean_rates(&grid, WINDOW), b.mean_rates(&grid, WINDOW)))
        };
        let rates: Vec<_> = integrals.iter().filter_map(rates).collect();
        let correlation = |shift: isize| {
            let runs = rates.iter();
            let runs = runs.map(|(a, b)| Moments::shifted(a, b, shift, 0..b.len()));
            runs.fold(Moments::default(), Moments::and)
                .correlation()
                .abs()
        };
        let best = delays.map(|shift| (correlation(shift), shift));
        // Nearest to no delay where nothing correlates.
        let best = best.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.abs().cmp(&a.1.abs())))?;
        // A copy is exact at its own delay only, so it is found to a fraction of the step.
        let fine = -FINE..=FINE;
        let fine = fine.map(|k| (best.1 as f64 + k as f64 / FINE as f64) * DELAY_STEP);
        let at = |delay: f64| {
            let pairs = integrals.iter().flat_map(|(a, b)| {
                let grid = TimeGrid::over(a, b, DELAY_STEP);
                let times = grid
                    .into_iter()
                    .flat_map(|grid| (0..grid.count).map(move |index| grid.time(index)));
                times.filter_map(move |time| {
                    Some((
                        a.mean_rate(time + delay, WINDOW)?,
                        b.mean_rate(time, WINDOW)?,
                    ))
                })
            });
            Self {
                values: pairs.collect(),
                delay,
            }
        };
        let correlation = |pairs: &Self| pairs.ratio().map_or(0.0, |ratio| ratio.correlation.abs());
        let found = fine.map(at).map(|pairs| (correlation(&pairs), pairs));
        let best = found.max_by(|a, b| a.0.total_cmp(&b.0))?.1;
        (best.values.len() >= MIN_WINDOWS).then_some(best)
    }

    /// Their relation; `None` if either does not move.
    pub fn ratio(&self) -> Option<Ratio> {
        let mut moments = Moments::default();
        for (a, b) in &self.values {
            moments.push(*a, *b);
        }
        let value = moments.proportion();
        let count = self.values.len() as f64;
        let square = |term: &dyn Fn(&(f64, f64)) -> f64| {
            let sum: f64 = self.values.iter().map(|pair| term(pair).powi(2)).sum();
            (sum / count).sqrt()
        };
        let (first, second) = (square(&|pair| pair.0), square(&|pair| pair.1));
        let deviations = moments.deviations();
        let moves = first > 0.0 && second > 0.0 && deviations.0 > 1e-9 * first;
        let off = square(&|(a, b)| a - value * b);
        moves.then(|| Ratio {
            value,
            correlation: moments.correlation(),
            unexplained: off / deviations.0,
            scatter: off / first,
            variety: deviations.1 / second,
        })
    }
}
