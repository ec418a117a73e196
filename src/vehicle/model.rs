//! A vehicle on a terrain, prepared for evaluation.

use super::{LoadPlane, Motion, Vehicle};
use crate::contact::{Regularisation, Resolution, WheelContact, WheelMotion};
use crate::parameter::ParameterError;
use crate::scalar::Scalar;
use crate::terrain::Terrain;
use fearless_simd::Level;

/// A vehicle on a terrain: everything about the two that does not move.
#[derive(Debug, Clone)]
pub struct VehicleModel {
    vehicle: Vehicle,
    terrain: Terrain,
    regularisation: Regularisation,
    contact: WheelContact,
    plane: LoadPlane,
    /// The processor's vector instructions.
    level: Level,
}

impl VehicleModel {
    /// A vehicle on a terrain, with the default settings.
    ///
    /// # Errors
    /// The first parameter that lies outside its range.
    pub fn new(vehicle: Vehicle, terrain: Terrain) -> Result<Self, ParameterError> {
        Self::with_settings(
            vehicle,
            terrain,
            Regularisation::default(),
            Resolution::default(),
        )
    }

    /// A vehicle on a terrain, with other regularisation speeds or quadrature nodes.
    ///
    /// # Errors
    /// The first parameter that lies outside its range.
    pub fn with_settings(
        vehicle: Vehicle,
        terrain: Terrain,
        regularisation: Regularisation,
        resolution: Resolution,
    ) -> Result<Self, ParameterError> {
        vehicle.validate()?;
        let (radius, width) = (vehicle.wheel_radius, vehicle.wheel_width);
        let contact = WheelContact::new(&terrain, radius, width, regularisation, resolution)?;
        let plane = LoadPlane::new(&vehicle);
        Ok(Self {
            vehicle,
            terrain,
            regularisation,
            contact,
            plane,
            level: Level::new(),
        })
    }

    /// The vehicle.
    #[must_use]
    pub fn vehicle(&self) -> &Vehicle {
        &self.vehicle
    }

    /// The terrain.
    #[must_use]
    pub fn terrain(&self) -> &Terrain {
        &self.terrain
    }

    /// How one wheel moves (10).
    pub(super) fn wheel_motion(&self, motion: &Motion, index: usize) -> WheelMotion<f64> {
        let (ahead, left) = self.vehicle.wheel_centre(index);
        WheelMotion {
            forward: motion.v_x - motion.yaw_rate * left,
            lateral: motion.v_y + motion.yaw_rate * ahead,
            yaw_rate: motion.yaw_rate,
            angular_speed: if left > 0.0 {
                motion.omega_left
            } else {
                motion.omega_right
            },
        }
    }

    /// r omega \[m/s\] of (13), kept away from zero.
    pub(super) fn slip_denominator<S: Scalar>(&self, omega: S) -> S {
        let bounded = self.regularisation.bounded_angular_speed(omega);
        let sign = if omega.value() < 0.0 { -1.0 } else { 1.0 };
        bounded.scale(self.vehicle.wheel_radius * sign)
    }

    /// Weight m g \[N\].
    pub(super) fn weight(&self) -> f64 {
        self.plane.weight()
    }

    /// Each wheel's load and its derivatives by a_X and a_Y; whether a wheel is lifted.
    pub(super) fn distribute_loads(&self, acceleration: [f64; 2], loads: &mut [[f64; 3]]) -> bool {
        self.plane.distribute(acceleration, loads)
    }

    pub(super) fn level(&self) -> Level {
        self.level
    }

    pub(super) fn contact(&self) -> &WheelContact {
        &self.contact
    }
}
