//! Making of films: the assignment of measured tiles to places, with orientations.
//!
//! * [`MeasuredBox`]: measured tiles, sorted by the parts of a layout; each is a [`CutTile`].
//! * [`CommonTurn`]: a turn that all measured tiles of a part have in common.
//! * [`PartlyPlaced`]: a film with some tiles already placed.
//! * [`Orientation`]: one of the 24 ways in which a cuboid fits an upright box.
//! * [`AssignmentProblem`]: tiles, places, and their effects on the displacement errors.
//! * [`Assignment`]: the tile of each place, found by local searches from many starts.
//! * [`PlanRow`]: a line of the plan by which the tiles of a film are placed.
//! * [`MeasurementErrors`]: errors of the measurements of tiles, and their effect after sorting.
//! * [`SortedSampler`]: samples of films whose tiles are cut with spares, measured and sorted.
//!
//! Lengths in millimetres, polarizations in tesla. This crate reads no files and prints nothing.

// Rules are written as `!(x > limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// Tiles, places, and the tile of each place.
mod assignment;
/// A turn that all measured tiles of a part have in common.
mod common_turn;
/// Local searches for the tile of each place.
mod local_search;
/// A box of measured tiles, sorted by the parts of a layout.
mod measured_box;
/// Errors of measurements, and their effect after sorting.
mod measurement;
/// The ways in which a cuboid fits an upright box.
mod orientation;
/// Films with some tiles already placed.
mod partly_placed;
/// The plan: the place and the orientation of each tile.
mod plan_row;
/// Effects of tiles on the displacement errors at each place.
mod problem;
/// Tiles with adjustable strength.
mod shims;
/// Samples of films with sorted tiles.
mod sorted_films;

pub use assignment::{Assignment, AssignmentError, AssignmentSettings, CutTile, PlaceGroup, PlacedTile, ShortGroup};
pub use common_turn::CommonTurn;
pub use measured_box::{MeasuredBox, MeasuredMagnet, MeasuredTile};
pub use measurement::MeasurementErrors;
pub use orientation::Orientation;
pub use partly_placed::{FixedTile, PartlyPlaced, Placement};
pub use plan_row::PlanRow;
pub use problem::AssignmentProblem;
pub use sorted_films::{SortedSampler, Sorting};
