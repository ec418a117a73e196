//! Rows behind run in the ruts of the rows ahead.

use super::declaration::effect;
use crate::scalar::Scalar;

effect! {
    /// The soil remembers: unloaded after a row has passed, it springs back along a steep line and
    /// carries the next row on it, until that row sinks deeper than the one before.
    ///
    /// Each wheel carries the depth z_m to which the soil that it meets was pressed before, a state
    /// that follows the row ahead over the distance L between the two (the first-order
    /// approximation of the transport by the vehicle's motion): dz_m/dt = |V| / L (memory o z_ahead -
    /// z_m), with o = 1 / (1 + (d / b)^2) the overlap of its track with that of the row ahead which it
    /// misses least: d = L_j tan(beta_j), beta_j the sideslip midway between it and row j. In a turn
    /// about the vehicle's middle the last row runs in the rut of the first. At rest the memory stays.
    Multipass: "multipass", Physics,
    lifts "homogeneous ground: every row meets untouched soil",
    equation "sigma = K_e (z - z_p) up to z_m, k z^n beyond; K_e = ratio k z_m^(n-1), z_p = z_m (1 - 1/ratio); dz_m/dt = |V| / L (memory z_ahead / (1 + (d/b)^2) - z_m), d between the tracks",
    source "elastic reloading below the greatest pressure so far: Wong, Theory of Ground Vehicles, ch. 2; Krenn & Hirzinger, SCM, ASTRA 2009",
    {
        memory ["1"] 0.0..1.0, off 0.0, normal(1.0, 0.3), "Share of the rut ahead that a row meets";
        stiffness_ratio ["1"] 1.5..100.0, shape 10.0, lognormal(10.0, 0.7), "Stiffness of unloaded soil over the secant stiffness of its first loading";
    }
}

/// A rut as the next wheel meets it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rut<S> {
    /// Depth of its ground below the untouched surface z_p \[m\].
    pub ground: S,
    /// Depth below its ground up to which it is elastic \[m\].
    pub elastic: S,
}

impl<S: Scalar> Multipass<S> {
    /// The rut that a pass to the depth `deepest` \[m\] left.
    #[inline(always)]
    pub fn rut(&self, deepest: S) -> Rut<S> {
        let elastic = deepest / self.stiffness_ratio;
        Rut {
            ground: deepest - elastic,
            elastic,
        }
    }

    /// The depth that a row's soil should have been pressed to, when the row ahead runs at the depth
    /// `ahead` \[m\]; `missed` is the square of the distance between their tracks over a wheel's width.
    #[inline(always)]
    pub fn arriving(&self, ahead: S, missed: S) -> S {
        self.memory * ahead / missed.offset(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EFFECT: Multipass<f64> = Multipass {
        memory: 1.0,
        stiffness_ratio: 10.0,
    };

    #[test]
    fn the_line_of_reloading_meets_the_first_loading_where_it_ended() {
        let (k, n, deepest) = (1.5e6_f64, 0.7, 0.02_f64);
        let rut = EFFECT.rut(deepest);
        let stiffness = EFFECT.stiffness_ratio * k * deepest.powf(n - 1.0);
        let reloaded = stiffness * rut.elastic;
        assert!((reloaded / (k * deepest.powf(n)) - 1.0).abs() < 1e-12);
        assert!((rut.ground + rut.elastic - deepest).abs() < 1e-15);
        assert!((rut.ground - 0.018).abs() < 1e-15);
    }

    #[test]
    fn a_track_beside_the_rut_meets_untouched_soil() {
        let straight = EFFECT.arriving(0.02, 0.0);
        assert_eq!(straight, 0.02);
        assert!(EFFECT.arriving(0.02, 25.0) < 0.02 * 0.05);
        let off = Multipass {
            memory: 0.0,
            ..EFFECT
        };
        assert_eq!(off.arriving(0.02, 0.0), 0.0);
    }
}
