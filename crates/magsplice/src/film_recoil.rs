//! The polarization of films whose tiles have a recoil permeability, and what it changes.

use std::sync::Arc;

use glam::DVec3;
use magsplice_decouple::{Decoupling, Figure, Figures};
use magsplice_field::Scene;
use magsplice_ideal::{Comparison, IdealFilm};
use magsplice_layout::{Layout, WorkingVolume};
use magsplice_magnet::{BoundingBox, Grid, Permeability, Quantity, Tile};
use magsplice_recoil::tolerances::MAX_CELLS;
use magsplice_recoil::{
    DemagnetizedCell, Group, Magnetization, RecoilTile, RefinementError, TileChange, refine_within,
};
use serde::Serialize;

use crate::film_error::FilmError;
use crate::stage::{Progress, Stage};

/// Most points of a working volume at which the effect of recoil is evaluated, once for each level.
const MOST_POINTS: usize = 2_000;

/// Most points along each axis of a volume that has more. Fields below a film are smooth.
const MOST_POINTS_ALONG: usize = 9;

/// Distance of the points around the tiles of a layout without a working volume, in shortest sides
/// of the box around all tiles.
const POINTS_OUTSIDE: f64 = 1.0;

/// Distance from a tile, in its shortest side, within which B is not asked to be known to the
/// stated error. It is that of the cell beside the point, and unbounded at edges.
const NEAREST: f64 = 0.01;

/// Most tiles for which [`RecoilEstimate::new`] gives an estimate, so that `check` stays fast.
const MOST_ESTIMATED_TILES: usize = 1_000;

/// The self-consistent polarization of a film, and its effect with error estimates.
///
/// Clones share the cells.
#[derive(Clone, Debug)]
pub struct FilmRecoil {
    /// The cells with their polarization.
    pub magnetization: Arc<Magnetization>,
    /// What recoil changes.
    pub summary: RecoilSummary,
}

/// What recoil changes in a film, with estimates of the errors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecoilSummary {
    /// Number of cells of the last level.
    pub cells: usize,
    /// Level of division.
    pub level: usize,
    /// Largest change of B, at points of the working volume. Without a working volume, at points
    /// around the box of all tiles, at a distance of its shortest side; nearer to the tiles B
    /// changes more.
    pub change_t: f64,
    /// Estimate of the largest error of B at the same points.
    pub error_t: f64,
    /// Figures over a few points of the working volume. `None` without an ideal film and a working
    /// volume, or if they do not exist.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub figures: Option<FiguresWithRecoil>,
    /// Largest lost fraction of the magnitude of the polarization of a tile.
    pub largest_weakening: f64,
    /// Largest angle by which the mean polarization of a tile turns.
    pub largest_turn_deg: f64,
}

/// Figures of a film without and with recoil over its working volume; over few points of it, if it
/// has more than 2000.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FiguresWithRecoil {
    /// Figures of the rigid film.
    pub without: Figures,
    /// Figures with recoil.
    pub with_recoil: Figures,
    /// Estimates of the errors of the figures with recoil.
    pub errors: Figures,
}

/// What recoil changes in the figures of a film, to first order and with one cell for each tile.
///
/// # Accuracy
/// The error of the change of the amplitude is tens of percent. Where the fields of the tiles of a
/// designed film cancel, the change of an error of the film may be wrong by a factor.
/// [`crate::Film`] computes these changes with an error estimate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RecoilEstimate {
    /// The permeability of all tiles. `None` for those that the layout states.
    pub recoil_permeability: Option<f64>,
    /// Figures of the rigid film.
    pub without: Figures,
    /// Figures with recoil.
    pub with_recoil: Figures,
}

impl FilmRecoil {
    /// Solves for the polarization of a layout. `None` if its tiles have no recoil.
    pub(crate) fn new(layout: &Layout, progress: &dyn Progress) -> Result<Option<FilmRecoil>, FilmError> {
        if !layout.has_recoil() {
            return Ok(None);
        }
        let tiles = recoil_tiles(layout, None);
        let failed = |error| FilmError::from_recoil(error, layout);
        let points = points(layout);
        let figures = FigureGrid::new(layout);
        let quantity = |cells: &[Tile]| {
            let scene = scene(layout, cells);
            let field_t = scene.field_at(Quantity::FluxDensity, &points);
            let mut values = field_t
                .map_or(vec![f64::NAN; 3 * points.len()], |field_t| field_t.iter().flat_map(DVec3::to_array).collect());
            values.extend(
                figures
                    .iter()
                    .flat_map(|grid| grid.figures(&scene).map_or([f64::NAN; Figure::ALL.len()], |found| flat(&found))),
            );
            values
        };
        let of_field = 3 * points.len();
        let bare = layout.bare_tiles();
        let rigid = quantity(&bare);
        let tolerances = |rigid: &[f64], values: &[f64]| {
            let change_t = largest_vector(&differences(&values[..of_field], &rigid[..of_field]));
            let mut tolerances = vec![f64::INFINITY; rigid.len()];
            tolerances[..of_field].fill(layout.material.recoil_error * change_t);
            tolerances
        };
        let told = |level: usize| progress.show(Stage { name: "polarization, level", done: level, of: None, unit: "" });
        let group = Group { vectors: points.len(), components: 3 };
        let refined =
            refine_within(&tiles, &layout.iron, MAX_CELLS, &[group], tolerances, quantity, told).map_err(failed)?;
        let (values, errors) = (&refined.values, &refined.errors);
        let of_rigid = figures.as_ref().and_then(|grid| grid.figures(&scene(layout, &bare)));
        let found = of_rigid.map(|without| {
            let [with_recoil, errors] = [values, errors].map(|flat| unflat(&without, &flat[of_field..]));
            FiguresWithRecoil { without, with_recoil, errors }
        });
        let tile_changes = refined.magnetization.tile_changes();
        let largest = |of: fn(&TileChange) -> f64| tile_changes.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
        let summary = RecoilSummary {
            cells: refined.magnetization.fields_t().len(),
            level: refined.level,
            change_t: largest_vector(&differences(&values[..of_field], &rigid[..of_field])),
            error_t: errors[0],
            figures: found.filter(|_| values[of_field..].iter().all(|value| value.is_finite())),
            largest_weakening: largest(|change| change.weakening),
            largest_turn_deg: largest(|change| change.angle.to_degrees()),
        };
        Ok(Some(FilmRecoil { magnetization: Arc::new(refined.magnetization), summary }))
    }

    /// The weakening and the turn of each tile.
    pub fn tile_changes(&self) -> Vec<TileChange> {
        self.magnetization.tile_changes()
    }

    /// The cells beyond the knee of the material, and their share of the volume of all tiles.
    /// `None` if the layout states no knee.
    pub fn beyond_knee(&self, layout: &Layout) -> Option<(Vec<DemagnetizedCell>, f64)> {
        let knee_t = layout.material.knee_field_t?;
        Some((self.magnetization.beyond_knee(knee_t), self.magnetization.share_beyond_knee(knee_t)))
    }
}

/// Permeabilities assumed for a layout without any: typical values of rare-earth magnets, and of
/// weak bonded magnets.
const TRIED_PERMEABILITIES: [f64; 2] = [1.05, 1.2];

impl RecoilEstimate {
    /// The estimates for the permeabilities of a layout, or if it states none, for those that
    /// magnets have. Empty where [`RecoilEstimate::new`] has none.
    ///
    /// # Errors
    /// As [`RecoilEstimate::new`].
    pub fn usual(layout: &Layout) -> Result<Vec<RecoilEstimate>, FilmError> {
        let tried = if layout.has_recoil() { &TRIED_PERMEABILITIES[..1] } else { &TRIED_PERMEABILITIES };
        let permeability = |mu_r: &f64| Permeability::isotropic(*mu_r).expect("a permeability of magnets");
        let found = tried.iter().map(|mu_r| RecoilEstimate::new(layout, permeability(mu_r)));
        found.filter_map(Result::transpose).collect()
    }

    /// The estimates for the permeabilities of a layout. Empty if it states none.
    ///
    /// # Errors
    /// As [`RecoilEstimate::new`].
    pub fn of_stated(layout: &Layout) -> Result<Vec<RecoilEstimate>, FilmError> {
        if layout.has_recoil() { RecoilEstimate::usual(layout) } else { Ok(Vec::new()) }
    }

    /// The estimate for tiles with the permeabilities of the layout, or if it states none, all with
    /// `permeability`. `None` if the layout has no ideal film or no working volume, has more than a
    /// thousand tiles, or its figures do not exist.
    ///
    /// # Errors
    /// [`FilmError::Recoil`] if tiles overlap.
    pub fn new(layout: &Layout, permeability: Permeability) -> Result<Option<RecoilEstimate>, FilmError> {
        let stated = layout.has_recoil();
        let Some(grid) = FigureGrid::new(layout).filter(|_| layout.tiles.len() <= MOST_ESTIMATED_TILES) else {
            return Ok(None);
        };
        let tiles = recoil_tiles(layout, (!stated).then_some(permeability));
        let estimate = Magnetization::first_order(&tiles, &layout.iron, 1, |_| {})
            .map_err(|error| FilmError::from_recoil(RefinementError::Recoil(error), layout))?;
        let figures = [&layout.bare_tiles()[..], estimate.cells()].map(|tiles| grid.figures(&scene(layout, tiles)));
        let [Some(without), Some(with_recoil)] = figures else { return Ok(None) };
        let recoil_permeability = (!stated).then_some(permeability.along());
        Ok(Some(RecoilEstimate { recoil_permeability, without, with_recoil }))
    }
}

/// The scene of tiles or their cells before the iron of a layout.
fn scene(layout: &Layout, tiles: &[Tile]) -> Scene {
    Scene::new(tiles).with_planes(&layout.iron).expect("tiles before the iron, as the layout requires")
}

/// The tiles of a layout with their permeabilities, or all with one.
pub(crate) fn recoil_tiles(layout: &Layout, permeability: Option<Permeability>) -> Vec<RecoilTile> {
    let tiles = layout.tiles.iter().zip(layout.permeabilities());
    tiles.map(|(named, own)| RecoilTile { tile: named.tile, permeability: permeability.unwrap_or(own) }).collect()
}

/// Few points of the working volume outside all tiles. If it has none, the corners of a box around
/// all tiles and the middles of its faces, before the iron.
fn points(layout: &Layout) -> Vec<DVec3> {
    let is_outside = |point: &DVec3| !layout.tiles.iter().any(|named| is_near(&named.tile, *point));
    let grid = layout.volume.as_ref().map(|volume| coarse(&volume.grid));
    let reference_mm = layout.volume.as_ref().map(|volume| volume.reference_mm);
    let of_volume: Vec<DVec3> = grid.iter().flat_map(Grid::points).chain(reference_mm).filter(is_outside).collect();
    if !of_volume.is_empty() {
        return of_volume;
    }
    let BoundingBox { lower, upper } = BoundingBox::from_tiles(layout.tiles.iter().map(|named| &named.tile));
    let margin = DVec3::splat(POINTS_OUTSIDE * (upper - lower).min_element());
    let around = Grid::new(lower - margin, upper + margin, [3; 3]).expect("a box of finite sides");
    let middle = around.point(around.len() / 2);
    around.points().filter(|point| *point != middle && layout.iron.plane_before(*point).is_none()).collect()
}

/// Whether a point is in a tile, or nearer to it than [`NEAREST`].
fn is_near(tile: &Tile, point: DVec3) -> bool {
    let local = (tile.rotation().inverse() * (point - tile.position())).abs();
    (local - 0.5 * tile.size()).max_element() <= NEAREST * tile.size().min_element()
}

/// The grid, or one with few points along each axis in the same region.
fn coarse(grid: &Grid) -> Grid {
    if grid.len() <= MOST_POINTS {
        return *grid;
    }
    let counts = grid.counts().map(|count| count.min(MOST_POINTS_ALONG));
    Grid::new(grid.lower(), grid.upper(), counts).expect("fewer points of a grid")
}

/// The volume over which figures are evaluated.
struct FigureGrid<'a> {
    ideal: &'a IdealFilm,
    volume: &'a WorkingVolume,
    grid: Grid,
    ideal_field_t: Vec<DVec3>,
}

impl<'a> FigureGrid<'a> {
    /// `None` without an ideal film and a working volume below it.
    fn new(layout: &'a Layout) -> Option<FigureGrid<'a>> {
        let (ideal, volume) = (layout.ideal.as_ref()?, layout.volume.as_ref()?);
        let grid = coarse(&volume.grid);
        let ideal_field_t = grid.points().map(|point| ideal.flux_density_t(point)).collect::<Option<_>>()?;
        Some(FigureGrid { ideal, volume, grid, ideal_field_t })
    }

    /// `None` if the figures do not exist.
    fn figures(&self, scene: &Scene) -> Option<Figures> {
        let points: Vec<DVec3> = self.grid.points().collect();
        let field_t = scene.field_at(Quantity::FluxDensity, &points).ok()?;
        let reference_mm = self.volume.reference_mm;
        let reference_t = scene.field(Quantity::FluxDensity, reference_mm).ok()?;
        let comparison = Comparison::new(&points, &field_t, &self.ideal_field_t).ok()?;
        let decoupling = Decoupling::from_field(&self.grid, &field_t, (reference_mm, reference_t), self.ideal).ok()?;
        Some(Figures::new(&decoupling, comparison.amplitude))
    }
}

/// Figures from values in the order of [`Figure::ALL`], without those that are undefined for the
/// rigid film.
fn unflat(rigid: &Figures, values: &[f64]) -> Figures {
    let value = |figure: Figure| rigid.get(figure).map(|_| values[figure.index()]);
    Figures::from_fn(value).expect("displacements and the amplitude are defined")
}

/// The values of figures in the order of [`Figure::ALL`]. An undefined uniformity is 0, which
/// recoil does not change.
fn flat(figures: &Figures) -> [f64; Figure::ALL.len()] {
    Figure::ALL.map(|figure| figures.get(figure).copied().unwrap_or(0.0))
}

fn differences(values: &[f64], others: &[f64]) -> Vec<f64> {
    values.iter().zip(others).map(|(value, other)| value - other).collect()
}

/// The length of the longest of vectors whose components follow each other.
fn largest_vector(components: &[f64]) -> f64 {
    components.chunks(3).map(|vector| DVec3::from_slice(vector).length()).fold(0.0, f64::max)
}
