//! Films as they are made: which measured tile goes to which place, and which way round; and which tiles of
//! a film that was made are wrong.
//!
//! * [`CutTile`]: a tile that was cut and measured.
//! * [`Orientation`]: one of the 24 ways in which a cuboid fits an upright box.
//! * [`AssignmentProblem`]: tiles, places, and what each does to the displacement errors.
//! * [`Assignment`]: the tile of each place, found by local searches from many starts.
//! * [`MeasurementErrors`]: errors of the measurements of tiles, and what they leave of the sorting.
//! * [`SortedSampler`]: samples of films whose tiles are cut with spares, measured and sorted.
//! * [`ScanDiagnosis`]: which tiles are weak, turned or displaced, from a scan of the field: a
//!   [`Diagnosis`].
//!
//! Lengths in millimetres, polarizations in tesla. This crate reads no files and prints nothing.
//!
//! # Features
//! `serde` (off by default): `Serialize` for values and results.

// Rules are written as `!(x > limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// Tiles, places, and the tile of each place.
mod assignment;
/// Wrong tiles of a film that was made, from a scan of its field.
mod diagnosis;
/// Local searches for the tile of each place.
mod local_search;
/// Errors of measurements, and what they leave of the sorting.
mod measurement;
/// The ways in which a cuboid fits an upright box.
mod orientation;
/// What tiles do to the displacement errors at each place.
mod problem;
/// Tiles whose strength is chosen.
mod shims;
/// Samples of films whose tiles are sorted.
mod sorted_films;

pub use assignment::{Assignment, AssignmentError, AssignmentSettings, CutTile, PlaceGroup, PlacedTile};
pub use diagnosis::{
    Candidate, Diagnosis, DiagnosisError, DiagnosisSettings, ErrorKind, Estimate, FieldScan, NamedError, ScanDiagnosis,
    SimilarErrors, Untold,
};
pub use measurement::MeasurementErrors;
pub use orientation::Orientation;
pub use problem::AssignmentProblem;
pub use sorted_films::{SortedSampleError, SortedSampler, Sorting};
