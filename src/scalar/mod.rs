//! The number types that the kernels are generic over: plain values and forward dual
//! numbers, one at a time ([`Scalar`]) or eight at a time ([`Packed`]).
//!
//! One kernel serves values and exact derivatives: evaluated on [`Dual`] it carries `N`
//! partial derivatives along, evaluated on `f64` it computes the value alone. The eight
//! lanes use the widest instructions that the processor has. Products are fused with sums, and the
//! result is the same bits on all processors that can do so (AVX2, AVX-512, NEON); on older ones the last digits differ.

mod dual;
mod functions;
mod lanes;

pub use dual::Dual;
pub use functions::Elementary;

use fearless_simd::{Simd, f64x8};
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Arithmetic that a kernel needs, on one number or on eight packed ones.
pub trait Real:
    Copy
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// A constant of the same type: its derivatives are zero.
    #[must_use]
    fn like(self, value: f64) -> Self;
    /// The product with a constant.
    #[must_use]
    fn scale(self, factor: f64) -> Self;
    /// The sum with a constant.
    #[must_use]
    fn offset(self, value: f64) -> Self;
    /// self factor + term, fused where the processor can.
    #[must_use]
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// self factor - term, fused where the processor can.
    #[must_use]
    fn mul_sub(self, factor: Self, term: Self) -> Self;
    /// sqrt(x) for x > 0.
    #[must_use]
    fn root(self) -> Self;
    /// 1 / sqrt(x) for x > 0.
    #[must_use]
    fn inverse_sqrt(self) -> Self;
    /// exp(x) for x <= 0; below -700 it is as at -700, which is next to nothing.
    #[must_use]
    fn decay(self) -> Self;
    /// x^exponent for x > 0.
    #[must_use]
    fn power(self, exponent: f64) -> Self;
    /// x^exponent for x > 0, where the exponent has derivatives as well (of eight packed
    /// ones the first serves all).
    #[must_use]
    fn power_of(self, exponent: Self) -> Self;
    /// ln(x) for x > 0.
    #[must_use]
    fn logarithm(self) -> Self;
    /// 1 where x > 0, else 0; without derivatives.
    #[must_use]
    fn positive(self) -> Self;
    /// Sine and cosine of an angle between -1 and 1 rad.
    fn sin_cos_small(self) -> (Self, Self);
}

/// A number (value or dual) that can be spread over eight lanes.
pub trait Scalar: Real {
    /// Eight of these at once: the integrand at eight quadrature nodes.
    type Packed<S: Simd>: Packed<S, Lane = Self>;
    /// A constant: its derivatives are zero.
    fn constant(value: f64) -> Self;
    /// The value without its derivatives.
    fn value(self) -> f64;
    /// Whether all its derivatives are zero.
    fn is_constant(self) -> bool;
    /// Continues a function of several arguments: its value, and its gradient times
    /// the arguments' own derivatives (chain rule).
    fn chain<const M: usize>(value: f64, gradient: &[f64; M], arguments: &[Self; M]) -> Self;
    /// The same number in all eight lanes.
    fn splat<S: Simd>(self, simd: S) -> Self::Packed<S>;
}

/// Eight numbers at once.
pub trait Packed<S: Simd>: Real {
    /// One of the eight.
    type Lane: Scalar<Packed<S> = Self>;
    /// The product with constants, lane by lane.
    #[must_use]
    fn scale_lanes(self, factors: f64x8<S>) -> Self;
    /// The sum over the lanes.
    fn sum(self) -> Self::Lane;
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    /// Central differences of a smooth function err by h^2; h = 1e-6 leaves about 1e-10.
    const DIFFERENCE_TOLERANCE: f64 = 1e-8;

    #[inline(always)]
    fn sample<R: Real>(x: R, y: R) -> R {
        let (sin, cos) = (x * y).sin_cos_small();
        (sin.scale(0.3) + cos * (-x).decay()) * y.offset(2.0).inverse_sqrt()
            - x.offset(3.0).power(0.7)
    }

    #[test]
    fn duals_agree_with_differences() {
        let (x, y, h) = (0.7, 1.3, 1e-6);
        let dual = sample(Dual::<f64, 2>::variable(x, 0), Dual::variable(y, 1));
        assert_eq!(dual.re, sample(x, y));
        let dx = (sample(x + h, y) - sample(x - h, y)) / (2.0 * h);
        let dy = (sample(x, y + h) - sample(x, y - h)) / (2.0 * h);
        assert!((dual.eps[0] - dx).abs() < DIFFERENCE_TOLERANCE);
        assert!((dual.eps[1] - dy).abs() < DIFFERENCE_TOLERANCE);
    }

    #[inline(always)]
    fn packed_sample<S: Simd>(simd: S, x: f64) -> f64 {
        use fearless_simd::SimdBase;
        let result = sample(Scalar::splat(x, simd), Scalar::splat(0.9, simd));
        let lanes = result.as_slice();
        assert!(lanes.iter().all(|lane| *lane == lanes[0]));
        lanes[0]
    }

    #[test]
    fn packed_lanes_agree_with_single_numbers() {
        for x in [0.0, 0.1, 0.7, 1.1] {
            let packed = dispatch!(Level::new(), simd => packed_sample(simd, x));
            // The vector functions are within a few units in the last place.
            assert!((packed - sample(x, 0.9)).abs() < 1e-14, "{x}");
        }
    }

    #[test]
    fn chain_rule_continues_a_gradient() {
        let x = Dual::<f64, 2>::variable(2.0, 0);
        let y = Dual::<f64, 2>::variable(5.0, 1);
        let product = Dual::chain(10.0, &[5.0, 2.0], &[x, y]);
        assert_eq!(product, x * y);
    }
}
