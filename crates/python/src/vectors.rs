//! NumPy arrays viewed as vectors, and vectors as NumPy arrays.

use glam::{DMat3, DVec3};
use magsplice::layout::decimal;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;

/// Least number of points of a task.
const POINTS_PER_TASK: usize = 1 << 12;

/// Round-off of a sum of two or three coordinates, as a fraction.
const SUM_ROUNDING: f64 = 2.0 * f64::EPSILON;

/// Three values, a tuple in Python, where arrays would be lists.
pub(crate) type Triple<T = f64> = (T, T, T);

/// The rows of a contiguous array of shape (n, 3), without a copy.
///
/// # Errors
/// If the array has another shape or is not contiguous.
pub(crate) fn vectors<'a>(rows: &'a PyReadonlyArray2<'_, f64>) -> PyResult<&'a [DVec3]> {
    if rows.as_array().ncols() != 3 {
        return Err(PyValueError::new_err("an array must have the shape (n, 3)"));
    }
    Ok(bytemuck::cast_slice(rows.as_slice()?))
}

/// An array of shape (n, 3) with moved decimal points, exact in every digit.
#[pyfunction]
pub(crate) fn shifted<'py>(
    py: Python<'py>,
    values: PyReadonlyArray2<'py, f64>,
    exponent: i32,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let values = vectors(&values)?;
    let moved: Vec<DVec3> = values.iter().map(|vector| decimal::shifted_vector(*vector, exponent)).collect();
    Ok(rows_of(py, &moved))
}

/// Points in metres as points in millimetres, see [`in_mm`].
pub(crate) fn points_in_mm(points: &[DVec3]) -> Vec<DVec3> {
    points.par_iter().with_min_len(POINTS_PER_TASK).map(|point| in_mm(*point)).collect()
}

/// A vector in metres as one in millimetres, by moved decimal points. Coordinates that differ by
/// round-off from a number with twelve decimals are this number: in metres, a sum such as 0.14 +
/// 0.005 is 0.14500000000000002.
pub(crate) fn in_mm(metres: DVec3) -> DVec3 {
    decimal::shifted_vector(metres.to_array().map(without_rounding).into(), 3)
}

/// The number with twelve decimals nearest to a number, if both differ by the round-off of a sum.
/// Of numbers between them a millionth is so near at 0.01, the size of a magnet in metres.
fn without_rounding(value: f64) -> f64 {
    const LAST: f64 = 1e12;
    let nearest = (value * LAST).round() / LAST;
    if (nearest - value).abs() <= SUM_ROUNDING * value.abs() { nearest } else { value }
}

/// A new array with one row for each item.
pub(crate) fn rows<'py, const N: usize>(
    py: Python<'py>,
    values: impl ExactSizeIterator<Item = [f64; N]>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let count = values.len();
    values.flatten().collect::<Vec<f64>>().into_pyarray(py).reshape([count, N])
}

/// A new array of shape (n, 3).
pub(crate) fn rows_of<'py>(py: Python<'py>, vectors: &[DVec3]) -> Bound<'py, PyArray2<f64>> {
    rows(py, vectors.iter().map(DVec3::to_array)).expect("each vector has three numbers")
}

/// An array of zeros, or `MemoryError`, where functions of the crate numpy panic.
fn zeros<'py>(py: Python<'py>, shape: impl IntoPyObject<'py>) -> PyResult<Bound<'py, PyAny>> {
    py.import("numpy")?.getattr("zeros")?.call1((shape,))
}

/// An array of shape (n, 3), written by `write` without a copy.
pub(crate) fn written_rows<'py, R>(
    py: Python<'py>,
    count: usize,
    write: impl FnOnce(&mut [DVec3]) -> PyResult<R>,
) -> PyResult<(Bound<'py, PyArray2<f64>>, R)> {
    let array: Bound<'py, PyArray2<f64>> = zeros(py, (count, 3))?.cast_into()?;
    let result = write(bytemuck::cast_slice_mut(array.readwrite().as_slice_mut()?))?;
    Ok((array, result))
}

/// An array of shape (n, 3, 3), written by `write` without a copy: element (n, j) is column j.
pub(crate) fn written_gradients<'py, R>(
    py: Python<'py>,
    count: usize,
    write: impl FnOnce(&mut [DMat3]) -> PyResult<R>,
) -> PyResult<(Bound<'py, PyArray3<f64>>, R)> {
    let array: Bound<'py, PyArray3<f64>> = zeros(py, (count, 3, 3))?.cast_into()?;
    let result = write(bytemuck::cast_slice_mut(array.readwrite().as_slice_mut()?))?;
    Ok((array, result))
}

/// A one-dimensional array that owns a vector.
pub(crate) fn numbers(py: Python<'_>, values: Vec<f64>) -> Bound<'_, PyArray1<f64>> {
    values.into_pyarray(py)
}
