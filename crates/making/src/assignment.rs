//! Tiles that were cut and measured, the places of a film, and the tile of each place.

use glam::DVec3;
use magsplice_magnet::TileFaults;
use magsplice_tolerance::SampleError;
use thiserror::Error;

use crate::orientation::Orientation;

/// A tile that was cut and measured, in a frame of its own in which it is meant to be as its part.
#[derive(Clone, Debug, PartialEq)]
pub struct CutTile {
    /// Its name.
    pub name: String,
    /// Measured polarization.
    pub polarization_t: DVec3,
    /// Measured sides; those of the part if they were not measured.
    pub size_mm: DVec3,
}

/// Places that take the same part, and the tiles that were cut as this part.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaceGroup {
    /// Sides of the part.
    pub size_mm: DVec3,
    /// Polarization of the part.
    pub polarization_t: DVec3,
    /// Indices of the places: tiles of the film.
    pub places: Vec<usize>,
    /// The tiles.
    pub tiles: Vec<CutTile>,
}

/// Where a tile goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct PlacedTile {
    /// Index of the place.
    pub place: usize,
    /// Index of the group.
    pub group: usize,
    /// Index of the tile in its group.
    pub tile: usize,
    /// Which way round.
    pub orientation: Orientation,
}

/// The tile of each place.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Assignment {
    /// In the order of the places.
    pub placed: Vec<PlacedTile>,
    /// For each shim tile, the factor by which its polarization differs from that of the film.
    pub shim_factors: Vec<f64>,
    /// Root mean square of the displacement errors over all points and axes, by the exact field, in
    /// mm.
    pub rms_mm: f64,
    /// The same of the tiles in the order in which they were given, each as measured where it fits
    /// so, with shim tiles as they are in the film.
    pub in_order_rms_mm: f64,
    /// The same, by the linear model, at which each start ended, least first. The least that many
    /// of them have in common is probably the best there is.
    pub starts_rms_mm: Vec<f64>,
}

/// How an assignment is searched.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct AssignmentSettings {
    /// Number of starts.
    pub starts: usize,
    /// Times that each start is disturbed and searched anew.
    pub kicks: usize,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Whether tiles may be turned over.
    pub may_turn_over: bool,
}

impl Default for AssignmentSettings {
    fn default() -> AssignmentSettings {
        AssignmentSettings { starts: 16, kicks: 200, seed: 1, may_turn_over: true }
    }
}

/// Why tiles cannot be assigned.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum AssignmentError {
    /// A group has fewer tiles than places.
    #[error("has {tiles} tiles for {places} places")]
    TooFew {
        /// Index of the group.
        group: usize,
        /// Number of its places.
        places: usize,
        /// Number of its tiles.
        tiles: usize,
    },
    /// The part of a group fits one of its places in no orientation that is allowed.
    #[error("its part fits place number {} in no orientation that is allowed", place + 1)]
    NoOrientation {
        /// Index of the place.
        place: usize,
    },
    /// A tile cannot exist.
    #[error("tile {name}: {faults}")]
    Tile {
        /// Its name.
        name: String,
        /// The rules that it breaks.
        faults: TileFaults,
    },
    /// The film has no displacement errors, or a tile of a sample cannot exist.
    #[error("{0}")]
    Film(#[source] SampleError),
    /// There are too many combinations of tiles and places.
    #[error("there are more than {most} combinations of tiles and places")]
    TooLarge {
        /// Number of combinations up to which a problem is solved.
        most: usize,
    },
    /// The effect of a shim tile cannot be separated from the other shim tiles.
    #[error("the effect of shim tile {} cannot be separated from the other shim tiles", tile + 1)]
    Shim {
        /// Its index in the film.
        tile: usize,
    },
}
