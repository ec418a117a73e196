//! The balance of all wheels: every wheel carries its load, the loads follow from the
//! accelerations, and the accelerations from the wheels' forces.

use super::{Motion, VehicleModel, Wrench};
use crate::contact::{Detail, WheelForces, WheelMotion};
use crate::scalar::Dual;
use fearless_simd::{Simd, dispatch};
use std::f64::consts::FRAC_PI_2;
use std::fmt;

/// Entry angles and accelerations at which all wheels are in balance.
///
/// One balance is the first guess for the next; it owns all the memory that a solution
/// needs, so that solving allocates nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Balance {
    /// a_X, a_Y \[m/s^2\].
    pub(crate) acceleration: [f64; 2],
    pub(crate) wheels: Vec<BalancedWheel>,
    /// Whether some wheel carries nothing.
    pub(crate) lifted: bool,
    loads: Vec<[f64; 3]>,
    pub(super) forces: Vec<WheelForces<f64>>,
    slopes: Vec<WheelForces<f64>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct BalancedWheel {
    /// theta_1 \[rad\]; 0 where the wheel carries nothing.
    pub entry_angle: f64,
    /// Load \[N\].
    pub load: f64,
}

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

/// Why the wheels find no balance.
#[derive(Debug, Clone, PartialEq)]
pub enum BalanceError {
    /// A wheel would sink to its axle: its entry angle passes pi/2.
    Bogged {
        /// Number of the wheel, from 1.
        wheel: usize,
        /// Its load \[N\].
        load: f64,
    },
    /// A velocity or wheel speed is not finite, or too large for finite forces.
    NotFinite(Motion),
    /// Newton's method did not settle.
    NotConverged(Motion),
}

impl fmt::Display for BalanceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bogged { wheel, load } => write!(
                f,
                "the vehicle is bogged: wheel {wheel} sinks to its axle under its load of {load:.0} N \
                 (entry angle past 90 deg); the soil is too soft for this vehicle"
            ),
            Self::NotFinite(motion) => write!(f, "no finite forces at {motion:?}"),
            Self::NotConverged(motion) => {
                write!(f, "loads and accelerations did not settle at {motion:?}")
            }
        }
    }
}

impl std::error::Error for BalanceError {}

/// Relative change of the entry angles, and change of the accelerations \[m/s^2\], below which
/// Newton's method stops. It applies that last step too, so what remains is its square.
const STEP_TOLERANCE: f64 = 1e-3;
const ACCELERATION_TOLERANCE: f64 = 5e-3;
/// The coarse rule is worth no smaller steps than this.
const COARSE_STEP_TOLERANCE: f64 = 0.02;
/// Newton's method settles in two or three steps; many more mean that it never will.
const MAX_ITERATIONS: usize = 60;
/// Longest step of ln(theta_1), and what replaces it where the vertical force does not grow.
const MAX_LOG_STEP: f64 = 0.7;
/// Entry angles \[rad\] that the iteration may pass through; the answer must stay below pi/2.
const ENTRY_ANGLE_RANGE: (f64, f64) = (1e-7, 1.8);

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
        if !motion.to_array().iter().all(|v| v.is_finite()) {
            return Err(BalanceError::NotFinite(*motion));
        }
        let fresh = balance.wheels.iter().all(|wheel| wheel.entry_angle == 0.0);
        let mut detail = if fresh { Detail::Coarse } else { Detail::Full };
        for _ in 0..MAX_ITERATIONS {
            self.evaluate(motion, balance, detail);
            let step = self.acceleration_step(balance);
            if !step.iter().all(|v| v.is_finite()) {
                balance.reset();
                return Err(BalanceError::NotFinite(*motion));
            }
            balance.acceleration[0] += step[0];
            balance.acceleration[1] += step[1];
            balance.lifted = self.distribute_loads(balance.acceleration, &mut balance.loads);
            let longest = balance.advance();
            let settled = step.iter().all(|s| s.abs() < ACCELERATION_TOLERANCE);
            match detail {
                Detail::Coarse if longest < COARSE_STEP_TOLERANCE => detail = Detail::Full,
                Detail::Full if settled && longest < STEP_TOLERANCE => {
                    return balance.check_bogged();
                }
                _ => {}
            }
        }
        let outcome = balance.check_bogged();
        balance.reset();
        outcome.and(Err(BalanceError::NotConverged(*motion)))
    }

    /// Evaluates every wheel's forces and their slope by its entry angle.
    fn evaluate(&self, motion: &Motion, balance: &mut Balance, detail: Detail) {
        dispatch!(self.level(), simd => self.evaluate_with(simd, motion, balance, detail));
    }

    #[inline(always)]
    fn evaluate_with<V: Simd>(
        &self,
        simd: V,
        motion: &Motion,
        balance: &mut Balance,
        detail: Detail,
    ) {
        balance.lifted = self.distribute_loads(balance.acceleration, &mut balance.loads);
        for index in 0..balance.wheels.len() {
            let wheel = &mut balance.wheels[index];
            wheel.load = balance.loads[index][0];
            if wheel.load <= 0.0 {
                wheel.entry_angle = 0.0;
                balance.forces[index] = WheelForces::zero();
                balance.slopes[index] = WheelForces::zero();
                continue;
            }
            if wheel.entry_angle <= 0.0 {
                let (low, high) = ENTRY_ANGLE_RANGE;
                wheel.entry_angle = self
                    .contact()
                    .entry_angle_guess(wheel.load)
                    .clamp(low, high);
            }
            let local = self.wheel_motion(motion, index);
            let constant = |re| Dual { re, eps: [0.0] };
            let local = WheelMotion {
                forward: constant(local.forward),
                lateral: constant(local.lateral),
                yaw_rate: constant(local.yaw_rate),
                angular_speed: constant(local.angular_speed),
            };
            let entry = Dual::<f64, 1>::variable(wheel.entry_angle, 0);
            let forces = self
                .contact()
                .forces(simd, &local, entry, detail)
                .to_array();
            balance.forces[index] = WheelForces::from_array(forces.map(|f| f.re));
            balance.slopes[index] = WheelForces::from_array(forces.map(|f| f.eps[0]));
        }
    }

    /// Newton's step of a_X and a_Y, all entry angles following their loads.
    fn acceleration_step(&self, balance: &Balance) -> [f64; 2] {
        let mass = self.vehicle().mass;
        let [a_x, a_y] = balance.acceleration;
        let mut residual = [-mass * a_x, -mass * a_y];
        let mut matrix = [[mass, 0.0], [0.0, mass]];
        for ((force, slope), load) in balance
            .forces
            .iter()
            .zip(&balance.slopes)
            .zip(&balance.loads)
        {
            residual[0] += force.thrust - force.compaction;
            residual[1] += force.lateral;
            if load[0] <= 0.0 || slope.vertical <= 0.0 {
                continue;
            }
            // Change of F_X and F_Y for each newton of vertical load.
            let by_load = [
                (slope.thrust - slope.compaction) / slope.vertical,
                slope.lateral / slope.vertical,
            ];
            let missing = load[0] - force.vertical;
            for row in 0..2 {
                residual[row] += by_load[row] * missing;
                matrix[row][0] -= by_load[row] * load[1];
                matrix[row][1] -= by_load[row] * load[2];
            }
        }
        solve_2x2(matrix, residual)
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

impl Balance {
    /// A first guess: no acceleration, and entry angles from the loads at rest.
    #[must_use]
    pub fn new(model: &VehicleModel) -> Self {
        let count = model.vehicle().wheel_count();
        Self {
            acceleration: [0.0; 2],
            wheels: vec![BalancedWheel::default(); count],
            lifted: false,
            loads: vec![[0.0; 3]; count],
            forces: vec![WheelForces::zero(); count],
            slopes: vec![WheelForces::zero(); count],
        }
    }

    /// Moves the guess along a linearisation: `change` is how the motion differs from the
    /// one that this balance solves.
    pub(crate) fn predict(&mut self, trend: &Trend, change: &[f64; 5]) {
        let along = |slopes: &[f64; 5]| -> f64 {
            slopes
                .iter()
                .zip(change)
                .map(|(slope, by)| slope * by)
                .sum()
        };
        for (a, slopes) in self.acceleration.iter_mut().zip(&trend.acceleration) {
            *a += along(slopes);
        }
        for (wheel, slopes) in self.wheels.iter_mut().zip(&trend.entry_angles) {
            let longest = 0.2 * wheel.entry_angle;
            wheel.entry_angle += along(slopes).clamp(-longest, longest);
        }
    }

    /// Takes over another balance of the same vehicle without allocating.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.acceleration = other.acceleration;
        self.wheels.copy_from_slice(&other.wheels);
        self.lifted = other.lifted;
        self.loads.copy_from_slice(&other.loads);
        self.forces.copy_from_slice(&other.forces);
        self.slopes.copy_from_slice(&other.slopes);
    }

    /// Back to the first guess of [`Balance::new`].
    pub(crate) fn reset(&mut self) {
        self.acceleration = [0.0; 2];
        self.wheels.fill(BalancedWheel::default());
    }

    /// Whether some wheel carries nothing at this balance.
    #[must_use]
    pub fn lifted(&self) -> bool {
        self.lifted
    }

    /// Fills a wrench with what this balance means at its motion.
    pub fn wrench(&self, model: &VehicleModel, motion: &Motion, wrench: &mut Wrench) {
        wrench.sum(model, &self.forces);
        for (index, wheel) in self.wheels.iter().enumerate() {
            wrench.set_contact(model, index, wheel.load, wheel.entry_angle);
        }
        wrench.set_slips(model, motion);
    }

    /// Takes Newton's step of every entry angle, in the logarithms of angle and force
    /// (which are nearly proportional), carries the forces along to first order, and
    /// returns the longest step.
    fn advance(&mut self) -> f64 {
        let mut longest: f64 = 0.0;
        for index in 0..self.wheels.len() {
            let wheel = &mut self.wheels[index];
            let load = self.loads[index][0];
            if load <= 0.0 || wheel.load <= 0.0 {
                // A wheel that lifts or touches down is evaluated anew.
                if load != wheel.load {
                    longest = f64::INFINITY;
                }
                continue;
            }
            wheel.load = load;
            let (force, slope) = (&mut self.forces[index], &self.slopes[index]);
            let growth = wheel.entry_angle * slope.vertical;
            let log_step = if force.vertical > 0.0 && growth > 0.0 {
                ((load / force.vertical).ln() * force.vertical / growth)
                    .clamp(-MAX_LOG_STEP, MAX_LOG_STEP)
            } else {
                MAX_LOG_STEP
            };
            let (low, high) = ENTRY_ANGLE_RANGE;
            let next = (wheel.entry_angle * log_step.exp()).clamp(low, high);
            let step = next - wheel.entry_angle;
            longest = longest.max((step / next).abs());
            wheel.entry_angle = next;
            let (values, slopes) = (force.to_array(), slope.to_array());
            *force = WheelForces::from_array(std::array::from_fn(|k| values[k] + slopes[k] * step));
        }
        longest
    }

    /// Visits every number that a solution consists of, for a snapshot.
    pub(crate) fn visit(&mut self, visit: &mut impl FnMut(&mut f64)) {
        self.acceleration.iter_mut().for_each(&mut *visit);
        for wheel in &mut self.wheels {
            visit(&mut wheel.entry_angle);
            visit(&mut wheel.load);
        }
        for force in &mut self.forces {
            let mut numbers = force.to_array();
            numbers.iter_mut().for_each(&mut *visit);
            *force = WheelForces::from_array(numbers);
        }
        let mut lifted = f64::from(u8::from(self.lifted));
        visit(&mut lifted);
        self.lifted = lifted != 0.0;
    }

    fn check_bogged(&self) -> Result<(), BalanceError> {
        let deepest = self.wheels.iter().position(|w| w.entry_angle >= FRAC_PI_2);
        match deepest {
            Some(index) => Err(BalanceError::Bogged {
                wheel: index + 1,
                load: self.wheels[index].load,
            }),
            None => Ok(()),
        }
    }
}
