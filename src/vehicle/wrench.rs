//! What the ground does to the vehicle: totals and each wheel's share.

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
    /// Number of the fields of the whole vehicle.
    pub(crate) const TOTALS: usize = 9;

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

    /// Visits every number, those of the whole vehicle first.
    pub(crate) fn visit(&mut self, visit: &mut impl FnMut(&mut f64)) {
        for total in [
            &mut self.a_x,
            &mut self.a_y,
            &mut self.yaw_acceleration,
            &mut self.rolling_resistance,
            &mut self.turning_resistance_moment,
            &mut self.turning_moment,
            &mut self.torque_left,
            &mut self.torque_right,
            &mut self.power,
        ] {
            visit(total);
        }
        for wheel in &mut self.wheels {
            let mut numbers = wheel.to_array();
            numbers.iter_mut().for_each(&mut *visit);
            *wheel = WheelOutputs::from_array(numbers);
        }
    }

    /// Sets the numbers of the whole vehicle, in the order of the fields.
    pub(super) fn set_totals(&mut self, totals: [f64; Self::TOTALS]) {
        [
            self.a_x,
            self.a_y,
            self.yaw_acceleration,
            self.rolling_resistance,
            self.turning_resistance_moment,
            self.turning_moment,
            self.torque_left,
            self.torque_right,
            self.power,
        ] = totals;
    }

    /// Takes over another wrench of the same vehicle without allocating.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.wheels.copy_from_slice(&other.wheels);
        let wheels = std::mem::take(&mut self.wheels);
        *self = Self { wheels, ..*other };
    }
}
