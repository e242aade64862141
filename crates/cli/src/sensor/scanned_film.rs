//! Results of `scan`: a fitted scan with what its positions and its parameters show.

use magsplice::decouple::uniformity_by_planes;
use magsplice::prelude::{Branch, DVec3, Parameters};
use magsplice::scan::{ScanFit, ScanPositions};
use magsplice::sensor::SensedField;
use magsplice::{Film, FilmError};

/// A scan that was fitted.
pub(crate) struct ScannedFilm {
    pub(crate) fit: ScanFit,
    /// Line of each reading.
    pub(crate) lines: Vec<u64>,
    /// Where the sensor was, in the frame of the film.
    pub(crate) places_mm: Vec<DVec3>,
    /// Readings without offset and rotation of the sensor, in the frame of the film.
    pub(crate) corrected_t: Vec<DVec3>,
    /// The field of the layout, times the fitted strength.
    pub(crate) simulated_t: Vec<DVec3>,
    pub(crate) positions: ScanPositions,
    /// With an ideal film.
    pub(crate) uniformity: Option<Uniformity>,
}

/// Uniformity RMSE of R_x, R_y, S_z, without outliers; nothing where no plane has two points.
pub(crate) struct Uniformity {
    pub(crate) readings: [Option<f64>; 3],
    pub(crate) corrected: [Option<f64>; 3],
    pub(crate) simulated: [Option<f64>; 3],
    /// Readings whose parameters do not exist, because B_z is 0.
    pub(crate) singular: usize,
}

impl ScannedFilm {
    pub(crate) fn new(
        film: &Film,
        sensed: &SensedField,
        points: &[DVec3],
        readings_t: &[DVec3],
        lines: Vec<u64>,
        fit: ScanFit,
    ) -> Result<ScannedFilm, FilmError> {
        let parameters = &fit.parameters;
        let places_mm: Vec<DVec3> = points.iter().map(|point| *point + parameters.start).collect();
        // Readings without the errors that the layout states, along the axes of its sensor.
        let sensor = sensed.sensor();
        let scaled_t: Vec<DVec3> =
            readings_t.iter().map(|reading| (*reading - sensor.offset_t) / sensor.gain).collect();
        let corrected_t: Vec<DVec3> =
            scaled_t.iter().map(|reading| sensor.rotation * parameters.corrected_t(*reading)).collect();
        let field_t = sensed.without_gain_and_offset().readings_t(&places_mm).map_err(FilmError::Points)?;
        let simulated_t: Vec<DVec3> =
            field_t.into_iter().map(|field| parameters.strength * (sensor.rotation * field)).collect();
        let kept: Vec<usize> = (0..points.len()).filter(|index| fit.outliers.binary_search(index).is_err()).collect();
        let uniformity = match (film.ideal(), film.reference_field_t()) {
            (Ok(_), Ok(reference_t)) => Branch::from_axis_field(reference_t)
                .map(|branch| Uniformity::new(points, &kept, [readings_t, &corrected_t, &simulated_t], branch)),
            _ => None,
        };
        let positions = ScanPositions::new(points);
        Ok(ScannedFilm { fit, lines, places_mm, corrected_t, simulated_t, positions, uniformity })
    }
}

impl Uniformity {
    /// `fields_t` are the readings, the corrected ones and the field of the layout.
    fn new(points: &[DVec3], kept: &[usize], fields_t: [&[DVec3]; 3], branch: Branch) -> Uniformity {
        let parameters = fields_t.map(|field_t| -> Vec<Option<Parameters>> {
            kept.iter().map(|index| Parameters::from_field(field_t[*index], branch)).collect()
        });
        let usable: Vec<usize> =
            (0..kept.len()).filter(|n| parameters.iter().all(|of_field| of_field[*n].is_some())).collect();
        let places: Vec<DVec3> = usable.iter().map(|n| points[kept[*n]]).collect();
        let [readings, corrected, simulated] = parameters.map(|of_field| {
            let usable: Vec<Parameters> = usable.iter().filter_map(|n| of_field[*n]).collect();
            uniformity_by_planes(&places, &usable).to_array()
        });
        Uniformity { readings, corrected, simulated, singular: kept.len() - usable.len() }
    }
}
