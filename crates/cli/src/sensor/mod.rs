//! Results of `read`, `calibrate`, `scan` and `diagnose`.

/// Results of `calibrate`.
pub(crate) mod calibration;
/// Results of `diagnose`: a film with what a scan tells of its tiles.
pub(crate) mod diagnosed_film;
/// Displacements from readings below a film.
pub(crate) mod film_readings;
/// What noise lets a sensor see.
pub(crate) mod film_resolution;
/// The film that an experiment reads.
pub(crate) mod made_film;
/// Planes through a scan.
#[cfg(feature = "report")]
pub(crate) mod scan_planes;
/// Results of `scan`: a fitted scan.
pub(crate) mod scanned_film;
