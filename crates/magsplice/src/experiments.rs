//! Experiments in which the film is moved along each axis while its sensor is read.

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_sensor::{ExperimentSettings, ExperimentStep, Locator, SensedField, displacements, experiment};

use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

/// Steps of the experiments of Dai 2024, Fig. 9, along x, y and z, in millimetres: 0.5 mm in shear
/// and 1 mm normal to the film.
pub const EXPERIMENT_STEP_MM: DVec3 = DVec3::new(0.5, 0.5, 1.0);

/// Most steps along an axis.
const MOST_STEPS: f64 = 1e5;

impl Film {
    /// What the sensor reads and tells while the film is moved along x, then y, then z, by
    /// multiples of a step. The sensor stays in the working volume.
    ///
    /// `seed` is that of the noise; without it the readings have none. `real` has the tiles of the
    /// film that is there, where it is not the one of the layout.
    ///
    /// # Errors
    /// If the layout has no working volume, a step is not above 0 or makes more than 100 000 steps,
    /// or the sensor cannot read the field.
    pub fn experiments(
        &self,
        step_mm: DVec3,
        seed: Option<u64>,
        real: Option<&Scene>,
    ) -> Result<[Vec<ExperimentStep>; 3], FilmError> {
        let volume = self.volume()?;
        let (grid, reference) = (volume.grid, volume.reference_mm);
        let most = (grid.upper() - grid.lower()) / step_mm;
        if !(step_mm.cmpgt(DVec3::ZERO).all() && most.cmple(DVec3::splat(MOST_STEPS)).all()) {
            return Err(FilmError::ExperimentStep(step_mm));
        }
        let ordered = self.sensed_field(&grid)?;
        let sensed = match real {
            Some(scene) => SensedField::new(scene, *ordered.sensor(), &grid).map_err(FilmError::Sensor)?,
            None => ordered.clone(),
        };
        let wavenumber = self.ideal().ok().map(|ideal| ideal.wavenumber());
        let settings = ExperimentSettings { reference, wavenumber, seed };
        let locator = Locator::new(ordered, grid).map_err(FilmError::Points)?;
        self.tell(Stage::uncounted("experiments"));
        // One run, so that each reading has noise of its own.
        let along = [0, 1, 2].map(|axis| displacements(&grid, reference, axis, step_mm[axis]));
        let mut steps = experiment(&sensed, &locator, &along.concat(), &settings).map_err(FilmError::Points)?;
        let normal = steps.split_off(along[0].len() + along[1].len());
        let along_y = steps.split_off(along[0].len());
        Ok([steps, along_y, normal])
    }
}
