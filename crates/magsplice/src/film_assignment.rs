//! Which measured tile goes to which place of a film, and which way round.

use magsplice_layout::{Distribution, FilmTolerance, Layout, MAX_NAME_BYTES};
use magsplice_magnet::Tile;
use magsplice_making::{
    Assignment, AssignmentError, AssignmentProblem, AssignmentSettings, MeasurementErrors, Orientation, PartlyLaid,
    PlanRow,
};
use magsplice_tolerance::{RealFilm, Statistics, TileChanges};

use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

/// What the name of a layout with measured tiles ends with.
const ASSIGNED: &str = ", assigned";

/// A film with the tile of each place.
#[derive(Clone, Debug)]
pub struct FilmAssignment {
    /// RMS displacement error of the film as ordered, in mm.
    pub ordered_rms_mm: f64,
    /// The tile of each place that was free.
    pub found: Assignment,
    /// Errors of the measurements, and the RMS displacement errors with them.
    pub measurement: Option<(MeasurementErrors, Statistics)>,
    /// The tiles where they lie or will lie.
    pub tiles: Vec<Tile>,
    /// One row for each place.
    pub plan: Vec<PlanRow>,
    /// Index and strength in tesla of each shim tile, negative if it is reversed.
    pub shims: Vec<(usize, f64)>,
}

impl Film {
    /// The tiles of a box at the places that are left, so that the displacement error of the film
    /// is least. `shims` are the places of tiles whose strength is chosen. With errors of the
    /// measurements the distribution that they leave is evaluated. What recoil adds to the field is
    /// that of the film as ordered.
    ///
    /// # Errors
    /// [`FilmError::Missing`] without an ideal film and a working volume; [`FilmError::Assignment`]
    /// if the tiles cannot be assigned.
    pub fn assign(
        &self,
        partly: &PartlyLaid,
        shims: &[usize],
        settings: &AssignmentSettings,
        errors: Option<MeasurementErrors>,
    ) -> Result<FilmAssignment, FilmError> {
        let (layout, ideal, volume) = (self.layout(), self.ideal()?, self.evaluation_grid()?);
        self.tell(Stage::uncounted("assigning tiles"));
        let groups = || partly.groups.iter().map(|group| (group.size_mm, group.places.len())).collect();
        let name = |error: &AssignmentError| match error {
            AssignmentError::NoOrientation { place: index } | AssignmentError::Shim { tile: index } => {
                layout.tiles[*index].name.clone()
            }
            _ => String::new(),
        };
        let failed = |error: AssignmentError| FilmError::Assignment { tile: name(&error), groups: groups(), error };
        let without_errors = |error| failed(AssignmentError::Film(error));
        let film = self.weakened(RealFilm::new(&partly.film, &FilmTolerance::default()));
        let model = TileChanges::new(&film, &volume, ideal).map_err(without_errors)?;
        let ordered_rms_mm = model.exact_rms_mm(&layout.bare_tiles()).map_err(without_errors)?;
        let problem = AssignmentProblem::new(&model, &partly.film, &partly.groups, shims, settings).map_err(failed)?;
        let found = problem.solve(settings).map_err(failed)?;
        let tiles = problem.film(&found.placed, &found.shim_factors).map_err(failed)?;
        let measurement = match errors {
            Some(errors) => {
                let rms = problem.rms_of_measured_mm(&found.placed, &found.shim_factors, &errors, settings.seed);
                Some((errors, rms.map_err(failed)?))
            }
            None => None,
        };
        let mut plan: Vec<(usize, PlanRow)> = partly.plan.clone();
        plan.extend(found.placed.iter().map(|placed| {
            let tile = &partly.groups[placed.group].tiles[placed.tile];
            let place = &layout.tiles[placed.place].name;
            (placed.place, PlanRow::new(place, &tile.name, placed.orientation, &tiles[placed.place], false))
        }));
        plan.extend(shims.iter().map(|&shim| {
            let place = &layout.tiles[shim].name;
            (shim, PlanRow::new(place, PlanRow::SHIM, Orientation::AS_MEASURED, &tiles[shim], false))
        }));
        plan.sort_by_key(|(place, _)| *place);
        let plan = plan.into_iter().map(|(_, row)| row).collect();
        let shims = shims.iter().map(|&shim| (shim, shim_strength_t(&partly.film[shim], &tiles[shim]))).collect();
        Ok(FilmAssignment { ordered_rms_mm, found, measurement, tiles, plan, shims })
    }

    /// The layout of an assigned film: its tiles as measured, and the errors of laying and of the
    /// measurements. `has_sizes` says whether sides were measured, `program` who assigned, in the
    /// history.
    pub fn assigned_layout(&self, assigned: &FilmAssignment, has_sizes: bool, program: &str) -> Layout {
        let ordered = self.layout();
        let mut layout = Layout::clone(ordered).with_made_tiles(&assigned.tiles);
        if !layout.name.ends_with(ASSIGNED) && layout.name.len() + ASSIGNED.len() <= MAX_NAME_BYTES {
            layout.name += ASSIGNED;
        }
        if let Some(tolerance) = &mut layout.tolerance {
            let errors = assigned.measurement.as_ref().map_or(MeasurementErrors::default(), |(errors, _)| *errors);
            of_measured_tiles(tolerance, errors, has_sizes);
        }
        layout.history.push(format!(
            "{program}: measured tiles in \"{}\" (sha256 {}), RMS displacement error {:.5} mm, in the order of the list \
             {:.5} mm",
            ordered.name,
            &ordered.sha256[..12],
            assigned.found.rms_mm,
            assigned.found.in_order_rms_mm,
        ));
        layout
    }
}

/// The strength of a shim in tesla, negative if it is reversed.
fn shim_strength_t(ordered: &Tile, shim: &Tile) -> f64 {
    let j_t = shim.polarization_t();
    j_t.length() * j_t.dot(ordered.polarization_t()).signum()
}

/// Leaves the errors of laying. Strength and direction are known but for the errors of the
/// measurements, and so are sides if they were measured.
fn of_measured_tiles(tolerance: &mut FilmTolerance, errors: MeasurementErrors, has_sizes: bool) {
    for tile in &mut tolerance.tiles {
        tile.strength = Distribution::normal(errors.strength);
        tile.direction = [Distribution::normal(errors.direction_rad), Distribution::normal(errors.direction_rad)];
        if has_sizes {
            tile.size = std::array::from_fn(|_| Distribution::normal(errors.size_mm.unwrap_or(0.0)));
        }
    }
}
