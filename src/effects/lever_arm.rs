//! An antenna off the reference point.

use super::declaration::effect;
use crate::scalar::{Elementary, Scalar};

effect! {
    /// The position is that of another point of the vehicle.
    LeverArm: "lever_arm", Sensors,
    phrase "an antenna off the reference point",
    lifts "perfect measurement: pose of the reference point",
    equation "x_reported = x + x_a cos psi - y_a sin psi, y_reported = y + x_a sin psi + y_a cos psi",
    source "rigid-body kinematics",
    check "Measure how far the antenna is ahead of the reference point and to its left.",
    {
        ahead ["m"] -5.0..5.0, off 0.0, normal(0.0, 0.3), "Place of the antenna ahead of the reference point";
        left ["m"] -5.0..5.0, off 0.0, normal(0.0, 0.3), "Place of the antenna to its left";
    }
}

impl<S: Scalar> LeverArm<S> {
    /// Position of the antenna \[m\] on a vehicle at a position and heading.
    pub fn position(&self, position: [S; 2], heading: S) -> [S; 2] {
        let (sin, cos) = heading.sin_cos();
        [
            position[0] + self.ahead * cos - self.left * sin,
            position[1] + self.ahead * sin + self.left * cos,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heading_north_ahead_is_north_and_left_is_west() {
        let arm = LeverArm {
            ahead: 0.5,
            left: 0.2,
        };
        let [x, y] = arm.position([1.0, 2.0], std::f64::consts::FRAC_PI_2);
        assert!((x - 0.8).abs() < 1e-12 && (y - 2.5).abs() < 1e-12);
    }
}
