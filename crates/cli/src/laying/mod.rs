//! Laying a film from a box of measured tiles: the tiles, those that lie already, and the plan.

/// A film with the tile of each place: the result of `assign`.
pub(crate) mod assigned_film;
/// The plan as a file.
pub(crate) mod laying_plan;
/// The columns of measured tiles.
mod measured_columns;
/// Measured tiles from a CSV file, sorted by the parts of a layout.
pub(crate) mod measured_tiles;
/// Tiles that lie already, from a CSV file.
pub(crate) mod placed_tiles;
