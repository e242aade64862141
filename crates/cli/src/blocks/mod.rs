//! Blocks from a CSV file.

/// The columns that hold the properties of a block.
pub(crate) mod columns;
/// Groups of columns, found by their names.
mod finder;
/// The columns of a rotation.
mod rotation;
/// The rows as tiles.
pub(crate) mod rows;
