//! The reason why the polarization of a set of tiles cannot be computed.

use std::error::Error;
use std::fmt;

use magsplice_magnet::TileFaults;
use magsplice_pair::NotConverged;

use crate::tolerances::{MAX_CELLS, MOST_BYTES, MOST_CELLS_OF_TENSORS, MOST_PERMEABILITY_OF_TREE};

/// Bytes of a GiB.
const GIBIBYTE: f64 = 1_073_741_824.0;

/// The reason why the polarization of a set of tiles cannot be computed.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RecoilError {
    /// Level 0 has no cells.
    NoLevel,
    /// Two tiles share volume, where the polarization would have two values.
    Overlap {
        /// Index of the first tile.
        first: usize,
        /// Index of the second tile.
        second: usize,
    },
    /// The pairs of the cells do not fit in memory.
    TooManyCells {
        /// Number of cells.
        count: usize,
    },
    /// The near pairs of cells do not fit in memory, because cells are much longer in one direction
    /// than another.
    TooManyNearPairs {
        /// Number of cells.
        count: usize,
        /// Memory of the solution in bytes.
        bytes: usize,
    },
    /// The sums over the cells are not accurate enough for the permeability.
    TooPermeable {
        /// Largest permeability.
        permeability: f64,
        /// Number of cells.
        cells: usize,
    },
    /// A tile cannot be divided.
    Cell {
        /// Index of the tile.
        tile: usize,
        /// The reason.
        source: TileFaults,
    },
    /// The mean field of a tile in another tile turned against it does not converge.
    Turned {
        /// Index of the tile over which the field is averaged.
        receiver: usize,
        /// Index of the source of the field.
        source_tile: usize,
        /// The reason.
        source: NotConverged,
    },
    /// The iteration for the polarization does not converge.
    NotSolved {
        /// Reached residual, relative to the residual at the start.
        residual: f64,
    },
}

impl fmt::Display for RecoilError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RecoilError::NoLevel => write!(f, "level = 0, must be at least 1"),
            RecoilError::Overlap { first, second } => write!(f, "tiles {first} and {second} overlap"),
            RecoilError::TooManyCells { count } => {
                write!(f, "{count} cells, must be at most {MAX_CELLS}; use a lower level of division or fewer tiles")
            }
            RecoilError::TooManyNearPairs { count, bytes } => write!(
                f,
                "the near pairs of {count} cells take {:.1} GiB, must be at most {:.1} GiB; use a lower level of \
                 division, or divide long and thin tiles into shorter ones",
                *bytes as f64 / GIBIBYTE,
                MOST_BYTES as f64 / GIBIBYTE
            ),
            RecoilError::TooPermeable { permeability, cells } => write!(
                f,
                "recoil permeability = {permeability} with {cells} cells, must be at most \
                 {MOST_PERMEABILITY_OF_TREE}; lower it, or use a level with at most {MOST_CELLS_OF_TENSORS} cells"
            ),
            RecoilError::Cell { tile, source } => write!(f, "tile {tile} cannot be divided into cells: {source}"),
            RecoilError::Turned { receiver, source_tile, source } => {
                write!(f, "tiles {receiver} and {source_tile}: {source}")
            }
            RecoilError::NotSolved { residual } => write!(
                f,
                "the polarization is not solved: its residual is {residual:.1e} of the initial residual; lower the \
                 permeability"
            ),
        }
    }
}

impl Error for RecoilError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            RecoilError::Cell { source, .. } => Some(source),
            RecoilError::Turned { source, .. } => Some(source),
            _ => None,
        }
    }
}
