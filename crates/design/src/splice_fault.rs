//! Why a layout to begin with cannot be made.

use std::fmt;

use magsplice_layout::{LayoutFault, SHORTEST_WAVELENGTH_MM, STRONGEST_MAGNET_T, meant_length, meant_polarization};

/// Amplitude that no film of tiles reaches. The fundamental of a square wave is 4 / pi of its
/// height, and the tiles are as strong as the ideal film's crests.
pub(crate) const MAX_AMPLITUDE: f64 = 2.0;

/// Width of the wide intervals, as a fraction of the wavelength. Two thirds of a half-wave at full
/// strength have no third harmonic (Dai 2024, Fig. 5, has 3.3 of 5 mm).
pub(crate) const WIDE: f64 = 1.0 / 3.0;

/// A number of a [`SpliceRequest`](crate::SpliceRequest) out of range. Lengths in millimetres,
/// polarization in tesla.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SpliceFault {
    /// A number, with its name and its unit, is not finite or not greater than 0.
    NotPositive(&'static str, f64, &'static str),
    /// The remanence is above that of any permanent magnet.
    TooStrong(f64),
    /// The least amplitude is above 2.
    UnreachableAmplitude(f64),
    /// The wavelength is too short for machine tools.
    ShortWavelength(f64),
    /// A length, with its name, is below a thousandth of the wavelength, which follows it.
    TooShort(&'static str, f64, f64),
    /// A length, with its name, is above a thousand times the wavelength, which follows it.
    TooLong(&'static str, f64, f64),
    /// The gap is not finite or less than 0.
    Gap(f64),
    /// The first distance is not less than the second.
    Distances(f64, f64),
    /// Along this axis the film does not hold the crests about its middle: extent and wavelength.
    NoCrests(char, f64, f64),
    /// B_z of the ideal film vanishes in the working volume: extents along x and y, wavelength.
    SingularRange([f64; 2], f64),
    /// The shortest side is above a quarter of the wavelength, which follows it.
    LongCut(f64, f64),
    /// No film or tile has this wavelength, thickness and remanence.
    OutOfRange,
    /// The layout breaks a rule of layout files.
    Layout(LayoutFault),
}

impl fmt::Display for SpliceFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SpliceFault::NotPositive(name, value, unit) => {
                write!(f, "{name}: {value} {unit}, must be a finite number greater than 0")
            }
            SpliceFault::TooStrong(j) => write!(
                f,
                "remanence: {j} T, must be at most {STRONGEST_MAGNET_T} T, more than any permanent magnet has; {}",
                meant_polarization(*j)
            ),
            SpliceFault::UnreachableAmplitude(amplitude) => write!(
                f,
                "amplitude: {amplitude}, must be at most {MAX_AMPLITUDE}, which tiles of the remanence of the ideal \
                 film cannot exceed: a fraction, not percent"
            ),
            SpliceFault::ShortWavelength(wave) => write!(
                f,
                "wavelength: {wave} mm, must be at least {SHORTEST_WAVELENGTH_MM} mm, or tiles are no larger than the \
                 resolution of machine tools; {}",
                meant_length(*wave)
            ),
            SpliceFault::TooShort(name, mm, wave) => write!(
                f,
                "{name}: {mm} mm, must be at least a thousandth of the wavelength, {wave} mm; {}",
                meant_length(*mm)
            ),
            SpliceFault::TooLong(name, mm, wave) => write!(
                f,
                "{name}: {mm} mm, must be at most a thousand times the wavelength, {wave} mm; did you mean {} mm, \
                 which is {mm} um?",
                1e-3 * mm
            ),
            SpliceFault::Gap(mm) => write!(f, "gap: {mm} mm, must be a finite number of at least 0"),
            SpliceFault::Distances(near, far) => {
                write!(f, "distance: {near} to {far} mm, the first must be less than the second")
            }
            SpliceFault::NoCrests(axis, mm, wave) => {
                let least_mm = least_extent(*wave);
                write!(
                    f,
                    "film: {mm} mm along {axis}, must be at least {least_mm:.4} mm, 5/6 of the wavelength, to hold the \
                     crests about the middle"
                )?;
                if 1e3 * mm >= least_mm { write!(f, "; {}", meant_length(*mm)) } else { Ok(()) }
            }
            SpliceFault::SingularRange([x, y], wave) => write!(
                f,
                "range: {x} x {y} mm reaches points where B_z vanishes; half the sum of both must be less than half the \
                 wavelength, {} mm",
                0.5 * wave
            ),
            SpliceFault::LongCut(mm, wave) => {
                let most_mm = 0.25 * wave;
                write!(f, "smallest cut: {mm} mm, must be at most a quarter of the wavelength, {most_mm} mm")
            }
            SpliceFault::OutOfRange => f.write_str("wavelength, thickness and remanence: out of range"),
            SpliceFault::Layout(fault) => fault.fmt(f),
        }
    }
}

/// Least extent of a film along an axis, for this wavelength: a shorter film has no crest on
/// either side.
pub(crate) fn least_extent(wavelength: f64) -> f64 {
    2.0 * (0.25 * wavelength) + WIDE * wavelength
}
