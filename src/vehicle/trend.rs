//! How a balance moves when the motion changes: improves the guesses between two solutions.

use super::{VehicleModel, Wrench};

/// How a balance changes with the motion: derivatives by the five components of [`Motion`].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trend {
    pub acceleration: [[f64; 5]; 2],
    pub entry_angles: Vec<[f64; 5]>,
}

impl Trend {
    pub(crate) fn new(model: &VehicleModel) -> Self {
        Self {
            acceleration: [[0.0; 5]; 2],
            entry_angles: vec![[0.0; 5]; model.vehicle().wheel_count()],
        }
    }

    /// Takes the derivative of the wrench in one direction of the motion.
    pub(crate) fn set_direction(&mut self, direction: usize, derivative: &Wrench) {
        self.acceleration[0][direction] = derivative.a_x;
        self.acceleration[1][direction] = derivative.a_y;
        for (slopes, wheel) in self.entry_angles.iter_mut().zip(&derivative.wheels) {
            slopes[direction] = wheel.entry_angle;
        }
    }

    /// Visits every number, for a snapshot.
    pub(crate) fn visit(&mut self, visit: &mut impl FnMut(&mut f64)) {
        let rows = self.acceleration.iter_mut().chain(&mut self.entry_angles);
        rows.flatten().for_each(visit);
    }
}
