//! Numbers with units as a person types them: `8mm`, `20mmx20mm`, `-3.9..-2.4`, `0.1µT`.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

use magsplice::layout::decimal::{self, with_unit};
use magsplice::prelude::DVec3;

use crate::units::{self, ANGLES, FLUX_DENSITIES, LENGTHS, Unit, in_rad};

/// What an option takes.
struct Kind {
    /// Its name in messages.
    name: &'static str,
    units: &'static [Unit],
    /// The unit of a number without one.
    default: &'static str,
    /// What a number without a unit is, in words.
    bare: &'static str,
}

const LENGTH: Kind = Kind { name: "a length", units: &LENGTHS, default: "mm", bare: "in mm" };
const FLUX_DENSITY: Kind = Kind { name: "a flux density", units: &FLUX_DENSITIES, default: "T", bare: "in T" };
const ANGLE: Kind = Kind { name: "an angle", units: &ANGLES, default: "deg", bare: "in degrees" };

/// A length in mm.
pub(crate) fn length_mm(text: &str) -> Result<f64, String> {
    let (number, unit) = with_unit(text);
    LENGTH.value(number, unit)
}

/// An angle in radians.
pub(crate) fn angle_rad(text: &str) -> Result<f64, String> {
    let (number, unit) = with_unit(text);
    ANGLE.value(number, unit).map(in_rad)
}

/// A fraction: a number, or a percentage such as 0.5%.
pub(crate) fn fraction(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let (number, exponent) = text.strip_suffix('%').map_or((text, 0), |percent| (percent.trim(), -2));
    decimal::scaled(number, exponent).ok_or_else(|| "must be a fraction such as 0.005 or 0.5%".to_owned())
}

/// A whole number in a range.
pub(crate) fn whole<T: FromStr + PartialOrd + Display>(text: &str, range: RangeInclusive<T>) -> Result<T, String> {
    let number = text.parse().ok().filter(|number| range.contains(number));
    number.ok_or_else(|| format!("must be a whole number from {} to {}", range.start(), range.end()))
}

/// A number above 0.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|value: &f64| *value > 0.0 && value.is_finite());
    number.ok_or_else(|| "must be a number greater than 0, such as 0.65".to_owned())
}

/// The seed of random numbers.
pub(crate) fn seed(text: &str) -> Result<u64, String> {
    whole(text, 0..=u64::MAX)
}

/// A flux density or polarization in T.
pub(crate) fn flux_density_t(text: &str) -> Result<f64, String> {
    let (number, unit) = with_unit(text);
    FLUX_DENSITY.value(number, unit)
}

/// A point: three lengths in mm with commas between them.
pub(crate) fn point_mm(text: &str) -> Result<DVec3, String> {
    vector(text, length_mm, "must be three lengths with commas between them, such as 0,0,-4 or 0,0,-4mm")
}

/// Three values with commas between them.
pub(crate) fn vector(text: &str, value: fn(&str) -> Result<f64, String>, rule: &str) -> Result<DVec3, String> {
    let parts: Vec<&str> = text.split(',').collect();
    let [x, y, z] = parts[..] else { return Err(rule.to_owned()) };
    Ok(DVec3::new(value(x)?, value(y)?, value(z)?))
}

/// Two lengths in mm with an x between them.
pub(crate) fn extents_mm(text: &str) -> Result<[f64; 2], String> {
    let parts = text.split_once(['x', 'X', '×']);
    lengths_mm(
        text,
        parts,
        Pair { between: "x", rule: "must be two lengths with an x between them, such as 20x20 or 20mmx20mm" },
    )
}

/// Two lengths in mm with .. between them.
pub(crate) fn interval_mm(text: &str) -> Result<[f64; 2], String> {
    lengths_mm(
        text,
        text.split_once(".."),
        Pair { between: "..", rule: "must be two lengths with .. between them, such as 3..5 or 3mm..5mm" },
    )
}

/// How two lengths are written.
#[derive(Clone, Copy)]
struct Pair {
    between: &'static str,
    rule: &'static str,
}

impl Pair {
    /// Why a text without the mark between lengths is no pair, with what was probably meant.
    fn refusal(&self, text: &str) -> String {
        let Pair { between, rule } = self;
        let is_length = |text: &str| length_mm(text).is_ok();
        if is_length(text) {
            let (is, meant) =
                ("is one length", if *between == "x" { format!(": write {text}x{text}") } else { String::new() });
            return format!("{is}, {rule}{meant}");
        }
        // Not at the first character, which may be a minus sign.
        let marks = text.char_indices().skip(1).filter(|(_, mark)| !mark.is_ascii_alphanumeric() && *mark != '.');
        let parts = marks.map(|(at, mark)| (text[..at].trim(), text[at + mark.len_utf8()..].trim()));
        let words = ["to", "by"].iter().filter_map(|word| text.split_once(word));
        let meant = parts
            .chain(words)
            .map(|(one, other)| (one.trim(), other.trim()))
            .find(|(one, other)| is_length(one) && is_length(other));
        meant.map_or((*rule).to_owned(), |(one, other)| format!("{rule}: write {one}{between}{other}"))
    }
}

/// The lengths of two parts of `text`. A unit at the end holds for both.
fn lengths_mm(text: &str, parts: Option<(&str, &str)>, pair: Pair) -> Result<[f64; 2], String> {
    let (first, second) = parts.ok_or_else(|| pair.refusal(text.trim()))?;
    let Pair { between, rule } = pair;
    let ((first, first_unit), (second, second_unit)) = (with_unit(first), with_unit(second));
    let is_number = |text: &str| decimal::scaled(text, 0).is_some();
    if !is_number(first) || !is_number(second) {
        return Err(rule.to_owned());
    }
    if second_unit.is_empty() && !first_unit.is_empty() {
        return Err(format!(
            "has a unit for the first length only, must have it at the end, as in {first}{between}{second}{first_unit}"
        ));
    }
    let first_unit = if first_unit.is_empty() { second_unit } else { first_unit };
    Ok([LENGTH.value(first, first_unit)?, LENGTH.value(second, second_unit)?])
}

impl Kind {
    fn value(&self, number: &str, unit: &str) -> Result<f64, String> {
        let Kind { name, units, default, bare } = self;
        let known = units::names(units);
        let unit = if unit.is_empty() { default } else { unit };
        let found = units.iter().find(|known| known.name == unit);
        let value = decimal::scaled(number, found.map_or(0, |unit| unit.exponent));
        match (value, found) {
            (Some(value), Some(unit)) => Ok(value * unit.factor),
            (Some(_), None) => {
                Err(format!("has the unit {unit}, must be {name} in {known}; a number without a unit is {bare}"))
            }
            (None, _) => Err(format!("must be a number with or without a unit ({known}), such as 8{default} or 8")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_move_the_decimal_point() {
        for text in ["8", "8mm", "8 mm", " 0.8cm ", "8000um", "8e3µm", "8000μm", "0.008m", "8e-3 m"] {
            assert_eq!(length_mm(text), Ok(8.0), "{text}");
        }
        for text in ["0.5in", "0.5 inch", "500mil"] {
            assert_eq!(length_mm(text), Ok(12.7), "{text}");
        }
        for text in ["1e-7", "1mG", "1e-6kOe", "0.1uT", "0.1µT", "0.1μT", "100nT", "1e-4mT", "1E-7 T"] {
            assert_eq!(flux_density_t(text), Ok(1e-7), "{text}");
        }
    }

    #[test]
    fn a_unit_at_the_end_holds_for_both() {
        for text in ["20x10", "20mmx10mm", "20x10mm", "2x1cm", "20mm x 1cm", "20×10"] {
            assert_eq!(extents_mm(text), Ok([20.0, 10.0]), "{text}");
        }
        for text in ["-3.9..-2.4", "-3.9mm..-2.4mm", "-0.39..-0.24cm", "-3.9 .. -2.4"] {
            assert_eq!(interval_mm(text), Ok([-3.9, -2.4]), "{text}");
        }
        let one = extents_mm("2cmx10").expect_err("one unit");
        assert!(one.contains("for the first length only") && one.contains("2x10cm"), "{one}");
    }

    #[test]
    fn wrong_units_and_numbers_are_named() {
        for (text, named) in [("8kg", "has the unit kg"), ("8MM", "has the unit MM"), ("120mT", "has the unit mT")] {
            assert!(length_mm(text).expect_err(text).starts_with(named), "{text}");
        }
        for (text, meant) in [
            ("3-5", "write 3..5"),
            ("-5--3", "write -5..-3"),
            ("3mm-5mm", "write 3mm..5mm"),
            ("3 to 5", "write 3..5"),
            ("3:5", "write 3..5"),
            ("3", "is one length, must be two lengths with .. between them, such as 3..5"),
        ] {
            let told = interval_mm(text).expect_err(text);
            assert!(told.contains(meant), "{text}: {told}");
        }
        for (text, meant) in
            [("20", "is one length, "), ("20", "write 20x20"), ("2cm", "write 2cmx2cm"), ("20*10", "write 20x10")]
        {
            let told = extents_mm(text).expect_err(text);
            assert!(told.contains(meant), "{text}: {told}");
        }
        for text in ["", "mm", "eight", "nan", "inf", "8,5", "1e999", "8mm2", "..", "é"] {
            assert!(length_mm(text).is_err() && extents_mm(text).is_err() && interval_mm(text).is_err(), "{text}");
        }
        assert!(interval_mm("3").is_err() && interval_mm("3..4..5").is_err() && extents_mm("3xx4").is_err());
    }
}
