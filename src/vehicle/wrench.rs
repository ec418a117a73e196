//! What the ground does to the vehicle: totals and each wheel's share.

use super::{Motion, Vehicle};
use crate::contact::WheelForces;

/// Forces, moments and resistances at one instant (or their derivative in one direction).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Wrench {
    /// Acceleration of the centre of mass along X \[m/s^2\] (19); where effects move the centre of
    /// mass, of the point where the vehicle's parameters put it.
    pub a_x: f64,
    /// Acceleration of the centre of mass along Y \[m/s^2\] (20).
    pub a_y: f64,
    /// dOmega/dt \[rad/s^2\] (24).
    pub yaw_acceleration: f64,
    /// Rolling resistance R_r \[N\] (21).
    pub rolling_resistance: f64,
    /// Moment of turning resistance M_r \[N m\] (25).
    pub turning_resistance_moment: f64,
    /// Moment of the thrust \[N m\], the first term of (24).
    pub turning_moment: f64,
    /// Torque of the left axles \[N m\], positive drives forward.
    pub torque_left: f64,
    /// Torque of the right axles \[N m\], positive drives forward.
    pub torque_right: f64,
    /// Power of the axles \[W\], the sum of torque times angular speed; negative where the
    /// wheels brake.
    pub power: f64,
    /// Each wheel's share, front row first, left before right.
    pub wheels: Vec<WheelOutputs>,
}

/// One wheel at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WheelOutputs {
    /// Longitudinal slip S_X \[-\] at the wheel's lowest point (13).
    pub longitudinal_slip: f64,
    /// Lateral slip S_Y \[-\] at the wheel's lowest point (13).
    pub lateral_slip: f64,
    /// Vertical load \[N\].
    pub load: f64,
    /// Sinkage r (1 - cos theta_1) \[m\] (2).
    pub sinkage: f64,
    /// Entry angle theta_1 \[rad\].
    pub entry_angle: f64,
    /// Force of the ground along X \[N\] (18).
    pub force_x: f64,
    /// Force of the ground along Y \[N\] (18).
    pub force_y: f64,
    /// Torque of the axle on the wheel \[N m\], positive drives forward: the shear along the rim
    /// times the radius at which the rim rolls.
    pub torque: f64,
}

impl WheelOutputs {
    /// Number of the fields.
    pub(crate) const COUNT: usize = 8;

    /// The numbers in the order of the fields.
    fn to_array(self) -> [f64; Self::COUNT] {
        [
            self.longitudinal_slip,
            self.lateral_slip,
            self.load,
            self.sinkage,
            self.entry_angle,
            self.force_x,
            self.force_y,
            self.torque,
        ]
    }

    /// From the numbers in the order of the fields.
    pub(crate) fn from_array(
        [
            longitudinal_slip,
            lateral_slip,
            load,
            sinkage,
            entry_angle,
            force_x,
            force_y,
            torque,
        ]: [f64; Self::COUNT],
    ) -> Self {
        Self {
            longitudinal_slip,
            lateral_slip,
            load,
            sinkage,
            entry_angle,
            force_x,
            force_y,
            torque,
        }
    }
}

impl Wrench {
    /// Becomes the weighted sum of other wrenches' numbers (derivatives are added so).
    pub(crate) fn combine<'a>(&mut self, terms: impl Iterator<Item = (&'a Self, f64)>) {
        let count = self.wheels.len();
        *self = Self {
            wheels: std::mem::take(&mut self.wheels),
            ..Self::default()
        };
        self.wheels.clear();
        self.wheels.resize(count, WheelOutputs::default());
        for (term, weight) in terms {
            self.a_x += weight * term.a_x;
            self.a_y += weight * term.a_y;
            self.yaw_acceleration += weight * term.yaw_acceleration;
            self.rolling_resistance += weight * term.rolling_resistance;
            self.turning_resistance_moment += weight * term.turning_resistance_moment;
            self.turning_moment += weight * term.turning_moment;
            self.torque_left += weight * term.torque_left;
            self.torque_right += weight * term.torque_right;
            self.power += weight * term.power;
            for (sum, wheel) in self.wheels.iter_mut().zip(&term.wheels) {
                let (old, more) = (sum.to_array(), wheel.to_array());
                *sum = WheelOutputs::from_array(std::array::from_fn(|k| old[k] + weight * more[k]));
            }
        }
    }

    /// Takes over another wrench of the same vehicle without allocating.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.wheels.copy_from_slice(&other.wheels);
        let wheels = std::mem::take(&mut self.wheels);
        *self = Self { wheels, ..*other };
    }

    /// Sums the wheels' forces, which may as well be derivatives: the sums are linear.
    pub(super) fn sum(&mut self, vehicle: &Vehicle, forces: &[WheelForces<f64>]) {
        let (mut force_x, mut force_y) = (0.0, 0.0);
        let (mut resistance, mut turning, mut turning_resistance) = (0.0, 0.0, 0.0);
        for (index, force) in forces.iter().enumerate() {
            let (ahead, left) = vehicle.wheel_centre(index);
            let wheel_x = force.thrust - force.compaction;
            force_x += wheel_x;
            force_y += force.lateral;
            resistance += force.rolling_resistance;
            turning -= left * wheel_x + force.width_moment;
            turning_resistance -= ahead * force.lateral + force.arc_moment;
            self.wheels[index].force_x = wheel_x;
            self.wheels[index].force_y = force.lateral;
            self.wheels[index].torque = force.torque;
        }
        self.a_x = force_x / vehicle.mass;
        self.a_y = force_y / vehicle.mass;
        self.rolling_resistance = resistance;
        self.turning_moment = turning;
        self.turning_resistance_moment = turning_resistance;
        self.yaw_acceleration = (turning - turning_resistance) / vehicle.yaw_inertia;
    }

    /// Sums the wheels' torques by side, and their power, from the wheels' values.
    pub(super) fn set_axles(&mut self, motion: &Motion) {
        let torques = by_side(self.wheels.iter().map(|wheel| wheel.torque));
        [self.torque_left, self.torque_right] = torques;
        self.power = torques[0] * motion.omega_left + torques[1] * motion.omega_right;
    }

    /// The same of a derivative: in its direction the wheel speeds change by `turned` \[rad/s\],
    /// left and right, and the sides have these `torques` \[N m\].
    pub(super) fn set_axle_derivatives(
        &mut self,
        motion: &Motion,
        torques: [f64; 2],
        turned: [f64; 2],
    ) {
        self.set_axles(motion);
        self.power += torques[0] * turned[0] + torques[1] * turned[1];
    }

    /// Sets one wheel's load and entry angle, and the sinkage that follows.
    pub(super) fn set_contact(&mut self, radius: f64, index: usize, load: f64, entry: f64) {
        let wheel = &mut self.wheels[index];
        wheel.load = load;
        wheel.entry_angle = entry;
        // 1 - cos theta = 2 sin^2(theta / 2), exact for small angles.
        wheel.sinkage = radius * 2.0 * (entry / 2.0).sin().powi(2);
    }
}

/// Sums of the left and of the right wheels' numbers, in the order of the wheels.
pub(super) fn by_side(wheels: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for (index, number) in wheels.enumerate() {
        sums[index % 2] += number;
    }
    sums
}
