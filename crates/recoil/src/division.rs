//! A set of tiles divided into cells.

use magsplice_magnet::{Tile, overlaps};
use magsplice_pair::NotConverged;

use crate::cells::{cell_count, cells};
use crate::error::RecoilError;
use crate::material::RecoilTile;
use crate::tolerances::MAX_CELLS;

/// Cells of all tiles, in the order of the tiles.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Division {
    /// Cells with the polarization J_r.
    pub(crate) cells: Vec<Tile>,
    /// Index of the tile of each cell.
    pub(crate) owners: Vec<usize>,
}

impl Division {
    /// The cells of all tiles at a level.
    pub(crate) fn new(tiles: &[RecoilTile], level: usize) -> Result<Division, RecoilError> {
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
        let mut division = Division { cells: Vec::with_capacity(count), owners: Vec::with_capacity(count) };
        for (owner, tile) in bare.iter().enumerate() {
            let parts = cells(tile, level).map_err(|source| RecoilError::Cell { tile: owner, source })?;
            division.owners.extend(std::iter::repeat_n(owner, parts.len()));
            division.cells.extend(parts);
        }
        Ok(division)
    }

    /// The error for a mean field of the cell `source` in the cell `receiver` that does not
    /// converge.
    pub(crate) fn turned(&self, receiver: usize, source: usize, error: NotConverged) -> RecoilError {
        let [receiver, source_tile] = [receiver, source].map(|cell| self.owners[cell]);
        RecoilError::Turned { receiver, source_tile, source: error }
    }
}
