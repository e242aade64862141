//! Findings about angles under keys in degrees that are fractions of pi: they are in radians.

use std::f64::consts::PI;

use crate::brief::StockPart;
use crate::finding::{Finding, FindingSubject, listed};
use crate::names::shown;
use crate::rotation::RotationTable;
use crate::tile::single::TileTable;

/// Angles in radians that people write are multiples of pi / 12, which is 15 degrees.
const PARTS_OF_PI: f64 = 12.0;

/// Largest multiple, a full turn. Numbers above it have at most two digits after the point among
/// four, as directions that are rounded to the resolution of a design have.
const LARGEST_MULTIPLE: f64 = 2.0 * PARTS_OF_PI;

/// Digits from which on a fraction of pi is no coincidence: one number of 260 below a full turn in
/// radians, and no number that is rounded to hundredths of a degree.
const LEAST_DIGITS: usize = 4;

/// Findings about angles of tiles and of the stock of a design.
pub(crate) fn findings(tiles: &[TileTable], stock: &[StockPart]) -> Vec<Finding> {
    let of_tiles = tiles.iter().enumerate().flat_map(|(index, tile)| {
        let directions = [("direction_deg", tile.direction_deg), ("tilt_deg", tile.tilt_deg)];
        let given = directions.into_iter().filter_map(|(key, angle)| Some((key.to_owned(), angle?)));
        let angles = given.chain(tile.rotation.iter().flat_map(RotationTable::angles_deg));
        angles.filter_map(move |(key, angle)| {
            let meant = meant_degrees(angle)?;
            let name = tile.name.as_ref().map_or_else(|| format!("tile-{}", index + 1), |name| shown(name));
            Some(format!("tile \"{name}\": {key} = {angle} {meant}"))
        })
    });
    let of_stock = stock.iter().enumerate().filter_map(|(index, part)| {
        let angle = part.direction_deg;
        Some(format!("design: stock[{index}].direction_deg = {angle} {}", meant_degrees(angle)?))
    });
    let mut findings = listed(of_tiles, FindingSubject::Tiles, |message| message, "angles");
    findings.extend(listed(of_stock, FindingSubject::Design, |message| message, "angles"));
    findings
}

/// What an angle is in radians, and how many degrees were probably meant. `None` if it is no
/// fraction of pi, to the digits that it has.
fn meant_degrees(angle: f64) -> Option<String> {
    let multiple = (angle * PARTS_OF_PI / PI).round();
    if multiple == 0.0 || !(multiple.abs() <= LARGEST_MULTIPLE) {
        return None;
    }
    // The shortest decimal text that is this number, as in the file but for zeros at its end.
    let text = angle.abs().to_string();
    let (_, decimals) = text.split_once('.')?;
    let digits = text.trim_start_matches(['0', '.']).chars().filter(char::is_ascii_digit).count();
    let rounding = 0.5 * 10_f64.powi(-(decimals.len() as i32)) + 4.0 * f64::EPSILON * angle.abs();
    let is_fraction = digits >= LEAST_DIGITS && (angle - multiple * PI / PARTS_OF_PI).abs() <= rounding;
    is_fraction.then(|| {
        let degrees = multiple * 180.0 / PARTS_OF_PI;
        format!("is {} in radians: did you mean {degrees} degrees?", fraction_of_pi(multiple as i64))
    })
}

/// A multiple of pi / 12 in lowest terms.
fn fraction_of_pi(multiple: i64) -> String {
    let parts = PARTS_OF_PI as i64;
    let common = [12, 6, 4, 3, 2, 1].into_iter().find(|n| multiple % n == 0 && parts % n == 0).unwrap_or(1);
    let (count, part) = (multiple / common, parts / common);
    let pi = match count {
        1 => "pi".to_owned(),
        -1 => "-pi".to_owned(),
        _ => format!("{count} pi"),
    };
    if part == 1 { pi } else { format!("{pi}/{part}") }
}

#[cfg(test)]
mod tests {
    // Typed numbers are the subject of these tests.
    #![allow(clippy::approx_constant)]

    use super::*;

    #[test]
    fn fractions_of_pi_are_recognized_to_their_digits() {
        for (angle, meant) in [
            (0.7854, "is pi/4 in radians: did you mean 45 degrees?"),
            (0.785398, "is pi/4 in radians"),
            (PI / 4.0, "is pi/4 in radians"),
            (1.0_f64.atan(), "is pi/4 in radians"),
            (-1.5708, "is -pi/2 in radians: did you mean -90 degrees?"),
            (3.1416, "is pi in radians: did you mean 180 degrees?"),
            (3.142, "is pi in radians"),
            (0.5236, "is pi/6 in radians"),
            (1.0472, "is pi/3 in radians"),
            (0.2618, "is pi/12 in radians: did you mean 15 degrees?"),
            (1.309, "is 5 pi/12 in radians: did you mean 75 degrees?"),
            (2.0944, "is 2 pi/3 in radians"),
            (6.2832, "is 2 pi in radians: did you mean 360 degrees?"),
        ] {
            let found = meant_degrees(angle).unwrap_or_else(|| panic!("{angle} is a fraction of pi"));
            assert!(found.starts_with(meant), "{angle}: {found}");
        }
    }

    /// With all digits, however they were computed: other formulas differ in the last of them.
    #[test]
    fn multiples_of_fifteen_degrees_are_recognized_with_all_digits() {
        for multiple in 1..=24 {
            let degrees = 15.0 * f64::from(multiple);
            let last = degrees.to_radians();
            for angle in [last.next_down(), last, last.next_up(), -last] {
                let found = meant_degrees(angle).unwrap_or_else(|| panic!("{angle} is a fraction of pi"));
                let meant = format!("did you mean {} degrees?", degrees.copysign(angle));
                assert!(found.ends_with(&meant), "{angle}: {found}");
            }
        }
        assert_eq!(meant_degrees(25.0 * PI / 12.0), None);
    }

    #[test]
    fn other_angles_and_few_digits_are_not() {
        for angle in
            [0.0, 45.0, 39.27, 0.785, 3.14, 1.05, 0.7853, 1.571e2, 12.57, 6.545, 1e-300, f64::NAN, f64::INFINITY]
        {
            assert_eq!(meant_degrees(angle), None, "{angle}");
        }
        // Directions rounded to a hundredth of a degree.
        assert!((0..100_000).all(|step| meant_degrees(f64::from(step) / 100.0).is_none()));
    }
}
