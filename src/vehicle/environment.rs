//! Where and how a vehicle stands and moves, and what acts on it besides the ground's stresses.

use super::memory::MemoryLayout;
use super::{Chassis, GRAVITY, Motion, Tracks};
use crate::effects::{Effects, ResidualMotion, SlopeGravity, Unscaled};
use crate::scalar::Scalar;

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

/// Motion and surroundings, generic over the scalar.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Situation<S> {
    pub velocity: [S; 2],
    pub yaw_rate: S,
    pub wheel_speeds: [S; 2],
    pub position: [S; 2],
    pub heading: S,
    pub time: S,
    pub distance: S,
}

/// Where a vehicle is and how it moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pose<S> {
    pub place: [S; 3],
    pub velocity: [S; 2],
    pub yaw_rate: S,
}

impl<S: Copy> Situation<S> {
    /// Where the vehicle is and how it moves.
    pub(super) fn pose(&self) -> Pose<S> {
        Pose {
            place: [self.position[0], self.position[1], self.heading],
            velocity: self.velocity,
            yaw_rate: self.yaw_rate,
        }
    }

    /// The same with every number replaced.
    pub fn map<T>(&self, mut f: impl FnMut(S) -> T) -> Situation<T> {
        Situation {
            velocity: self.velocity.map(&mut f),
            yaw_rate: f(self.yaw_rate),
            wheel_speeds: self.wheel_speeds.map(&mut f),
            position: self.position.map(&mut f),
            heading: f(self.heading),
            time: f(self.time),
            distance: f(self.distance),
        }
    }
}

impl Situation<f64> {
    pub fn new(motion: &Motion, surroundings: &Surroundings, layout: &MemoryLayout) -> Self {
        Self {
            velocity: [motion.v_x, motion.v_y],
            yaw_rate: motion.yaw_rate,
            wheel_speeds: [motion.omega_left, motion.omega_right],
            position: surroundings.position,
            heading: surroundings.heading,
            time: surroundings.time,
            distance: layout.distance(surroundings.memory),
        }
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
