//! Tolerances and tuning constants of direct summation, each with its trade-off.

use magsplice_cuboid::tolerances::EXACT_BOUND;

/// Along a rotated axis, a point closer to a face than this many units of round-off of its distance
/// from the axis's origin counts as on the face, because its coordinate has that error.
pub(crate) const POINT_ROUNDINGS: f64 = 4.0;

/// Width of the cells for the lookup of directions. Any width far above `SAME_ROTATION` works.
pub(crate) const DIRECTION_CELL: f64 = 1e-9;

/// Largest remaining fraction of the logarithmic terms of several tiles at a shared edge that
/// counts as cancelled. If more remains, the field is unbounded there.
///
/// The remainder of a cancelled term is multiplied by ln(2^-240) = -166, so 1e-14 stays at
/// round-off of the polarization.
pub(crate) const EDGE_CANCELLATION: f64 = 1e-14;

/// Largest difference between the unit directions of edges that count as the same direction. It is
/// far above round-off and far below any intended angle.
pub(crate) const SAME_RAY: f64 = 1e-9;

/// Largest ratio of the longest to the second side of a bar. Bars use the compact closed form,
/// whose error in units of round-off is at least that ratio.
pub(crate) const LONGEST_BAR: f64 = 10.0;

/// Largest error of one part of a cluster, over the error of a single tile at the end of its closed
/// form. Next to a thin part only the error of this part counts. Measured errors of single tiles
/// are below a fifth of [`EXACT_BOUND`].
pub(crate) const LARGEST_ERROR_OF_PART: f64 = 3.0;

/// Range of the closed form of a cluster under a tolerance, over [`CLOSED_FORM_REACH`]. Its error
/// grows with that ratio.
pub(crate) const STRETCH: f64 = 2.0;

/// Error bound of direct summation within a tree, as a fraction like [`EXACT_BOUND`].
pub const STRETCHED_BOUND: f64 = STRETCH * EXACT_BOUND;

/// Largest number of tiles in each of four groups that share a division. Products of 12 lengths for
/// each tile, between 1 / [`PRODUCT_RANGE`] and [`PRODUCT_RANGE`], then stay in range.
pub(crate) const SMALL_GROUP: usize = 4;

/// Largest number of tiles whose terms are multiplied before one logarithm or arctangent is taken.
/// More tiles take less time each, but their total angle must stay below half a turn, so the points
/// must be farther away.
pub(crate) const TILES_PER_GROUP: usize = 16;

/// [`TILES_PER_GROUP`] for the elements of rods. Some of their lengths are as small as the square
/// of the smallest distance over the longest side.
pub(crate) const RODS_PER_GROUP: usize = 8;

/// Smallest distance d from a group at which its product is used, as a multiple of the cube root of
/// its volume V. The total half angle of the group is then below 2.5. Any tiles are beyond a plane.
/// The angle is therefore at most the integral of dV / r^3 over the cap of a ball with that volume,
/// 2 pi (ln(R / d) - 1 + d / R), which is 2.5 for V = 24 d^3.
pub(crate) const GROUP_DISTANCE: f64 = 0.35;

/// Distance at which points may still use the product of a group, in thicknesses of the thickest
/// tile. It limits the volume of the group, see [`GROUP_DISTANCE`].
pub(crate) const GROUP_THICKNESSES: f64 = 2.0;

/// Largest distance from tiles whose terms are multiplied, scaled to their size; the smallest
/// distance is its inverse. Products of 12 lengths for each tile of a group then stay in range.
pub(crate) const PRODUCT_RANGE: f64 = 16.0;

/// Largest number of tiles that share tables of corners. It is large enough that most corners are
/// shared, and small enough that the tables stay in the first caches.
pub(crate) const TILES_PER_CLUSTER: usize = 64;

/// Largest number of tiles in a cluster that a tree never halves. A tree halves larger clusters
/// that are elongated, see [`HALVED_RADIUS`]. The spheres of the halves are smaller, so expansions
/// converge nearer to them.
pub(crate) const TILES_PER_ITEM: usize = 32;

/// Largest radius of the halves of a cluster, as a fraction of the radius of the cluster, at which
/// the cluster is halved. Halves of rows and of rectangles of 3 : 2 and longer are smaller. Halves
/// of a square would have four fifths of its radius, and there would be twice as many nodes.
pub(crate) const HALVED_RADIUS: f64 = 0.7;

/// Largest number of corners in the tables of a cluster, a power of two. Tiles with longer tables
/// are divided further.
pub(crate) const MOST_CORNERS: usize = 512;

/// See [`MOST_CORNERS`].
pub(crate) const MOST_PLANES: usize = 128;

/// See [`MOST_CORNERS`].
pub(crate) const MOST_GROUPS: usize = 256;

/// Largest number of shapes whose multipole series are kept, 10 kB each. In a scene with more
/// shapes no series is kept; each is computed when needed.
pub(crate) const KEPT_SERIES: usize = 4096;

/// Smallest and largest number of points that one thread evaluates at a time. The smallest divides
/// 405 points among the threads. The largest fills the vectors of each method and still fits the
/// first caches.
pub(crate) const POINTS_PER_BATCH: [usize; 2] = [64, 512];

/// Upper bound of the magnitude of a cuboid over |B|, where the series is used: from 7.3 half
/// diagonals on. In units of V / 4 pi r^3, |B| is at least |J|, the smallest field of a dipole,
/// less the terms of higher degree. They are at most 0.082 times the sum of |J_k| (docs/physics.md,
/// Eq. P45), which is at most 3^1/2 |J|. So the ratio is at most (2 + 0.082) 3^1/2 / (1 - 0.082 *
/// 3^1/2).
pub(crate) const FAR_MAGNITUDE: f64 = 4.21;

/// Largest field of a tile over its J, for each component, at points close to it that are evaluated
/// in vectors. They are at least 2^-40 of the longest side from all planes of its faces, or 0.003
/// of the second side, at least 2^-40 of the longest, from the tile. Eqs. P46 and P52 give at most
/// 7.6 there.
pub(crate) const NEAR_FIELD_OVER_J: f64 = 8.0;

/// Smallest field that keeps a tolerance over the magnitude of a single tile, up to which a bound
/// from the distances of a point decides nearly all points. The bound is at most 60 times the
/// magnitude beside rods, and the field is rarely below a tenth of it. Above this ratio the closed
/// form computes a bound for each point, in some third of its time.
pub(crate) const DECIDED_BY_DISTANCE: f64 = 1e-3;

/// Largest number of points of a scene of one tile that one thread evaluates at a time. It is
/// larger than [`POINTS_PER_BATCH`] because the last vectors of each method are not full.
pub(crate) const POINTS_OF_ONE_TILE: usize = 8192;

/// Number of points of a scene of one tile whose methods are determined at a time. It fills the
/// vectors of most methods, and the queues stay in the first caches.
pub const STREAMED_POINTS: usize = 256;

/// Number of points whose memory is requested ahead. Their evaluation takes longer than the memory
/// access, and they fit the second cache.
pub(crate) const FETCHED_AHEAD: usize = 512;

/// Points keep their order if at most one of this many pairs of vectors has points of several
/// methods. Such a pair is evaluated once by each of these methods. Otherwise the points are sorted
/// by method.
pub(crate) const MIXED_SHARE: usize = 4;

/// Smallest number of clusters and single tiles in a scene for which a batch consists of
/// neighbouring points. Most clusters then have the same method at all points of a batch.
pub(crate) const REGROUPED_PARTS: usize = 100;

/// Number of points among which neighbouring points are chosen. Their copies take a megabyte.
pub(crate) const REGROUPED_POINTS: usize = 16_384;

/// Number of batches for each thread, where there are enough points. More batches divide the work
/// more evenly.
pub(crate) const BATCHES_PER_THREAD: usize = 8;

/// Number of neighbouring tiles whose magnitudes have one bound at points far from them. A bound of
/// one tile takes a twelfth of the time of its closed form. Far away the exact field of a cluster
/// takes as little, and there the groups are far too.
pub(crate) const TILES_PER_GROUP_BOUND: usize = 16;

/// Distance from the centre of such a group, in radii of the sphere around it, from which its tiles
/// have one bound. The bound is at most 8^3 / 7^3 = 1.5 times the magnitude of dipoles in the
/// group.
pub(crate) const GROUP_BOUND_FROM: f64 = 8.0;

/// Degrees of an expansion that the gradient needs more than the field. The part of degree l of a
/// derivative is l + 2 times its share of the field, and each degree divides it by the distance in
/// radii, at least 3. At the highest degree, from 3 radii on, the truncation error of the gradient
/// is at most 6e-14 of the sum over tiles.
pub(crate) const FURTHER_DEGREES: usize = 3;

/// Number of points at which the time of the exact field is counted. The count takes less time than
/// the exact field at these points.
pub(crate) const COST_POINTS: usize = 4;
