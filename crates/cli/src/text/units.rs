//! Values in the units in which text shows them. No other file of the program converts a value that
//! the library gave it.

use std::ops::Mul;

/// Tesla in mT.
pub(crate) fn in_mt<T: Mul<f64, Output = T>>(value_t: T) -> T {
    value_t * 1e3
}

/// Tesla in uT.
pub(crate) fn in_ut<T: Mul<f64, Output = T>>(value_t: T) -> T {
    value_t * 1e6
}

/// Seconds in ms.
pub(crate) fn in_ms(seconds: f64) -> f64 {
    1e3 * seconds
}

/// A fraction in per cent.
pub(crate) fn in_per_cent(fraction: f64) -> f64 {
    100.0 * fraction
}

/// Radians in degrees.
pub(crate) fn in_deg(angle_rad: f64) -> f64 {
    angle_rad.to_degrees()
}
