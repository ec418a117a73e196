//! Where and how a vehicle moves, generic over the scalar.

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
}
