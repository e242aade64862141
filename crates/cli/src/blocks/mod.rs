//! Blocks from a CSV file.

/// The columns that hold the properties of a block.
pub(crate) mod columns;
/// The columns of a rotation.
mod rotation;
/// The rows as tiles.
pub(crate) mod rows;
