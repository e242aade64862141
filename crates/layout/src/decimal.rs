//! Decimal numbers with a unit, converted by moving the decimal point of their text.

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
    fn texts_that_are_no_finite_numbers_are_refused() {
        for text in ["", "e3", "1e2e3", "nan", "inf", "1 2", "1e", "--1", "1e999", "1e2147483647", "1e99999999999"] {
            assert_eq!((scaled(text, 3), scaled(text, 0)), (None, None), "{text}");
        }
        assert_eq!(scaled("1e-2147483648", -3), Some(0.0));
    }
}
