//! The whole vehicle: geometry, load transfer, and the balance of all its wheels.
//!
//! # Frames and signs
//! World: x east, y north, heading psi counter-clockwise from x. Body: origin at the
//! centre of mass, X forward, Y left, Z up. Wheels count from 0 in the code (from 1 in
//! the variables' names): even ones on the left, odd ones on the right, front row first.
//! Moments and yaw rate are positive counter-clockwise, a wheel's angular speed is
//! positive when it rolls forward. `a_x`, `a_y` are the accelerations of the centre of
//! mass along the body's axes: dV_X/dt = a_x + V_Y Omega, dV_Y/dt = a_y - V_X Omega.

mod balance;
mod chassis;
mod continuation;
mod derivatives;
mod environment;
mod geometry;
mod loads;
mod memory;
mod model;
mod newton;
mod parameter;
mod prepared;
mod rut;
mod situation;
mod tracks;
mod unusual;
mod wrench;

pub use balance::Balance;
pub(crate) use chassis::Chassis;
pub(crate) use derivatives::{Differentiated, Direction, Directions, Trend};
pub use environment::Surroundings;
pub use geometry::Vehicle;
pub use loads::GRAVITY;
pub(crate) use memory::Remembered;
pub use model::VehicleModel;
pub use newton::BalanceError;
pub use parameter::{ModelParameter, Specification, TerrainParameter, VehicleParameter};
pub(crate) use prepared::Prepared;
pub(crate) use rut::TrackSlope;
pub(crate) use tracks::{
    ApproachPath, TRACK_SAMPLES, sample_size, spacing, wheel_places, wheel_travel,
};
pub use tracks::{Tracks, seen_from};
pub use unusual::{USUAL_SOIL, Unusual};
pub use wrench::{WheelOutputs, Wrench};

/// Velocities of the vehicle and speeds of its wheels: what the ground's forces depend on.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// Velocity of the centre of mass along X, V_X \[m/s\] (9).
    pub v_x: f64,
    /// Velocity of the centre of mass along Y, V_Y \[m/s\].
    pub v_y: f64,
    /// Yaw rate Omega \[rad/s\] (9).
    pub yaw_rate: f64,
    /// Angular speed of the left wheels \[rad/s\].
    pub omega_left: f64,
    /// Angular speed of the right wheels \[rad/s\].
    pub omega_right: f64,
}

impl Motion {
    /// The five quantities in the order of the fields.
    #[must_use]
    pub fn to_array(self) -> [f64; 5] {
        [
            self.v_x,
            self.v_y,
            self.yaw_rate,
            self.omega_left,
            self.omega_right,
        ]
    }

    /// From the five quantities in the order of the fields.
    #[must_use]
    pub fn from_array([v_x, v_y, yaw_rate, omega_left, omega_right]: [f64; 5]) -> Self {
        Self {
            v_x,
            v_y,
            yaw_rate,
            omega_left,
            omega_right,
        }
    }
}
