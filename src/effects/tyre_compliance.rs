//! A tyre that flattens where the ground is harder than it.

use super::declaration::effect;
use super::soil::Soil;
use crate::scalar::{Elementary, Scalar};

effect! {
    /// A tyre softer than the ground flattens: it rolls like a rigid wheel of larger radius.
    ///
    /// A rigid wheel stands on the ground with the mean pressure
    /// p_r = k^(1/(2n+1)) (3 W / ((3-n) b sqrt(2r)))^(2n/(2n+1)). Where the tyre's pressure p is
    /// below it, the wheel is replaced by the rigid one whose pressure is p, of radius
    /// r* = (3 W / ((3-n) b))^2 k^(1/n) p^(-(2n+1)/n) / 2; the rim still turns with r omega. W is the load at
    /// rest. Where n is small that may be many million times r, though the contact stays as short as the load
    /// over width and pressure.
    TyreCompliance: "tyre_compliance", Physics,
    lifts "rigid wheels",
    equation "r* = max(r, (3 W / ((3-n) b))^2 k^(1/n) p^(-(2n+1)/n) / 2)",
    source "rigid limit: Wong, Theory of Ground Vehicles, 2.5, after Bekker; the substitute circle: Schmid, J. Terramechanics 32 (1995)",
    {
        pressure ["Pa"] 5000.0..2e6, off 2e6, lognormal(60000.0, 0.6), "Inflation pressure with what the carcass carries; at 2 MPa the wheel is rigid";
    }
}

impl<S: Scalar> TyreCompliance<S> {
    /// Mean pressure under a rigid wheel \[Pa\] that carries `load` \[N\].
    pub fn rigid_limit(soil: &Soil<S>, load: S, radius: S, width: S) -> S {
        let n = soil.exponent;
        let twice = n.scale(2.0);
        let order = twice.offset(1.0);
        let bracket = load.scale(3.0) / (n.like(3.0) - n) / width / radius.scale(2.0).sqrt();
        soil.modulus.raised(n.like(1.0) / order) * bracket.raised(twice / order)
    }

    /// Radius of the wheel that takes its place \[m\], where that is larger.
    pub fn radius(&self, soil: &Soil<S>, load: S, radius: S, width: S) -> S {
        let n = soil.exponent;
        let bracket = load.scale(3.0) / (n.like(3.0) - n) / width;
        let order = n.scale(2.0).offset(1.0);
        let substitute = (bracket * bracket).scale(0.5) * soil.modulus.raised(n.like(1.0) / n)
            / self.pressure.raised(order / n);
        substitute.most(radius).least(radius.scale(LARGEST))
    }
}

/// The substitute wheel is at most so many times as large: beyond, entry angles are near rounding.
const LARGEST: f64 = 1e12;

#[cfg(test)]
mod tests {
    use super::*;

    /// Dry sand under the paper's wheel: k = 0.99 / 0.246 + 1528.43 kN/m^(n+2).
    const SAND: Soil<f64> = Soil {
        cohesion: 1040.0,
        friction: 0.5317,
        modulus: 1_532_454.0,
        exponent: 1.1,
        shear_modulus: 0.01,
    };

    #[test]
    fn the_papers_wheel_on_sand_stands_on_32_kpa() {
        // W = 490 x 9.81 / 8 = 600.9 N, b = 0.246, r = 0.25: k^(1/3.2) = 85.66;
        // (3 x 600.9 / (1.9 x 0.246 x 0.70711))^(2.2/3.2) = 5454.5^0.6875 = 370.9: 31.8 kPa.
        let limit = TyreCompliance::rigid_limit(&SAND, 600.9, 0.25, 0.246);
        assert!((limit / 31.8e3 - 1.0).abs() < 5e-3, "{limit}");
    }

    #[test]
    fn the_substitute_wheel_stands_on_the_tyres_pressure() {
        let tyre = TyreCompliance { pressure: 20e3 };
        let radius = tyre.radius(&SAND, 600.9, 0.25, 0.246);
        assert!(radius > 0.25);
        let limit = TyreCompliance::rigid_limit(&SAND, 600.9, radius, 0.246);
        assert!((limit / 20e3 - 1.0).abs() < 1e-12);
        let hard = TyreCompliance { pressure: 40e3 };
        assert_eq!(hard.radius(&SAND, 600.9, 0.25, 0.246), 0.25);
    }
}
