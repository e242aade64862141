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

/// Tiles do not overlap if they penetrate each other by at most this many units of round-off of the
/// largest coordinate: 5.7e-14 of the largest sum of the coordinates of a corner.
///
/// A computed position differs from the intended one by the round-off of everything it was computed
/// from:
///
/// * A rotated position moves by the error of the angle times its whole distance from the centre of
///   rotation, not times its projection on the normal of the touching faces. An angle of up to one
///   turn that is converted from degrees and multiplied has an error of 4 x 2 pi = 25 units.
/// * Rings are also built step by step. The sum of 256 equal angles is wrong by up to 320 units,
///   and 256 rotations multiplied by each other by up to 256.
/// * The coordinates of a row about the origin, or of a group that was moved, are differences of
///   lengths as large as the row or the move, each rounded.
/// * Cosine, radius, rotation of the tile and its sides add less than 32 units.
///
/// A ring has one of the errors of the second kind, where it closes. The sum of 320, twice 25 and
/// twice 32 units is below 512. Tiles 100 mm from the origin may thus penetrate each other by 6e-12
/// mm, far less than the diameter of an atom (1e-7 mm).
pub const OVERLAP_ROUNDINGS: f64 = 512.0;

/// Largest penetration that counts as round-off, as a fraction of the thinnest side of both tiles.
/// It matters in layouts with tiles ten million sides away.
pub const DEEPEST_ROUND_OFF: f64 = 1e-6;

/// Faces closer than this many units of round-off of their coordinates are one face, so that every
/// point of a seam has one owner. Tiles that penetrate each other by more than this, and by no more
/// than [`OVERLAP_ROUNDINGS`], both own the points between their faces.
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
