//! The numbers of a film, and maps of them.

use std::time::Duration;

use magsplice::decouple::{PerAxis, PlaneResidual};
use magsplice::prelude::DVec3;
use magsplice::results::{CheckedExpectation, FilmEvaluation};
use magsplice::{Film, FilmError};
use serde::Serialize;

use crate::request::MapQuantity;

/// Most points of a map along an axis: a screen has few more, and a map of resolutions of so many
/// takes a second.
const MOST_POINTS: usize = 200;

/// The numbers of a film.
#[derive(Serialize)]
pub(crate) struct Evaluated {
    evaluation: FilmEvaluation,
    /// The longest error of the displacement.
    worst_displacement_error_mm: Option<DVec3>,
    /// The point where it occurs.
    worst_displacement_at_mm: Option<DVec3>,
    /// What each displacement shows over the planes normal to its axis, minus the true one.
    residuals_mm: PerAxis<Vec<PlaneResidual>>,
    /// Standard deviation of the displacement by one reading, RMS over the volume. `None` without
    /// noise, or where nothing is seen.
    resolution_mm: Option<DVec3>,
    /// Outcomes of `[expect]`. Those of films as made need samples and are left out.
    expectations: Vec<CheckedExpectation>,
}

/// A quantity on a plane.
#[derive(Serialize)]
pub(crate) struct Mapped {
    x_mm: Vec<f64>,
    y_mm: Vec<f64>,
    /// Values, y fastest; null where there is none.
    values: Vec<Option<f64>>,
}

impl Evaluated {
    /// The numbers of a film.
    ///
    /// # Errors
    /// As [`Film::evaluate`].
    pub(crate) fn of(film: &Film) -> Result<Evaluated, FilmError> {
        let evaluation = film.evaluate()?;
        let outcomes = film.outcomes(None).into_iter();
        let expectations = outcomes.map(|(expectation, outcome)| {
            let outcome = outcome.map_err(|error| error.to_string());
            CheckedExpectation::new(expectation, outcome, film.layout(), Duration::ZERO)
        });
        let (volume, k) = (film.volume()?, film.ideal()?.wavenumber());
        let decoupling = &evaluation.decoupling.decoupling;
        let worst = decoupling.worst_displacement_error(&volume.grid, volume.reference_mm, k);
        Ok(Evaluated {
            worst_displacement_error_mm: worst.map(|(error, _)| error),
            worst_displacement_at_mm: worst.map(|(_, at)| at),
            residuals_mm: decoupling.residuals(&volume.grid, volume.reference_mm, k),
            resolution_mm: resolution_mm(film)?,
            expectations: expectations.collect(),
            evaluation,
        })
    }
}

/// RMS over the volume; `None` without noise, or where nothing is seen.
fn resolution_mm(film: &Film) -> Result<Option<DVec3>, FilmError> {
    match film.resolution(None) {
        Ok(resolution) => Ok(resolution.summary(&resolution.by_field_mm).map(|summary| summary.rms_mm)),
        Err(FilmError::NoNoise) => Ok(None),
        Err(error) => Err(error),
    }
}

impl Mapped {
    /// A quantity along one axis on the plane of a height, over the working volume.
    ///
    /// # Errors
    /// In words, if the film has no working volume or the counts are out of range.
    pub(crate) fn of(
        film: &Film,
        quantity: MapQuantity,
        axis: usize,
        z_mm: f64,
        counts: [usize; 2],
    ) -> Result<Mapped, String> {
        if !counts.iter().all(|count| (2..=MOST_POINTS).contains(count)) {
            return Err(format!("counts = {counts:?}, must be from 2 to {MOST_POINTS}"));
        }
        if axis > 2 {
            return Err(format!("axis = {axis}, must be 0, 1 or 2"));
        }
        let volume = film.volume().map_err(|error| error.to_string())?;
        let (lower, upper) = (volume.lower_mm, volume.upper_mm);
        let coordinates = |axis: usize| -> Vec<f64> {
            let last = (counts[axis] - 1) as f64;
            (0..counts[axis]).map(|n| lower[axis] + n as f64 / last * (upper[axis] - lower[axis])).collect()
        };
        let (x_mm, y_mm) = (coordinates(0), coordinates(1));
        let points: Vec<DVec3> = x_mm.iter().flat_map(|x| y_mm.iter().map(move |y| DVec3::new(*x, *y, z_mm))).collect();
        let vectors = vectors(film, quantity, points).map_err(|error| error.to_string())?;
        let values = vectors.into_iter().map(|v| v.map(|v| v[axis]).filter(|value| value.is_finite())).collect();
        Ok(Mapped { x_mm, y_mm, values })
    }
}

fn vectors(film: &Film, quantity: MapQuantity, points: Vec<DVec3>) -> Result<Vec<Option<DVec3>>, FilmError> {
    Ok(match quantity {
        MapQuantity::FluxDensity => film.field_at_t(&points)?.into_iter().map(Some).collect(),
        MapQuantity::DisplacementError => film.decouple_at(points)?.displacement_errors_mm,
        MapQuantity::Resolution => film.resolution_at(&points, None)?.by_field_mm.into_iter().map(Some).collect(),
    })
}
