//! Decimal numbers with a unit, converted by moving the decimal point of their text.

use glam::DVec3;

/// The number in `text` times a power of ten, rounded once: 3.3 with the exponent -3 is the number
/// that 0.0033 is. `None` for anything but a finite number.
pub fn scaled(text: &str, exponent: i32) -> Option<f64> {
    let value = if exponent == 0 {
        text.parse::<f64>().ok()?
    } else {
        let (digits, own) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        // Without this an empty text and a second exponent would become numbers.
        if !digits.ends_with(|c: char| c.is_ascii_digit() || c == '.') {
            return None;
        }
        let own: i32 = own.parse().ok()?;
        format!("{digits}e{}", own.saturating_add(exponent)).parse::<f64>().ok()?
    };
    value.is_finite().then_some(value)
}

/// Powers of ten that are exact in binary, of the last digits of coordinates: 15 digits of numbers
/// below 1, and of numbers below 1000.
const LAST_DIGITS: [i32; 2] = [15, 12];

/// The number with the shortest digits of `value` and its decimal point moved by `exponent` places:
/// 0.0041 with the exponent 3 is 4.1, which 0.0041 times 1000 is not. Numbers that are not finite
/// are unchanged.
pub fn shifted(value: f64, exponent: i32) -> f64 {
    // A number of up to 15 digits is the quotient of two whole numbers that are exact in binary, so
    // one division rounds it. This takes a tenth of the time of its text.
    for last in LAST_DIGITS {
        let whole = (value * 10f64.powi(last)).round();
        if whole.abs() < 1e15 && whole / 10f64.powi(last) == value && (0..=15).contains(&(last - exponent)) {
            return whole / 10f64.powi(last - exponent);
        }
    }
    scaled(&format!("{value:e}"), exponent).unwrap_or(value)
}

/// A vector with the decimal points of its components moved, see [`shifted`].
pub fn shifted_vector(vector: DVec3, exponent: i32) -> DVec3 {
    vector.to_array().map(|value| shifted(value, exponent)).into()
}

/// The number at the beginning of a text, and the unit behind it, which may be empty.
pub fn with_unit(text: &str) -> (&str, &str) {
    let end = text.rfind(|c: char| c.is_ascii_digit() || c == '.').map_or(text.len(), |last| last + 1);
    (text[..end].trim(), text[end..].trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_once() {
        assert_eq!(scaled("0.0033", 3), Some(3.3));
        assert_eq!(scaled("3.3", -3), Some(0.0033));
        assert_eq!(scaled("-1.7E-3", 3), Some(-1.7));
        assert_eq!(scaled("+.1", -6), Some(1e-7));
        assert_eq!(scaled("7.", 0), Some(7.0));
    }

    #[test]
    fn moved_points_keep_all_digits() {
        assert_ne!(0.0041 * 1e3, 4.1);
        for text in ["0", "0.0041", "-0.07", "0.57", "1.23456789012345e-3", "999.999999999999", "5e-324", "1e300"] {
            let value: f64 = text.parse().unwrap();
            for exponent in [3, -3] {
                assert_eq!(shifted(value, exponent), scaled(text, exponent).unwrap(), "{text} by {exponent}");
            }
        }
        // Seventeen digits, and the last ones of a sum.
        for value in [0.1 + 0.2, 1.0 / 3.0, -2e3 / 7.0, 0.57 + 4e-16] {
            assert_eq!(Some(shifted(value, 3)), scaled(&value.to_string(), 3));
        }
        for index in 0..10_000 {
            let value = f64::from(index) * 1e-5;
            assert_eq!(Some(shifted(value, 3)), scaled(&value.to_string(), 3));
        }
        // Exponents for which no power of ten is exact, and none at all.
        for exponent in [0, 1, 12, 15, 16, 20, -1, -12, -15, -20] {
            for text in ["0.57", "123.456", "1e-9"] {
                let value: f64 = text.parse().unwrap();
                assert_eq!(Some(shifted(value, exponent)), scaled(text, exponent), "{text} by {exponent}");
            }
        }
        assert!(shifted(f64::NAN, 3).is_nan() && shifted(f64::INFINITY, 3) == f64::INFINITY);
    }

    #[test]
    fn texts_that_are_no_finite_numbers_are_refused() {
        for text in ["", "e3", "1e2e3", "nan", "inf", "1 2", "1e", "--1", "1e999", "1e2147483647", "1e99999999999"] {
            assert_eq!((scaled(text, 3), scaled(text, 0)), (None, None), "{text}");
        }
        assert_eq!(scaled("1e-2147483648", -3), Some(0.0));
    }

    #[test]
    fn points_of_vectors_are_moved() {
        assert_eq!(shifted_vector(DVec3::new(0.0041, -0.57, 12.0), 3), DVec3::new(4.1, -570.0, 12000.0));
    }

    #[test]
    fn units_are_behind_the_last_digit() {
        for (text, known) in [
            ("10nT", ("10", "nT")),
            (" 1e-5  mT ", ("1e-5", "mT")),
            ("7.", ("7.", "")),
            ("-0.5", ("-0.5", "")),
            ("few", ("few", "")),
            ("", ("", "")),
        ] {
            assert_eq!(with_unit(text), known, "{text:?}");
        }
    }
}
