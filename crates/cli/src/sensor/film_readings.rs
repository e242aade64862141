//! Readings below a film: their displacements, by the field of the layout and by the closed form.

use std::path::Path;

use magsplice::layout::Layout;
use magsplice::prelude::{Branch, DVec3, Parameters};
use magsplice::sensor::{LocateError, Located, Locator, Noise};
use magsplice::{Film, FilmError};

use crate::failure::Failure;
use crate::words::{film_failure, no_volume};

/// Standard deviations by which a position may be outside the volume because of noise: of normal
/// errors, one of 30 000 is larger.
const MOST_DEVIATIONS: f64 = 4.0;

/// Readings at the beginning of a file that are of the sensor at rest.
#[derive(Clone, Copy)]
pub(crate) struct AtRest {
    /// How many.
    count: usize,
    /// Whether they tell the place of the sensor at rest, and not a constant field.
    is_place: bool,
    /// The option that gave them.
    option: &'static str,
}

impl AtRest {
    /// The numbers of `--zero` and `--rest`, one of which is 0.
    pub(crate) fn new(zero: usize, rest: usize) -> AtRest {
        if rest > 0 {
            AtRest { count: rest, is_place: true, option: "--rest" }
        } else {
            AtRest { count: zero, is_place: false, option: "--zero" }
        }
    }
}

/// Readings below a film, with what was found from them.
pub(crate) struct FilmReadings {
    /// The position of each reading.
    pub(crate) found: Vec<Result<Located, LocateError>>,
    /// The displacement of the sensor by the closed form, NaN where it has none. With an ideal film.
    pub(crate) closed_form_mm: Option<Vec<DVec3>>,
    /// The position from which displacements count.
    pub(crate) origin_mm: DVec3,
    /// Noise of the readings, if it is known.
    pub(crate) noise: Option<Noise>,
}

impl FilmReadings {
    /// Finds the positions. `noise` is that of the readings; without it, that of the sensor of the
    /// layout. `at_rest` says which readings are of the sensor at rest: they tell a constant field, which
    /// is subtracted from all, or the position from which displacements count. `file` has the readings.
    pub(crate) fn new(
        film: &Film,
        layout_path: &Path,
        file: &Path,
        readings_t: &[DVec3],
        at_rest: AtRest,
        noise: Option<Noise>,
    ) -> Result<FilmReadings, Failure> {
        let layout: &Layout = film.layout();
        let failed = |error| film_failure(layout_path, layout, error);
        let volume = film.volume().map_err(|error| no_volume(layout_path, error))?;
        let sensed = film.sensed_field(&volume.grid).map_err(failed)?;
        let at_reference_t =
            sensed.readings_t(&[volume.reference_mm]).map_err(|errors| failed(FilmError::Points(errors)))?[0];
        let refused = |message: String| Failure::Points { path: file.to_owned(), message };
        let AtRest { count, option, .. } = at_rest;
        let resting = readings_t
            .get(..count)
            .ok_or_else(|| refused(format!("has {} readings, fewer than the {count} of {option}", readings_t.len())))?;
        let mean_t = if count > 0 { resting.iter().sum::<DVec3>() / count as f64 } else { at_reference_t };
        let constant_t = if at_rest.is_place { DVec3::ZERO } else { mean_t - at_reference_t };
        let closed_form_mm = film.ideal().ok().map(|ideal| {
            let of = |reading_t: &DVec3| {
                let before_t = sensed.field_of_reading_t(mean_t - constant_t);
                let branch = Branch::from_axis_field(before_t)?;
                let before = Parameters::from_field(before_t, branch)?;
                let field_t = sensed.field_of_reading_t(*reading_t - constant_t);
                Some(Parameters::from_field(field_t, branch)?.displacement_from(&before, ideal.wavenumber()))
            };
            readings_t.iter().map(|reading| of(reading).unwrap_or(DVec3::NAN)).collect()
        });
        let noise = noise.or(Noise::of_sensor(sensed.sensor()));
        let locator = Locator::new(sensed, volume.grid).map_err(|errors| failed(FilmError::Points(errors)))?;
        let locator = locator.with_constant_reading(constant_t);
        let origin_mm = match at_rest.is_place {
            true => match locator.locate(&[mean_t]).remove(0) {
                Ok(located) | Err(LocateError::Outside(located)) => located.position,
                Err(error) => return Err(refused(format!("the mean of the readings of {option}: {error}"))),
            },
            false => volume.reference_mm,
        };
        let mut found = locator.locate(readings_t);
        for found in &mut found {
            if let (Err(LocateError::Outside(located)), Some(noise)) = (&*found, &noise) {
                let outside = (volume.grid.lower() - located.position).max(located.position - volume.grid.upper());
                if noise.of_position(located.gradient).is_some_and(|d| outside.cmple(MOST_DEVIATIONS * d).all()) {
                    *found = Ok(*located);
                }
            }
        }
        Ok(FilmReadings { found, closed_form_mm, origin_mm, noise })
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
