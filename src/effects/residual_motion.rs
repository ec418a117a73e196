//! A vehicle's motion in dimensionless numbers: what residual models are built from.

use crate::scalar::{Elementary, Scalar};

/// Motion in units of gravity g and half the track B: velocities over sqrt(g B), angular speeds
/// times sqrt(B / g).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResidualMotion<S> {
    /// Speed ahead, u = V_X / sqrt(g B).
    pub ahead: S,
    /// Speed to the left, w = V_Y / sqrt(g B).
    pub aside: S,
    /// Yaw rate counter-clockwise, q = Omega sqrt(B / g).
    pub turn: S,
    /// Mean speed of the rims over the ground, ((r omega)_L + (r omega)_R) / 2 - V_X, over sqrt(g B).
    pub slip: S,
    /// The same of the turn, ((r omega)_R - (r omega)_L) / 2 - Omega B, over sqrt(g B).
    pub turn_slip: S,
    /// Sine and cosine of the heading: a step ahead goes so far north and east.
    pub heading: [S; 2],
    /// Speed over sqrt(g B) below which signs fade.
    fading: S,
}

/// What a [`ResidualMotion`] is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unscaled<S> {
    /// V_X and V_Y \[m/s\].
    pub velocity: [S; 2],
    /// Omega \[rad/s\].
    pub yaw_rate: S,
    /// Speeds of the left and the right rims, r omega \[m/s\].
    pub rims: [S; 2],
    /// Half the distance between the wheels' planes, B \[m\].
    pub half_track: S,
    /// Heading, counter-clockwise from east \[rad\].
    pub heading: S,
}

impl<S: Scalar> ResidualMotion<S> {
    /// Scales a motion under gravity \[m/s^2\]; signs fade below the speed `fading` \[m/s\].
    pub fn new(motion: &Unscaled<S>, gravity: f64, fading: f64) -> Self {
        let half_track = motion.half_track;
        let per_speed = half_track.scale(gravity).inverse_sqrt();
        let scaled = |speed: S| speed * per_speed;
        let [left, right] = motion.rims;
        let around = motion.yaw_rate * half_track;
        let (sin, cos) = motion.heading.sin_cos();
        Self {
            ahead: scaled(motion.velocity[0]),
            aside: scaled(motion.velocity[1]),
            turn: scaled(around),
            slip: scaled((left + right).scale(0.5) - motion.velocity[0]),
            turn_slip: scaled((right - left).scale(0.5) - around),
            heading: [sin, cos],
            fading: per_speed.scale(fading),
        }
    }

    /// The sign of a speed, s(v) = v / sqrt(v^2 + v_0^2): it fades towards standstill.
    pub(super) fn sign(&self, speed: S) -> S {
        speed * (speed * speed + self.fading * self.fading).inverse_sqrt()
    }

    /// The size of a speed, s(v) v, without a kink.
    pub(super) fn size(&self, speed: S) -> S {
        self.sign(speed) * speed
    }
}

/// Share of the vehicle's weight (of m g B for a moment) that a residual model is worth at most: outside the motion
/// that it was fitted to, a force that grows with the speed would drive itself.
const LARGEST_SHARE: f64 = 1.0;

/// Sum of features times coefficients, within [`LARGEST_SHARE`].
pub(super) fn weighted<S: Scalar, const N: usize>(coefficients: [S; N], features: [S; N]) -> S {
    let pairs = coefficients.into_iter().zip(features);
    let sum = pairs.fold(S::constant(0.0), |sum, (coefficient, feature)| {
        sum + coefficient * feature
    });
    let (low, high) = (S::constant(-LARGEST_SHARE), S::constant(LARGEST_SHARE));
    low.max(high.min(sum))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// B = 0.61 m: sqrt(9.81 x 0.61) = 2.446242 m/s. Turning right ahead and to the left, heading 30 deg.
    pub fn example() -> ResidualMotion<f64> {
        let motion = Unscaled {
            velocity: [1.5, 0.2],
            yaw_rate: -0.4,
            rims: [2.0, 1.6],
            half_track: 0.61,
            heading: 30.0_f64.to_radians(),
        };
        ResidualMotion::new(&motion, 9.81, 1e-6)
    }

    /// Compares features with numbers by hand, rounded to the fifth decimal.
    pub fn compare<const N: usize>(found: [f64; N], by_hand: [f64; N]) {
        for (index, (found, expected)) in found.iter().zip(by_hand).enumerate() {
            assert!(
                (found - expected).abs() < 6e-6,
                "feature {index}: {found} {expected}"
            );
        }
    }

    #[test]
    fn each_coefficient_weighs_its_own_feature() {
        use crate::effects::{ResidualLateral, ResidualLongitudinal, ResidualYaw};
        let at = example();
        macro_rules! check {
            ($($effect:ident),*) => {$(
                for (index, feature) in $effect::features(&at).into_iter().enumerate() {
                    let mut coefficients = $effect::<f64>::DECLARATION.parameters.iter().map(|_| 0.0).collect::<Vec<_>>();
                    coefficients[index] = -0.2;
                    let share = $effect::from_slice(&coefficients).share(&at);
                    assert!((share + 0.2 * feature).abs() < 1e-15, "{index}");
                }
            )*};
        }
        check!(ResidualLateral, ResidualLongitudinal, ResidualYaw);
    }

    #[test]
    fn motions_are_scaled_by_gravity_and_half_the_track() {
        let at = example();
        compare(
            [at.ahead, at.aside, at.turn, at.slip, at.turn_slip],
            [0.61319, 0.08176, -0.09974, 0.12264, 0.01799],
        );
    }

    #[test]
    fn no_law_is_worth_more_than_the_weight() {
        let sum = |coefficients: [f64; 2]| weighted(coefficients, [10.0, 1.0]);
        assert_eq!(sum([0.05, 0.25]), 0.75);
        assert_eq!((sum([0.3, 0.0]), sum([-0.3, 0.0])), (1.0, -1.0));
        assert!(sum([f64::NAN, 0.0]).is_nan());
    }

    #[test]
    fn signs_fade_at_the_speed_that_the_drawbar_s_does() {
        let motion = Unscaled {
            velocity: [0.01, -0.01],
            yaw_rate: 0.0,
            rims: [0.0; 2],
            half_track: 0.61,
            heading: 0.0,
        };
        let at = ResidualMotion::new(&motion, 9.81, 0.01);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert!((at.sign(at.ahead) - half).abs() < 1e-12);
        assert!((at.sign(at.aside) + half).abs() < 1e-12);
        assert!((at.size(at.aside) + at.aside * half).abs() < 1e-12);
        assert_eq!((at.sign(at.turn), at.size(at.turn)), (0.0, 0.0));
    }
}
