//! Films as they are made: which measured tile goes to which place, and which way round.
//!
//! * [`MeasuredBox`]: measured tiles, sorted by the parts of a layout; each is a [`CutTile`].
//! * [`PartlyPlaced`]: a film of which some tiles are placed already.
//! * [`Orientation`]: one of the 24 ways in which a cuboid fits an upright box.
//! * [`AssignmentProblem`]: tiles, places, and what each does to the displacement errors.
//! * [`Assignment`]: the tile of each place, found by local searches from many starts.
//! * [`PlanRow`]: a line of the plan by which the tiles of a film are placed.
//! * [`MeasurementErrors`]: errors of the measurements of tiles, and what they leave of the
//!   sorting.
//! * [`SortedSampler`]: samples of films whose tiles are cut with spares, measured and sorted.
//!
//! Lengths in millimetres, polarizations in tesla. This crate reads no files and prints nothing.

// Rules are written as `!(x > limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// Tiles, places, and the tile of each place.
mod assignment;
/// Local searches for the tile of each place.
mod local_search;
/// A box of measured tiles, sorted by the parts of a layout.
mod measured_box;
/// Errors of measurements, and what they leave of the sorting.
mod measurement;
/// The ways in which a cuboid fits an upright box.
mod orientation;
/// Films of which some tiles lie already.
mod partly_placed;
/// The plan: which tile goes where, and which way round.
mod plan_row;
/// What tiles do to the displacement errors at each place.
mod problem;
/// Tiles whose strength is chosen.
mod shims;
/// Samples of films whose tiles are sorted.
mod sorted_films;

pub use assignment::{Assignment, AssignmentError, AssignmentSettings, CutTile, PlaceGroup, PlacedTile};
pub use measured_box::{MeasuredBox, MeasuredMagnet, MeasuredTile};
pub use measurement::MeasurementErrors;
pub use orientation::Orientation;
pub use partly_placed::{Laying, LyingTile, PartlyPlaced};
pub use plan_row::PlanRow;
pub use problem::AssignmentProblem;
pub use sorted_films::{SortedSampler, Sorting};
