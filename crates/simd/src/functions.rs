//! Logarithms and arctangents of ratios, in the lanes of a vector.
//!
//! Both functions take numerator and denominator, so that a product of many terms needs one
//! division in all. Both reduce to an odd polynomial in a number below 0.203.
//!
//! # Accuracy
//! The relative error of an angle is at most 1e-15. The relative error of an artanh is at most
//! 6e-16, plus the effect of rounding its ratio to 1e-16.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, FRAC_PI_8, LN_2, PI};

use fearless_simd::prelude::*;

use crate::lanes::{LanePair, Lanes, Number};

/// tan(pi / 16) and tan(3 pi / 16), where the nearest multiple of pi / 8 changes.
const TAN_PI_16: f64 = 0.198_912_367_379_658;
const TAN_3_PI_16: f64 = 0.668_178_637_919_298_9;
/// tan(pi / 8)
const TAN_PI_8: f64 = std::f64::consts::SQRT_2 - 1.0;

/// A value base + sign * series(numerator / denominator): a function after the reduction of its
/// argument. Several of them may share a division.
#[derive(Clone, Copy)]
pub struct Reduced<N> {
    /// Numerator of the reduced argument.
    pub numerator: N,
    /// Denominator of the reduced argument.
    pub denominator: N,
    base: N,
    /// 1 or -1 for angles; logarithms have no sign.
    sign: Option<N>,
}

impl<N: Number> Reduced<N> {
    /// base + artanh(numerator / denominator).
    #[inline(always)]
    pub fn of_logarithm(numerator: N, denominator: N, base: N) -> Reduced<N> {
        Reduced { numerator, denominator, base, sign: None }
    }

    /// base + sign * arctan(numerator / denominator).
    #[inline(always)]
    pub fn of_angle(numerator: N, denominator: N, base: N, sign: N) -> Reduced<N> {
        Reduced { numerator, denominator, base, sign: Some(sign) }
    }

    /// The value from the quotient of numerator and denominator.
    #[inline(always)]
    pub fn value(&self, simd: N::Instructions, quotient: N) -> N {
        match self.sign {
            None => self.base + odd_series(simd, quotient, false),
            Some(sign) => odd_series(simd, quotient, true).mul_add(sign, self.base),
        }
    }

    /// The value, with a division of its own.
    #[inline(always)]
    pub fn divided(&self, simd: N::Instructions) -> N {
        self.value(simd, self.numerator.over(self.denominator))
    }
}

/// The functions of one vector or a pair of vectors.
pub trait Functions: Number {
    /// artanh(n / m), |n| < m.
    fn artanh_of_ratio(simd: Self::Instructions, n: Self, m: Self) -> Reduced<Self>;
    /// The angle of re + i im, between -pi and pi.
    fn angle(simd: Self::Instructions, re: Self, im: Self) -> Reduced<Self>;
    /// ln(a / b) / 2 of positive numbers.
    fn half_logarithm_of_ratio(simd: Self::Instructions, a: Self, b: Self) -> Reduced<Self>;
}

impl<S: Simd> Functions for Lanes<S> {
    #[inline(always)]
    fn artanh_of_ratio(simd: S, n: Self, m: Self) -> Reduced<Self> {
        let (power, base) = nearest_power(m + n, m - n);
        let one = Lanes::<S>::splat(simd, 1.0);
        let (sum, difference) = (one + power, one - power);
        Reduced::of_logarithm(m.mul_add(difference, n * sum), n.mul_add(difference, m * sum), base)
    }

    #[inline(always)]
    fn angle(simd: S, re: Self, im: Self) -> Reduced<Self> {
        reduced_angle(simd, re, im)
    }

    #[inline(always)]
    fn half_logarithm_of_ratio(_: S, a: Self, b: Self) -> Reduced<Self> {
        let (power, base) = nearest_power(a, b);
        Reduced::of_logarithm(a - power * b, a + power * b, base)
    }
}

impl<S: Simd> Functions for LanePair<S> {
    #[inline(always)]
    fn artanh_of_ratio(simd: S, LanePair([n, n_2]): Self, LanePair([m, m_2]): Self) -> Reduced<Self> {
        let (first, second) = (Lanes::artanh_of_ratio(simd, n, m), Lanes::artanh_of_ratio(simd, n_2, m_2));
        side_by_side(first, second)
    }

    #[inline(always)]
    fn angle(simd: S, LanePair([re, re_2]): Self, LanePair([im, im_2]): Self) -> Reduced<Self> {
        let (first, second) = (reduced_angle(simd, re, im), reduced_angle(simd, re_2, im_2));
        side_by_side(first, second)
    }

    #[inline(always)]
    fn half_logarithm_of_ratio(simd: S, LanePair([a, a_2]): Self, LanePair([b, b_2]): Self) -> Reduced<Self> {
        let first = Lanes::half_logarithm_of_ratio(simd, a, b);
        side_by_side(first, Lanes::half_logarithm_of_ratio(simd, a_2, b_2))
    }
}

#[inline(always)]
fn side_by_side<S: Simd>(first: Reduced<Lanes<S>>, second: Reduced<Lanes<S>>) -> Reduced<LanePair<S>> {
    Reduced {
        numerator: LanePair([first.numerator, second.numerator]),
        denominator: LanePair([first.denominator, second.denominator]),
        base: LanePair([first.base, second.base]),
        sign: first.sign.zip(second.sign).map(|(first, second)| LanePair([first, second])),
    }
}

const SIGN: u64 = 1 << 63;
const EXPONENT_ONE: u64 = 1023 << 52;
const EXPONENT_HALF: u64 = 1 << 51;
const EXPONENT_MASK: u64 = 0x7ff << 52;
/// The bits of 2^52. With a small integer in the lowest bits they are 2^52 plus that integer.
const INTEGER: u64 = 1075 << 52;
const INTEGER_OFFSET: f64 = 4_503_599_627_370_496.0 + 1023.0;

/// artanh(n / m), |n| < m.
#[inline(always)]
pub fn artanh_of_ratio<S: Simd>(simd: S, n: Lanes<S>, m: Lanes<S>) -> Lanes<S> {
    Lanes::artanh_of_ratio(simd, n, m).divided(simd)
}

/// ln(a / b) / 2 of positive numbers.
#[inline(always)]
pub fn half_logarithm_of_ratio<S: Simd>(simd: S, a: Lanes<S>, b: Lanes<S>) -> Lanes<S> {
    Lanes::half_logarithm_of_ratio(simd, a, b).divided(simd)
}

/// Largest hyperbolic tangent in [`logarithm_of_tangent_or_ratio`] that serves as the argument of
/// the series.
pub const LARGEST_TANGENT: f64 = 0.2;

/// A logarithm that is half the logarithm of above / below and the artanh of n / m, with n, m > 0.
/// The tangent keeps the digits of small logarithms, the ratio the digits of large ones.
#[inline(always)]
pub fn logarithm_of_tangent_or_ratio<N: Functions>(simd: N::Instructions, [n, m]: [N; 2], [above, below]: [N; 2]) -> N {
    let excess = n - m * LARGEST_TANGENT;
    let large = N::half_logarithm_of_ratio(simd, above, below);
    let numerator = excess.where_at_least(0.0, large.numerator, n);
    let denominator = excess.where_at_least(0.0, large.denominator, m);
    let base = excess.where_at_least(0.0, large.base, N::splat(simd, 0.0));
    Reduced::of_logarithm(numerator, denominator, base).divided(simd)
}

/// The power of two E nearest to a / b, and ln(E) / 2. Then ln(a / b) / 2 = ln(E) / 2 + artanh(s)
/// with s = (a - E b) / (a + E b), which is small and free of cancellation.
#[inline(always)]
fn nearest_power<S: Simd>(Lanes(a): Lanes<S>, Lanes(b): Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    // The difference of the bits equals the difference of the logarithms, to 9 %.
    let power = (a.to_bits() - b.to_bits() + (EXPONENT_ONE + EXPONENT_HALF)) & EXPONENT_MASK;
    let exponent = S::f64s::from_bits((power >> 52) | INTEGER) - INTEGER_OFFSET;
    (Lanes(S::f64s::from_bits(power)), Lanes(exponent * (0.5 * LN_2)))
}

/// The angle of re + i im, between -pi and pi.
#[inline(always)]
pub fn angle<S: Simd>(simd: S, re: Lanes<S>, im: Lanes<S>) -> Lanes<S> {
    reduced_angle(simd, re, im).divided(simd)
}

#[inline(always)]
fn reduced_angle<S: Simd>(simd: S, Lanes(re): Lanes<S>, Lanes(im): Lanes<S>) -> Reduced<Lanes<S>> {
    let zero = S::f64s::splat(simd, 0.0);
    let (x, y) = (re.abs(), im.abs());
    let steep = y.simd_gt(x);
    let (low, high) = (steep.select(x, y), steep.select(y, x));
    // The addition theorem subtracts the nearest of 0, pi / 8 and pi / 4.
    let (beyond_first, beyond_second) = (low.simd_gt(high * TAN_PI_16), low.simd_gt(high * TAN_3_PI_16));
    let (first, second) = (S::f64s::splat(simd, TAN_PI_8), S::f64s::splat(simd, 1.0));
    let tangent = beyond_second.select(second, beyond_first.select(first, zero));
    let (first, second) = (S::f64s::splat(simd, FRAC_PI_8), S::f64s::splat(simd, FRAC_PI_4));
    let taken_off = beyond_second.select(second, beyond_first.select(first, zero));
    let right = steep.select(S::f64s::splat(simd, FRAC_PI_2) - taken_off, taken_off);
    let half_turn = re.simd_lt(zero).select(S::f64s::splat(simd, PI) - right, right);
    // Each of the three reflections changes the sign of the remainder.
    let one = S::f64s::splat(simd, 1.0);
    let reflected = steep.select(zero - one, one).to_bits() ^ ((re.to_bits() ^ im.to_bits()) & SIGN);
    Reduced {
        numerator: Lanes(low - tangent * high),
        denominator: Lanes(tangent.mul_add(low, high)),
        base: Lanes(half_turn.copysign(im)),
        sign: Some(Lanes(S::f64s::from_bits(reflected))),
    }
}

/// Polynomials in s^2 for (artanh(s) - s) / s^3, s^2 < 0.0412, highest power first: minimax in the
/// relative error of artanh(s), 2e-17.
const ARTANH: [f64; 7] = [
    0.077_169_589_959_751_46,
    0.076_208_159_365_934_9,
    0.090_933_945_125_152_38,
    0.111_110_639_006_070_96,
    0.142_857_147_639_322_86,
    0.199_999_999_977_071_2,
    0.333_333_333_333_370_5,
];
/// [`ARTANH`] for the arctangent.
const ARCTAN: [f64; 7] = [
    -0.057_852_644_138_648_775,
    0.076_357_281_277_731_3,
    -0.090_889_993_438_501_35,
    0.111_110_754_808_010_29,
    -0.142_857_139_291_770_16,
    0.199_999_999_983_058_42,
    -0.333_333_333_333_306_06,
];
/// [`ARTANH`] for s^2 < 0.0016, to 7e-15.
const SHORT_ARTANH: [f64; 3] = [0.143_201_388_841_882_7, 0.199_999_678_527_577_07, 0.333_333_333_418_647_8];
/// [`SHORT_ARTANH`] for the arctangent.
const SHORT_ARCTAN: [f64; 3] = [-0.142_514_143_024_738_8, 0.199_999_680_083_033_83, -0.333_333_333_248_485_2];

/// artanh(s), or the arctangent, for s^2 < 0.0412: |s| below tanh(0.2) and tan(0.2), and below
/// every reduced argument.
#[inline(always)]
pub fn odd_series<N: Number>(simd: N::Instructions, s: N, is_angle: bool) -> N {
    odd_polynomial(simd, s, if is_angle { &ARCTAN } else { &ARTANH })
}

/// artanh(s), or the arctangent, to 7e-15 for s^2 < 0.0016: |s| below tanh(0.04) and tan(0.04).
#[inline(always)]
pub fn short_odd_series<N: Number>(simd: N::Instructions, s: N, is_angle: bool) -> N {
    odd_polynomial(simd, s, if is_angle { &SHORT_ARCTAN } else { &SHORT_ARTANH })
}

#[inline(always)]
fn odd_polynomial<N: Number>(simd: N::Instructions, s: N, coefficients: &[f64]) -> N {
    let z = s * s;
    let mut sum = N::splat(simd, coefficients[0]);
    for coefficient in &coefficients[1..] {
        sum = sum.mul_add_constant(z, *coefficient);
    }
    (s * z).mul_add(sum, s)
}
