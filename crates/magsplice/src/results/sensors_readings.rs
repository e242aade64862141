//! Positions of a head from the readings of all its sensors.

use std::collections::BTreeSet;

use glam::DVec3;
use magsplice_magnet::Grid;
use magsplice_sensor::{HeadFit, HeadLocator, HeadUnknowns, LocateError, Located, Noise, mean_at_rest};

use super::head_fits::{HeadFits, RESIDUAL_ALARM};
use super::readings::{
    AtRest, EXPLAINED, FilmReadings, LOCATOR_BYTES_PER_POINT, MOST_DEVIATIONS, STRETCH, is_near, other_columns,
};
use super::source::Source;
use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

impl Film {
    /// The position of the head of the layout for each reading: one reading of each sensor, in
    /// their order, in tesla. `unknowns` are fitted to them by least squares beside the position.
    /// `at_rest` has as many readings for each position. The closed form is that of the weighted
    /// sum. Other arguments are those of [`Film::read`].
    ///
    /// # Errors
    /// As [`Film::read`]; [`FilmError::NoHead`] for a layout with one sensor,
    /// [`FilmError::SensorReadings`] for readings that are not one of each sensor, and
    /// [`FilmError::HeadLocator`] for more unknowns than readings.
    pub fn read_sensors(
        &self,
        readings_t: &[DVec3],
        at_rest: AtRest,
        noise: Option<Noise>,
        unknowns: HeadUnknowns,
    ) -> Result<FilmReadings, FilmError> {
        let head = self.head().ok_or(FilmError::NoHead)?;
        let count = head.elements.len();
        let of_rest = match at_rest {
            AtRest::Constant(_) => &[][..],
            AtRest::Zero(readings_t) | AtRest::Rest(readings_t) => readings_t,
        };
        if let Some(other) = [readings_t, of_rest].into_iter().find(|readings_t| readings_t.len() % count != 0) {
            return Err(FilmError::SensorReadings { sensors: count, given: other.len() });
        }
        let volume = self.volume_for(LOCATOR_BYTES_PER_POINT)?;
        let sensed = self.sensed_field(&volume.grid)?;
        let at_reference_t = sensed.readings_of_sensors_t(&[volume.reference_mm]).map_err(FilmError::Points)?;
        let at_reference_t: Vec<DVec3> = at_reference_t.into_iter().flatten().collect();
        let mean = |readings_t: &[DVec3]| -> Result<Vec<DVec3>, FilmError> {
            let of = |sensor: usize| {
                let of_sensor: Vec<DVec3> = readings_t.iter().copied().skip(sensor).step_by(count).collect();
                mean_at_rest(&of_sensor).ok_or(FilmError::AtRest(LocateError::NotFinite))
            };
            (0..count).map(of).collect()
        };
        let (constants_t, at_rest_t) = match at_rest {
            AtRest::Constant(constant_t) => (vec![constant_t; count], at_reference_t),
            AtRest::Zero(readings_t) => {
                let means_t = mean(readings_t)?.into_iter();
                (means_t.zip(&at_reference_t).map(|(mean_t, at_t)| mean_t - *at_t).collect(), at_reference_t)
            }
            AtRest::Rest(readings_t) => (vec![DVec3::ZERO; count], mean(readings_t)?),
        };
        let locator = HeadLocator::new(sensed.clone(), volume.grid, unknowns).map_err(FilmError::of_head)?;
        let mut locator = locator.with_constant_readings(&constants_t);
        if let Some(Noise { deviation_t }) = noise {
            locator = locator.with_deviation(deviation_t);
        }
        if let AtRest::Zero(readings_t) = at_rest {
            // The mean at rest has noise of its own.
            locator = locator.with_noise_times((1.0 + count as f64 / readings_t.len().max(1) as f64).sqrt());
        }
        let has_noise = locator.has_noise();
        let origin_mm = match at_rest {
            AtRest::Rest(_) => locator.locate(&at_rest_t).remove(0).map_err(FilmError::AtRest)?.position,
            AtRest::Constant(_) | AtRest::Zero(_) => volume.reference_mm,
        };
        let rows = readings_t.len() / count;
        let mut located = Vec::with_capacity(rows);
        for stretch in readings_t.chunks(count * STRETCH) {
            self.tell(Stage { name: "readings", done: located.len(), of: Some(rows), unit: "readings" });
            located.extend(locator.locate(stretch));
        }
        // Noise may have moved a position out of the volume.
        let is_excused = |fit: &HeadFit| {
            let outside = (volume.grid.lower() - fit.position).max(fit.position - volume.grid.upper());
            fit.is_within || has_noise && outside.cmple(MOST_DEVIATIONS * fit.position_deviation).all()
        };
        let located_of = |fit: &Result<HeadFit, LocateError>| match fit {
            Ok(fit) => {
                let of_fit = Located { position: fit.position, gradient: fit.gradient };
                if is_excused(fit) { Ok(of_fit) } else { Err(LocateError::Outside(of_fit)) }
            }
            Err(error) => Err(error.clone()),
        };
        let found: Vec<Result<Located, LocateError>> = located.iter().map(located_of).collect();
        let sums = readings_t.chunks(count).zip(&located).map(|(row, fit)| {
            let constant_free: Vec<DVec3> =
                row.iter().zip(&constants_t).map(|(of, constant_t)| *of - *constant_t).collect();
            if fit.is_ok() { head.sum_t(&constant_free) } else { DVec3::NAN }
        });
        let closed_form_mm = self.closed_form_mm(&sensed, head.sum_t(&at_rest_t), sums);
        let mut wrong: BTreeSet<usize> = (0..rows).filter(|row| is_lost(&located[*row], &volume.grid)).collect();
        let fits = located.into_iter().map(Result::ok).collect();
        let mut of_head = HeadFits { unknowns, fits, has_noise, contradicting: None };
        let tried = |wrong: &BTreeSet<usize>| -> Vec<DVec3> {
            let step = wrong.len().div_ceil(MOST_TRIED).max(1);
            let rows = wrong.iter().step_by(step).flat_map(|row| &readings_t[count * row..count * (row + 1)]);
            rows.copied().collect()
        };
        let contradictory: BTreeSet<usize> = of_head.contradictory().into_iter().collect();
        wrong.extend(&contradictory);
        let hint = (2 * wrong.len() > rows && wrong.len() >= LEAST_TRIED)
            .then(|| other_columns(|change| explained_share(&locator, &tried(&wrong), change) >= EXPLAINED))
            .flatten();
        if hint.is_none() && !contradictory.is_empty() {
            of_head.contradicting = locator.contradicting_sensor(&tried(&contradictory), RESIDUAL_ALARM);
        }
        Ok(FilmReadings {
            source: Source::of(self),
            readings: rows,
            found,
            closed_form_mm,
            origin_mm,
            noise,
            assumes_rest: at_rest == AtRest::Constant(DVec3::ZERO),
            states_errors: self.layout().states_errors_of_tiles(),
            elastomer: self.layout().elastomer,
            hint,
            of_head: Some(of_head),
        })
    }
}

/// Least number of readings by which another unit or other axes are tried.
const LEAST_TRIED: usize = 3;

/// Largest number of readings by which causes of contradictions are tried.
const MOST_TRIED: usize = 20;

/// Whether a reading has no position in the volume, or is beyond the range of a sensor.
fn is_lost(found: &Result<HeadFit, LocateError>, volume: &Grid) -> bool {
    match found {
        Ok(fit) => !is_near(fit.position, volume),
        found => matches!(found, Err(LocateError::NoPosition | LocateError::Saturated)),
    }
}

/// Share of readings that, changed so, have a position in the volume, and a residual that is noise.
fn explained_share(locator: &HeadLocator, readings_t: &[DVec3], change: &dyn Fn(DVec3) -> DVec3) -> f64 {
    let changed: Vec<DVec3> = readings_t.iter().map(|reading_t| change(*reading_t)).collect();
    let fits = locator.locate(&changed);
    let is_explained = |fit: &&Result<HeadFit, LocateError>| {
        let is_noise = |fit: &HeadFit| {
            !locator.has_noise() || fit.probability().is_none_or(|probability| probability >= RESIDUAL_ALARM)
        };
        fit.as_ref().is_ok_and(|fit| is_near(fit.position, locator.grid()) && is_noise(fit))
    };
    fits.iter().filter(is_explained).count() as f64 / fits.len().max(1) as f64
}
