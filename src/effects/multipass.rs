//! Rows behind run in the ruts of the rows ahead.

use super::declaration::effect;
use crate::scalar::Scalar;

effect! {
    /// The soil remembers: unloaded after a row has passed, it springs back along a steep line and
    /// carries the next row on it, until that row sinks deeper than the one before.
    ///
    /// Each wheel carries the depth z_m to which the soil that it runs on was pressed before, a state. The
    /// tracks that all wheels left are remembered, with their depths z, over the last 13 wheel bases
    /// driven. A wheel meets them on a line along its axle, r/3 before it: of a track that crosses that
    /// line at the distance d beside the wheel's middle the share 1 / (1 + (d / b)^2), and of all
    /// tracks the one that is then the deepest counts. What the wheel meets passes under it within as
    /// long a way: dz_m/dt = 3 |V| / r (memory z / (1 + (d / b)^2) - z_m). So the first row meets
    /// untouched soil, and its own track where it turns back; in a turn about the vehicle's middle the
    /// last row runs in the rut of the first; and a vehicle that turns on the spot leaves the tracks in which it
    /// came, and comes upon those of the circle, of both sides. At rest the memory stays.
    Multipass: "multipass", Wheels + memory,
    phrase "rear wheels in the front wheels' rut",
    lifts "homogeneous ground: every row meets untouched soil",
    equation "sigma = K_e (z - z_p) up to z_m, k z^n beyond; K_e = ratio k z_m^(n-1), z_p = z_m (1 - 1/ratio); dz_m/dt = 3 |V| / r (memory z / (1 + (d/b)^2) - z_m), z the depth of the track that makes most of it, d how far beside the wheel it lies, r/3 before the axle",
    source "elastic reloading below the greatest pressure so far: Wong, Theory of Ground Vehicles (2001), ch. 2; as Chrono's SCM terrain adds it to Krenn & Hirzinger, ISTVS European conference, Bremen 2009",
    check "Measure the rut after the first row and after the last one, on ground that was not driven before.",
    formulas differ,
    {
        memory ["1"] 0.0..1.0, off 0.0, normal(1.0, 0.3), "Share of the rut ahead that a row meets", first_step_to(1.0);
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
}
