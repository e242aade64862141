//! Expectations of a film: what its layout states it must meet, held against what was computed.
//!
//! * [`Outcome`]: one expectation with its value, bound and margin.
//! * [`Baseline`]: a field as it was, and how far another is from it.
//! * [`Clearance`]: how near the tiles come to the working volume.
//!
//! Lengths in millimetres, as in layout files. This crate computes no field, reads no files and prints nothing.
//!
//! ```
//! use magsplice_expect::{Bound, Expectation, Outcome};
//!
//! let outcome = Outcome { expectation: Expectation::Amplitude, value: 0.82, bound: Bound::AtLeast(0.8), place: None };
//! assert!(outcome.is_met() && (outcome.margin() - 0.02).abs() < 1e-15);
//! ```

mod baseline;
mod clearance;
mod cuboid;
mod outcome;

pub use baseline::{Baseline, Difference, OtherPoints};
pub use clearance::Clearance;
pub use outcome::{
    Bound, Expectation, Outcome, Parameter, Place, amplitude, clearance, displacement, field, uniformity,
};
