//! Forces on one wheel whose contact effects alter: (3) to (6) and (11) to (18) once more, (4) in full.
//!
//! `patch.rs` evaluates the same equations without effects, and faster. A change of an equation belongs in both.
//!
//! The arc reaches from -theta_2 to theta_1 with the greatest stress at theta_m between; behind it
//! the stress is that of the front at the angle theta_1 - (theta + theta_2) (theta_1 - theta_m) /
//! (theta_m + theta_2), which is (5) for theta_2 = 0 and theta_m = theta_1 / 2.

use super::patch::{Crossing, Footprint, NEAREST_TURN};
use super::quadrature::{MOST_ROWS, Quadrature};
use super::sums::PatchSums;
use super::wheel::OneSided;
use super::{Detail, Regularisation, WheelContact, WheelForces, WheelMotion};
use crate::effects::{
    Bulldozing, Displacement, Multipass, SlipSinkage, Soil, StressPeak, absolute_slip, whole_slip,
};
use crate::scalar::{Elementary, Packed, Real, Scalar};
use fearless_simd::{Level, Simd, dispatch, f64x8, prelude::*};

/// One wheel and its soil with everything that effects change, generic over the scalar so that
/// every parameter can be differentiated by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelLaw<S> {
    /// Soil under the wheel.
    pub soil: Soil<S>,
    /// Radius r at which the rim rolls \[m\].
    pub radius: S,
    /// Sinkage at which a tyre is flat \[m\]: it sinks no deeper.
    pub flat: Option<S>,
    /// Wheel width b \[m\].
    pub width: f64,
    /// Exit angle behind the lowest point as a share of the entry angle.
    pub rebound: S,
    /// K_Y / K_X.
    pub modulus_ratio: S,
    /// Shear strength across the wheel over that along it.
    pub strength_ratio: S,
    /// Viscous coefficients of this wheel along X and Y \[N s/m\].
    pub viscosity: [S; 2],
    /// Where the greatest stress lies, if not in the middle.
    pub peak: Option<StressPeak<S>>,
    /// Sinkage that grows with slip.
    pub slip_sinkage: Option<SlipSinkage<S>>,
    /// Soil pushed ahead.
    pub bulldozing: Option<Bulldozing<S>>,
    /// Soil that remembers the rows ahead.
    pub multipass: Option<Multipass<S>>,
    /// Whether the shear displacement is the wheel's own state.
    pub transient: bool,
}

/// What a wheel and its soil remember.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelMemory<S> {
    /// What the shear displacement is made of, where it is a state.
    pub displacement: Displacement<S>,
    /// Depth to which the soil was pressed by the rows ahead \[m\].
    pub pressed: S,
}

impl WheelMemory<f64> {
    /// Nothing sheared, nothing pressed.
    pub const NONE: Self = Self {
        displacement: Displacement {
            forward: 0.0,
            lateral: 0.0,
            yaw: 0.0,
            rim: 0.0,
        },
        pressed: 0.0,
    };
    /// Number of its values.
    pub const COUNT: usize = 5;
}

impl<S: Copy> WheelMemory<S> {
    /// The values in the order of the fields.
    #[must_use]
    pub fn to_array(self) -> [S; WheelMemory::COUNT] {
        let Displacement {
            forward,
            lateral,
            yaw,
            rim,
        } = self.displacement;
        [forward, lateral, yaw, rim, self.pressed]
    }

    /// From the values in the order of the fields.
    #[must_use]
    pub fn from_array([forward, lateral, yaw, rim, pressed]: [S; WheelMemory::COUNT]) -> Self {
        Self {
            displacement: Displacement {
                forward,
                lateral,
                yaw,
                rim,
            },
            pressed,
        }
    }
}

impl WheelLaw<f64> {
    /// The same law with another scalar: its derivatives are zero.
    #[inline(always)]
    pub(crate) fn lift<S: Scalar>(&self) -> WheelLaw<S> {
        let c = S::constant;
        WheelLaw {
            soil: Soil {
                cohesion: c(self.soil.cohesion),
                friction: c(self.soil.friction),
                modulus: c(self.soil.modulus),
                exponent: c(self.soil.exponent),
                shear_modulus: c(self.soil.shear_modulus),
            },
            radius: c(self.radius),
            flat: self.flat.map(c),
            width: self.width,
            rebound: c(self.rebound),
            modulus_ratio: c(self.modulus_ratio),
            strength_ratio: c(self.strength_ratio),
            viscosity: self.viscosity.map(c),
            peak: self.peak.map(|p| StressPeak {
                a0: c(p.a0),
                a1: c(p.a1),
            }),
            slip_sinkage: self.slip_sinkage.map(|s| SlipSinkage {
                exponent_growth: c(s.exponent_growth),
                sinkage_growth: c(s.sinkage_growth),
            }),
            bulldozing: self.bulldozing.map(|b| Bulldozing {
                lateral: c(b.lateral),
                frontal: c(b.frontal),
                unit_weight: c(b.unit_weight),
            }),
            multipass: self.multipass.map(|m| Multipass {
                memory: c(m.memory),
                stiffness_ratio: c(m.stiffness_ratio),
            }),
            transient: self.transient,
        }
    }
}

/// The circle on which a wheel meets the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactArc<S> {
    /// Its radius \[m\], larger than the wheel's where a tyre is flat.
    pub circle: S,
    /// Its entry angle theta_1 \[rad\].
    pub entry: S,
}

impl<S: Scalar> ContactArc<S> {
    /// Depth of its lowest point below the ground that it meets \[m\].
    pub fn sinkage(&self) -> S {
        let (sine, _) = self.entry.scale(0.5).sin_cos_small();
        self.circle * (sine * sine).scale(2.0)
    }
}

impl<S: Scalar> WheelLaw<S> {
    /// The arc on which a wheel stands that reaches so far into the ground: `reach` is theta_1 \[rad\] of a rigid
    /// wheel. Beyond the reach at which a tyre is flat the sinkage stays, and the contact grows with the square
    /// of (sin reach/2)^2: a tyre may be flat over a thousand times the length at which it starts to be, and the
    /// reach stays an angle.
    #[inline(always)]
    pub fn arc(&self, reach: S) -> ContactArc<S> {
        let rigid = ContactArc {
            circle: self.radius,
            entry: reach,
        };
        let Some(flat) = self.flat else { return rigid };
        let (sine, _) = reach.scale(0.5).sin_cos_small();
        let deepest = (flat / self.radius).scale(0.5);
        let over = sine * sine / deepest;
        if over.value() <= 1.0 {
            return rigid;
        }
        let longer = over * over;
        ContactArc {
            circle: self.radius * longer * longer,
            entry: twice_arc_sine(deepest.sqrt() / longer),
        }
    }

    /// The reach at which a wheel carries a load, where it would be `rigid` without a tyre; for a guess.
    pub(crate) fn reach(&self, rigid: f64) -> f64 {
        let Some(flat) = self.flat else { return rigid };
        let (flat, radius) = (flat.value(), self.radius.value());
        let begins = (0.5 * flat / radius).sqrt();
        let over = (0.5 * rigid).sin() / begins;
        if over <= 1.0 {
            return rigid;
        }
        // The contact of a flat tyre is as long as its load is large, that of a rigid wheel its root of order 2n+1.
        let longer = over.powf(2.0 * self.soil.exponent.value() + 1.0);
        2.0 * (begins * longer.powf(0.25)).min(HIGHEST_SINE).asin()
    }
}

/// Of a guess for the reach.
const HIGHEST_SINE: f64 = 0.7;

/// An angle by the sine of its half.
#[inline(always)]
fn twice_arc_sine<S: Scalar>(sine: S) -> S {
    let value = sine.value();
    let slope = 2.0 / (1.0 - value * value).sqrt();
    S::chain(2.0 * value.asin(), &[slope], &[sine])
}

/// The law that effects alter, on the wheel's +X side.
struct AlteredSide<'a, V, S> {
    wheel: &'a WheelContact,
    simd: V,
    rule: &'a Quadrature,
    law: &'a WheelLaw<S>,
    patch: &'a AlteredPatch<S>,
    memory: &'a WheelMemory<S>,
    arc: ContactArc<S>,
}

impl WheelContact {
    /// Forces of the ground on a wheel under a law that effects alter, whose rim enters the soil
    /// (or the ground of the rut) at `reach` \[rad\], or farther ahead where a tyre is flat ([`WheelLaw::arc`]).
    ///
    /// One function for each scalar, dispatched here to the vector instructions: inlined into its
    /// callers it would be compiled many times over.
    #[inline(never)]
    pub fn altered_forces<S: Scalar>(
        &self,
        level: Level,
        law: &WheelLaw<S>,
        motion: &WheelMotion<S>,
        memory: &WheelMemory<S>,
        reach: S,
        detail: Detail,
    ) -> WheelForces<S> {
        dispatch!(level, simd => self.altered_with(simd, law, motion, memory, reach, detail))
    }

    #[inline(always)]
    fn altered_with<V: Simd, S: Scalar>(
        &self,
        simd: V,
        law: &WheelLaw<S>,
        motion: &WheelMotion<S>,
        memory: &WheelMemory<S>,
        reach: S,
        detail: Detail,
    ) -> WheelForces<S> {
        let arc = law.arc(reach);
        let rule = self.rule(detail);
        let fading = self.regularisation().travel_speed;
        let rim_speed = motion.angular_speed * law.radius;
        let soil = law.slip_sinkage.as_ref().map_or(law.soil, |effect| {
            let slip = whole_slip(rim_speed, motion.forward, motion.lateral, fading);
            effect.soil(&law.soil, slip)
        });
        let peak = law.peak.as_ref().map_or(S::constant(0.5), |effect| {
            effect.place(absolute_slip(rim_speed, motion.forward, fading))
        });
        let patch = AlteredPatch::new(
            law,
            arc.circle,
            soil,
            peak,
            memory.pressed,
            self.regularisation(),
        );
        let side = AlteredSide {
            wheel: self,
            simd,
            rule,
            law,
            patch: &patch,
            memory,
            arc,
        };
        let mut forces = self.both_sides(motion, &side);
        forces.thrust = forces.thrust - law.viscosity[0] * motion.forward;
        forces.lateral = forces.lateral - law.viscosity[1] * motion.lateral;
        forces
    }
}

impl<V: Simd, S: Scalar> OneSided<S> for AlteredSide<'_, V, S> {
    /// With the sign -1 it is the mirror image of the wheel that the memory belongs to.
    #[inline(always)]
    fn forces(&self, sign: f64, motion: &WheelMotion<S>) -> WheelForces<S> {
        let Self {
            wheel,
            simd,
            rule,
            law,
            patch,
            memory,
            arc,
        } = *self;
        let rim_speed = motion.angular_speed * law.radius;
        let displacement = if law.transient {
            let Displacement {
                forward,
                lateral,
                yaw,
                rim,
            } = memory.displacement;
            Displacement {
                forward: forward.scale(sign),
                lateral,
                yaw: yaw.scale(sign),
                rim: rim.scale(sign),
            }
        } else {
            let bounded = wheel
                .regularisation()
                .bounded_angular_speed(motion.angular_speed);
            let time_per_angle = arc.circle / (law.radius * bounded);
            Displacement {
                forward: motion.forward * time_per_angle,
                lateral: motion.lateral * time_per_angle,
                yaw: motion.yaw_rate * time_per_angle,
                rim: rim_speed * time_per_angle,
            }
        };
        let seen = AlteredMotion {
            forward: motion.forward,
            lateral: motion.lateral,
            yaw_rate: motion.yaw_rate,
            rim_speed,
            displacement,
            fading_squared: patch.fading_squared(rim_speed),
        };
        let (sums, wedge) = patch.integrate(simd, rule, &seen, arc.entry);
        let area = arc.circle.scale(law.width);
        let mut forces = sums.forces(
            |sum| sum * area,
            |sum| sum * area * arc.circle,
            |sum| sum * area * law.radius,
        );
        if let Some(wedge) = wedge {
            let fading = wheel.regularisation().travel_speed;
            let speed_squared = motion.forward * motion.forward + motion.lateral * motion.lateral;
            let inverse = speed_squared.offset(fading * fading).inverse_sqrt();
            let across = -motion.lateral * inverse;
            forces.lateral += across * wedge.force;
            forces.arc_moment += across * wedge.moment;
            forces.compaction += motion.forward * inverse * wedge.frontal;
        }
        forces
    }
}

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
