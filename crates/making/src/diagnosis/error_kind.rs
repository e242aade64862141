//! The kinds of error that are named.

/// What is wrong with a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "kebab-case"))]
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

    /// The numbers of its components, as in [`TileErrors::all`](magsplice_layout::TileErrors::all):
    /// x, y, z; for the direction of J the turns in the plane of the film and out of it.
    pub fn components(self) -> std::ops::Range<usize> {
        match self {
            ErrorKind::Displacement => 0..3,
            ErrorKind::Turn => 3..6,
            ErrorKind::Strength => 9..10,
            ErrorKind::Direction => 10..12,
        }
    }

    /// The kind that has an error as its component. `None` for errors of size.
    pub fn of_component(error: usize) -> Option<ErrorKind> {
        ErrorKind::ALL.into_iter().find(|kind| kind.components().contains(&error))
    }
}
