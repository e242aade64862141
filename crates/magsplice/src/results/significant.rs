//! Numbers with as many digits as a person would write.

/// Significant digits of numbers for people and machine tools. Round-off of sums and products of a
/// few numbers lies beyond them, and a tool's steps, 1e-3 mm, far above.
const DIGITS: i32 = 12;

/// The value rounded to twelve significant digits: 27.424 for 27.424000000000003.
pub fn twelve_digits(value: f64) -> f64 {
    rounded_beside(value, value)
}

/// The value rounded to the last of the twelve digits of `largest`. Beside a coordinate of 10 mm,
/// 1e-16 mm is round-off of 0.
pub fn rounded_beside(value: f64, largest: f64) -> f64 {
    if largest == 0.0 || !largest.is_finite() {
        return value;
    }
    let decimals = DIGITS - 1 - largest.abs().log10().floor() as i32;
    // Through decimal text, so that 3.3 stays 3.3. Adding 0 turns -0 into 0.
    let text = match usize::try_from(decimals) {
        Ok(decimals) => format!("{value:.decimals$}"),
        Err(_) => format!("{value:.*e}", (DIGITS - 1) as usize),
    };
    text.parse().unwrap_or(value) + 0.0
}

/// Six decimals, or six significant digits where six decimals would lose them or be too wide.
pub fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        // Adding 0 turns -0 into 0.
        format!("{:.6}", value + 0.0)
    } else {
        format!("{value:.5e}")
    }
}

/// Three significant digits, of a ratio in a sentence.
pub(super) fn ratio(value: f64) -> String {
    let decimals = 2 - value.abs().log10().floor().clamp(-3.0, 2.0) as i32;
    if value.is_finite() && value.abs() < 1e5 { format!("{value:.*}", decimals.max(0) as usize) } else { number(value) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_have_three_digits() {
        let words = [257.981_22, 1.2345, 0.7318, 12.0, 31_304.6].map(ratio);
        assert_eq!(words, ["258", "1.23", "0.732", "12.0", "31305"]);
    }

    #[test]
    fn round_off_is_dropped_and_written_digits_stay() {
        assert_eq!(twelve_digits(27.424000000000003), 27.424);
        assert_eq!(twelve_digits(3.9819999999999998), 3.982);
        for value in [0.0, 3.3, -0.85, 1e-300, 123456789012.0, 1e22, 0.123456789012] {
            assert_eq!(twelve_digits(value), value);
        }
        assert_eq!(rounded_beside(-5.6e-17, 10.0).to_bits(), 0);
        assert_eq!(rounded_beside(0.0005, 10.0), 0.0005);
    }
}
