//! The numbers that the figures and the page draw: the field of the film and of the ideal film, the
//! decoupling parameters, and the tiles that are drawn.

use std::ops::Deref;

use glam::DVec3;
use magsplice::decouple::{Branch, Decoupling, Parameter, Parameters};
use magsplice::field::{PointErrorCause, PointErrors};
use magsplice::layout::{Layout, NamedTile, WorkingVolume};
use magsplice::prelude::{Accuracy, Grid, IdealFilm, Quantity, Tolerance};
use magsplice::{Film, FilmError};

use crate::error::ReportError;
use crate::tile_shapes::in_plane;

/// Number of cells along a side of a map in a figure: finer than print resolves.
const MAP_CELLS: usize = 128;

/// Maximum number of tiles drawn. A viewer needs minutes for a figure of more.
const MAX_TILES: usize = 20_000;

/// The tiles to draw: all, or if they are too many the ones nearest to the reference point of the
/// working volume, or to the origin, seen from above.
pub(crate) fn tiles_to_draw(layout: &Layout) -> Vec<&NamedTile> {
    let mut drawn: Vec<&NamedTile> = layout.tiles.iter().collect();
    if drawn.len() > MAX_TILES {
        let centre_mm = layout.volume.as_ref().map_or(DVec3::ZERO, |volume| volume.reference_mm);
        let distance = |named: &&NamedTile| named.tile.position().truncate().distance_squared(centre_mm.truncate());
        drawn.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        drawn.truncate(MAX_TILES);
    }
    drawn
}

/// What is left of the error of the field of the ideal film, as a fraction of |B|. Its phases are
/// right to one unit of round-off of about ten periods, its exponential to a few more.
pub(crate) const IDEAL_ROUND_OFF: f64 = 1e-14;

/// Error bounds by which a component of B must exceed zero. Two, because the stated bound does not
/// count the displacement of points in the frames of rotated tiles.
pub(crate) const BOUNDS_OF_ZERO: f64 = 2.0;

/// Error bounds, over the magnitude of B, by which a parameter must differ from zero.
const BOUNDS_PER_PARAMETER: f64 = 4.0;

/// The largest component of B that may be an error alone, at each point, in tesla: the stated error
/// of the exact field, and the tolerance if there is one.
pub(crate) fn round_off_t(film: &Film, points: &[DVec3], field_t: &[DVec3]) -> Vec<f64> {
    let tolerated_t = |b: &DVec3| match film.scene().accuracy() {
        Accuracy::Within(Tolerance::Relative { fraction, .. }) => fraction * b.length(),
        Accuracy::Within(Tolerance::AbsoluteT { error_t, .. }) => error_t,
        _ => 0.0,
    };
    let exact_t = film.scene().error_bounds_t(points);
    exact_t.into_iter().zip(field_t).map(|(bound, b)| BOUNDS_OF_ZERO * bound + tolerated_t(b)).collect()
}

/// The vector with each component set to 0 whose magnitude is at most `round_off`.
pub(crate) fn without_round_off(b: DVec3, round_off: f64) -> DVec3 {
    DVec3::from(b.to_array().map(|c| if c.abs() <= round_off { 0.0 } else { c }))
}

/// A film over its working volume.
pub(crate) struct Survey<'a> {
    pub(crate) volume: &'a WorkingVolume,
    /// B in tesla on the grid of the volume, z fastest. Components that are round-off are 0.
    pub(crate) field_t: Vec<DVec3>,
    /// Components of B up to this are round-off, at every point of the grid, in tesla.
    pub(crate) round_off_t: f64,
    /// The ideal film and the decoupling parameters, if the layout has an ideal film.
    pub(crate) against_ideal: Option<AgainstIdeal<'a>>,
}

/// The ideal film over the same grid, and the decoupling parameters of the spliced film.
pub(crate) struct AgainstIdeal<'a> {
    pub(crate) film: &'a IdealFilm,
    pub(crate) decoupling: Decoupling,
    /// The branch of the arctangents on the axis of the film.
    pub(crate) branch: Branch,
    /// Best-fit amplitude over the volume.
    pub(crate) amplitude: f64,
}

impl<'a> Survey<'a> {
    /// The survey of a film; `None` if its layout has no working volume.
    pub(crate) fn new(film: &'a Film) -> Result<Option<Survey<'a>>, ReportError> {
        let Ok(volume) = film.volume() else { return Ok(None) };
        let field_t = film.volume_field_t()?;
        let against_ideal = match film.ideal() {
            Ok(ideal) => {
                let decoupling = film.decouple()?.decoupling;
                let amplitude = film.compare()?.comparison.amplitude;
                // decouple() returned, so the reference point has parameters and thus a branch.
                Branch::from_axis_field(film.reference_field_t()?).map(|branch| AgainstIdeal {
                    film: ideal,
                    decoupling,
                    branch,
                    amplitude,
                })
            }
            Err(_) => None,
        };
        let points: Vec<DVec3> = volume.grid.points().collect();
        let round_off_t = round_off_t(film, &points, field_t);
        let most_t = round_off_t.iter().copied().filter(|b| b.is_finite()).fold(0.0, f64::max);
        let field_t = field_t.iter().zip(&round_off_t).map(|(&b, &bound)| without_round_off(b, bound)).collect();
        Ok(Some(Survey { volume, field_t, round_off_t: most_t, against_ideal }))
    }

    /// Heights of the lowest, the middle and the highest plane of the grid, without repetition.
    pub(crate) fn heights_mm(&self) -> Vec<f64> {
        let grid = &self.volume.grid;
        let last = grid.counts()[2] - 1;
        let mut planes = vec![0, last / 2, last];
        planes.dedup();
        planes.into_iter().map(|plane| grid.coordinate(2, plane)).collect()
    }
}

impl AgainstIdeal<'_> {
    /// The parameters of the ideal film on the x, y or z axis at this coordinate. `z_mm` is the
    /// height of the x and y axes.
    pub(crate) fn ideal_on_axis(&self, z_mm: f64, axis: usize, at_mm: f64) -> Option<Parameters> {
        let mut point = DVec3::new(0.0, 0.0, z_mm);
        let branch = Branch::from_axis_field(self.film.flux_density_t(point)?)?;
        point[axis] = at_mm;
        Parameters::from_field(self.film.flux_density_t(point)?, branch)
    }
}

/// R_x, R_y and S_z; NaN where they do not exist.
pub(crate) fn as_vector(parameters: Option<Parameters>) -> DVec3 {
    parameters.map_or(DVec3::NAN, |p| DVec3::from(Parameter::ALL.map(|parameter| p.get(parameter))))
}

/// The field at the points of a grid. Values are in the order of the grid: the last axis runs
/// fastest.
pub(crate) struct GridField {
    pub(crate) grid: Grid,
    /// B in tesla; NaN where it is unbounded, and in iron. Components that are round-off are 0.
    pub(crate) field_t: Vec<DVec3>,
    /// Components of B up to this are round-off, in tesla.
    round_off_t: Vec<f64>,
}

impl GridField {
    pub(crate) fn new(film: &Film, grid: Grid) -> Result<GridField, FilmError> {
        let mut field_t = vec![DVec3::ZERO; grid.len()];
        if film.head().is_some() {
            field_t = film.field_at_t(&grid.points().collect::<Vec<DVec3>>())?;
        } else if let Err(PointErrors(mut errors)) =
            film.scene().field_on_grid_into(Quantity::FluxDensity, &grid, &mut field_t)
        {
            let is_blank = |cause| matches!(cause, PointErrorCause::Unbounded { .. } | PointErrorCause::InIron { .. });
            errors.retain(|error| !is_blank(error.cause));
            if !errors.is_empty() {
                return Err(FilmError::Points(PointErrors(errors)));
            }
        }
        let points: Vec<DVec3> = grid.points().collect();
        let round_off_t = round_off_t(film, &points, &field_t);
        for (b, &bound) in field_t.iter_mut().zip(&round_off_t) {
            *b = without_round_off(*b, bound);
        }
        Ok(GridField { grid, field_t, round_off_t })
    }

    /// B of the ideal film in tesla; NaN where Eq. 2 does not hold.
    pub(crate) fn ideal_t(&self, film: &IdealFilm) -> Vec<DVec3> {
        let ideal = |point| film.flux_density_t(point).unwrap_or(DVec3::NAN);
        self.grid.points().map(ideal).map(|b| without_round_off(b, IDEAL_ROUND_OFF * b.length())).collect()
    }

    /// B of the film minus B of the ideal film times `amplitude`, in tesla. Components that are
    /// round-off are 0.
    pub(crate) fn difference_t(&self, ideal_t: &[DVec3], amplitude: f64) -> Vec<DVec3> {
        let difference = |((field_t, ideal_t), bound): ((&DVec3, &DVec3), &f64)| {
            let ideal = amplitude * *ideal_t;
            without_round_off(*field_t - ideal, bound + IDEAL_ROUND_OFF * ideal.length())
        };
        self.field_t.iter().zip(ideal_t).zip(&self.round_off_t).map(difference).collect()
    }

    /// The decoupling parameters; NaN where they do not exist.
    ///
    /// R_x and R_y that are round-off are 0: an error of B of one bound changes them by at most a
    /// few times the bound over |B_z|.
    pub(crate) fn parameters(&self, branch: Branch) -> Vec<DVec3> {
        let of_cell = |(&b, bound): (&DVec3, &f64)| {
            let least = BOUNDS_PER_PARAMETER * bound / b.z.abs();
            let angle = |r: f64| if r.abs() <= least { 0.0 } else { r };
            let found = Parameters::from_field(b, branch);
            as_vector(found.map(|found| Parameters { r_x: angle(found.r_x), r_y: angle(found.r_y), ..found }))
        };
        self.field_t.iter().zip(&self.round_off_t).map(of_cell).collect()
    }

    /// Differences of S_z up to this are round-off at each point: an error of B of one bound
    /// changes S_z by at most a few times the bound over the largest component of B.
    pub(crate) fn log_round_off(&self) -> impl Iterator<Item = f64> {
        let of_cell = |(b, bound): (&DVec3, &f64)| BOUNDS_PER_PARAMETER * bound / b.abs().max_element();
        self.field_t.iter().zip(&self.round_off_t).map(of_cell)
    }
}

/// The field on a plane through the working volume, at the centres of cells.
pub(crate) struct FieldSlice {
    /// The axis normal to the plane, and the coordinate of the plane along it.
    pub(crate) normal: usize,
    pub(crate) at_mm: f64,
    /// The two axes that span the plane.
    pub(crate) axes: [usize; 2],
    /// Lower and upper end along these axes, in millimetres.
    pub(crate) ranges_mm: [[f64; 2]; 2],
    field: GridField,
}

impl Deref for FieldSlice {
    type Target = GridField;

    fn deref(&self) -> &GridField {
        &self.field
    }
}

impl FieldSlice {
    /// The slice of the working volume where coordinate `normal` is `at_mm`, with B at the centre
    /// of each cell. B is NaN where it is unbounded.
    pub(crate) fn new(film: &Film, volume: &WorkingVolume, normal: usize, at_mm: f64) -> Result<FieldSlice, FilmError> {
        let (axes, [lower, upper]) = (in_plane(normal), mapped_region(volume));
        let ranges_mm = axes.map(|axis| [lower[axis], upper[axis]]);
        let field = GridField::new(film, cells_of_plane(volume, normal, at_mm, MAP_CELLS))?;
        Ok(FieldSlice { normal, at_mm, axes, ranges_mm, field })
    }

    /// Number of cells along the two axes.
    pub(crate) fn cells(&self) -> [usize; 2] {
        self.axes.map(|axis| self.grid.counts()[axis])
    }
}

/// Extent of maps along an axis without extent, as a fraction of the longest extent of the volume,
/// and that of a point in millimetres.
const FLAT_EXTENT: f64 = 0.1;
const POINT_EXTENT_MM: f64 = 0.5;

/// Corners of the region of maps: the working volume, and beyond it along axes without extent.
pub(crate) fn mapped_region(volume: &WorkingVolume) -> [DVec3; 2] {
    let extents = volume.upper_mm - volume.lower_mm;
    let longest = extents.max_element();
    let least = if longest > 0.0 { FLAT_EXTENT * longest } else { POINT_EXTENT_MM };
    let beyond = extents.map(|extent| if extent > 0.0 { 0.0 } else { 0.5 * least });
    [volume.lower_mm - beyond, volume.upper_mm + beyond]
}

/// The centres of cells on the plane of the working volume where coordinate `normal` is `at_mm`.
pub(crate) fn cells_of_plane(volume: &WorkingVolume, normal: usize, at_mm: f64, cells: usize) -> Grid {
    let ([mut lower, mut upper], mut counts) = (mapped_region(volume), [1; 3]);
    for axis in in_plane(normal) {
        let half_cell = 0.5 * (upper[axis] - lower[axis]) / cells as f64;
        lower[axis] += half_cell;
        upper[axis] -= half_cell;
        counts[axis] = cells;
    }
    (lower[normal], upper[normal]) = (at_mm, at_mm);
    Grid::new(lower, upper, counts).expect("a slice of a valid volume is a valid grid")
}
