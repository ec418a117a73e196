//! A slipping wheel digs itself in.

use super::declaration::effect;
use super::soil::Soil;
use crate::scalar::{Elementary, Scalar};

effect! {
    /// The sinkage grows with the slip, by a larger exponent or by a factor.
    ///
    /// The factor on the sinkage at equal pressure is a factor on the modulus:
    /// p = k z^n / f^n0 with Lyasko's f = (1 + S s)/(1 - S s / 2). The slip s is the speed at which
    /// the rim slides over the soil in both directions, as a share of the larger of the rim's speed
    /// and the wheel's: 0 where it rolls, 1 where it is locked or spins on the spot. Straight
    /// ahead it is abs(i); on a measured wheel the sinkage at slip angles up to 45 deg follows it
    /// and not abs(i) (docs/explanation/single_wheel.md). Where both speeds vanish it fades, and where
    /// the rim runs against the travel it stays as on a locked wheel.
    SlipSinkage: "slip_sinkage", Wheels,
    phrase "wheels that dig in as they slip",
    lifts "sigma from the static sinkage",
    equation "p = k z^n / f^n0, n = n0 + n1 s, f = (1 + S s)/(1 - S s/2); s = sqrt((r omega - V_X)^2 + V_Y^2)/max(abs(r omega), abs(V)), rounded off within 0.01 of 0, held from 1 on",
    source "n1: Ding et al., J. Terramechanics 48 (2011); f with S = 1: Lyasko, J. Terramechanics 47 (2010), there of a wheel's sinkage under its load, here of a plate's under its pressure; s across the wheel as well: data of Pavlov, CMU 2022 (the project's docs/explanation/single_wheel.md)",
    check "Let the vehicle pull against an obstacle, and measure how much deeper its wheels dig in.",
    formulas differ,
    {
        exponent_growth ["1"] 0.0..1.0, off 0.0, lognormal(0.2, 0.8), "Growth n1 of the sinkage exponent with the slip s";
        sinkage_growth ["1"] 0.0..1.4, off 0.0, lognormal(0.8, 0.5), "Growth S of the sinkage at equal pressure with the slip s";
    }
}

/// How far beyond 1 a slip goes in the end that is held from there on.
const HELD_WITHIN: f64 = 0.1;

/// abs(i) of a wheel with the rim speed r omega and the forward speed V \[m/s\], both speeds
/// rounded off within `width` \[m/s\] of zero.
#[inline(always)]
pub fn absolute_slip<S: Scalar>(rim_speed: S, forward: S, width: f64) -> S {
    let slip = (rim_speed - forward)
        / larger(
            rim_speed.rounded_abs(width),
            forward.rounded_abs(width),
            width,
        );
    // Rounded off within one per cent, and zero at zero.
    slip.rounded_abs(0.01).offset(-0.01)
}

/// The slip s along and across a wheel with the rim speed r omega, the forward speed V_X and the
/// lateral speed V_Y \[m/s\]: [`absolute_slip`] where V_Y is zero, held from 1 on.
#[inline(always)]
pub fn whole_slip<S: Scalar>(rim_speed: S, forward: S, lateral: S, width: f64) -> S {
    let travel = (forward * forward + lateral * lateral)
        .offset(width * width)
        .sqrt();
    let largest = larger(rim_speed.rounded_abs(width), travel, width);
    let (along, across) = ((rim_speed - forward) / largest, lateral / largest);
    let slip = (along * along + across * across)
        .offset(0.01 * 0.01)
        .sqrt()
        .offset(-0.01);
    if slip.value() <= 1.0 {
        return slip;
    }
    let beyond = slip.offset(-1.0).scale(-1.0 / HELD_WITHIN).decay();
    beyond.scale(-HELD_WITHIN).offset(1.0 + HELD_WITHIN)
}

/// The larger of two speeds, rounded off where they are equal within `width`.
#[inline(always)]
fn larger<S: Scalar>(first: S, second: S, width: f64) -> S {
    (first + second + (first - second).rounded_abs(width)).scale(0.5)
}

impl<S: Scalar> SlipSinkage<S> {
    /// The soil under a wheel with the slip s.
    #[inline(always)]
    pub fn soil(&self, soil: &Soil<S>, slip: S) -> Soil<S> {
        let growth = self.sinkage_growth * slip;
        let deeper = growth.offset(1.0) / growth.scale(-0.5).offset(1.0);
        Soil {
            modulus: soil.modulus / deeper.powf(soil.exponent),
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
        // S = 0.5 at s = 0.6: 1.3 / 0.85 = 1.529412 times as deep.
        let effect = SlipSinkage {
            exponent_growth: 0.0,
            sinkage_growth: 0.5,
        };
        let slipped = effect.soil(&SOIL, 0.6);
        let depth = |soil: &Soil<f64>| (20e3 / soil.modulus).powf(1.0 / soil.exponent);
        assert!((depth(&slipped) / depth(&SOIL) - 1.3 / 0.85).abs() < 1e-12);
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

    #[test]
    fn sideways_sliding_is_slip_as_well() {
        let width = 1e-6;
        let slip = |rim, forward, lateral| whole_slip(rim, forward, lateral, width);
        // Straight ahead it is the longitudinal slip, driven, braked and backwards.
        for (rim, forward) in [
            (2.0, 1.0),
            (1.0, 2.0),
            (-2.0, -1.0),
            (0.0, 1.0),
            (1.0, 0.0),
            (0.0, 0.0),
        ] {
            assert_eq!(slip(rim, forward, 0.0), absolute_slip(rim, forward, width));
        }
        // 30 deg and a rim as fast as the wheel: sqrt((1 - 0.866025)^2 + 0.25) = 0.517638.
        let (sin, cos) = std::f64::consts::FRAC_PI_6.sin_cos();
        for side in [sin, -sin] {
            assert!((slip(1.0, cos, side) - 0.507_735).abs() < 2e-5);
        }
        // A locked wheel slips wholly in whatever direction it is drawn.
        assert!((slip(0.0, cos, sin) - slip(0.0, 1.0, 0.0)).abs() < 1e-5);
    }

    #[test]
    fn a_rim_against_the_travel_slips_little_more_than_a_locked_wheel() {
        let slip = |rim: f64| whole_slip(rim, 1.0, 0.0, 1e-6);
        assert!(slip(-1.0) > slip(-0.1) && slip(-1.0) < 1.0 + HELD_WITHIN);
        // Both sides of the bend meet with the same slope.
        let (before, bend, after) = (slip(-0.0090), slip(-0.0100), slip(-0.0110));
        assert!(((after - bend) - (bend - before)).abs() < 0.02 * (after - bend));
    }
}
