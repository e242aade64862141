//! Positions from readings.

use std::sync::OnceLock;

use glam::{DMat3, DVec3};
use magsplice_magnet::{Grid, PointErrors};
use rayon::prelude::*;
use thiserror::Error;

use crate::descent::{Ending, Region, descend};
use crate::sensed_field::SensedField;
use crate::starts::starts;

/// Margin of the search outside the volume, as a fraction of its extent along each axis.
const REACH: f64 = 0.5;

/// Smallest extent for that fraction, over the diagonal, for volumes without thickness.
const LEAST_EXTENT: f64 = 0.1;

/// Distance from the volume, as a fraction of its diagonal, up to which a position counts as
/// inside: the round-off of positions on its surface.
pub(crate) const ON_SURFACE: f64 = 1e-9;

/// Distance above which two positions differ, as a fraction of the diagonal. Searches end within
/// 1e-16 of the diagonal from each other, unless the gradient nearly vanishes.
pub(crate) const APART: f64 = 1e-6;

/// Steps along an axis of the enlarged grid: enough for a direction along which the volume has no
/// extent, and few enough for any volume.
const LEAST_STEPS: usize = 4;
const MOST_STEPS: usize = 40;

/// Number of readings processed at a time, which bounds the memory.
const BATCH: usize = 1 << 14;

/// Finds the positions of a sensor in a volume from its readings.
#[derive(Debug)]
pub struct Locator<'a> {
    field: SensedField<'a>,
    grid: Grid,
    /// The readings at the points of the grid.
    readings_t: Vec<DVec3>,
    /// Part of every reading that does not come from the film.
    constant_t: DVec3,
    region: Region,
    /// The grid of the volume enlarged by the reach of the search, and the readings at its points.
    /// Evaluated when a reading has no position near the volume.
    enlarged: OnceLock<(Grid, Vec<DVec3>)>,
}

/// The position of a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Located {
    /// The position, in the frame and the unit of length of the tiles.
    pub position: DVec3,
    /// Gradient of the reading there: column j is the derivative along x_j, in tesla per unit of
    /// length. [`Noise`](crate::Noise) computes standard deviations from it.
    pub gradient: DMat3,
}

/// The reason why a reading has no position.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum LocateError {
    /// The reading is not finite.
    #[error("a component of the reading is missing")]
    NotFinite,
    /// The only position found is outside the volume.
    #[error("the position with this reading is outside the volume, at {}", shown(.0.position))]
    Outside(Located),
    /// More than one position in the volume has the reading. The first two.
    #[error("two positions have this reading: {} and {}", shown(.0[0]), shown(.0[1]))]
    Ambiguous([DVec3; 2]),
    /// No position within half the extent of the volume around it has the reading.
    #[error("no position in or near the volume has this reading")]
    NoPosition,
    /// The readings of a head do not determine the numbers that are fitted.
    #[error("the readings do not determine the numbers that are fitted: fit less, or use more sensors")]
    Undetermined,
    /// The reading is at the limit of the sensor's range, and the flux density may be larger.
    #[error("the reading is at the limit of the sensor's range")]
    Saturated,
}

impl Located {
    /// The position of a reading, also outside the volume.
    pub fn of(found: &Result<Located, LocateError>) -> Option<Located> {
        match found {
            Ok(located) | Err(LocateError::Outside(located)) => Some(*located),
            Err(_) => None,
        }
    }
}

impl<'a> Locator<'a> {
    /// A locator for the volume of a grid. The field comes from an exact
    /// [`Scene`](magsplice_field::Scene), read by a perfect sensor or by a [`SensedField`].
    ///
    /// The search begins at points of the grid, so its step must resolve the field: a tenth of the
    /// wavelength of a film is sufficient.
    ///
    /// # Errors
    /// If the field does not exist at points of the grid.
    pub fn new(field: impl Into<SensedField<'a>>, grid: Grid) -> Result<Locator<'a>, PointErrors> {
        let field = field.into();
        let readings_t = field.readings_t(&grid.points().collect::<Vec<DVec3>>())?;
        let (lower, upper) = (grid.lower(), grid.upper());
        let diagonal = (upper - lower).length();
        let reach = REACH * (upper - lower).max(DVec3::splat(LEAST_EXTENT * diagonal));
        let region = Region { lower: lower - reach, upper: upper + reach, diagonal };
        Ok(Locator { field, grid, readings_t, constant_t: DVec3::ZERO, region, enlarged: OnceLock::new() })
    }

    /// Sets a constant part of all readings in addition to the field of the tiles: a stray field,
    /// or an unspecified offset of the sensor.
    pub fn with_constant_reading(self, constant_t: DVec3) -> Locator<'a> {
        Locator { constant_t, ..self }
    }

    /// The volume.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    pub(crate) fn region(&self) -> Region {
        self.region
    }

    /// Where searches for a reading begin; those of a thorough search also in the reach around the
    /// volume.
    pub(crate) fn starts(&self, reading_t: DVec3, thorough: bool) -> Vec<DVec3> {
        let (grid, at_grid_t) = match thorough {
            true => {
                let (grid, at_grid_t) = self.enlarged.get_or_init(|| self.enlarged());
                (grid, at_grid_t)
            }
            false => (&self.grid, &self.readings_t),
        };
        starts(grid, at_grid_t, reading_t - self.constant_t, thorough)
    }

    /// The position of each reading, in the frame of the tiles. Readings are in tesla, as given by
    /// the sensor.
    ///
    /// Gauss-Newton steps begin at every point of the grid whose field is nearer to the reading
    /// than the fields at its neighbours. If they find no position, they begin anew on a grid that
    /// is enlarged by half the extent of the volume on each side. They use the exact field and its
    /// gradient. The error of positions is the error bound of the field (docs/accuracy.md) over its
    /// gradient. Results do not depend on the other readings or on the number of threads.
    ///
    /// Uniqueness of the position in the volume is not proved: it holds as far as the grid resolves
    /// the field.
    pub fn locate(&self, readings_t: &[DVec3]) -> Vec<Result<Located, LocateError>> {
        readings_t.chunks(BATCH).flat_map(|readings_t| self.locate_batch(readings_t)).collect()
    }

    fn locate_batch(&self, readings_t: &[DVec3]) -> Vec<Result<Located, LocateError>> {
        let mut found = self.search(readings_t, &self.grid, &self.readings_t, false);
        let lost: Vec<usize> = (0..found.len()).filter(|&of| found[of] == Err(LocateError::NoPosition)).collect();
        if !lost.is_empty() {
            let (grid, at_grid_t) = self.enlarged.get_or_init(|| self.enlarged());
            let readings_t: Vec<DVec3> = lost.iter().map(|of| readings_t[*of]).collect();
            for (of, again) in lost.into_iter().zip(self.search(&readings_t, grid, at_grid_t, true)) {
                found[of] = again;
            }
        }
        found
    }

    /// The grid of the region, about as fine as the grid of the volume, and the readings at its
    /// points; NaN on edges of tiles.
    fn enlarged(&self) -> (Grid, Vec<DVec3>) {
        let Region { lower, upper, .. } = self.region;
        let extent = self.grid.upper() - self.grid.lower();
        let counts = [0, 1, 2].map(|axis| {
            let step = extent[axis] / (self.grid.counts()[axis] - 1).max(1) as f64;
            let steps = if step > 0.0 { ((upper - lower)[axis] / step).ceil() } else { 0.0 };
            (steps as usize).clamp(LEAST_STEPS, MOST_STEPS) + 1
        });
        let grid = Grid::new(lower, upper, counts).expect("a region around a grid");
        let (readings_t, _) = self.field.readings_and_gradients(&grid.points().collect::<Vec<DVec3>>());
        (grid, readings_t)
    }

    /// The position of each reading, by searches from points of a grid with these readings. A
    /// `thorough` search has more starts.
    fn search(
        &self,
        readings_t: &[DVec3],
        grid: &Grid,
        at_grid_t: &[DVec3],
        thorough: bool,
    ) -> Vec<Result<Located, LocateError>> {
        let starts: Vec<Result<Vec<DVec3>, LocateError>> = readings_t
            .par_iter()
            .map(|reading| {
                if !reading.is_finite() {
                    return Err(LocateError::NotFinite);
                }
                if self.field.sensor().is_saturated(*reading) {
                    return Err(LocateError::Saturated);
                }
                Ok(starts(grid, at_grid_t, *reading - self.constant_t, thorough))
            })
            .collect();
        let searches: Vec<(DVec3, DVec3)> = readings_t
            .iter()
            .zip(&starts)
            .flat_map(|(reading, starts)| starts.iter().flatten().map(|start| (*reading - self.constant_t, *start)))
            .collect();
        let mut endings = descend(&self.field, &self.region, &searches).into_iter();
        let of_reading = |starts: Result<Vec<DVec3>, LocateError>| {
            let endings: Vec<Ending> = endings.by_ref().take(starts?.len()).collect();
            self.only(&endings)
        };
        starts.into_iter().map(of_reading).collect()
    }

    /// The only position in the volume among the ends of the searches.
    fn only(&self, endings: &[Ending]) -> Result<Located, LocateError> {
        let mut within: Vec<Located> = Vec::new();
        let mut outside: Option<Located> = None;
        for ending in endings {
            let Ending::Found { position, gradient } = *ending else { continue };
            let located = Located { position, gradient };
            let margin = ON_SURFACE * self.region.diagonal;
            let is_within =
                position.cmpge(self.grid.lower() - margin).all() && position.cmple(self.grid.upper() + margin).all();
            if !is_within {
                outside = outside.or(Some(located));
            } else if within.iter().all(|other| other.position.distance(position) > APART * self.region.diagonal) {
                within.push(located);
            }
        }
        match (within.as_slice(), outside) {
            ([located], _) => Ok(*located),
            ([first, second, ..], _) => Err(LocateError::Ambiguous([first.position, second.position])),
            ([], Some(located)) => Err(LocateError::Outside(located)),
            ([], None) => Err(LocateError::NoPosition),
        }
    }
}

/// A position to six decimals.
fn shown(position: DVec3) -> String {
    // Adding 0 turns -0 into 0.
    let [x, y, z] = position.to_array().map(|c| (1e6 * c).round() / 1e6 + 0.0);
    format!("({x}, {y}, {z})")
}
