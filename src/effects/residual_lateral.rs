//! A force to the side that nobody has a name for.

use super::declaration::effect;
use super::residual_motion::{ResidualMotion, weighted};
use crate::scalar::Scalar;

effect! {
    /// A force along the body's Y axis at the centre of mass: a sum of features of the motion.
    ///
    /// It describes how unknown physics acts, not what it is.
    ResidualLateral: "residual_lateral", Residual(Lateral),
    phrase "an empirical force across the vehicle",
    lifts "nothing acts across the vehicle but what the model names",
    equation "F_Y += m g (constant + direction s(V_Y) + sideways w + sideways_squared w|w| + turning q + turning_squared q|q| + speed_turning u q + slip p + north cos psi - east sin psi), u = V_X / sqrt(g B), w = V_Y / sqrt(g B), q = Omega sqrt(B / g), p = (r (omega_R - omega_L) / 2 - Omega B) / sqrt(g B), s(v) = v / sqrt(v^2 + v_0^2), |x| = x s(x); the bracket within -1 and 1",
    source "dimensional analysis: coefficients of a linear law, to be estimated, in units of the weight m g, gravity g and half the track B",
    check "Look for what pushes the vehicle sideways: wind, a taut cable, an attachment that rubs, a side slope.",
    {
        constant ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "A steady push to the left";
        direction ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the direction of the lateral speed, as dry friction (negative)";
        sideways ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the lateral speed";
        sideways_squared ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the square of the lateral speed";
        turning ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the yaw rate";
        turning_squared ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the square of the yaw rate";
        speed_turning ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the speed times the yaw rate, as a centrifugal force";
        slip ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the rims' difference in speed that does not turn the vehicle";
        east ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "A push towards the east", on_map;
        north ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "A push towards the north", on_map;
    }
}

impl<S: Scalar> ResidualLateral<S> {
    /// What the coefficients multiply, in the order of the declaration.
    pub fn features(at: &ResidualMotion<S>) -> [S; 10] {
        let (u, w, q) = (at.ahead, at.aside, at.turn);
        let [sin, cos] = at.heading;
        [
            S::constant(1.0),
            at.sign(w),
            w,
            w * at.size(w),
            q,
            q * at.size(q),
            u * q,
            at.turn_slip,
            -sin,
            cos,
        ]
    }

    /// Force to the left as a share of the weight m g.
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
            ResidualLateral::features(&example()),
            [
                1.0, 1.0, 0.08176, 0.00668, -0.09974, -0.00995, -0.06116, 0.01799, -0.5, 0.86603,
            ],
        );
    }
}
