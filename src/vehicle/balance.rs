//! The balance of all wheels: the vertical force of every wheel carries its load (22), the loads follow from the
//! accelerations (28), and the accelerations from the wheels' forces (19), (20).

use super::{Differentiated, Direction};
use crate::contact::WheelForces;

/// Longest step of ln(theta_1), and what replaces it where the vertical force does not grow.
pub(super) const MAX_LOG_STEP: f64 = 0.7;
/// Farthest that accelerations are predicted \[m/s^2\]: slopes are steep next to standstill.
const LONGEST_PREDICTION: f64 = 2.0;
/// Entry angles \[rad\] that the iteration may pass through; the answer must stay below pi/2.
pub(super) const ENTRY_ANGLE_RANGE: (f64, f64) = (1e-12, 1.8);

/// Entry angles and accelerations at which all wheels are in balance.
///
/// One balance is the first guess for the next; it owns all the memory that a solution
/// needs, so that solving allocates nothing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Balance {
    /// a_X, a_Y \[m/s^2\].
    pub(crate) acceleration: [f64; 2],
    pub(crate) wheels: Vec<BalancedWheel>,
    /// Whether some wheel carries nothing.
    pub(crate) lifted: bool,
    pub(super) loads: Vec<[f64; 3]>,
    pub(super) forces: Vec<WheelForces<f64>>,
    pub(super) slopes: Vec<WheelForces<f64>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct BalancedWheel {
    /// theta_1 \[rad\] (its reach where a tyre may be flat, [`crate::contact::WheelLaw::arc`]), of a light wheel that
    /// of the lightest load; 0 where nothing is known.
    pub entry_angle: f64,
    /// Load \[N\].
    pub load: f64,
    /// Share of the contact's forces that act: below 1 where the load is lighter than the
    /// lightest one that is resolved.
    pub share: f64,
}

impl Balance {
    /// A first guess for so many wheels: no acceleration, and unknown entry angles (0).
    pub(super) fn of_wheels(count: usize) -> Self {
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
            *a += along(slopes).clamp(-LONGEST_PREDICTION, LONGEST_PREDICTION);
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
        self.slopes.fill(WheelForces::zero());
    }

    /// Whether slopes of the forces by the entry angles are known, of this balance or of one nearby.
    pub(super) fn has_slopes(&self) -> bool {
        self.slopes.iter().all(|slope| slope.vertical > 0.0)
    }

    /// Whether some wheel carries nothing at this balance.
    #[must_use]
    pub fn lifted(&self) -> bool {
        self.lifted
    }

    /// Takes Newton's step of every entry angle, in the logarithms of angle and force
    /// (which are nearly proportional), carries the forces along to first order, and
    /// returns the longest step.
    pub(super) fn advance(&mut self, lightest: f64) -> f64 {
        let mut longest: f64 = 0.0;
        for index in 0..self.wheels.len() {
            let (wheel, load) = (&mut self.wheels[index], self.loads[index][0]);
            let (force, slope) = (&mut self.forces[index], &self.slopes[index]);
            let target = load.max(lightest);
            wheel.load = load;
            wheel.share = load / target;
            let growth = wheel.entry_angle * slope.vertical;
            let log_step = if force.vertical > 0.0 && growth > 0.0 {
                ((target / force.vertical).ln() * force.vertical / growth)
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

    /// Lets the forces of light wheels fade: from here on they are those that act.
    pub(super) fn fade_light_wheels(&mut self) {
        for (wheel, force) in self.wheels.iter().zip(&mut self.forces) {
            if wheel.share < 1.0 {
                *force = WheelForces::from_array(force.to_array().map(|f| f * wheel.share));
            }
        }
    }

    /// Visits every number that a solution consists of, for a snapshot.
    pub(crate) fn visit(&mut self, visit: &mut impl FnMut(&mut f64)) {
        self.acceleration.iter_mut().for_each(&mut *visit);
        for wheel in &mut self.wheels {
            visit(&mut wheel.entry_angle);
            visit(&mut wheel.load);
            visit(&mut wheel.share);
        }
        for force in self.forces.iter_mut().chain(&mut self.slopes) {
            let mut numbers = force.to_array();
            numbers.iter_mut().for_each(&mut *visit);
            *force = WheelForces::from_array(numbers);
        }
        let mut lifted = f64::from(u8::from(self.lifted));
        visit(&mut lifted);
        self.lifted = lifted != 0.0;
    }

    /// The first wheel whose entry angle reaches `limit` \[rad\].
    pub(super) fn sunk(&self, limit: f64) -> Option<usize> {
        self.wheels.iter().position(|w| w.entry_angle >= limit)
    }
}

/// How a balance changes with the motion: derivatives by the five components of [`Motion`].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trend {
    pub acceleration: [[f64; 5]; 2],
    pub entry_angles: Vec<[f64; 5]>,
}

impl Trend {
    pub(crate) fn of_wheels(count: usize) -> Self {
        Self {
            acceleration: [[0.0; 5]; 2],
            entry_angles: vec![[0.0; 5]; count],
        }
    }

    /// Takes the derivatives of the wrench in those directions that are of the motion.
    pub(crate) fn take(&mut self, list: &[Direction], results: &[Differentiated]) {
        for (direction, result) in list.iter().zip(results) {
            let place = Direction::MOTION.iter().position(|one| one == direction);
            let Some(place) = place else { continue };
            let wrench = &result.wrench;
            self.acceleration[0][place] = wrench.a_x;
            self.acceleration[1][place] = wrench.a_y;
            for (slopes, wheel) in self.entry_angles.iter_mut().zip(&wrench.wheels) {
                slopes[place] = wheel.entry_angle;
            }
        }
    }

    /// Visits every number, for a snapshot.
    pub(crate) fn visit(&mut self, visit: &mut impl FnMut(&mut f64)) {
        let rows = self.acceleration.iter_mut().chain(&mut self.entry_angles);
        rows.flatten().for_each(visit);
    }
}
