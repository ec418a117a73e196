//! What a vehicle and its ground remember: states besides position and velocity.

use super::rut::{Ruts, SPEED_FLOOR};
use super::situation::Situation;
use super::{Chassis, Tracks};
use crate::contact::{Wheel, WheelMemory};
use crate::effects::{Boundary, Displacement, Effects, SlopeProfile};
use crate::scalar::{Elementary, Scalar};
use crate::vehicle::Specification;

/// Which numbers are remembered, and where they stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct MemoryLayout {
    /// The distance driven.
    distance: bool,
    /// Four numbers of each wheel's shear displacement.
    shear: bool,
    /// The depth to which each wheel's soil was pressed before.
    rut: bool,
    wheels: usize,
}

/// What a remembered number is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Remembered {
    /// The distance driven.
    Distance,
    /// A part of a wheel's shear displacement.
    Shear,
    /// The depth to which a wheel's soil was pressed before.
    Rut,
}

/// Number of values of a wheel's shear displacement.
const SHEAR: usize = WheelMemory::COUNT - 1;
/// Entry angle \[rad\] of a rigid wheel below which its relaxation length no longer shrinks.
const SHORTEST_ARC: f64 = 0.02;

impl MemoryLayout {
    pub fn new(specification: &Specification) -> Self {
        let effects: &Effects = &specification.effects;
        let active = effects.active::<f64>(|_, _| None);
        let over_distance = matches!(effects.slope_profile, Some(SlopeProfile::Distance(_)))
            || (active.terrain_change.is_some() && effects.boundary == Boundary::Distance);
        Self {
            distance: over_distance,
            shear: active.transient_shear.is_some_and(|e| e.relaxation > 0.0),
            rut: active.multipass.is_some(),
            wheels: specification.vehicle.wheel_count(),
        }
    }

    /// Where the depth stands to which a wheel's soil was pressed before; `None` where wheels do not meet the ruts that
    /// they left.
    pub fn rut_of(&self, wheel: usize) -> Option<usize> {
        let place = self.first(wheel) + self.per_wheel();
        self.rut.then(|| place - 1)
    }

    /// How many numbers there are.
    pub fn count(&self) -> usize {
        usize::from(self.distance) + self.wheels * self.per_wheel()
    }

    fn per_wheel(&self) -> usize {
        SHEAR * usize::from(self.shear) + usize::from(self.rut)
    }

    fn first(&self, wheel: usize) -> usize {
        usize::from(self.distance) + wheel * self.per_wheel()
    }

    /// Names of the numbers, in order.
    pub fn names(&self) -> Vec<String> {
        let mut names = Vec::new();
        if self.distance {
            names.push("distance".into());
        }
        for wheel in 1..=self.wheels {
            let shear = ["shear_forward", "shear_lateral", "shear_yaw", "shear_rim"];
            let shear = shear.iter().filter(|_| self.shear);
            let rut = ["rut_depth"].iter().filter(|_| self.rut);
            names.extend(
                shear
                    .chain(rut)
                    .map(|name| format!("wheel[{wheel}].{name}")),
            );
        }
        names
    }

    /// The distance driven \[m\].
    pub fn distance(&self, memory: &[f64]) -> f64 {
        if self.distance {
            memory.first().copied().unwrap_or_default()
        } else {
            0.0
        }
    }

    /// What one wheel remembers, in the order of [`WheelMemory`]'s fields.
    pub fn wheel(&self, memory: &[f64], wheel: usize) -> [f64; WheelMemory::COUNT] {
        let mut values = [0.0; WheelMemory::COUNT];
        let first = self.first(wheel);
        let Some(own) = memory.get(first..first + self.per_wheel()) else {
            return values;
        };
        for (place, value) in self.places().zip(own) {
            values[place] = *value;
        }
        values
    }

    /// Where, in [`WheelMemory`]'s order, a wheel's numbers belong.
    pub fn places(&self) -> impl Iterator<Item = usize> {
        let from = if self.shear { 0 } else { SHEAR };
        let to = if self.rut { WheelMemory::COUNT } else { SHEAR };
        from..to
    }

    /// The wheel and the place in [`WheelMemory`]'s order of a number; `None` for the distance.
    pub fn owner(&self, index: usize) -> Option<(usize, usize)> {
        let index = index.checked_sub(usize::from(self.distance))?;
        let (wheel, own) = (index / self.per_wheel(), index % self.per_wheel());
        self.places().nth(own).map(|place| (wheel, place))
    }

    /// What a number is. `None` beyond the last.
    pub fn what(&self, index: usize) -> Option<Remembered> {
        match self.owner(index) {
            Some((_, SHEAR)) => Some(Remembered::Rut),
            Some(_) => Some(Remembered::Shear),
            None if self.distance && index == 0 => Some(Remembered::Distance),
            None => None,
        }
    }

    /// Adds the rates of change of the numbers, of wheels in their contact.
    pub fn rates<S: Scalar>(
        &self,
        chassis: &Chassis<S>,
        at: &Situation<S>,
        wheel: impl Fn(usize) -> Wheel<S>,
        tracks: Tracks,
        rates: &mut Vec<S>,
    ) {
        if self.distance {
            let [x, y] = at.velocity;
            rates.push((x * x + y * y).offset(SPEED_FLOOR).sqrt());
        }
        if self.per_wheel() == 0 {
            return;
        }
        let effect = chassis.effects.multipass.filter(|_| self.rut);
        let ruts = effect
            .as_ref()
            .map(|effect| Ruts::new(chassis, effect, at, &wheel, tracks));
        for index in 0..self.wheels {
            let wheel = wheel(index);
            let (motion, law) = (&wheel.motion, &wheel.law);
            if let (true, Some(effect)) = (self.shear, &chassis.effects.transient_shear) {
                let drive = Displacement {
                    forward: motion.forward,
                    lateral: motion.lateral,
                    yaw: motion.yaw_rate,
                    rim: motion.angular_speed * law.radius,
                };
                let contact = law.arc(wheel.reach);
                let turning = motion.angular_speed.rounded_abs(1e-9) * law.radius / contact.circle;
                // The shortest one is the wheel's, not that of the larger circle on which a flat tyre stands.
                let shortest = (law.radius / contact.circle).scale(SHORTEST_ARC);
                let whole = contact.entry * law.rebound.offset(1.0);
                let arc = whole.max(shortest);
                let rate = effect.rate(
                    &wheel.memory.displacement,
                    &drive,
                    turning,
                    arc,
                    law.soil.shear_modulus,
                );
                rates.extend([rate.forward, rate.lateral, rate.yaw, rate.rim]);
            }
            if let Some(ruts) = &ruts {
                rates.push(ruts.rate(index, wheel.memory.pressed));
            }
        }
    }
}
