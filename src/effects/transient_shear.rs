//! Shear displacement that takes its time.

use super::declaration::effect;
use crate::scalar::{Elementary, Scalar};

effect! {
    /// The shear displacement of (14) is that of a steady state; it builds up while the rim rolls
    /// through the contact, and stays where nothing rolls: it holds a vehicle on a slope.
    ///
    /// The displacement obeys dj/dt - omega dj/dtheta = V_j along the contact, with j = 0 where the rim
    /// enters. Its steady state (14) is linear in four numbers of the wheel, V_X/abs(omega),
    /// V_Y/abs(omega), Omega/abs(omega) and r sign(omega); here these four are states J. Averaged over
    /// the contact of angle L (theta_1, and with `elastic_rebound` theta_2 behind the axle besides; a Galerkin closure with the
    /// steady profile, whose mean over the contact is J L / 2) the equation is dJ/dt = 2/(s L) (V - abs(omega) J) with V = V_X, V_Y, Omega,
    /// r omega: exact in the steady state and for the mean displacement of a locked wheel, of first
    /// order in between. Soil sheared beyond 10 K slides on without storing more. A scale below 0.01 counts as 0.01: the
    /// displacement then follows within 0.4 ms at 5 rad/s.
    TransientShear: "transient_shear", Wheels + memory,
    phrase "shear that builds up over a distance",
    lifts "velocities constant while a point of the rim is in contact",
    equation "dJ/dt = 2/(s L) (V - abs(omega) J), j as in (14) with J for V/abs(omega), L the angle of contact, theta_1 or theta_1 + theta_2; what is sheared beyond 10 K stores no more; s is 0.01 at least",
    source "transport equation of the brush model (Pacejka, Tyre and Vehicle Dynamics, ch. 2), projected here",
    check "Start and stop gently, and compare how far the rims turn before the vehicle follows.",
    formulas differ,
    {
        relaxation ["1"] 0.0..5.0, off 0.0, lognormal(1.0, 0.4), "Scale s of the relaxation length, 1 as derived; 0 is the steady state of the paper", first_step_to(1.0);
    }
}

/// Displacement in units of K beyond which the shear is mobilised to 5e-5 and nothing is stored.
pub const LONGEST: f64 = 10.0;

/// Scale of the relaxation length that is followed at the shortest. At 0.01, 0.003 and 0.001 a drive of 3 s with a turn
/// and a reversal ends within 0.2 mm; the cost grows with its inverse.
const SHORTEST: f64 = 0.01;

/// What the shear displacement of a wheel is made of; in the steady state the velocities over
/// abs(omega).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Displacement<S> {
    /// Of V_X at the wheel's middle \[m/rad\].
    pub forward: S,
    /// Of V_Y \[m/rad\].
    pub lateral: S,
    /// Of Omega \[1\].
    pub yaw: S,
    /// Of r omega \[m/rad\].
    pub rim: S,
}

impl<S: Scalar> TransientShear<S> {
    /// Rate of the displacement \[per s\] under a wheel that touches the soil over an `arc`
    /// \[rad\] and moves with the velocities `drive` (in the order of [`Displacement`]), at
    /// abs(omega) `turning` \[rad/s\], on soil of modulus K \[m\].
    pub fn rate(
        &self,
        displacement: &Displacement<S>,
        drive: &Displacement<S>,
        turning: S,
        arc: S,
        shear_modulus: S,
    ) -> Displacement<S> {
        let half_arc = arc.scale(0.5);
        let scale = self.relaxation.max(half_arc.like(SHORTEST)) * half_arc;
        let stored = displacement.forward - displacement.rim;
        let slip = drive.forward - drive.rim;
        // The mean displacement in units of the longest one, and the speed that slides past it.
        let full =
            (stored * stored + displacement.lateral * displacement.lateral) * half_arc * half_arc
                / (shear_modulus * shear_modulus).scale(LONGEST * LONGEST);
        let speed = (slip * slip + drive.lateral * drive.lateral)
            .offset(1e-18)
            .sqrt();
        let sliding =
            speed * half_arc / shear_modulus.scale(LONGEST) * full * full.offset(1e-12).sqrt();
        let relax =
            |drive: S, value: S, slides: S| (drive - turning * value - sliding * slides) / scale;
        Displacement {
            forward: relax(drive.forward, displacement.forward, stored),
            lateral: relax(drive.lateral, displacement.lateral, displacement.lateral),
            yaw: relax(drive.yaw, displacement.yaw, displacement.yaw),
            rim: relax(drive.rim, displacement.rim, S::constant(0.0)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EFFECT: TransientShear<f64> = TransientShear { relaxation: 1.0 };

    #[test]
    fn the_steady_state_is_the_papers() {
        let (omega, drive) = (
            6.0,
            Displacement {
                forward: 1.4,
                lateral: 0.1,
                yaw: 0.2,
                rim: 1.5,
            },
        );
        let steady = Displacement {
            forward: 1.4 / omega,
            lateral: 0.1 / omega,
            yaw: 0.2 / omega,
            rim: 0.25,
        };
        let rate = EFFECT.rate(&steady, &drive, omega, 0.4, 0.01);
        // Below LONGEST K next to nothing slides: (0.0236 x 0.2 / 0.1)^3.
        assert!(
            rate.forward.abs() < 1e-3 && rate.rim.abs() < 1e-12,
            "{rate:?}"
        );
    }

    #[test]
    fn a_locked_wheel_stores_the_distance_that_it_slides() {
        // Mean displacement J theta_1 / 2 grows with V: dJ/dt = 2 V / theta_1 = 2 x 0.02 / 0.4.
        let still = Displacement {
            forward: 0.0,
            lateral: 0.0,
            yaw: 0.0,
            rim: 0.0,
        };
        let drive = Displacement {
            forward: 0.02,
            ..still
        };
        let rate = EFFECT.rate(&still, &drive, 0.0, 0.4, 0.01);
        assert!((rate.forward - 0.1).abs() < 1e-12, "{rate:?}");
        // At the longest displacement, J = 10 K x 2 / theta_1, it stores no more.
        let full = Displacement {
            forward: 10.0 * 0.01 * 2.0 / 0.4,
            ..still
        };
        let rate = EFFECT.rate(&full, &drive, 0.0, 0.4, 0.01);
        assert!(rate.forward.abs() < 1e-9, "{rate:?}");
    }

    #[test]
    fn nothing_creeps_at_rest() {
        let held = Displacement {
            forward: 0.02,
            lateral: -0.01,
            yaw: 0.003,
            rim: 0.25,
        };
        let rest = Displacement {
            forward: 0.0,
            lateral: 0.0,
            yaw: 0.0,
            rim: 0.0,
        };
        let rate = EFFECT.rate(&held, &rest, 0.0, 0.4, 0.01);
        for value in [rate.forward, rate.lateral, rate.yaw, rate.rim] {
            assert!(value.abs() < 1e-6, "{rate:?}");
        }
    }
}
