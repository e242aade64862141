//! Forces on all tiles of a film.

use std::error::Error;
use std::fmt;

use magsplice_magnet::Tile;
use rayon::prelude::*;

use crate::load::Load;
use crate::pair::pair_loads;
use crate::turned::NotConverged;

/// Most tiles: their pairs take 800 MB.
const MOST_TILES: usize = 4_000;

/// Forces and torques of all pairs of tiles.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmForces {
    count: usize,
    /// On the tile `of` by the tile `by`, at `of * count + by`.
    loads: Vec<Load>,
}

/// Why the forces of a film are not known.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FilmForcesError {
    /// More tiles than their pairs can be held in memory.
    TooManyTiles {
        /// Number of tiles.
        count: usize,
        /// Most tiles.
        most: usize,
    },
    /// The force of a pair does not converge.
    Pair {
        /// Index of the one tile.
        first: usize,
        /// Index of the other.
        second: usize,
        /// The reason.
        source: NotConverged,
    },
}

impl FilmForces {
    /// The loads of all pairs. `tolerance` is that of [`pair_loads`], for tiles that are turned against
    /// each other. `progress` is told, from any thread, when the pairs of a tile with later ones are
    /// done.
    ///
    /// # Errors
    /// Too many tiles; turned tiles so close that their force does not converge.
    pub fn new(tiles: &[Tile], tolerance: f64, progress: impl Fn() + Sync) -> Result<FilmForces, FilmForcesError> {
        let count = tiles.len();
        if count > MOST_TILES {
            return Err(FilmForcesError::TooManyTiles { count, most: MOST_TILES });
        }
        let rows: Vec<Vec<[Load; 2]>> =
            (0..count)
                .into_par_iter()
                .map(|first| {
                    let row =
                        (first + 1..count).map(|second| {
                            pair_loads(&tiles[first], &tiles[second], tolerance)
                                .map_err(|source| FilmForcesError::Pair { first, second, source })
                        });
                    let row = row.collect::<Result<Vec<_>, _>>()?;
                    progress();
                    Ok(row)
                })
                .collect::<Result<_, _>>()?;
        let mut loads = vec![Load::ZERO; count * count];
        for (first, row) in rows.into_iter().enumerate() {
            for (second, [on_first, on_second]) in (first + 1..count).zip(row) {
                loads[first * count + second] = on_first;
                loads[second * count + first] = on_second;
            }
        }
        Ok(FilmForces { count, loads })
    }

    /// The loads of all pairs of tiles that are divided into cells, such as tiles whose polarization follows the
    /// field. `owners` holds the index of the tile of each cell. Torques are about the centres of the tiles.
    ///
    /// # Errors
    /// As [`FilmForces::new`], with indices of cells in place of those of tiles.
    ///
    /// # Panics
    /// If there is not one owner for each cell, or an owner is not a tile.
    pub fn of_cells(
        tiles: &[Tile],
        cells: &[Tile],
        owners: &[usize],
        tolerance: f64,
        progress: impl Fn() + Sync,
    ) -> Result<FilmForces, FilmForcesError> {
        assert_eq!(cells.len(), owners.len(), "one owner for each cell");
        let of_pairs = FilmForces::new(cells, tolerance, progress)?;
        let count = tiles.len();
        let mut loads = vec![Load::ZERO; count * count];
        for (of, of_owner) in owners.iter().enumerate() {
            let lever = cells[of].position() - tiles[*of_owner].position();
            for (by, by_owner) in owners.iter().enumerate().filter(|(_, by_owner)| *by_owner != of_owner) {
                let Load { force, torque } = of_pairs.by_one(of, by);
                loads[of_owner * count + by_owner] += Load { force, torque: torque + lever.cross(force) };
            }
        }
        Ok(FilmForces { count, loads })
    }

    /// Number of tiles.
    pub fn tile_count(&self) -> usize {
        self.count
    }

    /// The load on the tile `of` by the tile `by`; zero for the same tile.
    ///
    /// # Panics
    /// If an index is not that of a tile.
    pub fn by_one(&self, of: usize, by: usize) -> Load {
        assert!(by < self.count, "tile {by} of {}", self.count);
        self.loads[of * self.count + by]
    }

    /// The load on the tile `of` by those tiles, one after another.
    ///
    /// # Panics
    /// If an index is not that of a tile.
    pub fn by_some(&self, of: usize, by: impl IntoIterator<Item = usize>) -> Load {
        by.into_iter().fold(Load::ZERO, |sum, by| sum + self.by_one(of, by))
    }

    /// The load on each tile by all others.
    pub fn by_all(&self) -> Vec<Load> {
        (0..self.count).map(|of| self.by_some(of, 0..self.count)).collect()
    }
}

impl fmt::Display for FilmForcesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FilmForcesError::TooManyTiles { count, most } => {
                write!(f, "{count} tiles have more pairs than fit in memory, at most {most} tiles")
            }
            FilmForcesError::Pair { first, second, source } => write!(f, "tiles {first} and {second}: {source}"),
        }
    }
}

impl Error for FilmForcesError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            FilmForcesError::Pair { source, .. } => Some(source),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// Tiles cut in two have the loads of whole ones.
    #[test]
    fn loads_of_cells_add_up_to_those_of_tiles() {
        let tile = |x: f64, j_t: DVec3| Tile::new(DVec3::new(x, 0.1, 0.0), DVec3::new(2.0, 1.0, 1.0), j_t).unwrap();
        let tiles = [tile(0.0, DVec3::new(0.3, 0.2, 1.0)), tile(2.0, DVec3::X), tile(4.5, DVec3::Y)];
        let halves = |tile: &Tile| {
            [-0.5, 0.5].map(|x| Tile::new(tile.position() + x * DVec3::X, DVec3::ONE, tile.polarization_t()).unwrap())
        };
        let cells: Vec<Tile> = tiles.iter().flat_map(halves).collect();
        let divided = FilmForces::of_cells(&tiles, &cells, &[0, 0, 1, 1, 2, 2], 1e-9, || {}).unwrap();
        let whole = FilmForces::new(&tiles, 1e-9, || {}).unwrap();
        assert_eq!(divided.tile_count(), 3);
        for (divided, whole) in divided.by_all().iter().zip(whole.by_all()) {
            assert!((divided.force - whole.force).length() <= 1e-13 * whole.force.length(), "{divided:?} {whole:?}");
            assert!((divided.torque - whole.torque).length() <= 1e-12 * whole.torque.length(), "{divided:?} {whole:?}");
        }
    }
}
