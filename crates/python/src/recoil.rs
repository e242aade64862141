//! The effect of recoil in a film.

use magsplice::RecoilEstimate;
use magsplice::magnet::Permeability;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::exceptions::{bad_value, of_film};
use crate::film::Film;
use crate::results::{WithArrays, dictionary, with_arrays};
use crate::threads::detached;
use crate::vectors::{numbers, rows_of};

/// The effect of recoil in the film and in each tile; None without recoil.
#[pyfunction]
pub(crate) fn recoil<'py>(py: Python<'py>, film: &Film) -> PyResult<Option<WithArrays<'py>>> {
    let Some(found) = film.evaluated(py)?.recoil() else { return Ok(None) };
    let changes = detached(py, || found.tile_changes())?;
    let polarization_t: Vec<_> = changes.iter().map(|change| change.mean_polarization_t).collect();
    let beyond_knee = found.beyond_knee(&film.layout).map(|(_, share)| share);
    let more = [
        ("share_beyond_knee", beyond_knee.into_bound_py_any(py)?),
        ("weakening", numbers(py, changes.iter().map(|change| change.weakening).collect()).into_any()),
        ("angle_deg", numbers(py, changes.iter().map(|change| change.angle.to_degrees()).collect()).into_any()),
        ("mean_polarization_t", rows_of(py, &polarization_t).into_any()),
    ];
    with_arrays(py, &found.summary, more).map(Some)
}

/// Largest permeability of an estimate to first order: the second order is a quarter of it.
const MOST_OF_FIRST_ORDER: f64 = 1.25;

/// The effect of recoil to first order. None if there are no figures.
#[pyfunction]
pub(crate) fn recoil_estimate<'py>(py: Python<'py>, film: &Film, mu_r: f64) -> PyResult<Option<Bound<'py, PyDict>>> {
    let permeability = Permeability::isotropic(mu_r).map_err(bad_value)?;
    if mu_r > MOST_OF_FIRST_ORDER {
        return Err(bad_value(format_args!(
            "mu_r = {mu_r}, must be at most {MOST_OF_FIRST_ORDER} to first order: film.replace(material={{\"recoil_permeability\": \
             {mu_r}}}).recoil solves it"
        )));
    }
    let found = detached(py, || RecoilEstimate::new(&film.layout, permeability))?.map_err(of_film)?;
    found.map(|found| dictionary(py, &found)).transpose()
}
