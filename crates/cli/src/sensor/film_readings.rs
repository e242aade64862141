//! Readings below a film: their displacements, by the field of the layout and by the closed form.

use std::path::Path;

use magsplice::prelude::DVec3;
use magsplice::sensor::{LocateError, Located, Noise};
use magsplice::{AtRest, Film, FilmError};

use crate::failure::Failure;
use crate::words::{film_failure, no_volume};

/// Readings at the beginning of a file that are of the sensor at rest.
#[derive(Clone, Copy)]
pub(crate) struct Resting {
    /// How many.
    count: usize,
    /// Whether they tell the place of the sensor at rest, and not a constant field.
    is_place: bool,
    /// The option that gave them.
    option: &'static str,
}

impl Resting {
    /// The numbers of `--zero` and `--rest`, one of which is 0.
    pub(crate) fn new(zero: usize, rest: usize) -> Resting {
        if rest > 0 {
            Resting { count: rest, is_place: true, option: "--rest" }
        } else {
            Resting { count: zero, is_place: false, option: "--zero" }
        }
    }
}

/// Readings below a film, with what was found from them.
pub(crate) struct FilmReadings {
    /// The position of each reading.
    pub(crate) found: Vec<Result<Located, LocateError>>,
    /// The displacement of the sensor by the closed form, NaN where it has none. With an ideal
    /// film.
    pub(crate) closed_form_mm: Option<Vec<DVec3>>,
    /// The position from which displacements count.
    pub(crate) origin_mm: DVec3,
    /// Noise of the readings, if it is known.
    pub(crate) noise: Option<Noise>,
}

impl FilmReadings {
    /// Finds the positions. `noise` is that of the readings; without it, that of the sensor of the
    /// layout. `at_rest` says which readings are of the sensor at rest: they tell a constant field,
    /// which is subtracted from all, or the position from which displacements count. `file` has the
    /// readings.
    pub(crate) fn new(
        film: &Film,
        layout_path: &Path,
        file: &Path,
        readings_t: &[DVec3],
        at_rest: Resting,
        noise: Option<Noise>,
    ) -> Result<FilmReadings, Failure> {
        let refused = |message: String| Failure::Points { path: file.to_owned(), message };
        let Resting { count, option, is_place } = at_rest;
        let resting = readings_t
            .get(..count)
            .ok_or_else(|| refused(format!("has {} readings, fewer than the {count} of {option}", readings_t.len())))?;
        let at_rest = match (count, is_place) {
            (0, _) => AtRest::Constant(DVec3::ZERO),
            (_, true) => AtRest::Rest(resting),
            (_, false) => AtRest::Zero(resting),
        };
        let reader = film.reader(at_rest, noise).map_err(|error| match error {
            FilmError::AtRest(error) => refused(format!("the mean of the readings of {option}: {error}")),
            FilmError::Missing(_) => no_volume(layout_path, error),
            error => film_failure(layout_path, film.layout(), error),
        })?;
        Ok(FilmReadings {
            found: reader.locate(readings_t),
            closed_form_mm: reader.closed_form_mm(readings_t),
            origin_mm: reader.origin_mm,
            noise: reader.noise,
        })
    }

    /// The position of each reading, also outside the volume. Nothing for a reading with two
    /// positions or none.
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
