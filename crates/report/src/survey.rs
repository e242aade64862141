//! Everything that is computed for a report, before anything is drawn.

use glam::DVec3;
use magsplice::decouple::{Branch, Decoupling, Parameters};
use magsplice::field::{Cause, Grid, IdealFilm, PointErrors, Quantity};
use magsplice::layout::WorkingVolume;
use magsplice::{Film, FilmError};

use crate::solid::in_plane;

/// Cells along a side of a map in a figure, more than a printed one shows.
const MAP_CELLS: usize = 128;

/// A film over its working volume.
pub(crate) struct Survey<'a> {
    pub(crate) volume: &'a WorkingVolume,
    /// B in tesla on the grid of the volume, z fastest.
    pub(crate) field_t: Vec<DVec3>,
    /// What the layout's ideal film adds, if it has one.
    pub(crate) against_ideal: Option<AgainstIdeal<'a>>,
}

pub(crate) struct AgainstIdeal<'a> {
    pub(crate) film: &'a IdealFilm,
    /// B of the ideal film on the same grid.
    pub(crate) field_t: Vec<DVec3>,
    pub(crate) decoupling: Decoupling,
    pub(crate) branch: Branch,
}

impl<'a> Survey<'a> {
    /// `None` if the layout has no working volume. `field_t` is its field, if it is known already.
    pub(crate) fn of(film: &Film<'a>, field_t: Option<Vec<DVec3>>) -> Result<Option<Survey<'a>>, FilmError> {
        let Ok(volume) = film.volume() else { return Ok(None) };
        let field_t = field_t.map_or_else(|| film.volume_field_t(), Ok)?;
        assert_eq!(field_t.len(), volume.grid.len(), "one value per point");
        let against_ideal = match film.ideal() {
            Ok(ideal) => {
                let decoupling = film.decouple(&field_t)?;
                let at = |p| ideal.flux_density_t(p).ok_or(FilmError::NotBelow(p));
                let ideal_t = volume.grid.points().map(at).collect::<Result<Vec<DVec3>, FilmError>>()?;
                // There are parameters at the reference point, so it has a branch.
                Branch::from_axis_field(film.reference_field_t()?).map(|branch| AgainstIdeal {
                    film: ideal,
                    field_t: ideal_t,
                    decoupling,
                    branch,
                })
            }
            Err(_) => None,
        };
        Ok(Some(Survey { volume, field_t, against_ideal }))
    }

    /// Indices of the lowest plane of the grid, one in the middle, and the highest, as far as these are different ones.
    pub(crate) fn z_planes(&self) -> Vec<usize> {
        let last = self.volume.grid.counts()[2] - 1;
        let mut planes = vec![0, last / 2, last];
        planes.dedup();
        planes
    }
}

impl AgainstIdeal<'_> {
    /// The ideal film's parameters on the x, y or z axis at this coordinate, at the height `z_mm` if the axis is not z.
    pub(crate) fn ideal_on_axis(&self, z_mm: f64, axis: usize, at_mm: f64) -> Option<Parameters> {
        let mut point = DVec3::new(0.0, 0.0, z_mm);
        let branch = Branch::from_axis_field(self.film.flux_density_t(point)?)?;
        point[axis] = at_mm;
        Parameters::from_field(self.film.flux_density_t(point)?, branch)
    }
}

/// The field on a plane, in cells.
pub(crate) struct Slice {
    /// The axes that span the plane.
    pub(crate) axes: [usize; 2],
    /// From and to along them, in millimetres.
    pub(crate) ranges_mm: [[f64; 2]; 2],
    grid: Grid,
    field_t: Vec<DVec3>,
}

impl Slice {
    /// The part of the working volume where coordinate `normal` is `at_mm`. Where the field is unbounded it is NaN.
    pub(crate) fn of(film: &Film, volume: &WorkingVolume, normal: usize, at_mm: f64) -> Result<Slice, FilmError> {
        let axes = in_plane(normal);
        let (mut lower, mut upper, mut counts) = (volume.lower_mm, volume.upper_mm, [1; 3]);
        // Each cell has the value of its middle.
        for axis in axes {
            let half_cell = 0.5 * (upper[axis] - lower[axis]) / MAP_CELLS as f64;
            lower[axis] += half_cell;
            upper[axis] -= half_cell;
            counts[axis] = MAP_CELLS;
        }
        (lower[normal], upper[normal]) = (at_mm, at_mm);
        let grid = Grid::new(lower, upper, counts).expect("a slice of the volume");
        let ranges_mm = axes.map(|axis| [volume.lower_mm[axis], volume.upper_mm[axis]]);
        let mut field_t = vec![DVec3::ZERO; grid.len()];
        if let Err(errors) = film.scene().field_on_grid_into(Quantity::FluxDensity, &grid, &mut field_t) {
            let other: Vec<_> =
                errors.0.into_iter().filter(|error| !matches!(error.cause, Cause::Unbounded { .. })).collect();
            if !other.is_empty() {
                return Err(FilmError::Points(PointErrors(other)));
            }
        }
        Ok(Slice { axes, ranges_mm, grid, field_t })
    }

    /// Cells along the two axes.
    pub(crate) fn cells(&self) -> [usize; 2] {
        self.axes.map(|axis| self.grid.counts()[axis])
    }

    fn index(&self, u: usize, v: usize) -> usize {
        // The grid has one point along the normal, so the later axis runs fastest.
        u * self.grid.counts()[self.axes[1]] + v
    }

    pub(crate) fn field_t(&self, u: usize, v: usize) -> DVec3 {
        self.field_t[self.index(u, v)]
    }

    /// B of the ideal film in the same cell; NaN where Eq. 2 does not hold.
    pub(crate) fn ideal_t(&self, film: &IdealFilm, u: usize, v: usize) -> DVec3 {
        film.flux_density_t(self.grid.point(self.index(u, v))).unwrap_or(DVec3::NAN)
    }

    /// The decoupling parameters in a cell; `None` where they do not exist.
    pub(crate) fn parameters(&self, branch: Branch, u: usize, v: usize) -> Option<Parameters> {
        Parameters::from_field(self.field_t(u, v), branch)
    }

    /// Every cell.
    pub(crate) fn all(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let [nu, nv] = self.cells();
        (0..nu).flat_map(move |u| (0..nv).map(move |v| (u, v)))
    }
}
