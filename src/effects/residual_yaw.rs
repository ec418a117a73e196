//! A yaw moment that nobody has a name for.

use super::declaration::effect;
use super::residual_motion::{ResidualMotion, weighted};
use crate::scalar::Scalar;

effect! {
    /// A yaw moment about the centre of mass: a sum of features of the motion.
    ///
    /// It describes how unknown physics acts, not what it is.
    ResidualYaw: "residual_yaw", Residual(Yaw),
    phrase "an empirical yaw moment",
    lifts "nothing turns the vehicle but what the model names",
    equation "M_Z += m g B (constant + speed u + speed_squared u|u| + direction s(Omega B) + turning q + turning_squared q|q| + speed_turning |u| q + sideways w + speed_sideways u w + slip p + east cos psi + north sin psi), u = V_X / sqrt(g B), w = V_Y / sqrt(g B), q = Omega sqrt(B / g), p = (r (omega_R - omega_L) / 2 - Omega B) / sqrt(g B), s(v) = v / sqrt(v^2 + v_0^2), |x| = x s(x); the bracket within -1 and 1",
    source "dimensional analysis: coefficients of a linear law, to be estimated, in units of the weight m g, gravity g and half the track B",
    check "Look for what turns the vehicle: a brake that drags on one side, an attachment off the middle, a weaker motor.",
    {
        constant ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "A steady moment to the left";
        speed ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the speed";
        speed_squared ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the square of the speed";
        direction ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the direction of the turn, as dry friction (negative)";
        turning ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the yaw rate";
        turning_squared ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the square of the yaw rate";
        speed_turning ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the yaw rate times the speed's size";
        sideways ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the lateral speed";
        speed_sideways ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the speed times the lateral speed, as a wing's moment";
        slip ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the rims' difference in speed that does not turn the vehicle";
        east ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the cosine of the heading", on_map;
        north ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the sine of the heading", on_map;
    }
}

impl<S: Scalar> ResidualYaw<S> {
    /// What the coefficients multiply, in the order of the declaration.
    pub fn features(at: &ResidualMotion<S>) -> [S; 12] {
        let (u, w, q) = (at.ahead, at.aside, at.turn);
        let [north, east] = at.heading;
        [
            S::constant(1.0),
            u,
            u * at.size(u),
            at.sign(q),
            q,
            q * at.size(q),
            at.size(u) * q,
            w,
            u * w,
            at.turn_slip,
            east,
            north,
        ]
    }

    /// Moment to the left as a share of m g B.
    pub fn share(&self, at: &ResidualMotion<S>) -> S {
        weighted(self.to_array(), Self::features(at))
    }
}

#[cfg(test)]
mod tests {
    use super::super::residual_motion::tests::{compare, example};
    use super::*;

    #[test]
    fn features_are_what_they_are_by_hand() {
        // u = 0.61319, w = 0.08176, q = -0.09974, p = 0.01799, psi = 30 deg.
        compare(
            ResidualYaw::features(&example()),
            [
                1.0, 0.61319, 0.37600, -1.0, -0.09974, -0.00995, -0.06116, 0.08176, 0.05013,
                0.01799, 0.86603, 0.5,
            ],
        );
    }
}
