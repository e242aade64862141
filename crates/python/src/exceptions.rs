//! Python exceptions for the errors of the library, with the same messages.

use magsplice::FilmError;
use magsplice::layout::LayoutError;
use magsplice::magnet::{PointError, PointErrorCause, PointErrors};
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::import_exception;
use pyo3::{PyErr, PyResult};
use serde::Deserialize;
use serde::de::value::{BorrowedStrDeserializer, Error};

import_exception!(magsplice.errors, MagspliceError);
mod python {
    pyo3::import_exception!(magsplice.errors, LayoutError);
    pyo3::import_exception!(magsplice.errors, PointsError);
}

/// An error of a layout: `LayoutError` with its faults, or the error of the operating system.
pub(crate) fn of_layout(error: LayoutError) -> PyErr {
    let message = error.to_string();
    match error {
        LayoutError::Read { error, path } => match error.raw_os_error() {
            // Python chooses the class by the number, such as FileNotFoundError, and prints it.
            Some(number) => {
                let reason = error.to_string().replace(&format!(" (os error {number})"), "");
                PyOSError::new_err((number, reason, path))
            }
            None => PyOSError::new_err(message),
        },
        LayoutError::Invalid { faults, .. } => {
            let faults: Vec<_> = faults.into_iter().map(|f| (f.line, f.place, f.message)).collect();
            python::LayoutError::new_err((message, faults))
        }
        _ => python::LayoutError::new_err(message),
    }
}

/// Points without a field, as `PointsError`.
pub(crate) fn of_points(errors: &PointErrors) -> PyErr {
    let tile = |error: &PointError| match error.cause {
        PointErrorCause::Unbounded { tile } | PointErrorCause::Unresolved { tile } => Some(tile),
        _ => None,
    };
    let points: Vec<_> = errors.0.iter().map(|e| (e.index, e.point.to_array(), tile(e), e.cause.to_string())).collect();
    python::PointsError::new_err((errors.to_string(), points))
}

/// An error of the evaluation of a film.
pub(crate) fn of_film(error: FilmError) -> PyErr {
    match error {
        FilmError::Points(errors) => of_points(&errors),
        error => failed(error),
    }
}

/// Any other error of the library, as `MagspliceError`.
pub(crate) fn failed(error: impl std::fmt::Display) -> PyErr {
    MagspliceError::new_err(error.to_string())
}

/// The value of a word of a layout file.
pub(crate) fn one_of<'a, T: Deserialize<'a>>(name: &str, word: &'a str, known: &str) -> PyResult<T> {
    let value = T::deserialize(BorrowedStrDeserializer::<Error>::new(word));
    value.map_err(|_| bad_value(format_args!("{name} = {word:?}, must be {known}")))
}

/// An invalid value of an argument.
pub(crate) fn bad_value(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}
