//! Topics of PX4 (github.com/PX4/PX4-Autopilot, `msg/`), and their frames: north, east, down on the ground; ahead, right,
//! down on the vehicle. Here they become east, north, up and ahead, left, up.
//!
//! Actuator outputs and setpoints are commands. Measured wheel speeds are in `wheel_encoders` alone.

use std::f64::consts::FRAC_PI_2;

/// A layout of messages.
pub(super) struct Layout {
    /// Name of the layout, which is that of its main topic.
    pub name: &'static str,
    /// Other topics with this layout.
    others: &'static [&'static str],
    /// The fields that are read, in the order of the functions below. A log without one has NaN in its place.
    pub fields: &'static [&'static str],
}

pub(super) const WHEEL_ENCODERS: &str = "wheel_encoders";
pub(super) const LOCAL_POSITION: &str = "vehicle_local_position";
pub(super) const ODOMETRY: &str = "vehicle_odometry";
pub(super) const ANGULAR_VELOCITY: &str = "vehicle_angular_velocity";
pub(super) const SENSOR_COMBINED: &str = "sensor_combined";
pub(super) const ATTITUDE: &str = "vehicle_attitude";

const LAYOUTS: [Layout; 6] = [
    Layout {
        name: WHEEL_ENCODERS,
        others: &[],
        fields: &[
            "wheel_speed[0]",
            "wheel_speed[1]",
            "wheel_angle[0]",
            "wheel_angle[1]",
        ],
    },
    Layout {
        name: LOCAL_POSITION,
        others: &[
            "vehicle_local_position_groundtruth",
            "external_ins_local_position",
        ],
        // The heading was `yaw` until PX4 1.11.
        fields: &[
            "x",
            "y",
            "vx",
            "vy",
            "heading",
            "yaw",
            "xy_valid",
            "v_xy_valid",
        ],
    },
    Layout {
        name: ODOMETRY,
        others: &["vehicle_mocap_odometry", "vehicle_visual_odometry"],
        fields: &[
            "position[0]",
            "position[1]",
            "q[0]",
            "q[1]",
            "q[2]",
            "q[3]",
            "velocity_frame",
            "velocity[0]",
            "velocity[1]",
            "angular_velocity[2]",
        ],
    },
    Layout {
        name: ANGULAR_VELOCITY,
        others: &[],
        fields: &["xyz[0]", "xyz[1]", "xyz[2]"],
    },
    Layout {
        name: SENSOR_COMBINED,
        others: &[],
        fields: &[
            "gyro_rad[0]",
            "gyro_rad[1]",
            "gyro_rad[2]",
            "accelerometer_m_s2[0]",
            "accelerometer_m_s2[1]",
            "accelerometer_m_s2[2]",
        ],
    },
    Layout {
        name: ATTITUDE,
        others: &["vehicle_attitude_groundtruth", "external_ins_attitude"],
        fields: &["q[0]", "q[1]", "q[2]", "q[3]"],
    },
];

/// The layout of a topic's messages, if it is read.
pub(super) fn layout(topic: &str) -> Option<&'static Layout> {
    let is_of = |layout: &&Layout| layout.name == topic || layout.others.contains(&topic);
    LAYOUTS.iter().find(is_of)
}

/// Names of the wheels. PX4 documents `wheel_speed` as "0 right, 1 left", and its driver writes it so; a version under
/// development had the reverse.
pub(super) const WHEELS: [&str; 2] = ["right_wheel_0", "left_wheel_1"];

/// Notes for the user of a log.
pub(super) const NOTES: [&str; 2] = [
    "PX4's axes (north, east, down; ahead, right, down) were turned to east, north, up and ahead, left, up; times count \
     from the start of the autopilot",
    "wheel_speed[0] of wheel_encoders counts as the right wheel and wheel_speed[1] as the left, as PX4 documents them \
     (--left right_wheel_0 --right left_wheel_1 swaps them)",
];

/// Pose and velocities in this project's frames; NaN for unknown values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PlanarMotion {
    /// East and north \[m\].
    pub position: [f64; 2],
    /// Counter-clockwise from east \[rad\].
    pub heading: f64,
    /// Ahead and to the left \[m/s\].
    pub velocity: [f64; 2],
    /// Counter-clockwise \[rad/s\].
    pub yaw_rate: f64,
}

/// Of `vehicle_local_position`.
pub(super) fn local_position(
    [
        north,
        east,
        v_north,
        v_east,
        heading,
        yaw,
        is_valid,
        is_velocity_valid,
    ]: [f64; 8],
) -> PlanarMotion {
    // A flag that the log lacks is NaN.
    let valid = |flag: f64, value: [f64; 2]| if flag == 0.0 { [f64::NAN; 2] } else { value };
    let yaw = if heading.is_nan() { yaw } else { heading };
    PlanarMotion {
        position: valid(is_valid, [east, north]),
        heading: FRAC_PI_2 - yaw,
        velocity: to_body(valid(is_velocity_valid, [v_north, v_east]), yaw),
        yaw_rate: f64::NAN,
    }
}

/// `VELOCITY_FRAME_BODY_FRD`: ahead, right, down on the vehicle. The other known frames are fixed to the ground.
const BODY: f64 = 3.0;
const UNKNOWN: f64 = 0.0;

/// Of `vehicle_odometry`. Its frame on the ground may have any heading, which then turns the map.
pub(super) fn odometry(fields: [f64; 10]) -> PlanarMotion {
    let [north, east, w, x, y, z, frame, v_first, v_second, rate_down] = fields;
    let yaw = yaw([w, x, y, z]);
    let velocity = if frame == BODY {
        [v_first, -v_second]
    } else if frame == UNKNOWN {
        [f64::NAN; 2]
    } else {
        to_body([v_first, v_second], yaw)
    };
    PlanarMotion {
        position: [east, north],
        heading: FRAC_PI_2 - yaw,
        velocity,
        yaw_rate: -rate_down,
    }
}

/// Ahead and to the left, from a velocity north and east and the yaw, clockwise from north.
fn to_body([north, east]: [f64; 2], yaw: f64) -> [f64; 2] {
    let (sin, cos) = yaw.sin_cos();
    [north * cos + east * sin, north * sin - east * cos]
}

/// The yaw, clockwise from north, of a quaternion w, x, y, z; NaN if it is none.
fn yaw([w, x, y, z]: [f64; 4]) -> f64 {
    let square = w * w + x * x + y * y + z * z;
    if square.is_finite() && square > 0.0 {
        (2.0 * (w * z + x * y)).atan2(w * w + x * x - y * y - z * z)
    } else {
        f64::NAN
    }
}

/// The attitude x, y, z, w of a heading; NaN throughout for one that is unknown.
pub(super) fn attitude(heading: f64) -> [f64; 4] {
    let (sin, cos) = (0.5 * heading).sin_cos();
    let nothing = if heading.is_finite() { 0.0 } else { f64::NAN };
    [nothing, nothing, sin, cos]
}

/// The attitude of `vehicle_attitude`.
pub(super) fn level_attitude(quaternion: [f64; 4]) -> [f64; 4] {
    attitude(FRAC_PI_2 - yaw(quaternion))
}

/// A vector of the vehicle, ahead, left, up.
pub(super) fn forward_left_up([ahead, right, down]: [f64; 3]) -> [f64; 3] {
    [ahead, -right, -down]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two vectors, up to rounding.
    fn assert_near<const N: usize>(found: [f64; N], expected: [f64; N]) {
        let is_near = |(a, b): (f64, f64)| (a - b).abs() < 1e-12;
        assert!(
            found.into_iter().zip(expected).all(is_near),
            "{found:?} {expected:?}"
        );
    }

    #[test]
    fn a_vehicle_that_drives_east_has_heading_zero() {
        // 3 m north and 5 m east, at 2 m/s to the east and 0.1 m/s to the south, which is its right.
        let yaw = FRAC_PI_2;
        let motion = local_position([3.0, 5.0, -0.1, 2.0, yaw, f64::NAN, 1.0, f64::NAN]);
        assert_near(motion.position, [5.0, 3.0]);
        assert_near([motion.heading], [0.0]);
        assert_near(motion.velocity, [2.0, -0.1]);
        // The same by the quaternion, with velocities of the ground and of the vehicle.
        let (sin, cos) = (0.5 * yaw).sin_cos();
        for (frame, velocity) in [(1.0, [-0.1, 2.0]), (3.0, [2.0, 0.1])] {
            let [first, second] = velocity;
            let fields = [3.0, 5.0, cos, 0.0, 0.0, sin, frame, first, second, 0.4];
            let same = odometry(fields);
            assert_near(same.position, motion.position);
            assert_near([same.heading, same.yaw_rate], [0.0, -0.4]);
            assert_near(same.velocity, motion.velocity);
        }
        assert_near(level_attitude([cos, 0.0, 0.0, sin]), [0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn what_is_not_valid_is_no_number() {
        let motion = local_position([3.0, 5.0, 1.0, 2.0, f64::NAN, 0.5, 0.0, 0.0]);
        assert!(
            motion
                .position
                .iter()
                .chain(&motion.velocity)
                .all(|value| value.is_nan())
        );
        assert_near([motion.heading], [FRAC_PI_2 - 0.5]);
        assert!(level_attitude([0.0; 4]).iter().all(|value| value.is_nan()));
        assert!(odometry([f64::NAN; 10]).heading.is_nan());
    }
}
