//! The stiffness of the elastic layer, from forces and readings.

use glam::DVec3;
use magsplice_decouple::PerAxis;
use magsplice_magnet::Axis;
use magsplice_sensor::Stiffness;
use serde::Serialize;

use super::readings::FilmReadings;
use super::source::Source;
use crate::film_error::FilmError;

/// The stiffness along x, y, z, in N/mm and N.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FilmCalibration {
    /// The film.
    #[serde(flatten)]
    pub source: Source,
    /// Number of readings.
    pub readings: usize,
    /// Stiffness of the elastic layer of the layout by Hooke's law. `None` without one.
    pub hooke_n_per_mm: Option<DVec3>,
    /// By displacements from the field of the layout.
    pub by_field: PerAxis<Stiffness>,
    /// By those of the closed form. `None` without an ideal film.
    pub by_closed_form: Option<PerAxis<Stiffness>>,
}

impl FilmReadings {
    /// The stiffness that these readings give, of films under forces in newton.
    ///
    /// # Errors
    /// [`FilmError::NoPosition`] for a reading with two positions or none;
    /// [`FilmError::Stiffness`] for forces that give no line.
    ///
    /// # Panics
    /// If there are not as many forces as readings.
    pub fn calibrate(&self, forces_n: &[DVec3]) -> Result<FilmCalibration, FilmError> {
        let fit = |displacements_mm: &[DVec3]| {
            let of = |axis: Axis| {
                // The film moves by the opposite of the sensor's displacement.
                let displacements: Vec<f64> = displacements_mm.iter().map(|moved| -moved[axis.index()]).collect();
                let forces: Vec<f64> = forces_n.iter().map(|force| force[axis.index()]).collect();
                Stiffness::fit(&displacements, &forces).map_err(|error| FilmError::Stiffness { axis, error })
            };
            Ok(PerAxis { x: of(Axis::X)?, y: of(Axis::Y)?, z: of(Axis::Z)? })
        };
        if let Some(reading) = self.positions().position(|located| located.is_none()) {
            return Err(FilmError::NoPosition { reading });
        }
        Ok(FilmCalibration {
            source: self.source.clone(),
            readings: forces_n.len(),
            hooke_n_per_mm: self.elastomer.map(|layer| layer.hooke_n_per_mm()),
            by_field: fit(&self.displacement_mm())?,
            by_closed_form: self.closed_form_mm.as_deref().map(fit).transpose()?,
        })
    }
}
