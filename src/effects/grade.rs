//! A slope under the vehicle.

use super::declaration::effect;
use crate::scalar::{Elementary, Scalar};

effect! {
    /// Inclined ground: gravity pulls along the fall line, and presses less on the ground.
    ///
    /// Positions are measured along the surface. The loads follow from the forces of the ground,
    /// which now hold a part of the weight: m h (a - g) in place of m h a in (28).
    Grade: "grade", Slope,
    phrase "sloping ground",
    lifts "flat ground",
    equation "F_X += m g_X, F_Y += m g_Y, g = -9.81 q / sqrt(1 + |q|^2) turned into the body by psi, q = (tan slope_east, tan slope_north); sum F_Z = m 9.81 / sqrt(1 + |q|^2)",
    source "statics of a body on an inclined plane (derived here; Wong, Theory of Ground Vehicles, 3.1, has the one-dimensional case)",
    check "Measure the slope with an inclinometer, and check that east and north of the recorded positions are right.",
    {
        slope_east ["rad"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "Angle by which the ground rises towards the east";
        slope_north ["rad"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "Angle by which the ground rises towards the north";
    }
}

/// Gravity on a slope, in the body frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlopeGravity<S> {
    /// Components along the body's X and Y \[m/s^2\].
    pub along: [S; 2],
    /// Component against the surface's normal, g cos(slope) \[m/s^2\].
    pub normal: S,
}

impl<S: Scalar> Grade<S> {
    /// Gravity of magnitude `gravity` \[m/s^2\] as a vehicle with this heading feels it.
    pub fn gravity(&self, heading: S, gravity: f64) -> SlopeGravity<S> {
        let (east, north) = (self.slope_east.tan(), self.slope_north.tan());
        let normal = (east * east + north * north)
            .offset(1.0)
            .inverse_sqrt()
            .scale(gravity);
        let (sin, cos) = heading.sin_cos();
        SlopeGravity {
            along: [
                -(east * cos + north * sin) * normal,
                (east * sin - north * cos) * normal,
            ],
            normal,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_degrees_uphill_weigh_what_a_right_triangle_says() {
        let slope = 10.0_f64.to_radians();
        let grade = Grade {
            slope_east: slope,
            slope_north: 0.0,
        };
        let gravity = grade.gravity(0.0, 9.81);
        // g sin 10 deg = 1.7035, g cos 10 deg = 9.6610 m/s^2.
        assert!((gravity.along[0] + 1.7035).abs() < 5e-5);
        assert_eq!(gravity.along[1], 0.0);
        assert!((gravity.normal - 9.6610).abs() < 5e-5);
    }

    #[test]
    fn the_body_turns_under_gravity() {
        let grade = Grade {
            slope_east: 0.1,
            slope_north: -0.05,
        };
        let (here, turned) = (
            grade.gravity(0.4, 9.81),
            grade.gravity(0.4 + std::f64::consts::PI, 9.81),
        );
        for axis in 0..2 {
            assert!((here.along[axis] + turned.along[axis]).abs() < 1e-14);
        }
        let squares: f64 = here.along.iter().map(|g| g * g).sum();
        assert!((squares + here.normal * here.normal - 9.81 * 9.81).abs() < 1e-12);
        // Heading north, the ground falls ahead and rises to the right.
        let north = grade.gravity(std::f64::consts::FRAC_PI_2, 9.81).along;
        assert!(north[0] > 0.0 && north[1] > 0.0);
    }
}
