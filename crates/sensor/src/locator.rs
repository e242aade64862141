//! Positions from readings.

use std::error::Error;
use std::fmt;

use glam::{DMat3, DVec3};
use magsplice_magnet::{Grid, PointErrors};
use rayon::prelude::*;

use crate::descent::{Ending, Region, descend};
use crate::sensed_field::SensedField;
use crate::starts::starts;

/// How far outside the volume positions are searched, as a fraction of its extent along each axis.
const REACH: f64 = 0.5;

/// Least extent that the reach is a fraction of, over the diagonal, for volumes that are a plane.
const LEAST_EXTENT: f64 = 0.1;

/// Distance from the volume, as a fraction of its diagonal, up to which a position counts as
/// within: the round-off of positions on its surface.
const ON_SURFACE: f64 = 1e-9;

/// Distance of two positions, as a fraction of the diagonal, from which on they are different.
/// Searches end within 1e-16 of it from each other, unless the gradient nearly vanishes.
const APART: f64 = 1e-6;

/// Readings that are searched at a time, which bounds the memory.
const BATCH: usize = 1 << 14;

/// Finds the positions in a volume at which a sensor has given readings.
#[derive(Debug)]
pub struct Locator<'a> {
    field: SensedField<'a>,
    grid: Grid,
    /// The readings at the points of the grid.
    readings_t: Vec<DVec3>,
    /// What every reading has beyond that of the film.
    constant_t: DVec3,
    region: Region,
}

/// A position with a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Located {
    /// The position, in the frame and the unit of length of the tiles.
    pub position: DVec3,
    /// Gradient of the reading there: column j is the derivative along x_j, in tesla per unit of
    /// length. [`Noise`](crate::Noise) makes standard deviations from it.
    pub gradient: DMat3,
}

/// Why a reading has no position.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LocateError {
    /// The reading is not finite.
    NotFinite,
    /// The only position found is outside the volume.
    Outside(Located),
    /// More than one position in the volume has the reading. The first two.
    Ambiguous([DVec3; 2]),
    /// No position within half the extent of the volume around it has the reading.
    NoPosition,
    /// The reading is at the limit of the sensor's range, and the flux density may be larger.
    Saturated,
}

impl<'a> Locator<'a> {
    /// A locator for the volume that a grid spans. The field is that of an exact
    /// [`Scene`](magsplice_field::Scene), which a perfect sensor reads, or what a sensor reads of
    /// it.
    ///
    /// The search begins at points of the grid, so its step must resolve the field: a tenth of the
    /// wavelength of a film is enough.
    ///
    /// # Errors
    /// Points of the grid without a field.
    pub fn new(field: impl Into<SensedField<'a>>, grid: Grid) -> Result<Locator<'a>, PointErrors> {
        let field = field.into();
        let readings_t = field.readings_t(&grid.points().collect::<Vec<DVec3>>())?;
        let (lower, upper) = (grid.lower(), grid.upper());
        let diagonal = (upper - lower).length();
        let reach = REACH * (upper - lower).max(DVec3::splat(LEAST_EXTENT * diagonal));
        let region = Region { lower: lower - reach, upper: upper + reach, diagonal };
        Ok(Locator { field, grid, readings_t, constant_t: DVec3::ZERO, region })
    }

    /// The same locator for readings that contain this much besides the field of the tiles: a stray
    /// field, or an offset that the sensor does not state.
    pub fn with_constant_reading(self, constant_t: DVec3) -> Locator<'a> {
        Locator { constant_t, ..self }
    }

    /// The volume.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The position with each reading, in the frame of the tiles. Readings in tesla, as the sensor
    /// gives them.
    ///
    /// Gauss-Newton steps begin at every point of the grid whose field is nearer to the reading
    /// than those of its neighbours. They use the exact field and its gradient. The positions found
    /// are exact to the error of the field, 2e-14 of the sum over tiles, over its gradient. Results
    /// do not depend on the other readings, nor on the number of threads.
    ///
    /// That no other position in the volume has the reading is not proved: it holds as far as the
    /// grid resolves the field.
    pub fn locate(&self, readings_t: &[DVec3]) -> Vec<Result<Located, LocateError>> {
        readings_t.chunks(BATCH).flat_map(|readings_t| self.locate_batch(readings_t)).collect()
    }

    fn locate_batch(&self, readings_t: &[DVec3]) -> Vec<Result<Located, LocateError>> {
        let starts: Vec<Result<Vec<DVec3>, LocateError>> = readings_t
            .par_iter()
            .map(|reading| {
                if !reading.is_finite() {
                    return Err(LocateError::NotFinite);
                }
                if self.field.sensor().is_saturated(*reading) {
                    return Err(LocateError::Saturated);
                }
                Ok(starts(&self.grid, &self.readings_t, *reading - self.constant_t))
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

    /// The only position in the volume among those at which searches ended.
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

impl fmt::Display for LocateError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            LocateError::NotFinite => write!(f, "the reading is not a finite number"),
            LocateError::Outside(located) => {
                write!(f, "the position with this reading is outside the volume, at {}", shown(located.position))
            }
            LocateError::Ambiguous([first, second]) => {
                write!(f, "two positions have this reading: {} and {}", shown(*first), shown(*second))
            }
            LocateError::Saturated => write!(f, "the reading is at the limit of the sensor's range"),
            LocateError::NoPosition => write!(f, "no position in or near the volume has this reading"),
        }
    }
}

/// A position to six digits behind the point.
fn shown(position: DVec3) -> String {
    // Adding 0 turns -0 into 0.
    let [x, y, z] = position.to_array().map(|c| (1e6 * c).round() / 1e6 + 0.0);
    format!("({x}, {y}, {z})")
}

impl Error for LocateError {}
