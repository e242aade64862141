//! Real films: the decoupling errors of films whose tiles are misplaced, turned, cut to wrong sizes,
//! and weaker or magnetized in another direction than ordered.
//!
//! * [`TileErrors`]: standard deviations of the errors of one tile.
//! * [`RealFilm`]: sample number i of a film, which depends on a seed and on i alone.
//! * [`FilmErrors`]: the errors of decoupling and displacement of one sample.
//! * [`Sampled`]: the errors of many samples, with their mean, percentiles and confidence intervals.
//!
//! Flux densities in tesla, angles in radians; lengths in any one unit. This crate reads no files
//! and prints nothing.
//!
//! # Features
//! `serde` (off by default): `Serialize` for values and results, `Deserialize` for values.

/// Independent normal deviates by sample, tile and error.
mod deviates;
/// The errors of decoupling and displacement of a film.
mod film_errors;
/// Samples of a film with errors of its tiles.
mod real_film;
/// The errors of many samples.
mod sampled;
/// Mean and percentiles of samples, with confidence intervals.
mod statistics;
/// Standard deviations of the errors of one tile.
mod tile_errors;

pub use film_errors::{EvaluationGrid, FilmErrors, SampleError};
pub use real_film::RealFilm;
pub use sampled::Sampled;
pub use statistics::{Estimate, Statistics};
pub use tile_errors::TileErrors;
