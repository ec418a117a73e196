//! State and inputs of the vehicle, and the state's rate of change.

use crate::vehicle::{Motion, Surroundings, Tracks, Wrench};
use nalgebra::{SMatrix, SVector};

pub(crate) type StateVector = SVector<f64, { State::COUNT }>;
pub(super) type StateMatrix = SMatrix<f64, { State::COUNT }, { State::COUNT }>;
pub(super) type InputMatrix = SMatrix<f64, { State::COUNT }, 2>;

/// Pose in the world frame and velocities in the body frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// Position of the centre of mass, east \[m\].
    pub x: f64,
    /// Position of the centre of mass, north \[m\].
    pub y: f64,
    /// Heading psi, counter-clockwise from east \[rad\].
    pub heading: f64,
    /// Velocity V_X ahead \[m/s\].
    pub v_x: f64,
    /// Velocity V_Y to the left \[m/s\].
    pub v_y: f64,
    /// Yaw rate Omega, counter-clockwise \[rad/s\].
    pub yaw_rate: f64,
}

impl State {
    /// Number of states.
    pub const COUNT: usize = 6;

    /// The states in the order of the fields.
    #[must_use]
    pub fn to_array(self) -> [f64; Self::COUNT] {
        [
            self.x,
            self.y,
            self.heading,
            self.v_x,
            self.v_y,
            self.yaw_rate,
        ]
    }

    /// From the states in the order of the fields.
    #[must_use]
    pub fn from_array([x, y, heading, v_x, v_y, yaw_rate]: [f64; Self::COUNT]) -> Self {
        Self {
            x,
            y,
            heading,
            v_x,
            v_y,
            yaw_rate,
        }
    }

    /// The velocities at which wheels with these speeds roll without slip, as far as a
    /// skid-steer vehicle can: V_X = r (omega_L + omega_R) / 2, V_Y = 0,
    /// Omega = r (omega_R - omega_L) / (2 B).
    #[must_use]
    pub fn rolling_without_slip(
        self,
        wheel_speeds: WheelSpeeds,
        wheel_radius: f64,
        half_track: f64,
    ) -> Self {
        let WheelSpeeds { left, right } = wheel_speeds;
        Self {
            v_x: wheel_radius * (left + right) / 2.0,
            v_y: 0.0,
            yaw_rate: wheel_radius * (right - left) / (2.0 * half_track),
            ..self
        }
    }

    pub(crate) fn motion(&self, wheel_speeds: WheelSpeeds) -> Motion {
        Motion {
            v_x: self.v_x,
            v_y: self.v_y,
            yaw_rate: self.yaw_rate,
            omega_left: wheel_speeds.left,
            omega_right: wheel_speeds.right,
        }
    }

    /// What effects depend on besides the motion.
    pub(crate) fn surroundings<'a>(
        &self,
        time: f64,
        memory: &'a [f64],
        tracks: Tracks<'a>,
    ) -> Surroundings<'a> {
        Surroundings {
            position: [self.x, self.y],
            heading: self.heading,
            time,
            memory,
            tracks,
        }
    }

    /// The state's rate of change under a wrench: the kinematics of a planar rigid body,
    /// with dV_X/dt = a_X + V_Y Omega and dV_Y/dt = a_Y - V_X Omega (19), (20), (24).
    pub(crate) fn derivative(&self, wrench: &Wrench) -> [f64; Self::COUNT] {
        let (sin, cos) = self.heading.sin_cos();
        [
            self.v_x * cos - self.v_y * sin,
            self.v_x * sin + self.v_y * cos,
            self.yaw_rate,
            wrench.a_x + self.v_y * self.yaw_rate,
            wrench.a_y - self.v_x * self.yaw_rate,
            wrench.yaw_acceleration,
        ]
    }
}

/// Angular speeds of the wheels on both sides \[rad/s\], or their rates \[rad/s^2\].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WheelSpeeds {
    /// Left wheels.
    pub left: f64,
    /// Right wheels.
    pub right: f64,
}

impl From<[f64; 2]> for WheelSpeeds {
    fn from([left, right]: [f64; 2]) -> Self {
        Self { left, right }
    }
}

impl WheelSpeeds {
    /// The speeds `seconds` later when they change at these `rates`.
    #[must_use]
    pub fn after(self, rates: Self, seconds: f64) -> Self {
        Self {
            left: self.left + rates.left * seconds,
            right: self.right + rates.right * seconds,
        }
    }

    /// Those of a motion.
    pub(super) fn of(motion: &Motion) -> Self {
        Self {
            left: motion.omega_left,
            right: motion.omega_right,
        }
    }

    /// The greater of the differences of both sides from other speeds.
    pub(super) fn apart(self, other: Self) -> f64 {
        let left = (self.left - other.left).abs();
        left.max((self.right - other.right).abs())
    }

    /// Whether two speeds differ by no more than rounding leaves where one was integrated from its
    /// rate: no force shows it.
    pub(super) fn is_nearly(self, other: Self) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= ROUNDING * (1.0 + a.abs());
        near(self.left, other.left) && near(self.right, other.right)
    }
}

/// Some ten roundings, as a share.
const ROUNDING: f64 = 1e-14;
