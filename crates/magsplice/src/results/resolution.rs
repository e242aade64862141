//! The displacements that noise lets a sensor see.

use glam::DVec3;
use magsplice_decouple::{Branch, Parameters};
use magsplice_head::SensorHead;
use magsplice_layout::PartSetting;
use magsplice_sensor::{HeadLocator, HeadResolution, HeadUnknowns, Noise, SensedField};
use serde::Serialize;

use super::source::Source;
use super::table::{ColumnQuantity, Points, Table};
use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

/// Bytes for each point: gradients, readings and deviations. Measured: 406.
const BYTES_PER_POINT: f64 = 408.0;

/// Standard deviations of displacements at points, for one reading. They are infinite where no
/// displacement can be resolved. Values by point are in [`FilmResolution::table`].
#[derive(Clone, Debug, Serialize)]
pub struct FilmResolution {
    /// The film.
    #[serde(flatten)]
    pub source: Source,
    /// Number of points.
    pub points: usize,
    /// The noise of a reading.
    #[serde(skip)]
    pub noise: Noise,
    /// Readings per second, if the layout states them.
    #[serde(skip)]
    pub rate_hz: Option<f64>,
    /// The points.
    #[serde(skip)]
    pub places: Points,
    /// Whether the reading is at the limit of the sensor's range.
    #[serde(skip)]
    pub saturated: Vec<bool>,
    /// The setting of the sensor's part that holds all readings, and its range in tesla. `None` if
    /// no reading is at the limit, or no setting holds them.
    #[serde(skip)]
    pub larger_range: Option<(PartSetting, DVec3)>,
    /// By the field of the layout.
    #[serde(skip)]
    pub by_field_mm: Vec<DVec3>,
    /// By the closed form. `None` without an ideal film.
    #[serde(skip)]
    pub by_closed_form_mm: Option<Vec<DVec3>>,
    /// By the readings of all sensors of a head. `None` for one sensor.
    #[serde(skip)]
    pub by_sensors: Option<SensorsResolution>,
}

/// Standard deviations of displacements by one reading of each sensor of a head.
#[derive(Clone, Debug)]
pub struct SensorsResolution {
    /// In a known stray field.
    pub known_stray_mm: Vec<DVec3>,
    /// With the stray field fitted to the same readings.
    pub fitted_stray_mm: Vec<DVec3>,
    /// Those of the fitted stray field.
    pub stray_deviation_t: Vec<DVec3>,
    /// Smallest singular value of the derivatives of the readings over their noise, without what a
    /// stray field explains, in 1/mm.
    pub least_singular_value_per_mm: Vec<f64>,
}

/// Standard deviations over all points where the reading is within the sensor's range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResolutionSummary {
    /// Root mean squares.
    pub rms_mm: DVec3,
    /// The least.
    pub least_mm: DVec3,
    /// The largest.
    pub largest_mm: DVec3,
    /// The point with the largest deviation in all axes together.
    pub worst_at_mm: DVec3,
}

impl Film {
    /// The resolution over the working volume with this noise, or with that of the sensor of the
    /// layout.
    ///
    /// # Errors
    /// If the layout has no working volume, [`FilmError::Memory`], [`FilmError::NoNoise`], or the
    /// sensor cannot read the field.
    pub fn resolution(&self, noise: Option<Noise>) -> Result<FilmResolution, FilmError> {
        self.resolution_of(Points::Grid(self.volume_for(BYTES_PER_POINT)?.grid), noise)
    }

    /// The resolution at points of the working volume in millimetres.
    ///
    /// # Errors
    /// As [`Film::resolution`].
    pub fn resolution_at(&self, points_mm: &[DVec3], noise: Option<Noise>) -> Result<FilmResolution, FilmError> {
        self.resolution_of(Points::Scattered(points_mm.to_vec()), noise)
    }

    fn resolution_of(&self, places: Points, noise: Option<Noise>) -> Result<FilmResolution, FilmError> {
        let sensed = self.sensed_field(&self.volume()?.grid)?;
        let sensor = *sensed.sensor();
        // The noise that is given is that of each sensor.
        let head = self.head().map(|head| match noise {
            Some(Noise { deviation_t }) => head.clone().with_noise(deviation_t),
            None => head.clone(),
        });
        let noise = match &head {
            Some(head) => Noise::of_sensor(&head.as_one()),
            None => noise.or(Noise::of_sensor(&sensor)),
        };
        let noise = noise.ok_or(FilmError::NoNoise)?;
        self.tell(Stage::uncounted("resolution"));
        let points: Vec<DVec3> = places.iter().collect();
        let gradient = sensed.gradients(&points).map_err(FilmError::Points)?;
        let readings_t = sensed.readings_t(&points).map_err(FilmError::Points)?;
        let saturated: Vec<bool> = readings_t.iter().map(|b| sensor.is_saturated(sensor.digitized_t(*b))).collect();
        let stated = self.layout().sensor.as_ref().filter(|_| saturated.contains(&true));
        let larger_range = stated.and_then(|sensor| sensor.setting_for(&readings_t));
        // A reading at the limit of the range gives no position.
        let seen = |index: usize, deviations: Option<DVec3>| {
            deviations.filter(|_| !saturated[index]).unwrap_or(DVec3::INFINITY)
        };
        let by_field_mm = gradient.iter().enumerate().map(|(index, g)| seen(index, noise.of_position(*g))).collect();
        let by_closed_form_mm = match self.ideal() {
            Ok(ideal) => {
                let branch = Branch::from_axis_field(self.reference_field_t()?);
                let of = |reading_t: &DVec3| {
                    let field_t = sensed.field_of_reading_t(*reading_t);
                    let (_, derivatives) = Parameters::with_derivatives(field_t, branch?)?;
                    noise.of_parameters(&derivatives, ideal.wavenumber(), &sensor)
                };
                Some(readings_t.iter().enumerate().map(|(index, reading_t)| seen(index, of(reading_t))).collect())
            }
            Err(_) => None,
        };
        let by_sensors = head.map(|head| self.by_sensors(&head, &points)).transpose()?.flatten();
        Ok(FilmResolution {
            source: Source::of(self),
            points: points.len(),
            noise,
            rate_hz: self.layout().sensor.as_ref().and_then(|sensor| sensor.rate_hz),
            places,
            saturated,
            larger_range,
            by_field_mm,
            by_closed_form_mm,
            by_sensors,
        })
    }

    /// The resolution by all sensors; `None` if they are too few for a stray field, or one has no
    /// noise.
    fn by_sensors(&self, head: &SensorHead, points: &[DVec3]) -> Result<Option<SensorsResolution>, FilmError> {
        if 3 * head.elements.len() < HeadUnknowns::StrayField.count() {
            return Ok(None);
        }
        let grid = self.volume()?.grid;
        if head.elements.iter().any(|of| of.sensor.deviation_t().min_element() == 0.0) {
            return Ok(None);
        }
        let of = |unknowns: HeadUnknowns| -> Result<Vec<Option<HeadResolution>>, FilmError> {
            let sensed = SensedField::of_head(self.scene(), head, &grid).map_err(FilmError::Sensor)?;
            let locator = HeadLocator::new(sensed, grid, unknowns).map_err(FilmError::of_head)?;
            Ok(locator.resolution(points))
        };
        let (known, fitted) = (of(HeadUnknowns::Position)?, of(HeadUnknowns::StrayField)?);
        let vectors = |of: &[Option<HeadResolution>], value: fn(&HeadResolution) -> DVec3| -> Vec<DVec3> {
            of.iter().map(|of| of.as_ref().map_or(DVec3::INFINITY, value)).collect()
        };
        let singular = fitted.iter().map(|of| of.map_or(0.0, |of| of.least_singular_value));
        Ok(Some(SensorsResolution {
            known_stray_mm: vectors(&known, |of| of.position_deviation),
            fitted_stray_mm: vectors(&fitted, |of| of.position_deviation),
            stray_deviation_t: vectors(&fitted, |of| of.stray_deviation_t),
            least_singular_value_per_mm: singular.collect(),
        }))
    }
}

impl FilmResolution {
    /// The deviations at all points.
    pub fn table(&self) -> Table {
        let by_field = &["deviation_x_mm", "deviation_y_mm", "deviation_z_mm"];
        let by_closed_form =
            &["closed_form_deviation_x_mm", "closed_form_deviation_y_mm", "closed_form_deviation_z_mm"];
        let mut columns = vec![ColumnQuantity::of_vectors("deviation_mm", by_field, &self.by_field_mm)];
        columns.extend(
            self.by_closed_form_mm
                .as_ref()
                .map(|deviations| ColumnQuantity::of_vectors("closed_form_deviation_mm", by_closed_form, deviations)),
        );
        if let Some(of) = &self.by_sensors {
            let known = &["known_stray_x_mm", "known_stray_y_mm", "known_stray_z_mm"];
            let fitted = &["fitted_stray_x_mm", "fitted_stray_y_mm", "fitted_stray_z_mm"];
            let stray = &["stray_deviation_x_t", "stray_deviation_y_t", "stray_deviation_z_t"];
            columns.push(ColumnQuantity::of_vectors("known_stray_mm", known, &of.known_stray_mm));
            columns.push(ColumnQuantity::of_vectors("fitted_stray_mm", fitted, &of.fitted_stray_mm));
            columns.push(ColumnQuantity::of_vectors("stray_deviation_t", stray, &of.stray_deviation_t));
            let singular = of.least_singular_value_per_mm.iter().copied();
            columns.push(ColumnQuantity::of_numbers(&["least_singular_value_per_mm"], singular));
        }
        Table::new(self.places.clone(), columns, self.source.metadata())
    }

    /// Smallest singular value at the point where it is least and at the tenth percentile of the
    /// points, in 1/mm. `None` for one sensor.
    pub fn least_singular_values_per_mm(&self) -> Option<[f64; 2]> {
        let mut sorted = self.by_sensors.as_ref()?.least_singular_value_per_mm.clone();
        sorted.sort_by(f64::total_cmp);
        Some([*sorted.first()?, *sorted.get(sorted.len() / 10)?])
    }

    /// Summary of deviations at the points. `None` if nothing is seen.
    pub fn summary(&self, deviations_mm: &[DVec3]) -> Option<ResolutionSummary> {
        let within = self.places.iter().zip(deviations_mm).zip(&self.saturated);
        let within: Vec<(DVec3, DVec3)> =
            within.filter(|(_, saturated)| !**saturated).map(|((point, deviation), _)| (point, *deviation)).collect();
        let squares: DVec3 = within.iter().map(|(_, deviation)| deviation * deviation).sum();
        let worst = within.iter().max_by(|(_, a), (_, b)| a.length().total_cmp(&b.length()))?;
        Some(ResolutionSummary {
            rms_mm: (squares / within.len() as f64).map(f64::sqrt),
            least_mm: within.iter().fold(DVec3::INFINITY, |least, (_, deviation)| least.min(*deviation)),
            largest_mm: within.iter().fold(DVec3::ZERO, |largest, (_, deviation)| largest.max(*deviation)),
            worst_at_mm: worst.0,
        })
    }
}
