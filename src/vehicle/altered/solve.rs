//! The balance of a vehicle whose motion effects alter.

use super::loads::{LoadTargets, spread_loads};
use super::rut::{Ruts, TrackSlope};
use super::{Chassis, Environment, MemoryLayout, Situation, Surroundings, Tracks};
use crate::contact::{Detail, Regularisation, WheelContact, WheelForces, WheelMemory};
use crate::effects::{Boundary, SlopeProfile};
use crate::parameter::{Bounds, ParameterError};
use crate::scalar::{Dual, Scalar};
use crate::vehicle::{Balance, Motion, Specification, WheelOutputs, Wrench};
use fearless_simd::Level;

/// What is shorter \[m\] may be stepped over: a ramp of a tenth of a millimetre that stands for an edge would cost
/// thousands of steps a second all the way.
const FINEST: f64 = 0.02;

/// A specification with effects, prepared for evaluation.
#[derive(Debug, Clone)]
pub(crate) struct Altered {
    pub specification: Specification,
    pub chassis: Chassis<f64>,
    pub layout: MemoryLayout,
    /// The same outside of the effects' window, where they have one.
    pub outside: Option<Outside>,
    /// The length \[m\] of the shortest thing that lies in the way.
    pub grain: Option<f64>,
}

/// A specification and its chassis outside of the effects' window.
#[derive(Debug, Clone)]
pub(crate) struct Outside {
    pub specification: Specification,
    pub chassis: Chassis<f64>,
}

/// What holds throughout one solution.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Prepared<'a> {
    pub altered: &'a Altered,
    /// The one that holds at this time and place.
    pub chassis: &'a Chassis<f64>,
    pub situation: Situation<f64>,
    pub environment: Environment<f64>,
    pub memory: &'a [f64],
    pub tracks: Tracks<'a>,
}

/// Accelerations, resistances and moments of the whole vehicle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Totals<S> {
    pub acceleration: [S; 2],
    pub yaw_acceleration: S,
    pub rolling_resistance: S,
    pub turning_moment: S,
    pub turning_resistance_moment: S,
}

impl Altered {
    /// Applies the effects of a specification whose vehicle and terrain are valid.
    ///
    /// # Errors
    /// A soil that the effects leave without stiffness.
    pub fn new(specification: &Specification) -> Result<Self, ParameterError> {
        let chassis = Chassis::new(specification, |_| None);
        let outside = specification.effects.outside().map(|effects| {
            let specification = Specification {
                effects,
                ..specification.clone()
            };
            let own = Chassis::new(&specification, |_| None);
            Outside {
                chassis: own.remembering_like(&chassis),
                specification,
            }
        });
        if chassis.effects.tyre_compliance.is_some() {
            // A tyre's stiffness has 3 - n in its denominator.
            let below = Bounds::half_open("sinkage_exponent", "1", 0.0, 3.0);
            below
                .because("with tyre_compliance")
                .check(specification.terrain.sinkage_exponent)?;
        }
        let other = outside.iter().flat_map(|outside| &outside.chassis.wheels);
        for wheel in chassis.wheels.iter().chain(other) {
            Bounds::open_low("sinkage modulus", "N/m^(n+2)", 0.0, 1e16)
                .check(wheel.law.soil.modulus)?;
        }
        let effects = &specification.effects;
        let profile = effects.slope_profile.as_ref();
        let window = effects.window.as_ref();
        let grains = [
            profile.and_then(SlopeProfile::min_feature_length),
            window.and_then(|window| window.extent.min_feature_length()),
        ];
        let shortest = grains.into_iter().flatten().reduce(f64::min);
        Ok(Self {
            specification: specification.clone(),
            chassis,
            layout: MemoryLayout::new(specification),
            grain: shortest.map(|grain| grain.max(FINEST)),
            outside,
        })
    }

    /// The chassis outside of the effects' window, if the vehicle is there.
    pub fn outside_at(&self, surroundings: &Surroundings) -> Option<&Outside> {
        let window = self.specification.effects.window.as_ref()?;
        let inside = window
            .extent
            .holds(surroundings.time, surroundings.position);
        self.outside.as_ref().filter(|_| !inside)
    }

    pub fn prepare<'a>(
        &'a self,
        motion: &Motion,
        surroundings: &Surroundings<'a>,
        regularisation: &Regularisation,
    ) -> Prepared<'a> {
        let situation = Situation::new(motion, surroundings, &self.layout);
        let fading = regularisation.travel_speed;
        let outside = self.outside_at(surroundings);
        let chassis = outside.map_or(&self.chassis, |outside| &outside.chassis);
        let effects = &self.specification.effects;
        Prepared {
            altered: self,
            chassis,
            situation,
            environment: chassis.environment(&situation, effects, fading),
            memory: surroundings.memory,
            tracks: surroundings.tracks,
        }
    }
}

impl Prepared<'_> {
    /// Fills a wrench with what a balance means here.
    pub fn wrench(&self, balance: &Balance, regularisation: &Regularisation, wrench: &mut Wrench) {
        let (chassis, layout) = (self.chassis, &self.altered.layout);
        let situation = &self.situation;
        let totals = chassis.totals(&self.environment, situation.yaw_rate, &balance.forces);
        [wrench.a_x, wrench.a_y] = totals.acceleration;
        wrench.yaw_acceleration = totals.yaw_acceleration;
        wrench.rolling_resistance = totals.rolling_resistance;
        wrench.turning_moment = totals.turning_moment;
        wrench.turning_resistance_moment = totals.turning_resistance_moment;
        for (index, wheel) in balance.wheels.iter().enumerate() {
            let carries = wheel.load > 0.0;
            let entry_angle = if carries { wheel.entry_angle } else { 0.0 };
            let memory = layout.wheel(self.memory, index);
            wrench.wheels[index] = WheelOutputs::from_array(chassis.outputs(
                situation,
                regularisation,
                self.altered.specification.effects.boundary,
                index,
                wheel.load,
                entry_angle,
                &memory,
                &balance.forces[index],
            ));
        }
    }

    /// Writes the rates of what is remembered.
    pub fn memory_rates(&self, balance: &Balance, rates: &mut Vec<f64>) {
        let Altered {
            layout,
            specification,
            ..
        } = self.altered;
        layout.rates(
            self.chassis,
            &self.situation,
            &self.standing(balance),
            self.tracks,
            specification.effects.boundary,
            rates,
        );
    }

    /// Each wheel's entry angle and what it remembers.
    fn standing(&self, balance: &Balance) -> Vec<(f64, WheelMemory<f64>)> {
        let layout = &self.altered.layout;
        let wheels = balance.wheels.iter().enumerate();
        wheels
            .map(|(index, wheel)| (wheel.entry_angle, layout.wheel(self.memory, index)))
            .collect()
    }

    /// How the rates of what the wheels meet depend on the samples of their tracks.
    pub fn track_slopes(&self, balance: &Balance) -> Vec<TrackSlope> {
        let Some(effect) = &self.chassis.effects.multipass else {
            return Vec::new();
        };
        let boundary = self.altered.specification.effects.boundary;
        let wheels = 0..balance.wheels.len();
        let laws: Vec<_> = wheels
            .map(|index| self.chassis.law(&self.situation, boundary, index))
            .collect();
        Ruts::new(
            self.chassis,
            effect,
            &self.situation,
            &laws,
            &self.standing(balance),
            self.tracks,
        )
        .slopes()
    }

    /// Writes each wheel's load and its derivatives by the ground's specific force; whether one is
    /// lifted.
    pub fn distribute(&self, specific: [f64; 2], loads: &mut [[f64; 3]]) -> bool {
        let chassis = self.chassis;
        let lift = Dual::<f64, 2>::constant;
        let count = loads.len();
        let places: Vec<_> = (0..count).map(|i| chassis.arm(i).map(lift)).collect();
        let targets = LoadTargets::new(
            lift(chassis.mass * self.environment.gravity.normal),
            self.environment.load_moments.map(lift),
            lift(chassis.mass * chassis.com_height),
            [0, 1].map(|axis| Dual::variable(specific[axis], axis)),
        );
        let mut duals = vec![lift(0.0); count];
        let lifted = spread_loads(&places, &targets, &mut duals);
        for (load, dual) in loads.iter_mut().zip(duals) {
            *load = [dual.re, dual.eps[0], dual.eps[1]];
        }
        lifted
    }

    /// A guess for how far a wheel reaches into the ground that would do so by `rigid` \[rad\] without a tyre.
    pub fn reach(&self, index: usize, rigid: f64) -> f64 {
        self.chassis.wheels[index].law.reach(rigid)
    }

    /// One wheel's forces and their slopes by its entry angle.
    pub fn wheel(
        &self,
        level: Level,
        contact: &WheelContact,
        index: usize,
        entry_angle: f64,
        detail: Detail,
    ) -> WheelForces<Dual<f64, 1>> {
        let Altered {
            layout,
            specification,
            ..
        } = self.altered;
        let chassis = self.chassis;
        let law = chassis.law(&self.situation, specification.effects.boundary, index);
        let motion = chassis.wheel_motion(&self.situation, index);
        let lift = Dual::constant;
        let motion = crate::contact::WheelMotion {
            forward: lift(motion.forward),
            lateral: lift(motion.lateral),
            yaw_rate: lift(motion.yaw_rate),
            angular_speed: lift(motion.angular_speed),
        };
        let memory = layout.wheel(self.memory, index).to_array().map(lift);
        let memory = crate::contact::WheelMemory::from_array(memory);
        let entry = Dual::variable(entry_angle, 0);
        contact.altered_forces(level, &law.lift(), &motion, &memory, entry, detail)
    }
}

impl<S: Scalar> Chassis<S> {
    /// One wheel's numbers in the order of [`crate::vehicle::WheelOutputs`]; the sinkage is
    /// counted from the untouched surface.
    #[allow(
        clippy::too_many_arguments,
        reason = "what a wheel's outputs depend on"
    )]
    pub fn outputs(
        &self,
        at: &Situation<S>,
        regularisation: &Regularisation,
        boundary: Boundary,
        index: usize,
        load: S,
        entry_angle: S,
        memory: &WheelMemory<S>,
        forces: &WheelForces<S>,
    ) -> [S; WheelOutputs::COUNT] {
        let law = self.law(at, boundary, index);
        let motion = self.wheel_motion(at, index);
        let omega = motion.angular_speed;
        let sign = if omega.value() < 0.0 { -1.0 } else { 1.0 };
        let rim = regularisation.bounded_angular_speed(omega).scale(sign) * law.radius;
        let arc = law.arc(entry_angle);
        let ground = law
            .multipass
            .map_or(S::constant(0.0), |effect| effect.rut(memory.pressed).ground);
        [
            -(motion.forward - law.radius * omega) / rim,
            -motion.lateral / rim,
            load,
            arc.sinkage() + ground,
            arc.entry,
            forces.thrust - forces.compaction,
            forces.lateral,
            forces.torque,
        ]
    }

    /// Sums the forces of all wheels and of the surroundings; the acceleration is that of the
    /// reference point.
    pub fn totals(
        &self,
        environment: &Environment<S>,
        yaw_rate: S,
        forces: &[WheelForces<S>],
    ) -> Totals<S> {
        let zero = S::constant(0.0);
        let (mut force, mut resistance) = (environment.force, zero);
        let (mut turning, mut turning_resistance) = (zero, zero);
        for (index, wheel) in forces.iter().enumerate() {
            let [ahead, left] = self.arm(index);
            let along = wheel.thrust - wheel.compaction;
            force[0] += along;
            force[1] += wheel.lateral;
            resistance += wheel.rolling_resistance;
            turning += -(left * along + wheel.width_moment);
            turning_resistance += -(ahead * wheel.lateral + wheel.arc_moment);
        }
        let yaw_acceleration =
            (turning - turning_resistance + environment.yaw_moment) / self.yaw_inertia;
        let [ahead, left] = self.com;
        let spin = yaw_rate * yaw_rate;
        let [along, across] = environment.gravity.along;
        Totals {
            acceleration: [
                force[0] / self.mass + along + yaw_acceleration * left + spin * ahead,
                force[1] / self.mass + across - yaw_acceleration * ahead + spin * left,
            ],
            yaw_acceleration,
            rolling_resistance: resistance,
            turning_moment: turning,
            turning_resistance_moment: turning_resistance,
        }
    }
}
