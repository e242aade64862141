//! Searches for films.

use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

use magsplice::design::{DesignProblem, ProgressUpdate, SpliceRequest, distances_of};
use magsplice::layout::{Brief, Goal, Preset, StatedSensor, Under};
use magsplice::results::FoundFilm;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::exceptions::{bad_value, failed, one_of};
use crate::film::{Film, PRESETS};
use crate::interruption::Interruption;
use crate::results::dictionary;
use crate::threads::detached;

/// Searches for a better film under the table [design] of the layout, or with another smallest
/// amplitude. `is_spliced` is whether the layout is that [`pattern`]. `progress` is called with
/// stage, finished items, number of items and best error.
#[pyfunction]
pub(crate) fn design<'py>(
    py: Python<'py>,
    film: &Film,
    least_amplitude: Option<f64>,
    is_spliced: bool,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyDict>, String)> {
    let layout = &film.layout;
    let problem = detached(py, || match (least_amplitude, &layout.brief) {
        (Some(least), Some(brief)) => {
            DesignProblem::from_brief(layout, Brief { least_amplitude: Some(least), ..brief.clone() })
        }
        _ => DesignProblem::new(layout),
    })?
    .map_err(failed)?;
    let (interruption, last) = (Interruption::default(), Mutex::new(None));
    let search = || {
        problem.search(&|update| {
            *last.lock().unwrap_or_else(PoisonError::into_inner) = Some(update);
            if interruption.has_begun() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
    };
    let tell = || match (&progress, last.lock().unwrap_or_else(PoisonError::into_inner).take()) {
        (Some(call), Some(ProgressUpdate { stage, done, of, best })) => {
            call.call1((stage.name(), done, of, best)).map(|_| ())
        }
        _ => Ok(()),
    };
    let result = interruption.run_and_tell(py, search, tell)?.map_err(failed)?;
    let program = concat!("magsplice ", env!("CARGO_PKG_VERSION"));
    let found = match is_spliced {
        true => problem.spliced_layout(&result, &format!("{program} splice")),
        false => problem.designed_layout(&result, &format!("{program} design")),
    };
    let text = found.to_compact_toml();
    let result = detached(py, || FoundFilm::new(result, found))?.map_err(failed)?;
    Ok((dictionary(py, &result)?, text))
}

/// The start layout of a search, as TOML. Lengths are in millimetres.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python passes them by name")]
pub(crate) fn pattern(
    wavelength_mm: f64,
    film_mm: [f64; 2],
    thickness_mm: Option<f64>,
    remanence_t: f64,
    range_mm: Option<[f64; 2]>,
    distance_mm: Option<[f64; 2]>,
    smallest_cut_mm: Option<f64>,
    gap_mm: f64,
    resolution_mm: f64,
    resolution_deg: f64,
    least_amplitude: f64,
    parts: Option<usize>,
    goal: &str,
    starts: usize,
    seed: u64,
    preset: Option<&str>,
    under: &str,
    one_sided: bool,
    sensor: Option<&str>,
    name: Option<String>,
) -> PyResult<String> {
    let goal: Goal = one_of("goal", goal, "\"uniformity\", \"displacement\" or \"field\"")?;
    let preset = preset.map(|name| one_of::<Preset>("preset", name, PRESETS)).transpose()?;
    let under: Under = one_of("under", under, "\"nominal\" or \"tolerance\"")?;
    let part = |name: &str| {
        let known =
            || bad_value(format_args!("sensor = {name:?}, must be one of: {}", StatedSensor::part_names().join(", ")));
        StatedSensor::of_part(name).ok_or_else(known)
    };
    let sensor = sensor.map(part).transpose()?;
    let default = SpliceRequest::new(wavelength_mm, film_mm);
    let request = SpliceRequest {
        name,
        thickness_mm: thickness_mm.unwrap_or(default.thickness_mm),
        remanence_t,
        range_mm: range_mm.unwrap_or(default.range_mm),
        distance_mm: distance_mm.map_or(default.distance_mm, distances_of),
        smallest_cut_mm: smallest_cut_mm.unwrap_or(default.smallest_cut_mm),
        preset,
        one_sided,
        sensor,
        brief: Brief {
            gap_mm,
            resolution_mm,
            resolution_deg,
            least_amplitude: Some(least_amplitude),
            parts,
            goal,
            under,
            starts,
            seed,
            ..default.brief
        },
        ..default
    };
    Ok(request.layout().map_err(failed)?.to_compact_toml())
}
