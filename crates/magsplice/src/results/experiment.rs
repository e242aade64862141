//! Experiments in which the film is moved along each axis while its sensor is read.

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_layout::Elastomer;
use magsplice_magnet::{Deformation, DeformationError, Tile};
use magsplice_sensor::{ExperimentSettings, ExperimentStep, SensedField, displacements, experiment};
use serde::Serialize;

use super::readings::{LOCATOR_BYTES_PER_POINT, locator};
use super::source::Source;
use super::table::{ColumnQuantity, Rows, Table};
use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

/// Steps of the experiments of Dai 2024, Fig. 9, along x, y and z, in millimetres: 0.5 mm in shear
/// and 1 mm normal to the film.
pub const EXPERIMENT_STEP_MM: DVec3 = DVec3::new(0.5, 0.5, 1.0);

/// Most steps along an axis.
const MOST_STEPS: f64 = 1e5;

/// What a sensor reads while its film is moved. Values by step are in [`FilmExperiments::table`].
#[derive(Clone, Debug, Serialize)]
pub struct FilmExperiments {
    /// The film.
    #[serde(flatten)]
    pub source: Source,
    /// Number of readings.
    pub readings: usize,
    /// The steps along x, y and z.
    #[serde(skip)]
    pub steps: [Vec<ExperimentStep>; 3],
    /// The elastic layer, if the layout has one.
    #[serde(skip)]
    pub elastomer: Option<Elastomer>,
    #[serde(skip)]
    has_ideal: bool,
}

impl Film {
    /// What the sensor reads while the film is moved along x, then y, then z, by multiples of a
    /// step, and the displacements that these readings give. The sensor stays in the working
    /// volume.
    ///
    /// `seed` is the seed of the noise; without it the readings have no noise. `real` is the field
    /// of the film as made, if it differs from the film of the layout.
    ///
    /// # Errors
    /// If the layout has no working volume, a step is not above 0 or makes more than 100 000 steps,
    /// or the sensor cannot read the field.
    pub fn experiments(
        &self,
        step_mm: DVec3,
        seed: Option<u64>,
        real: Option<&Scene>,
    ) -> Result<FilmExperiments, FilmError> {
        let volume = self.volume_for(LOCATOR_BYTES_PER_POINT)?;
        let (grid, reference) = (volume.grid, volume.reference_mm);
        let most = (grid.upper().max(reference) - grid.lower().min(reference)) / step_mm;
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
        let locator = locator(ordered, grid)?;
        self.tell(Stage::uncounted("experiments"));
        // One run, so that each reading has noise of its own.
        let along = [0, 1, 2].map(|axis| displacements(&grid, reference, axis, step_mm[axis]));
        let mut steps = experiment(&sensed, &locator, &along.concat(), &settings).map_err(FilmError::Points)?;
        let readings = steps.len();
        let along_z = steps.split_off(along[0].len() + along[1].len());
        let along_y = steps.split_off(along[0].len());
        Ok(FilmExperiments {
            source: Source::of(self),
            readings,
            steps: [steps, along_y, along_z],
            elastomer: self.layout().elastomer,
            has_ideal: wavenumber.is_some(),
        })
    }

    /// The field of the film after a deformation. Tiles with a recoil permeability keep the
    /// polarization that they have in this film; in a bent film they have its mean. Iron moves with
    /// the film.
    ///
    /// # Errors
    /// See [`DeformationError`].
    pub fn deformed(&self, deformation: &Deformation) -> Result<Scene, DeformationError> {
        let tiles: Vec<Tile> = match self.recoil() {
            // Cells of a bent film would bend each tile, which is stiff.
            Some(recoil) if deformation.bend.is_some() => recoil.magnetization.mean_tiles(),
            Some(recoil) => recoil.magnetization.cells().to_vec(),
            None => self.layout().bare_tiles(),
        };
        let (iron, deformed) = (deformation.apply_to_iron(&self.layout().iron, &tiles)?, deformation.apply(&tiles)?);
        Ok(Scene::new(&deformed).with_planes(&iron).expect("iron that moves with its tiles"))
    }
}

impl FilmExperiments {
    /// All steps, those along x first.
    pub fn all_steps(&self) -> impl Iterator<Item = &ExperimentStep> + Clone {
        self.steps.iter().flatten()
    }

    /// Displacement, reading, and what the reading gives, of each step.
    pub fn table(&self) -> Table {
        let column = |name, components, value: &dyn Fn(&ExperimentStep) -> Option<DVec3>| {
            let values: Vec<DVec3> = self.all_steps().map(|step| value(step).unwrap_or(DVec3::NAN)).collect();
            ColumnQuantity::of_vectors(name, components, &values)
        };
        let mut columns = vec![
            column("film_mm", &["film_dx_mm", "film_dy_mm", "film_dz_mm"], &|step| Some(step.displacement)),
            column("readings_t", &["bx_t", "by_t", "bz_t"], &|step| Some(step.reading_t)),
            column("found_mm", &["found_dx_mm", "found_dy_mm", "found_dz_mm"], &|step| step.by_field),
        ];
        if self.has_ideal {
            columns.push(column("parameters", &["r_x_rad", "r_y_rad", "s_z_ln_t"], &|step| {
                step.parameters.map(|p| DVec3::new(p.r_x, p.r_y, p.s_z))
            }));
            let names = &["closed_form_dx_mm", "closed_form_dy_mm", "closed_form_dz_mm"];
            columns.push(column("closed_form_mm", names, &|step| step.by_closed_form));
        }
        if let Some(layer) = self.elastomer {
            let force = |moved: Option<DVec3>| moved.map(|moved| layer.force_n(moved));
            columns.push(column("force_n", &["fx_n", "fy_n", "fz_n"], &|step| force(Some(step.displacement))));
            let names = &["found_fx_n", "found_fy_n", "found_fz_n"];
            columns.push(column("found_force_n", names, &|step| force(step.by_field)));
            if self.has_ideal {
                let names = &["closed_form_fx_n", "closed_form_fy_n", "closed_form_fz_n"];
                columns.push(column("closed_form_force_n", names, &|step| force(step.by_closed_form)));
            }
        }
        let saturated = self.all_steps().map(|step| step.is_saturated);
        columns.push(ColumnQuantity::of_whole(&["saturated"], saturated));
        let rows = Rows::Numbered { name: "step", first: 1, count: self.readings };
        Table::new(rows, columns, self.source.metadata())
    }
}
