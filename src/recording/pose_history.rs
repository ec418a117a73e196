//! The path that a vehicle has driven up to a time.

use super::series::Series;
use super::statistics::upper_median;
use std::ops::Range;

/// A path covers this duration before its end \[s\].
const SECONDS: f64 = 40.0;
/// Minimum interval between the poses of a path \[s\].
const SPACING: f64 = 0.05;
/// Between samples further apart than this the pose is unknown \[s\].
const GAP: f64 = 1.2;
/// A path starts after the last gap that is longer than this \[s\].
const BRIDGED: f64 = 2.0;
/// A pose is the value of lines through the samples within REACH \[s\]. If these are fewer than ENOUGH, the lines go
/// through the ENOUGH nearest samples within FARTHEST \[s\].
const REACH: f64 = 0.3;
const ENOUGH: usize = 5;
const FARTHEST: f64 = 0.6;
/// For up to this many samples the initial line is robust against an outlier.
const FEW: usize = 12;
/// Samples at this multiple of the median distance have half the weight; rounds of reweighting.
const FAR: f64 = 2.0;
const ROUNDS: usize = 5;

/// The poses of a vehicle over time, smoothed against noise and outliers.
#[derive(Debug, Clone, Default)]
pub struct PoseHistory {
    /// Recorded x, y \[m\] and heading \[rad\].
    recorded: [Series; 3],
    /// Times of the smoothed poses \[s\].
    time: Vec<f64>,
    /// Smoothed x, y \[m\] and heading \[rad\].
    poses: Vec<[f64; 3]>,
}

impl PoseHistory {
    /// From x, y \[m\] and heading \[rad\] of one run.
    #[must_use]
    pub fn new(x: &Series, y: &Series, heading: &Series) -> Self {
        let mut history = Self {
            recorded: [x, y, heading].map(Clone::clone),
            ..Self::default()
        };
        let mut next = f64::NEG_INFINITY;
        for at in x.time.iter().copied() {
            if at < next {
                continue;
            }
            if let Some(pose) = history.pose(at) {
                history.time.push(at);
                history.poses.push(pose);
                next = at + SPACING;
            }
        }
        history
    }

    /// Poses x, y \[m\] and heading \[rad\] of the path up to a time \[s\]: the oldest first, the pose at that time last. Empty
    /// if that pose is unknown.
    #[must_use]
    pub fn to(&self, time: f64) -> Vec<[f64; 3]> {
        let Some(here) = self.pose(time) else {
            return Vec::new();
        };
        let earliest = self.time.partition_point(|at| *at < time - SECONDS);
        let end = self.time.partition_point(|at| *at < time);
        let mut first = end;
        let mut later = time;
        while first > earliest && later - self.time[first - 1] <= BRIDGED {
            first -= 1;
            later = self.time[first];
        }
        let mut poses = self.poses[first..end].to_vec();
        poses.push(here);
        poses
    }

    /// The pose at a time \[s\].
    fn pose(&self, time: f64) -> Option<[f64; 3]> {
        let [x, y, heading] = &self.recorded;
        Some([smooth(x, time)?, smooth(y, time)?, smooth(heading, time)?])
    }
}

/// Value at a time of the line through the samples around it, with Cauchy's weights against outliers. `None` outside the
/// series and in its gaps.
fn smooth(series: &Series, time: f64) -> Option<f64> {
    let between = series.at(time)?;
    let after = series.time.partition_point(|at| *at < time);
    let before = series.time.partition_point(|at| *at <= time).max(1) - 1;
    if series.time.get(after)? - series.time[before] > GAP {
        return None;
    }
    let near = nearest(&series.time, time);
    if near.len() < ENOUGH {
        return Some(between);
    }
    let times = series.time[near.clone()].iter().map(|at| at - time);
    let values = series.value[near].iter().copied();
    let samples: Vec<(f64, f64)> = times.zip(values).collect();
    let mut weights = vec![1.0; samples.len()];
    let mut line = if samples.len() > FEW {
        weighted_line(&samples, &weights)
    } else {
        median_line(&samples)
    };
    for _ in 0..ROUNDS {
        let off = |(at, value): &(f64, f64)| (value - line[0] - line[1] * at).abs();
        let away: Vec<f64> = samples.iter().map(off).collect();
        let Some(usual) = upper_median(away.clone()).filter(|usual| *usual > 0.0) else {
            break;
        };
        for (weight, away) in weights.iter_mut().zip(away) {
            *weight = 1.0 / (1.0 + (away / (FAR * usual)).powi(2));
        }
        line = weighted_line(&samples, &weights);
    }
    Some(line[0])
}

/// The samples around a time through which a line is fitted.
fn nearest(times: &[f64], time: f64) -> Range<usize> {
    let within = |reach: f64| {
        let first = times.partition_point(|at| *at < time - reach);
        first..times.partition_point(|at| *at <= time + reach)
    };
    let near = within(REACH);
    if near.len() >= ENOUGH {
        return near;
    }
    let mut near = within(FARTHEST);
    while near.len() > ENOUGH {
        if time - times[near.start] > times[near.end - 1] - time {
            near.start += 1;
        } else {
            near.end -= 1;
        }
    }
    near
}

/// Value at 0 and slope of the line with the median slope between samples (Theil and Sen), and the median offset.
fn median_line(samples: &[(f64, f64)]) -> [f64; 2] {
    let pairs = samples.iter().enumerate();
    let slopes = pairs.flat_map(|(k, (at, value))| {
        let later = samples[k + 1..].iter();
        later.map(move |(then, other)| (other - value) / (then - at))
    });
    let slope = upper_median(slopes.collect()).unwrap_or(0.0);
    let offsets = samples.iter().map(|(at, value)| value - slope * at);
    [upper_median(offsets.collect()).unwrap_or(0.0), slope]
}

/// Value at 0 and slope of the line through samples (at, value).
fn weighted_line(samples: &[(f64, f64)], weights: &[f64]) -> [f64; 2] {
    let sum = |of: fn(f64, f64) -> f64| -> f64 {
        let each = samples.iter().zip(weights);
        each.map(|((at, value), weight)| weight * of(*at, *value))
            .sum()
    };
    let weight = sum(|_, _| 1.0);
    let (mean_at, mean) = (sum(|at, _| at) / weight, sum(|_, value| value) / weight);
    let square = sum(|at, _| at * at) / weight - mean_at * mean_at;
    let product = sum(|at, value| at * value) / weight - mean_at * mean;
    let slope = if square > 0.0 { product / square } else { 0.0 };
    [mean - slope * mean_at, slope]
}

/// Distance along the heading from the first position on \[m\], decreasing in reverse. It is known at the times of x at
/// which y and the heading \[rad\] are known.
#[must_use]
pub fn distance_along_heading(x: &Series, y: &Series, heading: &Series) -> Series {
    let mut total = 0.0;
    let mut last: Option<[f64; 3]> = None;
    let mut points = Vec::new();
    for (time, east) in x.samples() {
        let (Some(north), Some(angle)) = (y.at(time), heading.at(time)) else {
            continue;
        };
        if let Some([from_east, from_north, from]) = last {
            // The direction of the sum of both is the mean direction, wrapped or not.
            let (cos, sin) = (angle.cos() + from.cos(), angle.sin() + from.sin());
            let length = cos.hypot(sin).max(f64::MIN_POSITIVE);
            total += ((east - from_east) * cos + (north - from_north) * sin) / length;
        }
        last = Some([east, north, angle]);
        points.push((time, total));
    }
    points.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_ends_at_its_time_and_drops_old_poses() {
        let series = |slope: f64| -> Series {
            let times = (0..=600).map(|k| 0.1 * f64::from(k));
            times.map(|time| (time, slope * time)).collect()
        };
        let (x, y, heading) = (series(1.0), series(-0.5), series(0.1));
        let all = PoseHistory::new(&x, &y, &heading);
        let path = all.to(50.05);
        let last = path.last().unwrap();
        for (found, slope) in last.iter().zip([1.0, -0.5, 0.1]) {
            assert!((found - slope * 50.05).abs() < 1e-9, "{found}");
        }
        assert!((path[0][0] - 10.1).abs() < 1e-9, "{:?}", path[0]);
        assert_eq!(path.len(), 401);
        // At the start the path is one pose, beyond the end the pose is unknown.
        assert_eq!(all.to(0.0).len(), 1);
        assert!(all.to(60.1).is_empty());
    }

    #[test]
    fn an_outlier_hardly_bends_a_path() {
        let noise = |k: usize| 0.01 * (7.3 * k as f64).sin();
        for rate in [4.0, 5.0, 8.0, 10.0, 25.0] {
            let at = |k: usize| k as f64 / rate;
            let straight: Series = (0..100).map(|k| (at(k), at(k) + noise(k))).collect();
            let mut stray = straight.clone();
            stray.value[50] += 3.0;
            for k in 40..60 {
                let [good, bad] = [&straight, &stray].map(|series| smooth(series, at(k)).unwrap());
                assert!(
                    (good - at(k)).abs() < 0.015 && (bad - at(k)).abs() < 0.03,
                    "{rate} {k} {bad}"
                );
            }
        }
    }

    #[test]
    fn a_pose_within_a_gap_is_unknown_and_a_path_starts_after_a_long_gap() {
        let with = |gap: [f64; 2]| -> PoseHistory {
            let times = (0..300).map(|k| 0.1 * f64::from(k));
            let kept = times.filter(|at| *at < gap[0] + 1e-9 || *at > gap[1] - 1e-9);
            let line: Series = kept.map(|at| (at, at)).collect();
            PoseHistory::new(&line, &line, &line)
        };
        assert!(with([10.0, 11.5]).to(10.7).is_empty());
        assert_eq!(with([10.0, 11.5]).to(20.0).len(), 201 - 14);
        assert!((with([10.0, 12.5]).to(20.0)[0][0] - 12.5).abs() < 1e-9);
        assert_eq!(with([10.0, 11.0]).to(10.5).len(), 102);
    }

    #[test]
    fn samples_of_a_fast_sensor_are_thinned() {
        let line: Series = (0..6000).map(|k| (0.01 * f64::from(k), 0.02)).collect();
        assert!(PoseHistory::new(&line, &line, &line).to(50.0).len() <= 801);
    }

    #[test]
    fn samples_far_apart_are_not_smoothed() {
        let series: Series = [(0.0, 1.0), (2.0, 5.0), (4.0, 3.0)].into_iter().collect();
        assert_eq!(smooth(&series, 2.0), Some(5.0));
        assert_eq!(smooth(&series, 1.0), None);
        let series: Series = [(0.0, 1.0), (1.0, 5.0), (2.0, 3.0)].into_iter().collect();
        assert_eq!(smooth(&series, 0.5), Some(3.0));
    }

    #[test]
    fn reverse_counts_backward_and_sideways_not_at_all() {
        let series = |values: [f64; 4]| -> Series {
            let times = [0.0, 1.0, 2.0, 3.0];
            times.into_iter().zip(values).collect()
        };
        let x = series([0.0, 2.0, 1.0, 1.0]);
        let y = series([0.0, 0.0, 0.0, 5.0]);
        assert_eq!(
            distance_along_heading(&x, &y, &series([0.0; 4])).value,
            [0.0, 2.0, 1.0, 1.0]
        );
    }
}
