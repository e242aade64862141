//! Forces on all tiles of a film.

use magsplice_magnet::{Tile, TileImages};
use magsplice_pair::{Load, NotConverged, load_in_f64, pair_loads};
use rayon::prelude::*;
use thiserror::Error;

/// Distance of two tiles, in sums of half their diagonals, from which on mean polarizations replace
/// their cells. In twelve tiles of a designed film with a permeability of 1.2 this changes the
/// force of each pair by at most 1.3e-4 of the largest force on a tile.
const FAR: f64 = 1.5;

/// Forces and torques of all pairs of tiles.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmForces {
    count: usize,
    /// The load on the tile `of` by the tile `by`, at `of * count + by`.
    loads: Vec<Load>,
}

/// The reason why the forces of a film cannot be computed.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum FilmForcesError {
    /// The pairs of the tiles exceed the memory.
    #[error("{count} tiles, must be at most {most} for their pairs to fit in memory")]
    TooManyTiles {
        /// Number of tiles.
        count: usize,
        /// Largest number of tiles.
        most: usize,
    },
    /// The force of a pair does not converge.
    #[error("tiles {first} and {second}: {source}")]
    Pair {
        /// Index of the first tile.
        first: usize,
        /// Index of the second tile.
        second: usize,
        /// The reason.
        source: NotConverged,
    },
}

/// A tile with the mean polarization of its cells, and its cells.
struct DividedTile {
    mean: Tile,
    cells: Vec<Tile>,
}

impl DividedTile {
    /// # Panics
    /// If the numbers of cells and owners differ, or an owner is not a tile.
    fn all(means: &[Tile], cells: &[Tile], owners: &[usize]) -> Vec<DividedTile> {
        assert_eq!(cells.len(), owners.len(), "one owner for each cell");
        let mut divided: Vec<DividedTile> =
            means.iter().map(|mean| DividedTile { mean: *mean, cells: Vec::new() }).collect();
        owners.iter().zip(cells).for_each(|(owner, cell)| divided[*owner].cells.push(*cell));
        divided
    }

    /// The load on this tile, by the means if they are far apart.
    fn load_by(&self, other: &DividedTile, tolerance: f64) -> Result<Load, NotConverged> {
        let (mean, by) = (&self.mean, &other.mean);
        let offset = mean.position() - by.position();
        if offset.length() > FAR * 0.5 * (mean.size().length() + by.size().length()) {
            return load_in_f64(mean, by, tolerance);
        }
        let mut sum = Load::ZERO;
        for of in &self.cells {
            let lever = of.position() - mean.position();
            for by in &other.cells {
                let Load { force, torque } = load_in_f64(of, by, tolerance)?;
                sum += Load { force, torque: torque + lever.cross(force) };
            }
        }
        Ok(sum)
    }
}

impl FilmForces {
    /// Largest number of tiles; their pairs take 800 MB, twice while they are sorted.
    pub const MOST_TILES: usize = 4_000;

    /// The loads of all pairs. `tolerance` is the tolerance of [`pair_loads`] for tiles turned
    /// against each other. `progress` is called, from any thread, when the pairs of a tile with
    /// later tiles begin. A panic of `progress` ends the work and reaches the caller.
    ///
    /// # Errors
    /// If there are too many tiles, or turned tiles are so close that their force does not
    /// converge.
    pub fn new(tiles: &[Tile], tolerance: f64, progress: impl Fn() + Sync) -> Result<FilmForces, FilmForcesError> {
        FilmForces::of_pairs(tiles.len(), progress, |first, second| {
            pair_loads(&tiles[first], &tiles[second], tolerance)
        })
    }

    /// The loads of all pairs of tiles divided into cells, such as tiles whose polarization follows
    /// the field. `owners` holds the index of the tile of each cell, in ascending order. Torques
    /// are about the centres of the tiles. `progress` is called as by [`FilmForces::new`].
    ///
    /// `tiles` have the mean polarization of their cells. It replaces the cells for tiles farther
    /// apart than one and a half times the sum of half their diagonals.
    ///
    /// Pairs of cells with parallel edges are evaluated in `f64`. The error of the force of a pair
    /// of cells was below 1e-11 J J' D^2 / (4 pi mu0) for random pairs, where D is the largest
    /// distance of two corners. The error of the division is larger.
    ///
    /// # Errors
    /// The errors of [`FilmForces::new`].
    ///
    /// # Panics
    /// If the numbers of cells and owners differ, or an owner is not a tile.
    pub fn of_cells(
        tiles: &[Tile],
        cells: &[Tile],
        owners: &[usize],
        tolerance: f64,
        progress: impl Fn() + Sync,
    ) -> Result<FilmForces, FilmForcesError> {
        let divided = DividedTile::all(tiles, cells, owners);
        FilmForces::of_pairs(tiles.len(), progress, |first, second| {
            let on_first = divided[first].load_by(&divided[second], tolerance)?;
            Ok([on_first, on_first.reaction(tiles[first].position() - tiles[second].position())])
        })
    }

    /// The same loads with those by images of the tiles in flat iron, such as
    /// [`TileImages`](magsplice_magnet::TileImages): each acts where its tile does, on this tile
    /// too. `owners` holds the index of the tile of each image. The iron takes up the sum of all
    /// forces. `progress` is called, from any thread, for each tile.
    ///
    /// # Errors
    /// The errors of [`FilmForces::new`].
    ///
    /// # Panics
    /// If there are not as many tiles as loads, or not as many owners as images.
    pub fn with_images(
        mut self,
        tiles: &[Tile],
        images: &[Tile],
        owners: &[usize],
        tolerance: f64,
        progress: impl Fn() + Sync,
    ) -> Result<FilmForces, FilmForcesError> {
        assert_eq!((tiles.len(), owners.len()), (self.count, images.len()), "a load for each tile, an owner each");
        let add = |(first, loads): (usize, &mut [Load])| {
            progress();
            for (image, &second) in images.iter().zip(owners) {
                let of_pair = pair_loads(&tiles[first], image, tolerance);
                loads[second] += of_pair.map_err(|source| FilmForcesError::Pair { first, second, source })?[0];
            }
            Ok(())
        };
        self.loads.par_chunks_mut(self.count.max(1)).enumerate().map(add).collect::<Result<(), _>>()?;
        Ok(self)
    }

    /// [`FilmForces::with_images`] for tiles divided into cells, as in [`FilmForces::of_cells`],
    /// with the images of both by the same reflections.
    ///
    /// # Errors
    /// The errors of [`FilmForces::new`].
    ///
    /// # Panics
    /// If there are not as many tiles as loads, or as many cells as owners.
    pub fn with_images_of_cells(
        mut self,
        [tiles, cells]: [&[Tile]; 2],
        owners: &[usize],
        images: [&TileImages; 2],
        tolerance: f64,
        progress: impl Fn() + Sync,
    ) -> Result<FilmForces, FilmForcesError> {
        assert_eq!(tiles.len(), self.count, "a load for each tile");
        let divided = DividedTile::all(tiles, cells, owners);
        // Series of both may end one reflection apart, where images are negligible.
        let [images, images_of_cells] = images.map(|of| &of.tiles[..]);
        let reflections = images.chunks(tiles.len().max(1)).zip(images_of_cells.chunks(cells.len().max(1)));
        let reflected: Vec<Vec<DividedTile>> =
            reflections.map(|(images, cells)| DividedTile::all(images, cells, owners)).collect();
        let add = |(first, loads): (usize, &mut [Load])| {
            progress();
            for (second, image) in reflected.iter().flat_map(|images| images.iter().enumerate()) {
                let load = divided[first].load_by(image, tolerance);
                loads[second] += load.map_err(|source| FilmForcesError::Pair { first, second, source })?;
            }
            Ok(())
        };
        self.loads.par_chunks_mut(self.count.max(1)).enumerate().map(add).collect::<Result<(), _>>()?;
        Ok(self)
    }

    /// The loads of `count` tiles from the loads of each pair.
    fn of_pairs(
        count: usize,
        progress: impl Fn() + Sync,
        loads_of: impl Fn(usize, usize) -> Result<[Load; 2], NotConverged> + Sync,
    ) -> Result<FilmForces, FilmForcesError> {
        if count > FilmForces::MOST_TILES {
            return Err(FilmForcesError::TooManyTiles { count, most: FilmForces::MOST_TILES });
        }
        let of_first = |first: usize| {
            progress();
            let of_second =
                |second| loads_of(first, second).map_err(|source| FilmForcesError::Pair { first, second, source });
            (first + 1..count).map(of_second).collect::<Result<Vec<[Load; 2]>, _>>()
        };
        let rows: Vec<Vec<[Load; 2]>> = (0..count).into_par_iter().map(of_first).collect::<Result<_, _>>()?;
        let mut loads = vec![Load::ZERO; count * count];
        for (first, row) in rows.into_iter().enumerate() {
            for (second, [on_first, on_second]) in (first + 1..count).zip(row) {
                loads[first * count + second] = on_first;
                loads[second * count + first] = on_second;
            }
        }
        Ok(FilmForces { count, loads })
    }

    /// Number of tiles.
    pub fn tile_count(&self) -> usize {
        self.count
    }

    /// The load on the tile `of` by the tile `by`, and by its images; by the same tile, that by its
    /// own images.
    ///
    /// # Panics
    /// If an index is not the index of a tile.
    pub fn by_one(&self, of: usize, by: usize) -> Load {
        assert!(by < self.count, "tile {by} of {}", self.count);
        self.loads[of * self.count + by]
    }

    /// The load on the tile `of` by the tiles `by`, added one after another.
    ///
    /// # Panics
    /// If an index is not the index of a tile.
    pub fn by_some(&self, of: usize, by: impl IntoIterator<Item = usize>) -> Load {
        by.into_iter().fold(Load::ZERO, |sum, by| sum + self.by_one(of, by))
    }

    /// The load on each tile by all others.
    pub fn by_all(&self) -> Vec<Load> {
        (0..self.count).map(|of| self.by_some(of, 0..self.count)).collect()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// Tiles cut in two have the loads of whole tiles.
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

    /// Cells count up to one and a half times the sum of half the diagonals. Beyond it the mean
    /// polarization of each tile replaces them. The halves have opposite polarizations across the
    /// mean, which the tile lacks.
    #[test]
    fn distant_tiles_act_with_their_mean_polarization() {
        let size = DVec3::new(2.0, 1.0, 1.0);
        let limit = FAR * size.length();
        let halves_t = [DVec3::new(0.0, 0.8, 1.0), DVec3::new(0.0, -0.8, 1.0)];
        for (distance, is_near) in [(0.99 * limit, true), (1.01 * limit, false)] {
            let tiles = [0.0, distance].map(|x| Tile::new(DVec3::X * x, size, DVec3::Z).unwrap());
            let halves = |tile: &Tile| {
                [0, 1].map(|half| {
                    let offset = DVec3::X * (half as f64 - 0.5);
                    Tile::new(tile.position() + offset, DVec3::ONE, halves_t[half]).unwrap()
                })
            };
            let cells: Vec<Tile> = tiles.iter().flat_map(halves).collect();
            let found = FilmForces::of_cells(&tiles, &cells, &[0, 0, 1, 1], 1e-9, || {}).unwrap().by_one(0, 1);
            let of_tiles = load_in_f64(&tiles[0], &tiles[1], 1e-9).unwrap();
            let pairs = [(0, 2), (0, 3), (1, 2), (1, 3)];
            let of_cells: DVec3 =
                pairs.iter().map(|&(of, by)| load_in_f64(&cells[of], &cells[by], 1e-9).unwrap().force).sum();
            // The halves change the force by more than a tenth.
            assert!((of_cells - of_tiles.force).length() > 0.1 * of_tiles.force.length(), "{of_cells} {of_tiles:?}");
            let expected = if is_near { of_cells } else { of_tiles.force };
            assert!((found.force - expected).length() < 1e-12 * expected.length(), "{distance}: {found:?} {expected}");
        }
    }

    /// The first pair of the largest film is evaluated, and one tile more is refused before.
    #[test]
    fn films_with_more_tiles_than_the_most_are_refused() {
        let not_converged = NotConverged { integral: magsplice_pair::PairIntegral::Load, reached: 1.0, tolerance: 0.0 };
        let refused = |count| FilmForces::of_pairs(count, || (), |_, _| Err(not_converged)).unwrap_err();
        let most = FilmForces::MOST_TILES;
        assert!(matches!(refused(most), FilmForcesError::Pair { .. }));
        assert!(matches!(refused(most + 1), FilmForcesError::TooManyTiles { count, .. } if count == most + 1));
    }
}
