//! Drag that grows with the square of the speed.

use super::declaration::effect;
use crate::scalar::{Elementary, Scalar};

effect! {
    /// Quadratic drag at the centre of mass, of air, water or high grass.
    Drag: "drag", Body,
    phrase "drag that grows with the square of the speed",
    lifts "no aerodynamic force",
    equation "F = -k |V| V, k = rho C_d A / 2 for air (about 0.7 for a plate of a square metre); the prior spans water and high grass",
    source "quadratic drag; Wong, Theory of Ground Vehicles, 3.2",
    check "Look for what resists more at speed: wind, water, high grass, or something that is dragged along.",
    formulas differ,
    {
        coefficient ["N s^2/m^2"] 0.0..1000.0, off 0.0, lognormal(10.0, 1.5), "Coefficient k";
    }
}

impl<S: Scalar> Drag<S> {
    /// Force along X and Y \[N\] at the velocity `v` \[m/s\].
    pub fn force(&self, v: [S; 2]) -> [S; 2] {
        // The root of the square is smooth enough times the velocity; the floor keeps its slope.
        let speed = (v[0] * v[0] + v[1] * v[1]).offset(1e-24).sqrt();
        v.map(|v| -self.coefficient * speed * v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_metre_of_plate_in_air() {
        // rho C_d A / 2 = 1.225 x 1.2 x 1 / 2 = 0.735; at (3, 4) m/s: 18.375 N against the motion.
        let force = Drag { coefficient: 0.735 }.force([3.0, 4.0]);
        assert!((force[0] + 11.025).abs() < 1e-9 && (force[1] + 14.7).abs() < 1e-9);
        assert_eq!(Drag { coefficient: 5.0 }.force([0.0, 0.0]), [0.0, 0.0]);
    }
}
