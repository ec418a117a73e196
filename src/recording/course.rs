//! The course over which a vehicle came to where it is.

use super::Series;

/// A course begins so long before its end \[s\].
const SECONDS: f64 = 40.0;
/// A pose is that of the lines through the samples this near \[s\], where there are enough.
const REACH: f64 = 0.3;
const ENOUGH: usize = 3;

/// Poses x, y \[m\] and heading \[rad\] over which a vehicle came to where it is at a time \[s\], the oldest first and that
/// of the time itself last; less the noise that sensors have from one sample to the next. Empty where that one
/// is not known.
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

/// Value at a time of the line through the samples around it; `None` outside a series.
fn smooth(series: &Series, time: f64) -> Option<f64> {
    let between = series.at(time)?;
    let first = series.time.partition_point(|at| *at < time - REACH);
    let end = series.time.partition_point(|at| *at <= time + REACH);
    if end - first < ENOUGH {
        return Some(between);
    }
    let samples = || {
        series.time[first..end]
            .iter()
            .zip(&series.value[first..end])
    };
    let count = (end - first) as f64;
    let mean_time = samples().map(|(at, _)| at - time).sum::<f64>() / count;
    let mean = samples().map(|(_, value)| value).sum::<f64>() / count;
    let (mut product, mut square) = (0.0, 0.0);
    for (at, value) in samples() {
        let off = at - time - mean_time;
        product += off * (value - mean);
        square += off * off;
    }
    Some(mean - mean_time * product / square)
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
    fn samples_that_are_far_apart_count_as_they_are() {
        let series: Series = [(0.0, 1.0), (2.0, 5.0), (4.0, 3.0)].into_iter().collect();
        assert_eq!(smooth(&series, 1.0), Some(3.0));
        assert_eq!(smooth(&series, 2.0), Some(5.0));
    }
}
