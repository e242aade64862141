//! Readings of a sensor: their files, and results of `read`, `calibrate` and `scan`.

/// Results of `calibrate`.
pub(crate) mod calibration;
/// Displacements from readings below a film.
pub(crate) mod film_readings;
/// Readings of a sensor from a CSV file.
pub(crate) mod reading_file;
/// Results of `scan`: a fitted scan.
pub(crate) mod scanned_film;
