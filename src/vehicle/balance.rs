//! The balance of all wheels: the vertical force of every wheel carries its load (22), the loads follow from the
//! accelerations (28), and the accelerations from the wheels' forces (19), (20).

use crate::contact::WheelForces;

/// Longest step of ln(theta_1), and what replaces it where the vertical force does not grow.
pub(super) const MAX_LOG_STEP: f64 = 0.7;
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
