//! Logarithm and arctangent of about 31 digits.
//!
//! Each adds the correction of one Newton step to the value of the standard library. The step sums
//! the inverse function as a Taylor series.

use crate::double_double::DoubleDouble;

/// ln 2.
const LN_2: DoubleDouble = DoubleDouble { hi: std::f64::consts::LN_2, lo: 2.319_046_813_846_299_6e-17 };

/// pi / 2.
pub(crate) const HALF_PI: DoubleDouble =
    DoubleDouble { hi: std::f64::consts::FRAC_PI_2, lo: 6.123_233_995_736_766e-17 };

/// 1 / n! for n up to 19.
const INVERSE_FACTORIALS: [DoubleDouble; 20] = inverse_factorials();

/// Halvings of the argument of exp, from at most ln 2 / 2 to at most 0.011. With 13 terms the rest
/// of the series is below 1e-35.
const EXP_HALVINGS: u32 = 5;

/// Terms of the series of exp.
const EXP_TERMS: usize = 13;

/// Halvings of the argument of the sine, from at most pi / 2 to at most 0.1. With powers up to 19
/// the rest of the series is below 1e-40.
const SINE_HALVINGS: u32 = 4;

const fn inverse_factorials() -> [DoubleDouble; 20] {
    let mut inverse = [DoubleDouble::ONE; 20];
    let mut n = 1;
    while n < 20 {
        inverse[n] = inverse[n - 1].over(n as f64);
        n += 1;
    }
    inverse
}

/// exp(-x).
fn exp_of_negative(x: f64) -> DoubleDouble {
    let halves = (x / LN_2.hi).round();
    let rest = LN_2.times(halves) - DoubleDouble::new(x);
    let t = rest.scaled(0.5_f64.powi(EXP_HALVINGS as i32));
    // exp(t) - 1, which keeps its digits during the squarings.
    let mut sum = INVERSE_FACTORIALS[EXP_TERMS];
    for n in (1..EXP_TERMS).rev() {
        sum = sum * t + INVERSE_FACTORIALS[n];
    }
    let mut less_one = sum * t;
    for _ in 0..EXP_HALVINGS {
        less_one = less_one * (less_one + DoubleDouble::new(2.0));
    }
    (less_one + DoubleDouble::ONE).scaled(2_f64.powi(-(halves as i32)))
}

/// The natural logarithm of a positive number between 1e-130 and 1e130.
pub(crate) fn ln(x: DoubleDouble) -> DoubleDouble {
    let start = x.hi.ln();
    let change = x * exp_of_negative(start) - DoubleDouble::ONE;
    DoubleDouble::new(start) + change - DoubleDouble::new(0.5 * change.hi * change.hi)
}

/// Sine and cosine of an angle between 0 and pi / 2.
fn sine_and_cosine(angle: f64) -> (DoubleDouble, DoubleDouble) {
    let t = angle * 0.5_f64.powi(SINE_HALVINGS as i32);
    let square = DoubleDouble::product(t, t);
    let (mut sine, mut versine) = (INVERSE_FACTORIALS[19], INVERSE_FACTORIALS[18]);
    for n in (0..9).rev() {
        sine = INVERSE_FACTORIALS[2 * n + 1] - sine * square;
    }
    for n in (1..9).rev() {
        versine = INVERSE_FACTORIALS[2 * n] - versine * square;
    }
    let mut sine = sine.times(t);
    // 1 - cos t, which keeps its digits at small angles.
    let mut versine = versine * square;
    for _ in 0..SINE_HALVINGS {
        let squared = sine.squared();
        sine = (sine * (DoubleDouble::ONE - versine)).scaled(2.0);
        versine = squared.scaled(2.0);
    }
    (sine, DoubleDouble::ONE - versine)
}

/// The angle between 0 and pi / 2 whose tangent is y / x, of numbers that are not negative and not
/// both zero.
pub(crate) fn arctangent(y: DoubleDouble, x: DoubleDouble) -> DoubleDouble {
    if y.is_zero() {
        return DoubleDouble::ZERO;
    }
    if x.is_zero() {
        return HALF_PI;
    }
    let start = y.hi.atan2(x.hi);
    let (sine, cosine) = sine_and_cosine(start);
    DoubleDouble::new(start) + (y * cosine - x * sine) / (x * cosine + y * sine)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::rows;

    /// Relative error of each function at most 4e-31: tests/reference/README.md.
    #[test]
    fn logarithms_and_arctangents_have_31_digits() {
        for (function, numbers) in rows("functions", 23) {
            let [y, x, hi, lo] = numbers[..] else { panic!("{numbers:?}") };
            let [y, x] = [y, x].map(DoubleDouble::new);
            let value = if function == "ln" { ln(y) } else { arctangent(y, x) };
            let error = ((value.hi - hi) + (value.lo - lo)).abs() / hi.abs();
            assert!(error <= 4e-31, "{function} {numbers:?}: {value:?}");
        }
    }
}
