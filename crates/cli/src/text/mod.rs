//! Results as printed tables, with units.

/// `assign`: the errors of the film, and the plan.
pub(crate) mod assign;
/// `bench`: pairs per second for each accuracy.
pub(crate) mod bench;
/// `budget`: where the displacement error comes from.
pub(crate) mod budget;
/// `calibrate`.
pub(crate) mod calibrate;
/// `check`: one line per expectation.
pub(crate) mod check;
/// `decouple` and `compare`: field, comparison with the ideal film, decoupling errors.
pub(crate) mod decouple;
/// `decouple --points`: parameters and errors at points.
pub(crate) mod decouple_points;
/// `design` and `splice`: a film that was found, and the films of a front.
pub(crate) mod design;
/// `diagnose`: the tiles that are wrong, and what the scan cannot tell.
pub(crate) mod diagnose;
/// `forces`: loads on tiles, and an order of laying.
pub(crate) mod forces;
/// The header of a film: its name, tiles, working volume and accuracy.
pub(crate) mod header;
/// Numbers and counts in words.
pub(crate) mod number;
/// `plan`: the methods, their truncation errors and costs.
pub(crate) mod plan;
/// What recoil changes in a film.
pub(crate) mod recoil;
/// `resolution`.
pub(crate) mod resolution;
/// Rows of tables.
pub(crate) mod rows;
/// `scan`.
pub(crate) mod scan;
/// `tiles`: the tiles of a layout and its bill of materials.
pub(crate) mod tiles;
/// `tolerance`: statistics of samples as tables.
pub(crate) mod tolerance;
