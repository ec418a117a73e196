//! How long, how far, and how much of it at rest.

use crate::recording::{Channel, Run, Series, longest_interval, way_along};

/// Wheels slower than this stand still \[rad/s\].
const STILL: f64 = 0.02;
/// Ways back that are shorter than this are noise \[m\].
const WAY_BACK: f64 = 0.2;
/// The same for turning back \[rad\].
const TURN_BACK: f64 = 0.05;
/// With fewer samples at rest a gyro's bias is not known.
const FEWEST: usize = 20;
/// A bias shows beyond so many standard errors.
const CLEAR: f64 = 3.0;

/// Duration and distance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// From the first sample to the last \[s\].
    pub duration: f64,
    /// Length of the way along the heading, forward and back, after the pose \[m\], without what
    /// noise goes to and fro; `None` without a pose.
    pub distance: Option<f64>,
    /// Angle turned, both ways, after the yaw rate (where it was sampled without a gap), or after the heading without one \[rad\]; without noise and
    /// without a bias that shows at rest.
    pub turned: Option<f64>,
    /// Time in which all wheels stand still \[s\].
    pub at_rest: f64,
}

impl Motion {
    /// Of one run.
    #[must_use]
    pub fn of(run: &Run) -> Self {
        let series = |channel| run.series(channel);
        let pose = (
            series(Channel::X),
            series(Channel::Y),
            series(Channel::Heading),
        );
        let distance = match pose {
            (Some(x), Some(y), Some(heading)) => {
                Some(length(&way_along(x, y, heading).value, WAY_BACK))
            }
            _ => None,
        };
        let rests = rest_spans(run);
        let turned = series(Channel::YawRate).map(|rate| {
            let bias = bias(rate, &rests);
            // What it did in a gap is not known.
            let limit = longest_interval(rate);
            let pairs = rate.value.windows(2).zip(rate.intervals());
            let pairs = pairs.filter(|(_, interval)| *interval <= limit);
            let steps = pairs.scan(0.0, |angle, (pair, interval)| {
                *angle += (f64::midpoint(pair[0], pair[1]) - bias) * interval;
                Some(*angle)
            });
            length(
                &std::iter::once(0.0).chain(steps).collect::<Vec<f64>>(),
                TURN_BACK,
            )
        });
        let by_heading = || Some(length(&series(Channel::Heading)?.value, TURN_BACK));
        Self {
            duration: run.duration(),
            distance,
            turned: turned.or_else(by_heading),
            // A sum of nothing is -0.
            at_rest: 0.0 + rests.iter().map(|(from, to)| to - from).sum::<f64>(),
        }
    }

    /// Both together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let sum = |a: Option<f64>, b: Option<f64>| a.map_or(b, |a| Some(a + b.unwrap_or(0.0)));
        Self {
            duration: self.duration + other.duration,
            distance: sum(self.distance, other.distance),
            turned: sum(self.turned, other.turned),
            at_rest: self.at_rest + other.at_rest,
        }
    }
}

/// How far values go up and down; a way back counts from where it begins, once it is longer than `band`.
fn length(values: &[f64], band: f64) -> f64 {
    let Some(first) = values.first() else {
        return 0.0;
    };
    // The last value that counts is the furthest in the direction taken.
    let (mut furthest, mut direction, mut total) = (*first, 0.0, 0.0);
    for value in values {
        let step = value - furthest;
        if step * direction > 0.0 || step.abs() > band {
            (furthest, direction) = (*value, step.signum());
            total += step.abs();
        }
    }
    total
}

/// The mean of a rate at rest, where it is known and not explained by the scatter.
fn bias(rate: &Series, rests: &[(f64, f64)]) -> f64 {
    let rests_at = |time: f64| {
        let next = rests.partition_point(|(_, end)| *end < time);
        rests.get(next).is_some_and(|(start, _)| *start <= time)
    };
    let there = rate.samples().filter(|(time, _)| rests_at(*time));
    let there: Vec<f64> = there.map(|(_, value)| value).collect();
    let count = there.len() as f64;
    let mean = there.iter().sum::<f64>() / count;
    let square = there
        .iter()
        .map(|value| (value - mean).powi(2))
        .sum::<f64>();
    let is_clear = mean.abs() * count > CLEAR * square.sqrt();
    if there.len() >= FEWEST && is_clear {
        mean
    } else {
        0.0
    }
}

/// The spans in which all wheels stand still \[s\].
#[must_use]
pub fn rest_spans(run: &Run) -> Vec<(f64, f64)> {
    let Some(drive) = run.drive() else {
        return Vec::new();
    };
    let mut spans: Vec<(f64, f64)> = Vec::new();
    let mut still_since = None;
    for (row, &time) in drive.time.iter().enumerate() {
        let is_still = drive
            .wheel_speeds(row)
            .iter()
            .all(|speed| speed.abs() <= STILL);
        match (is_still, still_since) {
            (true, None) => still_since = Some((time, time)),
            (true, Some((since, _))) => still_since = Some((since, time)),
            (false, Some(span)) => {
                spans.push(span);
                still_since = None;
            }
            (false, None) => {}
        }
    }
    spans.extend(still_since);
    spans.retain(|(from, to)| to > from);
    spans
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_to_and_fro_count_from_end_to_end_and_noise_does_not() {
        assert_eq!(length(&[], 0.2), 0.0);
        assert_eq!(length(&[5.0], 0.2), 0.0);
        // Forward, back, and forward again, in steps below the band.
        let there = (0..=100).map(|k| 0.05 * f64::from(k));
        let back = there.clone().rev();
        let drive: Vec<f64> = there.clone().chain(back).chain(there).collect();
        assert!((length(&drive, 0.2) - 15.0).abs() < 1e-9);
        // A decimetre to and fro.
        let noise: Vec<f64> = (0..1000).map(|k| 0.1 * f64::from(k % 2)).collect();
        assert_eq!(length(&noise, 0.2), 0.0);
        let noisy: Vec<f64> = drive
            .iter()
            .zip(&noise)
            .map(|(way, noise)| way + noise)
            .collect();
        assert!((length(&noisy, 0.2) - 15.0).abs() < 0.5);
    }

    #[test]
    fn nobody_knows_what_turned_in_a_gap() {
        let times = (0..=100).chain(100_000..=100_100);
        let rate: Series = times.map(|k| (0.05 * f64::from(k), 0.4)).collect();
        let turned = Motion::of(&Run::new("").with(Channel::YawRate, rate)).turned;
        assert!((turned.unwrap() - 0.4 * 10.0).abs() < 1e-9, "{turned:?}");
    }

    #[test]
    fn a_vehicle_that_stands_goes_nowhere() {
        let times = || (0..2000).map(|k| (0.05 * f64::from(k), f64::from(k % 2) - 0.5));
        let still = || times().map(|(time, _)| (time, 0.0)).collect::<Series>();
        let noisy = |mean: f64, size: f64| -> Series {
            times()
                .map(|(time, way)| (time, mean + size * way))
                .collect()
        };
        let run = Run::new("")
            .with(Channel::OmegaLeft, still())
            .with(Channel::OmegaRight, still())
            .with(Channel::X, noisy(3.0, 0.04))
            .with(Channel::Y, noisy(1.0, 0.04))
            .with(Channel::Heading, noisy(0.5, 0.01));
        let biased = run.clone().with(Channel::YawRate, noisy(0.02, 0.04));
        for run in [run, biased] {
            let Motion {
                distance, turned, ..
            } = Motion::of(&run);
            assert_eq!(distance, Some(0.0));
            assert!(turned.unwrap() < 1e-9, "{turned:?}");
        }
    }
}
