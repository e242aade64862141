//! Limits on tiles, and the round-off that geometry tolerates.

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
/// penetrate each other by at most half of it do not overlap. A pair that is not reported as
/// overlapping is therefore joined, and no sliver has two owners.
///
/// `position - size / 2` adds two roundings to the intended number, which may itself be computed.
pub const SEAM_ROUNDINGS: f64 = 8.0;

/// [`SEAM_ROUNDINGS`] for rotated tiles, whose positions are rotated and rotated back.
pub const ROTATED_SEAM_ROUNDINGS: f64 = 32.0;

/// Largest difference of the components of two directions that count as equal.
///
/// A quaternion built from an axis and an angle in degrees has an error of about four units of
/// round-off.
pub const SAME_ROTATION: f64 = 16.0 * f64::EPSILON;

/// Sine of the angle of two edges below which they count as parallel, because their cross product
/// has no reliable direction.
pub(crate) const PARALLEL_EDGES: f64 = 1e-6;

const fn power_of_two(exponent: i64) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}
