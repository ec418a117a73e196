//! What effects depend on besides the motion.

use super::situation::Situation;
use super::{Motion, Tracks};

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

impl Situation<f64> {
    /// After a distance driven \[m\], where effects depend on it.
    pub fn new(motion: &Motion, surroundings: &Surroundings, distance: f64) -> Self {
        Self {
            velocity: [motion.v_x, motion.v_y],
            yaw_rate: motion.yaw_rate,
            wheel_speeds: [motion.omega_left, motion.omega_right],
            position: surroundings.position,
            heading: surroundings.heading,
            time: surroundings.time,
            distance,
        }
    }
}
