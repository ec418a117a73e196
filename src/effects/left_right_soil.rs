//! Soil that differs between the sides.

use super::declaration::effect;
use super::soil::Soil;
use crate::scalar::{Elementary, Scalar};

effect! {
    /// The left wheels run on stronger soil than the right ones, or on weaker.
    LeftRightSoil: "left_right_soil", Wheels,
    phrase "different soil left and right",
    lifts "homogeneous ground across the track",
    equation "c, tan phi and k times sqrt(ratio) on the left, over sqrt(ratio) on the right",
    source "modelling assumption: the geometric mean of both sides is the terrain",
    check "Compare the ruts of the left and the right wheels, and the tyre pressures of both sides.",
    class Ground,
    formulas differ,
    {
        ratio ["1"] 0.1..10.0, off 1.0, lognormal(1.0, 0.4), "Strength and stiffness of the left soil over the right one's";
    }
}

impl<S: Scalar> LeftRightSoil<S> {
    /// The soil under a wheel on the left, or on the right.
    #[inline(always)]
    pub fn soil(&self, soil: &Soil<S>, left: bool) -> Soil<S> {
        let root = self.ratio.sqrt();
        let factor = if left { root } else { S::constant(1.0) / root };
        Soil {
            cohesion: soil.cohesion * factor,
            friction: soil.friction * factor,
            modulus: soil.modulus * factor,
            ..*soil
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sides_differ_by_the_ratio_and_keep_their_mean() {
        let soil = Soil {
            cohesion: 900.0,
            friction: 0.6,
            modulus: 4e5,
            exponent: 1.0,
            shear_modulus: 0.01,
        };
        let effect = LeftRightSoil { ratio: 2.25 };
        let (left, right) = (effect.soil(&soil, true), effect.soil(&soil, false));
        assert!((left.cohesion - 1350.0).abs() < 1e-9);
        assert!((left.friction / right.friction - 2.25).abs() < 1e-12);
        assert!((left.modulus * right.modulus - 1.6e11).abs() < 1.0);
    }
}
