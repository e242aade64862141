//! Tolerances and tuning constants.

/// Largest error of the mean demagnetizing tensor of two boxes with parallel edges, relative to the norm
/// of the tensor. Errors of the division into cells are larger by orders of magnitude.
pub const TENSOR_ERROR: f64 = 1e-9;

/// Error of the sum over corners, relative to the tensor of a dipole, in units of round-off of the cube of
/// the largest distance of two corners over the volume of the receiver. The 55 pairs of the tests have
/// at most a fifth of it.
pub(crate) const CORNER_ROUNDINGS: f64 = 0.25;

/// Least ratio of the distance of two centres to the largest half side of the box of all differences of
/// points at which the Gaussian rule of five nodes per axis is used. Its error is largest for a small box
/// beside a long one: 6e-10 of the tensor at a ratio of 5.8, in proportion to the tenth power.
pub(crate) const DISTANT: f64 = 6.5;

/// Most halvings of a pair that is neither near nor distant. Each halves a side of one of the two boxes;
/// boxes 64 times shorter than their distance are distant whatever their shape.
pub(crate) const MOST_HALVINGS: usize = 36;

/// Turned edges whose directions differ by no more than this from those of the other box are parallel.
pub(crate) const PARALLEL: f64 = 1e-13;

/// Change of the mean tensor of two turned boxes, relative to its norm, at which a part of the receiver is
/// no more divided.
pub const TURNED_ERROR: f64 = 1e-6;

/// Least ratio of the distance of the centres of two turned boxes to the sum of their half diagonals at which
/// Gauss-Legendre rules of four nodes along each side of both are used. Their error is below
/// 0.8 (1 / ratio)^8 of the tensor: 5e-7.
pub(crate) const TURNED_DISTANT: f64 = 6.0;

/// Most parts of a receiver that is turned against the source.
pub(crate) const MOST_PARTS: usize = 100_000;

/// Most cells of one solution. The tensors of their pairs take 1.2 GB.
pub const MAX_CELLS: usize = 7_000;

/// Residual of the iteration, relative to that at the start, at which it ends. The tensors are known to
/// no more than [`TENSOR_ERROR`].
pub(crate) const RESIDUAL: f64 = 1e-12;

/// Most iterations. For a permeability of 1.2 ten are needed, for [`crate::MAX_PERMEABILITY`] about a
/// thousand.
pub(crate) const MOST_ITERATIONS: usize = 5_000;
