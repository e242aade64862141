//! The displacements that noise lets a sensor see over the working volume.

use magsplice::layout::WorkingVolume;
use magsplice::prelude::{Branch, DVec3, Parameters};
use magsplice::sensor::Noise;
use magsplice::{Film, FilmError, Stage};

/// Standard deviations of displacements at the points of the working volume, in mm. They are
/// infinite where nothing is seen.
pub(crate) struct FilmResolution {
    pub(crate) noise: Noise,
    /// Readings per second.
    pub(crate) rate_hz: Option<f64>,
    pub(crate) points_mm: Vec<DVec3>,
    /// Whether the reading is at the limit of the sensor's range.
    pub(crate) saturated: Vec<bool>,
    /// By the field of the layout.
    pub(crate) by_field_mm: Vec<DVec3>,
    /// By the closed form, with an ideal film.
    pub(crate) by_closed_form_mm: Option<Vec<DVec3>>,
}

impl FilmResolution {
    /// For this noise, or for that of the sensor of the layout. `None` if neither is stated.
    pub(crate) fn new(
        film: &Film,
        volume: &WorkingVolume,
        noise: Option<Noise>,
    ) -> Result<Option<FilmResolution>, FilmError> {
        let sensed = film.sensed_field(&volume.grid)?;
        let sensor = *sensed.sensor();
        let Some(noise) = noise.or(Noise::of_sensor(&sensor)) else { return Ok(None) };
        film.tell(Stage::uncounted("resolution"));
        let points: Vec<DVec3> = volume.grid.points().collect();
        let gradient = sensed.gradients(&points).map_err(FilmError::Points)?;
        let readings_t = sensed.readings_t(&points).map_err(FilmError::Points)?;
        let saturated: Vec<bool> = readings_t.iter().map(|b| sensor.is_saturated(sensor.digitized_t(*b))).collect();
        // A reading at the limit of the range tells no position.
        let seen = |index: usize, deviations: Option<DVec3>| {
            deviations.filter(|_| !saturated[index]).unwrap_or(DVec3::INFINITY)
        };
        let by_field_mm = gradient.iter().enumerate().map(|(index, g)| seen(index, noise.of_position(*g))).collect();
        let by_closed_form_mm = match film.ideal() {
            Ok(ideal) => {
                let branch = Branch::from_axis_field(film.reference_field_t()?);
                let of = |reading_t: &DVec3| {
                    let field_t = sensed.field_of_reading_t(*reading_t);
                    let (_, derivatives) = Parameters::with_derivatives(field_t, branch?)?;
                    noise.of_parameters(&derivatives, ideal.wavenumber(), &sensor)
                };
                Some(readings_t.iter().enumerate().map(|(index, reading_t)| seen(index, of(reading_t))).collect())
            }
            Err(_) => None,
        };
        let rate_hz = film.layout().sensor.as_ref().and_then(|sensor| sensor.rate_hz);
        Ok(Some(FilmResolution { noise, rate_hz, points_mm: points, saturated, by_field_mm, by_closed_form_mm }))
    }
}
