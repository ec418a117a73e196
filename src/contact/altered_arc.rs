//! Where a contact arc that effects alter begins and ends, and where it has to be split.

use super::altered_patch::{AlteredMotion, AlteredPatch};
use super::patch::NEAREST_TURN;
use crate::scalar::{Elementary, Scalar};

/// Share of the entry angle below which a split of the arc is held in derivatives.
const EARLIEST_MOVING_TURN: f64 = 5e-3;
/// Depth \[m\] over which the ground of a rut is elastic below which its arc is that of untouched soil: the first row's.
const SHALLOWEST: f64 = 1e-7;

/// The arc in the numbers that every node shares.
pub(super) struct Arc<S> {
    pub exit: S,
    pub middle: S,
    pub entry: S,
    pub half_sine_squared: S,
    pub sin_entry: S,
    pub cos_entry: S,
    /// (theta_1 - theta_m) / (theta_m + theta_2).
    pub rear_slope: S,
}

impl<S: Scalar> AlteredPatch<S> {
    #[inline(always)]
    pub(super) fn arc(&self, entry: S) -> Arc<S> {
        let (half_sine, half_cosine) = entry.scale(0.5).sin_cos_small();
        let exit = -(self.rebound * entry);
        // Not behind the lowest point: there the soil that springs back would push harder than what it took to compact it.
        let lowest = self.rebound / self.rebound.offset(1.0);
        let middle = exit + (entry - exit) * self.peak.max(lowest);
        Arc {
            exit,
            middle,
            entry,
            half_sine_squared: half_sine * half_sine,
            sin_entry: (half_sine * half_cosine).scale(2.0),
            cos_entry: (half_sine * half_sine).scale(-2.0).offset(1.0),
            rear_slope: (entry - middle) / (middle - exit),
        }
    }

    /// Where, behind and ahead of the greatest stress, a wheel in a rut reaches the depth beyond
    /// which its ground is no longer elastic; `None` where it does not.
    #[inline(always)]
    pub(super) fn rut_ends(&self, arc: &Arc<S>) -> Option<[S; 2]> {
        let rut = self.rut.as_ref()?;
        if rut.elastic.value() < SHALLOWEST {
            return None;
        }
        let below = (rut.elastic / self.circle).scale(0.5);
        let sine_squared = arc.half_sine_squared - below;
        let ahead = if sine_squared.value() > 0.0 {
            // The half angle by its sine, with the derivative of the arc sine.
            let sine = sine_squared.sqrt();
            let (value, slope) = (sine.value(), 2.0 / (1.0 - sine.value().powi(2)).sqrt());
            S::chain(2.0 * value.asin(), &[slope], &[sine])
        } else {
            arc.exit
        };
        let behind = arc.exit + (arc.entry - ahead) / arc.rear_slope;
        if ahead.value() > arc.middle.value() {
            Some([behind, ahead])
        } else {
            Some([arc.middle, arc.middle])
        }
    }

    /// The ends of the pieces into which an arc is split, in order: at the greatest stress, at the
    /// rut's ends and at the turns of the slip velocity. Those beyond the arc are to be left out.
    #[inline(always)]
    pub(super) fn ends(&self, arc: &Arc<S>, rut: Option<[S; 2]>, behind: S, ahead: S) -> [S; 7] {
        let [rut_behind, rut_ahead] = rut.unwrap_or([arc.exit; 2]);
        let mut ends = [
            arc.exit, behind, rut_behind, arc.middle, rut_ahead, ahead, arc.entry,
        ];
        for end in 1..ends.len() {
            let mut place = end;
            while place > 0 && ends[place - 1].value() > ends[place].value() {
                ends.swap(place - 1, place);
                place -= 1;
            }
        }
        ends
    }

    /// The angle at which the slip velocity of a row changes its sign, ahead of the lowest point:
    /// cos(theta) = r omega / V_Xi.
    #[inline(always)]
    pub(super) fn turn(&self, motion: &AlteredMotion<S>, arc: &Arc<S>, at: f64) -> S {
        let forward = motion.forward - motion.yaw_rate.scale(at * self.footprint.width);
        let ratio = motion.rim_speed / forward;
        let entry = arc.entry.value();
        let turn = ratio.value().clamp(-1.0, 1.0).acos();
        let turn = turn.clamp(NEAREST_TURN * entry, (1.0 - NEAREST_TURN) * entry);
        let moves = turn > EARLIEST_MOVING_TURN * entry && turn < (1.0 - NEAREST_TURN) * entry;
        let slope = if moves { -1.0 / turn.sin() } else { 0.0 };
        S::chain(turn, &[slope], &[ratio])
    }
}
