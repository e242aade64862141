//! Experiments that move the film, with the readings of its sensor.

use magsplice::FilmError;
use magsplice::magnet::{Bend, Deformation, HeightMap};
use magsplice::prelude::DVec3;
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;

use crate::exceptions::{bad_value, of_film};
use crate::film::Film;
use crate::results::{WithArrays, dictionary, quantities};
use crate::vectors::vectors;

/// The shape of a bent film, from Python.
#[derive(FromPyObject)]
pub(crate) enum Shape<'py> {
    /// Axis and radius of a cylinder, in millimetres.
    Cylinder(usize, f64),
    /// Points of a height map, in millimetres.
    Heights(PyReadonlyArray2<'py, f64>),
}

/// The readings at the steps of the film, and their columns. `seed` is the seed of the noise.
#[pyfunction]
pub(crate) fn experiment<'py>(
    py: Python<'py>,
    film: &Film,
    step_mm: [f64; 3],
    seed: Option<u64>,
    shift_mm: [f64; 3],
    rotation_deg: [f64; 3],
    bend: Option<Shape<'py>>,
) -> PyResult<WithArrays<'py>> {
    let sensor = film.layout.sensor.as_ref();
    if seed.is_some() && sensor.is_none_or(|sensor| sensor.as_one().noise_t == DVec3::ZERO) {
        return Err(of_film(FilmError::NoNoise));
    }
    let bend = match bend {
        None => None,
        Some(Shape::Cylinder(along, radius)) => Some(Bend::Cylinder { along, radius }),
        Some(Shape::Heights(points)) => Some(Bend::Heights(
            HeightMap::from_points(vectors(&points)?)
                .map_err(|error| bad_value(format_args!("heights_mm: {error}")))?,
        )),
    };
    let deformation =
        Deformation { bend, rotation_rad: rotation_deg.map(f64::to_radians).into(), shift: shift_mm.into() };
    let real = match deformation == Deformation::default() {
        true => None,
        false => Some(film.evaluated(py)?.deformed(&deformation).map_err(|error| {
            bad_value(format_args!("this bend or shift of the film is impossible (lengths in mm): {error}"))
        })?),
    };
    let found = film.run(py, |film| film.experiments(step_mm.into(), seed, real.as_ref()))?;
    Ok((dictionary(py, &found)?, quantities(py, &found.table())?))
}
