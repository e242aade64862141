//! Results as printed tables, with units.

/// The header of a film: its name, tiles, working volume and accuracy.
pub(crate) mod header;
/// Numbers and counts in words.
pub(crate) mod number;
/// What recoil changes in a film.
pub(crate) mod recoil;
/// Rows of tables.
pub(crate) mod rows;
/// Values in the units in which text shows them.
pub(crate) mod units;
