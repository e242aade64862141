//! Which measured tile goes to which place of a film, and which way round.

use magsplice_layout::{Distribution, FilmTolerance, Layout, MAX_NAME_BYTES, Part};
use magsplice_magnet::Tile;
use magsplice_making::{
    AssignmentError, AssignmentProblem, AssignmentSettings, CommonTurn, MeasurementErrors, Orientation, PartlyPlaced,
    PlanRow,
};
use magsplice_tolerance::{RealFilm, Statistics, TileChanges};
use serde::Serialize;

use super::source::Source;
use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

/// What the name of a layout with measured tiles ends with.
const ASSIGNED: &str = ", assigned";

/// Bytes for each point of the volume: points, fields and displacement errors.
const BYTES_PER_POINT: f64 = 128.0;

/// Bytes of the derivatives by J and sides of a tile for each point, and of their basis. Measured
/// with four tiles and two threads: 1269 in all.
const BYTES_PER_TILE: f64 = 2.0 * 6.0 * 24.0;

/// Bytes of the response of a tile for each point.
const BYTES_PER_THREAD: f64 = 296.0;

/// Starts whose end counts as the best one: within a tenth of it.
const NEAR_BEST: f64 = 1.1;

/// A film with the tile of each place. RMS displacement errors are over the working volume and its
/// three axes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FilmAssignment {
    /// The film as ordered.
    #[serde(flatten)]
    pub source: Source,
    /// Number of tiles that were measured.
    pub measured_tiles: usize,
    /// Number of tiles that are left.
    pub spares: usize,
    /// RMS displacement error of the film as ordered.
    pub ordered_rms_mm: f64,
    /// RMS displacement error of the tiles in the given order.
    pub in_order_rms_mm: f64,
    /// The same of the tiles as assigned.
    pub rms_mm: f64,
    /// The same, by the linear model, at which each search ended, least first.
    pub starts_rms_mm: Vec<f64>,
    /// Errors of the measurements, if they are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measurement_errors: Option<MeasurementErrors>,
    /// The RMS displacement error with them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured_rms_mm: Option<Statistics>,
    /// The shim tiles.
    pub shims: Vec<Shim>,
    /// One row for each place.
    pub plan: Vec<PlanRow>,
    /// The tiles where they lie or will lie.
    #[serde(skip)]
    pub tiles: Vec<Tile>,
    /// Turns that all measured tiles of a part have in common.
    #[serde(skip)]
    pub common_turns: Vec<CommonTurn>,
}

/// A tile whose strength is chosen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Shim {
    /// Its place.
    pub place: String,
    /// Strength, negative if the tile is reversed.
    pub strength_t: f64,
}

impl Film {
    /// The tiles of a box at the places that are left, so that the displacement error of the film
    /// is least. `shims` are the places of tiles whose strength is chosen. With errors of the
    /// measurements the distribution that they leave is evaluated. Recoil adds to the field what it
    /// adds to the film as ordered.
    ///
    /// # Errors
    /// [`FilmError::Missing`] without an ideal film and a working volume; [`FilmError::Assignment`]
    /// if the tiles cannot be assigned.
    pub fn assign(
        &self,
        partly: &PartlyPlaced,
        shims: &[usize],
        settings: &AssignmentSettings,
        errors: Option<MeasurementErrors>,
    ) -> Result<FilmAssignment, FilmError> {
        let (layout, ideal) = (self.layout(), self.ideal()?);
        let bytes_per_point = BYTES_PER_POINT
            + BYTES_PER_TILE * layout.tiles.len() as f64
            + BYTES_PER_THREAD * rayon::current_num_threads() as f64;
        let volume = self.evaluation_grid(bytes_per_point)?;
        self.tell(Stage::uncounted("derivatives by tiles"));
        let groups = || partly.groups.iter().map(|group| (group.size_mm, group.places.len())).collect();
        let name = |error: &AssignmentError| match error {
            AssignmentError::NoOrientation { place: index } | AssignmentError::Shim { tile: index } => {
                layout.tiles[*index].name.clone()
            }
            _ => String::new(),
        };
        let failed = |error: AssignmentError| FilmError::Assignment { tile: name(&error), groups: groups(), error };
        let without_errors = |error| failed(AssignmentError::Film(error));
        let film = RealFilm::new(&partly.film, &FilmTolerance::default()).with_iron(layout.iron.clone());
        let film = self.weakened(film);
        let model = TileChanges::new(&film, &volume, ideal).map_err(without_errors)?;
        let ordered_rms_mm = model.exact_rms_mm(&layout.bare_tiles()).map_err(without_errors)?;
        let problem = AssignmentProblem::new(&model, &partly.film, &partly.groups, shims, settings).map_err(failed)?;
        let found =
            problem.solve(settings, self.counting("assigning tiles", settings.starts, "starts")).map_err(failed)?;
        let tiles = problem.film(&found.placed, &found.shim_factors).map_err(failed)?;
        let measured_rms_mm = errors
            .map(|errors| problem.rms_of_measured_mm(&found.placed, &found.shim_factors, &errors, settings.seed))
            .transpose()
            .map_err(failed)?;
        let mut plan: Vec<(usize, PlanRow)> = partly.plan.clone();
        plan.extend(found.placed.iter().map(|placed| {
            let tile = &partly.groups[placed.group].tiles[placed.tile];
            let place = &layout.tiles[placed.place].name;
            (placed.place, PlanRow::new(place, &tile.name, placed.orientation, &tiles[placed.place], false))
        }));
        let parts = layout.parts();
        plan.extend(shims.iter().map(|&shim| {
            let (place, made) = (&layout.tiles[shim].name, &tiles[shim]);
            let part = parts.iter().find(|part| part.tiles.contains(&shim));
            let as_made = |part: &Part| {
                [made, &partly.film[shim]]
                    .into_iter()
                    .find_map(|tile| Orientation::between(part.direction, part.size_mm, tile))
            };
            let orientation = part.and_then(as_made).unwrap_or(Orientation::AS_MEASURED);
            (shim, PlanRow::new(place, PlanRow::SHIM, orientation, made, false))
        }));
        plan.sort_by_key(|(place, _)| *place);
        let measured_tiles = partly.plan.len() + partly.groups.iter().map(|group| group.tiles.len()).sum::<usize>();
        let shim = |&shim: &usize| Shim {
            place: layout.tiles[shim].name.clone(),
            strength_t: shim_strength_t(&partly.film[shim], &tiles[shim]),
        };
        Ok(FilmAssignment {
            source: Source::of(self),
            measured_tiles,
            spares: (measured_tiles + shims.len()).saturating_sub(plan.len()),
            ordered_rms_mm,
            in_order_rms_mm: found.in_order_rms_mm,
            rms_mm: found.rms_mm,
            starts_rms_mm: found.starts_rms_mm,
            measurement_errors: errors,
            measured_rms_mm,
            shims: shims.iter().map(shim).collect(),
            plan: plan.into_iter().map(|(_, row)| row).collect(),
            tiles,
            common_turns: partly.groups.iter().filter_map(CommonTurn::of).collect(),
        })
    }

    /// The layout of an assigned film: its tiles as measured, with the errors of placement and of
    /// measurement. `has_sizes` is whether sides were measured, `program` who assigned, in the
    /// history.
    pub fn assigned_layout(&self, assigned: &FilmAssignment, has_sizes: bool, program: &str) -> Layout {
        let ordered = self.layout();
        let mut layout = Layout::clone(ordered).with_made_tiles(&assigned.tiles);
        if !layout.name.ends_with(ASSIGNED) && layout.name.len() + ASSIGNED.len() <= MAX_NAME_BYTES {
            layout.name += ASSIGNED;
        }
        if let Some(tolerance) = &mut layout.tolerance {
            keep_placement_errors(tolerance, assigned.measurement_errors.unwrap_or_default(), has_sizes);
        }
        layout.history.push(format!(
            "{program}: measured tiles in \"{}\" (sha256 {}), RMS displacement error {:.5} mm, in the order of the list \
             {:.5} mm",
            ordered.name,
            &ordered.sha256[..12],
            assigned.rms_mm,
            assigned.in_order_rms_mm,
        ));
        layout
    }
}

impl FilmAssignment {
    /// The median of the ends of all starts over the best, and the number of starts that ended
    /// within a tenth of the best.
    pub fn agreement(&self) -> (f64, usize) {
        let ends = &self.starts_rms_mm;
        let best = ends[0];
        let near = ends.iter().filter(|end| **end <= NEAR_BEST * best).count();
        (if best > 0.0 { ends[ends.len() / 2] / best } else { 1.0 }, near)
    }
}

/// The strength of a shim in tesla, negative if it is reversed.
fn shim_strength_t(ordered: &Tile, shim: &Tile) -> f64 {
    let j_t = shim.polarization_t();
    j_t.length() * j_t.dot(ordered.polarization_t()).signum()
}

/// Keeps the placement errors. Strength and direction have only the errors of the measurements, and
/// so have sides if they were measured.
fn keep_placement_errors(tolerance: &mut FilmTolerance, errors: MeasurementErrors, has_sizes: bool) {
    for tile in &mut tolerance.tiles {
        tile.strength = Distribution::normal(errors.strength);
        tile.direction = [Distribution::normal(errors.direction_rad), Distribution::normal(errors.direction_rad)];
        if has_sizes {
            tile.size = std::array::from_fn(|_| Distribution::normal(errors.size_mm.unwrap_or(0.0)));
        }
    }
}
