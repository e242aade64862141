//! A set of tiles divided into cells.

use glam::DMat3;
use magsplice_magnet::{IronPlanes, Reflection, Tile, overlaps};
use magsplice_pair::{NotConverged, mean_tensor};

use crate::cells::{cell_count, cells};
use crate::error::RecoilError;
use crate::material::RecoilTile;
use crate::tolerances::{MAX_CELLS, NEGLIGIBLE_T};

/// Cells of all tiles, in the order of the tiles.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Division {
    /// Cells with the polarization J_r.
    pub(crate) cells: Vec<Tile>,
    /// Index of the tile of each cell.
    pub(crate) owners: Vec<usize>,
    /// The cells again, in the places of their images in planes of iron.
    pub(crate) images: Vec<(Reflection, Vec<Tile>)>,
}

impl Division {
    /// The cells of all tiles at a level.
    pub(crate) fn new(tiles: &[RecoilTile], iron: &IronPlanes, level: usize) -> Result<Division, RecoilError> {
        if level == 0 {
            return Err(RecoilError::NoLevel);
        }
        let count = tiles.iter().fold(0_usize, |sum, each| sum.saturating_add(cell_count(each.tile.size(), level)));
        if count > MAX_CELLS {
            return Err(RecoilError::TooManyCells { count });
        }
        let bare: Vec<Tile> = tiles.iter().map(|each| each.tile).collect();
        if let Some(overlap) = overlaps(&bare).next() {
            return Err(RecoilError::Overlap { first: overlap.first, second: overlap.second });
        }
        let (mut all, mut owners) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (owner, tile) in bare.iter().enumerate() {
            let parts = cells(tile, level).map_err(|source| RecoilError::Cell { tile: owner, source })?;
            owners.extend(std::iter::repeat_n(owner, parts.len()));
            all.extend(parts);
        }
        let out_of_range = |source| RecoilError::Cell { tile: 0, source };
        let images = iron.reflected_beyond(&all, NEGLIGIBLE_T).map_err(out_of_range)?;
        Ok(Division { cells: all, owners, images })
    }

    /// The cells and their images as cells.
    pub(crate) fn with_images(&self) -> Division {
        let images = self.images.iter().flat_map(|(_, images)| images);
        Division {
            cells: self.cells.iter().chain(images).copied().collect(),
            owners: self.owners.repeat(1 + self.images.len()),
            images: Vec::new(),
        }
    }

    /// The sum over the cell `source` and its images of their mean tensors in the cell `receiver`,
    /// for a polarization of `source`.
    pub(crate) fn mean_tensor(&self, receiver: usize, source: usize) -> Result<DMat3, RecoilError> {
        let of = |cells: &[Tile]| {
            let tensor = mean_tensor(&self.cells[receiver], &cells[source]);
            tensor.map(|tensor| tensor.to_matrix()).map_err(|error| self.turned(receiver, source, error))
        };
        let images = self.images.iter().map(|(reflection, images)| Ok(of(images)? * reflection.of_polarization()));
        images.fold(of(&self.cells), |sum, image| Ok(sum? + image?))
    }

    /// The error for a mean field of the cell `source` in the cell `receiver` that does not
    /// converge.
    pub(crate) fn turned(&self, receiver: usize, source: usize, error: NotConverged) -> RecoilError {
        let [receiver, source_tile] = [receiver, source].map(|cell| self.owners[cell]);
        RecoilError::Turned { receiver, source_tile, source: error }
    }
}
