//! Tables that users bring, each with its columns: points, blocks, readings, tiles.

/// Blocks as tiles.
pub(crate) mod blocks;
/// The columns of a magnetization.
mod magnet_columns;
/// Measured tiles, sorted by the parts of a layout.
pub(crate) mod measured_tiles;
/// Tiles already placed.
pub(crate) mod placed_tiles;
/// The tile of each step of a placement order.
pub(crate) mod placement_order;
/// Points, in batches or all.
pub(crate) mod points;
/// Points for the verbs that compare with the ideal film.
pub(crate) mod points_below_film;
/// Readings of a sensor, alone or with positions or forces.
pub(crate) mod readings;
/// The columns of a rotation.
mod rotation;
