//! Forces on one wheel whose contact effects alter.

use super::altered_patch::{AlteredMotion, AlteredPatch};
use super::quadrature::Quadrature;
use super::wheel::OneSided;
use super::{Detail, WheelContact, WheelForces, WheelMotion};
use crate::effects::{
    Bulldozing, Displacement, Multipass, SlipSinkage, Soil, StressPeak, absolute_slip, whole_slip,
};
use crate::scalar::{Elementary, Scalar};
use fearless_simd::{Level, Simd, dispatch};

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
    /// of (sin reach/2)^2: a tyre may be flat over a thousand times the length at which it begins to be, and the
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
