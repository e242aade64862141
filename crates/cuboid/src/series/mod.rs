//! The multipole series of one cuboid (docs/physics.md, section 2.7).

/// Coefficients of the series of a shape.
pub mod coefficients;
/// Evaluation of the series in vectors.
pub mod multipole;
