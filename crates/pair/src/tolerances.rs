//! Tolerances and tuning constants.

/// Default largest error of the mean tensor of two boxes with parallel edges, relative to the norm
/// of the tensor.
pub const TENSOR_ERROR: f64 = 1e-9;

/// Error of the sum over corners, relative to the tensor of a dipole, in units of round-off of the
/// cube of the largest distance of two corners over the volume of the receiver. The 55 pairs of the
/// tests reach at most a fifth of it.
pub(crate) const CORNER_ROUNDINGS: f64 = 0.25;

/// Largest number of halvings of a pair that is neither near nor distant. Each halves a side of one
/// of the two boxes. Boxes of any shape 64 times shorter than their distance are distant.
pub(crate) const MOST_HALVINGS: usize = 36;

/// Largest difference of the directions of edges that count as parallel for the mean tensor. Forces
/// are exact to round-off for differences up to
/// [`SAME_ROTATION`](magsplice_magnet::tolerances::SAME_ROTATION).
pub(crate) const PARALLEL: f64 = 1e-13;

/// Bound of the relative error of the mean tensor by a rule of n nodes, times the 2n-th power of
/// the ratio of the distance of the centres to the largest half side of the box of all differences
/// of points. It is largest for two nodes, 0.7, and 0.03 for five nodes of a small box beside a
/// long box.
pub(crate) const RULE_ERROR: f64 = 1.5;

/// Smallest distance of the centres of two tiles, in half the sum of their diagonals, from which
/// forces and torques are evaluated by five nodes along each axis. For a half length h the error of
/// the rule is about (h / 2D)^10 times the binomial 14 over 4, below 1e-15 from D = 32 h.
pub(crate) const DISTANT_LOAD: f64 = 32.0;

/// Change of the mean tensor of two turned boxes, relative to its norm, below which a part of the
/// receiver is not divided further.
pub const TURNED_ERROR: f64 = 1e-6;

/// Smallest ratio of the distance of the centres of two turned boxes to the sum of their half
/// diagonals for Gauss-Legendre rules of four nodes along each side of both. Their error is below
/// 0.8 (1 / ratio)^8 of the tensor: 5e-7.
pub(crate) const TURNED_DISTANT: f64 = 6.0;

/// Largest number of parts of a receiver turned against the source.
pub(crate) const MOST_PARTS: usize = 100_000;

/// Largest number of panels of the faces of a tile in the field of another tile. A distant pair
/// needs six, a pair whose edges touch a few hundred.
pub(crate) const MOST_PANELS: usize = 4_000;

/// Shift of points on a face of the source outwards, as a fraction of its longest half side. The
/// field changes by at most this fraction times its logarithm.
pub(crate) const OUTSIDE: f64 = 1e-13;
