//! Positions of a head by the readings of all its sensors.

use glam::DVec3;
use magsplice_sensor::{HeadFit, HeadLocator, HeadUnknowns, LocateError, Located, Noise, mean_at_rest};

use super::readings::{AtRest, FilmReadings, LOCATOR_BYTES_PER_POINT, MOST_DEVIATIONS, STRETCH};
use super::source::Source;
use super::table::ColumnQuantity;
use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

/// Probability that the residual of a right reading is called too large.
pub const RESIDUAL_ALARM: f64 = 1e-3;

/// Share of the readings up to which too large residuals are chance.
const MOST_ALARMS: f64 = 10.0 * RESIDUAL_ALARM;

/// What all sensors of a head tell beside the position.
#[derive(Clone, Debug)]
pub struct HeadFits {
    /// What was fitted beside the position.
    pub unknowns: HeadUnknowns,
    /// The fit of each reading; `None` without a position.
    pub fits: Vec<Option<HeadFit>>,
    /// Whether deviations and residuals count in the noise of the sensors.
    pub has_noise: bool,
}

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
        let locator = HeadLocator::new(sensed.clone(), volume.grid.clone(), unknowns).map_err(FilmError::of_head)?;
        let mut locator = locator.with_constant_readings(&constants_t);
        if let Some(Noise { deviation_t }) = noise {
            locator = locator.with_deviation(deviation_t);
        }
        let has_noise = noise.is_some() || head.deviation_t().min_element() > 0.0;
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
        let found = located.iter().map(|fit| match fit {
            Ok(fit) => {
                let of_fit = Located { position: fit.position, gradient: fit.gradient };
                if is_excused(fit) { Ok(of_fit) } else { Err(LocateError::Outside(of_fit)) }
            }
            Err(error) => Err(error.clone()),
        });
        let sums = readings_t.chunks(count).zip(&located).map(|(row, fit)| {
            let constant_free: Vec<DVec3> =
                row.iter().zip(&constants_t).map(|(of, constant_t)| *of - *constant_t).collect();
            if fit.is_ok() { head.sum_t(&constant_free) } else { DVec3::NAN }
        });
        let closed_form_mm = self.closed_form_mm(&sensed, head.sum_t(&at_rest_t), sums);
        Ok(FilmReadings {
            source: Source::of(self),
            readings: rows,
            found: found.collect(),
            closed_form_mm,
            origin_mm,
            noise,
            elastomer: self.layout().elastomer,
            hint: None,
            of_head: Some(HeadFits { unknowns, fits: located.into_iter().map(Result::ok).collect(), has_noise }),
        })
    }
}

impl HeadFits {
    /// A value of each fit; NaN without a position.
    pub fn of_each(&self, value: impl Fn(&HeadFit) -> DVec3) -> Vec<DVec3> {
        self.fits.iter().map(|fit| fit.as_ref().map_or(DVec3::NAN, &value)).collect()
    }

    /// Whether the residual of a reading is larger than the noise allows, but for one in
    /// 1 / [`RESIDUAL_ALARM`].
    pub fn is_residual_too_large(&self, reading: usize) -> bool {
        let probability = self.fits[reading].as_ref().and_then(HeadFit::probability);
        self.has_noise && probability.is_some_and(|probability| probability < RESIDUAL_ALARM)
    }

    /// Words for readings that the film, a uniform stray field and noise do not explain. `None` if
    /// they are as rare as chance makes them.
    pub fn remark(&self) -> Option<String> {
        let large: Vec<usize> = (0..self.fits.len()).filter(|reading| self.is_residual_too_large(*reading)).collect();
        let located = self.fits.iter().flatten().count();
        if large.is_empty() || (large.len() as f64) < MOST_ALARMS * located as f64 {
            return None;
        }
        let fits = || large.iter().filter_map(|reading| self.fits[*reading].as_ref());
        let mut without = vec![0_usize; fits().map(|fit| fit.suspect + 1).max().unwrap_or(0)];
        fits().filter_map(|fit| fit.contradicting_sensor(RESIDUAL_ALARM)).for_each(|sensor| without[sensor] += 1);
        let (sensor, most) = without.iter().enumerate().max_by_key(|(_, count)| **count)?;
        let chip = match 2 * most > large.len() {
            true => format!("; without sensor {} it is noise in {most} of them: that sensor is suspect", sensor + 1),
            false => String::new(),
        };
        Some(format!(
            "the residual of {} of {located} readings is larger than the noise allows (in 1 of {} by chance): iron or a \
             magnet is near, the film differs from the layout, or a sensor has other errors than stated; the deviations \
             do not contain this{chip}",
            large.len(),
            (1.0 / RESIDUAL_ALARM).round()
        ))
    }

    /// Stray field, rotation, deviations and chi squared of each reading, as columns.
    pub fn columns(&self) -> Vec<ColumnQuantity> {
        const DEGREES: f64 = 180.0 / std::f64::consts::PI;
        let stray = self.unknowns.has_stray_field();
        let turn = self.unknowns.has_rotation();
        let with_noise = |is_fitted: bool| is_fitted && self.has_noise;
        let vectors: [(bool, &'static str, &'static [&'static str; 3], fn(&HeadFit) -> DVec3); 4] = [
            (stray, "stray_t", &["stray_x_t", "stray_y_t", "stray_z_t"], |fit| fit.stray_t),
            (
                with_noise(stray),
                "stray_deviation_t",
                &["stray_deviation_x_t", "stray_deviation_y_t", "stray_deviation_z_t"],
                |fit| fit.stray_deviation_t,
            ),
            (turn, "rotation_deg", &["rotation_x_deg", "rotation_y_deg", "rotation_z_deg"], |fit| {
                DEGREES * fit.rotation_rad
            }),
            (
                with_noise(turn),
                "rotation_deviation_deg",
                &["rotation_deviation_x_deg", "rotation_deviation_y_deg", "rotation_deviation_z_deg"],
                |fit| DEGREES * fit.rotation_deviation_rad,
            ),
        ];
        let fitted = vectors.into_iter().filter(|(is_fitted, ..)| *is_fitted);
        let mut columns: Vec<ColumnQuantity> = fitted
            .map(|(_, name, components, value)| ColumnQuantity::of_vectors(name, components, &self.of_each(value)))
            .collect();
        let freedom = self.fits.iter().flatten().next().map_or(0, |fit| fit.degrees_of_freedom);
        if self.has_noise && freedom > 0 {
            let ratio = |fit: &Option<HeadFit>| fit.as_ref().map_or(f64::NAN, |fit| fit.chi_squared / freedom as f64);
            columns.push(ColumnQuantity::of_numbers(&["chi_squared_over_freedom"], self.fits.iter().map(ratio)));
        }
        columns
    }
}
