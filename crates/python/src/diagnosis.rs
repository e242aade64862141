//! Which tiles of a film that was made are wrong.

use magsplice::magnet::{PerTileError, TileError};
use magsplice::scan::{Candidate, ErrorKind, FreeParameters, NamedError};
use magsplice::sensor::Noise;
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::film::{Film, run};
use crate::vectors::{Triple, vectors};

/// Index and kind of an error of a tile.
type Error = (usize, &'static str);

/// A diagnosis, with the fields of the Python class.
#[derive(IntoPyObject)]
pub(crate) struct DiagnosisNumbers<'py> {
    named: Vec<NamedNumbers>,
    is_complete: bool,
    is_residual_too_large: bool,
    residual_t: f64,
    chi_squared: f64,
    freedom: usize,
    strength: f64,
    offset_t: Triple,
    rotation_rad: Triple,
    start_mm: Triple,
    /// Errors of each tile, in mm, radians, or as a fraction.
    errors: Bound<'py, PyArray2<f64>>,
}

#[derive(IntoPyObject)]
struct NamedNumbers {
    of: Error,
    magnitude: f64,
    /// Values and their standard deviations, in mm, radians, or as a fraction.
    components: Vec<(f64, f64)>,
    chi_squared: f64,
    ln_probability: f64,
    alternatives: Vec<Error>,
}

/// The errors of tiles that a scan tells. `free` says whether strength, offset, rotation and start
/// are fitted.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python passes them by name")]
pub(crate) fn diagnose<'py>(
    py: Python<'py>,
    film: &Film,
    points: PyReadonlyArray2<'py, f64>,
    readings_t: PyReadonlyArray2<'py, f64>,
    noise_t: Option<[f64; 3]>,
    preset: Option<&str>,
    as_ordered: bool,
    free: [bool; 4],
    false_alarm: f64,
) -> PyResult<DiagnosisNumbers<'py>> {
    let (points, readings_t) = (vectors(&points)?.to_vec(), vectors(&readings_t)?);
    let mut layout = film.layout_with_errors(preset)?;
    if as_ordered {
        layout.tolerance = None;
    }
    let [strength, offset, rotation, start] = free;
    let free = FreeParameters { strength, offset, rotation, start };
    let noise = noise_t.map(|deviation_t| Noise { deviation_t: deviation_t.into() });
    let film = film.with_tables(py, layout)?;
    let found = run(py, film, |film| film.diagnose(points, readings_t, noise, free, false_alarm))?;
    let errors = PyArray2::zeros(py, [found.errors.len(), TileError::ALL.len()], false);
    let values = found.errors.iter().flat_map(PerTileError::values);
    errors.readwrite().as_slice_mut()?.iter_mut().zip(values).for_each(|(place, value)| *place = *value);
    Ok(DiagnosisNumbers {
        is_complete: found.is_complete,
        is_residual_too_large: found.is_residual_too_large(),
        residual_t: found.residual_t(),
        chi_squared: found.chi_squared,
        freedom: found.freedom,
        strength: found.scan.strength,
        offset_t: found.scan.offset_t.into(),
        rotation_rad: found.scan.rotation_rad.into(),
        start_mm: found.scan.start.into(),
        errors,
        named: found.named.iter().map(numbers).collect(),
    })
}

fn numbers(named: &NamedError) -> NamedNumbers {
    NamedNumbers {
        of: error(&named.candidate),
        magnitude: named.magnitude(),
        components: named.components.iter().map(|of| (of.value, of.deviation)).collect(),
        chi_squared: named.chi_squared,
        ln_probability: named.ln_probability,
        alternatives: named.alternatives.iter().map(error).collect(),
    }
}

fn error(candidate: &Candidate) -> Error {
    let kind = match candidate.kind {
        ErrorKind::Strength => "strength",
        ErrorKind::Turn => "turn",
        ErrorKind::Direction => "direction",
        ErrorKind::Displacement => "displacement",
        _ => "error",
    };
    (candidate.tile, kind)
}
