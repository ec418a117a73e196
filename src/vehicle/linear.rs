//! Exact derivatives of the wrench, by the implicit function theorem on the balance.

use super::newton::solve_2x2;
use super::wrench::by_side;
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
    /// Shares of the contacts' forces that act.
    shares: Vec<f64>,
    /// Scratch: derivatives of the forces in the direction asked for.
    forces: Vec<WheelForces<f64>>,
    /// Scratch: derivatives of the forces at held loads, and for each newton of load.
    held: Vec<[f64; FORCE_COUNT]>,
    by_load: Vec<[f64; FORCE_COUNT]>,
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
            shares: vec![1.0; count],
            forces: vec![WheelForces::zero(); count],
            held: vec![[0.0; FORCE_COUNT]; count],
            by_load: vec![[0.0; FORCE_COUNT]; count],
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
            self.shares[index] = wheel.share;
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
            self.held[index] = self.at_held_load(index, &change);
            self.by_load[index] = self.by_load(model, index);
            let held = WheelForces::from_array(self.held[index]);
            let by_load = WheelForces::from_array(self.by_load[index]);
            residual[0] += held.thrust - held.compaction;
            residual[1] += held.lateral;
            let by_load = [by_load.thrust - by_load.compaction, by_load.lateral];
            for row in 0..2 {
                matrix[row][0] -= by_load[row] * self.loads[index][1];
                matrix[row][1] -= by_load[row] * self.loads[index][2];
            }
        }
        let [a_x, a_y] = solve_2x2(matrix, residual);
        for index in 0..self.wheels.len() {
            let load = self.loads[index][1] * a_x + self.loads[index][2] * a_y;
            let (held, by_load) = (&self.held[index], &self.by_load[index]);
            let total = std::array::from_fn(|k| held[k] + by_load[k] * load);
            self.forces[index] = WheelForces::from_array(total);
            let change = model.wheel_motion(direction, index);
            let entry = self.entry_change(index, &change, load);
            let wheel = &mut derivative.wheels[index];
            wheel.load = load;
            wheel.entry_angle = entry;
            let radius = model.vehicle().wheel_radius;
            wheel.sinkage = radius * balance.wheels[index].entry_angle.sin() * entry;
        }
        derivative.sum(model.vehicle(), &self.forces);
        derivative.set_slip_derivatives(model, motion, direction);
        let wheels = self.wheels.iter().zip(&self.shares);
        let torques = by_side(wheels.map(|(forces, share)| share * forces.torque.re));
        let turned = [direction.omega_left, direction.omega_right];
        derivative.set_axle_derivatives(motion, torques, turned);
    }

    /// How a wheel's forces change at a fixed entry angle.
    fn at_fixed_angle(&self, index: usize, change: &WheelMotion<f64>) -> [f64; FORCE_COUNT] {
        let along = [
            change.forward,
            change.lateral,
            change.yaw_rate,
            change.angular_speed,
        ];
        let forces = self.wheels[index].to_array();
        forces.map(|force| along.iter().zip(force.eps).map(|(d, e)| d * e).sum::<f64>())
    }

    /// How a wheel's forces change while it goes on carrying the same load.
    fn at_held_load(&self, index: usize, change: &WheelMotion<f64>) -> [f64; FORCE_COUNT] {
        let fixed = self.at_fixed_angle(index, change);
        let slope = self.entry_slope(index);
        let entry = match slope.vertical {
            growth if growth > 0.0 => -WheelForces::from_array(fixed).vertical / growth,
            _ => 0.0,
        };
        let slope = slope.to_array();
        std::array::from_fn(|k| self.shares[index] * (fixed[k] + slope[k] * entry))
    }

    /// How a wheel's forces change for each newton of load: by the entry angle, or, of a light
    /// wheel, by their share.
    fn by_load(&self, model: &VehicleModel, index: usize) -> [f64; FORCE_COUNT] {
        let slope = self.entry_slope(index);
        if self.shares[index] < 1.0 {
            let lightest = model.lightest_load(None);
            self.wheels[index]
                .to_array()
                .map(|force| force.re / lightest)
        } else if slope.vertical > 0.0 {
            slope.to_array().map(|by_entry| by_entry / slope.vertical)
        } else {
            [0.0; FORCE_COUNT]
        }
    }

    /// How a wheel's entry angle changes; a light wheel's does not follow its load.
    fn entry_change(&self, index: usize, change: &WheelMotion<f64>, load: f64) -> f64 {
        let slope = self.entry_slope(index).vertical;
        if slope <= 0.0 {
            return 0.0;
        }
        let fixed = WheelForces::from_array(self.at_fixed_angle(index, change));
        let followed = if self.shares[index] < 1.0 { 0.0 } else { load };
        (followed - fixed.vertical) / slope
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
