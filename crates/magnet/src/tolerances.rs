//! Limits on tiles, and the round-off that geometry forgives.

/// Largest length (coordinate or size) of a tile or point. Differences of two such lengths are
/// finite.
pub const MAX_LENGTH: f64 = power_of_two(1000);

/// Smallest size of a tile.
pub const MIN_SIZE: f64 = power_of_two(-900);

/// Smallest ratio of the shortest to the longest side of a tile, 8e-31. Products of two sides and
/// the distance are normal numbers.
pub const MIN_ASPECT: f64 = power_of_two(-100);

/// Largest magnitude of a component of the polarization, 1.3e30 T.
pub const MAX_POLARIZATION_T: f64 = power_of_two(100);

/// Largest deviation from 1 of the norm of a rotation quaternion.
pub const UNIT_NORM_TOLERANCE: f64 = 1e-9;

/// Largest deviation from 1 of a norm that counts as round-off. Normalising such a quaternion again
/// would only change the last digit.
pub(crate) const NORM_ROUNDING: f64 = 2.0 * f64::EPSILON;

/// Half the distance of neighbouring numbers at 1.
pub const UNIT_ROUNDOFF: f64 = 0.5 * f64::EPSILON;

/// Faces closer than this many units of round-off of their coordinates are one face. Tiles that
/// reach into each other by no more than half of it do not overlap: a pair that is not reported as
/// overlapping is joined, so that no sliver has two owners.
///
/// `position - size / 2` is two roundings away from the intended number, which may be the result of
/// a computation itself.
pub const SEAM_ROUNDINGS: f64 = 8.0;

/// [`SEAM_ROUNDINGS`] where a rotation is involved: positions have been through it and back.
pub const ROTATED_SEAM_ROUNDINGS: f64 = 32.0;

/// Two directions whose components differ by no more than this are one direction.
///
/// A quaternion built from an axis and an angle in degrees is off by about four units of round-off.
pub const SAME_ROTATION: f64 = 16.0 * f64::EPSILON;

/// Edges of two tiles with a smaller sine of their angle count as parallel: their cross product has
/// no reliable direction.
pub(crate) const PARALLEL_EDGES: f64 = 1e-6;

const fn power_of_two(exponent: i64) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}
