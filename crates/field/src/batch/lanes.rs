//! The numbers of the vector forms.

use std::ops::{Add, Mul, Sub};

use fearless_simd::prelude::*;

/// The most doubles in a vector of any instruction set.
pub(super) const LONGEST_VECTOR: usize = 8;

/// As many doubles as the processor computes with at a time.
#[derive(Clone, Copy)]
pub(super) struct Lanes<S: Simd>(pub(super) S::f64s);

impl<S: Simd> Lanes<S> {
    pub(super) const LEN: usize = S::f64s::LEN;

    #[inline(always)]
    pub(super) fn splat(simd: S, value: f64) -> Self {
        Lanes(S::f64s::splat(simd, value))
    }

    /// From [`Lanes::LEN`] values.
    #[inline(always)]
    pub(super) fn load(simd: S, values: &[f64]) -> Self {
        Lanes(S::f64s::from_slice(simd, values))
    }

    #[inline(always)]
    pub(super) fn store(self, values: &mut [f64]) {
        self.0.store_slice(values);
    }

    #[inline(always)]
    pub(super) fn lane(&self, index: usize) -> f64 {
        self.0[index]
    }

    /// self * factor + term
    #[inline(always)]
    pub(super) fn mul_add(self, factor: Self, term: Self) -> Self {
        Lanes(self.0.mul_add(factor.0, term.0))
    }

    /// self * factor - term
    #[inline(always)]
    pub(super) fn mul_sub(self, factor: Self, term: Self) -> Self {
        Lanes(self.0.mul_sub(factor.0, term.0))
    }

    /// self * factor + term
    #[inline(always)]
    pub(super) fn scale_add(self, factor: f64, term: Self) -> Self {
        Lanes(self.0.mul_add(factor, term.0))
    }

    /// self * factor - term
    #[inline(always)]
    pub(super) fn mul_sub_constant(self, factor: Self, term: f64) -> Self {
        Lanes(self.0.mul_sub(factor.0, term))
    }

    #[inline(always)]
    pub(super) fn over(self, divisor: Self) -> Self {
        Lanes(self.0 / divisor.0)
    }

    /// The square roots of two, for squares between 2^-100 and 2^100, right to one unit in the last place.
    ///
    /// Roots in single precision, two steps of Newton's iteration in double: with long vectors twice as fast as the processor's root in double
    /// precision, which all units but one would wait for.
    #[inline(always)]
    pub(super) fn roots(Lanes(a): Self, Lanes(b): Self) -> [Self; 2] {
        if S::f64s::LEN <= 2 {
            return [Lanes(a.sqrt()), Lanes(b.sqrt())];
        }
        let single = a.narrow(b).sqrt();
        let reciprocal = single.approximate_recip();
        // One over the root to the last bits, then minus half of it.
        let reciprocal = reciprocal.mul_add(reciprocal.mul_sub(-single, -1.0), reciprocal);
        let (root_a, root_b) = single.widen();
        let (rate_a, rate_b) = (reciprocal * -0.5).widen();
        [Lanes(refined::<S>(a, root_a, rate_a)), Lanes(refined::<S>(b, root_b, rate_b))]
    }

    /// The rounded sum, and what was rounded away (Knuth).
    #[inline(always)]
    pub(super) fn two_sum(self, term: Self) -> (Self, Self) {
        let sum = self + term;
        let part = sum - self;
        (sum, (self - (sum - part)) + (term - part))
    }

    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        Lanes(self.0.sqrt())
    }

    #[inline(always)]
    pub(super) fn abs(self) -> Self {
        Lanes(self.0.abs())
    }

    /// 1 where self >= limit, else 0.
    #[inline(always)]
    pub(super) fn at_least(self, simd: S, limit: f64) -> Self {
        Lanes(self.0.simd_ge(limit).select(S::f64s::splat(simd, 1.0), S::f64s::splat(simd, 0.0)))
    }

    /// 1 where self <= limit, else 0.
    #[inline(always)]
    pub(super) fn at_most(self, simd: S, limit: f64) -> Self {
        Lanes(self.0.simd_le(limit).select(S::f64s::splat(simd, 1.0), S::f64s::splat(simd, 0.0)))
    }

    #[inline(always)]
    pub(super) fn min(self, other: Self) -> Self {
        Lanes(self.0.min(other.0))
    }

    #[inline(always)]
    pub(super) fn max(self, other: Self) -> Self {
        Lanes(self.0.max(other.0))
    }
}

/// Newton's iteration for the root of x, `rate` being -1 / 2 root.
#[inline(always)]
fn refined<S: Simd>(x: S::f64s, root: S::f64s, rate: S::f64s) -> S::f64s {
    let better = root.mul_sub(root, x).mul_add(rate, root);
    better.mul_sub(better, x).mul_add(rate, better)
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
