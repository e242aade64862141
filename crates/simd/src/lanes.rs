//! A vector of the processor, and pairs of vectors.

use std::ops::{Add, Mul, Sub};

use fearless_simd::prelude::*;

/// Largest number of doubles in a vector of any instruction set.
pub const LONGEST_VECTOR: usize = 8;

/// Number of points in a pair of the longest vectors. Lists of points are padded to multiples of
/// it.
pub const PAIR: usize = 2 * LONGEST_VECTOR;

/// This constant minus half the bits of x gives the bits of about 1 / sqrt(x) (Lomont).
const RECIPROCAL_ROOT: f64 = f64::from_bits(0x5fe6_eb50_c7b5_37a9);
/// 2^52, above which neighbouring doubles differ by 1.
const POWER_52: f64 = (1_u64 << 52) as f64;
/// Minimax polynomial for w^(-1/2) between 0.932 and 1.070, in relative error.
const ROOT_CORRECTION: [f64; 4] =
    [2.189_332_781_995_891, -2.191_720_726_753_980_7, 1.315_441_291_758_012_3, -0.313_054_093_377_317_9];

/// The numbers of a formula: a vector, or a pair of vectors whose operations are independent.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Sub<f64, Output = Self> + Mul<f64, Output = Self>
{
    /// The instruction set.
    type Instructions: Simd;

    /// The same value in every lane.
    fn splat(simd: Self::Instructions, value: f64) -> Self;
    /// self * factor + term
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// self * factor - term
    fn mul_sub(self, factor: Self, term: Self) -> Self;
    /// self * factor + term
    fn scale_add(self, factor: f64, term: Self) -> Self;
    /// self * factor - term
    fn mul_sub_constant(self, factor: Self, term: f64) -> Self;
    /// self * factor + term
    fn mul_add_constant(self, factor: Self, term: f64) -> Self;
    /// self / divisor
    fn over(self, divisor: Self) -> Self;
    /// The square root of the processor.
    fn sqrt(self) -> Self;
    /// The square root by [`Lanes::root`].
    fn root(self, simd: Self::Instructions) -> Self;
    /// `this` where self >= limit, else `other`.
    fn where_at_least(self, limit: f64, this: Self, other: Self) -> Self;
}

/// A vector of the doubles that the processor computes with at a time.
#[derive(Clone, Copy)]
pub struct Lanes<S: Simd>(pub S::f64s);

impl<S: Simd> Lanes<S> {
    /// Number of lanes.
    pub const LEN: usize = S::f64s::LEN;

    /// A vector of [`Lanes::LEN`] values.
    #[inline(always)]
    pub fn load(simd: S, values: &[f64]) -> Self {
        Lanes(S::f64s::from_slice(simd, values))
    }

    /// A vector of the first [`Lanes::LEN`] values, padded with zeros if there are fewer.
    #[inline(always)]
    pub fn load_some(simd: S, values: &[f64]) -> Self {
        if values.len() >= Self::LEN {
            return Self::load(simd, &values[..Self::LEN]);
        }
        let mut filled = [0.0; LONGEST_VECTOR];
        filled[..values.len()].copy_from_slice(values);
        Self::load(simd, &filled[..Self::LEN])
    }

    /// Transposes as many vectors as a vector has lanes; the others are unchanged.
    #[inline(always)]
    pub fn transposed(mut vectors: [Self; LONGEST_VECTOR]) -> [Self; LONGEST_VECTOR] {
        let half = Self::LEN / 2;
        // Each round moves the highest binary digit of a vector's number to the lowest digit of the
        // lane's number.
        for _ in 0..Self::LEN.ilog2() {
            let last = vectors;
            for pair in 0..half {
                let (Lanes(a), Lanes(b)) = (last[pair], last[pair + half]);
                vectors[2 * pair] = Lanes(a.zip_low(b));
                vectors[2 * pair + 1] = Lanes(a.zip_high(b));
            }
        }
        vectors
    }

    /// Writes [`Lanes::LEN`] values.
    #[inline(always)]
    pub fn store(self, values: &mut [f64]) {
        self.0.store_slice(values);
    }

    /// The value of one lane.
    #[inline(always)]
    pub fn lane(&self, index: usize) -> f64 {
        self.0[index]
    }

    /// The square root of a number between 2^-100 and 2^100, accurate to one unit in the last
    /// place.
    ///
    /// It uses multiplications alone. With long vectors this is faster than the processor's square
    /// root, which only one of its units computes.
    #[inline(always)]
    pub fn root(self, simd: S) -> Self {
        let Lanes(x) = self;
        if S::f64s::LEN <= 2 {
            return Lanes(x.sqrt());
        }
        // Half the exponent, negated, and a linear function of the digits: 1 / root to 3.5 %.
        let estimate = S::f64s::from_bits(S::f64s::splat(simd, RECIPROCAL_ROOT).to_bits() - (x.to_bits() >> 1));
        let product = x * estimate;
        let square = product * estimate;
        // square^(-1/2) on the interval of 3.5 % around 1, to 8e-7.
        let [a, b, c, d] = ROOT_CORRECTION;
        let correction = square.mul_add(square.mul_add(square.mul_add(d, c), b), a);
        let (root, reciprocal) = (product * correction, estimate * correction);
        // root (1 + h)^(-1/2) to second order in h = root^2 / x - 1, which is below 2e-6.
        let h = root.mul_sub(reciprocal, 1.0);
        Lanes((root * h).mul_add(h.mul_add(0.375, -0.5), root))
    }

    /// An upper bound of 1 / sqrt(x) for x between 2^-1000 and 2^1000, at most 0.4 % above it.
    ///
    /// The estimate is accurate to 3.5 %. Newton's step x -> x (3 - x^2) / 2 brings it to at most
    /// 0.18 % below the reciprocal root, never above.
    #[inline(always)]
    pub fn reciprocal_root_bound(self, simd: S) -> Self {
        const ABOVE: f64 = 1.002;
        let Lanes(x) = self;
        let estimate = S::f64s::from_bits(S::f64s::splat(simd, RECIPROCAL_ROOT).to_bits() - (x.to_bits() >> 1));
        let square = x * estimate * estimate;
        Lanes(estimate * square.mul_add(-0.5 * ABOVE, 1.5 * ABOVE))
    }

    /// An upper bound of log2(self / divisor), at most 0.18 above it, for positive numbers with
    /// self >= divisor. A divisor of 0 counts as 2^-1023.
    ///
    /// The bits of a number, as an integer, are a chord of its logarithm between powers of two, at
    /// most 0.0861 below the logarithm.
    #[inline(always)]
    pub fn log2_of_ratio_bound(self, simd: S, divisor: Self) -> Self {
        const CHORD: f64 = 0.0861;
        // The lowest bits are dropped, so that the rest is the fraction of a number from 2^52 on.
        const DROPPED: u32 = 12;
        let first = S::f64s::splat(simd, POWER_52);
        let difference = (self.0.to_bits() - divisor.0.to_bits()) >> DROPPED;
        let units = S::f64s::from_bits(first.to_bits() + difference) - first;
        Lanes(units.mul_add(1.0 / (POWER_52 / f64::from(1 << DROPPED)), CHORD + 1e-11))
    }

    /// Whether any value is below a limit.
    #[inline(always)]
    pub fn any_below(self, limit: f64) -> bool {
        self.0.simd_lt(limit).any_true()
    }

    /// The rounded sum and its rounding error (Knuth).
    #[inline(always)]
    pub fn two_sum(self, term: Self) -> (Self, Self) {
        let sum = self + term;
        let part = sum - self;
        (sum, (self - (sum - part)) + (term - part))
    }

    /// The square root of the processor.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Lanes(self.0.sqrt())
    }

    /// Each value rounded down to an integer.
    #[inline(always)]
    pub fn floor(self) -> Self {
        Lanes(self.0.floor())
    }

    /// The magnitude of each value.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Lanes(self.0.abs())
    }

    /// 1 or -1.
    #[inline(always)]
    pub fn sign(self, simd: S) -> Self {
        Lanes(S::f64s::splat(simd, 1.0).copysign(self.0))
    }

    /// 1 where self >= limit, else 0.
    #[inline(always)]
    pub fn at_least(self, simd: S, limit: f64) -> Self {
        Lanes(self.0.simd_ge(limit).select(S::f64s::splat(simd, 1.0), S::f64s::splat(simd, 0.0)))
    }

    /// `this` where self > limit, else `other`.
    #[inline(always)]
    pub fn where_more(self, limit: f64, this: Self, other: Self) -> Self {
        Lanes(self.0.simd_gt(limit).select(this.0, other.0))
    }

    /// 1 where self <= limit, else 0.
    #[inline(always)]
    pub fn at_most(self, simd: S, limit: f64) -> Self {
        Lanes(self.0.simd_le(limit).select(S::f64s::splat(simd, 1.0), S::f64s::splat(simd, 0.0)))
    }

    /// The smaller of two values in each lane.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        Lanes(self.0.min(other.0))
    }

    /// The larger of two values in each lane.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        Lanes(self.0.max(other.0))
    }
}

impl<S: Simd> Number for Lanes<S> {
    type Instructions = S;

    #[inline(always)]
    fn splat(simd: S, value: f64) -> Self {
        Lanes(S::f64s::splat(simd, value))
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Lanes(self.0.mul_add(factor.0, term.0))
    }

    #[inline(always)]
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        Lanes(self.0.mul_sub(factor.0, term.0))
    }

    #[inline(always)]
    fn scale_add(self, factor: f64, term: Self) -> Self {
        Lanes(self.0.mul_add(factor, term.0))
    }

    #[inline(always)]
    fn mul_sub_constant(self, factor: Self, term: f64) -> Self {
        Lanes(self.0.mul_sub(factor.0, term))
    }

    #[inline(always)]
    fn mul_add_constant(self, factor: Self, term: f64) -> Self {
        Lanes(self.0.mul_add(factor.0, term))
    }

    #[inline(always)]
    fn over(self, divisor: Self) -> Self {
        Lanes(self.0 / divisor.0)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Lanes::sqrt(self)
    }

    #[inline(always)]
    fn root(self, simd: S) -> Self {
        Lanes::root(self, simd)
    }

    #[inline(always)]
    fn where_at_least(self, limit: f64, this: Self, other: Self) -> Self {
        Lanes(self.0.simd_ge(limit).select(this.0, other.0))
    }
}

/// A pair of vectors.
#[derive(Clone, Copy)]
pub struct LanePair<S: Simd>(pub [Lanes<S>; 2]);

impl<S: Simd> Number for LanePair<S> {
    type Instructions = S;

    #[inline(always)]
    fn splat(simd: S, value: f64) -> Self {
        LanePair([Lanes::splat(simd, value); 2])
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        let ([a, b], [c, d], [e, f]) = (self.0, factor.0, term.0);
        LanePair([a.mul_add(c, e), b.mul_add(d, f)])
    }

    #[inline(always)]
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        let ([a, b], [c, d], [e, f]) = (self.0, factor.0, term.0);
        LanePair([a.mul_sub(c, e), b.mul_sub(d, f)])
    }

    #[inline(always)]
    fn scale_add(self, factor: f64, term: Self) -> Self {
        let ([a, b], [e, f]) = (self.0, term.0);
        LanePair([a.scale_add(factor, e), b.scale_add(factor, f)])
    }

    #[inline(always)]
    fn mul_sub_constant(self, factor: Self, term: f64) -> Self {
        let ([a, b], [c, d]) = (self.0, factor.0);
        LanePair([a.mul_sub_constant(c, term), b.mul_sub_constant(d, term)])
    }

    #[inline(always)]
    fn mul_add_constant(self, factor: Self, term: f64) -> Self {
        let ([a, b], [c, d]) = (self.0, factor.0);
        LanePair([a.mul_add_constant(c, term), b.mul_add_constant(d, term)])
    }

    #[inline(always)]
    fn over(self, divisor: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, divisor.0);
        LanePair([a.over(c), b.over(d)])
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let [a, b] = self.0;
        LanePair([a.sqrt(), b.sqrt()])
    }

    #[inline(always)]
    fn root(self, simd: S) -> Self {
        let [a, b] = self.0;
        LanePair([a.root(simd), b.root(simd)])
    }

    #[inline(always)]
    fn where_at_least(self, limit: f64, this: Self, other: Self) -> Self {
        let ([a, b], [c, d], [e, f]) = (self.0, this.0, other.0);
        LanePair([a.where_at_least(limit, c, e), b.where_at_least(limit, d, f)])
    }
}

impl<S: Simd> Add for LanePair<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        LanePair([a + c, b + d])
    }
}

impl<S: Simd> Sub for LanePair<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        LanePair([a - c, b - d])
    }
}

impl<S: Simd> Mul for LanePair<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        LanePair([a * c, b * d])
    }
}

impl<S: Simd> Sub<f64> for LanePair<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        let [a, b] = self.0;
        LanePair([a - other, b - other])
    }
}

impl<S: Simd> Mul<f64> for LanePair<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        let [a, b] = self.0;
        LanePair([a * other, b * other])
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Lanes(self.0 + other.0)
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Lanes(self.0 - other.0)
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Lanes(self.0 * other.0)
    }
}

impl<S: Simd> Sub<f64> for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        Lanes(self.0 - other)
    }
}

impl<S: Simd> Mul<f64> for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        Lanes(self.0 * other)
    }
}
