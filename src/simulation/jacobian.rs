//! Derivatives of the state's rate of change.

use super::evaluation::Evaluation;
use super::integrator::Stages;
use super::memory::directions;
use super::state::{InputMatrix, State, StateMatrix};
use crate::vehicle::{Differentiated, Direction, Directions, VehicleModel, Wrench};

/// Derivatives of the state's rate of change.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Jacobian {
    /// By the state, in the order of [`State::to_array`].
    pub by_state: StateMatrix,
    /// By the left and right wheel speed.
    pub by_input: InputMatrix,
}

/// Memory that carries nothing from one call to the next.
#[derive(Debug, Clone)]
pub(super) struct Work {
    pub partial: Wrench,
    pub derivatives: Derivatives,
    pub stages: Stages,
}

/// The directions of the integrator's Jacobian, and the derivatives in them.
#[derive(Debug, Clone, Default)]
pub(super) struct Derivatives {
    pub directions: Directions,
    pub results: Vec<Differentiated>,
}

impl Work {
    pub fn new(model: &VehicleModel, like: &Evaluation) -> Self {
        Self {
            partial: Wrench::for_model(model),
            derivatives: Derivatives {
                directions: Directions::new(model, directions(model)),
                results: Vec::new(),
            },
            stages: Stages::new(like),
        }
    }
}

impl State {
    /// What the kinematics alone contribute: dx/dt, dy/dt by heading and velocities, dpsi/dt by
    /// the yaw rate, and the rotating frame's + V_Y Omega and - V_X Omega.
    pub(super) fn kinematic_jacobian(&self) -> Jacobian {
        let (sin, cos) = self.heading.sin_cos();
        let mut by_state = StateMatrix::zeros();
        by_state[(0, 2)] = -self.v_x * sin - self.v_y * cos;
        by_state[(1, 2)] = self.v_x * cos - self.v_y * sin;
        (by_state[(0, 3)], by_state[(0, 4)]) = (cos, -sin);
        (by_state[(1, 3)], by_state[(1, 4)]) = (sin, cos);
        by_state[(2, 5)] = 1.0;
        (by_state[(3, 4)], by_state[(3, 5)]) = (self.yaw_rate, self.v_y);
        (by_state[(4, 3)], by_state[(4, 5)]) = (-self.yaw_rate, -self.v_x);
        Jacobian {
            by_state,
            by_input: InputMatrix::zeros(),
        }
    }
}

impl Jacobian {
    /// Adds the forces' derivatives in all directions.
    pub(super) fn take(&mut self, list: &[Direction], results: &[Differentiated]) {
        for (direction, result) in list.iter().zip(results) {
            let wrench = &result.wrench;
            if let Some(motion) = Direction::MOTION.iter().position(|d| d == direction) {
                self.add_motion(motion, wrench);
            } else if let Some(pose) = Direction::POSE.iter().position(|d| d == direction) {
                self.add(pose, wrench);
            }
        }
    }

    /// Adds the forces' derivatives by one of the states.
    fn add(&mut self, column: usize, derivative: &Wrench) {
        for (row, rate) in rates(derivative).into_iter().enumerate() {
            self.by_state[(3 + row, column)] += rate;
        }
    }

    /// The same by one of the five components of [`Motion`].
    fn add_motion(&mut self, direction: usize, derivative: &Wrench) {
        if direction < 3 {
            return self.add(3 + direction, derivative);
        }
        for (row, rate) in rates(derivative).into_iter().enumerate() {
            self.by_input[(3 + row, direction - 3)] = rate;
        }
    }
}

fn rates(derivative: &Wrench) -> [f64; 3] {
    [derivative.a_x, derivative.a_y, derivative.yaw_acceleration]
}
