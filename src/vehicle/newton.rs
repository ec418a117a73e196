//! Newton's method on the balance of all wheels.

use super::altered::Prepared;
use super::balance::ENTRY_ANGLE_RANGE;
use super::{Balance, Motion, Surroundings, VehicleModel, Wrench};
use crate::contact::{Detail, WheelForces, WheelMotion};
use crate::display::rounded;
use crate::scalar::Dual;
use fearless_simd::{Simd, dispatch};
use std::f64::consts::FRAC_PI_2;
use thiserror::Error;

/// Why the wheels find no balance.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BalanceError {
    /// A wheel would sink to its axle: its entry angle passes pi/2.
    #[error("the vehicle is bogged: wheel {wheel} sinks to its axle under its load of {load:.0} N; {}", bogged(*load, *bearing))]
    Bogged {
        /// Number of the wheel, from 1.
        wheel: usize,
        /// Its load \[N\].
        load: f64,
        /// What the soil bears at rest when the wheel stands in it to its axle \[N\], without effects.
        bearing: f64,
    },
    /// A velocity or wheel speed is not finite, or too large for finite forces.
    #[error("no finite forces at {}", words(.0))]
    NotFinite(Motion),
    /// Newton's method did not settle.
    #[error("the balance of loads and accelerations was not found at {}; the ground may hold the wheels so firmly that the vehicle tips", words(.0))]
    NotConverged(Motion),
}

fn bogged(load: f64, bearing: f64) -> String {
    if bearing > load {
        format!(
            "the soil bears {bearing:.0} N at rest, but the shear under the slipping wheel drags it down"
        )
    } else {
        format!("the soil is too soft for this vehicle: it bears {bearing:.0} N even there")
    }
}

fn words(motion: &Motion) -> String {
    let [v_x, v_y, yaw_rate, left, right] = motion.to_array().map(|value| rounded(value, 4));
    format!(
        "v_x {v_x} m/s, v_y {v_y} m/s, yaw rate {yaw_rate} rad/s, wheels {left} and {right} rad/s"
    )
}

/// Relative change of the entry angles, and change of the accelerations \[m/s^2\], below which
/// Newton's method stops. It applies that last step too, so what remains is its square.
pub(super) const STEP_TOLERANCE: f64 = 1e-3;
const ACCELERATION_TOLERANCE: f64 = 5e-3;
/// The coarse rule is worth no smaller steps than this.
const COARSE_STEP_TOLERANCE: f64 = 0.02;
/// Newton's method settles in two or three steps; many more mean that it never will.
const MAX_ITERATIONS: usize = 60;
/// So many steps are taken whole, and then none shorter than this share.
const UNDAMPED_ITERATIONS: usize = 6;
const SHORTEST_DAMPING: f64 = 1e-9;

impl Balance {
    /// A first guess: no acceleration, and unknown entry angles (0), which the solver takes from the loads.
    #[must_use]
    pub fn new(model: &VehicleModel) -> Self {
        Self::of_wheels(model.vehicle().wheel_count())
    }

    /// Fills a wrench with what this balance means at its motion.
    pub fn wrench(&self, model: &VehicleModel, motion: &Motion, wrench: &mut Wrench) {
        self.wrench_at(model, motion, &Surroundings::default(), wrench);
    }

    /// As [`Balance::wrench`], in surroundings on which effects may depend.
    pub fn wrench_at(
        &self,
        model: &VehicleModel,
        motion: &Motion,
        surroundings: &Surroundings,
        wrench: &mut Wrench,
    ) {
        let prepared = model.prepare(motion, surroundings);
        self.wrench_of(model, motion, prepared.as_ref(), wrench);
    }

    /// As [`Balance::wrench_at`], where effects are prepared already.
    pub(crate) fn wrench_of(
        &self,
        model: &VehicleModel,
        motion: &Motion,
        prepared: Option<&Prepared>,
        wrench: &mut Wrench,
    ) {
        if let Some(prepared) = prepared {
            prepared.wrench(self, model.regularisation(), wrench);
            return wrench.set_axles(motion);
        }
        wrench.sum(model.vehicle(), &self.forces);
        for (index, wheel) in self.wheels.iter().enumerate() {
            let entry_angle = if wheel.load > 0.0 {
                wheel.entry_angle
            } else {
                0.0
            };
            wrench.set_contact(model.vehicle().wheel_radius, index, wheel.load, entry_angle);
        }
        wrench.set_slips(model, motion);
        wrench.set_axles(motion);
    }

    /// Writes the rates of what the vehicle and its ground remember.
    pub(crate) fn memory_rates(&self, prepared: Option<&Prepared>, rates: &mut Vec<f64>) {
        if let (Some(prepared), false) = (prepared, rates.is_empty()) {
            prepared.memory_rates(self, rates);
        }
    }
}

impl VehicleModel {
    /// Finds the balance at a motion, starting from what `balance` holds.
    ///
    /// Newton's method on all entry angles and both accelerations at once; each wheel's
    /// angle couples to the others through the accelerations alone, so that a step is one
    /// evaluation of every wheel and a 2 by 2 system. Where nothing is known yet, the first
    /// steps integrate by the coarse rule.
    ///
    /// # Errors
    /// A bogged wheel, or a motion that is not finite. `balance` is then of no use as an
    /// answer, but still a guess.
    pub fn solve(&self, motion: &Motion, balance: &mut Balance) -> Result<(), BalanceError> {
        self.solve_at(motion, &Surroundings::default(), balance)
    }

    /// As [`VehicleModel::solve`], in surroundings on which effects may depend.
    ///
    /// # Errors
    /// As [`VehicleModel::solve`].
    pub fn solve_at(
        &self,
        motion: &Motion,
        surroundings: &Surroundings,
        balance: &mut Balance,
    ) -> Result<(), BalanceError> {
        let prepared = self.prepare(motion, surroundings);
        self.solve_prepared(motion, prepared.as_ref(), balance)
    }

    /// As [`VehicleModel::solve_at`], where effects are prepared already.
    pub(crate) fn solve_prepared(
        &self,
        motion: &Motion,
        prepared: Option<&Prepared>,
        balance: &mut Balance,
    ) -> Result<(), BalanceError> {
        if !motion.to_array().iter().all(|v| v.is_finite()) {
            return Err(BalanceError::NotFinite(*motion));
        }
        let fresh = balance.wheels.iter().all(|wheel| wheel.entry_angle == 0.0);
        let mut detail = if fresh { Detail::Coarse } else { Detail::Full };
        let guess = balance.acceleration;
        let mut damping = 1.0_f64;
        let mut last = [0.0; 2];
        for iteration in 0..MAX_ITERATIONS {
            self.evaluate(motion, prepared, balance, detail);
            let fading = self.lightest_load(prepared);
            let (matrix, residual) = self.acceleration_system(prepared, balance, fading);
            let step = solve_2x2(matrix, residual);
            if !step.iter().all(|v| v.is_finite()) {
                balance.reset();
                return Err(BalanceError::NotFinite(*motion));
            }
            // Where wheels lift and touch down the steps may go to and fro: then shorten them. The last
            // one is taken whole, and so is what turns for rounding.
            let turned = step[0] * last[0] + step[1] * last[1] < 0.0;
            let settled = step.iter().all(|s| s.abs() < ACCELERATION_TOLERANCE);
            if settled {
                damping = 1.0;
            } else if iteration >= UNDAMPED_ITERATIONS {
                damping = if turned {
                    (0.5 * damping).max(SHORTEST_DAMPING)
                } else {
                    (1.5 * damping).min(1.0)
                };
            }
            last = step;
            balance.acceleration[0] += damping * step[0];
            balance.acceleration[1] += damping * step[1];
            balance.lifted = self.distribute(prepared, balance.acceleration, &mut balance.loads);
            let longest = balance.advance(self.lightest_load(prepared));
            match detail {
                Detail::Coarse if longest < COARSE_STEP_TOLERANCE => detail = Detail::Full,
                Detail::Full if settled && longest < STEP_TOLERANCE => {
                    balance.fade_light_wheels();
                    let sunk = balance.sunk(FRAC_PI_2);
                    return sunk.map_or(Ok(()), |k| Err(self.bogged(k, balance.wheels[k].load)));
                }
                _ => {}
            }
        }
        let found = self.find(motion, prepared, guess, balance);
        if found.is_err() {
            balance.reset();
        }
        found
    }

    /// Mass of the vehicle with what it carries \[kg\].
    pub(super) fn mass(&self, prepared: Option<&Prepared>) -> f64 {
        prepared.map_or(self.vehicle().mass, |at| at.chassis.mass)
    }

    /// Load \[N\] below which a wheel's forces fade in proportion to it, a thousandth of the
    /// mean load. (A wheel on cohesive soil has forces that grow infinitely fast with the
    /// first newtons; with them no balance would be found where a wheel lifts.)
    pub(super) fn lightest_load(&self, prepared: Option<&Prepared>) -> f64 {
        1e-3 * self.weight(prepared) / self.vehicle().wheel_count() as f64
    }

    /// Evaluates every wheel's forces and their slope by its entry angle.
    fn evaluate(
        &self,
        motion: &Motion,
        prepared: Option<&Prepared>,
        balance: &mut Balance,
        detail: Detail,
    ) {
        dispatch!(self.level(), simd => self.evaluate_with(simd, motion, prepared, balance, detail));
    }

    /// Each wheel's load and its derivatives by a_X and a_Y; whether a wheel is lifted.
    pub(super) fn distribute(
        &self,
        prepared: Option<&Prepared>,
        acceleration: [f64; 2],
        loads: &mut [[f64; 3]],
    ) -> bool {
        match prepared {
            Some(prepared) => prepared.distribute(acceleration, loads),
            None => self.distribute_loads(acceleration, loads),
        }
    }

    #[inline(always)]
    fn evaluate_with<V: Simd>(
        &self,
        simd: V,
        motion: &Motion,
        prepared: Option<&Prepared>,
        balance: &mut Balance,
        detail: Detail,
    ) {
        balance.lifted = self.distribute(prepared, balance.acceleration, &mut balance.loads);
        let lightest = self.lightest_load(prepared);
        for index in 0..balance.wheels.len() {
            let load = balance.loads[index][0];
            let target = load.max(lightest);
            let wheel = &mut balance.wheels[index];
            wheel.load = load;
            wheel.share = load / target;
            if wheel.entry_angle <= 0.0 {
                let (low, high) = ENTRY_ANGLE_RANGE;
                let rigid = self.contact().entry_angle_guess(target);
                let guess = prepared.map_or(rigid, |at| at.reach(index, rigid));
                wheel.entry_angle = guess.clamp(low, high);
            }
            self.evaluate_wheel(simd, motion, prepared, balance, index, detail);
        }
    }

    /// One wheel's forces and their slopes by its entry angle.
    #[inline(always)]
    pub(super) fn evaluate_wheel<V: Simd>(
        &self,
        simd: V,
        motion: &Motion,
        prepared: Option<&Prepared>,
        balance: &mut Balance,
        index: usize,
        detail: Detail,
    ) {
        let entry_angle = balance.wheels[index].entry_angle;
        let forces = match prepared {
            Some(prepared) => {
                prepared.wheel(self.level(), self.contact(), index, entry_angle, detail)
            }
            None => self.plain_wheel(simd, motion, index, entry_angle, detail),
        };
        let forces = forces.to_array();
        balance.forces[index] = WheelForces::from_array(forces.map(|f| f.re));
        balance.slopes[index] = WheelForces::from_array(forces.map(|f| f.eps[0]));
    }

    /// One wheel's forces and their slopes by its entry angle, without effects.
    #[inline(always)]
    fn plain_wheel<V: Simd>(
        &self,
        simd: V,
        motion: &Motion,
        index: usize,
        entry_angle: f64,
        detail: Detail,
    ) -> WheelForces<Dual<f64, 1>> {
        let local = self.wheel_motion(motion, index);
        let constant = |re| Dual { re, eps: [0.0] };
        let local = WheelMotion {
            forward: constant(local.forward),
            lateral: constant(local.lateral),
            yaw_rate: constant(local.yaw_rate),
            angular_speed: constant(local.angular_speed),
        };
        let entry = Dual::<f64, 1>::variable(entry_angle, 0);
        self.contact().forces(simd, &local, entry, detail)
    }

    /// Matrix and right side of Newton's step of a_X and a_Y, all entry angles following their loads.
    ///
    /// `fading` is the load \[N\] below which a wheel's forces are proportional to its load.
    pub(super) fn acceleration_system(
        &self,
        prepared: Option<&Prepared>,
        balance: &Balance,
        fading: f64,
    ) -> ([[f64; 2]; 2], [f64; 2]) {
        let mass = self.mass(prepared);
        let [a_x, a_y] = balance.acceleration;
        let mut residual = [-mass * a_x, -mass * a_y];
        let mut matrix = [[mass, 0.0], [0.0, mass]];
        for (index, wheel) in balance.wheels.iter().enumerate() {
            let (force, slope) = (&balance.forces[index], &balance.slopes[index]);
            let load = balance.loads[index];
            let (force_x, slope_x) = (
                force.thrust - force.compaction,
                slope.thrust - slope.compaction,
            );
            residual[0] += wheel.share * force_x;
            residual[1] += wheel.share * force.lateral;
            if slope.vertical <= 0.0 {
                continue;
            }
            // Change of F_X and F_Y for each newton that the wheel carries.
            let by_vertical = [slope_x / slope.vertical, slope.lateral / slope.vertical];
            let missing = wheel.load - wheel.share * force.vertical;
            // A light wheel's forces fade with its load instead.
            let by_load = if wheel.share < 1.0 {
                [force_x / fading, force.lateral / fading]
            } else {
                by_vertical
            };
            for row in 0..2 {
                residual[row] += by_vertical[row] * missing;
                matrix[row][0] -= by_load[row] * load[1];
                matrix[row][1] -= by_load[row] * load[2];
            }
        }
        (matrix, residual)
    }
}

/// Solves a 2 by 2 system by Cramer's rule.
pub(super) fn solve_2x2(matrix: [[f64; 2]; 2], rhs: [f64; 2]) -> [f64; 2] {
    let [[a, b], [c, d]] = matrix;
    let determinant = a * d - b * c;
    [
        (rhs[0] * d - b * rhs[1]) / determinant,
        (a * rhs[1] - c * rhs[0]) / determinant,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_motion_is_named_in_words_with_units() {
        let motion = Motion {
            v_x: 1.200_004,
            v_y: -1e-9,
            yaw_rate: 0.1,
            omega_left: 4.0,
            omega_right: 1e300,
        };
        assert_eq!(
            BalanceError::NotFinite(motion).to_string(),
            "no finite forces at v_x 1.2 m/s, v_y 0 m/s, yaw rate 0.1 rad/s, wheels 4 and 1e300 rad/s"
        );
    }
}
