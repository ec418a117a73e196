//! Where and how a vehicle stands and moves, and what acts on it besides the ground's stresses; generic over the scalar.

use crate::effects::SlopeGravity;

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
