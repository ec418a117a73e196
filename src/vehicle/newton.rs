//! Newton's method on the balance of all wheels.

use super::balance::ENTRY_ANGLE_RANGE;
use super::prepared::Prepared;
use super::{Balance, Motion, Surroundings, VehicleModel, Wrench};
use crate::contact::{Detail, WheelForces};
use crate::display::rounded;
use crate::scalar::{Dual, Scalar};
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
/// The share of them for a step along slopes of an earlier balance, which leaves some tenths of itself.
const OLD_SLOPES_SHARE: f64 = 0.1;
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
        model.prepare(motion, surroundings).wrench(self, wrench);
    }
}

impl VehicleModel {
    /// Finds the balance at a motion, starting from what `balance` holds.
    ///
    /// Newton's method on all entry angles and both accelerations at once; each wheel's
    /// angle couples to the others through the accelerations alone, so that a step is one
    /// evaluation of every wheel and a 2 by 2 system. Where a balance nearby is known, the first
    /// step follows its slopes.
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
        self.solve_prepared(motion, &prepared, balance)
    }

    /// As [`VehicleModel::solve_at`], where effects are prepared already.
    pub(crate) fn solve_prepared(
        &self,
        motion: &Motion,
        prepared: &Prepared,
        balance: &mut Balance,
    ) -> Result<(), BalanceError> {
        if !motion.to_array().iter().all(|v| v.is_finite()) {
            return Err(BalanceError::NotFinite(*motion));
        }
        let guess = balance.acceleration;
        let mut damping = 1.0_f64;
        let mut last = [0.0; 2];
        for iteration in 0..MAX_ITERATIONS {
            let with_slopes = iteration > 0 || !balance.has_slopes();
            self.evaluate(prepared, balance, with_slopes);
            let fading = prepared.lightest_load();
            let (matrix, residual) = self.acceleration_system(prepared, balance, fading);
            let step = solve_2x2(matrix, residual);
            if !step.iter().all(|v| v.is_finite()) {
                balance.reset();
                return Err(BalanceError::NotFinite(*motion));
            }
            // Where wheels lift and touch down the steps may go to and fro: then shorten them. The last
            // one is taken whole, and so is what turns for rounding.
            let turned = step[0] * last[0] + step[1] * last[1] < 0.0;
            let share = if with_slopes { 1.0 } else { OLD_SLOPES_SHARE };
            let settled = step
                .iter()
                .all(|s| s.abs() < share * ACCELERATION_TOLERANCE);
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
            balance.lifted = prepared.distribute(balance.acceleration, &mut balance.loads);
            let longest = balance.advance(prepared.lightest_load());
            if settled && longest < share * STEP_TOLERANCE {
                balance.fade_light_wheels();
                let sunk = balance.sunk(FRAC_PI_2);
                return sunk.map_or(Ok(()), |k| Err(self.bogged(k, balance.wheels[k].load)));
            }
        }
        let found = self.find(motion, prepared, guess, balance);
        if found.is_err() {
            balance.reset();
        }
        found
    }

    /// Evaluates every wheel's forces, and their slopes by its entry angle where they are asked for.
    fn evaluate(&self, prepared: &Prepared, balance: &mut Balance, with_slopes: bool) {
        balance.lifted = prepared.distribute(balance.acceleration, &mut balance.loads);
        let lightest = prepared.lightest_load();
        for index in 0..balance.wheels.len() {
            let load = balance.loads[index][0];
            let target = load.max(lightest);
            let wheel = &mut balance.wheels[index];
            wheel.load = load;
            wheel.share = load / target;
            if wheel.entry_angle <= 0.0 {
                let (low, high) = ENTRY_ANGLE_RANGE;
                wheel.entry_angle = prepared.reach_guess(index, target).clamp(low, high);
            }
            if with_slopes {
                self.evaluate_wheel(prepared, balance, index);
            } else {
                let wheel = prepared.wheel(index, wheel.entry_angle);
                balance.forces[index] = self.contact().forces(self.level(), &wheel, Detail::Full);
            }
        }
    }

    /// One wheel's forces and their slopes by its entry angle.
    pub(super) fn evaluate_wheel(&self, prepared: &Prepared, balance: &mut Balance, index: usize) {
        let wheel = prepared.wheel(index, balance.wheels[index].entry_angle);
        let mut wheel = wheel.map(Dual::<f64, 1>::constant);
        wheel.reach.eps = [1.0];
        let forces = self
            .contact()
            .forces(self.level(), &wheel, Detail::Full)
            .to_array();
        balance.forces[index] = WheelForces::from_array(forces.map(|f| f.re));
        balance.slopes[index] = WheelForces::from_array(forces.map(|f| f.eps[0]));
    }

    /// Matrix and right side of Newton's step of a_X and a_Y, all entry angles following their loads.
    ///
    /// `fading` is the load \[N\] below which a wheel's forces are proportional to its load.
    pub(super) fn acceleration_system(
        &self,
        prepared: &Prepared,
        balance: &Balance,
        fading: f64,
    ) -> ([[f64; 2]; 2], [f64; 2]) {
        let mass = prepared.chassis.mass;
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
