//! Every tolerance and tuning constant of this crate, with what it trades.

/// Beyond this value of tanh the logarithm of an edge is taken from products instead of from `ln_1p`.
///
/// Both forms are free of cancellation everywhere the products stay in range; `ln_1p` keeps relative accuracy where the
/// element is small, the products where it diverges. The switch only has to be away from 0 and 1.
pub(crate) const ARTANH_TO_PRODUCT: f64 = 0.5;

/// A point closer to a face than this fraction of the smallest size in the scene counts as that far from it, on its own side;
/// one exactly on the face on the side of +x, +y, +z of the tile's frame: the half-open rule lo <= p < hi.
///
/// It vanishes in every sum but those that are the offset itself, and ln(2^-240) = -166 costs hardly a digit where the logarithms of
/// touching tiles cancel.
pub(crate) const FACE_NUDGE: f64 = power_of_two(-120);

/// The nudge is never less than this fraction of a tile's own largest size, so that its square stays a normal number.
/// Seams between tiles that differ by more than 2^200 in size are beyond what is supported.
pub(crate) const SMALLEST_NUDGE: f64 = power_of_two(-300);

/// A tile whose largest size is below this fraction of the distance adds nothing: its field is below
/// 2^-1200 of J, and with J at most [`MAX_POLARIZATION_T`] rounds to zero.
pub(crate) const VANISHING_SIZE: f64 = power_of_two(-400);

/// Faces closer than this many units of round-off of their coordinates are one face. Tiles that reach into each other by no more than
/// half of it do not overlap: what is not reported as overlap must be joined, so that no sliver has two owners.
///
/// `position - size / 2` is two roundings away from the number the user meant, and that may be computed itself.
pub(crate) const SEAM_ROUNDINGS: f64 = 8.0;

/// The same where a rotation is involved: positions have been through it and back.
pub(crate) const ROTATED_SEAM_ROUNDINGS: f64 = 32.0;

/// Along a rotated axis, a point closer to a face than this many units of round-off of its distance from the axis's origin
/// lies on the face: its coordinate is no better known.
pub(crate) const POINT_ROUNDINGS: f64 = 4.0;

/// Points are put onto faces only of tiles at least this many times thicker than the round-off of the point.
pub(crate) const RESOLVED_THICKNESS: f64 = 16.0;

/// Half the distance of neighbouring numbers at 1.
pub(crate) const UNIT_ROUNDOFF: f64 = 0.5 * f64::EPSILON;

/// Two directions whose components differ by no more than this are one direction.
///
/// A quaternion built from an axis and an angle in degrees is off by about four units of round-off.
pub(crate) const SAME_ROTATION: f64 = 16.0 * f64::EPSILON;

/// Directions are looked up in cells of this width; any width far above `SAME_ROTATION` does.
pub(crate) const DIRECTION_CELL: f64 = 1e-9;

/// At a shared edge the logarithmic terms of several tiles cancel to this fraction, or the field is unbounded there.
///
/// What is left of a cancelled term is multiplied by ln(2^-240) = -166, so 1e-14 stays at round-off of the polarization.
pub(crate) const EDGE_CANCELLATION: f64 = 1e-14;

/// Edges whose unit directions differ by no more than this run together. Far above round-off, far below any angle meant.
pub(crate) const SAME_RAY: f64 = 1e-9;

/// Largest length (coordinate or size) the kernel accepts. Differences of two such lengths stay finite.
pub const MAX_LENGTH: f64 = power_of_two(1000);

/// Smallest size the kernel accepts.
pub const MIN_SIZE: f64 = power_of_two(-900);

/// Smallest ratio of the shortest to the longest side of a tile the kernel accepts, 8e-31. Products of two sides and the
/// distance stay normal numbers.
pub const MIN_ASPECT: f64 = power_of_two(-100);

/// Largest magnitude of a component of the polarization, 1.3e30 T.
pub const MAX_POLARIZATION_T: f64 = power_of_two(100);

/// How far from 1 the norm of a rotation quaternion may be.
pub const UNIT_NORM_TOLERANCE: f64 = 1e-9;

/// A norm this close to 1 is 1 up to round-off; normalising again would only change the last digit.
pub(crate) const NORM_ROUNDING: f64 = 2.0 * f64::EPSILON;

/// Edges of two tiles with a smaller sine of their angle count as parallel: their cross product is no direction.
pub(crate) const PARALLEL_EDGES: f64 = 1e-6;

/// Values whose spread is below this fraction of their mean are one value: it is what rounding their mean leaves.
pub(crate) const ROUNDED_SPREAD: f64 = 1e-14;

/// Points that one thread takes at a time. Large enough to hide the scheduling, small enough to share out 405 points.
pub(crate) const POINTS_PER_TASK: usize = 64;

const fn power_of_two(exponent: i64) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}
