//! Readings below a film: their displacements, by the field of the layout and by the closed form.

use std::path::Path;

use magsplice::layout::Layout;
use magsplice::prelude::{Branch, DVec3, Parameters};
use magsplice::sensor::{LocateError, Located, Locator};
use magsplice::{Film, FilmError};

use crate::failure::Failure;
use crate::words::{film_failure, no_volume};

/// Readings below a film, with what was found from them.
pub(crate) struct FilmReadings {
    /// The position of each reading.
    pub(crate) found: Vec<Result<Located, LocateError>>,
    /// The displacement of the sensor by the closed form, NaN where it has none. With an ideal film.
    pub(crate) closed_form_mm: Option<Vec<DVec3>>,
    pub(crate) reference_mm: DVec3,
}

impl FilmReadings {
    /// Finds the positions. The first `at_rest` readings are of the sensor at the reference point: what
    /// they show beyond the field of the film there is subtracted from all. `file` has the readings.
    pub(crate) fn new(
        film: &Film,
        layout_path: &Path,
        file: &Path,
        mut readings_t: Vec<DVec3>,
        at_rest: usize,
    ) -> Result<FilmReadings, Failure> {
        let layout: &Layout = film.layout();
        let failed = |error| film_failure(layout_path, layout, error);
        let volume = film.volume().map_err(|error| no_volume(layout_path, error))?;
        let at_reference_t = film.reference_field_t().map_err(failed)?;
        let Some(resting) = readings_t.get(..at_rest) else {
            let message = format!("has {} readings, fewer than the {at_rest} of --zero", readings_t.len());
            return Err(Failure::Points { path: file.to_owned(), message });
        };
        if at_rest > 0 {
            let offset_t = resting.iter().sum::<DVec3>() / at_rest as f64 - at_reference_t;
            readings_t.iter_mut().for_each(|reading| *reading -= offset_t);
        }
        let locator = Locator::new(film.scene(), volume.grid).map_err(|errors| failed(FilmError::Points(errors)))?;
        let closed_form_mm = film.ideal().ok().map(|ideal| {
            let of = |reading_t: &DVec3| {
                let branch = Branch::from_axis_field(at_reference_t)?;
                let before = Parameters::from_field(at_reference_t, branch)?;
                Some(Parameters::from_field(*reading_t, branch)?.displacement_from(&before, ideal.wavenumber()))
            };
            readings_t.iter().map(|reading| of(reading).unwrap_or(DVec3::NAN)).collect()
        });
        Ok(FilmReadings { found: locator.locate(&readings_t), closed_form_mm, reference_mm: volume.reference_mm })
    }

    /// The position of each reading, also outside the volume. Nothing for a reading with two positions or
    /// none.
    pub(crate) fn positions(&self) -> impl Iterator<Item = Option<Located>> + '_ {
        self.found.iter().map(|found| match found {
            Ok(located) | Err(LocateError::Outside(located)) => Some(*located),
            Err(_) => None,
        })
    }

    /// Why readings have no position in the volume, with their lines.
    pub(crate) fn unlocated<'a>(&'a self, lines: &'a [u64]) -> impl Iterator<Item = (u64, String)> + 'a {
        let named = |(found, line): (&Result<Located, LocateError>, &u64)| {
            found.as_ref().err().map(|error| (*line, format!("line {line}: {error}")))
        };
        self.found.iter().zip(lines).filter_map(named)
    }
}
