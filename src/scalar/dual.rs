//! Forward dual numbers.
#![allow(
    clippy::suspicious_arithmetic_impl,
    clippy::needless_range_loop,
    reason = "the product rule adds; loops by index keep the lanes in registers"
)]

use super::{Packed, Real, Scalar};
use fearless_simd::{Simd, f64x8};
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A forward dual number: a value and its derivatives in `N` directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<T, const N: usize> {
    /// The value.
    pub re: T,
    /// Its derivatives.
    pub eps: [T; N],
}

impl<const N: usize> Dual<f64, N> {
    /// The `direction`-th of the `N` independent variables.
    #[must_use]
    pub fn variable(value: f64, direction: usize) -> Self {
        let mut eps = [0.0; N];
        eps[direction] = 1.0;
        Self { re: value, eps }
    }
}

impl<T: Real, const N: usize> Dual<T, N> {
    // Loops, not `array::map`: its closures are not always inlined, and one that is not
    // loses the vector registers.

    #[inline(always)]
    fn each(mut self, re: T, f: impl Fn(T) -> T) -> Self {
        self.re = re;
        for e in &mut self.eps {
            *e = f(*e);
        }
        self
    }

    #[inline(always)]
    fn map(self, re: T, slope: T) -> Self {
        self.each(re, |e| e * slope)
    }

    #[inline(always)]
    fn zip(mut self, other: Self, re: T, f: impl Fn(T, T) -> T) -> Self {
        self.re = re;
        for k in 0..N {
            self.eps[k] = f(self.eps[k], other.eps[k]);
        }
        self
    }
}

impl<T: Real, const N: usize> Add for Dual<T, N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        self.zip(o, self.re + o.re, |a, b| a + b)
    }
}
impl<T: Real, const N: usize> AddAssign for Dual<T, N> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl<T: Real, const N: usize> Sub for Dual<T, N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self.zip(o, self.re - o.re, |a, b| a - b)
    }
}
impl<T: Real, const N: usize> Mul for Dual<T, N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        self.zip(o, self.re * o.re, |a, b| a.mul_add(o.re, b * self.re))
    }
}
impl<T: Real, const N: usize> Div for Dual<T, N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let inverse = o.re.like(1.0) / o.re;
        let quotient = self.re * inverse;
        self.zip(o, quotient, |a, b| (a - quotient * b) * inverse)
    }
}
impl<T: Real, const N: usize> Neg for Dual<T, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.each(-self.re, |e| -e)
    }
}

impl<T: Real, const N: usize> Real for Dual<T, N> {
    #[inline(always)]
    fn like(self, value: f64) -> Self {
        self.each(self.re.like(value), |e| e.like(0.0))
    }
    #[inline(always)]
    fn scale(self, factor: f64) -> Self {
        self.each(self.re.scale(factor), |e| e.scale(factor))
    }
    #[inline(always)]
    fn offset(self, value: f64) -> Self {
        Self {
            re: self.re.offset(value),
            eps: self.eps,
        }
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        let mut sum = term;
        sum.re = self.re.mul_add(factor.re, term.re);
        for k in 0..N {
            let own = factor.eps[k].mul_add(self.re, term.eps[k]);
            sum.eps[k] = self.eps[k].mul_add(factor.re, own);
        }
        sum
    }
    #[inline(always)]
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        let mut rest = term;
        rest.re = self.re.mul_sub(factor.re, term.re);
        for k in 0..N {
            let own = factor.eps[k].mul_sub(self.re, term.eps[k]);
            rest.eps[k] = self.eps[k].mul_add(factor.re, own);
        }
        rest
    }
    #[inline(always)]
    fn root(self) -> Self {
        let value = self.re.root();
        self.map(value, value.like(0.5) / value)
    }
    #[inline(always)]
    fn inverse_sqrt(self) -> Self {
        let value = self.re.inverse_sqrt();
        self.map(value, value * value * value.scale(-0.5))
    }
    #[inline(always)]
    fn decay(self) -> Self {
        let value = self.re.decay();
        self.map(value, value)
    }
    #[inline(always)]
    fn power(self, exponent: f64) -> Self {
        let value = self.re.power(exponent);
        self.map(value, value.scale(exponent) / self.re)
    }
    #[inline(always)]
    fn power_of(self, exponent: Self) -> Self {
        let value = self.re.power_of(exponent.re);
        let by_base = value * exponent.re / self.re;
        let by_exponent = value * self.re.logarithm();
        self.zip(exponent, value, |a, b| a.mul_add(by_base, b * by_exponent))
    }
    #[inline(always)]
    fn logarithm(self) -> Self {
        let inverse = self.re.like(1.0) / self.re;
        self.map(self.re.logarithm(), inverse)
    }
    #[inline(always)]
    fn positive(self) -> Self {
        Self {
            re: self.re.positive(),
            ..self.like(0.0)
        }
    }
    #[inline(always)]
    fn sin_cos_small(self) -> (Self, Self) {
        let (sin, cos) = self.re.sin_cos_small();
        (self.map(sin, cos), self.map(cos, -sin))
    }
}

impl<const N: usize> Scalar for Dual<f64, N> {
    type Packed<S: Simd> = Dual<f64x8<S>, N>;
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self {
            re: value,
            eps: [0.0; N],
        }
    }
    #[inline(always)]
    fn value(self) -> f64 {
        self.re
    }
    #[inline(always)]
    fn is_constant(self) -> bool {
        self.eps.iter().all(|e| *e == 0.0)
    }
    #[inline(always)]
    fn chain<const M: usize>(value: f64, gradient: &[f64; M], arguments: &[Self; M]) -> Self {
        let mut eps = [0.0; N];
        for (slope, argument) in gradient.iter().zip(arguments) {
            for (sum, e) in eps.iter_mut().zip(argument.eps) {
                *sum += slope * e;
            }
        }
        Self { re: value, eps }
    }
    #[inline(always)]
    fn splat<S: Simd>(self, simd: S) -> Dual<f64x8<S>, N> {
        let mut eps = [0.0.splat(simd); N];
        for k in 0..N {
            eps[k] = self.eps[k].splat(simd);
        }
        Dual {
            re: self.re.splat(simd),
            eps,
        }
    }
}

impl<S: Simd, const N: usize> Packed<S> for Dual<f64x8<S>, N> {
    type Lane = Dual<f64, N>;
    #[inline(always)]
    fn scale_lanes(self, factors: f64x8<S>) -> Self {
        self.each(self.re * factors, |e| e * factors)
    }
    #[inline(always)]
    fn sum(self) -> Dual<f64, N> {
        let mut eps = [0.0; N];
        for k in 0..N {
            eps[k] = self.eps[k].sum();
        }
        Dual {
            re: self.re.sum(),
            eps,
        }
    }
}
