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
    /// Whether messages list it. They leave out second names.
    is_listed: bool,
    /// Whether values are counts of a sensor, whose `factor` is the flux density of one count.
    pub(crate) is_count: bool,
}

impl Unit {
    /// Of text and plain numbers.
    pub(crate) const NONE: Unit = unit("", 0, 1.0);

    /// Whether a value has the same meaning in both units.
    pub(crate) fn is_same(self, other: Unit) -> bool {
        (self.exponent, self.factor, self.is_count) == (other.exponent, other.factor, other.is_count)
    }
}

const fn unit(name: &'static str, exponent: i32, factor: f64) -> Unit {
    Unit { name, exponent, factor, is_listed: true, is_count: false }
}

/// Another name of a unit.
const fn also(name: &'static str, exponent: i32, factor: f64) -> Unit {
    Unit { is_listed: false, ..unit(name, exponent, factor) }
}

const fn count(name: &'static str, is_listed: bool) -> Unit {
    Unit { is_listed, is_count: true, ..unit(name, 0, 1.0) }
}

const INCH_MM: f64 = 25.4;

/// Lengths in millimetres.
pub(crate) const LENGTHS: [Unit; 12] = [
    unit("mm", 0, 1.0),
    unit("cm", 1, 1.0),
    unit("m", 3, 1.0),
    unit("um", -3, 1.0),
    also("µm", -3, 1.0),
    also("μm", -3, 1.0),
    unit("nm", -6, 1.0),
    unit("in", 0, INCH_MM),
    also("inch", 0, INCH_MM),
    also("inches", 0, INCH_MM),
    unit("mil", -3, INCH_MM),
    also("thou", -3, INCH_MM),
];

/// Flux densities and polarizations in tesla.
pub(crate) const FLUX_DENSITIES: [Unit; FLUX_DENSITY_UNITS.len()] = {
    let mut units = [Unit::NONE; FLUX_DENSITY_UNITS.len()];
    let mut index = 0;
    while index < units.len() {
        let (name, exponent, is_listed) = FLUX_DENSITY_UNITS[index];
        units[index] = Unit { is_listed, ..unit(name, exponent, 1.0) };
        index += 1;
    }
    units
};

/// Counts of a sensor.
const COUNTS: [Unit; 4] = [count("counts", true), count("count", false), count("LSB", false), count("raw", false)];

/// Readings of a sensor: flux densities in tesla, and counts.
pub(crate) const READINGS: [Unit; FLUX_DENSITIES.len() + COUNTS.len()] = joined(FLUX_DENSITIES, COUNTS);

const DEGREES: Unit = unit("deg", 0, 1.0);

/// Angles in degrees.
pub(crate) const ANGLES: [Unit; 1] = [DEGREES];

/// Angles in degrees, as names of columns have them.
pub(crate) const COLUMN_ANGLES: [Unit; 4] =
    [DEGREES, unit("°", 0, 1.0), unit("rad", 0, 180.0 / PI), unit("mrad", -3, 180.0 / PI)];

/// Degrees in radians.
pub(crate) fn in_rad(angle_deg: f64) -> f64 {
    angle_deg.to_radians()
}

/// Standard gravity in m/s2, by definition.
const GRAVITY: f64 = 9.806_65;

/// Weight of an avoirdupois pound in newton, by definition.
const POUND_N: f64 = 0.453_592_37 * GRAVITY;

/// Forces in newton.
pub(crate) const FORCES: [Unit; 13] = [
    unit("N", 0, 1.0),
    unit("mN", -3, 1.0),
    unit("uN", -6, 1.0),
    also("µN", -6, 1.0),
    also("μN", -6, 1.0),
    unit("cN", -2, 1.0),
    unit("kN", 3, 1.0),
    unit("gf", -3, GRAVITY),
    unit("kgf", 0, GRAVITY),
    also("kp", 0, GRAVITY),
    unit("lbf", 0, POUND_N),
    unit("ozf", 0, POUND_N / 16.0),
    unit("dyn", -5, 1.0),
];

/// Magnetizations and field strengths, as names of columns have them: times mu0, in tesla.
pub(crate) const FIELD_STRENGTHS: [Unit; 12] = [
    unit("A_per_m", 0, MU_0),
    unit("kA_per_m", 3, MU_0),
    unit("A/m", 0, MU_0),
    unit("kA/m", 3, MU_0),
    also("A m^-1", 0, MU_0),
    also("kA m^-1", 3, MU_0),
    also("A m-1", 0, MU_0),
    also("kA m-1", 3, MU_0),
    unit("Oe", -4, 1.0),
    also("oersted", -4, 1.0),
    unit("mOe", -7, 1.0),
    unit("kOe", -1, 1.0),
];

/// Magnetic moments in A m2, as names of columns have them.
pub(crate) const MOMENTS: [Unit; 13] = [
    unit("A_m2", 0, 1.0),
    unit("mA_m2", -3, 1.0),
    unit("uA_m2", -6, 1.0),
    unit("A m2", 0, 1.0),
    unit("mA m2", -3, 1.0),
    unit("uA m2", -6, 1.0),
    also("Am2", 0, 1.0),
    also("mAm2", -3, 1.0),
    also("uAm2", -6, 1.0),
    also("A m^2", 0, 1.0),
    also("mA m^2", -3, 1.0),
    also("uA m^2", -6, 1.0),
    unit("emu", -3, 1.0),
];

/// The units of two lists.
const fn joined<const A: usize, const B: usize, const N: usize>(first: [Unit; A], second: [Unit; B]) -> [Unit; N] {
    let mut units = [Unit::NONE; N];
    let mut index = 0;
    while index < N {
        units[index] = if index < A { first[index] } else { second[index - A] };
        index += 1;
    }
    units
}

/// The unit with this name, written in lower or upper case.
pub(crate) fn find(units: &[Unit], name: &str) -> Option<Unit> {
    units.iter().find(|unit| unit.name.eq_ignore_ascii_case(name)).copied()
}

/// The names of units for a message, without second names.
pub(crate) fn names(units: &[Unit]) -> String {
    units.iter().filter(|unit| unit.is_listed).map(|unit| unit.name).collect::<Vec<_>>().join(", ")
}
