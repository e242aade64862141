//! Tolerances of a field as people write them: a fraction of |B| such as `1e-6`, or `10nT`.

use magsplice_magnet::Tolerance;

use crate::decimal;

/// Flux densities in tesla: names of units and their powers of ten. Each unit stands before those
/// that its name ends in. The two signs for micro look alike.
pub const FLUX_DENSITY_UNITS: [(&str, i32); 6] = [("mT", -3), ("uT", -6), ("µT", -6), ("μT", -6), ("nT", -9), ("T", 0)];

/// Fraction of |B| that is too large for a tolerance: it was probably meant as a field.
const LARGEST_FRACTION: f64 = 0.1;

/// The tolerance that a text states: a fraction of |B|, or a flux density with its unit.
///
/// ```
/// use magsplice_layout::tolerance_of_text;
///
/// assert_eq!(tolerance_of_text("10nT")?, tolerance_of_text("1e-5 mT")?);
/// assert!(tolerance_of_text("5").unwrap_err().contains("as in 5nT"));
/// # Ok::<(), String>(())
/// ```
///
/// # Errors
/// If the text is no number, has another unit, or is out of range. The message has the rule.
pub fn tolerance_of_text(text: &str) -> Result<Tolerance, String> {
    if let Some(percent) = text.trim().strip_suffix('%') {
        // The decimal point moves in the text, so that 5 % is the 0.05 that the user will type.
        let fraction = decimal::scaled(percent.trim(), -2).map_or("0.05".to_owned(), |value| value.to_string());
        return Err(format!(
            "a fraction of |B| is written without a unit: {fraction}; it must be below {LARGEST_FRACTION}. A field has a \
             unit (T, mT, uT, nT), as in 10nT"
        ));
    }
    let (number, unit) = decimal::with_unit(text);
    if unit.is_empty() {
        let fraction = number.parse().map_err(|_| {
            "must be a number: a fraction of |B| such as 1e-6, or a value with a unit (T, mT, uT, nT) such as 10nT"
                .to_owned()
        })?;
        return relative(fraction, number);
    }
    let exponent = FLUX_DENSITY_UNITS.iter().find(|(name, _)| *name == unit).map(|(_, exponent)| *exponent);
    match (exponent, decimal::scaled(number, exponent.unwrap_or(0))) {
        (Some(_), Some(error_t)) => Tolerance::absolute_t(error_t).map_err(|error| error.to_string()),
        (None, Some(_)) => Err(format!(
            "has the unit {unit}, must be a flux density in {}; a number without a unit is a fraction of |B|, below \
             {LARGEST_FRACTION}",
            unit_names()
        )),
        (_, None) => Err(format!("must be a number with or without a unit ({}), such as 10nT or 1e-6", unit_names())),
    }
}

/// The names of the units for a message, with one of the signs for micro.
fn unit_names() -> String {
    let names = FLUX_DENSITY_UNITS.iter().map(|(name, _)| *name);
    names.filter(|name| !name.starts_with('μ')).collect::<Vec<&str>>().join(", ")
}

/// A tolerance as a fraction of |B|, below 0.1.
///
/// # Errors
/// If it is 0.1 or more, which was probably meant as a field, or not above 0.
pub fn relative_tolerance(fraction: f64) -> Result<Tolerance, String> {
    relative(fraction, &fraction.to_string())
}

fn relative(fraction: f64, written: &str) -> Result<Tolerance, String> {
    if fraction >= LARGEST_FRACTION && fraction.is_finite() {
        let percent = 100.0 * fraction;
        return Err(format!(
            "{fraction} is {percent} % of |B|, must be a fraction below {LARGEST_FRACTION}; a field has a unit, as in \
             {written}nT"
        ));
    }
    Tolerance::relative(fraction).map_err(|error| error.to_string())
}
