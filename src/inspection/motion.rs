//! Duration, distance, and time at rest.

use crate::recording::{Channel, Run, Series, distance_along_heading, longest_interval};

/// Slower wheels stand still \[rad/s\].
const STILL: f64 = 0.02;
/// A shorter distance back is noise \[m\].
const DISTANCE_BAND: f64 = 0.2;
/// A smaller turn back is noise \[rad\].
const TURN_BAND: f64 = 0.05;
/// Minimum number of samples at rest for a gyro's bias.
const MIN_SAMPLES: usize = 20;
/// A bias is significant beyond this multiple of its standard error.
const CLEAR: f64 = 3.0;

/// Duration and distance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MotionSummary {
    /// From the first sample to the last \[s\].
    pub duration: f64,
    /// Distance along the heading, forward and back, from the pose \[m\], without noise; `None` without a pose.
    pub distance: Option<f64>,
    /// Angle turned, both ways, without noise \[rad\]. It is the integral of the yaw rate outside gaps, less a bias that is
    /// significant at rest; without a gyro it comes from the heading.
    pub turned: Option<f64>,
    /// Time in which all wheels stand still \[s\].
    pub at_rest: f64,
}

impl MotionSummary {
    /// The motion of one run.
    #[must_use]
    pub fn of(run: &Run) -> Self {
        let series = |channel| run.series(channel);
        let pose = (
            series(Channel::X),
            series(Channel::Y),
            series(Channel::Heading),
        );
        let distance = match pose {
            (Some(x), Some(y), Some(heading)) => Some(length(
                &distance_along_heading(x, y, heading).value,
                DISTANCE_BAND,
            )),
            _ => None,
        };
        let rests = rest_spans(run);
        let turned = series(Channel::YawRate).map(|rate| {
            let bias = bias(rate, &rests);
            // The motion in a gap is unknown.
            let limit = longest_interval(rate);
            let pairs = rate.value.windows(2).zip(rate.intervals());
            let pairs = pairs.filter(|(_, interval)| *interval <= limit);
            let steps = pairs.scan(0.0, |angle, (pair, interval)| {
                *angle += (f64::midpoint(pair[0], pair[1]) - bias) * interval;
                Some(*angle)
            });
            length(
                &std::iter::once(0.0).chain(steps).collect::<Vec<f64>>(),
                TURN_BAND,
            )
        });
        let by_heading = || Some(length(&series(Channel::Heading)?.value, TURN_BAND));
        Self {
            duration: run.duration(),
            distance,
            turned: turned.or_else(by_heading),
            // A sum of nothing is -0.
            at_rest: 0.0 + rests.iter().map(|(from, to)| to - from).sum::<f64>(),
        }
    }

    /// The motions of both.
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

/// Total variation of values; a reversal counts in full as soon as it exceeds `band`.
fn length(values: &[f64], band: f64) -> f64 {
    let Some(first) = values.first() else {
        return 0.0;
    };
    // The last counted value is the furthest in the current direction.
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

/// The mean of a rate at rest, if it is significant; otherwise 0.
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
    if there.len() >= MIN_SAMPLES && is_clear {
        mean
    } else {
        0.0
    }
}

/// Spans in which all wheels stand still \[s\].
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
    fn reversals_count_in_full_and_noise_does_not() {
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
            .map(|(distance, noise)| distance + noise)
            .collect();
        assert!((length(&noisy, 0.2) - 15.0).abs() < 0.5);
    }

    #[test]
    fn turning_in_a_gap_does_not_count() {
        let times = (0..=100).chain(100_000..=100_100);
        let rate: Series = times.map(|k| (0.05 * f64::from(k), 0.4)).collect();
        let turned = MotionSummary::of(&Run::new("").with(Channel::YawRate, rate)).turned;
        assert!((turned.unwrap() - 0.4 * 10.0).abs() < 1e-9, "{turned:?}");
    }

    #[test]
    fn a_vehicle_that_stands_goes_nowhere() {
        let times = || (0..2000).map(|k| (0.05 * f64::from(k), f64::from(k % 2) - 0.5));
        let still = || times().map(|(time, _)| (time, 0.0)).collect::<Series>();
        let noisy = |mean: f64, size: f64| -> Series {
            times()
                .map(|(time, swing)| (time, mean + size * swing))
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
            let MotionSummary {
                distance, turned, ..
            } = MotionSummary::of(&run);
            assert_eq!(distance, Some(0.0));
            assert!(turned.unwrap() < 1e-9, "{turned:?}");
        }
    }
}
