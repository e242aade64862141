//! Units that people write: their names, and how a value in them is converted.

use std::f64::consts::PI;

use magsplice::layout::FLUX_DENSITY_UNITS;
use magsplice::magnet::MU_0;

/// A unit, and how a value in it becomes one in the unit that the program computes in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unit {
    pub(crate) name: &'static str,
    /// Power of ten, by which the decimal point moves without round-off.
    pub(crate) exponent: i32,
    /// Factor after that.
    pub(crate) factor: f64,
}

/// Units by their names and powers of ten.
const fn units<const N: usize>(names: [(&'static str, i32); N], factor: f64) -> [Unit; N] {
    let mut units = [Unit { name: "", exponent: 0, factor }; N];
    let mut index = 0;
    while index < N {
        (units[index].name, units[index].exponent) = names[index];
        index += 1;
    }
    units
}

/// Lengths in millimetres. Each unit stands before those that its name ends in.
pub(crate) const LENGTHS: [Unit; 6] = units([("mm", 0), ("cm", 1), ("um", -3), ("µm", -3), ("μm", -3), ("m", 3)], 1.0);

/// Flux densities and polarizations in tesla.
pub(crate) const FLUX_DENSITIES: [Unit; 6] = units(FLUX_DENSITY_UNITS, 1.0);

const DEGREES: Unit = Unit { name: "deg", exponent: 0, factor: 1.0 };

/// Angles in degrees.
pub(crate) const ANGLES: [Unit; 1] = [DEGREES];

/// Angles in degrees, as names of columns have them.
pub(crate) const COLUMN_ANGLES: [Unit; 3] =
    [DEGREES, Unit { name: "°", ..DEGREES }, Unit { name: "rad", factor: 180.0 / PI, ..DEGREES }];

/// Degrees in radians.
pub(crate) fn in_rad(angle_deg: f64) -> f64 {
    angle_deg.to_radians()
}

/// Forces in newton.
pub(crate) const FORCES: [Unit; 2] = units([("mN", -3), ("N", 0)], 1.0);

/// Magnetizations as polarizations in tesla, as names of columns have them.
pub(crate) const MAGNETIZATIONS: [Unit; 8] = units(
    [
        ("A_per_m", 0),
        ("kA_per_m", 3),
        ("A/m", 0),
        ("kA/m", 3),
        ("A m^-1", 0),
        ("kA m^-1", 3),
        ("A m-1", 0),
        ("kA m-1", 3),
    ],
    MU_0,
);

/// Magnetic moments in A m2, as names of columns have them.
pub(crate) const MOMENTS: [Unit; 7] =
    units([("A_m2", 0), ("mA_m2", -3), ("uA_m2", -6), ("A m2", 0), ("mA m2", -3), ("uA m2", -6), ("emu", -3)], 1.0);

/// The unit with this name, written in lower or upper case.
pub(crate) fn find(units: &[Unit], name: &str) -> Option<Unit> {
    units.iter().find(|unit| unit.name.eq_ignore_ascii_case(name)).copied()
}

/// The names of units for a message. The two signs for micro look alike and are one name. Other
/// spellings of A/m are left out.
pub(crate) fn names(units: &[Unit]) -> String {
    let names = units.iter().map(|unit| unit.name);
    names.filter(|name| !name.starts_with('μ') && !name.ends_with("-1")).collect::<Vec<_>>().join(", ")
}
