//! The number types of the functions of corners.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use fearless_simd::prelude::*;
use magsplice_simd::lanes::Lanes;

use crate::double_double::DoubleDouble;
use crate::functions;

/// A number in a polynomial: a real number, or a vector of real numbers.
pub(crate) trait Arithmetic: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    fn times(self, factor: f64) -> Self;

    /// The product with a power of two.
    #[inline(always)]
    fn scaled(self, power_of_two: f64) -> Self {
        self.times(power_of_two)
    }
}

/// A real number of 16 or of 32 digits.
pub(crate) trait Real: Arithmetic + AddAssign + Div<Output = Self> + Neg<Output = Self> {
    const ZERO: Self;
    const HALF_PI: Self;

    /// The sum of two numbers, rounded once.
    fn sum(a: f64, b: f64) -> Self;

    /// The product of two numbers, rounded once.
    fn product(a: f64, b: f64) -> Self;

    fn rounded(value: DoubleDouble) -> Self;

    fn to_f64(self) -> f64;

    fn sqrt(self) -> Self;

    /// The natural logarithm of a positive number.
    fn ln(self) -> Self;

    /// The angle between 0 and pi / 2 whose tangent is y / x, of numbers that are not negative and
    /// not both zero.
    fn arctangent(y: Self, x: Self) -> Self;

    fn is_zero(self) -> bool {
        self.to_f64() == 0.0
    }

    fn abs(self) -> Self {
        if self.to_f64() < 0.0 { -self } else { self }
    }

    fn squared(self) -> Self {
        self * self
    }
}

impl<S: Simd> Arithmetic for Lanes<S> {
    #[inline(always)]
    fn times(self, factor: f64) -> Lanes<S> {
        self * factor
    }
}

impl Arithmetic for f64 {
    fn times(self, factor: f64) -> f64 {
        self * factor
    }
}

impl Arithmetic for DoubleDouble {
    fn times(self, factor: f64) -> DoubleDouble {
        DoubleDouble::times(self, factor)
    }

    fn scaled(self, power_of_two: f64) -> DoubleDouble {
        DoubleDouble::scaled(self, power_of_two)
    }
}

impl Real for f64 {
    const ZERO: f64 = 0.0;
    const HALF_PI: f64 = std::f64::consts::FRAC_PI_2;

    fn sum(a: f64, b: f64) -> f64 {
        a + b
    }

    fn product(a: f64, b: f64) -> f64 {
        a * b
    }

    fn rounded(value: DoubleDouble) -> f64 {
        value.to_f64()
    }

    fn to_f64(self) -> f64 {
        self
    }

    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }

    fn ln(self) -> f64 {
        f64::ln(self)
    }

    fn arctangent(y: f64, x: f64) -> f64 {
        y.atan2(x)
    }
}

impl Real for DoubleDouble {
    const ZERO: DoubleDouble = DoubleDouble::ZERO;
    const HALF_PI: DoubleDouble = functions::HALF_PI;

    fn sum(a: f64, b: f64) -> DoubleDouble {
        DoubleDouble::sum(a, b)
    }

    fn product(a: f64, b: f64) -> DoubleDouble {
        DoubleDouble::product(a, b)
    }

    fn rounded(value: DoubleDouble) -> DoubleDouble {
        value
    }

    fn to_f64(self) -> f64 {
        DoubleDouble::to_f64(self)
    }

    fn sqrt(self) -> DoubleDouble {
        DoubleDouble::sqrt(self)
    }

    fn ln(self) -> DoubleDouble {
        functions::ln(self)
    }

    fn arctangent(y: DoubleDouble, x: DoubleDouble) -> DoubleDouble {
        functions::arctangent(y, x)
    }
}
