//! Numbers that carry their derivatives along the three axes of the tile: forward-mode
//! differentiation.
//!
//! They serve the logarithms of the edges. There every term is positive, and slopes lose no more
//! digits than powers of a length.

use std::ops::{Add, Mul, Neg, Sub};

use super::number::Scalar;
use super::offsets::Offsets;

/// A value and its derivatives with respect to x, y, z.
#[derive(Clone, Copy, Debug)]
pub struct Dual {
    pub value: f64,
    pub slope: [f64; 3],
}

impl Dual {
    /// Applies a function with derivative `rate` at `self`.
    fn chain(self, value: f64, rate: f64) -> Dual {
        Dual { value, slope: self.slope.map(|s| s * rate) }
    }

    fn combine(self, other: Dual, value: f64, slope: impl Fn(f64, f64) -> f64) -> Dual {
        let [a, b] = [self.slope, other.slope];
        Dual { value, slope: [slope(a[0], b[0]), slope(a[1], b[1]), slope(a[2], b[2])] }
    }
}

impl Add for Dual {
    type Output = Dual;
    fn add(self, other: Dual) -> Dual {
        self.combine(other, self.value + other.value, |a, b| a + b)
    }
}

impl Sub for Dual {
    type Output = Dual;
    fn sub(self, other: Dual) -> Dual {
        self.combine(other, self.value - other.value, |a, b| a - b)
    }
}

impl Mul for Dual {
    type Output = Dual;
    fn mul(self, other: Dual) -> Dual {
        let product_rule = |a: f64, b: f64| dot([a, b], [other.value, self.value]);
        self.combine(other, self.value * other.value, product_rule)
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

impl Neg for Dual {
    type Output = Dual;
    fn neg(self) -> Dual {
        self.chain(-self.value, -1.0)
    }
}

impl Scalar for Dual {
    fn constant(value: f64) -> Dual {
        Dual { value, slope: [0.0; 3] }
    }
    fn value(self) -> f64 {
        self.value
    }
    fn scale(self, factor: f64) -> Dual {
        self.chain(self.value * factor, factor)
    }
    fn recip(self) -> Dual {
        let recip = 1.0 / self.value;
        self.chain(recip, -recip * recip)
    }
    fn sqrt(self) -> Dual {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }
    fn ln(self) -> Dual {
        self.chain(self.value.ln(), 1.0 / self.value)
    }
    fn ln_1p(self) -> Dual {
        self.chain(self.value.ln_1p(), 1.0 / (1.0 + self.value))
    }
    fn atan(self) -> Dual {
        self.chain(self.value.atan(), 1.0 / (1.0 + self.value * self.value))
    }
}

impl Offsets<f64> {
    /// The same offsets with their derivatives with respect to the (scaled) point along `axis`.
    pub fn differentiated(&self, axis: usize) -> Offsets<Dual> {
        let rate = self.sign();
        let along = |value: f64, rate: f64| {
            let mut slope = [0.0; 3];
            slope[axis] = rate;
            Dual { value, slope }
        };
        Offsets {
            near: along(self.near, rate),
            far: along(self.far, rate),
            sum: along(self.sum, 2.0 * rate),
            size: self.size,
            mirrored: self.mirrored,
            on_face: self.on_face,
        }
    }
}
