//! Masses, places and laws of a vehicle after its effects, and what follows from its wheels' forces.

use super::loads::{GRAVITY, LoadPlane, LoadTargets};
use super::situation::{Environment, Situation};
use super::{
    ModelParameter, Specification, TerrainParameter, VehicleParameter, WheelOutputs, Wrench,
};
use crate::contact::{Regularisation, Wheel, WheelForces, WheelLaw, WheelMemory, WheelMotion};
use crate::effects::{
    ActiveEffects, Boundary, Effects, ResidualMotion, SlopeGravity, Soil, Unscaled,
};
use crate::scalar::{Elementary, Scalar};

/// A vehicle on a soil with its effects applied, generic over the scalar.
#[derive(Debug, Clone)]
pub(crate) struct Chassis<S> {
    /// Mass \[kg\].
    pub mass: S,
    /// Yaw moment of inertia about the centre of mass \[kg m^2\].
    pub yaw_inertia: S,
    /// Height of the centre of mass above the ground \[m\].
    pub com_height: S,
    /// The centre of mass, ahead and to the left of the reference point (the one that the
    /// vehicle's own parameters give, whose motion is the state) \[m\].
    pub com: [S; 2],
    /// The centroid ahead of the reference point \[m\].
    pub centroid: S,
    pub wheels: Vec<ChassisWheel<S>>,
    pub effects: ActiveEffects<S>,
    /// Where each wheel's soil lies on the map, or when it changes.
    boundary: Boundary,
    plane: LoadPlane<S>,
}

/// One wheel of a [`Chassis`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct ChassisWheel<S> {
    /// Place ahead and to the left of the reference point \[m\].
    pub place: [S; 2],
    pub law: WheelLaw<S>,
}

impl<S: Scalar> Chassis<S> {
    /// Applies the effects; `seed` makes parameters variable.
    pub fn new(specification: &Specification, seed: impl Fn(ModelParameter) -> Option<S>) -> Self {
        let lifted = |parameter: ModelParameter| {
            seed(parameter).unwrap_or(S::constant(parameter.get(specification)))
        };
        let vehicle = &specification.vehicle;
        let effects = specification
            .effects
            .active(|parameter, _| seed(ModelParameter::Effect(parameter)));
        let [mass, yaw_inertia, radius, half_track, offset, height] =
            VehicleParameter::ALL.map(|number| lifted(ModelParameter::Vehicle(number)));
        let terrain = TerrainParameter::ALL.map(|number| lifted(ModelParameter::Terrain(number)));
        let soil = Soil::from_terrain(&terrain, S::constant(vehicle.wheel_width));
        let zero = S::constant(0.0);
        let one = S::constant(1.0);

        let shift = effects.com_shift.map_or([zero; 2], |s| [s.ahead, s.left]);
        let mut body = Body {
            mass,
            yaw_inertia,
            height,
            com: shift,
        };
        if let Some(load) = &effects.payload {
            let place = [load.ahead - offset, load.left];
            body = body.with_point(load.mass, place, load.height);
        }
        let count = vehicle.wheel_count();
        let place = |index: usize| {
            let row = S::constant(vehicle.row_positions[index / 2]);
            let left = index.is_multiple_of(2);
            [row - offset, if left { half_track } else { -half_track }]
        };
        let wheels = (0..count).map(|index| {
            let left = index.is_multiple_of(2);
            let factor = effects
                .wheel_radius
                .map_or(one, |w| if left { w.left } else { w.right });
            let soil = effects
                .left_right_soil
                .map_or(soil, |effect| effect.soil(&soil, left));
            let tyre = effects.tyre_compliance;
            let flat = tyre.map(|tyre| tyre.flat_sinkage(&soil));
            let soil = tyre.map_or(soil, |tyre| tyre.sheared(soil));
            let share = 1.0 / count as f64;
            ChassisWheel {
                place: place(index),
                law: WheelLaw {
                    flat,
                    rebound: effects.elastic_rebound.map_or(zero, |e| e.share),
                    modulus_ratio: effects.shear_anisotropy.map_or(one, |e| e.modulus_ratio),
                    strength_ratio: effects.shear_anisotropy.map_or(one, |e| e.strength_ratio),
                    viscosity: effects.rate_dependent_soil.map_or([zero; 2], |e| {
                        [e.forward.scale(share), e.lateral.scale(share)]
                    }),
                    peak: effects.stress_peak,
                    slip_sinkage: effects.slip_sinkage,
                    bulldozing: effects.bulldozing,
                    multipass: effects.multipass,
                    transient: effects
                        .transient_shear
                        .is_some_and(|e| e.relaxation.value() > 0.0),
                    ..WheelLaw::paper(soil, radius * factor, vehicle.wheel_width)
                },
            }
        });
        let wheels: Vec<_> = wheels.collect();
        let arms: Vec<_> = wheels.iter().map(|wheel| wheel.arm(body.com)).collect();
        Self {
            mass: body.mass,
            yaw_inertia: body.yaw_inertia,
            com_height: body.height,
            com: body.com,
            centroid: -offset,
            wheels,
            effects,
            boundary: specification.effects.boundary,
            plane: LoadPlane::new(&arms),
        }
    }

    /// Remembers what another chassis does, whether or not it is felt here.
    pub fn remembering_like(mut self, other: &Self) -> Self {
        self.effects.transient_shear = other.effects.transient_shear;
        self.effects.multipass = other.effects.multipass;
        self
    }

    /// The largest wheel's radius \[m\].
    pub fn reach(&self) -> f64 {
        let radii = self.wheels.iter().map(|wheel| wheel.law.radius.value());
        radii.fold(0.0, f64::max)
    }

    /// The wheels' places ahead and to the left of the reference point \[m\].
    pub fn places(&self) -> Vec<[f64; 2]> {
        let wheels = self.wheels.iter();
        wheels.map(|wheel| wheel.place.map(|x| x.value())).collect()
    }

    /// How one wheel moves (10).
    #[inline(always)]
    pub fn wheel_motion(&self, at: &Situation<S>, index: usize) -> WheelMotion<S> {
        let [ahead, left] = self.wheels[index].place;
        WheelMotion {
            forward: at.velocity[0] - at.yaw_rate * left,
            lateral: at.velocity[1] + at.yaw_rate * ahead,
            yaw_rate: at.yaw_rate,
            angular_speed: at.wheel_speeds[index % 2],
        }
    }

    /// A wheel's law where it stands.
    #[inline(always)]
    fn law(&self, at: &Situation<S>, index: usize) -> WheelLaw<S> {
        let wheel = &self.wheels[index];
        let mut law = wheel.law;
        if let Some(change) = &self.effects.terrain_change {
            let (sin, cos) = at.heading.sin_cos();
            let [ahead, left] = wheel.place;
            let place = [
                at.position[0] + ahead * cos - left * sin,
                at.position[1] + ahead * sin + left * cos,
            ];
            let share = change.share(self.boundary, at.time, at.distance, place);
            law.soil = change.soil(&law.soil, share);
            let tyre = self.effects.tyre_compliance.as_ref();
            law.flat = tyre.map(|tyre| tyre.flat_sinkage(&law.soil));
            law.soil = tyre.map_or(law.soil, |tyre| tyre.sheared(law.soil));
        }
        law
    }

    /// A wheel in its contact: its entry angle if it were rigid \[rad\], and what it remembers.
    #[inline(always)]
    pub fn wheel(
        &self,
        at: &Situation<S>,
        index: usize,
        reach: S,
        memory: WheelMemory<S>,
    ) -> Wheel<S> {
        Wheel {
            motion: self.wheel_motion(at, index),
            reach,
            memory,
            law: self.law(at, index),
        }
    }

    /// What the loads have to balance.
    #[inline(always)]
    fn load_targets(&self, environment: &Environment<S>) -> LoadTargets<S> {
        LoadTargets {
            normal: self.mass * environment.gravity.normal,
            moments: environment.load_moments,
            leverage: self.mass * self.com_height,
        }
    }

    /// Writes each wheel's load where the ground exerts this specific force \[m/s^2\], and its derivatives by it;
    /// whether a wheel is lifted.
    pub fn distribute(
        &self,
        environment: &Environment<S>,
        specific: [S; 2],
        loads: &mut [[S; 3]],
    ) -> bool {
        let targets = self.load_targets(environment);
        self.plane.distribute(&targets, specific, loads)
    }

    /// One wheel's numbers in the order of [`WheelOutputs`]; the sinkage is counted from the untouched surface.
    pub fn outputs(
        &self,
        wheel: &Wheel<S>,
        regularisation: &Regularisation,
        load: S,
        forces: &WheelForces<S>,
    ) -> [S; WheelOutputs::COUNT] {
        let Wheel {
            motion,
            law,
            memory,
            reach,
        } = wheel;
        let omega = motion.angular_speed;
        let sign = if omega.value() < 0.0 { -1.0 } else { 1.0 };
        let rim = regularisation.bounded_angular_speed(omega).scale(sign) * law.radius;
        let arc = law.arc(*reach);
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

    /// Sums the forces of all wheels and of the surroundings: the numbers of the whole vehicle in the order of
    /// [`Wrench`]'s fields. The acceleration is that of the reference point.
    pub fn totals(
        &self,
        environment: &Environment<S>,
        at: &Situation<S>,
        forces: &[WheelForces<S>],
    ) -> [S; Wrench::TOTALS] {
        let zero = S::constant(0.0);
        let (mut force, mut resistance) = (environment.force, zero);
        let (mut turning, mut turning_resistance) = (zero, zero);
        let mut torque = [zero; 2];
        for (index, (wheel, ground)) in self.wheels.iter().zip(forces).enumerate() {
            let [ahead, left] = wheel.arm(self.com);
            let along = ground.thrust - ground.compaction;
            force[0] += along;
            force[1] += ground.lateral;
            resistance += ground.rolling_resistance;
            turning += -(left * along + ground.width_moment);
            turning_resistance += -(ahead * ground.lateral + ground.arc_moment);
            torque[index % 2] += ground.torque;
        }
        let yaw_acceleration =
            (turning - turning_resistance + environment.yaw_moment) / self.yaw_inertia;
        let [ahead, left] = self.com;
        let spin = at.yaw_rate * at.yaw_rate;
        let [along, across] = environment.gravity.along;
        [
            force[0] / self.mass + along + yaw_acceleration * left + spin * ahead,
            force[1] / self.mass + across - yaw_acceleration * ahead + spin * left,
            yaw_acceleration,
            resistance,
            turning_resistance,
            turning,
            torque[0],
            torque[1],
            torque[0] * at.wheel_speeds[0] + torque[1] * at.wheel_speeds[1],
        ]
    }
}

impl<S: Scalar> Chassis<S> {
    /// Gravity, drag, drawbar and residual models; forces that change their sign fade below `fading` \[m/s\].
    pub fn environment(&self, at: &Situation<S>, effects: &Effects, fading: f64) -> Environment<S> {
        let zero = S::constant(0.0);
        let gravity = if let Some(mut grade) = self.effects.grade {
            if let Some(profile) = &effects.slope_profile {
                let [east, north] = profile.slopes(at.time, at.distance, at.position);
                grade.slope_east += east;
                grade.slope_north += north;
            }
            grade.gravity(at.heading, GRAVITY)
        } else {
            SlopeGravity {
                along: [zero; 2],
                normal: S::constant(GRAVITY),
            }
        };
        let mut environment = Environment {
            gravity,
            force: [zero; 2],
            yaw_moment: zero,
            load_moments: [zero; 2],
        };
        if let Some(drag) = &self.effects.drag {
            let com_velocity = [
                at.velocity[0] - at.yaw_rate * self.com[1],
                at.velocity[1] + at.yaw_rate * self.com[0],
            ];
            environment.force = drag.force(com_velocity);
        }
        if let Some(drawbar) = &self.effects.drawbar {
            let hitch = self.centroid - drawbar.hitch_behind;
            let velocity = [at.velocity[0], at.velocity[1] + at.yaw_rate * hitch];
            let pull = drawbar.pull(velocity, fading);
            let raised = drawbar.hitch_height - self.com_height;
            for (axis, pull) in pull.into_iter().enumerate() {
                environment.force[axis] += pull;
                environment.load_moments[axis] += raised * pull;
            }
            environment.yaw_moment += (hitch - self.com[0]) * pull[1] + self.com[1] * pull[0];
        }
        self.add_residuals(at, fading, &mut environment);
        environment
    }

    /// Residual models: forces and a moment at the centre of mass.
    fn add_residuals(&self, at: &Situation<S>, fading: f64, environment: &mut Environment<S>) {
        let effects = &self.effects;
        let (ahead, aside, around) = (
            &effects.residual_longitudinal,
            &effects.residual_lateral,
            &effects.residual_yaw,
        );
        if ahead.is_none() && aside.is_none() && around.is_none() {
            return;
        }
        let [left, right] = [&self.wheels[0], &self.wheels[1]];
        let unscaled = Unscaled {
            velocity: at.velocity,
            yaw_rate: at.yaw_rate,
            rims: [
                left.law.radius * at.wheel_speeds[0],
                right.law.radius * at.wheel_speeds[1],
            ],
            half_track: (left.place[1] - right.place[1]).scale(0.5),
            heading: at.heading,
        };
        let motion = ResidualMotion::new(&unscaled, GRAVITY, fading);
        let weight = self.mass.scale(GRAVITY);
        if let Some(law) = ahead {
            environment.force[0] += weight * law.share(&motion);
        }
        if let Some(law) = aside {
            environment.force[1] += weight * law.share(&motion);
        }
        if let Some(law) = around {
            environment.yaw_moment += weight * unscaled.half_track * law.share(&motion);
        }
    }
}

impl<S: Scalar> ChassisWheel<S> {
    /// Place ahead and to the left of the centre of mass.
    #[inline(always)]
    fn arm(&self, com: [S; 2]) -> [S; 2] {
        [self.place[0] - com[0], self.place[1] - com[1]]
    }
}

/// A rigid body: mass, yaw inertia about its centre of mass, and where that lies.
struct Body<S> {
    mass: S,
    yaw_inertia: S,
    height: S,
    com: [S; 2],
}

impl<S: Scalar> Body<S> {
    /// With a point mass added, by the parallel-axis rule.
    fn with_point(self, mass: S, place: [S; 2], height: S) -> Self {
        let total = self.mass + mass;
        let middle = |a: S, b: S| (self.mass * a + mass * b) / total;
        let apart = [place[0] - self.com[0], place[1] - self.com[1]];
        let reduced = self.mass * mass / total;
        Self {
            mass: total,
            yaw_inertia: self.yaw_inertia + reduced * (apart[0] * apart[0] + apart[1] * apart[1]),
            height: middle(self.height, height),
            com: [middle(self.com[0], place[0]), middle(self.com[1], place[1])],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_payload_moves_the_centre_of_mass_by_the_parallel_axis_rule() {
        // 100 kg on the vehicle's 400 kg, 1 m ahead: centre at 0.2 m; inertia 50 + 80 x 1.
        let body = Body {
            mass: 400.0,
            yaw_inertia: 50.0,
            height: 0.5,
            com: [0.0, 0.0],
        };
        let loaded = body.with_point(100.0, [1.0, 0.0], 1.0);
        assert!((loaded.com[0] - 0.2).abs() < 1e-15);
        assert!((loaded.yaw_inertia - 130.0).abs() < 1e-12);
        assert!((loaded.height - 0.6).abs() < 1e-15);
    }
}
