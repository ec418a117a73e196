//! The course over which a vehicle came to where it is.

use super::{Series, upper_median};
use std::ops::Range;

/// A course begins so long before its end \[s\].
const SECONDS: f64 = 40.0;
/// Poses are told at samples of the position that are this far apart, or further \[s\].
const SPACING: f64 = 0.05;
/// A pose between samples further apart than this is not known \[s\].
const GAP: f64 = 1.2;
/// A course begins behind the last gap that is longer than this \[s\].
const BRIDGED: f64 = 2.0;
/// A pose is that of the lines through the samples this near \[s\], or the nearest so many of those that are at least this
/// near \[s\].
const REACH: f64 = 0.3;
const ENOUGH: usize = 5;
const FARTHEST: f64 = 0.6;
/// Up to so many samples have a line that one of them cannot bend to begin with.
const FEW: usize = 12;
/// Samples that are off by so many times the usual count half, after so many rounds.
const FAR: f64 = 2.0;
const ROUNDS: usize = 5;

/// Where a vehicle was, less the noise that sensors have from one sample to the next, and outliers.
#[derive(Debug, Clone, Default)]
pub struct Course {
    /// Position, x and y \[m\], and heading \[rad\] as they were recorded.
    told: [Series; 3],
    /// When poses are known \[s\].
    time: Vec<f64>,
    /// Those x, y \[m\] and heading \[rad\].
    poses: Vec<[f64; 3]>,
}

impl Course {
    /// From x, y \[m\] and heading \[rad\] of one run.
    #[must_use]
    pub fn new(x: &Series, y: &Series, heading: &Series) -> Self {
        let mut course = Self {
            told: [x, y, heading].map(Clone::clone),
            ..Self::default()
        };
        let mut next = f64::NEG_INFINITY;
        for at in x.time.iter().copied() {
            if at < next {
                continue;
            }
            if let Some(pose) = course.pose(at) {
                course.time.push(at);
                course.poses.push(pose);
                next = at + SPACING;
            }
        }
        course
    }

    /// Poses x, y \[m\] and heading \[rad\] over which the vehicle came to where it was at a time \[s\], the oldest first
    /// and that of the time itself last. Empty where that one is not known.
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
        let [x, y, heading] = &self.told;
        Some([smooth(x, time)?, smooth(y, time)?, smooth(heading, time)?])
    }
}

/// Value at a time of the line through the samples around it, of which those that are off count less (Cauchy's weights);
/// `None` outside a series and in a gap of it.
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

/// The samples that tell a value at a time.
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

/// Value at 0 and slope of the line with the median of the slopes between samples (Theil and Sen), and of what is left.
fn median_line(samples: &[(f64, f64)]) -> [f64; 2] {
    let pairs = samples.iter().enumerate();
    let slopes = pairs.flat_map(|(k, (at, value))| {
        let later = samples[k + 1..].iter();
        later.map(move |(then, other)| (other - value) / (then - at))
    });
    let slope = upper_median(slopes.collect()).unwrap_or(0.0);
    let left = samples.iter().map(|(at, value)| value - slope * at);
    [upper_median(left.collect()).unwrap_or(0.0), slope]
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_course_ends_where_it_is_asked_for_and_forgets_what_was_long_ago() {
        let series = |slope: f64| -> Series {
            let times = (0..=600).map(|k| 0.1 * f64::from(k));
            times.map(|time| (time, slope * time)).collect()
        };
        let (x, y, heading) = (series(1.0), series(-0.5), series(0.1));
        let all = Course::new(&x, &y, &heading);
        let course = all.to(50.05);
        let last = course.last().unwrap();
        for (found, slope) in last.iter().zip([1.0, -0.5, 0.1]) {
            assert!((found - slope * 50.05).abs() < 1e-9, "{found}");
        }
        assert!((course[0][0] - 10.1).abs() < 1e-9, "{:?}", course[0]);
        assert_eq!(course.len(), 401);
        // At the beginning there is none, beyond the end it is not known.
        assert_eq!(all.to(0.0).len(), 1);
        assert!(all.to(60.1).is_empty());
    }

    #[test]
    fn one_sample_far_off_hardly_bends_a_course() {
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
    fn a_pose_within_a_gap_is_not_known_and_a_course_begins_behind_a_long_one() {
        let with = |gap: [f64; 2]| -> Course {
            let times = (0..300).map(|k| 0.1 * f64::from(k));
            let kept = times.filter(|at| *at < gap[0] + 1e-9 || *at > gap[1] - 1e-9);
            let line: Series = kept.map(|at| (at, at)).collect();
            Course::new(&line, &line, &line)
        };
        assert!(with([10.0, 11.5]).to(10.7).is_empty());
        assert_eq!(with([10.0, 11.5]).to(20.0).len(), 201 - 14);
        assert!((with([10.0, 12.5]).to(20.0)[0][0] - 12.5).abs() < 1e-9);
        assert_eq!(with([10.0, 11.0]).to(10.5).len(), 102);
    }

    #[test]
    fn samples_of_a_fast_sensor_are_thinned() {
        let line: Series = (0..6000).map(|k| (0.01 * f64::from(k), 0.02)).collect();
        assert!(Course::new(&line, &line, &line).to(50.0).len() <= 801);
    }

    #[test]
    fn samples_that_are_far_apart_count_as_they_are() {
        let series: Series = [(0.0, 1.0), (2.0, 5.0), (4.0, 3.0)].into_iter().collect();
        assert_eq!(smooth(&series, 2.0), Some(5.0));
        assert_eq!(smooth(&series, 1.0), None);
        let series: Series = [(0.0, 1.0), (1.0, 5.0), (2.0, 3.0)].into_iter().collect();
        assert_eq!(smooth(&series, 0.5), Some(3.0));
    }
}
