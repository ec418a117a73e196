//! A force ahead that nobody has a name for.

use super::declaration::effect;
use super::residual_motion::{ResidualMotion, weighted};
use crate::scalar::Scalar;

effect! {
    /// A force along the body's X axis at the centre of mass: a sum of features of the motion.
    ///
    /// It describes how unknown physics acts, not what it is.
    ResidualLongitudinal: "residual_longitudinal", Residual(Longitudinal),
    phrase "an empirical force along the vehicle",
    lifts "nothing acts along the vehicle but what the model names",
    equation "F_X += m g (constant + direction s(V_X) + speed u + speed_squared u|u| + turning s(V_X)|q| + turning_squared s(V_X) q^2 + speed_turning u|q| + sideways_turning w q + slip p + slip_squared p|p| + east cos psi + north sin psi), u = V_X / sqrt(g B), w = V_Y / sqrt(g B), q = Omega sqrt(B / g), p = (r (omega_L + omega_R) / 2 - V_X) / sqrt(g B), s(v) = v / sqrt(v^2 + v_0^2), |x| = x s(x); the bracket within -1 and 1",
    source "dimensional analysis: coefficients of a linear law, to be estimated, in units of the weight m g, gravity g and half the track B",
    check "Look for what pushes or brakes along the vehicle: a brake that drags, a cable, an attachment, wind.",
    {
        constant ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "A steady push ahead";
        direction ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the direction of travel, as dry friction (negative)";
        speed ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the speed";
        speed_squared ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the square of the speed";
        turning ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "In the direction of travel, with the yaw rate's size";
        turning_squared ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "In the direction of travel, with the square of the yaw rate";
        speed_turning ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the speed times the yaw rate's size";
        sideways_turning ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the lateral speed times the yaw rate, as an added mass";
        slip ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the rims' mean speed over the ground";
        slip_squared ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "With the square of the rims' mean speed over the ground";
        east ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "A push towards the east", on_map;
        north ["1"] -0.3..0.3, off 0.0, normal(0.0, 0.05), "A push towards the north", on_map;
    }
}

impl<S: Scalar> ResidualLongitudinal<S> {
    /// What the coefficients multiply, in the order of the declaration.
    pub fn features(at: &ResidualMotion<S>) -> [S; 12] {
        let (u, w, q, slip) = (at.ahead, at.aside, at.turn, at.slip);
        let [north, east] = at.heading;
        [
            S::constant(1.0),
            at.sign(u),
            u,
            u * at.size(u),
            at.sign(u) * at.size(q),
            at.sign(u) * q * q,
            u * at.size(q),
            w * q,
            slip,
            slip * at.size(slip),
            east,
            north,
        ]
    }

    /// Force ahead as a share of the weight m g.
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
        // u = 0.61319, w = 0.08176, q = -0.09974, p = 0.12264, psi = 30 deg.
        compare(
            ResidualLongitudinal::features(&example()),
            [
                1.0, 1.0, 0.61319, 0.37600, 0.09974, 0.00995, 0.06116, -0.00815, 0.12264, 0.01504,
                0.86603, 0.5,
            ],
        );
    }
}
