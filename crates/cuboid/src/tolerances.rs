//! Tolerances and tuning constants of one cuboid, each with what it trades.

use magsplice_simd::power_of_two::power_of_two;

/// Beyond this value of tanh the logarithm of an edge is taken from products instead of from `ln_1p`.
///
/// Both forms are free of cancellation everywhere the products stay in range; `ln_1p` keeps relative accuracy where the
/// element is small, the products where it diverges. The switch only has to be away from 0 and 1.
pub const ARTANH_TO_PRODUCT: f64 = 0.5;

/// A point closer to a face than this fraction of the smallest size in the scene counts as that far from it, on its own side;
/// one exactly on the face on the side of +x, +y, +z of the tile's frame: the half-open rule lo <= p < hi.
///
/// It vanishes in every sum but those that are the offset itself, and ln(2^-240) = -166 costs hardly a digit where the logarithms of
/// touching tiles cancel.
pub const FACE_NUDGE: f64 = power_of_two(-120);

/// The nudge is never less than this fraction of a tile's own largest size, so that its square stays a normal number.
/// Seams between tiles that differ by more than 2^200 in size are beyond what is supported.
pub const SMALLEST_NUDGE: f64 = power_of_two(-300);

/// A tile whose largest size is below this fraction of the distance adds nothing: its field is below
/// 2^-1200 of J, and with J at most `MAX_POLARIZATION_T` rounds to zero.
pub const VANISHING_SIZE: f64 = power_of_two(-400);

/// Points are put onto faces only of tiles at least this many times thicker than the round-off of the point.
pub const RESOLVED_THICKNESS: f64 = 16.0;

/// The closed form in vectors begins at this fraction of a tile's largest side from it. Nearer to an edge its differences of nearly equal
/// numbers cost digits like 1 / distance^2.
pub const NEAR_FRACTION: f64 = 0.08;

/// Nearer, and inside, terms are added up in vectors, of tiles whose smallest side is at least this fraction of the largest: then no column of the
/// tensor is so small there that round-off of the terms would matter.
pub const BESIDE_ASPECT: f64 = 0.1;

/// That needs points at least this fraction of the largest side off the planes of all faces: products of eight such lengths stay normal numbers.
pub const LEAST_OFFSET: f64 = power_of_two(-40);

/// The closed form in vectors ends this many second largest sides from the tile's middle: its error grows with that ratio.
pub const MIDDLE_REACH: f64 = 15.0;

/// It does not serve tiles whose largest side is more than this many times the second: what they lose is at least that ratio.
pub const LONGEST_NEEDLE: f64 = 10.0;

/// Orders of the multipole series in (half diagonal / distance)^2, and the distance in half diagonals from which each is enough, nearer ones
/// first. What is left out after order n is at most (n + 2) / distance^(2n + 2) of the field, which for a needle is below 3e-15 from here on, for
/// compact tiles far less.
pub const MULTIPOLE_ORDERS: [(usize, f64); 5] = [(8, 7.3), (6, 13.0), (5, 20.0), (4, 34.0), (3, 90.0)];

/// The highest of them.
pub const HIGHEST_ORDER: usize = 8;

/// What the closed form takes for a tile of a cluster, in multiply-adds of vectors: measured on the published film. It only decides which form
/// is taken where several would do.
pub const CLOSED_FORM_COST: f64 = 215.0;

/// The same for a tile by itself.
pub const ALONE_COST: f64 = 690.0;

/// The series ends at this square of the distance in sizes, so that no power of the distance overflows; the kernel of one point goes on.
pub const FARTHEST: f64 = power_of_two(200);

/// A tile whose volume is at most this fraction of the cubed distance has no element with half of 4 pi T beyond it: |T| is at most the integral of
/// dV / 2 pi r^3. Series in it then need no reduction.
pub const SMALL_ANGLE: f64 = 0.2;

/// The distance from its centre from which a tile's elements are small is found to this many halvings of its half diagonal.
pub const RADIUS_BISECTIONS: usize = 7;

/// Whether one form serves all points of a box is decided with this relative margin, far above the round-off in the decision for a point.
pub const FORM_MARGIN: f64 = 1e-9;

/// The same of groups of tiles together, to a tolerance: three terms of the series do, to a third of [`EXACT_BOUND`], and on films points are rarely nearer.
pub const SMALLER_ANGLE: f64 = 0.04;

/// T_ii is taken from the faces across i itself if the tile is at least this fraction of its second side thick there, else from the trace.
pub const DIRECT_DIAGONAL: f64 = 0.5;

/// The error of the exact field, as a fraction of the sum over tiles of the fields that the components of J make alone: what
/// `Scene` promises.
pub const EXACT_BOUND: f64 = 2e-14;

/// The largest field of a tile over its J, each component: |T_ij| grows by ln(2) / 2 pi each time a point comes closer to an edge by half, and no face is
/// closer than [`FACE_NUDGE`] squared.
pub const LARGEST_FIELD_OVER_J: f64 = 30.0;
