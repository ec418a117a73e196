//! Plausibility checks of wheel speeds and forward speed.

use super::collect::TimedValues;

/// Minimum number of samples for a conclusion.
const MIN_SAMPLES: usize = 20;
/// Slower wheels stand and have no direction \[rad/s\].
pub(super) const STANDING: f64 = 0.2;
/// A speed was computed from the wheel speeds if it deviates by less than this share of its standard deviation: slip
/// scatters more on any soil.
pub(super) const COMPUTED: f64 = 5e-3;
/// The same for a topic whose name claims an independent sensor.
pub(super) const COMPUTED_DESPITE_NAME: f64 = 1e-3;
/// Speeds with a smaller variation, as a share of their mean, allow no conclusion: they follow from anything steady.
const STEADY: f64 = 0.02;
/// Sides with opposite signs in this share of the drive are mirrored; otherwise the vehicle pivots.
const MIRRORED: f64 = 0.9;
/// Correlation beyond which wheels and vehicle go opposite ways.
const OPPOSITE: f64 = -0.5;

/// Relation between forward speed and wheel speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Follows {
    /// Possible for a measurement.
    Loosely,
    /// Exact, with this radius \[m\].
    Exactly(f64),
    /// With the opposite sign.
    Opposite,
}

/// The value at a time, linear between samples.
pub(super) fn at(series: &[(i64, f64)], time: i64) -> Option<f64> {
    let after = series.partition_point(|(sample, _)| *sample < time);
    let (to, end) = *series.get(after)?;
    if to == time {
        return Some(end);
    }
    let (from, start) = *series.get(after.checked_sub(1)?)?;
    Some(start + (end - start) * (time - from) as f64 / (to - from) as f64)
}

/// Compares forward speed with the mean wheel speed of both sides. A deviation below the share `computed` of the speed's
/// variation shows that the speed was computed from the wheels.
pub(super) fn follows(
    left: &TimedValues,
    right: &TimedValues,
    v_x: &TimedValues,
    computed: f64,
) -> Follows {
    let pairs: Vec<(f64, f64)> = v_x
        .iter()
        .filter_map(|(time, speed)| {
            let turning = 0.5 * (at(left, *time)? + at(right, *time)?);
            Some((turning, *speed))
        })
        .collect();
    let sum = |term: fn(&(f64, f64)) -> f64| pairs.iter().map(term).sum::<f64>();
    let (turning, both, speed) = (
        sum(|(turning, _)| turning * turning),
        sum(|(turning, speed)| turning * speed),
        sum(|(_, speed)| speed * speed),
    );
    let moved = turning > pairs.len() as f64 * STANDING * STANDING && speed > 0.0;
    if pairs.len() < MIN_SAMPLES || !moved {
        return Follows::Loosely;
    }
    let radius = both / turning;
    let deviation = (speed - radius * both).max(0.0);
    let count = pairs.len() as f64;
    let mean = sum(|(_, speed)| *speed) / count;
    let variation = speed - count * mean * mean;
    let varies = variation > count * (STEADY * mean).powi(2);
    if radius > 0.0 && varies && deviation < computed * computed * variation {
        Follows::Exactly(radius)
    } else if both < OPPOSITE * (turning * speed).sqrt() {
        Follows::Opposite
    } else {
        Follows::Loosely
    }
}

/// Whether the sides have opposite signs nearly all the time.
pub(super) fn mirrored(left: &TimedValues, right: &TimedValues) -> bool {
    let moving: Vec<bool> = left
        .iter()
        .filter_map(|(time, left)| {
            let right = at(right, *time)?;
            (left.abs() > STANDING && right.abs() > STANDING).then_some(left * right < 0.0)
        })
        .collect();
    let against = moving.iter().filter(|against| **against).count();
    moving.len() >= MIN_SAMPLES && against as f64 > MIRRORED * moving.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(value: impl Fn(f64) -> f64) -> TimedValues {
        (0..200).map(|k| (k * 10, value(k as f64 * 0.1))).collect()
    }

    #[test]
    fn between_samples_is_linear_and_beyond_is_nothing() {
        let series = [(0, 1.0), (10, 3.0)];
        assert_eq!(
            [0, 5, 10].map(|t| at(&series, t)),
            [1.0, 2.0, 3.0].map(Some)
        );
        assert_eq!([-1, 11].map(|t| at(&series, t)), [None, None]);
    }

    #[test]
    fn computed_speeds_are_distinguished_from_measured_ones() {
        let (left, right) = (series(|t| 4.0 + t.sin()), series(|t| 5.0 + t.cos()));
        let computed = series(|t| 0.15 * (9.0 + t.sin() + t.cos()) / 2.0);
        let Follows::Exactly(radius) = follows(&left, &right, &computed, COMPUTED) else {
            panic!()
        };
        assert!((radius - 0.15).abs() < 1e-12);
        // Slip that varies by 2 %.
        let slipping =
            series(|t| 0.15 * (9.0 + t.sin() + t.cos()) / 2.0 * (0.95 + 0.02 * (0.3 * t).sin()));
        assert_eq!(
            follows(&left, &right, &slipping, COMPUTED),
            Follows::Loosely
        );
        let back = series(|t| -0.7 - 0.1 * t.sin());
        assert_eq!(follows(&left, &right, &back, COMPUTED), Follows::Opposite);
        let still = series(|_| 0.0);
        assert_eq!(follows(&still, &still, &still, COMPUTED), Follows::Loosely);
    }

    #[test]
    fn a_steady_drive_does_not_make_a_measurement_wheel_odometry() {
        // 4 m/s with a variation of a tenth; slip varies by one in 300.
        let wheels = series(|t| 20.0 + 2.0 * t.sin());
        let measured = series(|t| 0.19 * (20.0 + 2.0 * t.sin()) * (1.0 + 0.003 * (0.7 * t).cos()));
        assert_eq!(
            follows(&wheels, &wheels, &measured, COMPUTED),
            Follows::Loosely
        );
        // A steady speed follows from any other steady one.
        let steady = series(|t| 20.0 + 0.1 * t.sin());
        let half = series(|t| 0.19 * (20.0 + 0.1 * t.sin()));
        assert_eq!(follows(&steady, &steady, &half, COMPUTED), Follows::Loosely);
        // A name that claims an independent sensor requires more evidence.
        let nearly =
            series(|t| 0.19 * (20.0 + 8.0 * t.sin()) + 0.19 * 8.0 * 0.002 * (3.0 * t).cos());
        let wheels = series(|t| 20.0 + 8.0 * t.sin());
        let of = |share| follows(&wheels, &wheels, &nearly, share);
        assert!(matches!(of(COMPUTED), Follows::Exactly(_)));
        assert_eq!(of(COMPUTED_DESPITE_NAME), Follows::Loosely);
    }

    #[test]
    fn mirrored_sides_turn_against_each_other() {
        let (left, right) = (series(|t| 4.0 + t.sin()), series(|t| -5.0 + t.cos()));
        assert!(mirrored(&left, &right));
        assert!(!mirrored(&left, &left));
        // Half of the drive is a pivot.
        let pivot = series(|t| if t < 10.0 { -4.0 } else { 4.0 });
        assert!(!mirrored(&left, &pivot));
    }
}
