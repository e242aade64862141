//! Cut and measured tiles, the places of a film, and the tile of each place.

use glam::DVec3;
use magsplice_magnet::TileFaults;
use magsplice_tolerance::SampleError;
use thiserror::Error;

use crate::orientation::Orientation;

/// A cut and measured tile, in its own frame, in which it nominally equals its part.
#[derive(Clone, Debug, PartialEq)]
pub struct CutTile {
    /// The name.
    pub name: String,
    /// Measured polarization.
    pub polarization_t: DVec3,
    /// Measured sides; the sides of the part if they were not measured.
    pub size_mm: DVec3,
}

/// Places of the same part, and the tiles cut as this part.
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

/// A tile at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct PlacedTile {
    /// Index of the place.
    pub place: usize,
    /// Index of the group.
    pub group: usize,
    /// Index of the tile in its group.
    pub tile: usize,
    /// The orientation.
    pub orientation: Orientation,
}

/// The tile of each place.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Assignment {
    /// Tiles in the order of the places.
    pub placed: Vec<PlacedTile>,
    /// Factor of the polarization of each shim tile, relative to the film.
    pub shim_factors: Vec<f64>,
    /// Root mean square of the displacement errors over all points and axes, by the exact field, in
    /// mm.
    pub rms_mm: f64,
    /// `rms_mm` of the tiles in their given order, in the orientation as measured where it fits,
    /// with the shim tiles of the film.
    pub in_order_rms_mm: f64,
    /// `rms_mm` by the linear model at the end of each start, in ascending order. A smallest value
    /// shared by many starts is probably the optimum.
    pub starts_rms_mm: Vec<f64>,
}

/// Settings of the search for an assignment.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct AssignmentSettings {
    /// Number of starts. `None` for rounds of 16 until four starts agree on the best, at most 256.
    pub starts: Option<usize>,
    /// Number of times that each start is disturbed and searched anew.
    pub kicks: usize,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Whether tiles may be turned over.
    pub may_turn_over: bool,
}

impl Default for AssignmentSettings {
    fn default() -> AssignmentSettings {
        AssignmentSettings { starts: None, kicks: 200, seed: 1, may_turn_over: true }
    }
}

/// A group with fewer tiles than places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShortGroup {
    /// Index of the group.
    pub group: usize,
    /// Number of places.
    pub places: usize,
    /// Number of tiles.
    pub tiles: usize,
}

/// The reason why tiles cannot be assigned.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum AssignmentError {
    /// Groups have fewer tiles than places. All of them.
    #[error(
        "{}",
        .0.iter()
            .map(|ShortGroup { group, places, tiles }| format!("group {group} has {tiles} tiles for {places} places"))
            .collect::<Vec<_>>()
            .join("; ")
    )]
    TooFew(Vec<ShortGroup>),
    /// The part of a group fits one of its places in no allowed orientation.
    #[error("its part does not fit place number {} in any allowed orientation", place + 1)]
    NoOrientation {
        /// Index of the place.
        place: usize,
    },
    /// A tile is invalid.
    #[error("tile {name}: {faults}")]
    Tile {
        /// The name.
        name: String,
        /// The rules that it breaks.
        faults: TileFaults,
    },
    /// The displacement errors of the film cannot be computed, or a tile of a sample is invalid.
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
