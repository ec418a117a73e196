//! The integrals over one contact patch whose compacting side is the +X side: (3) to (6), (4) in full, and (11) to
//! (18).
//!
//! The arc reaches from -theta_2 to theta_1 with the greatest stress at theta_m between; behind it
//! the stress is that of the front at the angle theta_1 - (theta + theta_2) (theta_1 - theta_m) /
//! (theta_m + theta_2), which is (5) for the paper's theta_2 = 0 and theta_m = theta_1 / 2.

use super::law::{WheelLaw, twice_arc_sine};
use super::quadrature::{MOST_ROWS, Quadrature};
use crate::effects::{Displacement, Soil};
use crate::scalar::{Elementary, Packed, Real, Scalar};
use fearless_simd::{Simd, f64x8, prelude::*};

/// Soil and shape as the integrand needs them.
pub(super) struct Patch<S> {
    soil: Soil<S>,
    /// k (2 R)^n: pressure where the halved cosine difference is 1 \[Pa\].
    pressure: S,
    /// Radius R of the contact's circle \[m\].
    pub circle: S,
    width: f64,
    /// Place of the greatest stress between exit (0) and entry (1).
    peak: S,
    rebound: S,
    /// (K_X / K_Y)^2.
    lateral_stretch: S,
    strength_ratio: S,
    /// Square of the slip speed below which the direction of the shear fades \[m^2/s^2\].
    slip_speed_squared: f64,
    rut: Option<RutLine<S>>,
}

/// Pressure in a rut: elastic up to a depth below its ground, as on untouched soil beyond.
struct RutLine<S> {
    ground: S,
    elastic: S,
    stiffness: S,
}

/// Motion of the wheel over the patch.
pub(super) struct PatchMotion<S> {
    /// V_X - Omega Y_i \[m/s\].
    pub forward: S,
    /// V_Y + Omega X_i \[m/s\].
    pub lateral: S,
    /// Omega \[rad/s\].
    pub yaw_rate: S,
    /// r omega \[m/s\].
    pub rim_speed: S,
    /// What (14) is made of: in the steady state the motion itself, \[m/s\]; where the displacement is a state that
    /// state, \[m\] for each radian.
    pub moved: Displacement<S>,
    /// -1/K times what turns `moved` into a displacement: the bounded contact time of a radian, 1 / abs(omega),
    /// or 1 where it is one already.
    pub rate: S,
    /// Square of a displacement in the units of `moved` that keeps its root's slope finite, far below any that matters.
    pub floor: f64,
    /// Square of the slip speed at which the shear fades \[m^2/s^2\].
    pub fading_squared: S,
    /// Slip speed that a stored displacement is worth where nothing slides \[m/s\].
    pub lean: f64,
}

/// Sums over the patch, per metre of radius and width (dA = r b dtheta d(y/b)).
#[derive(Debug, Clone, Copy)]
pub(super) struct PatchSums<S> {
    /// Shear along X, Y, Z.
    pub shear: [S; 3],
    /// Normal stress against X, and along Z.
    pub normal: [S; 2],
    /// y tau_X.
    pub width_moment: S,
    /// sin theta tau_Y.
    pub arc_moment: S,
    /// Shear along (cos theta, sin theta), the tangent of the rim.
    pub tangential: S,
}

/// Share of the entry angle below which a piece of the arc is left out: next to an end of the arc
/// its nodes would find no stress there but rounding.
const SHORTEST_PIECE: f64 = 1e-6;
/// Share of the entry angle within which no end of the arc is split off.
const NEAREST_TURN: f64 = 1e-4;
/// Share of the entry angle below which a split of the arc is held in derivatives.
const EARLIEST_MOVING_TURN: f64 = 5e-3;
/// A turn of the shear is sharp if it takes less than this share of the longer piece beside it.
const SHARP_TURN: f64 = 0.3;
/// Depth of a rut \[m\] far below any that matters: it keeps its stiffness finite.
const SHALLOWEST_RUT: f64 = 1e-9;
/// Depth \[m\] over which the ground of a rut is elastic below which its arc is that of untouched soil: the first row's.
const SHALLOWEST_ELASTIC: f64 = 1e-7;
/// Least slip speed in a patch over its change from the wheel's middle to its edge, from which on half the rows serve:
/// with two Gauss's rule errs by about (r + sqrt(r^2 + 1))^-4, 5e-5. Never three: where a wheel rolls without slip, rounding
/// alone would tell whether its middle row reverses.
const EVEN: f64 = 6.0;

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
    by_forward: P,
    /// What the rim's motion takes from j_X: r omega (sin theta_1 - sin theta).
    by_rim: P,
    /// V_jY, and its square with that of the fading slip speed.
    sideways: P,
    sideways_squared: P,
    /// j_Y in the units of `moved`; its square, stretched, with the floor that keeps the root smooth.
    aside: P,
    aside_squared: P,
}

/// The arc in the numbers that every node shares.
struct Arc<S> {
    exit: S,
    middle: S,
    entry: S,
    half_sine_squared: S,
    sin_entry: S,
    cos_entry: S,
    /// (theta_1 - theta_m) / (theta_m + theta_2).
    rear_slope: S,
}

/// The ends of the pieces into which an arc is split, in order.
#[derive(Clone, Copy)]
struct Ends<S> {
    at: [S; 7],
    count: usize,
}

impl<S: Scalar> Ends<S> {
    #[inline(always)]
    fn of(arc: &Arc<S>) -> Self {
        let mut at = [arc.entry; 7];
        (at[0], at[1]) = (arc.exit, arc.middle);
        Self { at, count: 3 }
    }

    /// Splits the arc there; an angle beyond it is left out.
    #[inline(always)]
    fn split(&mut self, angle: S) {
        let within =
            angle.value() > self.at[0].value() && angle.value() < self.at[self.count - 1].value();
        if !within {
            return;
        }
        let mut place = self.count;
        while self.at[place - 1].value() > angle.value() {
            self.at[place] = self.at[place - 1];
            place -= 1;
        }
        self.at[place] = angle;
        self.count += 1;
    }

    /// The longer of the pieces that meet at an angle.
    fn longest_beside(&self, angle: f64) -> f64 {
        let ends = self.at[..self.count].windows(2);
        ends.map(|pair| (pair[0].value(), pair[1].value()))
            .filter(|(from, to)| *from <= angle && angle <= *to)
            .fold(0.0, |longest, (from, to)| f64::max(longest, to - from))
    }
}

impl<S: Scalar> Patch<S> {
    /// With the soil after slip, the place of the greatest stress, and the depth to which the soil was pressed before.
    #[inline(always)]
    pub fn new(
        law: &WheelLaw<S>,
        circle: S,
        soil: Soil<S>,
        peak: S,
        pressed: S,
        slip_speed: f64,
    ) -> Self {
        let rut = law.multipass.map(|effect| {
            let deepest = pressed.rounded_abs(SHALLOWEST_RUT);
            let rut = effect.rut(deepest);
            let secant = deepest.powf(soil.exponent.offset(-1.0));
            RutLine {
                ground: rut.ground,
                elastic: rut.elastic,
                stiffness: effect.stiffness_ratio * soil.modulus * secant,
            }
        });
        Self {
            soil,
            pressure: soil.modulus * circle.scale(2.0).powf(soil.exponent),
            circle,
            width: law.width,
            peak,
            rebound: law.rebound,
            lateral_stretch: S::constant(1.0) / (law.modulus_ratio * law.modulus_ratio),
            strength_ratio: law.strength_ratio,
            slip_speed_squared: slip_speed * slip_speed,
            rut,
        }
    }

    /// Integrates the stresses over the patch with the entry angle `entry`; `TRANSIENT` where the shear displacement
    /// is a state.
    #[inline(always)]
    pub fn integrate<V: Simd, const TRANSIENT: bool>(
        &self,
        simd: V,
        rule: &Quadrature,
        motion: &PatchMotion<S>,
        entry: S,
    ) -> PatchSums<S> {
        let arc = self.arc(entry);
        let mut sums = PatchSums::new(S::constant(0.0).splat(simd));
        let mut room = [(0.0, 0.0); MOST_ROWS];
        let crossing = Crossing::new(self, motion, &arc);
        let width = crossing.width_nodes(rule, &mut room);
        let reversed = crossing.reversed_rows(width);
        let mut ends = Ends::of(&arc);
        if let Some([behind, ahead]) = self.rut_ends(&arc) {
            ends.split(behind);
            ends.split(ahead);
        }
        // First the rows whose slip velocity keeps its sign, then each of the others on its own split arc.
        // One loop, not two that share a closure: what is not inlined loses the vector registers.
        let mut task = (!reversed, ends, [&rule.rear, &rule.front]);
        let mut left = reversed & ((1 << width.len()) - 1);
        let mut straight = true;
        loop {
            let (rows, pieces, rules) = &task;
            for end in 1..pieces.count {
                let (start, end) = (pieces.at[end - 1], pieces.at[end]);
                if end.value() - start.value() <= SHORTEST_PIECE * entry.value() {
                    continue;
                }
                let ahead = start.value() >= arc.middle.value();
                let length = (end - start).splat(simd);
                let start = start.splat(simd);
                for nodes in rules[usize::from(ahead)] {
                    let angle = start + length.scale_lanes(f64x8::simd_from(simd, nodes.at));
                    let weight = length.scale_lanes(f64x8::simd_from(simd, nodes.weight));
                    let column = self.column(simd, motion, &arc, angle, ahead, weight);
                    if straight {
                        // Components of the normal stress (17).
                        sums.normal[0] += column.stress * column.sin;
                        sums.normal[1] += column.stress * column.cos;
                    }
                    self.accumulate::<V, TRANSIENT>(simd, &mut sums, motion, &column, width, *rows);
                }
            }
            if left == 0 {
                break;
            }
            let row = left.trailing_zeros() as usize;
            left &= left - 1;
            straight = false;
            let at = width[row].0;
            let turn = self.turn(motion, &arc, at);
            let mut split = ends;
            split.split(turn);
            split.split(-turn);
            let rules = if crossing.is_sharp(at, turn.value(), &split) {
                [&rule.sharp, &rule.sharp]
            } else {
                [&rule.rear, &rule.front]
            };
            task = (1 << row, split, rules);
        }
        sums.sum::<V>()
    }

    /// Prepares eight nodes of the arc, `ahead` of the greatest stress or behind it.
    #[inline(always)]
    fn column<V: Simd>(
        &self,
        simd: V,
        motion: &PatchMotion<S>,
        arc: &Arc<S>,
        angle: S::Packed<V>,
        ahead: bool,
        weight: S::Packed<V>,
    ) -> Column<S::Packed<V>> {
        let (half_sine, half_cosine) = angle.scale(0.5).sin_cos_small();
        let sine_squared = half_sine * half_sine;
        let sin = (half_sine * half_cosine).scale(2.0);
        let cos = sine_squared.scale(-2.0).offset(1.0);
        let entry_squared = arc.half_sine_squared.splat(simd);
        let rise = (entry_squared - sine_squared).scale(2.0);
        let travelled = arc.entry.splat(simd) - angle;
        // In front sigma is (3); behind it is that of the angle of the front that has the same stress.
        let half_rise = if ahead {
            entry_squared - sine_squared
        } else {
            let from_exit = angle - arc.exit.splat(simd);
            let alike = arc.entry.splat(simd) - from_exit * arc.rear_slope.splat(simd);
            let (sine, _) = alike.scale(0.5).sin_cos_small();
            entry_squared - sine * sine
        };
        let stress = self.stress(simd, half_rise);
        let strength = stress.mul_add(
            self.soil.friction.splat(simd),
            self.soil.cohesion.splat(simd),
        );
        let cos_entry = arc.cos_entry.splat(simd);
        let sin_entry = arc.sin_entry.splat(simd);
        let spin = (motion.yaw_rate * self.circle).splat(simd);
        let sideways = spin.mul_add(sin, motion.lateral.splat(simd));
        let moved = &motion.moved;
        let aside =
            moved.lateral.splat(simd) * travelled + (moved.yaw * self.circle).splat(simd) * rise;
        let aside_squared = aside * aside * self.lateral_stretch.splat(simd);
        let aside_squared = aside_squared.offset(motion.floor);
        Column {
            sin,
            cos,
            stress: stress * weight,
            strength: strength * weight,
            rise,
            mean_cos: (cos + cos_entry).scale(0.5),
            by_forward: (travelled + sin_entry * cos_entry - sin * cos).scale(0.5),
            by_rim: moved.rim.splat(simd) * (sin_entry - sin),
            sideways,
            sideways_squared: sideways.mul_add(sideways, motion.fading_squared.splat(simd)),
            aside,
            aside_squared,
        }
    }

    /// Normal stress at half the cosine difference from the entry \[Pa\]: (3), in a rut its elastic line first.
    #[inline(always)]
    fn stress<V: Simd>(&self, simd: V, half_rise: S::Packed<V>) -> S::Packed<V> {
        let Some(rut) = &self.rut else {
            return self.power(simd, half_rise) * self.pressure.splat(simd);
        };
        let depth = half_rise * self.circle.scale(2.0).splat(simd);
        let below = depth + rut.ground.splat(simd);
        let first = self.power(simd, below) * self.soil.modulus.splat(simd);
        let again = depth * rut.stiffness.splat(simd);
        let beyond = (depth - rut.elastic.splat(simd)).positive();
        again + (first - again) * beyond
    }

    /// The power n of a depth.
    #[inline(always)]
    fn power<V: Simd>(&self, simd: V, base: S::Packed<V>) -> S::Packed<V> {
        let exponent = self.soil.exponent;
        if exponent.is_constant() {
            base.power(exponent.value())
        } else {
            base.power_of(exponent.splat(simd))
        }
    }

    /// Adds the shear stress (16) of some rows (as bits), offset / b and weight, at eight nodes of the arc.
    #[inline(always)]
    fn accumulate<V: Simd, const TRANSIENT: bool>(
        &self,
        simd: V,
        sums: &mut PatchSums<S::Packed<V>>,
        motion: &PatchMotion<S>,
        column: &Column<S::Packed<V>>,
        width: &[(f64, f64)],
        rows: u64,
    ) {
        let rim = motion.rim_speed.splat(simd);
        let rate = motion.rate.splat(simd);
        let moved_rim = if TRANSIENT {
            motion.moved.rim.splat(simd)
        } else {
            rim
        };
        let zero = S::constant(0.0).splat(simd);
        let (mut along, mut across, mut twist) = (zero, zero, zero);
        for (index, (at, weight)) in width.iter().enumerate() {
            if rows & (1 << index) == 0 {
                continue;
            }
            let offset = at * self.width;
            let forward = (motion.forward - motion.yaw_rate.scale(offset)).splat(simd);
            let moved_forward = if TRANSIENT {
                (motion.moved.forward - motion.moved.yaw.scale(offset)).splat(simd)
            } else {
                forward
            };
            // The rim's tangential velocity (11), negated: the slip velocity (12) along (cos theta, sin theta).
            let mut tangential = forward.mul_sub(column.cos, rim);
            let mut sideways = column.sideways;
            let mut sideways_squared = column.sideways_squared;
            // Shear displacement (14), with sin 2a - sin 2b and cos 2a - cos 2b expanded.
            let x = moved_forward.mul_sub(column.by_forward, column.by_rim);
            let z = moved_forward.mul_sub(column.mean_cos, moved_rim) * column.rise;
            let path = z.mul_add(z, x.mul_add(x, column.aside_squared)).root();
            // -(1 - exp(-j / K)) of (6) with j of (15): the shear is opposite to the slip velocity.
            let mobilised = (path * rate).decay().offset(-1.0);
            if TRANSIENT {
                // Where nothing slides, the shear is opposite to the displacement.
                let saturated =
                    path.like(motion.lean) / (path + self.soil.shear_modulus.splat(simd));
                tangential += (x * column.cos + z * column.sin) * saturated;
                sideways += column.aside * saturated;
                sideways_squared = sideways * sideways + motion.fading_squared.splat(simd);
            }
            let speed_squared = tangential.mul_add(tangential, sideways_squared);
            let factor = (mobilised * speed_squared.inverse_sqrt()).scale(*weight);
            let thrust = factor * tangential;
            along += thrust;
            twist += thrust.scale(offset);
            across += if TRANSIENT { factor * sideways } else { factor };
        }
        let along = along * column.strength;
        let mut shear_y = across * column.strength * self.strength_ratio.splat(simd);
        if !TRANSIENT {
            shear_y = shear_y * column.sideways;
        }
        sums.tangential += along;
        sums.shear[0] = along.mul_add(column.cos, sums.shear[0]);
        sums.shear[1] += shear_y;
        sums.shear[2] = along.mul_add(column.sin, sums.shear[2]);
        let twist = twist * column.strength;
        sums.width_moment = twist.mul_add(column.cos, sums.width_moment);
        sums.arc_moment = shear_y.mul_add(column.sin, sums.arc_moment);
    }

    #[inline(always)]
    fn arc(&self, entry: S) -> Arc<S> {
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
    fn rut_ends(&self, arc: &Arc<S>) -> Option<[S; 2]> {
        let rut = self.rut.as_ref()?;
        if rut.elastic.value() < SHALLOWEST_ELASTIC {
            return None;
        }
        let below = (rut.elastic / self.circle).scale(0.5);
        let sine_squared = arc.half_sine_squared - below;
        let ahead = if sine_squared.value() > 0.0 {
            twice_arc_sine(sine_squared.sqrt())
        } else {
            arc.exit
        };
        let behind = arc.exit + (arc.entry - ahead) / arc.rear_slope;
        (ahead.value() > arc.middle.value()).then_some([behind, ahead])
    }

    /// The angle at which the slip velocity of a row changes its sign, ahead of the lowest point:
    /// cos(theta) = r omega / V_Xi.
    #[inline(always)]
    fn turn(&self, motion: &PatchMotion<S>, arc: &Arc<S>, at: f64) -> S {
        let forward = motion.forward - motion.yaw_rate.scale(at * self.width);
        let ratio = motion.rim_speed / forward;
        let entry = arc.entry.value();
        let turn = ratio.value().clamp(-1.0, 1.0).acos();
        // Nodes next to either end of the arc would find no stress there but rounding.
        let turn = turn.clamp(NEAREST_TURN * entry, (1.0 - NEAREST_TURN) * entry);
        // The integral does not depend on where the arc is split; next to theta = 0, where the
        // split moves infinitely fast, its derivative is left out.
        let moves = turn > EARLIEST_MOVING_TURN * entry && turn < (1.0 - NEAREST_TURN) * entry;
        let slope = if moves { -1.0 / turn.sin() } else { 0.0 };
        S::chain(turn, &[slope], &[ratio])
    }
}

impl<P: Copy> PatchSums<P> {
    /// Nothing summed yet.
    #[inline(always)]
    fn new(zero: P) -> Self {
        Self {
            shear: [zero; 3],
            normal: [zero; 2],
            width_moment: zero,
            arc_moment: zero,
            tangential: zero,
        }
    }

    /// The sums of eight lanes each.
    #[inline(always)]
    fn sum<V: Simd>(self) -> PatchSums<<P as Packed<V>>::Lane>
    where
        P: Packed<V>,
    {
        PatchSums {
            // Not `array::map`: a closure that is not inlined loses the vector registers.
            shear: [
                self.shear[0].sum(),
                self.shear[1].sum(),
                self.shear[2].sum(),
            ],
            normal: [self.normal[0].sum(), self.normal[1].sum()],
            width_moment: self.width_moment.sum(),
            arc_moment: self.arc_moment.sum(),
            tangential: self.tangential.sum(),
        }
    }
}

/// Where the slip velocity changes its sign over the patch: the motion without derivatives.
#[derive(Clone, Copy)]
struct Crossing {
    /// Velocities along X and Y, yaw rate, and r omega.
    forward: f64,
    lateral: f64,
    yaw_rate: f64,
    rim_speed: f64,
    /// Sine and cosine of the entry angle.
    sin_entry: f64,
    cos_entry: f64,
    /// Radius of the contact's circle and width \[m\].
    circle: f64,
    width: f64,
    slip_speed_squared: f64,
}

impl Crossing {
    #[inline(always)]
    fn new<S: Scalar>(patch: &Patch<S>, motion: &PatchMotion<S>, arc: &Arc<S>) -> Self {
        Self {
            forward: motion.forward.value(),
            lateral: motion.lateral.value(),
            yaw_rate: motion.yaw_rate.value(),
            rim_speed: motion.rim_speed.value(),
            sin_entry: arc.sin_entry.value(),
            cos_entry: arc.cos_entry.value(),
            circle: patch.circle.value(),
            width: patch.width,
            slip_speed_squared: patch.slip_speed_squared,
        }
    }

    /// Velocity along X at an offset across the width.
    #[inline(always)]
    fn forward_at(&self, at: f64) -> f64 {
        self.forward - self.yaw_rate * at * self.width
    }

    /// The nodes across the width: the fewer, the less the slip velocity changes across it. Where the tangential one
    /// V_Xi cos theta - r omega has both signs in the patch, the shear varies faster and a finer rule serves;
    /// where it turns round abruptly besides, the width is split along the line of no slip.
    #[inline(always)]
    fn width_nodes<'r>(
        &self,
        rule: &'r Quadrature,
        room: &'r mut [(f64, f64); MOST_ROWS],
    ) -> &'r [(f64, f64)] {
        let (rim, cos_entry) = (self.rim_speed, self.cos_entry);
        let slip = |at: f64, cos: f64| self.forward_at(at) * cos - rim;
        let corners = [
            slip(-0.5, 1.0),
            slip(0.5, 1.0),
            slip(-0.5, cos_entry),
            slip(0.5, cos_entry),
        ];
        let lowest = corners.into_iter().fold(f64::INFINITY, f64::min);
        let highest = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let along = lowest.max(-highest).max(0.0);
        let sideways = self.least_sideways();
        // Half the change of V_Xi from one edge to the other.
        let twist = 0.5 * (self.yaw_rate * self.width).abs();
        let least = (along * along + sideways * sideways).sqrt();
        if least > EVEN * twist {
            return &rule.even;
        }
        if along > 0.0 {
            return &rule.uneven;
        }
        if sideways > twist {
            return &rule.reversed;
        }
        // Where the line crosses the arc at a third of it, from theta = 0.
        let line =
            (self.forward - rim / (1.0 - (1.0 - cos_entry) / 9.0)) / (self.yaw_rate * self.width);
        let line = line.clamp(-0.5, 0.5);
        let mut count = 0;
        for edge in [-0.5, 0.5] {
            for &(at, weight) in &rule.split {
                room[count] = (line + (edge - line) * at, weight * (edge - line).abs());
                count += 1;
            }
        }
        &room[..count]
    }

    /// The lateral slip speed at an angle with this sine.
    #[inline(always)]
    fn sideways_at(&self, sin: f64) -> f64 {
        self.lateral + self.yaw_rate * self.circle * sin
    }

    /// The least lateral slip speed in the patch, with the speed at which the shear fades.
    #[inline(always)]
    fn least_sideways(&self) -> f64 {
        let (lowest, highest) = (self.lateral, self.sideways_at(self.sin_entry));
        let least = if lowest * highest < 0.0 {
            0.0
        } else {
            lowest.abs().min(highest.abs())
        };
        (least * least + self.slip_speed_squared).sqrt()
    }

    /// The rows (as bits) in which the tangential slip velocity changes its sign.
    #[inline(always)]
    fn reversed_rows(&self, width: &[(f64, f64)]) -> u64 {
        let mut bits = 0;
        for (index, &(at, _)) in width.iter().enumerate() {
            let forward = self.forward_at(at);
            let rim = self.rim_speed;
            let reversed = (forward - rim) * (forward * self.cos_entry - rim) < 0.0;
            bits |= u64::from(reversed) << index;
        }
        bits
    }

    /// Whether the shear of a row turns round within a small part of the pieces that meet at its turn.
    #[inline(always)]
    fn is_sharp<S: Scalar>(&self, at: f64, turn: f64, ends: &Ends<S>) -> bool {
        let sine = turn.sin();
        let sideways = self.sideways_at(sine);
        let speed = (sideways * sideways + self.slip_speed_squared).sqrt();
        speed < SHARP_TURN * ends.longest_beside(turn) * sine * self.forward_at(at).abs()
    }
}
