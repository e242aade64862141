//! The number types of the scalar kernel.

use std::ops::{Add, Mul, Neg, Sub};

/// A real number, optionally with derivatives.
///
/// The kernel is generic over this trait: with `f64` it gives the field, with
/// [`Dual`](super::dual::Dual) the field and its gradient. Branches depend on
/// [`value`](Scalar::value) alone.
pub trait Scalar: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> {
    /// A number that does not depend on the point.
    fn constant(value: f64) -> Self;
    fn value(self) -> f64;
    fn scale(self, factor: f64) -> Self;
    fn recip(self) -> Self;
    fn sqrt(self) -> Self;
    fn ln(self) -> Self;
    /// ln(1 + self)
    fn ln_1p(self) -> Self;
    fn atan(self) -> Self;

    fn square(self) -> Self {
        self * self
    }
    fn over(self, divisor: Self) -> Self {
        self * divisor.recip()
    }
    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }
}

impl Scalar for f64 {
    fn constant(value: f64) -> f64 {
        value
    }
    fn value(self) -> f64 {
        self
    }
    fn scale(self, factor: f64) -> f64 {
        self * factor
    }
    fn recip(self) -> f64 {
        1.0 / self
    }
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }
    fn ln(self) -> f64 {
        f64::ln(self)
    }
    fn ln_1p(self) -> f64 {
        f64::ln_1p(self)
    }
    fn atan(self) -> f64 {
        f64::atan(self)
    }
    fn over(self, divisor: f64) -> f64 {
        self / divisor
    }
}
