//! Elementary functions of single numbers, for what is computed once per wheel or vehicle.

use super::Scalar;

/// Elementary functions with their derivatives.
pub trait Elementary: Scalar {
    /// sqrt(x) for x > 0.
    #[must_use]
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value().sqrt();
        Self::chain(root, &[0.5 / root], &[self])
    }
    /// exp(x).
    #[must_use]
    #[inline(always)]
    fn exp(self) -> Self {
        let value = self.value().exp();
        Self::chain(value, &[value], &[self])
    }
    /// ln(x) for x > 0.
    #[must_use]
    #[inline(always)]
    fn ln(self) -> Self {
        Self::chain(self.value().ln(), &[1.0 / self.value()], &[self])
    }
    /// tan(x).
    #[must_use]
    #[inline(always)]
    fn tan(self) -> Self {
        let tan = self.value().tan();
        Self::chain(tan, &[1.0 + tan * tan], &[self])
    }
    /// sin(x) and cos(x) of any angle.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value().sin_cos();
        (
            Self::chain(sin, &[cos], &[self]),
            Self::chain(cos, &[-sin], &[self]),
        )
    }
    /// x^y for x > 0.
    #[must_use]
    #[inline(always)]
    fn powf(self, exponent: Self) -> Self {
        let (x, y) = (self.value(), exponent.value());
        let value = x.powf(y);
        Self::chain(value, &[y * value / x, value * x.ln()], &[self, exponent])
    }
    /// abs(x), rounded off within `width` of zero: sqrt(x^2 + width^2).
    #[must_use]
    #[inline(always)]
    fn rounded_abs(self, width: f64) -> Self {
        (self * self).offset(width * width).sqrt()
    }
    /// The quintic step: 0 up to x = -1, 1 from x = 1 on, two derivatives continuous.
    #[must_use]
    #[inline(always)]
    fn smooth_step(self) -> Self {
        let x = self.value().clamp(-1.0, 1.0);
        let square = x * x;
        // Its derivative is 15/16 (1 - x^2)^2.
        let value = 0.5 + x * (0.9375 - square * (0.625 - 0.1875 * square));
        Self::chain(value, &[0.9375 * (1.0 - square).powi(2)], &[self])
    }
    /// The smaller of two numbers.
    #[must_use]
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self.value() <= other.value() {
            self
        } else {
            other
        }
    }
    /// The larger of two numbers.
    #[must_use]
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self.value() >= other.value() {
            self
        } else {
            other
        }
    }
}

impl<S: Scalar> Elementary for S {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;

    /// Central differences with h = 1e-6 err by about 1e-10.
    const DIFFERENCE_TOLERANCE: f64 = 1e-8;

    #[test]
    fn derivatives_agree_with_differences() {
        type Function = (fn(Dual<f64, 1>) -> Dual<f64, 1>, fn(f64) -> f64);
        let functions: [Function; 8] = [
            (Elementary::sqrt, f64::sqrt),
            (Elementary::exp, f64::exp),
            (Elementary::ln, f64::ln),
            (Elementary::tan, f64::tan),
            (|x| x.sin_cos().0, f64::sin),
            (|x| x.sin_cos().1, f64::cos),
            (|x| x.powf(x), |x| x.powf(x)),
            (|x| x.rounded_abs(0.3), |x| x.hypot(0.3)),
        ];
        for (dual, plain) in functions {
            for x in [0.2, 0.9] {
                let found = dual(Dual::variable(x, 0));
                let slope = (plain(x + 1e-6) - plain(x - 1e-6)) / 2e-6;
                assert!((found.re - plain(x)).abs() < 1e-15);
                assert!((found.eps[0] - slope).abs() < DIFFERENCE_TOLERANCE);
            }
        }
    }

    #[test]
    fn the_step_is_flat_outside_and_odd_about_a_half() {
        assert_eq!(Elementary::smooth_step(-1.5), 0.0);
        assert_eq!(Elementary::smooth_step(1.5), 1.0);
        for x in [0.0, 0.3, 0.8] {
            let sum = Elementary::smooth_step(x) + Elementary::smooth_step(-x);
            assert!((sum - 1.0).abs() < 1e-15);
            let slope =
                (Elementary::smooth_step(x + 1e-6) - Elementary::smooth_step(x - 1e-6)) / 2e-6;
            let dual = Dual::<f64, 1>::variable(x, 0).smooth_step();
            assert!((dual.eps[0] - slope).abs() < DIFFERENCE_TOLERANCE);
        }
    }
}
