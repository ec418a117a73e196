//! A tyre that flattens where the ground is harder than it.

use super::StandingWheel;
use super::declaration::effect;
use super::soil::Soil;
use crate::scalar::{Elementary, Scalar};

effect! {
    /// A tyre softer than the ground flattens: it rolls like a rigid wheel of larger radius.
    ///
    /// A rigid wheel stands on the ground with the mean pressure
    /// p_r = k^(1/(2n+1)) (3 W / ((3-n) b sqrt(2r)))^(2n/(2n+1)). Where the tyre's pressure p is
    /// below it, the wheel is replaced by the rigid one whose pressure is p, of radius
    /// r* = (3 W / ((3-n) b))^2 k^(1/n) p^(-(2n+1)/n) / 2; the rim still turns with r omega. Whatever it
    /// carries, that circle sinks equally deep, to z* = (p/k)^(1/n) ((3-n)/(3 I))^(2/(2n+1)) with
    /// I = 2 times the integral of (1-u^2)^n from 1/2 to 1, the stress (3) over a flat arc, front and rear: the tyre sinks no
    /// deeper, and more load makes its contact longer. Where n is small the circle may be many million times as
    /// large as the wheel. z* is that of untouched soil without slip: `slip_sinkage` and ruts do not move it.
    ///
    /// The contact of a soft tyre on stiff clay is so large that the whole cohesion would hold it with several times its
    /// load; no load transfer is in balance with that. Our own bound, set by no measurement:
    /// the cohesion under a tyre is p / 2 at most.
    TyreCompliance: "tyre_compliance", Wheels,
    phrase "tyres that flatten",
    lifts "rigid wheels",
    equation "r* = max(r, (3 W / ((3-n) b))^2 k^(1/n) p^(-(2n+1)/n) / 2), W what the normal stress carries; c = min(c, p / 2)",
    source "rigid limit: Wong, Theory of Ground Vehicles (2001), ch. 2, after Bekker (moderate sinkage, n up to about 1.3); the substitute circle: Schmid, J. Terramechanics 32 (1995)",
    check "Measure the pressure of every tyre, and look how much the tyres flatten under load.",
    formulas differ,
    {
        pressure ["Pa"] 15000.0..2e6, off 2e6, lognormal(60000.0, 0.6), "Inflation pressure with what the carcass carries; 2 MPa switches it off: the wheel is then rigid on any ground", first_step_of(soft);
    }
}

/// A pressure at which tyres are soft on the given soil, as a share of the pressure above which they are rigid there:
/// 60 kPa is rigid on sand, and on clay so flat that no descent leads there.
const SOFT_SHARE: f64 = 0.65;

fn soft(wheel: &StandingWheel) -> f64 {
    let StandingWheel {
        soil,
        load,
        radius,
        width,
    } = wheel;
    SOFT_SHARE * TyreCompliance::rigid_limit(soil, *load, *radius, *width)
}

impl<S: Scalar> TyreCompliance<S> {
    /// Mean pressure under a rigid wheel \[Pa\] that carries `load` \[N\].
    pub fn rigid_limit(soil: &Soil<S>, load: S, radius: S, width: S) -> S {
        let n = soil.exponent;
        let twice = n.scale(2.0);
        let order = twice.offset(1.0);
        let bracket = load.scale(3.0) / (n.like(3.0) - n) / width / radius.scale(2.0).sqrt();
        soil.modulus.powf(n.like(1.0) / order) * bracket.powf(twice / order)
    }

    /// The soil as the tyre shears it.
    pub fn sheared(&self, soil: Soil<S>) -> Soil<S> {
        let adhesion = self.pressure.scale(ADHESION);
        Soil {
            cohesion: soil.cohesion.min(adhesion),
            ..soil
        }
    }

    /// The deepest sinkage z* \[m\]: there the tyre is flat.
    pub fn flat_sinkage(&self, soil: &Soil<S>) -> S {
        let n = soil.exponent;
        let order = n.scale(2.0).offset(1.0);
        let plate = (self.pressure / soil.modulus).powf(n.like(1.0) / n);
        let bekker = (n.like(3.0) - n) / support(n).scale(3.0);
        plate * bekker.powf(n.like(2.0) / order)
    }
}

/// Share of a tyre's pressure with which it adheres to the ground.
const ADHESION: f64 = 0.5;

/// Terms of the series for I: each is less than a quarter of the one before.
const TERMS: u32 = 20;

/// I = 2 integral of (1-u^2)^n from 1/2 to 1 = integral of x^n (1-x/4)^n from 0 to 1, by the binomial series.
fn support<S: Scalar>(n: S) -> S {
    let (mut sum, mut coefficient) = (n.like(0.0), n.like(1.0));
    for k in 0..TERMS {
        let k = f64::from(k);
        sum += coefficient / n.offset(k + 1.0);
        coefficient = coefficient * n.offset(-k).scale(-0.25 / (k + 1.0));
    }
    sum
}

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

    /// I by the midpoint rule.
    fn midpoints(n: f64) -> f64 {
        const COUNT: u32 = 200_000;
        let each = (0..COUNT).map(|k| 0.5 + 0.5 * (f64::from(k) + 0.5) / f64::from(COUNT));
        each.map(|u| (1.0 - u * u).powf(n)).sum::<f64>() / f64::from(COUNT)
    }

    #[test]
    fn the_support_of_a_flat_arc_is_its_integral() {
        for n in [0.1, 0.5, 1.0, 1.4] {
            assert!((support(n) / midpoints(n) - 1.0).abs() < 1e-6, "{n}");
        }
        // 2 (2/3 - 11/24) = 5/12.
        assert!((support(1.0) - 5.0 / 12.0).abs() < 1e-12);
    }

    #[test]
    fn a_soft_tyre_adheres_to_stiff_clay_with_half_its_pressure() {
        let clay = Soil {
            cohesion: 68_950.0,
            ..SAND
        };
        let cohesion = |pressure| TyreCompliance { pressure }.sheared(clay).cohesion;
        assert_eq!([20e3, 100e3, 200e3].map(cohesion), [10e3, 50e3, 68_950.0]);
    }

    #[test]
    fn the_substitute_wheel_stands_on_the_tyres_pressure() {
        let (load, width, pressure) = (600.9, 0.246, 20e3);
        let n = SAND.exponent;
        let bracket = 3.0 * load / ((3.0 - n) * width);
        let order = (2.0 * n + 1.0) / n;
        let circle =
            0.5 * bracket.powi(2) * SAND.modulus.powf(1.0 / n) * f64::powf(pressure, -order);
        let limit = TyreCompliance::rigid_limit(&SAND, load, circle, width);
        assert!(circle > 0.25 && (limit / pressure - 1.0).abs() < 1e-12);
        // It carries the load, k b (r*/2)^n r* theta^(2n+1) I, where it has sunk to z*.
        let sinkage = TyreCompliance { pressure }.flat_sinkage(&SAND);
        let entry = (2.0 * sinkage / circle).sqrt();
        let carried = SAND.modulus * width * sinkage.powf(n) * circle * entry * midpoints(n);
        assert!((carried / load - 1.0).abs() < 1e-5);
    }
}
