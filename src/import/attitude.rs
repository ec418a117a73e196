//! Heading from attitude.

use std::f64::consts::{PI, TAU};

/// Minimum length of a quaternion; publishers without an attitude send zeros.
const SHORTEST: f64 = 1e-3;
/// Larger deviations of a quaternion's length from 1 are noted.
const LENGTH_TOLERANCE: f64 = 1e-2;

/// The heading of a quaternion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Yaw {
    /// Heading \[rad\] in (-pi, pi\].
    Of(f64),
    /// The same from a quaternion whose length is not 1.
    Normalised(f64),
    /// Unknown: the quaternion is zero or not finite.
    None,
}

/// The heading of an attitude x, y, z, w: the angle about z, applied after roll and pitch.
pub(super) fn yaw(quaternion: [f64; 4]) -> Yaw {
    let length = quaternion
        .iter()
        .map(|component| component * component)
        .sum::<f64>()
        .sqrt();
    if !length.is_finite() || length < SHORTEST {
        return Yaw::None;
    }
    let [x, y, z, w] = quaternion.map(|component| component / length);
    let heading = (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z));
    if (length - 1.0).abs() > LENGTH_TOLERANCE {
        Yaw::Normalised(heading)
    } else {
        Yaw::Of(heading)
    }
}

/// The angle nearest to `before` that differs from `angle` by whole turns \[rad\].
pub(super) fn unwrap(before: f64, angle: f64) -> f64 {
    let step = (angle - before + PI).rem_euclid(TAU) - PI;
    before + step
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn yaw_of_known_attitudes() {
        let half = 0.35_f64;
        let Yaw::Of(heading) = yaw([0.0, 0.0, half.sin(), half.cos()]) else {
            panic!()
        };
        assert!((heading - 0.7).abs() < 1e-15);
        // Yaw 2, then pitch 0.4, then roll -0.3: the product of the three turns by hand.
        let turn = |angle: f64| (angle / 2.0).sin_cos();
        let ((sz, cz), (sy, cy), (sx, cx)) = (turn(2.0), turn(0.4), turn(-0.3));
        let quaternion = [
            cz * cy * sx - sz * sy * cx,
            cz * sy * cx + sz * cy * sx,
            sz * cy * cx - cz * sy * sx,
            cz * cy * cx + sz * sy * sx,
        ];
        let Yaw::Of(heading) = yaw(quaternion) else {
            panic!()
        };
        assert!((heading - 2.0).abs() < 1e-14, "{heading}");
        assert_eq!(
            yaw(quaternion.map(|component| -3.0 * component)),
            Yaw::Normalised(heading)
        );
        assert_eq!(yaw([0.0; 4]), Yaw::None);
        assert_eq!(yaw([f64::NAN, 0.0, 0.0, 1.0]), Yaw::None);
    }

    #[test]
    fn turns_add_up() {
        let mut heading = 3.0;
        for wrapped in [3.1, -3.1, -2.0, 0.0, 2.0, 3.1, -3.1] {
            heading = unwrap(heading, wrapped);
        }
        assert!((heading - (-3.1 + 2.0 * TAU)).abs() < 1e-12, "{heading}");
        assert!((unwrap(0.1, -0.1) + 0.1).abs() < 1e-15);
    }
}
