//! A load in tow.

use super::declaration::effect;
use crate::scalar::{Elementary, Scalar};

effect! {
    /// A dragged load pulls at the hitch against the hitch's motion.
    ///
    /// The force fades below the regularisation's travel speed, so that it does not push a vehicle
    /// at rest. Above or below the centre of mass it shifts load between the rows.
    Drawbar: "drawbar", Body,
    phrase "a towed load",
    lifts "no drawbar force",
    equation "F = -D v_h / sqrt(|v_h|^2 + v_0^2), v_h = (V_X, V_Y + Omega x_h) at the hitch; M_Z += x_h F_Y; sum X F_Z += (h_h - h) F_X, sum Y F_Z += (h_h - h) F_Y; x_h = -(d + hitch_behind), d that of the centre of mass ahead of the centroid, h_h the hitch's height, h that of the centre of mass; about the centre of mass as it is with payload and com_shift",
    source "dry friction of a dragged load; moments about the centre of mass derived here, cf. Wong, Theory of Ground Vehicles, 3.1",
    check "Look for a load in tow or a cable that drags; measure its pull, and how far behind and how high the hitch is.",
    formulas differ,
    {
        force ["N"] 0.0..20000.0, off 0.0, lognormal(200.0, 1.2), "Force D";
        hitch_behind ["m"] -10.0..10.0, shape 1.0, normal(0.7, 0.7), "Distance of the hitch behind the centroid", estimated;
        hitch_height ["m"] 0.0..5.0, shape 0.3, normal(0.3, 0.1), "Height of the hitch above the ground";
    }
}

impl<S: Scalar> Drawbar<S> {
    /// Force along X and Y \[N\] at the hitch moving with `v` \[m/s\]; it fades below
    /// `fading` \[m/s\].
    pub fn pull(&self, v: [S; 2], fading: f64) -> [S; 2] {
        let speed = (v[0] * v[0] + v[1] * v[1]).offset(fading * fading).sqrt();
        v.map(|v| -self.force * v / speed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EFFECT: Drawbar<f64> = Drawbar {
        force: 400.0,
        hitch_behind: 1.0,
        hitch_height: 0.3,
    };

    #[test]
    fn pulls_against_the_hitch_and_not_at_rest() {
        let [x, y] = EFFECT.pull([0.6, -0.8], 1e-6);
        assert!((x + 240.0).abs() < 1e-6 && (y - 320.0).abs() < 1e-6);
        assert_eq!(EFFECT.pull([0.0, 0.0], 0.01), [0.0, 0.0]);
        // At the fading speed 1/sqrt(2) of it.
        assert!((EFFECT.pull([0.01, 0.0], 0.01)[0] + 282.842_712).abs() < 1e-6);
    }
}
