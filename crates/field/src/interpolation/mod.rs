//! Interpolation of the field in boxes without tiles (docs/physics.md, section 5.1).

/// Cells of a box, each with a harmonic potential.
mod cells;
/// Chebyshev polynomials and nodes.
mod chebyshev;
/// The Chebyshev fit of the field in a box, with its error.
pub(crate) mod fit;
/// A box prepared for repeated look-ups.
pub(crate) mod fitted_field;
/// The field in a cell as the gradient of a harmonic polynomial.
pub(crate) mod harmonic_potential;
/// Look-ups of many points, sorted by cell.
mod look_up;
/// Mirror symmetry of scenes about the middle of a box.
mod mirror;
/// A grid divided into boxes with a fit.
pub(crate) mod on_grid;
/// Whether a fit can be faster than the exact field.
pub(crate) mod outlook;
/// Upper bound of the truncation error of a fit.
mod truncation_bound;
/// Weighted sums of rows, in vectors.
mod weighted_sums;
