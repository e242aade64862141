//! Films as they are made: which measured tile goes to which place, and which way round.
//!
//! * [`CutTile`]: a tile that was cut and measured.
//! * [`Orientation`]: one of the 24 ways in which a cuboid fits an upright box.
//! * [`AssignmentProblem`]: tiles, places, and what each does to the displacement errors.
//! * [`Assignment`]: the tile of each place, found by local searches from many starts.
//!
//! Lengths in millimetres, polarizations in tesla. This crate reads no files and prints nothing.
//!
//! # Features
//! `serde` (off by default): `Serialize` for values and results.

// Rules are written as `!(x > limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// Tiles and places, and what they do to the displacement errors.
mod assignment;
/// Local searches for the tile of each place.
mod local_search;
/// The ways in which a cuboid fits an upright box.
mod orientation;

pub use assignment::{
    Assignment, AssignmentError, AssignmentProblem, AssignmentSettings, CutTile, PlaceGroup, PlacedTile,
};
pub use orientation::Orientation;
