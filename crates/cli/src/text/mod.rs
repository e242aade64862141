//! Results as printed tables, with units.

/// `assign`: the errors of the film, and the plan.
pub(crate) mod assign;
/// `budget`: where the displacement error comes from.
pub(crate) mod budget;
/// `calibrate`.
pub(crate) mod calibrate;
/// `design` and `splice`: a film that was found, and the films of a front.
pub(crate) mod design;
/// `diagnose`: the tiles that are wrong, and what the scan cannot tell.
pub(crate) mod diagnose;
/// The header of a film: its name, tiles, working volume and accuracy.
pub(crate) mod header;
/// Numbers and counts in words.
pub(crate) mod number;
/// What recoil changes in a film.
pub(crate) mod recoil;
/// `resolution`.
pub(crate) mod resolution;
/// Rows of tables.
pub(crate) mod rows;
/// `scan`.
pub(crate) mod scan;
/// `tolerance`: statistics of samples as tables.
pub(crate) mod tolerance;
/// Values in the units in which text shows them.
pub(crate) mod units;
