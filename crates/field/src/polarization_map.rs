//! B at fixed points as a linear function of the polarizations of fixed tiles.

use std::fmt;

use glam::DVec3;
use magsplice_magnet::{PointErrors, Quantity, Tile};
use rayon::prelude::*;

use crate::scalar_product::scalar_product;
use crate::scene::Scene;
use crate::tolerances::POINTS_PER_TASK;

/// B at fixed points as a linear function of the polarizations of fixed tiles.
///
/// The map is computed once and then applied to any polarizations, for example to design or vary
/// strengths and directions.
///
/// # Units
/// Polarizations and B in tesla; points in the unit of length of the tiles.
///
/// # Cost
/// The map is computed from three fields of each tile at all points. Its application takes nine
/// multiply-adds per tile and point, for any geometry. Memory bandwidth limits its speed: the map
/// has 72 bytes per tile and point, see [`PolarizationMap::memory_bytes`].
///
/// # Accuracy
/// The field of each tile has the accuracy of a [`Scene`] of this tile. The sum over n tiles adds
/// rounding of at most 3n units of round-off of the sum of the magnitudes. The scene of all tiles
/// is more accurate where the fields of touching tiles cancel. On seams, which contain edges of the
/// single tiles, only the scene has a field.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use magsplice_field::{PolarizationMap, Tile};
///
/// let left = Tile::new(DVec3::new(-1.0, 0.0, 0.5), DVec3::ONE, DVec3::X)?;
/// let right = Tile::new(DVec3::new(1.0, 0.0, 0.5), DVec3::ONE, DVec3::X)?;
/// let map = PolarizationMap::new(&[left, right], &[DVec3::new(0.0, 0.0, -3.0)])?;
/// // Below the centre of two opposed tiles the field is along z.
/// let b_t = map.flux_density(&[0.12 * DVec3::X, -0.12 * DVec3::X]);
/// assert!(b_t[0].x.abs() < 1e-15 && b_t[0].z.abs() > 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PolarizationMap {
    tiles: usize,
    points: usize,
    /// The factors of all components of J, tile after tile, for each point and component of B.
    rows: Vec<f64>,
}

/// The reason why a [`PolarizationMap`] cannot be computed.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum PolarizationMapError {
    /// One of the tiles alone has no field at some of the points.
    Points {
        /// Index of the tile.
        tile: usize,
        /// The points and the reasons.
        errors: PointErrors,
    },
    /// The map needs more memory than can be allocated.
    TooLarge {
        /// Size of the map in bytes; `None` if it exceeds the range of `usize`.
        bytes: Option<usize>,
    },
}

impl PolarizationMap {
    /// The map of tiles at points. The polarizations of `tiles` are ignored.
    ///
    /// # Errors
    /// If a point is out of range or on an edge of a tile, even an edge shared with another tile,
    /// or if there is not enough memory.
    pub fn new(tiles: &[Tile], points: &[DVec3]) -> Result<PolarizationMap, PolarizationMapError> {
        let row = 3 * tiles.len();
        let count = row.checked_mul(3).and_then(|per_point| per_point.checked_mul(points.len()));
        let too_large = || PolarizationMapError::TooLarge { bytes: count.and_then(|count| count.checked_mul(8)) };
        let mut rows = Vec::new();
        rows.try_reserve_exact(count.ok_or_else(too_large)?).map_err(|_| too_large())?;
        rows.resize(count.unwrap_or_default(), 0.0);
        let mut field = vec![DVec3::ZERO; points.len()];
        for (index, tile) in tiles.iter().enumerate() {
            for axis in 0..3 {
                let unit =
                    Tile::new(tile.position(), tile.size(), DVec3::AXES[axis]).and_then(|t| t.rotated(tile.rotation()));
                let scene = Scene::new(&[unit.expect("a valid tile with another polarization")]);
                scene
                    .field_into(Quantity::FluxDensity, points, &mut field)
                    .map_err(|errors| PolarizationMapError::Points { tile: index, errors })?;
                for (point_rows, b) in rows.chunks_exact_mut(3 * row).zip(&field) {
                    for (component, value) in b.to_array().into_iter().enumerate() {
                        point_rows[component * row + 3 * index + axis] = value;
                    }
                }
            }
        }
        Ok(PolarizationMap { tiles: tiles.len(), points: points.len(), rows })
    }

    /// B at all points, in tesla; [`PolarizationMap::flux_density_into`] with a new vector.
    ///
    /// # Panics
    /// If there are not as many polarizations as tiles.
    pub fn flux_density(&self, polarizations_t: &[DVec3]) -> Vec<DVec3> {
        let mut field = vec![DVec3::ZERO; self.points];
        self.flux_density_into(polarizations_t, &mut field);
        field
    }

    /// Writes B at all points in tesla, for tiles with these polarizations in tesla, each along the
    /// axes of its tile. Runs in parallel over points; the result is bit-identical for any number
    /// of threads.
    ///
    /// # Panics
    /// If there are not as many polarizations as tiles, or not as many values as points.
    pub fn flux_density_into(&self, polarizations_t: &[DVec3], field: &mut [DVec3]) {
        assert_eq!(polarizations_t.len(), self.tiles, "one polarization per tile");
        assert_eq!(field.len(), self.points, "one value per point");
        let j: Vec<f64> = polarizations_t.iter().flat_map(DVec3::to_array).collect();
        field.par_iter_mut().enumerate().with_min_len(POINTS_PER_TASK).for_each(|(point, b)| {
            *b = DVec3::from([0, 1, 2].map(|component| scalar_product(self.row(point, component), &j)));
        });
    }

    /// A row of the matrix: the derivatives of B_x, B_y or B_z (`component` 0, 1 or 2) at a point
    /// with respect to the components of the polarizations, tile after tile. Dimensionless.
    ///
    /// # Panics
    /// If there is no such point or component.
    pub fn row(&self, point: usize, component: usize) -> &[f64] {
        assert!(point < self.points && component < 3, "a point and a component of the map");
        let length = 3 * self.tiles;
        &self.rows[(3 * point + component) * length..][..length]
    }

    /// Memory of the map in bytes.
    pub fn memory_bytes(&self) -> usize {
        self.rows.capacity() * size_of::<f64>()
    }
}

impl fmt::Display for PolarizationMapError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PolarizationMapError::Points { tile, errors } => {
                let advice = "move the points, or evaluate the scene of all tiles";
                write!(f, "tile {tile} alone has no field at some points: {errors}; {advice}")
            }
            PolarizationMapError::TooLarge { bytes: Some(bytes) } => {
                write!(f, "a map of {bytes} bytes does not fit into memory; use fewer points at a time")
            }
            PolarizationMapError::TooLarge { bytes: None } => {
                f.write_str("the size of the map in bytes overflows; use fewer points at a time")
            }
        }
    }
}

impl std::error::Error for PolarizationMapError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            PolarizationMapError::Points { errors, .. } => Some(errors),
            PolarizationMapError::TooLarge { .. } => None,
        }
    }
}
