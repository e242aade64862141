//! Errors of tiles in words.

use magsplice_scan::{DetectedError, ErrorKind};

/// Strength of a tile, over that of the layout, up to which its J is that of no magnet.
const ABSENT: f64 = 0.05;

/// An error in words, with its magnitude.
pub(super) fn in_words(detected: &DetectedError) -> String {
    let magnitude = detected.magnitude();
    match detected.candidate.kind {
        ErrorKind::Strength if (1.0 + magnitude).abs() < ABSENT => "missing, or not magnetized".to_owned(),
        ErrorKind::Strength if magnitude < -1.0 => {
            format!("reversed, with {} % of its strength", rounded(-100.0 * (1.0 + magnitude), 2))
        }
        ErrorKind::Strength if magnitude < 0.0 => format!("{} % too weak", rounded(-100.0 * magnitude, 2)),
        ErrorKind::Strength => format!("{} % too strong", rounded(100.0 * magnitude, 2)),
        ErrorKind::Turn => format!("turned by {} deg", rounded(magnitude.to_degrees(), 2)),
        ErrorKind::Direction => format!("J turned by {} deg", rounded(magnitude.to_degrees(), 2)),
        _ => format!("displaced by {} mm", rounded(magnitude, 3)),
    }
}

/// A number with this many decimals, and with more if it would have less than two digits.
fn rounded(value: f64, decimals: usize) -> String {
    let first = -value.abs().log10().floor();
    let needed = if first.is_finite() && first > 0.0 { first as usize + 1 } else { 0 };
    format!("{value:.*}", decimals.max(needed))
}
