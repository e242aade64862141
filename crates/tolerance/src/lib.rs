//! Films as made: the decoupling errors of films whose tiles are misplaced, turned, cut to wrong
//! sizes, and weaker or magnetized in another direction than ordered, in stray fields, read by real
//! sensors.
//!
//! * [`RealFilm`]: a film with random errors, and its samples.
//! * [`FilmSample`]: one sample, with the pose of the film, its surroundings and its sensor.
//! * [`Sampler`]: sample number i, which depends on a seed and on i alone, and its errors.
//! * [`FirstOrder`]: errors to first order, by exact derivatives: shares of causes and tiles
//!   without samples, and a check of their validity.
//! * [`TileChanges`]: the errors to first order by J and the sides of tiles.
//! * [`TileResponse`]: the exact derivatives of the field of one tile by each of its errors.
//! * [`LowRank`]: columns as combinations of a few orthonormal ones.
//! * [`EndlessPattern`]: the splicing pattern of a film without end, by its Fourier series.
//! * [`Budget`]: displacement errors by origin: pattern, end of the film, and each cause.
//! * [`Statistics`]: mean and percentiles of many samples, with confidence intervals.
//!
//! The errors themselves, such as [`magsplice_layout::FilmTolerance`], are values of a layout:
//! lengths in millimetres, flux densities in tesla, angles in radians. This crate reads no files
//! and prints nothing.

// Rules are written as `!(x > limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// The error budget.
mod budget;
/// Errors drawn at random, each by its place in a random stream.
mod draws;
/// The splicing pattern without end.
mod endless;
/// The figures of a film over its working volume.
mod evaluation_grid;
/// One sample with its surroundings.
mod film_sample;
/// Errors to first order.
mod first_order;
/// The images of a film in flat iron.
mod images;
/// Columns as combinations of a few orthonormal ones.
mod low_rank;
/// The errors of one cause alone.
mod one_cause;
/// Quantiles, means and variances of distributions.
mod quantile;
/// Readings of the sensor.
mod readings;
/// Samples of a film with errors of its tiles.
mod real_film;
/// The errors of many samples.
mod sampler;
/// Mean, percentiles and shares of samples, with confidence intervals.
mod statistics;
/// The polarization of tiles that recoil weakens and turns.
mod weakening;

pub use budget::{AxisBudget, Budget, Halving};
pub use endless::{EndlessPattern, EndlessPatternError};
pub use evaluation_grid::{EvaluationGrid, SampleError};
pub use film_sample::FilmSample;
pub use first_order::{
    AxisCheck, AxisErrors, Cause, Contribution, ErrorSource, ErrorTerm, FirstOrder, FirstOrderCheck, SensorError,
    Share, TileChanges, TileResponse,
};
pub use low_rank::LowRank;
pub use quantile::{mean_square, nodes};
pub use real_film::{RealFilm, direction_normal};
pub use sampler::{Sampler, statistics};
pub use statistics::{Estimate, Statistics, probability_of_at_least, share};
pub use weakening::Weakening;
