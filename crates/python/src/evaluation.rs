//! Numbers of a film: comparison with the ideal film, and decoupling.

use magsplice::decouple::Parameters;
use magsplice::ideal::Comparison;
use magsplice::prelude::DVec3;
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::exceptions::of_film;
use crate::film::Film;
use crate::vectors::{OptionalTriple, Triple, rows_of, vectors};

/// A comparison as a dictionary with the fields of the Python class.
#[derive(IntoPyObject)]
pub(crate) struct ComparisonNumbers {
    points: usize,
    component_rmse_t: Triple,
    rmse_t: f64,
    relative_rmse: f64,
    worst_t: f64,
    worst_at_mm: Triple,
    amplitude: f64,
    scaled_relative_rmse: Option<f64>,
    correlation: Triple<Option<f64>>,
}

impl From<Comparison> for ComparisonNumbers {
    fn from(c: Comparison) -> ComparisonNumbers {
        ComparisonNumbers {
            points: c.points,
            component_rmse_t: c.component_rmse_t.into(),
            rmse_t: c.rmse_t,
            relative_rmse: c.relative_rmse,
            worst_t: c.worst_t,
            worst_at_mm: c.worst_at.into(),
            amplitude: c.amplitude,
            scaled_relative_rmse: c.scaled_relative_rmse,
            correlation: c.correlation.into(),
        }
    }
}

/// The comparison of a field with that of the ideal film, at points or on the grid of the volume.
#[pyfunction]
#[pyo3(signature = (film, field_t, points=None))]
pub(crate) fn compare(
    py: Python<'_>,
    film: &Film,
    field_t: PyReadonlyArray2<'_, f64>,
    points: Option<PyReadonlyArray2<'_, f64>>,
) -> PyResult<ComparisonNumbers> {
    let field_t = vectors(&field_t)?;
    let points = points.as_ref().map(vectors).transpose()?;
    let film = film.evaluated(py)?;
    py.detach(|| {
        let found = match points {
            Some(points) => film.compare_at(points, field_t),
            None => film.compare(field_t),
        };
        found.map(ComparisonNumbers::from).map_err(of_film)
    })
}

/// Decoupling parameters as a dictionary.
#[derive(IntoPyObject)]
pub(crate) struct DecouplingNumbers<'py> {
    /// R_x, R_y, S_z at each point, NaN at singular ones.
    parameters: Bound<'py, PyArray2<f64>>,
    at_reference: Triple,
    singular_mm: Bound<'py, PyArray2<f64>>,
    /// Only for a grid; None where the planes have one point each.
    uniformity_rmse: Option<OptionalTriple>,
    ideal_rmse: Triple,
    displacement_rmse_mm: Triple,
    wavenumber_per_mm: f64,
}

/// The decoupling parameters of a field, at points or on the grid of the volume.
#[pyfunction]
#[pyo3(signature = (film, field_t, points=None))]
pub(crate) fn decouple<'py>(
    py: Python<'py>,
    film: &Film,
    field_t: PyReadonlyArray2<'py, f64>,
    points: Option<PyReadonlyArray2<'py, f64>>,
) -> PyResult<DecouplingNumbers<'py>> {
    let field_t = vectors(&field_t)?;
    let points = points.as_ref().map(vectors).transpose()?;
    let film = film.evaluated(py)?;
    let evaluate = || {
        let wavenumber = film.ideal()?.wavenumber();
        Ok(match points {
            Some(points) => {
                let found = film.decouple_at(points, field_t)?;
                let parameters = found.parameters.iter().map(vector).collect();
                (parameters, found.at_reference, found.singular, None, found.ideal_rmse, wavenumber)
            }
            None => {
                let found = film.decouple(field_t)?;
                let uniformity = Some(found.uniformity_rmse.to_array().into());
                let parameters: Vec<DVec3> = found.parameters.iter().map(vector).collect();
                (parameters, found.at_reference, found.singular, uniformity, found.ideal_rmse, wavenumber)
            }
        })
    };
    let (parameters, at_reference, singular, uniformity_rmse, ideal_rmse, wavenumber) =
        py.detach(evaluate).map_err(of_film)?;
    Ok(DecouplingNumbers {
        parameters: rows_of(py, &parameters),
        at_reference: vector(&Some(at_reference)).into(),
        singular_mm: rows_of(py, &singular),
        uniformity_rmse,
        ideal_rmse: ideal_rmse.to_array().into(),
        displacement_rmse_mm: ideal_rmse.as_lengths(wavenumber).into(),
        wavenumber_per_mm: wavenumber,
    })
}

/// R_x, R_y, S_z; NaN where they do not exist.
fn vector(parameters: &Option<Parameters>) -> DVec3 {
    parameters.map_or(DVec3::NAN, |p| DVec3::new(p.r_x, p.r_y, p.s_z))
}
