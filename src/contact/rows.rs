//! The rows of a contact patch: lines along the rolling direction, at nodes across the width.

use super::patch::PatchMotion;
use super::quadrature::{MOST_ROWS, Quadrature};
use crate::scalar::Scalar;

/// One line of the patch along the rolling direction.
#[derive(Clone, Copy)]
pub(super) struct Row<S> {
    /// Offset from the wheel's middle plane \[m\].
    pub offset: f64,
    /// Weight across the width.
    pub weight: f64,
    /// V_Xi of this row.
    pub forward: S,
}

/// What the choice of the rows depends on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Footprint {
    /// Radius of the contact's circle \[m\].
    pub radius: f64,
    /// Wheel width b \[m\].
    pub width: f64,
    /// Square of the slip speed below which the direction of the shear fades \[m^2/s^2\].
    pub slip_speed_squared: f64,
}

/// Where the slip velocity changes its sign over the patch: the motion without derivatives.
#[derive(Clone, Copy)]
pub(super) struct Crossing {
    /// Velocities along X and Y, yaw rate, and r omega.
    pub forward: f64,
    pub lateral: f64,
    pub yaw_rate: f64,
    pub rim_speed: f64,
    /// Sine and cosine of the entry angle.
    pub sin_entry: f64,
    pub cos_entry: f64,
}

impl Crossing {
    /// Of V_X, V_Y, Omega, the rim speed, and sine and cosine of the entry angle.
    #[inline(always)]
    pub(super) fn new<S: Scalar>(travel: [S; 3], rim_speed: S, entry: [S; 2]) -> Self {
        let [forward, lateral, yaw_rate] = travel.map(S::value);
        let [sin_entry, cos_entry] = entry.map(S::value);
        Self {
            forward,
            lateral,
            yaw_rate,
            rim_speed: rim_speed.value(),
            sin_entry,
            cos_entry,
        }
    }
}

impl Footprint {
    #[inline(always)]
    pub(super) fn rows<S: Scalar>(
        &self,
        width: &[(f64, f64)],
        motion: &PatchMotion<S>,
    ) -> impl Iterator<Item = Row<S>> {
        width.iter().map(|&(at, weight)| Row {
            offset: at * self.width,
            weight,
            forward: motion.forward - motion.yaw_rate.scale(at * self.width),
        })
    }

    /// The nodes across the width. Where the tangential slip velocity V_Xi cos theta - r omega
    /// has both signs in the patch, the shear varies faster across it and a finer rule serves;
    /// where it turns round abruptly besides, the width is split along the line of no slip.
    #[inline(always)]
    pub(super) fn width_nodes<'r>(
        &self,
        rule: &'r Quadrature,
        motion: &Crossing,
        room: &'r mut [(f64, f64); MOST_ROWS],
    ) -> &'r [(f64, f64)] {
        let (forward, rim) = (motion.forward, motion.rim_speed);
        let cos_entry = motion.cos_entry;
        // Change of V_Xi from the right edge to the left one.
        let twist = motion.yaw_rate * self.width;
        let ahead = |at: f64, cos: f64| (forward - twist * at) * cos > rim;
        let first = ahead(-0.5, 1.0);
        if [
            ahead(0.5, 1.0),
            ahead(-0.5, cos_entry),
            ahead(0.5, cos_entry),
        ] == [first; 3]
        {
            return &rule.width;
        }
        let sideways = self.least_sideways(motion);
        if sideways > 0.5 * twist.abs() {
            return &rule.width_reversed;
        }
        // Where the line crosses the arc at a third of it, from theta = 0.
        let line = (forward - rim / (1.0 - (1.0 - cos_entry) / 9.0)) / twist;
        let line = line.clamp(-0.5, 0.5);
        let mut count = 0;
        for edge in [-0.5, 0.5] {
            for &(at, weight) in &rule.width_split {
                room[count] = (line + (edge - line) * at, weight * (edge - line).abs());
                count += 1;
            }
        }
        &room[..count]
    }

    /// The least lateral slip speed in the patch, with the speed at which the shear fades.
    #[inline(always)]
    fn least_sideways(&self, motion: &Crossing) -> f64 {
        let lowest = motion.lateral;
        let highest = lowest + motion.yaw_rate * self.radius * motion.sin_entry;
        let least = if lowest * highest < 0.0 {
            0.0
        } else {
            lowest.abs().min(highest.abs())
        };
        (least * least + self.slip_speed_squared).sqrt()
    }

    /// The rows (as bits) in which the tangential slip velocity changes its sign.
    #[inline(always)]
    pub(super) fn reversed_rows(&self, width: &[(f64, f64)], motion: &Crossing) -> u64 {
        let (rim, cos_entry) = (motion.rim_speed, motion.cos_entry);
        let mut bits = 0;
        for (index, &(at, _)) in width.iter().enumerate() {
            let forward = motion.forward - motion.yaw_rate * at * self.width;
            let reversed = (forward - rim) * (forward * cos_entry - rim) < 0.0;
            bits |= u64::from(reversed) << index;
        }
        bits
    }
}
