//! Soil pushed ahead of a wheel's side and front.

use super::declaration::effect;
use super::soil::Soil;
use crate::scalar::{Elementary, Scalar};

effect! {
    /// The buried flank of a wheel that slides sideways pushes a wedge of soil ahead of it, the
    /// front of a wheel a smaller one.
    ///
    /// Hegedus' resistance of a vertical blade of unit width at depth h,
    /// R_b = D1 (c h + D2 gamma h^2 / 2), D1 = cot X_c + tan(X_c + phi),
    /// D2 = cot X_c + cot^2 X_c / cot phi with X_c = 45 deg - phi/2. As tan(X_c + phi) =
    /// tan(45 deg + phi/2) = cot X_c = q = sqrt(1 + tan^2 phi) + tan phi, these are D1 = 2 q and
    /// D2 = q + q^2 tan phi. Passive earth pressure by Rankine, 2 c q + gamma h q^2 for each metre
    /// of depth, integrates to 2 q c h + q^2 gamma h^2 / 2: the same term in c, and a
    /// resistance of the weight that is 2 D2 / q = 2 (1 + q tan phi) times as large.
    ///
    /// The blades of the flank stand side by side along X = r sin theta, so each is
    /// dX = r cos theta dtheta wide. The source has r - h cos theta in its place, which is nearly
    /// nothing below the axle of a wheel that is buried to it; against a measured wheel both do
    /// about as well (docs/explanation/single_wheel.md).
    Bulldozing: "bulldozing", Wheels,
    phrase "soil pushed ahead and aside by the wheels",
    lifts "no bulldozing",
    equation "F_Y = -lateral int R_b(h) r cos theta sin(beta) dtheta, F_X = -frontal b R_b(h_0) cos(beta); R_b = D1 (c h + D2 gamma h^2 / 2), sin(beta) = V_Y / |V|",
    source "Ishigami, Miwa, Nagatani, Yoshida, J. Field Robotics 24 (2007), after Hegedus 1960; the width of the blades by geometry",
    check "Measure the depth of the ruts in a turn, and look for soil heaped ahead of and beside the wheels.",
    formulas differ,
    {
        lateral ["1"] 0.0..30.0, off 0.0, lognormal(1.0, 1.2), "Strength of the lateral wedge, 1 as in the source";
        frontal ["1"] 0.0..30.0, off 0.0, lognormal(0.3, 1.2), "Strength of the frontal wedge, 1 for a blade as deep as the wheel";
        unit_weight ["N/m^3"] 5000.0..30000.0, shape 16000.0, lognormal(16000.0, 0.15), "Unit weight gamma of the soil";
    }
}

impl<S: Scalar> Bulldozing<S> {
    /// R_b(h) of a blade of unit width at depth `depth` \[N/m\].
    #[inline(always)]
    pub fn blade_resistance(&self, soil: &Soil<S>, depth: S) -> S {
        let t = soil.friction;
        let q = (t * t).offset(1.0).sqrt() + t;
        let weight = (q + q * q * t) * self.unit_weight * depth.scale(0.5);
        (q * depth).scale(2.0) * (soil.cohesion + weight)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOIL: Soil<f64> = Soil {
        cohesion: 800.0,
        friction: 0.577_350_269_189_625_8,
        modulus: 1e6,
        exponent: 1.0,
        shear_modulus: 0.01,
    };

    #[test]
    fn thirty_degrees_by_hand() {
        // X_c = 30 deg: cot = 1.73205, tan(60 deg) = 1.73205: D1 = 3.46410;
        // D2 = 1.73205 + 3 x 0.57735 = 3.46410. At h = 0.02 m, gamma = 16 kN/m^3:
        // 3.46410 (800 x 0.02 + 3.46410 x 16000 x 0.0004 / 2) = 3.46410 x 27.0851 = 93.825 N/m.
        let effect = Bulldozing {
            lateral: 1.0,
            frontal: 0.0,
            unit_weight: 16000.0,
        };
        let found = effect.blade_resistance(&SOIL, 0.02);
        assert!((found - 93.825).abs() < 1e-3, "{found}");
    }

    #[test]
    fn without_friction_only_cohesion_and_hydrostatic_weight_remain() {
        let effect = Bulldozing {
            lateral: 1.0,
            frontal: 0.0,
            unit_weight: 16000.0,
        };
        let clay = Soil {
            friction: 0.0,
            ..SOIL
        };
        let found = effect.blade_resistance(&clay, 0.1);
        assert!((found - 2.0 * (800.0 * 0.1 + 80.0)).abs() < 1e-9);
        assert_eq!(effect.blade_resistance(&SOIL, 0.0), 0.0);
    }
}
