//! Numbers that carry their derivatives along three axes: forward-mode differentiation in vectors.

use std::ops::{Add, Mul, Sub};

use crate::lanes::Number;

/// A number and its derivatives along x, y, z.
#[derive(Clone, Copy)]
pub struct Differentiated<N> {
    /// The number.
    pub value: N,
    /// Its derivatives.
    pub slope: [N; 3],
}

impl<N: Number> Differentiated<N> {
    /// A coordinate along `axis`.
    #[inline(always)]
    pub fn coordinate(simd: N::Instructions, value: N, axis: usize) -> Self {
        let mut slope = [N::splat(simd, 0.0); 3];
        slope[axis] = N::splat(simd, 1.0);
        Differentiated { value, slope }
    }
}

// Loops instead of closures: the compiler does not inline operations on vectors in a closure.

impl<N: Number> Add for Differentiated<N> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        self.value = self.value + other.value;
        for (own, other) in self.slope.iter_mut().zip(other.slope) {
            *own = *own + other;
        }
        self
    }
}

impl<N: Number> Sub for Differentiated<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        self.value = self.value - other.value;
        for (own, other) in self.slope.iter_mut().zip(other.slope) {
            *own = *own - other;
        }
        self
    }
}

impl<N: Number> Mul for Differentiated<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(mut self, other: Self) -> Self {
        for (own, slope) in self.slope.iter_mut().zip(other.slope) {
            *own = own.mul_add(other.value, self.value * slope);
        }
        self.value = self.value * other.value;
        self
    }
}

impl<N: Number> Sub<f64> for Differentiated<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, other: f64) -> Self {
        self.value = self.value - other;
        self
    }
}

impl<N: Number> Mul<f64> for Differentiated<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(mut self, factor: f64) -> Self {
        self.value = self.value * factor;
        for slope in &mut self.slope {
            *slope = *slope * factor;
        }
        self
    }
}

impl<N: Number> Number for Differentiated<N> {
    type Instructions = N::Instructions;

    #[inline(always)]
    fn splat(simd: N::Instructions, value: f64) -> Self {
        Differentiated { value: N::splat(simd, value), slope: [N::splat(simd, 0.0); 3] }
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        let mut result = term;
        for axis in 0..3 {
            let own = self.value.mul_add(factor.slope[axis], term.slope[axis]);
            result.slope[axis] = self.slope[axis].mul_add(factor.value, own);
        }
        result.value = self.value.mul_add(factor.value, term.value);
        result
    }

    #[inline(always)]
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        let mut result = term;
        for axis in 0..3 {
            let own = self.value.mul_sub(factor.slope[axis], term.slope[axis]);
            result.slope[axis] = self.slope[axis].mul_add(factor.value, own);
        }
        result.value = self.value.mul_sub(factor.value, term.value);
        result
    }

    #[inline(always)]
    fn scale_add(self, factor: f64, term: Self) -> Self {
        let mut result = term;
        for axis in 0..3 {
            result.slope[axis] = self.slope[axis].scale_add(factor, term.slope[axis]);
        }
        result.value = self.value.scale_add(factor, term.value);
        result
    }

    #[inline(always)]
    fn mul_sub_constant(self, factor: Self, term: f64) -> Self {
        let mut product = self * factor;
        product.value = self.value.mul_sub_constant(factor.value, term);
        product
    }

    #[inline(always)]
    fn mul_add_constant(self, factor: Self, term: f64) -> Self {
        let mut product = self * factor;
        product.value = self.value.mul_add_constant(factor.value, term);
        product
    }

    #[inline(always)]
    fn over(self, divisor: Self) -> Self {
        let mut result = self;
        result.value = self.value.over(divisor.value);
        for axis in 0..3 {
            let numerator = self.slope[axis] - result.value * divisor.slope[axis];
            result.slope[axis] = numerator.over(divisor.value);
        }
        result
    }

    #[inline(always)]
    fn sqrt(mut self) -> Self {
        let root = self.value.sqrt();
        let half_rate = root.over(self.value) * 0.5;
        for slope in &mut self.slope {
            *slope = *slope * half_rate;
        }
        self.value = root;
        self
    }

    #[inline(always)]
    fn root(self, _: N::Instructions) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn where_at_least(self, limit: f64, this: Self, other: Self) -> Self {
        let mut chosen = this;
        chosen.value = self.value.where_at_least(limit, this.value, other.value);
        for axis in 0..3 {
            chosen.slope[axis] = self.value.where_at_least(limit, this.slope[axis], other.slope[axis]);
        }
        chosen
    }
}
