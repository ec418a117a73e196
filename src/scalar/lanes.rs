//! Values: one `f64`, or eight in the processor's vector registers.

use super::{Packed, Real, Scalar};
use fearless_simd::{Bytes, Select, Simd, SimdBase, SimdFloat, SimdSplit, f64x8, i64x8};

/// Where [`Real::decay`] levels off: exp(-700) is still a normal number.
const DECAY_FLOOR: f64 = -700.0;

impl Real for f64 {
    #[inline(always)]
    fn like(self, value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn scale(self, factor: f64) -> Self {
        self * factor
    }
    #[inline(always)]
    fn offset(self, value: f64) -> Self {
        self + value
    }
    // Without the vector unit a fused product is a call.
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }
    #[inline(always)]
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        self * factor - term
    }
    #[inline(always)]
    fn root(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn inverse_sqrt(self) -> Self {
        1.0 / self.sqrt()
    }
    #[inline(always)]
    fn decay(self) -> Self {
        self.max(DECAY_FLOOR).exp()
    }
    #[inline(always)]
    fn power(self, exponent: f64) -> Self {
        self.powf(exponent)
    }
    #[inline(always)]
    fn power_of(self, exponent: Self) -> Self {
        self.powf(exponent)
    }
    #[inline(always)]
    fn logarithm(self) -> Self {
        self.ln()
    }
    #[inline(always)]
    fn positive(self) -> Self {
        f64::from(u8::from(self > 0.0))
    }
    #[inline(always)]
    fn sin_cos_small(self) -> (Self, Self) {
        self.sin_cos()
    }
}

impl Scalar for f64 {
    type Packed<S: Simd> = f64x8<S>;
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn value(self) -> f64 {
        self
    }
    #[inline(always)]
    fn is_constant(self) -> bool {
        true
    }
    #[inline(always)]
    fn chain<const M: usize>(value: f64, _: &[f64; M], _: &[Self; M]) -> Self {
        value
    }
    #[inline(always)]
    fn splat<S: Simd>(self, simd: S) -> f64x8<S> {
        f64x8::splat(simd, self)
    }
}

impl<S: Simd> Real for f64x8<S> {
    #[inline(always)]
    fn like(self, value: f64) -> Self {
        f64x8::splat(self.simd, value)
    }
    #[inline(always)]
    fn scale(self, factor: f64) -> Self {
        self * factor
    }
    #[inline(always)]
    fn offset(self, value: f64) -> Self {
        self + value
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        SimdFloat::mul_add(self, factor, term)
    }
    #[inline(always)]
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        SimdFloat::mul_sub(self, factor, term)
    }
    #[inline(always)]
    fn root(self) -> Self {
        SimdFloat::sqrt(self)
    }
    #[inline(always)]
    fn inverse_sqrt(self) -> Self {
        1.0 / SimdFloat::sqrt(self)
    }
    /// exp(x) = 2^n exp(x - n ln 2), the rest by its Taylor series: at abs(rest) <= ln 2 / 2
    /// the term of degree 13 is 2e-16 of the sum.
    #[inline(always)]
    fn decay(self) -> Self {
        let x = self.max(self.like(DECAY_FLOOR));
        let (n, bits) = round_to_integer(x * std::f64::consts::LOG2_E);
        let rest = natural_rest(x, n);
        let series = polynomial(rest, &INVERSE_FACTORIALS);
        scale_by_power_of_two(series, bits)
    }
    #[inline(always)]
    fn power(self, exponent: f64) -> Self {
        // The exponent of a pressure below one is negative or zero: `decay` serves both.
        let logarithm = natural_logarithm(self) * exponent;
        let (n, bits) = round_to_integer(logarithm * std::f64::consts::LOG2_E);
        let rest = natural_rest(logarithm, n);
        scale_by_power_of_two(polynomial(rest, &INVERSE_FACTORIALS), bits)
    }
    #[inline(always)]
    fn power_of(self, exponent: Self) -> Self {
        self.power(exponent.as_slice()[0])
    }
    #[inline(always)]
    fn logarithm(self) -> Self {
        natural_logarithm(self)
    }
    #[inline(always)]
    fn positive(self) -> Self {
        let zero = self.like(0.0);
        self.simd_gt(zero).select(self.like(1.0), zero)
    }
    /// Taylor series: at 1 rad the first omitted terms are 1e-17.
    #[inline(always)]
    fn sin_cos_small(self) -> (Self, Self) {
        let square = self * self;
        (
            self * polynomial(square, &SINE),
            polynomial(square, &COSINE),
        )
    }
}

impl<S: Simd> Packed<S> for f64x8<S> {
    type Lane = f64;
    #[inline(always)]
    fn scale_lanes(self, factors: f64x8<S>) -> Self {
        self * factors
    }
    /// Summed in a fixed order, whatever the width of the registers.
    #[inline(always)]
    fn sum(self) -> f64 {
        let (low, high) = self.split();
        let (low, high) = (low + high).split();
        let last = low + high;
        last.as_slice()[0] + last.as_slice()[1]
    }
}

/// ln 2 in two parts, the first with 20 trailing zero bits: n times it is exact.
const LN_2_HIGH: f64 = 6.931_471_803_691_238e-1;
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// 1/k! from k = 0.
const INVERSE_FACTORIALS: [f64; 14] = {
    let mut table = [1.0; 14];
    let mut k = 1;
    while k < 14 {
        table[k] = table[k - 1] / k as f64;
        k += 1;
    }
    table
};

/// (-1)^k / (2k + 1)! and (-1)^k / (2k)!.
const SINE: [f64; 9] = alternating(1);
const COSINE: [f64; 10] = alternating(0);

const fn alternating<const N: usize>(first: usize) -> [f64; N] {
    let mut table = [1.0; N];
    let mut k = 1;
    while k < N {
        let degree = 2 * k + first;
        table[k] = -table[k - 1] / (degree * (degree - 1)) as f64;
        k += 1;
    }
    table
}

/// 2 / (2k + 1): ln m = s (2 + 2/3 s^2 + 2/5 s^4 ...) with s = (m - 1) / (m + 1).
const LOGARITHM: [f64; 11] = {
    let mut table = [2.0; 11];
    let mut k = 1;
    while k < 11 {
        table[k] = 2.0 / (2 * k + 1) as f64;
        k += 1;
    }
    table
};

/// x - n ln 2.
#[inline(always)]
fn natural_rest<S: Simd>(x: f64x8<S>, n: f64x8<S>) -> f64x8<S> {
    SimdFloat::mul_add(n, -LN_2_LOW, SimdFloat::mul_add(n, -LN_2_HIGH, x))
}

/// Pairs of terms, and Horner's rule in x^4 on every other pair: four short chains in place of one of dependent steps.
#[inline(always)]
fn polynomial<S: Simd, const N: usize>(x: f64x8<S>, coefficients: &[f64; N]) -> f64x8<S> {
    let square = x * x;
    let fourth = square * square;
    let pairs = N.div_ceil(2);
    // The highest pair of even place and of odd place.
    let mut even = pair(x, coefficients, (pairs - 1) & !1);
    let mut odd = pair(x, coefficients, (pairs & !1) - 1);
    let mut place = (pairs - 1) & !1;
    while place >= 2 {
        place -= 2;
        even = SimdFloat::mul_add(even, fourth, pair(x, coefficients, place));
    }
    place = (pairs & !1) - 1;
    while place >= 3 {
        place -= 2;
        odd = SimdFloat::mul_add(odd, fourth, pair(x, coefficients, place));
    }
    SimdFloat::mul_add(odd, square, even)
}

/// Terms 2 place and 2 place + 1 of a polynomial over x^(2 place).
#[inline(always)]
fn pair<S: Simd, const N: usize>(x: f64x8<S>, coefficients: &[f64; N], place: usize) -> f64x8<S> {
    if 2 * place + 1 < N {
        SimdFloat::mul_add(
            x,
            coefficients[2 * place + 1],
            x.like(coefficients[2 * place]),
        )
    } else {
        x.like(coefficients[2 * place])
    }
}

/// 2^52 + 2^51: adding it leaves the rounded integer in the low bits of the mantissa.
const ROUNDING_SHIFT: f64 = 6_755_399_441_055_744.0;

/// The nearest integer, as a number and as bits to be shifted into an exponent.
#[inline(always)]
fn round_to_integer<S: Simd>(x: f64x8<S>) -> (f64x8<S>, i64x8<S>) {
    let shifted = x + ROUNDING_SHIFT;
    (shifted - ROUNDING_SHIFT, shifted.bitcast())
}

/// x 2^n for the bits of [`round_to_integer`], x and the product normal.
#[inline(always)]
fn scale_by_power_of_two<S: Simd>(x: f64x8<S>, bits: i64x8<S>) -> f64x8<S> {
    let x: i64x8<S> = x.bitcast();
    (x + (bits << 52_u32)).bitcast()
}

/// ln(x) for normal x > 0: x = m 2^n with sqrt(1/2) <= m < sqrt(2); at that end the first
/// omitted term is 1e-17.
#[inline(always)]
fn natural_logarithm<S: Simd>(x: f64x8<S>) -> f64x8<S> {
    const SQRT_HALF_BITS: i64 = std::f64::consts::FRAC_1_SQRT_2.to_bits() as i64;
    let bits: i64x8<S> = x.bitcast();
    let exponent = (bits - SQRT_HALF_BITS) >> 52_u32;
    let mantissa: f64x8<S> = (bits - (exponent << 52_u32)).bitcast();
    // An integer becomes a number the way back through the shift.
    let shift = ROUNDING_SHIFT.to_bits() as i64;
    let exponent: f64x8<S> = (exponent + shift).bitcast();
    let n = exponent - ROUNDING_SHIFT;
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    s * polynomial(s * s, &LOGARITHM) + n * LN_2_LOW + n * LN_2_HIGH
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    /// A few units in the last place of each function.
    const ROUNDING: f64 = 1e-15;

    type Functions = [f64; 4];

    #[inline(always)]
    fn evaluate<S: Simd>(simd: S, x: f64) -> Functions {
        let x = f64x8::splat(simd, x);
        let angle = x * (1.0 / 700.0);
        let (sin, cos) = angle.sin_cos_small();
        [
            (-x).decay().sum() / 8.0,
            x.power(0.13).sum() / 8.0,
            sin.sum() / 8.0,
            cos.sum() / 8.0,
        ]
    }

    #[test]
    fn vector_functions_agree_with_the_standard_library() {
        for x in [1e-12, 1e-3, 0.3, 0.7, 1.0, 2.5, 40.0, 699.0] {
            let values = dispatch!(Level::new(), simd => evaluate(simd, x));
            let angle: f64 = x / 700.0;
            let expected = [(-x).exp(), x.powf(0.13), angle.sin(), angle.cos()];
            for (value, expected) in values.iter().zip(expected) {
                let error = (value / expected - 1.0).abs();
                assert!(error < ROUNDING * 2.0, "{x}: {value} {expected}");
            }
        }
    }

    #[test]
    fn instruction_sets_differ_by_rounding_alone() {
        for x in [1e-3, 0.3, 2.5, 40.0] {
            let best = dispatch!(Level::new(), simd => evaluate(simd, x));
            let base = dispatch!(Level::baseline(), simd => evaluate(simd, x));
            for (best, base) in best.iter().zip(base) {
                assert!((best / base - 1.0).abs() < ROUNDING, "{best} {base}");
            }
        }
    }

    #[test]
    fn decay_levels_off() {
        #[inline(always)]
        fn decay<S: Simd>(simd: S) -> f64 {
            f64x8::splat(simd, -1e300).decay().sum()
        }
        let value = dispatch!(Level::new(), simd => decay(simd));
        assert!(value > 0.0 && value < 1e-300);
    }
}
