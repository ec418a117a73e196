//! The course over which a vehicle came to where it is.

use super::Series;

/// A course begins so long before its end \[s\].
const SECONDS: f64 = 40.0;
/// A pose is that of the lines through the samples this near \[s\], where there are enough.
const REACH: f64 = 0.3;
const ENOUGH: usize = 3;
/// Samples that are off by so many times the usual count half, after so many rounds.
const FAR: f64 = 2.0;
const ROUNDS: usize = 5;

/// Poses x, y \[m\] and heading \[rad\] over which a vehicle came to where it is at a time \[s\], the oldest first and that
/// of the time itself last; less the noise that sensors have from one sample to the next, and outliers. Empty where
/// that one is not known.
#[must_use]
pub fn course_to(x: &Series, y: &Series, heading: &Series, time: f64) -> Vec<[f64; 3]> {
    let pose = |at: f64| Some([smooth(x, at)?, smooth(y, at)?, smooth(heading, at)?]);
    let Some(last) = pose(time) else {
        return Vec::new();
    };
    let first = x.time.partition_point(|at| *at < time - SECONDS);
    let end = x.time.partition_point(|at| *at < time);
    let before = x.time[first.min(end)..end].iter();
    before
        .filter_map(|at| pose(*at))
        .chain(std::iter::once(last))
        .collect()
}

/// Value at a time of the line through the samples around it, of which those that are off count less (Cauchy's weights);
/// `None` outside a series.
fn smooth(series: &Series, time: f64) -> Option<f64> {
    let between = series.at(time)?;
    let first = series.time.partition_point(|at| *at < time - REACH);
    let end = series.time.partition_point(|at| *at <= time + REACH);
    let times = series.time[first..end].iter().map(|at| at - time);
    let samples: Vec<(f64, f64)> = times
        .zip(series.value[first..end].iter().copied())
        .collect();
    if samples.len() < ENOUGH {
        return Some(between);
    }
    let mut weights = vec![1.0; samples.len()];
    let mut line = weighted_line(&samples, &weights);
    for _ in 0..ROUNDS {
        let off = |(at, value): &(f64, f64)| (value - line[0] - line[1] * at).abs();
        let away: Vec<f64> = samples.iter().map(off).collect();
        let mut sorted = away.clone();
        let middle = sorted.len() / 2;
        let usual = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
        if usual <= 0.0 {
            break;
        }
        for (weight, away) in weights.iter_mut().zip(away) {
            *weight = 1.0 / (1.0 + (away / (FAR * usual)).powi(2));
        }
        line = weighted_line(&samples, &weights);
    }
    Some(line[0])
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
        let course = course_to(&x, &y, &heading, 50.05);
        let last = course.last().unwrap();
        for (found, slope) in last.iter().zip([1.0, -0.5, 0.1]) {
            assert!((found - slope * 50.05).abs() < 1e-9, "{found}");
        }
        assert!((course[0][0] - 10.1).abs() < 1e-9, "{:?}", course[0]);
        assert_eq!(course.len(), 401);
        // At the beginning there is none, beyond the end it is not known.
        assert_eq!(course_to(&x, &y, &heading, 0.0).len(), 1);
        assert!(course_to(&x, &y, &heading, 60.1).is_empty());
    }

    #[test]
    fn one_sample_far_off_hardly_bends_a_course() {
        let at = |k: usize| 0.1 * k as f64;
        let noise = |k: usize| 0.01 * (7.3 * k as f64).sin();
        let straight: Series = (0..100).map(|k| (at(k), at(k) + noise(k))).collect();
        let mut stray = straight.clone();
        stray.value[50] += 3.0;
        for k in 45..56 {
            let [good, bad] = [&straight, &stray].map(|series| smooth(series, at(k)).unwrap());
            assert!(
                (good - at(k)).abs() < 0.01 && (bad - at(k)).abs() < 0.03,
                "{k} {bad}"
            );
        }
    }

    #[test]
    fn samples_that_are_far_apart_count_as_they_are() {
        let series: Series = [(0.0, 1.0), (2.0, 5.0), (4.0, 3.0)].into_iter().collect();
        assert_eq!(smooth(&series, 1.0), Some(3.0));
        assert_eq!(smooth(&series, 2.0), Some(5.0));
    }
}
