//! What recoil changes in a film.

use magsplice::magnet::Permeability;
use magsplice::{RecoilEstimate, decouple};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::exceptions::{bad_value, of_film};
use crate::film::Film;
use crate::vectors::{OptionalTriple, Triple, numbers, rows_of};

/// Figures of a film: amplitude, uniformity RMSE, displacement RMSE in millimetres.
type Figures = (f64, OptionalTriple, Triple);

/// The polarization that agrees with the field, with the fields of the Python class.
#[derive(IntoPyObject)]
pub(crate) struct RecoilNumbers<'py> {
    cells: usize,
    level: usize,
    change_t: f64,
    error_t: f64,
    without: Option<Figures>,
    with_recoil: Option<Figures>,
    errors: Option<Figures>,
    share_beyond_knee: Option<f64>,
    weakening: Bound<'py, PyArray1<f64>>,
    angle_deg: Bound<'py, PyArray1<f64>>,
    mean_polarization_t: Bound<'py, PyArray2<f64>>,
}

/// What recoil changes; None without it.
#[pyfunction]
pub(crate) fn recoil<'py>(py: Python<'py>, film: &Film) -> PyResult<Option<RecoilNumbers<'py>>> {
    let Some(found) = film.recoil(py)? else { return Ok(None) };
    let changes = py.detach(|| found.tile_changes());
    let polarization_t: Vec<_> = changes.iter().map(|change| change.mean_polarization_t).collect();
    let [without, with_recoil] = found.figures().map_or([None; 2], |figures| figures.map(Some));
    Ok(Some(RecoilNumbers {
        cells: found.magnetization().cells().len(),
        level: found.level(),
        change_t: found.change_t(),
        error_t: found.error_t(),
        without: without.map(figures),
        with_recoil: with_recoil.map(figures),
        errors: found.figure_errors().map(figures),
        share_beyond_knee: found.beyond_knee(&film.layout).map(|(_, share)| share),
        weakening: numbers(py, changes.iter().map(|change| change.weakening).collect()),
        angle_deg: numbers(py, changes.iter().map(|change| change.angle.to_degrees()).collect()),
        mean_polarization_t: rows_of(py, &polarization_t),
    }))
}

/// What recoil changes to first order: permeability, None for those of the layout, and figures
/// without and with it. None if there are no figures.
#[pyfunction]
pub(crate) fn recoil_estimate(
    py: Python<'_>,
    film: &Film,
    mu_r: f64,
) -> PyResult<Option<(Option<f64>, Figures, Figures)>> {
    let permeability = Permeability::isotropic(mu_r).map_err(bad_value)?;
    let found = py.detach(|| RecoilEstimate::new(&film.layout, permeability)).map_err(of_film)?;
    Ok(found.map(|found| (found.permeability, figures(found.rigid), figures(found.recoil))))
}

fn figures(of: decouple::Figures) -> Figures {
    (of.amplitude, of.uniformity_rmse.to_array().into(), of.displacement_rmse_mm.to_array().into())
}
