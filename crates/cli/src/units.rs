//! Units that people write: their names, and the powers of ten that convert them.

/// A unit: its name, and the exponent of ten that converts a value to the unit that the program
/// computes in.
pub(crate) type Unit = (&'static str, i32);

/// Lengths in millimetres. Each unit stands before those that its name ends in.
pub(crate) const LENGTHS: [Unit; 6] = [("mm", 0), ("cm", 1), ("um", -3), ("µm", -3), ("μm", -3), ("m", 3)];

/// Flux densities and polarizations in tesla, in the same order.
pub(crate) const FLUX_DENSITIES: [Unit; 6] = [("mT", -3), ("uT", -6), ("µT", -6), ("μT", -6), ("nT", -9), ("T", 0)];

/// Angles in degrees.
pub(crate) const ANGLES: [Unit; 1] = [("deg", 0)];

/// Forces in newton.
pub(crate) const FORCES: [Unit; 2] = [("mN", -3), ("N", 0)];

/// Magnetizations in A/m, as names of columns have them.
pub(crate) const MAGNETIZATIONS: [Unit; 8] = [
    ("A_per_m", 0),
    ("kA_per_m", 3),
    ("A/m", 0),
    ("kA/m", 3),
    ("A m^-1", 0),
    ("kA m^-1", 3),
    ("A m-1", 0),
    ("kA m-1", 3),
];

/// Magnetic moments in A m2, as names of columns have them.
pub(crate) const MOMENTS: [Unit; 7] =
    [("A_m2", 0), ("mA_m2", -3), ("uA_m2", -6), ("A m2", 0), ("mA m2", -3), ("uA m2", -6), ("emu", -3)];

/// The exponent of a unit, written in lower or upper case.
pub(crate) fn exponent(units: &[Unit], name: &str) -> Option<i32> {
    units.iter().find(|(unit, _)| unit.eq_ignore_ascii_case(name)).map(|(_, exponent)| *exponent)
}

/// The names of units for a message. The two signs for micro look alike and are one name. Other
/// spellings of A/m are left out.
pub(crate) fn names(units: &[Unit]) -> String {
    let names: Vec<&str> =
        units.iter().map(|(name, _)| *name).filter(|name| !name.starts_with('μ') && !name.ends_with("-1")).collect();
    names.join(", ")
}
