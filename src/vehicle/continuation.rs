//! The balance where Newton's method fails: by continuation in the load below which a wheel's forces fade.
//!
//! On cohesive soil a braking wheel is dragged down by the shear on its front: without any load it stands at an entry
//! angle of its own and pulls several hundred newtons. The fading below [`Prepared::lightest_load`] keeps the
//! forces continuous in the load, but they grow from 0 within half a newton, and Newton's steps jump across.
//! Where all forces fade slowly the balance is easy to find; from there it is followed to the model's own fading.

use super::balance::{ENTRY_ANGLE_RANGE, MAX_LOG_STEP};
use super::newton::{BalanceError, STEP_TOLERANCE, solve_2x2};
use super::prepared::Prepared;
use super::{Balance, Motion, VehicleModel};
use crate::contact::{Detail, Wheel, WheelForces, WheelLaw, WheelMemory, WheelMotion};
use std::f64::consts::FRAC_PI_2;

/// Factor by which the fading load shrinks from one stage to the next, at first and at the slowest.
const FIRST_FACTOR: f64 = 4.0;
const SLOWEST_FACTOR: f64 = 1.1;
/// Newton's steps within a stage, and the evaluations along one of them.
const MAX_STEPS: usize = 15;
const MAX_HALVINGS: usize = 6;
/// Stages, failed ones among them.
const MAX_STAGES: usize = 30;
/// Steps of accelerations that trail the forces, and how many times the mass they trail by at the longest.
const MAX_TRAILING_STEPS: usize = 400;
const LONGEST_TRAILING: f64 = 1e6;
/// Evaluations of one wheel until it carries its load: bisection alone ends sooner.
const MAX_EVALUATIONS: usize = 80;
/// Acceleration \[m/s^2\] that is worth no further step.
const RESIDUAL_TOLERANCE: f64 = 5e-4;
/// The residual of a wheel's load as a share of it, and the width of a bracket as a share of the angle.
const LOAD_TOLERANCE: f64 = 1e-6;
const ANGLE_TOLERANCE: f64 = 1e-9;
/// Angle \[rad\] below which nothing is bisected.
const LOWEST_BISECTED: f64 = 1e-6;

/// What one stage ended with.
enum Stage {
    Settled,
    Failed,
    NotFinite,
}

/// Whether the forces that are missing \[N\] hardly accelerate the vehicle.
fn is_settled(missing: [f64; 2], mass: f64) -> bool {
    missing
        .iter()
        .all(|force| force.abs() < mass * RESIDUAL_TOLERANCE)
}

impl VehicleModel {
    /// Finds the balance from the acceleration \[m/s^2\] of a guess.
    ///
    /// # Algorithm
    /// 0. Where the soil does not even bear the standing vehicle to its axles, the vehicle is bogged.
    /// 1. The acceleration trails the forces from the guess on until both agree ([`VehicleModel::trail`]): where there
    ///    are several balances it stays with the nearest stable one.
    /// 2. Where it does not arrive: no acceleration, and the fading load is the mean load.
    /// 3. Newton's method on a_X and a_Y, each step shortened until the residual shrinks. In every evaluation each
    ///    wheel's entry angle is the smallest one that carries its load, by Newton's method within a bracket.
    /// 4. Where it settles, the fading load shrinks; where it does not, by a smaller factor from the last balance.
    /// 5. At the model's own fading load the balance is the answer.
    ///
    /// # Errors
    /// A bogged wheel, or a motion whose balance is not found.
    pub(super) fn find(
        &self,
        motion: &Motion,
        prepared: &Prepared,
        guess: [f64; 2],
        balance: &mut Balance,
    ) -> Result<(), BalanceError> {
        balance.reset();
        let wheels = balance.wheels.len();
        let weight = prepared.weight();
        if self.bearing() * (wheels as f64) < weight {
            // Not even the standing vehicle is carried.
            return Err(self.bogged(0, weight / wheels as f64));
        }
        let last = prepared.lightest_load();
        balance.acceleration = guess;
        if self.trail(prepared, balance, last) {
            let outcome = self.check_carried(balance);
            balance.fade_light_wheels();
            return outcome;
        }
        balance.reset();
        let mut fading = weight / wheels as f64;
        let mut factor = FIRST_FACTOR;
        let mut settled = balance.clone();
        for _ in 0..MAX_STAGES {
            match self.stage(prepared, balance, fading) {
                Stage::NotFinite => {
                    return Err(BalanceError::NotFinite(*motion));
                }
                Stage::Settled if fading <= last => {
                    let outcome = self.check_carried(balance);
                    balance.fade_light_wheels();
                    return outcome;
                }
                Stage::Settled => {
                    settled.copy_from(balance);
                    factor = (factor * factor).min(FIRST_FACTOR);
                }
                Stage::Failed => {
                    // Back to the fading load of the last balance, and on by less.
                    fading *= factor;
                    balance.copy_from(&settled);
                    factor = factor.sqrt();
                    if factor < SLOWEST_FACTOR {
                        break;
                    }
                }
            }
            fading = (fading / factor).max(last);
        }
        self.check_carried(balance)?;
        Err(BalanceError::NotConverged(*motion))
    }

    /// Refuses a balance in which a wheel does not carry its load.
    fn check_carried(&self, balance: &Balance) -> Result<(), BalanceError> {
        let mut wheels = balance.wheels.iter().zip(&balance.slopes);
        let sunk = wheels
            .position(|(wheel, slope)| wheel.entry_angle >= FRAC_PI_2 || slope.vertical <= 0.0);
        sunk.map_or(Ok(()), |index| {
            Err(self.bogged(index, balance.wheels[index].load))
        })
    }

    /// The error of a wheel that cannot carry its load.
    pub(super) fn bogged(&self, index: usize, load: f64) -> BalanceError {
        BalanceError::Bogged {
            wheel: index + 1,
            load,
            bearing: self.bearing(),
        }
    }

    /// What the soil bears at rest under a wheel that stands in it to its axle \[N\], without effects.
    fn bearing(&self) -> f64 {
        let vehicle = self.vehicle();
        let wheel = Wheel {
            motion: WheelMotion {
                forward: 0.0,
                lateral: 0.0,
                yaw_rate: 0.0,
                angular_speed: 0.0,
            },
            reach: FRAC_PI_2,
            memory: WheelMemory::NONE,
            law: WheelLaw::paper(self.bare_soil(), vehicle.wheel_radius, vehicle.wheel_width),
        };
        let axle = self.contact().forces(self.level(), &wheel, Detail::Full);
        axle.vertical
    }

    /// Newton's method on the accelerations at one fading load.
    fn stage(&self, prepared: &Prepared, balance: &mut Balance, fading: f64) -> Stage {
        let mass = prepared.chassis.mass;
        self.carry(prepared, balance, fading);
        for _ in 0..MAX_STEPS {
            let (matrix, residual) = self.acceleration_system(prepared, balance, fading);
            let step = solve_2x2(matrix, residual);
            let missing = residual[0].hypot(residual[1]);
            if !(step[0].is_finite() && step[1].is_finite() && missing.is_finite()) {
                return Stage::NotFinite;
            }
            let from = balance.acceleration;
            let mut share = 1.0;
            for halving in 0..=MAX_HALVINGS {
                balance.acceleration = [from[0] + share * step[0], from[1] + share * step[1]];
                self.carry(prepared, balance, fading);
                let (_, residual) = self.acceleration_system(prepared, balance, fading);
                let left = residual[0].hypot(residual[1]);
                if is_settled(residual, mass) {
                    return Stage::Settled;
                }
                if left < (1.0 - 1e-4 * share) * missing {
                    break;
                }
                // The last one is taken at any rate: it may lead across an edge at which a wheel lifts or fades.
                if halving < MAX_HALVINGS {
                    share *= 0.5;
                }
            }
        }
        Stage::Failed
    }

    /// Goes on to another balance: follows the accelerations as if they trailed the forces (pseudo-transient
    /// continuation, C. T. Kelley and D. E. Keyes, SIAM J. Numer. Anal. 35 (1998)), in steps of that time that grow
    /// as long as the accelerations move one way. Returns whether it arrived.
    fn trail(&self, prepared: &Prepared, balance: &mut Balance, fading: f64) -> bool {
        let mass = prepared.chassis.mass;
        let mut trailing = 1.0;
        let mut last = [0.0; 2];
        for _ in 0..MAX_TRAILING_STEPS {
            self.carry(prepared, balance, fading);
            let (mut matrix, residual) = self.acceleration_system(prepared, balance, fading);
            if is_settled(residual, mass) {
                return true;
            }
            matrix[0][0] += mass * trailing;
            matrix[1][1] += mass * trailing;
            let step = solve_2x2(matrix, residual);
            if !(step[0].is_finite() && step[1].is_finite()) {
                return false;
            }
            let turned = step[0] * last[0] + step[1] * last[1] < 0.0;
            trailing = if turned {
                (4.0 * trailing).min(LONGEST_TRAILING)
            } else {
                0.6 * trailing
            };
            last = step;
            balance.acceleration[0] += step[0];
            balance.acceleration[1] += step[1];
        }
        false
    }

    /// Lets every wheel carry its load at the balance's accelerations, or the fading load if that is larger.
    fn carry(&self, prepared: &Prepared, balance: &mut Balance, fading: f64) {
        balance.lifted = prepared.distribute(balance.acceleration, &mut balance.loads);
        for index in 0..balance.wheels.len() {
            let load = balance.loads[index][0];
            let target = load.max(fading);
            let wheel = &mut balance.wheels[index];
            wheel.load = load;
            wheel.share = load / target;
            if wheel.entry_angle <= 0.0 {
                wheel.entry_angle = prepared.reach_guess(index, target);
            }
            self.carry_one(prepared, balance, index, target);
        }
    }

    /// Finds the smallest entry angle at which a wheel carries a load, and its forces there. Where the ground bears less
    /// at any angle, the one at which it bears most, and forces that do not change with the load.
    fn carry_one(&self, prepared: &Prepared, balance: &mut Balance, index: usize, target: f64) {
        let (first, last) = ENTRY_ANGLE_RANGE;
        // The angle lies between these.
        let (mut low, mut high) = (first, f64::INFINITY);
        let mut angle = balance.wheels[index].entry_angle.clamp(first, last);
        for _ in 0..MAX_EVALUATIONS {
            balance.wheels[index].entry_angle = angle;
            self.evaluate_wheel(prepared, balance, index);
            let force = balance.forces[index].vertical;
            let growth = angle * balance.slopes[index].vertical;
            if (force - target).abs() <= LOAD_TOLERANCE * target {
                return;
            }
            // Next to no entry the shear may pull harder than the stress bears; behind the greatest bearing it sinks.
            let sinks = force > 0.0 && growth <= 0.0;
            if force >= target || sinks {
                high = high.min(angle);
            } else if angle < last {
                low = low.max(angle);
            } else {
                break;
            }
            if high.is_finite() && high - low <= ANGLE_TOLERANCE * high {
                break;
            }
            // In the logarithms of angle and force, which are nearly proportional.
            let log_step = (target / force).ln() * force / growth;
            let newton = angle * log_step.clamp(-MAX_LOG_STEP, MAX_LOG_STEP).exp();
            angle = if newton > low && newton < high {
                newton
            } else if high.is_finite() {
                (low.max(LOWEST_BISECTED) * high).sqrt()
            } else {
                (angle * MAX_LOG_STEP.exp()).min(last)
            };
        }
        if balance.forces[index].vertical < (1.0 - STEP_TOLERANCE) * target {
            balance.slopes[index] = WheelForces::zero();
        }
    }
}
