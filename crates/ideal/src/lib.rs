//! The ideal, sinusoidally magnetized film and the comparison of a field with it.
//!
//! * [`IdealFilm`]: the film that a spliced film approximates (Dai 2024, Eqs. 1 and 2).
//! * [`Comparison`]: RMSE, amplitude and correlation of a field against a reference.
//!
//! # Units
//! Flux density and polarization are in tesla, lengths in any one unit.
//!
//! # Features
//! * `serde` (off by default): `Serialize` for both, `Deserialize` for [`IdealFilm`].

// Rules are written as `!(x < limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// The difference of a field from a reference.
mod comparison;
/// The film of Eqs. 1 and 2.
mod ideal_film;

pub use comparison::{Comparison, ComparisonError};
pub use ideal_film::{IdealFilm, IdealFilmFault, IdealFilmFaults};
