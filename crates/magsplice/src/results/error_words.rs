//! Errors of tiles in words.

use magsplice_scan::{DetectedError, ErrorKind, FittedError};

/// Strength of a tile, over that of the layout, up to which its J is that of no magnet.
const ABSENT: f64 = 0.05;

/// Standard deviations of a strength within which it may be 0.
const CERTAIN: f64 = 2.0;

/// An error in words, with its magnitude.
pub(super) fn in_words(detected: &DetectedError) -> String {
    let (magnitude, deviation) = (detected.magnitude(), detected.magnitude_deviation());
    let per_cent = |value: f64| rounded(100.0 * value, 100.0 * deviation, 2);
    let degrees = || rounded(magnitude.to_degrees(), deviation.to_degrees(), 2);
    if !detected.components.iter().any(FittedError::is_significant) {
        return "an error that the scan does not resolve, of this tile or of another".to_owned();
    }
    let strength = 1.0 + magnitude;
    match detected.candidate.kind {
        ErrorKind::Strength if strength.abs().max(CERTAIN * deviation) < ABSENT => {
            "missing, or not magnetized".to_owned()
        }
        ErrorKind::Strength if strength.abs() < CERTAIN * deviation => {
            format!(
                "weak, missing or reversed, with {} +- {} % of its strength",
                per_cent(strength),
                per_cent(deviation)
            )
        }
        ErrorKind::Strength if strength < 0.0 => format!("reversed, with {} % of its strength", per_cent(-strength)),
        ErrorKind::Strength if magnitude < 0.0 => format!("{} % too weak", per_cent(-magnitude)),
        ErrorKind::Strength => format!("{} % too strong", per_cent(magnitude)),
        ErrorKind::Turn => format!("turned by {} deg", degrees()),
        ErrorKind::Direction => format!("J turned by {} deg", degrees()),
        _ => format!("displaced by {} mm", rounded(magnitude, deviation, 3)),
    }
}

/// A number with at most this many decimals: without those after the first digit of its deviation,
/// and with at least one digit.
fn rounded(value: f64, deviation: f64, decimals: i32) -> String {
    let place = |value: f64| if value == 0.0 { 0 } else { -value.abs().log10().floor() as i32 };
    let known = if deviation > 0.0 { place(deviation).clamp(0, decimals) } else { decimals };
    let decimals = if value.is_finite() { known.max(place(value)) } else { 0 };
    format!("{value:.*}", decimals.max(0) as usize)
}

#[cfg(test)]
mod tests {
    use magsplice_magnet::TileError;
    use magsplice_scan::Candidate;

    use super::*;

    /// A value below two of its deviations is no value.
    #[test]
    fn errors_below_their_deviation_have_no_magnitude() {
        let words = |value: f64, deviation: f64| {
            let candidate = Candidate { tile: 0, kind: ErrorKind::Strength };
            let components = vec![FittedError { error: TileError::Strength, value, deviation }];
            let alternatives = Vec::new();
            in_words(&DetectedError { candidate, components, chi_squared: 30.0, ln_probability: -20.0, alternatives })
        };
        assert_eq!(words(-0.036, 0.051), "an error that the scan does not resolve, of this tile or of another");
        assert_eq!(words(-0.36, 0.051), "36 % too weak");
    }

    #[test]
    fn digits_end_at_the_deviation() {
        let words = [(83.1251, 15.9), (2.968, 0.04), (0.0032, 0.0), (5.0, 0.0), (0.61, 0.5)]
            .map(|(value, deviation)| rounded(value, deviation, 2));
        assert_eq!(words, ["83", "2.97", "0.003", "5.00", "0.6"]);
    }
}
