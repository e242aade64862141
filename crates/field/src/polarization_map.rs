//! B at given points as a linear function of the polarizations of tiles that stay where they are.

use std::fmt;

use glam::DVec3;
use magsplice_magnet::{PointErrors, Quantity, Tile};
use rayon::prelude::*;

use crate::scalar_product::scalar_product;
use crate::scene::Scene;
use crate::tolerances::POINTS_PER_TASK;

/// B at fixed points as a linear function of the polarizations of fixed tiles: made once, then applied to any polarizations, as when strengths and
/// directions are designed or varied.
///
/// # Cost
/// It is made from three fields of each tile alone at all points. To apply it takes nine multiply-adds for a tile and a point, whatever the geometry, and is bound by
/// memory: 72 bytes for a tile and a point, see [`PolarizationMap::memory_bytes`].
///
/// # Accuracy
/// Each tile's part is that of a [`Scene`] of this tile alone; adding n tiles rounds by at most 3n units of round-off of the sum over tiles of the magnitudes. The scene of all
/// tiles is more exact where fields of touching tiles cancel; and on their seams, which are edges of tiles alone, only it has a field.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use magsplice_field::{PolarizationMap, Tile};
///
/// let tiles = [-1.0, 1.0].map(|x| Tile::new(DVec3::new(x, 0.0, 0.5), DVec3::ONE, DVec3::X).unwrap());
/// let map = PolarizationMap::new(&tiles, &[DVec3::new(0.0, 0.0, -3.0)]).unwrap();
/// // Opposed tiles: no field straight below the middle but along z.
/// let b = map.flux_density(&[0.12 * DVec3::X, -0.12 * DVec3::X]);
/// assert!(b[0].x.abs() < 1e-15 && b[0].z.abs() > 1e-4);
/// ```
#[derive(Clone, Debug)]
pub struct PolarizationMap {
    tiles: usize,
    points: usize,
    /// Point after point; for each component of B the row of all components of J, tile after tile.
    rows: Vec<f64>,
}

/// Why there is no map.
#[derive(Clone, Debug, PartialEq)]
pub enum PolarizationMapError {
    /// At these points a tile alone has no field, the index of which comes first.
    Points {
        /// The tile.
        tile: usize,
        /// The points.
        errors: PointErrors,
    },
    /// The map would take more bytes than may be allocated.
    TooLarge {
        /// How many, if that can be told.
        bytes: Option<usize>,
    },
}

impl PolarizationMap {
    /// Of tiles, whose own polarizations do not matter, at points.
    ///
    /// # Errors
    /// If a point lies on an edge of a tile, even one it shares with another, or is out of range; if there is not enough memory.
    pub fn new(tiles: &[Tile], points: &[DVec3]) -> Result<PolarizationMap, PolarizationMapError> {
        let row = 3 * tiles.len();
        let count = row.checked_mul(3).and_then(|of_point| of_point.checked_mul(points.len()));
        let too_large = || PolarizationMapError::TooLarge { bytes: count.and_then(|count| count.checked_mul(8)) };
        let mut rows = Vec::new();
        rows.try_reserve_exact(count.ok_or_else(too_large)?).map_err(|_| too_large())?;
        rows.resize(count.unwrap_or_default(), 0.0);
        let mut field = vec![DVec3::ZERO; points.len()];
        for (index, tile) in tiles.iter().enumerate() {
            for axis in 0..3 {
                let alone =
                    Tile::new(tile.position(), tile.size(), DVec3::AXES[axis]).and_then(|t| t.rotated(tile.rotation()));
                let scene = Scene::new(&[alone.expect("a valid tile with another polarization")]);
                scene
                    .field_into(Quantity::FluxDensity, points, &mut field)
                    .map_err(|errors| PolarizationMapError::Points { tile: index, errors })?;
                for (of_point, b) in rows.chunks_exact_mut(3 * row).zip(&field) {
                    for (component, value) in b.to_array().into_iter().enumerate() {
                        of_point[component * row + 3 * index + axis] = value;
                    }
                }
            }
        }
        Ok(PolarizationMap { tiles: tiles.len(), points: points.len(), rows })
    }

    /// B at all points, in tesla, of tiles with these polarizations in their own frames, in tesla.
    ///
    /// # Panics
    /// If there are not as many polarizations as tiles.
    pub fn flux_density(&self, polarizations_t: &[DVec3]) -> Vec<DVec3> {
        let mut field = vec![DVec3::ZERO; self.points];
        self.flux_density_into(polarizations_t, &mut field);
        field
    }

    /// The same, written to `field`, in parallel over points; bit-identical for any number of threads.
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

    /// How B_x, B_y or B_z (0, 1, 2) at a point depends on the components of the polarizations, tile after tile: a row of the matrix, for solvers.
    ///
    /// # Panics
    /// If there is no such point or component.
    pub fn row(&self, point: usize, component: usize) -> &[f64] {
        assert!(point < self.points && component < 3, "a point and a component of the map");
        let length = 3 * self.tiles;
        &self.rows[(3 * point + component) * length..][..length]
    }

    /// The memory it takes.
    pub fn memory_bytes(&self) -> usize {
        self.rows.capacity() * size_of::<f64>()
    }
}

impl fmt::Display for PolarizationMapError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PolarizationMapError::Points { tile, errors } => {
                write!(
                    f,
                    "tile {tile} alone has no field there: {errors}; move the points, or evaluate the scene of all tiles"
                )
            }
            PolarizationMapError::TooLarge { bytes: Some(bytes) } => {
                write!(f, "a map of {bytes} bytes does not fit into memory; take fewer points at a time")
            }
            PolarizationMapError::TooLarge { bytes: None } => f.write_str(
                "a map of more bytes than can be counted does not fit into memory; take fewer points at a time",
            ),
        }
    }
}

impl std::error::Error for PolarizationMapError {}
