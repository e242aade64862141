//! Tolerances and tuning constants.

/// Largest error of the mean tensor of two boxes with parallel edges, relative to the norm of the
/// tensor, unless another one is asked for.
pub const TENSOR_ERROR: f64 = 1e-9;

/// Error of the sum over corners, relative to the tensor of a dipole, in units of round-off of the
/// cube of the largest distance of two corners over the volume of the receiver. The 55 pairs of the
/// tests have at most a fifth of it.
pub(crate) const CORNER_ROUNDINGS: f64 = 0.25;

/// Most halvings of a pair that is neither near nor distant. Each halves a side of one of the two
/// boxes; boxes 64 times shorter than their distance are distant whatever their shape.
pub(crate) const MOST_HALVINGS: usize = 36;

/// Edges whose directions differ by no more than this are parallel for the mean tensor. Forces are
/// right to round-off for directions that differ by no more than
/// [`SAME_ROTATION`](magsplice_magnet::tolerances::SAME_ROTATION).
pub(crate) const PARALLEL: f64 = 1e-13;

/// The error of the mean tensor by a rule of n nodes, relative to it, is below this over the 2n-th
/// power of the ratio of the distance of the centres to the largest half side of the box of all
/// differences of points. It is largest for two nodes: 0.7, and 0.03 for five of a small box beside
/// a long one.
pub(crate) const RULE_ERROR: f64 = 1.5;

/// Least distance of the centres of two tiles, in half the sum of their diagonals, from which on
/// forces and torques are evaluated by five nodes along each axis. On half a length h the rule is
/// off by about (h / 2D)^10 times the binomial 14 over 4, below 1e-15 from D = 32 h.
pub(crate) const DISTANT_LOAD: f64 = 32.0;

/// Change of the mean tensor of two turned boxes, relative to its norm, at which a part of the
/// receiver is no more divided.
pub const TURNED_ERROR: f64 = 1e-6;

/// Least ratio of the distance of the centres of two turned boxes to the sum of their half
/// diagonals at which Gauss-Legendre rules of four nodes along each side of both are used. Their
/// error is below 0.8 (1 / ratio)^8 of the tensor: 5e-7.
pub(crate) const TURNED_DISTANT: f64 = 6.0;

/// Most parts of a receiver that is turned against the source.
pub(crate) const MOST_PARTS: usize = 100_000;

/// Most panels of the faces of a tile in the field of another one. A pair at a distance needs six,
/// one whose edges touch a few hundred.
pub(crate) const MOST_PANELS: usize = 4_000;

/// Points on a face of the source are moved outwards by this fraction of its longest half side. The
/// field changes by no more than the logarithm of it times itself.
pub(crate) const OUTSIDE: f64 = 1e-13;
