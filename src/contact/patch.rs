//! The integrals over one contact patch whose compacting side is the +X side.

use super::quadrature::{MOST_ROWS, Nodes, Quadrature};
use super::sums::PatchSums;
use crate::scalar::{Packed, Real, Scalar};
use fearless_simd::{Simd, f64x8, prelude::*};

/// Soil and wheel as the integrand needs them, computed once.
#[derive(Debug, Clone, Copy)]
pub(super) struct PatchLaw {
    /// Cohesion c \[Pa\].
    pub cohesion: f64,
    /// tan phi.
    pub friction: f64,
    /// 1 / K \[1/m\].
    pub inverse_shear_modulus: f64,
    /// Sinkage exponent n.
    pub exponent: f64,
    /// k (2 r)^n: pressure where the halved cosine difference is 1 \[Pa\].
    pub pressure: f64,
    /// Wheel radius and width, and the slip speed.
    pub footprint: Footprint,
}

/// Motion of the wheel over the patch.
#[derive(Debug, Clone, Copy)]
pub(super) struct PatchMotion<S> {
    /// V_X - Omega Y_i \[m/s\].
    pub forward: S,
    /// V_Y + Omega X_i \[m/s\].
    pub lateral: S,
    /// Omega \[rad/s\].
    pub yaw_rate: S,
    /// r omega \[m/s\].
    pub rim_speed: S,
    /// 1 / abs(omega), bounded \[s\]: contact time for each radian of the arc.
    pub time_per_angle: S,
}

/// What the rows of the patch share at eight nodes of the arc.
struct Column<P> {
    sin: P,
    cos: P,
    /// Normal stress sigma, weighted.
    stress: P,
    /// Shear strength c + sigma tan phi of (6), weighted.
    strength: P,
    /// cos theta - cos theta_1 of (2).
    rise: P,
    /// (cos theta + cos theta_1) / 2.
    mean_cos: P,
    /// ((theta_1 - theta) + (sin 2 theta_1 - sin 2 theta) / 2) / 2: j_X grows with V_Xi by it.
    stretch: P,
    /// r omega (sin theta_1 - sin theta).
    rolled: P,
    /// V_jY, and its square with the slip speed's.
    sideways: P,
    sideways_squared: P,
    /// j_Y^2 in units of the contact time, with the floor that keeps its root smooth.
    path_squared: P,
}

/// What the whole patch shares.
pub(super) struct Arc<S> {
    pub entry: S,
    /// sin(theta_1 / 2), its square, and cos(theta_1 / 2).
    pub half_sine: S,
    pub half_sine_squared: S,
    pub half_cosine: S,
    pub sin_entry: S,
    pub cos_entry: S,
}

impl PatchLaw {
    /// Integrates the stresses over the patch with the entry angle `entry`.
    #[inline(always)]
    pub(super) fn integrate<V: Simd, S: Scalar>(
        &self,
        simd: V,
        rule: &Quadrature,
        motion: &PatchMotion<S>,
        entry: S,
    ) -> PatchSums<S> {
        let (half_sine, half_cosine) = entry.scale(0.5).sin_cos_small();
        let arc = Arc {
            entry,
            half_sine,
            half_sine_squared: half_sine * half_sine,
            half_cosine,
            sin_entry: half_sine * half_cosine.scale(2.0),
            cos_entry: (half_sine * half_sine).scale(-2.0).offset(1.0),
        };
        let zero = S::constant(0.0).splat(simd);
        let mut sums = PatchSums::new(zero);
        let mut room = [(0.0, 0.0); MOST_ROWS];
        let rim = motion.rim_speed;
        let travel = [motion.forward, motion.lateral, motion.yaw_rate];
        let crossing = Crossing::new(travel, rim, [arc.sin_entry, arc.cos_entry]);
        let width = self.footprint.width_nodes(rule, &crossing, &mut room);
        let reversed = self.footprint.reversed_rows(width, &crossing);
        for nodes in &rule.arc {
            let (at, weight) = nodes.load(simd);
            let packed_entry = entry.splat(simd);
            let angle = packed_entry.scale_lanes(at);
            let weight = packed_entry.scale_lanes(weight);
            let front = f64x8::simd_from(simd, nodes.front);
            let column = self.column(simd, motion, &arc, angle, front, weight);
            // Components of the normal stress (17).
            sums.normal[0] += column.stress * column.sin;
            sums.normal[1] += column.stress * column.cos;
            let rows = self.footprint.rows(width, motion).enumerate();
            let straight = rows.filter(|(index, _)| reversed & (1 << index) == 0);
            self.accumulate(
                simd,
                &mut sums,
                motion,
                &column,
                straight.map(|(_, row)| row),
            );
        }
        if reversed != 0 {
            for (index, row) in self.footprint.rows(width, motion).enumerate() {
                if reversed & (1 << index) != 0 {
                    self.accumulate_reversed(simd, &mut sums, rule, motion, &arc, &row);
                }
            }
        }
        sums.sum::<V>()
    }

    /// Prepares eight nodes of the arc; `front` is 1 for those in the front half, else 0.
    #[inline(always)]
    fn column<V: Simd, S: Scalar>(
        &self,
        simd: V,
        motion: &PatchMotion<S>,
        arc: &Arc<S>,
        angle: S::Packed<V>,
        front: f64x8<V>,
        weight: S::Packed<V>,
    ) -> Column<S::Packed<V>> {
        let (half_sine, half_cosine) = angle.scale(0.5).sin_cos_small();
        let sine_squared = half_sine * half_sine;
        let sin = half_sine * half_cosine.scale(2.0);
        let cos = sine_squared.scale(-2.0).offset(1.0);
        let entry_squared = arc.half_sine_squared.splat(simd);
        let rise = (entry_squared - sine_squared).scale(2.0);
        let travelled = arc.entry.splat(simd) - angle;
        // In front sigma is (3); behind it is (5), which is (4) for theta_2 = 0 and theta_m = theta_1 / 2, and
        // (3) at the angle theta_1 - theta.
        let mirrored =
            arc.half_sine.splat(simd) * half_cosine - arc.half_cosine.splat(simd) * half_sine;
        let from_middle = mirrored + (half_sine - mirrored).scale_lanes(front);
        let half_rise = entry_squared - from_middle * from_middle;
        let stress = half_rise.power(self.exponent).scale(self.pressure);
        let cos_entry = arc.cos_entry.splat(simd);
        let sin_entry = arc.sin_entry.splat(simd);
        let lateral = motion.lateral.splat(simd);
        let spin = motion.yaw_rate.scale(self.footprint.radius).splat(simd);
        let sideways = lateral + spin * sin;
        let path = lateral * travelled + spin * rise;
        Column {
            sin,
            cos,
            stress: stress * weight,
            strength: stress.scale(self.friction).offset(self.cohesion) * weight,
            rise,
            mean_cos: (cos + cos_entry).scale(0.5),
            stretch: (travelled + sin_entry * cos_entry - sin * cos).scale(0.5),
            rolled: motion.rim_speed.splat(simd) * (sin_entry - sin),
            sideways,
            sideways_squared: (sideways * sideways).offset(self.footprint.slip_speed_squared),
            path_squared: (path * path).offset(DISPLACEMENT_FLOOR),
        }
    }

    /// Adds the shear stress (16) of some rows at eight nodes of the arc.
    #[inline(always)]
    fn accumulate<V: Simd, S: Scalar>(
        &self,
        simd: V,
        sums: &mut PatchSums<S::Packed<V>>,
        motion: &PatchMotion<S>,
        column: &Column<S::Packed<V>>,
        rows: impl Iterator<Item = Row<S>>,
    ) {
        let rim = motion.rim_speed.splat(simd);
        let rate = motion
            .time_per_angle
            .scale(-self.inverse_shear_modulus)
            .splat(simd);
        let zero = S::constant(0.0).splat(simd);
        let (mut along, mut across, mut twist) = (zero, zero, zero);
        for row in rows {
            let forward = row.forward.splat(simd);
            // The rim's tangential velocity (11), negated: the slip velocity (12) along (cos theta, sin theta).
            let tangential = forward * column.cos - rim;
            // Shear displacement (14), with sin 2a - sin 2b and cos 2a - cos 2b expanded.
            let x = forward * column.stretch - column.rolled;
            let z = (forward * column.mean_cos - rim) * column.rise;
            let path_squared = x * x + z * z + column.path_squared;
            let path = path_squared * path_squared.inverse_sqrt();
            // -(1 - exp(-j / K)) of (6) with j of (15): the shear is opposite to the slip velocity.
            let mobilised = (path * rate).decay().offset(-1.0);
            let speed_squared = tangential * tangential + column.sideways_squared;
            let factor = (mobilised * speed_squared.inverse_sqrt()).scale(row.weight);
            along += factor * tangential;
            twist += (factor * tangential).scale(row.offset);
            across += factor;
        }
        let along = along * column.strength;
        let shear_y = across * column.strength * column.sideways;
        sums.tangential += along;
        sums.shear[0] += along * column.cos;
        sums.shear[1] += shear_y;
        sums.shear[2] += along * column.sin;
        sums.width_moment += twist * column.strength * column.cos;
        sums.arc_moment += shear_y * column.sin;
    }

    /// A row in which the slip velocity changes its sign: there the shear's direction (16)
    /// turns round within a short stretch, so the arc is split at that angle.
    #[inline(always)]
    fn accumulate_reversed<V: Simd, S: Scalar>(
        &self,
        simd: V,
        sums: &mut PatchSums<S::Packed<V>>,
        rule: &Quadrature,
        motion: &PatchMotion<S>,
        arc: &Arc<S>,
        row: &Row<S>,
    ) {
        let ratio = motion.rim_speed / row.forward;
        let turn = ratio.value().clamp(-1.0, 1.0).acos();
        // Nodes next to either end of the arc would find no stress there but rounding.
        let entry = arc.entry.value();
        let turn = turn.clamp(NEAREST_TURN * entry, (1.0 - NEAREST_TURN) * entry);
        let sine = turn.sin();
        // The integral does not depend on where the arc is split; next to theta = 0, where the
        // split moves infinitely fast, its derivative is left out.
        let moves = turn > EARLIEST_MOVING_TURN * entry && turn < (1.0 - NEAREST_TURN) * entry;
        let slope = if moves { -1.0 / sine } else { 0.0 };
        let turn = S::chain(turn, &[slope], &[ratio]);
        let middle = arc.entry.scale(0.5);
        let (first, second) = if turn.value() < middle.value() {
            (turn, middle)
        } else {
            (middle, turn)
        };
        let ends = [first.splat(simd), second.splat(simd), arc.entry.splat(simd)];
        let late = usize::from(turn.value() >= middle.value());
        // The shear turns round within this angle.
        let sideways =
            motion.lateral.value() + motion.yaw_rate.value() * self.footprint.radius * sine;
        let speed = (sideways * sideways + self.footprint.slip_speed_squared).sqrt();
        let part = second.value() - first.value();
        let longer = part.max(if late == 1 {
            arc.entry.value() - second.value()
        } else {
            first.value()
        });
        let sharp = speed < SHARP_TURN * longer * sine * row.forward.value().abs();
        let nodes = if sharp { &rule.sharp } else { &rule.turning };
        for nodes in &nodes[late] {
            let mix = |shares: &[[f64; 8]; 3]| {
                let share = |end: usize| f64x8::simd_from(simd, shares[end]);
                ends[0].scale_lanes(share(0))
                    + ends[1].scale_lanes(share(1))
                    + ends[2].scale_lanes(share(2))
            };
            let (angle, weight) = (mix(&nodes.at), mix(&nodes.weight));
            let front = f64x8::simd_from(simd, nodes.front);
            let column = self.column(simd, motion, arc, angle, front, weight);
            self.accumulate(simd, sums, motion, &column, std::iter::once(*row));
        }
    }
}

/// Share of the entry angle within which no end of the arc is split off.
pub(super) const NEAREST_TURN: f64 = 1e-4;
/// Share of the entry angle below which a split of the arc is held in derivatives.
const EARLIEST_MOVING_TURN: f64 = 5e-3;
/// A turn of the shear is sharp if it takes less than this share of the longer part beside it.
const SHARP_TURN: f64 = 0.3;
/// Square of a slip distance per time [m^2/s^2] far below any that matters: it keeps the
/// displacement's derivative finite where nothing moves.
const DISPLACEMENT_FLOOR: f64 = 1e-20;

impl Nodes {
    #[inline(always)]
    fn load<V: Simd>(&self, simd: V) -> (f64x8<V>, f64x8<V>) {
        (
            f64x8::simd_from(simd, self.at),
            f64x8::simd_from(simd, self.weight),
        )
    }
}

/// The part of the vertical force that the normal stress carries at small entry angles:
/// F_Z / theta_1^(2n+1), from sigma = k (r theta_1^2 / 2)^n (1 - u^2)^n and cos theta = 1.
pub(super) fn small_angle_support(law: &PatchLaw, rule: &Quadrature) -> f64 {
    let integral: f64 = rule
        .arc
        .iter()
        .flat_map(|nodes| nodes.at.into_iter().zip(nodes.weight))
        .map(|(u, weight)| weight * (1.0 - u.max(1.0 - u).powi(2)).powf(law.exponent))
        .sum();
    // Half the cosine difference is theta_1^2 (1 - u^2) / 4.
    law.pressure
        * 0.25_f64.powf(law.exponent)
        * integral
        * law.footprint.radius
        * law.footprint.width
}

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
