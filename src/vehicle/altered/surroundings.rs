//! Where and how a vehicle stands, and what acts on it besides the ground's stresses.

use super::loads::LoadTargets;
use super::{Chassis, MemoryLayout, Situation, Tracks};
use crate::contact::{WheelLaw, WheelMotion};
use crate::effects::{Boundary, Effects, ResidualMotion, SlopeGravity, Unscaled};
use crate::scalar::Scalar;
use crate::vehicle::{GRAVITY, Motion};

/// What effects depend on besides the motion; the paper's model on none of it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Surroundings<'a> {
    /// Position, east and north \[m\].
    pub position: [f64; 2],
    /// Heading psi \[rad\].
    pub heading: f64,
    /// Time \[s\].
    pub time: f64,
    /// What the vehicle and its ground remember; empty for nothing yet.
    pub memory: &'a [f64],
    /// The tracks that the wheels left.
    pub tracks: Tracks<'a>,
}

/// What acts on the vehicle besides the stresses under its wheels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Environment<S> {
    /// Gravity on the slope.
    pub gravity: SlopeGravity<S>,
    /// Force of drag, drawbar and residual models along X and Y \[N\].
    pub force: [S; 2],
    /// Their yaw moment about the centre of mass \[N m\].
    pub yaw_moment: S,
    /// What they add to the sums of X F_Z and Y F_Z \[N m\].
    pub load_moments: [S; 2],
}

impl<S: Scalar> Situation<S> {
    pub fn new(motion: &Motion, surroundings: &Surroundings, layout: &MemoryLayout) -> Self {
        let c = S::constant;
        Self {
            velocity: [c(motion.v_x), c(motion.v_y)],
            yaw_rate: c(motion.yaw_rate),
            wheel_speeds: [c(motion.omega_left), c(motion.omega_right)],
            position: surroundings.position.map(c),
            heading: c(surroundings.heading),
            time: c(surroundings.time),
            distance: c(layout.distance(surroundings.memory)),
        }
    }
}

impl<S: Scalar> Chassis<S> {
    /// How a wheel moves (10).
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
    pub fn law(&self, at: &Situation<S>, boundary: Boundary, index: usize) -> WheelLaw<S> {
        let wheel = &self.wheels[index];
        let mut law = wheel.law;
        if let Some(change) = &self.effects.terrain_change {
            let (sin, cos) = crate::scalar::Elementary::sin_cos(at.heading);
            let [ahead, left] = wheel.place;
            let place = [
                at.position[0] + ahead * cos - left * sin,
                at.position[1] + ahead * sin + left * cos,
            ];
            let share = change.share(boundary, at.time, at.distance, place);
            law.soil = change.soil(&law.soil, share);
            let tyre = self.effects.tyre_compliance.as_ref();
            law.flat = tyre.map(|tyre| tyre.flat_sinkage(&law.soil));
            law.soil = tyre.map_or(law.soil, |tyre| tyre.sheared(law.soil));
        }
        law
    }

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

    /// What the loads have to balance when the ground exerts the specific force s \[m/s^2\].
    #[inline(always)]
    pub fn load_targets(&self, environment: &Environment<S>, specific: [S; 2]) -> LoadTargets<S> {
        LoadTargets::new(
            self.mass * environment.gravity.normal,
            environment.load_moments,
            self.mass * self.com_height,
            specific,
        )
    }
}
