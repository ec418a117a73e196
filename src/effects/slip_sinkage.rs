//! A slipping wheel digs itself in.

use super::declaration::effect;
use super::soil::Soil;
use crate::scalar::{Elementary, Scalar};

effect! {
    /// The sinkage grows with the slip, by a larger exponent or by a factor.
    ///
    /// The factor on the sinkage at equal pressure is a factor on the modulus:
    /// p = k (z / (1 + S abs(i)))^n. The slip i = (r omega - V) / max(abs(r omega), abs(V)) lies
    /// between -1 (locked) and 1 (spinning on the spot); where both speeds vanish it fades.
    SlipSinkage: "slip_sinkage", Physics,
    lifts "sigma from the static sinkage",
    equation "n = n0 + n1 abs(i); z = z0 (1 + S abs(i))",
    source "n1: Ding et al., J. Terramechanics 48 (2011); S: linear slip-sinkage after Lyasko, J. Terramechanics 47 (2010)",
    {
        exponent_growth ["1"] 0.0..1.0, off 0.0, lognormal(0.2, 0.8), "Growth n1 of the sinkage exponent with abs(i)";
        sinkage_growth ["1"] 0.0..2.0, off 0.0, lognormal(0.5, 0.6), "Growth S of the sinkage with abs(i)";
    }
}

/// abs(i) of a wheel with the rim speed r omega and the forward speed V \[m/s\], both speeds
/// rounded off within `width` \[m/s\] of zero.
#[inline(always)]
pub fn absolute_slip<S: Scalar>(rim_speed: S, forward: S, width: f64) -> S {
    let (rim, travel) = (rim_speed.rounded_abs(width), forward.rounded_abs(width));
    let largest = (rim + travel + (rim - travel).rounded_abs(width)).scale(0.5);
    let slip = (rim_speed - forward) / largest;
    // Rounded off within one per cent, and zero at zero.
    slip.rounded_abs(0.01).offset(-0.01)
}

impl<S: Scalar> SlipSinkage<S> {
    /// The soil under a wheel with the slip abs(i).
    #[inline(always)]
    pub fn soil(&self, soil: &Soil<S>, slip: S) -> Soil<S> {
        let deeper = (self.sinkage_growth * slip).offset(1.0);
        Soil {
            modulus: soil.modulus / deeper.raised(soil.exponent),
            exponent: soil.exponent + self.exponent_growth * slip,
            ..*soil
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOIL: Soil<f64> = Soil {
        cohesion: 800.0,
        friction: 0.5,
        modulus: 1e6,
        exponent: 1.1,
        shear_modulus: 0.01,
    };

    #[test]
    fn a_plate_under_the_same_pressure_sinks_by_the_factor() {
        // S = 0.5 at i = 0.6: 1.3 times as deep.
        let effect = SlipSinkage {
            exponent_growth: 0.0,
            sinkage_growth: 0.5,
        };
        let slipped = effect.soil(&SOIL, 0.6);
        let depth = |soil: &Soil<f64>| (20e3 / soil.modulus).powf(1.0 / soil.exponent);
        assert!((depth(&slipped) / depth(&SOIL) - 1.3).abs() < 1e-12);
    }

    #[test]
    fn slip_has_the_definitions_limits() {
        let width = 1e-6;
        let slip = |rim, travel| absolute_slip(rim, travel, width);
        assert!((slip(2.0, 1.0) - 0.49).abs() < 2e-4);
        assert!((slip(1.0, 2.0) - 0.49).abs() < 2e-4);
        assert!((slip(-2.0, -1.0) - slip(2.0, 1.0)).abs() < 1e-12);
        assert!((slip(0.0, 1.0) - 0.99).abs() < 1e-4);
        assert_eq!(slip(0.0, 0.0), 0.0);
        assert!(slip(1.0, -1.0) > 1.9);
    }
}
