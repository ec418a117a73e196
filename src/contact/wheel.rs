//! Forces on one wheel, in any direction of travel and rotation.

use super::law::{ContactArc, Wheel};
use super::patch::{Patch, PatchMotion};
use super::quadrature::{Quadrature, Resolution};
use crate::effects::{Bulldozing, Displacement, Soil, absolute_slip, whole_slip};
use crate::parameter::{Bounds, ParameterError};
use crate::scalar::{Elementary, Scalar};
use fearless_simd::{Level, Simd, dispatch};
use std::sync::Arc;

/// The speeds below which the paper's expressions, undefined at rest, are smoothed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Regularisation {
    /// Slip speed \[m/s\] below which the shear stress fades instead of turning round:
    /// its direction (16) is V_j / sqrt(V_j^2 + slip_speed^2).
    pub slip_speed: f64,
    /// Angular speed omega_min \[rad/s\] that bounds the contact time (theta_1 - theta) / omega
    /// of (14): from 2 omega_min down abs(omega) is replaced by omega_min + omega^2 / (4 omega_min).
    pub angular_speed: f64,
    /// Travel speed \[m/s\] below which the compacted side passes smoothly from front to rear.
    pub travel_speed: f64,
}

impl Default for Regularisation {
    fn default() -> Self {
        Self {
            slip_speed: 1e-3,
            angular_speed: 0.05,
            travel_speed: 0.01,
        }
    }
}

impl Regularisation {
    /// Refuses speeds that are not positive.
    ///
    /// # Errors
    /// The first speed outside its range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        Bounds::open_low("slip_speed", "m/s", 0.0, 1.0).check(self.slip_speed)?;
        Bounds::open_low("angular_speed", "rad/s", 0.0, 10.0).check(self.angular_speed)?;
        Bounds::open_low("travel_speed", "m/s", 0.0, 1.0).check(self.travel_speed)
    }

    /// abs(omega), kept away from zero (see [`Regularisation::angular_speed`]).
    pub fn bounded_angular_speed<S: Scalar>(&self, omega: S) -> S {
        let limit = self.angular_speed;
        if omega.value() >= 2.0 * limit {
            omega
        } else if omega.value() <= -2.0 * limit {
            -omega
        } else {
            (omega * omega).scale(0.25 / limit).offset(limit)
        }
    }

    /// Which side compacts soil: 1 the front, -1 the rear, in between near standstill.
    fn compacting_side<S: Scalar>(&self, forward: S) -> S {
        let u = forward.scale(1.0 / self.travel_speed);
        if u.value() >= 1.0 {
            S::constant(1.0)
        } else if u.value() <= -1.0 {
            S::constant(-1.0)
        } else {
            // The odd quintic that meets 1 with two vanishing derivatives.
            let square = u * u;
            u * (square * square.scale(0.375).offset(-1.25)).offset(1.875)
        }
    }
}

/// Which of its two rules a contact is integrated by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// Half the nodes in each direction: good to some 1e-3, enough for derivatives that guide a search.
    Coarse,
    /// All the nodes.
    Full,
}

/// What the ground does to one wheel, in the body frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelForces<S> {
    /// Integral of tau_X \[N\]: the shear's part of F_X (18).
    pub thrust: S,
    /// Integral of sigma sin theta \[N\], positive towards the rear: F_X = thrust - compaction.
    pub compaction: S,
    /// F_Y \[N\] (18).
    pub lateral: S,
    /// F_Z \[N\] (18).
    pub vertical: S,
    /// Integral of y tau_X \[N m\] about the wheel's middle plane.
    pub width_moment: S,
    /// Integral of x_i tau_Y \[N m\] about the wheel's axle, x_i = r sin theta (8).
    pub arc_moment: S,
    /// Horizontal force of the normal stress against the wheel's travel \[N\] (21).
    pub rolling_resistance: S,
    /// Torque that the axle needs \[N m\], positive drives forward: the shear along the rim
    /// times the radius (the normal stress points at the axle).
    pub torque: S,
}

/// Number of the fields of [`WheelForces`].
pub(crate) const FORCE_COUNT: usize = 8;

impl<S: Scalar> WheelForces<S> {
    /// A wheel that carries nothing.
    #[must_use]
    pub fn zero() -> Self {
        Self::from_array([S::constant(0.0); FORCE_COUNT])
    }

    pub(crate) fn to_array(self) -> [S; FORCE_COUNT] {
        [
            self.thrust,
            self.compaction,
            self.lateral,
            self.vertical,
            self.width_moment,
            self.arc_moment,
            self.rolling_resistance,
            self.torque,
        ]
    }

    pub(crate) fn from_array(array: [S; FORCE_COUNT]) -> Self {
        let [
            thrust,
            compaction,
            lateral,
            vertical,
            width_moment,
            arc_moment,
            rolling_resistance,
            torque,
        ] = array;
        Self {
            thrust,
            compaction,
            lateral,
            vertical,
            width_moment,
            arc_moment,
            rolling_resistance,
            torque,
        }
    }
}

/// What the contact of every wheel is evaluated with: quadrature rules and smoothing speeds.
#[derive(Debug, Clone)]
pub struct WheelContact {
    rule: Arc<Quadrature>,
    /// Half the nodes of `rule`.
    coarse_rule: Arc<Quadrature>,
    regularisation: Regularisation,
}

/// The slip speed at which the shear of a held wheel fades, as a share of that of a rolling one.
/// The smaller, the sooner a held vehicle settles: at 0.02 within some tenths of a second.
const HELD_SLIP_SPEED: f64 = 0.02;

/// Displacement \[m\] that keeps the slope of the root in (15) finite where it is a state; and where it is the motion
/// times the contact time, that motion \[m/s\] of a rigid wheel, a larger circle's contact being the longer.
const DISPLACEMENT_FLOOR: f64 = 1e-9;
const MOTION_FLOOR: f64 = 1e-10;

/// Resistance of the soil beside and ahead of the wheel, for a motion straight against it.
struct Wedge<S> {
    /// Lateral force \[N\].
    force: S,
    /// Its moment about the axle \[N m\].
    moment: S,
    /// Force against the front \[N\].
    frontal: S,
}

impl WheelContact {
    /// With these smoothing speeds and numbers of nodes.
    ///
    /// # Errors
    /// A speed or number out of range.
    pub fn new(
        regularisation: Regularisation,
        resolution: Resolution,
    ) -> Result<Self, ParameterError> {
        regularisation.validate()?;
        resolution.validate()?;
        Ok(Self {
            rule: Quadrature::shared(resolution),
            coarse_rule: Quadrature::shared(resolution.halved()),
            regularisation,
        })
    }

    /// The speeds below which the paper's expressions are smoothed.
    #[must_use]
    pub fn regularisation(&self) -> &Regularisation {
        &self.regularisation
    }

    /// Load \[N\] over theta_1^(2n+1) that the normal stress alone carries under a rigid wheel at small entry angles:
    /// of sigma = k (r theta_1^2 / 2)^n (1 - u^2)^n with cos theta = 1.
    pub(crate) fn support(&self, soil: &Soil<f64>, radius: f64, width: f64) -> f64 {
        let pressure = soil.modulus * (0.5 * radius).powf(soil.exponent);
        pressure * self.rule.flat_arc(soil.exponent) * radius * width
    }

    /// Forces of the ground on a wheel.
    ///
    /// # Algorithm
    /// 1. The slip of the wheel changes its soil and the place of the greatest stress, where effects say so.
    /// 2. The side that compacts soil is the one towards which the wheel travels; a wheel that travels backwards is the
    ///    mirror image of one that travels forwards. Near standstill both are weighted.
    /// 3. The shear displacement is that of steady motion (14), or what the wheel remembers.
    /// 4. Stresses are integrated over the arc and across the width (`patch.rs`): rows in which the slip velocity keeps
    ///    its sign together, each of the others on an arc that is split where it turns round.
    /// 5. The sums become forces by the patch's area; the soil that is pushed aside and viscosity are added.
    ///
    /// One function for each scalar, dispatched here to the vector instructions: inlined into its
    /// callers it would be compiled many times over.
    #[inline(never)]
    pub fn forces<S: Scalar>(
        &self,
        level: Level,
        wheel: &Wheel<S>,
        detail: Detail,
    ) -> WheelForces<S> {
        if wheel.law.transient {
            dispatch!(level, simd => self.forces_with::<_, S, true>(simd, wheel, detail))
        } else {
            dispatch!(level, simd => self.forces_with::<_, S, false>(simd, wheel, detail))
        }
    }

    #[inline(always)]
    fn forces_with<V: Simd, S: Scalar, const TRANSIENT: bool>(
        &self,
        simd: V,
        wheel: &Wheel<S>,
        detail: Detail,
    ) -> WheelForces<S> {
        let Wheel {
            motion,
            law,
            memory,
            ..
        } = wheel;
        let rule = match detail {
            Detail::Coarse => &self.coarse_rule,
            Detail::Full => &self.rule,
        };
        let arc = law.arc(wheel.reach);
        let fading = self.regularisation.travel_speed;
        let rim_speed = motion.angular_speed * law.radius;
        let soil = law.slip_sinkage.as_ref().map_or(law.soil, |effect| {
            let slip = whole_slip(rim_speed, motion.forward, motion.lateral, fading);
            effect.soil(&law.soil, slip)
        });
        let peak = law.peak.as_ref().map_or(S::constant(0.5), |effect| {
            effect.place(absolute_slip(rim_speed, motion.forward, fading))
        });
        let slip_speed = self.regularisation.slip_speed;
        let patch = Patch::new(law, arc.circle, soil, peak, memory.pressed, slip_speed);
        let area = arc.circle.scale(law.width);
        let side = self.regularisation.compacting_side(motion.forward);
        // Share of the patch whose front (rear) compacts; near standstill both do.
        let front = side.scale(0.5).offset(0.5);
        let mut forces = WheelForces::<S>::zero();
        for (sign, share) in [(1.0, front), (-1.0, S::constant(1.0) - front)] {
            if share.value() == 0.0 {
                continue;
            }
            // The rear is the front of the mirror image.
            let seen = self.patch_motion::<S, TRANSIENT>(wheel, arc.circle, rim_speed, &soil, sign);
            let sums = patch.integrate::<V, TRANSIENT>(simd, rule, &seen, arc.entry);
            let along = area.scale(sign) * share;
            let across = area * share;
            forces.thrust += sums.shear[0] * along;
            forces.compaction += sums.normal[0] * along;
            forces.lateral += sums.shear[1] * across;
            forces.vertical += (sums.shear[2] + sums.normal[1]) * across;
            forces.width_moment += sums.width_moment * along;
            forces.arc_moment += sums.arc_moment * along * arc.circle;
            forces.torque += sums.tangential * along * law.radius;
            if let Some(effect) = &law.bulldozing {
                let wedge = Wedge::of(effect, &soil, &arc, law.rebound, law.width);
                let speed_squared =
                    motion.forward * motion.forward + motion.lateral * motion.lateral;
                let inverse = speed_squared.offset(fading * fading).inverse_sqrt() * share;
                let aside = -motion.lateral * inverse;
                forces.lateral += aside * wedge.force;
                forces.arc_moment += (aside * wedge.moment).scale(sign);
                forces.compaction += motion.forward * inverse * wedge.frontal;
            }
        }
        forces.thrust = forces.thrust - law.viscosity[0] * motion.forward;
        forces.lateral = forces.lateral - law.viscosity[1] * motion.lateral;
        let travel = if side.value() < 0.0 { -1.0 } else { 1.0 };
        forces.rolling_resistance = forces.compaction.scale(travel);
        forces
    }

    /// The motion over the patch as it is (sign 1) or of its mirror image (sign -1).
    #[inline(always)]
    fn patch_motion<S: Scalar, const TRANSIENT: bool>(
        &self,
        wheel: &Wheel<S>,
        circle: S,
        rim_speed: S,
        soil: &Soil<S>,
        sign: f64,
    ) -> PatchMotion<S> {
        let Wheel { motion, law, .. } = wheel;
        let inverse_modulus = S::constant(-1.0) / soil.shear_modulus;
        let slip_speed_squared = self.regularisation.slip_speed.powi(2);
        let (forward, yaw_rate) = (motion.forward.scale(sign), motion.yaw_rate.scale(sign));
        let (lateral, rim_speed) = (motion.lateral, rim_speed.scale(sign));
        let (moved, rate, floor, fading_squared) = if TRANSIENT {
            let moved = &wheel.memory.displacement;
            let moved = Displacement {
                forward: moved.forward.scale(sign),
                lateral: moved.lateral,
                yaw: moved.yaw.scale(sign),
                rim: moved.rim.scale(sign),
            };
            // Where the rim hardly moves the shear fades at the slip speed of a held wheel.
            let held = HELD_SLIP_SPEED * HELD_SLIP_SPEED;
            let squared = rim_speed * rim_speed;
            let rolling = squared / squared.offset(slip_speed_squared);
            let fading = rolling.scale(1.0 - held).offset(held);
            let fading = fading.scale(slip_speed_squared);
            (moved, inverse_modulus, DISPLACEMENT_FLOOR, fading)
        } else {
            let bounded = self
                .regularisation
                .bounded_angular_speed(motion.angular_speed);
            let moved = Displacement {
                forward,
                lateral,
                yaw: yaw_rate,
                rim: rim_speed,
            };
            let time_per_angle = circle / (law.radius * bounded);
            let fading = S::constant(slip_speed_squared);
            let floor = MOTION_FLOOR * law.radius.value() / circle.value();
            (moved, inverse_modulus * time_per_angle, floor, fading)
        };
        PatchMotion {
            forward,
            lateral,
            yaw_rate,
            rim_speed,
            moved,
            rate,
            floor: floor * floor,
            fading_squared,
            lean: self.regularisation.slip_speed,
        }
    }
}

impl<S: Scalar> Wedge<S> {
    /// Of the resistance R_b = a h + b h^2 of blades side by side along the arc, h = R (cos theta - cos theta_1): its
    /// integrals with R cos theta, and for the moment with R^2 sin theta cos theta, in closed form.
    #[inline(always)]
    fn of(
        effect: &Bulldozing<S>,
        soil: &Soil<S>,
        arc: &ContactArc<S>,
        rebound: S,
        width: f64,
    ) -> Self {
        let ContactArc { circle, entry } = *arc;
        let (_, lowest) = entry.sin_cos();
        let [from, to] = [-(rebound * entry), entry].map(|angle| {
            let (sin, cos) = angle.sin_cos();
            let half = (angle + sin * cos).scale(0.5);
            let cubed = cos * cos * cos;
            [
                // h / R and its square times cos theta,
                half - lowest * sin,
                sin - (sin * sin * sin).scale(1.0 / 3.0) - (lowest * half).scale(2.0)
                    + lowest * lowest * sin,
                // and times sin theta cos theta.
                (lowest * cos * cos).scale(0.5) - cubed.scale(1.0 / 3.0),
                (lowest * cubed).scale(2.0 / 3.0)
                    - (cubed * cos).scale(0.25)
                    - (lowest * lowest * cos * cos).scale(0.5),
            ]
        });
        let t = soil.friction;
        let q = (t * t).offset(1.0).sqrt() + t;
        let square = circle * circle;
        let by_depth = q.scale(2.0) * soil.cohesion * square * effect.lateral;
        let by_square = q * (q + q * q * t) * effect.unit_weight * square * circle * effect.lateral;
        let blade = effect.blade_resistance(soil, arc.sinkage());
        Self {
            force: by_depth * (to[0] - from[0]) + by_square * (to[1] - from[1]),
            moment: (by_depth * (to[2] - from[2]) + by_square * (to[3] - from[3])) * circle,
            frontal: effect.frontal * blade.scale(width),
        }
    }
}
