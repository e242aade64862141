//! Candidate errors: tiles with their possible faults.

use magsplice_magnet::TileError;

/// The fault of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum ErrorKind {
    /// |J| is smaller or larger than ordered.
    Strength,
    /// The tile is turned about its centre, and J with it.
    Turn,
    /// J has another direction within the tile.
    Direction,
    /// The tile is displaced.
    Displacement,
}

impl ErrorKind {
    /// Every kind.
    pub const ALL: [ErrorKind; 4] =
        [ErrorKind::Strength, ErrorKind::Turn, ErrorKind::Direction, ErrorKind::Displacement];

    /// One word for the kind.
    pub const fn name(self) -> &'static str {
        match self {
            ErrorKind::Strength => "strength",
            ErrorKind::Turn => "turn",
            ErrorKind::Direction => "direction",
            ErrorKind::Displacement => "displacement",
        }
    }

    /// The components: x, y, z; for the direction of J the turns in the plane of the film and out
    /// of it.
    pub fn components(self) -> impl Iterator<Item = TileError> {
        TileError::ALL.into_iter().filter(move |error| ErrorKind::of_component(*error) == Some(self))
    }

    /// The kind with this error as a component. `None` for errors of size.
    pub fn of_component(error: TileError) -> Option<ErrorKind> {
        match error {
            TileError::Position(_) => Some(ErrorKind::Displacement),
            TileError::Rotation(_) => Some(ErrorKind::Turn),
            TileError::Size(_) => None,
            TileError::Strength => Some(ErrorKind::Strength),
            TileError::Direction(_) => Some(ErrorKind::Direction),
        }
    }
}

/// A tile with a possible fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub struct Candidate {
    /// Index of the tile.
    pub tile: usize,
    /// The fault.
    pub kind: ErrorKind,
}
