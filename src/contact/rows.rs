//! The rows of a contact patch: lines along the rolling direction, at nodes across the width.

use super::patch::{Arc, PatchLaw, PatchMotion};
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

impl PatchLaw {
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
    pub(super) fn width_nodes<'r, S: Scalar>(
        &self,
        rule: &'r Quadrature,
        motion: &PatchMotion<S>,
        arc: &Arc<S>,
        room: &'r mut [(f64, f64); MOST_ROWS],
    ) -> &'r [(f64, f64)] {
        let (forward, rim) = (motion.forward.value(), motion.rim_speed.value());
        let cos_entry = arc.cos_entry.value();
        // Change of V_Xi from the right edge to the left one.
        let twist = motion.yaw_rate.value() * self.width;
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
        let sideways = self.least_sideways(motion, arc);
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
    fn least_sideways<S: Scalar>(&self, motion: &PatchMotion<S>, arc: &Arc<S>) -> f64 {
        let lowest = motion.lateral.value();
        let highest = lowest + motion.yaw_rate.value() * self.radius * arc.sin_entry.value();
        let least = if lowest * highest < 0.0 {
            0.0
        } else {
            lowest.abs().min(highest.abs())
        };
        (least * least + self.slip_speed_squared).sqrt()
    }

    /// The rows (as bits) in which the tangential slip velocity changes its sign.
    #[inline(always)]
    pub(super) fn reversed_rows<S: Scalar>(
        &self,
        width: &[(f64, f64)],
        motion: &PatchMotion<S>,
        arc: &Arc<S>,
    ) -> u64 {
        let rim = motion.rim_speed.value();
        let cos_entry = arc.cos_entry.value();
        let mut bits = 0;
        for (index, &(at, _)) in width.iter().enumerate() {
            let forward = motion.forward.value() - motion.yaw_rate.value() * at * self.width;
            let reversed = (forward - rim) * (forward * cos_entry - rim) < 0.0;
            bits |= u64::from(reversed) << index;
        }
        bits
    }
}
