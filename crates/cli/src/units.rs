//! Units that people write: their names, and the powers of ten that convert them.

/// A unit: its name, and the exponent of ten that converts a value to the unit that the program
/// computes in.
pub(crate) type Unit = (&'static str, i32);

/// Lengths in millimetres. Each unit stands before those that its name ends in.
pub(crate) const LENGTHS: [Unit; 6] = [("mm", 0), ("cm", 1), ("um", -3), ("µm", -3), ("μm", -3), ("m", 3)];

/// The exponent of a unit, written in lower or upper case.
pub(crate) fn exponent(units: &[Unit], name: &str) -> Option<i32> {
    units.iter().find(|(unit, _)| unit.eq_ignore_ascii_case(name)).map(|(_, exponent)| *exponent)
}
