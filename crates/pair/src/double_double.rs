//! Numbers of about 32 digits: unevaluated sums of two f64.
//!
//! Algorithms: Dekker (1971); Joldes, Muller and Popescu (2017, "Tight and rigorous error bounds
//! for basic building blocks of double-word arithmetic"). Products use Dekker's splitting instead
//! of a fused multiplication, which gives the same bits at the same speed on every machine.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// 2^27 + 1: splits a number into halves whose products are exact (Dekker).
const SPLITTER: f64 = 134_217_729.0;

/// A sum of two f64, the second at most half a unit in the last place of the first. The relative
/// error of each operation is about 1e-31, for magnitudes between 1e-130 and 1e150.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DoubleDouble {
    pub(crate) hi: f64,
    pub(crate) lo: f64,
}

impl DoubleDouble {
    pub(crate) const ZERO: DoubleDouble = DoubleDouble::new(0.0);
    pub(crate) const ONE: DoubleDouble = DoubleDouble::new(1.0);

    pub(crate) const fn new(value: f64) -> DoubleDouble {
        DoubleDouble { hi: value, lo: 0.0 }
    }

    /// The exact sum of two numbers.
    pub(crate) const fn sum(a: f64, b: f64) -> DoubleDouble {
        let hi = a + b;
        let part = hi - a;
        DoubleDouble { hi, lo: (a - (hi - part)) + (b - part) }
    }

    /// The exact product of two numbers.
    pub(crate) const fn product(a: f64, b: f64) -> DoubleDouble {
        let hi = a * b;
        let ((a1, a2), (b1, b2)) = (split(a), split(b));
        DoubleDouble { hi, lo: ((a1 * b1 - hi) + a1 * b2 + a2 * b1) + a2 * b2 }
    }

    /// The exact sum of two numbers, the first of larger magnitude.
    const fn ordered_sum(a: f64, b: f64) -> DoubleDouble {
        let hi = a + b;
        DoubleDouble { hi, lo: b - (hi - a) }
    }

    pub(crate) fn is_zero(self) -> bool {
        self.hi == 0.0
    }

    /// The product with a power of two, which is exact.
    pub(crate) fn scaled(self, power_of_two: f64) -> DoubleDouble {
        DoubleDouble { hi: self.hi * power_of_two, lo: self.lo * power_of_two }
    }

    pub(crate) const fn times(self, factor: f64) -> DoubleDouble {
        let p = DoubleDouble::product(self.hi, factor);
        DoubleDouble::ordered_sum(p.hi, p.lo + self.lo * factor)
    }

    pub(crate) const fn over(self, divisor: f64) -> DoubleDouble {
        let quotient = self.hi / divisor;
        let p = DoubleDouble::product(quotient, divisor);
        let rest = (self.hi - p.hi) - p.lo + self.lo;
        DoubleDouble::ordered_sum(quotient, rest / divisor)
    }

    pub(crate) fn squared(self) -> DoubleDouble {
        self * self
    }

    /// The square root; zero of zero.
    pub(crate) fn sqrt(self) -> DoubleDouble {
        if self.hi == 0.0 {
            return DoubleDouble::ZERO;
        }
        let root = self.hi.sqrt();
        let rest = self - DoubleDouble::product(root, root);
        DoubleDouble::ordered_sum(root, rest.hi / (2.0 * root))
    }

    pub(crate) fn to_f64(self) -> f64 {
        self.hi + self.lo
    }
}

const fn split(a: f64) -> (f64, f64) {
    let scaled = SPLITTER * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

impl Neg for DoubleDouble {
    type Output = DoubleDouble;

    fn neg(self) -> DoubleDouble {
        DoubleDouble { hi: -self.hi, lo: -self.lo }
    }
}

impl Add for DoubleDouble {
    type Output = DoubleDouble;

    fn add(self, other: DoubleDouble) -> DoubleDouble {
        let high = DoubleDouble::sum(self.hi, other.hi);
        let low = DoubleDouble::sum(self.lo, other.lo);
        let sum = DoubleDouble::ordered_sum(high.hi, high.lo + low.hi);
        DoubleDouble::ordered_sum(sum.hi, low.lo + sum.lo)
    }
}

impl AddAssign for DoubleDouble {
    fn add_assign(&mut self, other: DoubleDouble) {
        *self = *self + other;
    }
}

impl Sub for DoubleDouble {
    type Output = DoubleDouble;

    fn sub(self, other: DoubleDouble) -> DoubleDouble {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = DoubleDouble;

    fn mul(self, other: DoubleDouble) -> DoubleDouble {
        let p = DoubleDouble::product(self.hi, other.hi);
        DoubleDouble::ordered_sum(p.hi, p.lo + (self.hi * other.lo + self.lo * other.hi))
    }
}

impl Div for DoubleDouble {
    type Output = DoubleDouble;

    fn div(self, other: DoubleDouble) -> DoubleDouble {
        let quotient = self.hi / other.hi;
        let rest = self - other.times(quotient);
        let correction = rest.hi / other.hi;
        let sum = DoubleDouble::ordered_sum(quotient, correction);
        let rest = rest - other.times(correction);
        DoubleDouble::ordered_sum(sum.hi, sum.lo + rest.hi / other.hi)
    }
}
