//! Numbers that record their roundings, for the error analysis of every form.
//!
//! Each operation rounds once. To first order, the error of a result is the sum over all roundings
//! before it of the rounding times the derivative of the result by that operand. The recorded
//! operations give all derivatives, from the last operation to the first (reverse-mode
//! differentiation). The sum of their magnitudes bounds the error for any roundings. An error that
//! reaches the result in several ways, such as that of an offset, counts once, with its sign.
//!
//! The methods are generic over their numbers, so the analysis runs the code that computes fields.

use std::cell::RefCell;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, FRAC_PI_8, LN_2, PI, SQRT_2};
use std::marker::PhantomData;
use std::ops::{Add, Mul, Neg, Sub};

use fearless_simd::Simd;
use magsplice_magnet::tolerances::UNIT_ROUNDOFF;
use magsplice_simd::functions::{Functions, Reduced};
use magsplice_simd::lanes::Number;

use crate::scalar::number::Scalar;
use crate::scalar::offsets::Offsets;

/// Roundings of a constant of a tile, such as an area from two sides, each a difference of faces.
const CONSTANT_ROUNDINGS: f64 = 4.0;

/// Roundings of a function of the standard library and of `Lanes::root`, which have an error of at
/// most one unit in the last place.
const FUNCTION_ROUNDINGS: f64 = 2.0;

/// An operation: its operands with the derivatives by them, and the size of its rounding in units
/// of round-off.
struct Operation {
    operands: [(Option<usize>, f64); 2],
    rounding: f64,
}

thread_local! {
    static OPERATIONS: RefCell<Vec<Operation>> = const { RefCell::new(Vec::new()) };
}

/// Forgets all operations. Numbers from before must not be used again.
pub(crate) fn forget_operations() {
    OPERATIONS.with_borrow_mut(Vec::clear);
}

/// A number and the operation that computed it; none for exact numbers. The methods need a token of
/// vector instructions, which it does not use.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rounded<S> {
    pub(crate) value: f64,
    operation: Option<usize>,
    instructions: PhantomData<S>,
}

impl<S: Simd> Rounded<S> {
    /// A number without error.
    pub(crate) fn exact(value: f64) -> Self {
        Rounded { value, operation: None, instructions: PhantomData }
    }

    /// Bound of the error.
    pub(crate) fn error(self) -> f64 {
        let Some(last) = self.operation else { return 0.0 };
        OPERATIONS.with_borrow(|operations| {
            let mut derivatives = vec![0.0; last + 1];
            derivatives[last] = 1.0;
            let mut sum = 0.0;
            for (index, operation) in operations[..=last].iter().enumerate().rev() {
                let own: f64 = derivatives[index];
                sum += own.abs() * operation.rounding;
                for (operand, derivative) in operation.operands {
                    if let Some(operand) = operand {
                        derivatives[operand] += own * derivative;
                    }
                }
            }
            UNIT_ROUNDOFF * sum
        })
    }

    fn computed(value: f64, operands: [(Self, f64); 2], rounding: f64) -> Self {
        let operands = operands.map(|(operand, derivative)| (operand.operation, derivative));
        let operation = OPERATIONS.with_borrow_mut(|operations| {
            operations.push(Operation { operands, rounding });
            operations.len() - 1
        });
        Rounded { value, operation: Some(operation), instructions: PhantomData }
    }

    /// A constant. Powers of two and zero are exact.
    fn given(value: f64) -> Self {
        if is_power_of_two(value) {
            return Self::exact(value);
        }
        let nothing = (Self::exact(0.0), 0.0);
        Self::computed(value, [nothing, nothing], CONSTANT_ROUNDINGS * value.abs())
    }

    /// A number that was rounded once.
    fn nearest(value: f64) -> Self {
        let nothing = (Self::exact(0.0), 0.0);
        Self::computed(value, [nothing, nothing], value.abs())
    }

    /// A function with this derivative at `self`.
    fn function(self, value: f64, slope: f64) -> Self {
        Self::computed(value, [(self, slope), (Self::exact(0.0), 0.0)], FUNCTION_ROUNDINGS * value.abs())
    }
}

/// Whether products by this number are exact.
fn is_power_of_two(value: f64) -> bool {
    const FRACTION: u64 = (1 << 52) - 1;
    value.to_bits() & FRACTION == 0
}

impl<S: Simd> Add for Rounded<S> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let value = self.value + other.value;
        // The difference of numbers within a factor of two is exact (Sterbenz).
        let is_exact = value.abs() <= self.value.abs().min(other.value.abs());
        Self::computed(value, [(self, 1.0), (other, 1.0)], if is_exact { 0.0 } else { value.abs() })
    }
}

impl<S: Simd> Sub for Rounded<S> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<S: Simd> Neg for Rounded<S> {
    type Output = Self;
    fn neg(self) -> Self {
        Self::computed(-self.value, [(self, -1.0), (Self::exact(0.0), 0.0)], 0.0)
    }
}

impl<S: Simd> Mul for Rounded<S> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let value = self.value * other.value;
        let is_exact = other.operation.is_none() && is_power_of_two(other.value);
        let rounding = if is_exact { 0.0 } else { value.abs() };
        Self::computed(value, [(self, other.value), (other, self.value)], rounding)
    }
}

impl<S: Simd> Sub<f64> for Rounded<S> {
    type Output = Self;
    fn sub(self, other: f64) -> Self {
        // The numbers that are subtracted are coordinates of faces and whole numbers.
        self - Self::exact(other)
    }
}

impl<S: Simd> Mul<f64> for Rounded<S> {
    type Output = Self;
    fn mul(self, other: f64) -> Self {
        self * Self::given(other)
    }
}

// Some instruction sets have no fused multiplication and addition, so both operations round.
impl<S: Simd> Number for Rounded<S> {
    type Instructions = S;

    fn splat(_: S, value: f64) -> Self {
        Rounded::given(value)
    }
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        self * factor - term
    }
    fn scale_add(self, factor: f64, term: Self) -> Self {
        self * factor + term
    }
    fn mul_sub_constant(self, factor: Self, term: f64) -> Self {
        self * factor - term
    }
    fn mul_add_constant(self, factor: Self, term: f64) -> Self {
        self * factor + Rounded::given(term)
    }
    fn over(self, divisor: Self) -> Self {
        let value = self.value / divisor.value;
        let inverse = 1.0 / divisor.value;
        Self::computed(value, [(self, inverse), (divisor, -value * inverse)], value.abs())
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        Self::computed(root, [(self, 0.5 / root), (Self::exact(0.0), 0.0)], root)
    }
    fn root(self, _: S) -> Self {
        let root = self.value.sqrt();
        self.function(root, 0.5 / root)
    }
    fn where_at_least(self, limit: f64, this: Self, other: Self) -> Self {
        if self.value >= limit { this } else { other }
    }
}

impl<S: Simd> Functions for Rounded<S> {
    fn artanh_of_ratio(_: S, n: Self, m: Self) -> Reduced<Self> {
        let (power, base) = nearest_power((m + n).value / (m - n).value);
        let (sum, difference) = (Rounded::exact(1.0 + power), Rounded::exact(1.0 - power));
        Reduced::of_logarithm(m * difference + n * sum, n * difference + m * sum, base)
    }
    fn angle(_: S, re: Self, im: Self) -> Reduced<Self> {
        let (x, y) = (Scalar::abs(re), Scalar::abs(im));
        let steep = y.value > x.value;
        let (low, high) = if steep { (x, y) } else { (y, x) };
        let slope = low.value / high.value;
        let (tangent, taken_off) = if slope > (3.0 * PI / 16.0).tan() {
            (1.0, FRAC_PI_4)
        } else if slope > (PI / 16.0).tan() {
            (SQRT_2 - 1.0, FRAC_PI_8)
        } else {
            (0.0, 0.0)
        };
        let right = if steep { FRAC_PI_2 - taken_off } else { taken_off };
        let half_turn = if re.value < 0.0 { PI - right } else { right };
        let reflections = [steep, re.value < 0.0, im.value < 0.0].into_iter().filter(|is| *is).count();
        let sign = Rounded::exact(if reflections % 2 == 0 { 1.0 } else { -1.0 });
        let base = Rounded::given(half_turn.copysign(im.value));
        Reduced::of_angle(low - high * tangent, low * tangent + high, base, sign)
    }
    fn half_logarithm_of_ratio(_: S, a: Self, b: Self) -> Reduced<Self> {
        let (power, base) = nearest_power(a.value / b.value);
        Reduced::of_logarithm(a - b * power, a + b * power, base)
    }
}

/// The nearest power of two and half its logarithm.
fn nearest_power<S: Simd>(ratio: f64) -> (f64, Rounded<S>) {
    let exponent = ratio.log2().round();
    (exponent.exp2(), Rounded::given(0.5 * LN_2 * exponent))
}

impl<S: Simd> Scalar for Rounded<S> {
    fn constant(value: f64) -> Self {
        Rounded::given(value)
    }
    fn value(self) -> f64 {
        self.value
    }
    fn scale(self, factor: f64) -> Self {
        self * factor
    }
    fn recip(self) -> Self {
        Number::over(Rounded::exact(1.0), self)
    }
    fn sqrt(self) -> Self {
        Number::sqrt(self)
    }
    fn ln(self) -> Self {
        self.function(self.value.ln(), 1.0 / self.value)
    }
    fn ln_1p(self) -> Self {
        self.function(self.value.ln_1p(), 1.0 / (1.0 + self.value))
    }
    fn atan(self) -> Self {
        self.function(self.value.atan(), 1.0 / (1.0 + self.value * self.value))
    }
    fn over(self, divisor: Self) -> Self {
        Number::over(self, divisor)
    }
}

/// Offsets of a point, each rounded once.
fn rounded_offsets<S: Simd>(offsets: &Offsets<f64>) -> Offsets<Rounded<S>> {
    Offsets {
        near: Rounded::nearest(offsets.near),
        far: Rounded::nearest(offsets.far),
        sum: Rounded::nearest(offsets.sum),
        size: offsets.size,
        mirrored: offsets.mirrored,
        on_face: offsets.on_face,
    }
}

mod tests;
