//! What the samples say about what they are.

use super::wheels::Series;

/// Fewer samples than this prove nothing.
const FEWEST: usize = 20;
/// Wheels slower than this stand, for telling their direction \[rad/s\].
pub(super) const STANDING: f64 = 0.2;
/// Speeds that follow from wheel speeds this well, as a share of their own standard deviation,
/// were computed from them: over any soil slip alone scatters more.
pub(super) const COMPUTED: f64 = 5e-3;
/// The same where a name says otherwise.
pub(super) const COMPUTED_DESPITE_NAME: f64 = 1e-3;
/// Speeds that vary less than this share of their mean follow from anything that is steady.
const STEADY: f64 = 0.02;
/// Sides that turn against each other in this share of the drive are mirrored, not pivoting.
const MIRRORED: f64 = 0.9;
/// Correlation beyond which wheels and vehicle go opposite ways.
const OPPOSITE: f64 = -0.5;

/// How forward speed goes with wheel speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Follows {
    /// As a measurement may.
    Loosely,
    /// Exactly, with this radius \[m\].
    Exactly(f64),
    /// Backwards.
    Opposite,
}

/// The value of a series between its samples.
pub(super) fn at(series: &[(i64, f64)], time: i64) -> Option<f64> {
    let after = series.partition_point(|(sample, _)| *sample < time);
    let (to, end) = *series.get(after)?;
    if to == time {
        return Some(end);
    }
    let (from, start) = *series.get(after.checked_sub(1)?)?;
    Some(start + (end - start) * (time - from) as f64 / (to - from) as f64)
}

/// Compares forward speed with the mean of both sides' wheel speeds; what it leaves over below the share
/// `computed` of the speed's variation shows that it was computed from them.
pub(super) fn follows(left: &Series, right: &Series, v_x: &Series, computed: f64) -> Follows {
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
    if pairs.len() < FEWEST || !moved {
        return Follows::Loosely;
    }
    // Of the best radius, what it leaves over.
    let radius = both / turning;
    let left_over = (speed - radius * both).max(0.0);
    let count = pairs.len() as f64;
    let mean = sum(|(_, speed)| *speed) / count;
    let variation = speed - count * mean * mean;
    let varies = variation > count * (STEADY * mean).powi(2);
    if radius > 0.0 && varies && left_over < computed * computed * variation {
        Follows::Exactly(radius)
    } else if both < OPPOSITE * (turning * speed).sqrt() {
        Follows::Opposite
    } else {
        Follows::Loosely
    }
}

/// Whether the sides turn against each other nearly all the time.
pub(super) fn mirrored(left: &Series, right: &Series) -> bool {
    let moving: Vec<bool> = left
        .iter()
        .filter_map(|(time, left)| {
            let right = at(right, *time)?;
            (left.abs() > STANDING && right.abs() > STANDING).then_some(left * right < 0.0)
        })
        .collect();
    let against = moving.iter().filter(|against| **against).count();
    moving.len() >= FEWEST && against as f64 > MIRRORED * moving.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(value: impl Fn(f64) -> f64) -> Series {
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
    fn computed_speeds_are_told_from_measured_ones() {
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
        // 4 m/s that vary by a tenth; slip is the same but for a part in 300.
        let wheels = series(|t| 20.0 + 2.0 * t.sin());
        let measured = series(|t| 0.19 * (20.0 + 2.0 * t.sin()) * (1.0 + 0.003 * (0.7 * t).cos()));
        assert_eq!(
            follows(&wheels, &wheels, &measured, COMPUTED),
            Follows::Loosely
        );
        // What hardly varies follows from anything that does not either.
        let steady = series(|t| 20.0 + 0.1 * t.sin());
        let half = series(|t| 0.19 * (20.0 + 0.1 * t.sin()));
        assert_eq!(follows(&steady, &steady, &half, COMPUTED), Follows::Loosely);
        // A name that says otherwise asks for more.
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
