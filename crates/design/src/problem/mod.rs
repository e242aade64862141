//! The objective, its variables and its rules.

/// Affine expressions of the variables.
pub(crate) mod affine;
/// A layout prepared for design.
pub(crate) mod design_problem;
/// Errors of films as made, as mean squares.
mod error_model;
/// The expected square that errors of films add, with derivatives.
mod expected_squares;
/// How the field changes with errors that several tiles share.
mod joint_response;
/// The least-squares problem, and films that are compared in it.
pub(crate) mod least_squares;
/// Flat iron near the film: the reading of its images.
mod near_iron;
/// Residuals of each goal, with derivatives.
pub(crate) mod objective;
/// Tiles as functions of the variables.
pub(crate) mod pattern;
/// The reading below a film.
pub(crate) mod reading;
/// Tests of the expected square of errors.
#[cfg(test)]
mod robust_tests;
/// Linear rules: sides, outline, thickness, strength, distances.
pub(crate) mod rules;
/// Points of the design grid, and the field there with derivatives.
pub(crate) mod sampling;
/// Symmetry operations and orbits of tiles.
pub(crate) mod symmetry;
/// How the field of a tile changes with its errors.
mod tile_response;
