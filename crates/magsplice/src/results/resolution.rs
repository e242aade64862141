//! The displacements that noise lets a sensor see.

use glam::DVec3;
use magsplice_decouple::{Branch, Parameters};
use magsplice_layout::PartSetting;
use magsplice_sensor::Noise;
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
        let noise = noise.or(Noise::of_sensor(&sensor)).ok_or(FilmError::NoNoise)?;
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
        })
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
        Table::new(self.places.clone(), columns, self.source.metadata())
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
