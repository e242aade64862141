//! The reason why the polarization of a set of tiles cannot be computed.

use magsplice_magnet::TileFaults;
use magsplice_pair::NotConverged;
use thiserror::Error;

use crate::tolerances::{MAX_CELLS, MOST_BYTES, MOST_CELLS_OF_TENSORS, MOST_PERMEABILITY_OF_TREE};

/// Bytes of a GiB.
const GIBIBYTE: f64 = 1_073_741_824.0;

/// The reason why the polarization of a set of tiles cannot be computed.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum RecoilError {
    /// Level 0 has no cells.
    #[error("level = 0, must be at least 1")]
    NoLevel,
    /// Two tiles share volume, where the polarization would have two values.
    #[error("tiles {first} and {second} overlap")]
    Overlap {
        /// Index of the first tile.
        first: usize,
        /// Index of the second tile.
        second: usize,
    },
    /// The pairs of the cells do not fit in memory.
    #[error("{count} cells, must be at most {MAX_CELLS}; use a lower level of division or fewer tiles")]
    TooManyCells {
        /// Number of cells.
        count: usize,
    },
    /// The near pairs of cells do not fit in memory, because cells are much longer in one direction
    /// than another.
    #[error(
        "the near pairs of {count} cells take {:.1} GiB, must be at most {:.1} GiB; use a lower level of division, or \
         divide long and thin tiles into shorter ones", *bytes as f64 / GIBIBYTE, MOST_BYTES as f64 / GIBIBYTE
    )]
    TooManyNearPairs {
        /// Number of cells.
        count: usize,
        /// Memory of the solution in bytes.
        bytes: usize,
    },
    /// The sums over the cells are not accurate enough for the permeability.
    #[error(
        "recoil permeability = {permeability} with {cells} cells, must be at most {MOST_PERMEABILITY_OF_TREE}; lower it, or \
         use a level with at most {MOST_CELLS_OF_TENSORS} cells"
    )]
    TooPermeable {
        /// Largest permeability.
        permeability: f64,
        /// Number of cells.
        cells: usize,
    },
    /// A tile cannot be divided.
    #[error("tile {tile} cannot be divided into cells: {source}")]
    Cell {
        /// Index of the tile.
        tile: usize,
        /// The reason.
        source: TileFaults,
    },
    /// The mean field of a tile in another tile turned against it does not converge.
    #[error("tiles {receiver} and {source_tile}: {source}")]
    Turned {
        /// Index of the tile over which the field is averaged.
        receiver: usize,
        /// Index of the source of the field.
        source_tile: usize,
        /// The reason.
        source: NotConverged,
    },
    /// The iteration for the polarization does not converge.
    #[error(
        "the solution for the polarization does not converge: the residual is {residual:.1e} of the initial residual; \
         lower the permeability"
    )]
    NotSolved {
        /// Reached residual, relative to the residual at the start.
        residual: f64,
    },
}
