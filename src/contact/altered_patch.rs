//! The integrals over a contact patch that effects alter.
//!
//! The arc reaches from -theta_2 to theta_1 with the greatest stress at theta_m between; behind it
//! the stress is that of the front at the angle theta_1 - (theta + theta_2) (theta_1 - theta_m) /
//! (theta_m + theta_2), which is (5) for theta_2 = 0 and theta_m = theta_1 / 2.

use super::altered_arc::Arc;
use super::quadrature::{MOST_ROWS, Quadrature};
use super::rows::{Crossing, Footprint};
use super::sums::PatchSums;
use super::{Regularisation, WheelLaw};
use crate::effects::{Bulldozing, Displacement, Soil};
use crate::scalar::{Elementary, Packed, Real, Scalar};
use fearless_simd::{Simd, f64x8, prelude::*};

/// Share of the entry angle below which a piece of the arc is left out: next to an end of the arc
/// its nodes would find no stress there but rounding.
const SHORTEST_PIECE: f64 = 1e-6;
/// Square of a displacement \[m^2\] far below any that matters: it keeps its root's slope finite.
const DISPLACEMENT_FLOOR: f64 = 1e-18;
/// Depth of a rut \[m\] far below any that matters: it keeps its stiffness finite.
const SHALLOWEST_RUT: f64 = 1e-9;
/// The slip speed at which the shear of a held wheel fades, as a share of that of a rolling one.
/// The smaller, the sooner a held vehicle settles: at 0.02 within some tenths of a second.
const HELD_SLIP_SPEED: f64 = 0.02;

/// A law, prepared for the integrand.
pub(super) struct AlteredPatch<S> {
    soil: Soil<S>,
    pub footprint: Footprint,
    pub circle: S,
    /// Place of the greatest stress between exit (0) and entry (1).
    pub peak: S,
    pub rebound: S,
    inverse_modulus: S,
    /// (K_X / K_Y)^2.
    lateral_stretch: S,
    strength_ratio: S,
    /// Slip speed that the stored displacement is worth where nothing slides \[m/s\], 0 in the
    /// steady state.
    lean: f64,
    slip_speed_squared: f64,
    /// Square of the share of it at which the shear fades while the wheel is held.
    held_share_squared: f64,
    pub rut: Option<RutLine<S>>,
    bulldozing: Option<Bulldozing<S>>,
}

/// Pressure in a rut: elastic up to a depth below its ground, as on untouched soil beyond.
pub(super) struct RutLine<S> {
    ground: S,
    pub elastic: S,
    stiffness: S,
}

/// Motion of the wheel over the patch.
pub(super) struct AlteredMotion<S> {
    pub forward: S,
    pub lateral: S,
    pub yaw_rate: S,
    pub rim_speed: S,
    pub displacement: Displacement<S>,
    /// Square of the slip speed at which the shear fades.
    pub fading_squared: S,
}

/// Resistance of the soil beside and ahead of the wheel, for a motion straight against it.
pub(super) struct Wedge<S> {
    /// Lateral force \[N\].
    pub force: S,
    /// Its moment about the axle \[N m\].
    pub moment: S,
    /// Force against the front \[N\].
    pub frontal: S,
}

/// What the rows of the patch share at eight nodes of the arc.
struct Column<P> {
    sin: P,
    cos: P,
    stress: P,
    strength: P,
    rise: P,
    mean_cos: P,
    stretch: P,
    rolled: P,
    sideways: P,
    /// Lateral displacement j_Y.
    aside: P,
    /// Square of the slip speed at which the shear fades.
    fading_squared: P,
    weight: P,
}

impl<S: Scalar> AlteredPatch<S> {
    #[inline(always)]
    pub fn new(
        law: &WheelLaw<S>,
        circle: S,
        soil: Soil<S>,
        peak: S,
        pressed: S,
        regularisation: &Regularisation,
    ) -> Self {
        let slip_speed = regularisation.slip_speed;
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
        let held_share = if law.transient { HELD_SLIP_SPEED } else { 1.0 };
        let one = S::constant(1.0);
        Self {
            soil,
            footprint: Footprint {
                radius: circle.value(),
                width: law.width,
                slip_speed_squared: slip_speed * slip_speed,
            },
            circle,
            peak,
            rebound: law.rebound,
            inverse_modulus: one / soil.shear_modulus,
            lateral_stretch: one / (law.modulus_ratio * law.modulus_ratio),
            strength_ratio: law.strength_ratio,
            lean: if law.transient { slip_speed } else { 0.0 },
            slip_speed_squared: slip_speed * slip_speed,
            held_share_squared: held_share * held_share,
            rut,
            bulldozing: law.bulldozing,
        }
    }

    /// Square of the slip speed at which the shear fades: that of a held wheel where the rim hardly moves.
    #[inline(always)]
    pub fn fading_squared(&self, rim_speed: S) -> S {
        let held = self.held_share_squared;
        let squared = rim_speed * rim_speed;
        let rolling = squared / squared.offset(self.slip_speed_squared);
        rolling
            .scale(1.0 - held)
            .offset(held)
            .scale(self.slip_speed_squared)
    }

    /// Integrates the stresses over the patch, and the resistance of the soil beside it.
    #[inline(always)]
    pub fn integrate<V: Simd>(
        &self,
        simd: V,
        rule: &Quadrature,
        motion: &AlteredMotion<S>,
        entry: S,
    ) -> (PatchSums<S>, Option<Wedge<S>>) {
        let arc = self.arc(entry);
        let zero = S::constant(0.0).splat(simd);
        let mut sums = PatchSums::new(zero);
        // Integrals of h cos(theta) and h^2 cos(theta) over the arc, and with sin(theta).
        let mut buried = [zero; 4];
        let mut room = [(0.0, 0.0); MOST_ROWS];
        let rim = motion.rim_speed;
        let travel = [motion.forward, motion.lateral, motion.yaw_rate];
        let crossing = Crossing::new(travel, rim, [arc.sin_entry, arc.cos_entry]);
        let width = self.footprint.width_nodes(rule, &crossing, &mut room);
        let reversed = self.footprint.reversed_rows(width, &crossing);
        // First the rows whose slip velocity keeps its sign, then each of the others on its own
        // split arc.
        let rut = self.rut_ends(&arc);
        let straight = self.ends(&arc, rut, arc.exit, arc.exit);
        let first = (straight, !reversed);
        let others = (0..width.len()).filter(|row| reversed & (1 << row) != 0);
        let others = others.map(|row| {
            let turn = self.turn(motion, &arc, width[row].0);
            (self.ends(&arc, rut, -turn, turn), 1 << row)
        });
        for (task, (ends, rows)) in std::iter::once(first).chain(others).enumerate() {
            let straight = task == 0;
            let graded = straight;
            for pair in ends.windows(2) {
                let (start, end) = (pair[0].max(arc.exit), pair[1].min(arc.entry));
                if end.value() - start.value() <= SHORTEST_PIECE * entry.value() {
                    continue;
                }
                let ahead = start.value() >= arc.middle.value();
                let front = f64x8::splat(simd, f64::from(u8::from(ahead)));
                let nodes = match (graded, ahead) {
                    (true, false) => &rule.rear,
                    (true, true) => &rule.front,
                    (false, _) => &rule.piece,
                };
                let length = (end - start).splat(simd);
                let start = start.splat(simd);
                for nodes in nodes {
                    let angle = start + length.scale_lanes(f64x8::simd_from(simd, nodes.at));
                    let weight = length.scale_lanes(f64x8::simd_from(simd, nodes.weight));
                    let column = self.column(simd, motion, &arc, angle, front, weight);
                    if straight {
                        sums.normal[0] += column.stress * column.sin;
                        sums.normal[1] += column.stress * column.cos;
                        let depth = column.rise;
                        let strip = depth * column.cos * column.weight;
                        buried[0] += strip;
                        buried[1] += strip * depth;
                        buried[2] += strip * column.sin;
                        buried[3] += strip * depth * column.sin;
                    }
                    for (index, &(at, share)) in width.iter().enumerate() {
                        if rows & (1 << index) != 0 {
                            self.accumulate(simd, &mut sums, motion, &column, at, share);
                        }
                    }
                }
            }
        }
        let wedge = self.bulldozing.as_ref().map(|effect| {
            let [by_depth, by_square, depth_moment, square_moment] = buried;
            let sums = [
                by_depth.sum(),
                by_square.sum(),
                depth_moment.sum(),
                square_moment.sum(),
            ];
            self.wedge(effect, &arc, sums)
        });
        (sums.sum::<V>(), wedge)
    }

    /// Forces on the wheel's flank from the integrals of h/R cos(theta) and (h/R)^2 cos(theta)
    /// over the arc, plain and with sin(theta): R_b = a h + b h^2.
    #[inline(always)]
    fn wedge(&self, effect: &Bulldozing<S>, arc: &Arc<S>, buried: [S; 4]) -> Wedge<S> {
        let t = self.soil.friction;
        let q = (t * t).offset(1.0).sqrt() + t;
        let radius_squared = self.circle * self.circle;
        let by_depth = q.scale(2.0) * self.soil.cohesion * radius_squared * effect.lateral;
        let by_square = q
            * (q + q * q * t)
            * effect.unit_weight
            * radius_squared
            * self.circle
            * effect.lateral;
        let sinkage = self.circle * (arc.half_sine_squared).scale(2.0);
        let blade = effect.blade_resistance(&self.soil, sinkage);
        Wedge {
            force: by_depth * buried[0] + by_square * buried[1],
            moment: (by_depth * buried[2] + by_square * buried[3]) * self.circle,
            frontal: effect.frontal * blade.scale(self.footprint.width),
        }
    }

    /// Prepares eight nodes of the arc; `front` is 1 for those ahead of the greatest stress.
    #[inline(always)]
    fn column<V: Simd>(
        &self,
        simd: V,
        motion: &AlteredMotion<S>,
        arc: &Arc<S>,
        angle: S::Packed<V>,
        front: f64x8<V>,
        weight: S::Packed<V>,
    ) -> Column<S::Packed<V>> {
        let (half_sine, half_cosine) = angle.scale(0.5).sin_cos_small();
        let sine_squared = half_sine * half_sine;
        let sin = (half_sine * half_cosine).scale(2.0);
        let cos = sine_squared.scale(-2.0).offset(1.0);
        let entry_squared = arc.half_sine_squared.splat(simd);
        let rise = (entry_squared - sine_squared).scale(2.0);
        let travelled = arc.entry.splat(simd) - angle;
        // The angle of the front that has the same stress.
        let mirrored =
            arc.entry.splat(simd) - (angle - arc.exit.splat(simd)) * arc.rear_slope.splat(simd);
        let alike = mirrored + (angle - mirrored).scale_lanes(front);
        let (alike, _) = alike.scale(0.5).sin_cos_small();
        let depth = (entry_squared - alike * alike) * self.circle.scale(2.0).splat(simd);
        let stress = self.stress(simd, depth);
        let spin = motion.yaw_rate * self.circle;
        let cos_entry = arc.cos_entry.splat(simd);
        let sin_entry = arc.sin_entry.splat(simd);
        let moved = &motion.displacement;
        let strength = stress * self.soil.friction.splat(simd) + self.soil.cohesion.splat(simd);
        Column {
            sin,
            cos,
            stress: stress * weight,
            strength: strength * weight,
            rise,
            mean_cos: (cos + cos_entry).scale(0.5),
            stretch: (travelled + sin_entry * cos_entry - sin * cos).scale(0.5),
            rolled: moved.rim.splat(simd) * (sin_entry - sin),
            sideways: motion.lateral.splat(simd) + spin.splat(simd) * sin,
            aside: moved.lateral.splat(simd) * travelled
                + (moved.yaw * self.circle).splat(simd) * rise,
            fading_squared: motion.fading_squared.splat(simd),
            weight,
        }
    }

    /// Normal stress at depths below the surface that the wheel meets \[Pa\].
    #[inline(always)]
    fn stress<V: Simd>(&self, simd: V, depth: S::Packed<V>) -> S::Packed<V> {
        let (modulus, exponent) = (
            self.soil.modulus.splat(simd),
            self.soil.exponent.splat(simd),
        );
        match &self.rut {
            None => depth.power_of(exponent) * modulus,
            Some(rut) => {
                let first = (depth + rut.ground.splat(simd)).power_of(exponent) * modulus;
                let again = depth * rut.stiffness.splat(simd);
                let beyond = (depth - rut.elastic.splat(simd)).positive();
                again + (first - again) * beyond
            }
        }
    }

    /// Adds the shear stress (16) of one row at eight nodes of the arc.
    #[inline(always)]
    fn accumulate<V: Simd>(
        &self,
        simd: V,
        sums: &mut PatchSums<S::Packed<V>>,
        motion: &AlteredMotion<S>,
        column: &Column<S::Packed<V>>,
        at: f64,
        share: f64,
    ) {
        let offset = at * self.footprint.width;
        let rim = motion.rim_speed.splat(simd);
        let forward = (motion.forward - motion.yaw_rate.scale(offset)).splat(simd);
        let moved = &motion.displacement;
        let moved_forward = (moved.forward - moved.yaw.scale(offset)).splat(simd);
        // Tangential slip velocity (12), and shear displacement (14).
        let mut tangential = forward * column.cos - rim;
        let mut sideways = column.sideways;
        let x = moved_forward * column.stretch - column.rolled;
        let z = (moved_forward * column.mean_cos - moved.rim.splat(simd)) * column.rise;
        let stretched = column.aside * column.aside * self.lateral_stretch.splat(simd);
        let path_squared = (x * x + z * z + stretched).offset(DISPLACEMENT_FLOOR);
        let path = path_squared * path_squared.inverse_sqrt();
        let mobilised = (-(path * self.inverse_modulus.splat(simd)))
            .decay()
            .offset(-1.0);
        if self.lean > 0.0 {
            // Where nothing slides, the shear is opposite to the displacement.
            let saturated = path.like(self.lean) / (path + self.soil.shear_modulus.splat(simd));
            tangential += (x * column.cos + z * column.sin) * saturated;
            sideways += column.aside * saturated;
        }
        let speed_squared = tangential * tangential + sideways * sideways + column.fading_squared;
        let factor = (mobilised * speed_squared.inverse_sqrt()).scale(share) * column.strength;
        let along = factor * tangential;
        let across = factor * sideways * self.strength_ratio.splat(simd);
        sums.tangential += along;
        sums.shear[0] += along * column.cos;
        sums.shear[1] += across;
        sums.shear[2] += along * column.sin;
        sums.width_moment += (along * column.cos).scale(offset);
        sums.arc_moment += across * column.sin;
    }
}
