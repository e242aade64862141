//! Tolerances and tuning constants of one cuboid, each with its trade-off.

use magsplice_simd::power_of_two::power_of_two;

/// tanh of the logarithm of an edge beyond which it is computed from products instead of `ln_1p`.
///
/// Both expressions are free of cancellation wherever the products stay in range. `ln_1p` keeps
/// relative accuracy where the element is small, the products where it diverges. Any switch well
/// between 0 and 1 works.
pub const ARTANH_TO_PRODUCT: f64 = 0.5;

/// Smallest distance of a point from a face, as a fraction of the smallest size in the scene. A
/// nearer point counts as at this distance from the face, on its own side. A point exactly on a
/// face counts as on the side of +x, +y, +z of the tile's frame: the half-open rule lo <= p < hi.
///
/// The distance vanishes in every sum except the offset. Where the logarithms of touching tiles
/// cancel, ln(2^-240) = -166 loses hardly a digit.
pub const FACE_NUDGE: f64 = power_of_two(-120);

/// Smallest value of [`FACE_NUDGE`], as a fraction of a tile's own largest size, so that its square
/// is a normal number. Seams between tiles whose sizes differ by more than 2^200 are not supported.
pub const SMALLEST_NUDGE: f64 = power_of_two(-300);

/// Ratio of the largest size of a tile to its distance below which its field vanishes. The field is
/// below 2^-1200 of J, which rounds to zero for the largest J (`MAX_POLARIZATION_T` of
/// magsplice-magnet).
pub const VANISHING_SIZE: f64 = power_of_two(-400);

/// Smallest ratio of a tile's thickness to the round-off of a point for which points are moved onto
/// its faces.
pub const RESOLVED_THICKNESS: f64 = 16.0;

/// Distance from a tile, as a fraction of its largest side, or of the second side of a rod, at
/// which the closed form in vectors begins. Nearer to an edge its differences of nearly equal
/// numbers lose digits like 1 / distance^2.
pub const NEAR_FRACTION: f64 = 0.08;

/// Smallest ratio of the shortest to the longest side for which points inside and nearer are
/// evaluated by a term for each edge and corner. No column of the tensor is then so small there
/// that the round-off of the terms matters. At 0.1 their rounding would exceed [`EXACT_BOUND`].
pub const NEAR_EDGE_ASPECT: f64 = 0.125;

/// Smallest distance from a plate or a rod, as a fraction of its second side, for its form of
/// half-infinite rods. Nearer to an edge its error grows like 1 / distance.
pub const THIN_FROM: f64 = 3e-3;

/// Smallest ratio of the shortest to the longest side for the gradient in vectors close to a
/// cuboid: products of sixteen lengths are normal numbers.
pub const THINNEST_GRADIENT: f64 = power_of_two(-20);

/// Largest distance from a plate or a rod along an axis, in shortest sides, for the field by sums
/// of positive terms. Beyond a rim the arctangents of its two corners cancel up to the square of
/// that ratio. The scalar kernel evaluates points from here up to [`THIN_FROM`], beside plates
/// thinner than 1 : 1e-4.
pub const POSITIVE_FIELD_REACH: f64 = 30.0;

/// Largest distance from a cuboid along an axis, scaled so that the longest side is between 1 and
/// 2, for the closed form of the gradient in vectors. The series of all cuboids begin nearer.
pub const GRADIENT_REACH: f64 = 32.0;

/// Smallest ratio of the shortest to the longest side for which points close to a plate or a rod
/// are evaluated in vectors: squares of distances stay in the range of
/// [`Lanes::root`](magsplice_simd::lanes::Lanes::root).
pub const THINNEST: f64 = power_of_two(-40);

/// Ratio of the longest to the second side beyond which
/// [`Form::Thin`](crate::closed_form::terms::Form) takes T_ac and T_aa from the compact form away
/// from the ends. Its own form loses that ratio.
pub const STRIP_ASPECT: f64 = 10.0;

/// Smallest distance of points close to a plate or a rod from the planes of all faces, as a
/// fraction of the largest side: products of eight such lengths are normal numbers.
pub const LEAST_OFFSET: f64 = power_of_two(-40);

/// Distance from the centre, in second largest sides, or in longest sides of a rod, at which the
/// closed form in vectors ends: its error grows with that ratio.
pub const CLOSED_FORM_REACH: f64 = 15.0;

/// Largest ratio of the longest to the second side for the closed form of rods in vectors. Products
/// of twelve lengths as small as [`NEAR_FRACTION`] of the second side are then far from the
/// smallest numbers.
pub const LONGEST_ROD: f64 = power_of_two(20);

/// Orders of the multipole series in (half diagonal / distance)^2, and the distance in half
/// diagonals from which each is sufficient, nearest first. The truncation error after order n is at
/// most (n + 2) / distance^(2n + 2) of the field. From these distances on it is below 3e-15 for a
/// needle and far smaller for compact tiles.
pub const MULTIPOLE_ORDERS: [(usize, f64); 5] = [(8, 7.3), (6, 13.0), (5, 20.0), (4, 34.0), (3, 90.0)];

/// The highest of the [`MULTIPOLE_ORDERS`].
pub const HIGHEST_ORDER: usize = 8;

/// Time of the closed form for one tile of a cluster, in multiply-adds of vectors, measured on the
/// published film. It only determines the choice among methods that all reach the bound.
pub const CLOSED_FORM_COST: f64 = 215.0;

/// Time of the closed form for a single tile, in the same unit.
pub const SINGLE_TILE_COST: f64 = 690.0;

/// Square of the distance in sizes at which the series ends, so that no power of the distance
/// overflows. The scalar kernel evaluates points beyond.
pub const FARTHEST: f64 = power_of_two(200);

/// Largest half of 4 pi T whose series need no argument reduction. It also bounds the ratio of a
/// tile's volume to the cubed distance, because |T| is at most the integral of dV / 2 pi r^3.
pub const SMALL_ANGLE: f64 = 0.2;

/// Number of bisections of the half diagonal in the search for the distance of small elements.
pub const RADIUS_BISECTIONS: usize = 7;

/// Relative margin of the decision whether all points of a box share a method, far above the
/// round-off of the decision for a point.
pub const METHOD_MARGIN: f64 = 1e-9;

/// [`SMALL_ANGLE`] for the groups of a cluster, within a tolerance. Three terms of the series reach
/// a third of [`EXACT_BOUND`], and points of films are rarely nearer.
pub const SMALLER_ANGLE: f64 = 0.04;

/// Smallest thickness of a tile along i, as a fraction of its second side, for which T_ii is
/// computed from the faces normal to i instead of the trace.
pub const DIRECT_DIAGONAL: f64 = 0.5;

/// Error bound of the exact field, as a fraction of the sum of the magnitudes of the fields of
/// every single component of J of every tile.
///
/// Every form of the field of a tile stays below it for any roundings of its operations, by the
/// error analysis of docs/accuracy.md, which is a test. The largest bound found is 8.7e-14, beside
/// plates. Roundings are rarely at their worst at once: the largest error found is 2.5e-14.
pub const EXACT_BOUND: f64 = 1e-13;

/// Error bound of the gradient, as a fraction of the sum of the largest components of the gradients
/// of every single component of J of every tile.
///
/// The largest bound that the same analysis finds is 2.8e-14. The expansions of clusters add a
/// truncation error of up to 6e-14.
pub const GRADIENT_BOUND: f64 = 1e-13;

/// Error of the field of a cuboid with a face moved by a fraction of its least side, over that
/// fraction and the bound of its magnitude, at points at least a tenth of that side from its edges.
/// The field of the thin layer between both places of the face is at most 1.51 of the bound for
/// cubes, in tests with random points, and less for other shapes.
pub const MOVED_FACE_ERROR: f64 = 2.0;

/// Largest relative rounding error of a bound of the magnitude, from some hundred operations and
/// the error of the elements.
pub const MAGNITUDE_ROUNDING: f64 = 1e-12;

/// Largest field of a tile over its J, for each component: |T_ij| grows by ln(2) / 2 pi each time
/// the distance from an edge halves, and no point is closer to an edge than [`FACE_NUDGE`] squared.
pub const LARGEST_FIELD_OVER_J: f64 = 30.0;

/// Distance from the centre, in half diagonals, from which a series about the centre alone bounds
/// the magnitude of the field. Nearer, bounds by the distances from the faces and edges are
/// tighter.
pub const SERIES_BOUND_FROM: f64 = 1.5;

/// Largest squared distance in half diagonals that the bound of the magnitude distinguishes. The
/// bound at this distance, below 1e-270 of J, applies beyond.
pub const FARTHEST_BOUND: f64 = 1e180;

/// Smallest half diagonal of a cuboid, in radii of a sphere around its group, whose bound of the
/// magnitude is computed in single precision.
pub const SMALLEST_IN_SINGLE_PRECISION: f64 = 0.01;

/// Factor that corrects a bound of the magnitude for single precision. At 10 radii from the centre
/// of its group, the offset from the centre of a cuboid has an error of 11 units of 2^-24 in each
/// coordinate. This is 8e-5 of the smallest distance, 0.015 radii. The terms fall at most like q^7
/// x^2, so their error is 7e-4. Some 50 roundings add 3e-6.
pub const SINGLE_PRECISION: f64 = 1.001;
