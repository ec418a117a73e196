//! Forces on one wheel, in any direction of travel and rotation.

use super::patch::{Footprint, PatchLaw, PatchMotion, small_angle_support};
use super::quadrature::{Quadrature, Resolution};
use super::sums::PatchSums;
use crate::parameter::{Bounds, ParameterError};
use crate::scalar::Scalar;
use crate::terrain::Terrain;
use fearless_simd::Simd;
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
    /// Half the nodes in each direction: good to some 1e-3, enough to approach a balance.
    Coarse,
    /// All the nodes.
    Full,
}

/// How one wheel moves over the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelMotion<S> {
    /// Velocity of the wheel's centre along X, V_X - Omega Y_i \[m/s\] (10).
    pub forward: S,
    /// Velocity of the wheel's centre along Y, V_Y + Omega X_i \[m/s\] (10).
    pub lateral: S,
    /// Yaw rate of the vehicle Omega \[rad/s\].
    pub yaw_rate: S,
    /// Angular speed of the wheel omega \[rad/s\], positive rolls forward.
    pub angular_speed: S,
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

/// One wheel on one soil, with everything prepared that does not move.
#[derive(Debug, Clone)]
pub struct WheelContact {
    law: PatchLaw,
    rule: Arc<Quadrature>,
    /// Half the nodes of `rule`.
    coarse_rule: Arc<Quadrature>,
    regularisation: Regularisation,
    /// F_Z / theta_1^(2n+1) at small angles, normal stress alone.
    support: f64,
}

/// Forces on a wheel that compacts soil on its +X side, of the motion as it is (sign 1) or of its
/// mirror image (sign -1). A trait: a closure as large as this is not always inlined, and one
/// that is not loses the vector instructions.
pub(super) trait OneSided<S> {
    fn forces(&self, sign: f64, motion: &WheelMotion<S>) -> WheelForces<S>;
}

/// The paper's law.
struct PlainSide<'a, V, S> {
    wheel: &'a WheelContact,
    simd: V,
    rule: &'a Quadrature,
    entry_angle: S,
}

impl<V: Simd, S: Scalar> OneSided<S> for PlainSide<'_, V, S> {
    #[inline(always)]
    fn forces(&self, _: f64, motion: &WheelMotion<S>) -> WheelForces<S> {
        self.wheel
            .one_sided(self.simd, self.rule, motion, self.entry_angle)
    }
}

impl WheelContact {
    /// A wheel of the given radius and width \[m\] on a soil.
    ///
    /// # Errors
    /// A soil without stiffness under this wheel (k = k_c / b + k_phi <= 0), or
    /// parameters out of range.
    pub fn new(
        terrain: &Terrain,
        radius: f64,
        width: f64,
        regularisation: Regularisation,
        resolution: Resolution,
    ) -> Result<Self, ParameterError> {
        terrain.validate()?;
        regularisation.validate()?;
        resolution.validate()?;
        let modulus = terrain.sinkage_modulus(width);
        Bounds::open_low(
            "cohesive_modulus / b + frictional_modulus",
            "N/m^(n+2)",
            0.0,
            1e14,
        )
        .check(modulus)?;
        let law = PatchLaw {
            cohesion: terrain.cohesion,
            friction: terrain.friction_angle.tan(),
            inverse_shear_modulus: 1.0 / terrain.shear_modulus,
            exponent: terrain.sinkage_exponent,
            pressure: modulus * (2.0 * radius).powf(terrain.sinkage_exponent),
            footprint: Footprint {
                radius,
                width,
                slip_speed_squared: regularisation.slip_speed.powi(2),
            },
        };
        let rule = Quadrature::shared(resolution);
        let support = small_angle_support(&law, &rule);
        Ok(Self {
            law,
            rule,
            coarse_rule: Quadrature::shared(resolution.halved()),
            regularisation,
            support,
        })
    }

    /// Entry angle \[rad\] at which the normal stress alone would carry a load \[N\].
    pub(crate) fn entry_angle_guess(&self, load: f64) -> f64 {
        (load / self.support)
            .powf(1.0 / (2.0 * self.law.exponent + 1.0))
            .min(1.5)
    }

    /// Forces of the ground on the wheel, whose rim enters the soil at `entry_angle` \[rad\].
    ///
    /// The side that compacts soil is the one towards which the wheel travels; a wheel
    /// that travels backwards is the mirror image of one that travels forwards.
    #[inline(always)]
    pub fn forces<V: Simd, S: Scalar>(
        &self,
        simd: V,
        motion: &WheelMotion<S>,
        entry_angle: S,
        detail: Detail,
    ) -> WheelForces<S> {
        let rule = self.rule(detail);
        let side = PlainSide {
            wheel: self,
            simd,
            rule,
            entry_angle,
        };
        self.both_sides(motion, &side)
    }

    pub(super) fn rule(&self, detail: Detail) -> &Quadrature {
        match detail {
            Detail::Coarse => &self.coarse_rule,
            Detail::Full => &self.rule,
        }
    }

    pub(super) fn regularisation(&self) -> &Regularisation {
        &self.regularisation
    }

    /// Forces on a wheel of which `one_sided` gives those on its +X side when that compacts soil,
    /// of the motion as it is (sign 1) and of its mirror image (sign -1).
    #[inline(always)]
    pub(super) fn both_sides<S: Scalar>(
        &self,
        motion: &WheelMotion<S>,
        one_sided: &impl OneSided<S>,
    ) -> WheelForces<S> {
        let side = self.regularisation.compacting_side(motion.forward);
        // Share of the patch whose front (rear) compacts; near standstill both do.
        let front = side.scale(0.5).offset(0.5);
        let mut forces = WheelForces::<S>::zero();
        for (sign, share) in [(1.0, front), (-1.0, S::constant(1.0) - front)] {
            if share.value() == 0.0 {
                continue;
            }
            // The rear is the front of the mirror image.
            let seen = WheelMotion {
                forward: motion.forward.scale(sign),
                lateral: motion.lateral,
                yaw_rate: motion.yaw_rate.scale(sign),
                angular_speed: motion.angular_speed.scale(sign),
            };
            let one = one_sided.forces(sign, &seen);
            forces.thrust += one.thrust.scale(sign) * share;
            forces.compaction += one.compaction.scale(sign) * share;
            forces.lateral += one.lateral * share;
            forces.vertical += one.vertical * share;
            forces.width_moment += one.width_moment.scale(sign) * share;
            forces.arc_moment += one.arc_moment.scale(sign) * share;
            forces.torque += one.torque.scale(sign) * share;
        }
        let travel = if side.value() < 0.0 { -1.0 } else { 1.0 };
        forces.rolling_resistance = forces.compaction.scale(travel);
        forces
    }

    /// Forces on a wheel that compacts soil on its +X side.
    #[inline(always)]
    fn one_sided<V: Simd, S: Scalar>(
        &self,
        simd: V,
        rule: &Quadrature,
        motion: &WheelMotion<S>,
        entry_angle: S,
    ) -> WheelForces<S> {
        let Footprint { radius, width, .. } = self.law.footprint;
        let bounded = self
            .regularisation
            .bounded_angular_speed(motion.angular_speed);
        let patch = PatchMotion {
            forward: motion.forward,
            lateral: motion.lateral,
            yaw_rate: motion.yaw_rate,
            rim_speed: motion.angular_speed.scale(radius),
            time_per_angle: S::constant(1.0) / bounded,
        };
        let sums = self.law.integrate(simd, rule, &patch, entry_angle);
        let scale = |factor: f64| move |sum: S| sum.scale(factor);
        let area = radius * width;
        sums.forces(scale(area), scale(area * radius), scale(area * radius))
    }
}

impl<S: Scalar> PatchSums<S> {
    /// The forces of a patch, from what its sums are to be multiplied with: its area per radian,
    /// that times the radius of its circle, and that times the radius at which the rim drives.
    #[inline(always)]
    pub(super) fn forces(
        self,
        area: impl Fn(S) -> S,
        arm: impl Fn(S) -> S,
        drive: impl Fn(S) -> S,
    ) -> WheelForces<S> {
        let compaction = area(self.normal[0]);
        WheelForces {
            thrust: area(self.shear[0]),
            compaction,
            lateral: area(self.shear[1]),
            vertical: area(self.shear[2] + self.normal[1]),
            width_moment: area(self.width_moment),
            arc_moment: arm(self.arc_moment),
            rolling_resistance: compaction,
            torque: drive(self.tangential),
        }
    }
}
