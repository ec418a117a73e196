//! The mounting of an inertial sensor, from gravity.

use super::checks::{STANDING, at};
use super::collect::{ImuSample, TimedValues};

/// A mean specific force below this does not include gravity \[m/s^2\].
const GRAVITY: f64 = 5.0;
/// Minimum duration at rest for the direction of gravity \[s\].
const REST: f64 = 1.0;
/// Maximum angle of an upright z axis \[deg\]: at rest the ground may slope, in motion accelerations tilt the mean.
const NEAR_AT_REST: f64 = 10.0;
const NEAR_IN_MOTION: f64 = 30.0;

/// The mounting of a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Mounting {
    /// Unknown.
    Unknown,
    /// Its accelerations do not include gravity; their mean is this \[m/s^2\].
    WithoutGravity(f64),
    /// Its z axis points up.
    Upright,
    /// Its z axis points down.
    Down,
    /// Its z axis points elsewhere.
    Tilted {
        /// Unit vector up, in the sensor's axes.
        up: [f64; 3],
        /// Angle between it and the z axis \[deg\].
        degrees: f64,
        /// Whether it was measured at rest.
        at_rest: bool,
    },
}

impl Mounting {
    /// From the mean specific force while the wheels stand, or of the whole drive if they hardly do.
    pub fn of(samples: &[(i64, ImuSample)], [left, right]: &[TimedValues; 2]) -> Self {
        let stands = |side: &TimedValues, time: i64| {
            at(side, time).is_some_and(|speed| speed.abs() < STANDING)
        };
        let known = samples.iter().filter_map(|(time, sample)| {
            let force = sample.acceleration?;
            let is_finite = force.iter().all(|component| component.is_finite());
            is_finite.then_some((*time, force))
        });
        let known: Vec<(i64, [f64; 3])> = known.collect();
        if known.iter().all(|(_, force)| *force == [0.0; 3]) {
            return Self::Unknown;
        }
        let rest = known
            .iter()
            .filter(|(time, _)| stands(left, *time) && stands(right, *time));
        let rest: Vec<(i64, [f64; 3])> = rest.copied().collect();
        let span = known[known.len() - 1].0 - known[0].0;
        let seconds = span as f64 * 1e-9 * rest.len() as f64 / known.len() as f64;
        if seconds >= REST {
            Self::by(mean(&rest), NEAR_AT_REST)
        } else {
            Self::by(mean(&known), NEAR_IN_MOTION)
        }
    }

    fn by(force: [f64; 3], near: f64) -> Self {
        let length = force
            .iter()
            .map(|component| component * component)
            .sum::<f64>()
            .sqrt();
        if length < GRAVITY {
            return Self::WithoutGravity(length);
        }
        let up = force.map(|component| component / length);
        let degrees = up[2].clamp(-1.0, 1.0).acos().to_degrees();
        if degrees <= near {
            Self::Upright
        } else if degrees >= 180.0 - near {
            Self::Down
        } else {
            Self::Tilted {
                up,
                degrees,
                at_rest: near == NEAR_AT_REST,
            }
        }
    }

    /// The axis of the yaw rate, its description, and the sign of the lateral acceleration, `None` if the lateral axis is
    /// unknown. `z_down` is the user's option.
    pub fn axis(self, z_down: bool) -> ([f64; 3], String, Option<f64>) {
        let negated = || "angular_velocity.z, negated: z points down".to_owned();
        match self {
            Self::Tilted { up, .. } => {
                let [x, y, z] = up;
                let name =
                    format!("angular_velocity along [{x:.3}, {y:.3}, {z:.3}], up by gravity");
                (up, name, None)
            }
            Self::Down => ([0.0, 0.0, -1.0], negated(), z_down.then_some(-1.0)),
            _ if z_down => ([0.0, 0.0, -1.0], negated(), Some(-1.0)),
            _ => ([0.0, 0.0, 1.0], "angular_velocity.z".into(), Some(1.0)),
        }
    }

    /// A note for the user.
    pub fn note(self, topic: &str, z_down: bool) -> Option<String> {
        match (self, z_down) {
            (Self::Unknown, _) | (Self::Upright, false) | (Self::Down, true) => None,
            (Self::WithoutGravity(mean), _) => Some(format!(
                "{topic}: the mean acceleration is {mean:.2} m/s^2: gravity was taken out; yaw rate and \
                 accelerations are those of the sensor's own axes"
            )),
            (Self::Upright, true) => Some(format!(
                "warning: {topic}: its z axis points up, so that --imu-z-down gives yaw rate and a_y the \
                 wrong sign"
            )),
            (Self::Down, false) => Some(format!(
                "warning: {topic}: its z axis points down: yaw_rate is its negative; a_x and a_y are left \
                 out (--imu-z-down takes them, where its x axis points ahead)"
            )),
            (
                Self::Tilted {
                    degrees, at_rest, ..
                },
                _,
            ) => {
                let when = if at_rest { "at rest" } else { "on average" };
                Some(format!(
                    "warning: {topic}: its z axis is {degrees:.0} deg from upright {when}; yaw_rate is \
                     about the vertical; a_x and a_y are left out, as gravity does not show the direction \
                     of the other axes"
                ))
            }
        }
    }
}

fn mean(samples: &[(i64, [f64; 3])]) -> [f64; 3] {
    let sum = |axis: usize| samples.iter().map(|(_, force)| force[axis]).sum::<f64>();
    [0, 1, 2].map(|axis| sum(axis) / samples.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: i64 = 1_000_000_000;

    /// Two seconds at rest, if at all, then eight in which the vehicle accelerates ahead.
    fn mounted(axes: impl Fn([f64; 3]) -> [f64; 3], rests: bool) -> Mounting {
        let stands = |time: i64| rests && time < 2 * SECOND;
        let times = || (0..1000).map(|k| k * SECOND / 100);
        let wheels: TimedValues = times()
            .map(|time| (time, if stands(time) { 0.0 } else { 5.0 }))
            .collect();
        let imu = times().map(|time| {
            let force = [if stands(time) { 0.0 } else { 3.0 }, 0.0, 9.81];
            let sample = ImuSample {
                yaw: None,
                angular_velocity: None,
                acceleration: Some(axes(force)),
            };
            (time, sample)
        });
        let imu: Vec<(i64, ImuSample)> = imu.collect();
        Mounting::of(&imu, &[wheels.clone(), wheels])
    }

    #[test]
    fn gravity_at_rest_shows_the_mounting() {
        assert_eq!(mounted(|force| force, true), Mounting::Upright);
        let down = |[x, y, z]: [f64; 3]| [x, -y, -z];
        assert_eq!(mounted(down, true), Mounting::Down);
        // A camera's axes: to the right, down, ahead.
        let camera = mounted(|[x, y, z]| [-y, -z, x], true);
        let expected = Mounting::Tilted {
            up: [0.0, -1.0, 0.0],
            degrees: 90.0,
            at_rest: true,
        };
        assert_eq!(camera, expected);
        let (axis, _, left) = camera.axis(false);
        assert_eq!((axis, left), ([0.0, -1.0, 0.0], None));
        assert!(
            camera
                .note("/imu", false)
                .unwrap()
                .starts_with("warning: /imu: its z axis is 90 deg")
        );
        // Without gravity or accelerations the mounting is unknown.
        let free = |[x, y, _]: [f64; 3]| [x, y, 0.0];
        assert_eq!(mounted(free, true), Mounting::WithoutGravity(0.0));
        assert_eq!(mounted(|_| [0.0; 3], true), Mounting::Unknown);
        assert_eq!(mounted(|_| [f64::NAN; 3], true), Mounting::Unknown);
    }

    #[test]
    fn accelerations_do_not_look_like_a_tilt() {
        // On average the specific force is 17 deg from the vertical.
        assert_eq!(mounted(|force| force, false), Mounting::Upright);
        let down = |[x, y, z]: [f64; 3]| [x, -y, -z];
        assert_eq!(mounted(down, false), Mounting::Down);
        let camera = mounted(|[x, y, z]| [-y, -z, x], false);
        let is_on_average = matches!(camera, Mounting::Tilted { at_rest: false, .. });
        assert!(is_on_average, "{camera:?}");
    }

    #[test]
    fn the_option_for_the_z_axis_counts() {
        let of = |mounting: Mounting, z_down| {
            let (axis, _, left) = mounting.axis(z_down);
            (axis[2], left, mounting.note("/imu", z_down).is_some())
        };
        assert_eq!(of(Mounting::Upright, false), (1.0, Some(1.0), false));
        assert_eq!(of(Mounting::Upright, true), (-1.0, Some(-1.0), true));
        assert_eq!(of(Mounting::Down, false), (-1.0, None, true));
        assert_eq!(of(Mounting::Down, true), (-1.0, Some(-1.0), false));
        assert_eq!(of(Mounting::Unknown, true), (-1.0, Some(-1.0), false));
    }
}
