//! Why a request gives no layout.

use magsplice_layout::{LayoutFault, SHORTEST_WAVELENGTH_MM, STRONGEST_MAGNET_T, meant_length, meant_polarization};
use thiserror::Error;

/// Amplitude that no film of tiles reaches. The fundamental of a square wave is 4 / pi of its
/// height, and the tiles are as strong as the ideal film's crests.
pub(crate) const MAX_AMPLITUDE: f64 = 2.0;

/// Width of the wide intervals, as a fraction of the wavelength. Two thirds of a half-wave at full
/// strength have no third harmonic (Dai 2024, Fig. 5, has 3.3 of 5 mm).
pub(crate) const WIDE: f64 = 1.0 / 3.0;

/// A number of a [`SpliceRequest`](crate::SpliceRequest) out of range. Lengths in millimetres,
/// polarization in tesla.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SpliceFault {
    /// A number, given with its name and unit, is not finite or not above 0.
    #[error("{0}: {1} {2}, must be a finite number greater than 0")]
    NotPositive(&'static str, f64, &'static str),
    /// The remanence is above the remanence of any permanent magnet.
    #[error(
        "remanence: {0} T, must be at most {STRONGEST_MAGNET_T} T, more than any permanent magnet has; {meant}",
        meant = meant_polarization(*.0)
    )]
    TooStrong(f64),
    /// The least amplitude is above 2.
    #[error(
        "amplitude: {0}, must be at most {MAX_AMPLITUDE}, the limit for tiles with the remanence of the ideal film; it \
         is a fraction, not percent"
    )]
    UnreachableAmplitude(f64),
    /// The wavelength is too short for machine tools.
    #[error(
        "wavelength: {0} mm, must be at least {SHORTEST_WAVELENGTH_MM} mm: with less, tiles are no larger than the \
         resolution of machine tools; {meant}", meant = meant_length(*.0)
    )]
    ShortWavelength(f64),
    /// A length, with its name, is below a thousandth of the wavelength, which follows it.
    #[error("{0}: {1} mm, must be at least a thousandth of the wavelength, {2} mm; {meant}", meant = meant_length(*.1))]
    TooShort(&'static str, f64, f64),
    /// A length, with its name, is above a thousand times the wavelength, which follows it.
    #[error(
        "{0}: {1} mm, must be at most a thousand times the wavelength, {2} mm; did you mean {meant} mm, which is {1} um?",
        meant = 1e-3 * .1
    )]
    TooLong(&'static str, f64, f64),
    /// The gap is not finite or less than 0.
    #[error("gap: {0} mm, must be a finite number of at least 0")]
    Gap(f64),
    /// The seed is above the largest integer of a layout file.
    #[error("seed: {0}, must be at most {most}, the largest integer of a layout file", most = i64::MAX)]
    LargeSeed(u64),
    /// The first distance is not less than the second.
    #[error("distance: {0} to {1} mm, the first must be less than the second")]
    Distances(f64, f64),
    /// Along this axis the film does not hold the crests about its middle: extent and wavelength.
    #[error(
        "film: {1} mm along {0}, must be at least {least:.4} mm, 5/6 of the wavelength, to contain the crests of the \
         polarization next to the middle{meant}",
        least = least_extent(*.2),
        meant = if *.1 <= 1e-2 * least_extent(*.2) && 1e3 * .1 >= least_extent(*.2) { format!("; {}", meant_length(*.1)) } else { String::new() }
    )]
    NoCrests(char, f64, f64),
    /// B_z of the ideal film vanishes in the working volume: extents along x and y, wavelength.
    #[error(
        "range: {} x {} mm reaches points where B_z vanishes; half the sum of both must be less than half the \
         wavelength, {} mm", .0[0], .0[1], 0.5 * .1
    )]
    SingularRange([f64; 2], f64),
    /// The shortest side is above a quarter of the wavelength, which follows it.
    #[error("smallest cut: {0} mm, must be at most a quarter of the wavelength, {most} mm", most = 0.25 * .1)]
    LongCut(f64, f64),
    /// The number of parts of a one-sided film is limited.
    #[error(
        "parts: {0} with one-sided, must be left out: parts are magnetized in the plane of the film, and tiles of a \
         one-sided film out of it"
    )]
    OneSidedParts(usize),
    /// No film or tile has this wavelength, thickness and remanence.
    #[error("wavelength, thickness and remanence: out of range")]
    OutOfRange,
    /// The layout breaks a rule of layout files.
    #[error("{0}")]
    Layout(LayoutFault),
}

/// Least extent of a film along an axis, for this wavelength: a shorter film has no crest on
/// either side.
pub(crate) fn least_extent(wavelength: f64) -> f64 {
    2.0 * (0.25 * wavelength) + WIDE * wavelength
}
