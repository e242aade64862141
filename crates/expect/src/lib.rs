//! Expectations of a film: the bounds of its layout, compared with computed values.
//!
//! * [`Outcome`]: one expectation with its value, bound and margin.
//! * [`Baseline`]: a stored field, and the difference of another field from it.
//! * [`Clearance`]: the distance of the tiles from the working volume.
//! * [`keeps_bounds`]: whether a film as made keeps its bounds.
//! * [`NarrowGaps`]: the pairs of tiles that almost touch.
//!
//! Lengths in millimetres, as in layout files. This crate computes no field, reads no files and
//! prints nothing.
//!
//! # Features
//! `serde` (off by default): `Serialize` for outcomes, differences and clearances.
//!
//! # Example
//! ```
//! use magsplice_decouple::Figure;
//! use magsplice_expect::{Bound, Expectation, Outcome};
//!
//! let bound = Bound::AtLeast(0.8);
//! let amplitude = Expectation::Figure(Figure::Amplitude);
//! let outcome = Outcome { expectation: amplitude, value: 0.82, bound, location: None };
//! assert!(outcome.is_met() && (outcome.margin() - 0.02).abs() < 1e-15);
//! ```

/// A stored field, and the difference of another field from it.
mod baseline;
/// The distance of tiles from the working volume.
mod clearance;
/// Bounds of films as made.
mod made;
/// Tiles that almost touch.
mod narrow_gaps;
/// Boxes with their own axes, and the distance between two of them.
mod oriented_box;
/// Expectations, and their outcomes.
mod outcome;

pub use baseline::{Baseline, BaselineDifference, PointsMismatch};
pub use clearance::Clearance;
pub use made::keeps_bounds;
pub use narrow_gaps::NarrowGaps;
pub use outcome::{Bound, Expectation, Location, Outcome};
