//! Tolerances of a field as people write them: a fraction of |B| such as `1e-6`, or `10nT`.

use magsplice_magnet::Tolerance;

use crate::decimal;

/// Flux densities in tesla: names of units, their powers of ten, and whether messages list them.
/// Messages leave out second names. The two signs for micro look alike. An oersted is the field
/// strength of one gauss in air.
pub const FLUX_DENSITY_UNITS: [(&str, i32, bool); 18] = [
    ("T", 0, true),
    ("mT", -3, true),
    ("uT", -6, true),
    ("µT", -6, false),
    ("μT", -6, false),
    ("nT", -9, true),
    ("G", -4, true),
    ("Gs", -4, false),
    ("gauss", -4, false),
    ("mG", -7, true),
    ("mGs", -7, false),
    ("mgauss", -7, false),
    ("kG", -1, true),
    ("kGs", -1, false),
    ("Oe", -4, true),
    ("oersted", -4, false),
    ("mOe", -7, true),
    ("kOe", -1, true),
];

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
    let exponent = FLUX_DENSITY_UNITS.iter().find(|(name, ..)| *name == unit).map(|(_, exponent, _)| *exponent);
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

/// The names of the units for a message.
fn unit_names() -> String {
    let listed = FLUX_DENSITY_UNITS.iter().filter(|(.., is_listed)| *is_listed);
    listed.map(|(name, ..)| *name).collect::<Vec<&str>>().join(", ")
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_fractions_or_fields() {
        let relative = |fraction| Tolerance::relative(fraction).unwrap();
        let absolute_t = |error_t| Tolerance::absolute_t(error_t).unwrap();
        for (text, known) in [
            ("1e-6", relative(1e-6)),
            (" 0.09 ", relative(0.09)),
            ("10nT", absolute_t(10e-9)),
            ("0.1 mT", absolute_t(0.1e-3)),
            ("2 uT", absolute_t(2e-6)),
            ("2µT", absolute_t(2e-6)),
            ("2μT", absolute_t(2e-6)),
            ("1T", absolute_t(1.0)),
            ("3 G", absolute_t(3e-4)),
            ("3gauss", absolute_t(3e-4)),
            ("3 Gs", absolute_t(3e-4)),
            ("3 mG", absolute_t(3e-7)),
            ("3 mGs", absolute_t(3e-7)),
            ("3 mgauss", absolute_t(3e-7)),
            ("3 kG", absolute_t(0.3)),
            ("3 kGs", absolute_t(0.3)),
            ("3 Oe", absolute_t(3e-4)),
            ("3 oersted", absolute_t(3e-4)),
            ("3 mOe", absolute_t(3e-7)),
            ("3 kOe", absolute_t(0.3)),
        ] {
            assert_eq!(tolerance_of_text(text), Ok(known), "{text}");
        }
        assert_eq!(relative_tolerance(0.05), Ok(relative(0.05)));
    }

    #[test]
    fn texts_of_other_units_are_refused() {
        for (text, rule) in [
            ("5%", "a fraction of |B| is written without a unit: 0.05; it must be below 0.1. A field has a unit"),
            ("1e-3 %", "a fraction of |B| is written without a unit: 0.00001;"),
            ("a%", "a fraction of |B| is written without a unit: 0.05;"),
            ("5", "5 is 500 % of |B|, must be a fraction below 0.1; a field has a unit, as in 5nT"),
            ("0.1", "0.1 is 10 % of |B|, must be a fraction below 0.1"),
            ("1 mm", "has the unit mm, must be a flux density in T, mT, uT, nT, G, mG, kG, Oe, mOe, kOe; a number"),
            ("nT", "must be a number"),
            (
                "--1 nT",
                "must be a number with or without a unit (T, mT, uT, nT, G, mG, kG, Oe, mOe, kOe), such as 10nT",
            ),
            ("", "must be a number: a fraction of |B| such as 1e-6"),
        ] {
            let found = tolerance_of_text(text).expect_err(text);
            assert!(found.starts_with(rule), "{text:?}: {found}");
        }
        // Not a number is no field in another unit.
        let infinite = relative_tolerance(f64::INFINITY).expect_err("infinite");
        assert!(!infinite.contains("% of |B|"), "{infinite}");
        assert!(relative_tolerance(0.0).is_err() && relative_tolerance(-0.01).is_err());
    }
}
