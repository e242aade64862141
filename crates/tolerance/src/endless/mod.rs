//! The splicing pattern without end: the central period of a film, repeated in x and y.

/// Footprints of tiles within one period, and their Fourier transforms.
mod footprint;
/// The field of the endless pattern by its Fourier series.
mod pattern;

pub use pattern::{EndlessPattern, EndlessPatternError};
