//! The greatest stress away from the middle of the contact.

use super::declaration::effect;
use crate::scalar::Scalar;

effect! {
    /// The greatest stress lies elsewhere than in the middle of the contact, and moves with slip.
    StressPeak: "stress_peak", Wheels,
    phrase "pressure that peaks elsewhere",
    lifts "theta_m = theta_1 / 2",
    equation "theta_m = (a0 + a1 abs(i)) theta_1",
    source "Wong & Reece, J. Terramechanics 4 (1967), part I, driven wheels: a0 0.43, a1 0.32 in compact sand (0.18, 0.32 in loose sand, which is below the range here); for braking wheels abs(i) is assumed",
    check "Pressure under a wheel shows only on a test bench; predict another drive with both models and compare.",
    formulas differ,
    {
        a0 ["1"] 0.2..0.6, off 0.5, normal(0.4, 0.1), "theta_m / theta_1 without slip";
        a1 ["1"] 0.0..0.4, off 0.0, normal(0.15, 0.1), "Its growth with abs(i)";
    }
}

impl<S: Scalar> StressPeak<S> {
    /// Where in the contact the greatest stress lies, from 0 (exit) to 1 (entry).
    #[inline(always)]
    pub fn place(&self, slip: S) -> S {
        let place = self.a0 + self.a1 * slip;
        // Beyond what was ever measured: the arc behind the entry must keep some length.
        if place.value() > 0.95 {
            S::constant(0.95)
        } else {
            place
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wong_and_reece_on_compact_sand() {
        // a0 = 0.43, a1 = 0.32 (their compact sand): at 22.1 % slip 0.5007.
        let peak = StressPeak { a0: 0.43, a1: 0.32 };
        assert!((peak.place(0.221) - 0.50072).abs() < 1e-9);
        assert_eq!(StressPeak { a0: 0.6, a1: 0.4 }.place(1.5), 0.95);
    }
}
