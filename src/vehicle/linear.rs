//! Exact derivatives of the wrench, by the implicit function theorem on the balance.

use super::balance::solve_2x2;
use super::{Balance, Motion, VehicleModel, Wrench};
use crate::contact::{Detail, FORCE_COUNT, WheelForces, WheelMotion};
use crate::scalar::Dual;
use fearless_simd::{Simd, dispatch};

/// Directions in which a wheel's forces are differentiated: forward and lateral velocity,
/// yaw rate, angular speed, entry angle.
const DIRECTIONS: usize = 5;

/// The derivatives of every wheel's forces at one balance.
#[derive(Debug, Clone)]
pub struct Linearisation {
    wheels: Vec<WheelForces<Dual<f64, DIRECTIONS>>>,
    loads: Vec<[f64; 3]>,
    /// Scratch: derivatives of the forces in the direction asked for.
    forces: Vec<WheelForces<f64>>,
    /// Scratch: derivatives of the forces at fixed entry angles.
    partial: Vec<[f64; FORCE_COUNT]>,
}

impl Linearisation {
    /// Room for a model's wheels.
    #[must_use]
    pub fn new(model: &VehicleModel) -> Self {
        let count = model.vehicle().wheel_count();
        let zero = WheelForces::<Dual<f64, DIRECTIONS>>::zero();
        Self {
            wheels: vec![zero; count],
            loads: vec![[0.0; 3]; count],
            forces: vec![WheelForces::zero(); count],
            partial: vec![[0.0; FORCE_COUNT]; count],
        }
    }

    /// Differentiates every wheel at a solved balance and its motion.
    pub fn evaluate(&mut self, model: &VehicleModel, motion: &Motion, balance: &Balance) {
        model.distribute_loads(balance.acceleration, &mut self.loads);
        dispatch!(model.level(), simd => self.evaluate_with(simd, model, motion, balance));
    }

    #[inline(always)]
    fn evaluate_with<V: Simd>(
        &mut self,
        simd: V,
        model: &VehicleModel,
        motion: &Motion,
        balance: &Balance,
    ) {
        for (index, wheel) in balance.wheels.iter().enumerate() {
            self.wheels[index] = if wheel.load <= 0.0 {
                WheelForces::zero()
            } else {
                let local = model.wheel_motion(motion, index);
                let local = WheelMotion {
                    forward: Dual::variable(local.forward, 0),
                    lateral: Dual::variable(local.lateral, 1),
                    yaw_rate: Dual::variable(local.yaw_rate, 2),
                    angular_speed: Dual::variable(local.angular_speed, 3),
                };
                let entry = Dual::variable(wheel.entry_angle, 4);
                model.contact().forces(simd, &local, entry, Detail::Full)
            };
        }
    }

    /// The derivative of the wrench (slips included) when the motion changes in `direction`.
    pub fn derivative(
        &mut self,
        model: &VehicleModel,
        motion: &Motion,
        balance: &Balance,
        direction: &Motion,
        derivative: &mut Wrench,
    ) {
        let mass = model.vehicle().mass;
        let mut residual = [0.0; 2];
        let mut matrix = [[mass, 0.0], [0.0, mass]];
        for index in 0..self.wheels.len() {
            let change = model.wheel_motion(direction, index);
            let along = [
                change.forward,
                change.lateral,
                change.yaw_rate,
                change.angular_speed,
            ];
            let partial = self.wheels[index]
                .to_array()
                .map(|force| along.iter().zip(force.eps).map(|(d, e)| d * e).sum::<f64>());
            self.partial[index] = partial;
            let partial = WheelForces::from_array(partial);
            let slope = self.entry_slope(index);
            residual[0] += partial.thrust - partial.compaction;
            residual[1] += partial.lateral;
            if slope.vertical <= 0.0 {
                continue;
            }
            let by_load = [
                (slope.thrust - slope.compaction) / slope.vertical,
                slope.lateral / slope.vertical,
            ];
            for row in 0..2 {
                residual[row] -= by_load[row] * partial.vertical;
                matrix[row][0] -= by_load[row] * self.loads[index][1];
                matrix[row][1] -= by_load[row] * self.loads[index][2];
            }
        }
        let [a_x, a_y] = solve_2x2(matrix, residual);
        for index in 0..self.wheels.len() {
            let slope = self.entry_slope(index);
            let load = self.loads[index][1] * a_x + self.loads[index][2] * a_y;
            let mut total = self.partial[index];
            let mut entry = 0.0;
            if slope.vertical > 0.0 {
                entry = (load - WheelForces::from_array(total).vertical) / slope.vertical;
                for (sum, by_entry) in total.iter_mut().zip(slope.to_array()) {
                    *sum += by_entry * entry;
                }
            }
            self.forces[index] = WheelForces::from_array(total);
            let wheel = &mut derivative.wheels[index];
            wheel.load = load;
            wheel.entry_angle = entry;
            let radius = model.vehicle().wheel_radius;
            wheel.sinkage = radius * balance.wheels[index].entry_angle.sin() * entry;
        }
        derivative.sum(model, &self.forces);
        derivative.set_slip_derivatives(model, motion, direction);
    }

    fn entry_slope(&self, index: usize) -> WheelForces<f64> {
        WheelForces::from_array(self.wheels[index].to_array().map(|f| f.eps[DIRECTIONS - 1]))
    }
}

impl Wrench {
    /// The derivative of the slips (13) when the motion changes in `direction`.
    fn set_slip_derivatives(&mut self, model: &VehicleModel, motion: &Motion, direction: &Motion) {
        for (index, wheel) in self.wheels.iter_mut().enumerate() {
            let local = model.wheel_motion(motion, index);
            let change = model.wheel_motion(direction, index);
            let dual = |re, d| Dual { re, eps: [d] };
            let omega = dual(local.angular_speed, change.angular_speed);
            let forward = dual(local.forward, change.forward);
            let lateral = dual(local.lateral, change.lateral);
            let radius = dual(model.vehicle().wheel_radius, 0.0);
            let rim = model.slip_denominator(omega);
            wheel.longitudinal_slip = (-(forward - radius * omega) / rim).eps[0];
            wheel.lateral_slip = (-lateral / rim).eps[0];
        }
    }
}
