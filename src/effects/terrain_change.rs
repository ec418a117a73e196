//! Another soil beyond a boundary.

use super::declaration::effect;
use super::soil::Soil;
use crate::scalar::{Elementary, Scalar};

effect! {
    /// A second soil, as factors of the first, beyond a moment, a distance, or a line on the map.
    ///
    /// A wheel's soil passes from one to the other by the quintic step, in the logarithms of its
    /// parameters.
    TerrainChange: "terrain_change", SoilByPlace,
    phrase "a change of soil on the way",
    lifts "homogeneous ground",
    equation "c, tan phi, k, K times factor^w, w the quintic step of (u - position) / transition; u the time, the distance driven, or the wheel's x cos(direction) + y sin(direction)",
    source "modelling assumption: soil parameters vary monotonously across a boundary of finite width",
    check "Look at the ground on both sides of the boundary: soil, moisture, vegetation.",
    formulas differ,
    {
        cohesion_factor ["1"] 0.02..50.0, off 1.0, lognormal(1.0, 0.7), "Cohesion beyond the boundary, as a factor";
        friction_factor ["1"] 0.1..5.0, off 1.0, lognormal(1.0, 0.3), "tan(phi) beyond the boundary, as a factor";
        stiffness_factor ["1"] 0.02..50.0, off 1.0, lognormal(1.0, 0.7), "Sinkage modulus k beyond the boundary, as a factor";
        shear_modulus_factor ["1"] 0.1..10.0, off 1.0, lognormal(1.0, 0.5), "Shear deformation modulus K beyond the boundary, as a factor";
        position ["s or m"] -1e6..1e6, shape 0.0, normal(0.0, 100.0), "Where the boundary lies: a time, a distance driven, or the line's distance from the origin";
        direction ["rad"] -7.0..7.0, shape 0.0, normal(0.0, 2.0), "Direction from the first soil to the second, counter-clockwise from east (a line on the map)";
        transition ["s or m"] 1e-3..1e3, shape 0.5, lognormal(0.5, 0.7), "Half the width of the transition";
    }
}

/// What the boundary is measured over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Boundary {
    /// The simulated time \[s\].
    Time,
    /// The distance that the vehicle has driven \[m\].
    Distance,
    /// A line on the map \[m\].
    #[default]
    Place,
}

impl<S: Scalar> TerrainChange<S> {
    /// How far a point lies beyond the boundary, from 0 (first soil) to 1 (second).
    pub fn share(&self, boundary: Boundary, time: S, distance: S, place: [S; 2]) -> S {
        let along = match boundary {
            Boundary::Time => time,
            Boundary::Distance => distance,
            Boundary::Place => {
                let (sin, cos) = self.direction.sin_cos();
                place[0] * cos + place[1] * sin
            }
        };
        ((along - self.position) / self.transition).smooth_step()
    }

    /// The soil at a share of the way from the first to the second.
    pub fn soil(&self, first: &Soil<S>, share: S) -> Soil<S> {
        let factor = |factor: S| (factor.ln() * share).exp();
        Soil {
            cohesion: first.cohesion * factor(self.cohesion_factor),
            friction: first.friction * factor(self.friction_factor),
            modulus: first.modulus * factor(self.stiffness_factor),
            shear_modulus: first.shear_modulus * factor(self.shear_modulus_factor),
            exponent: first.exponent,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHANGE: TerrainChange<f64> = TerrainChange {
        cohesion_factor: 4.0,
        friction_factor: 0.5,
        stiffness_factor: 9.0,
        shear_modulus_factor: 0.25,
        position: 2.0,
        direction: std::f64::consts::FRAC_PI_2,
        transition: 0.5,
    };
    const SOIL: Soil<f64> = Soil {
        cohesion: 1000.0,
        friction: 0.5,
        modulus: 1e6,
        exponent: 1.0,
        shear_modulus: 0.01,
    };

    #[test]
    fn the_boundary_divides_the_map() {
        let share = |y| CHANGE.share(Boundary::Place, 0.0, 0.0, [77.0, y]);
        assert_eq!((share(1.5), share(2.5)), (0.0, 1.0));
        assert!((share(2.0) - 0.5).abs() < 1e-12);
        assert_eq!(CHANGE.share(Boundary::Time, 3.0, 0.0, [0.0; 2]), 1.0);
        assert_eq!(CHANGE.share(Boundary::Distance, 3.0, 1.0, [0.0; 2]), 0.0);
    }

    #[test]
    fn half_way_lies_the_geometric_mean() {
        let middle = CHANGE.soil(&SOIL, 0.5);
        assert!((middle.cohesion - 2000.0).abs() < 1e-9);
        assert!((middle.modulus - 3e6).abs() < 1e-6);
        assert!((middle.shear_modulus - 0.005).abs() < 1e-15);
        let before = CHANGE.soil(&SOIL, 0.0);
        assert_eq!(before, SOIL);
    }
}
