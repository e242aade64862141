//! Tolerances and tuning constants of many cuboids, each with what it trades.

use magsplice_cuboid::tolerances::EXACT_BOUND;

/// Along a rotated axis, a point closer to a face than this many units of round-off of its distance
/// from the axis's origin lies on the face: its coordinate is no better known.
pub(crate) const POINT_ROUNDINGS: f64 = 4.0;

/// Width of the cells in which directions are looked up. Any width far above `SAME_ROTATION` works.
pub(crate) const DIRECTION_CELL: f64 = 1e-9;

/// Largest fraction of the logarithmic terms of several tiles at a shared edge that may remain if
/// they count as cancelled. If more remains, the field is unbounded there.
///
/// The remainder of a cancelled term is multiplied by ln(2^-240) = -166, so 1e-14 stays at
/// round-off of the polarization.
pub(crate) const EDGE_CANCELLATION: f64 = 1e-14;

/// Largest difference between the unit directions of edges that count as the same direction. It is
/// far above round-off and far below any intended angle.
pub(crate) const SAME_RAY: f64 = 1e-9;

/// Cost of a multipole expansion of degree p at a vector of points, in multiply-adds over
/// (p + 2) (p + 3). There are half as many terms, each with six sums and three operations of the
/// recurrence.
pub(crate) const NODE_COST: f64 = 4.5;

/// [`NODE_COST`] of a flat film, whose parity halves the sums.
pub(crate) const FLAT_NODE_COST: f64 = 3.0;

/// Allowed truncation error of a local expansion, as a fraction of the one allowed for its node.
///
/// A larger fraction lowers the degree of the local expansion, but leaves less to all other nodes.
/// Times between 0.1 and this differ by about 1 %.
pub(crate) const LOCAL_ERROR_SHARE: f64 = 0.25;

/// Rounding of an item's field that needs no closer bound, as a fraction of the truncation error
/// allowed for a node.
pub(crate) const ROUNDING_SHARE: f64 = 1e-3;

/// Smallest number of points for which nodes are translated. A translation costs as much as the
/// multipole expansion at that many points.
pub(crate) const MIN_TRANSLATION_POINTS: usize = 32;

/// Distances from a translated node's centre, in its radii, to the spheres on which its field is
/// bounded (r - rho of Eq. P37).
///
/// Farther from the node the field is weaker; nearer to it the sphere is larger, which lowers the
/// degree. The best of them is used.
pub(crate) const SPHERE_GAPS: [f64; 4] = [1.0, 1.4, 2.0, 3.0];

/// Smallest distance, in radii of a node, at which its expansion is considered. At smaller
/// distances no degree is sufficient.
pub(crate) const MIN_NODE_DISTANCE: f64 = 1.2;

/// Degrees of a tree beyond the binary logarithm of the inverse tolerance, for the factors of the
/// truncation error that grow with the degree.
pub(crate) const EXTRA_DEGREES: f64 = 16.0;

/// Smallest value of a tree's highest degree.
pub(crate) const MIN_TREE_DEGREE: usize = 6;

/// Largest number of points that are sorted at a time. Their copies take 400 MB.
pub(crate) const MAX_SORTED_POINTS: usize = 1 << 22;

/// Smallest number of points in a list whose bounding box is interpolated.
pub(crate) const MIN_LOOK_UP_POINTS: usize = 20_000;

/// Smallest number of tiles for which the bounding box of a list is interpolated. Direct summation
/// of fewer tiles is as fast as a look-up.
pub(crate) const MIN_LOOK_UP_TILES: usize = 24;

/// Smallest number of points per node when the bounding box of a list is interpolated. Each node
/// costs one exact field.
pub(crate) const LOOK_UP_POINTS_PER_NODE: usize = 4;

/// Smallest number of tiles for which the tree is used. Direct summation of fewer tiles is cheaper
/// than sorting the points.
pub(crate) const MIN_TREE_TILES: usize = 64;

/// Smallest number of points for which the tree is used. Direct summation at fewer points costs
/// less than building the tree.
pub(crate) const MIN_TREE_POINTS: usize = 256;

/// Number of points of a list at which the rounding of the tree's sums is compared with the
/// tolerance before the points are sorted. They cost at most a sixteenth of the exact field.
pub(crate) const ROUNDING_POINTS: usize = 16;

/// Largest cost of an interaction list, as a fraction of that of direct summation, with which the
/// tree is used. Costs are counted, not measured, and the tree's points are sorted.
pub(crate) const LARGEST_LIST_COST: f64 = 0.8;

/// Smallest and largest number of points in a batch of the tree.
///
/// One thread evaluates the parts of a batch in turn. The allowed truncation error of the first
/// part is estimated, and the one of each further part follows from the part before. Points of the
/// whole batch with a weak field are refined together.
pub(crate) const POINTS_PER_TREE_BATCH: [usize; 2] = [256, 2048];

/// Number of batches that keep all threads busy until the end, where there are enough points.
pub(crate) const TREE_BATCHES: usize = 64;

/// Number of points that share an interaction list. More points share the cost of the list. Fewer
/// points are closer together, so that more tiles are far away and expansions have lower degrees.
pub(crate) const POINTS_PER_LIST: usize = 128;

/// One of this many points may have a field too weak for the truncation error, and is refined. A
/// refined point costs as much as five others; half as many of them would make all others 3 %
/// slower.
pub(crate) const POINTS_PER_WEAK_FIELD: usize = 32;

/// Number of points of a part at which the field is estimated first.
pub(crate) const ESTIMATE_POINTS: usize = 16;

/// Allowed truncation error of the first estimate of the field, as a fraction of the largest J.
pub(crate) const FIRST_ERROR_OVER_J: f64 = 1e-3;

/// Number of nodes among which a truncation error is divided before an interaction list is known.
pub(crate) const FIRST_NODE_COUNT: f64 = 16.0;

/// Mean truncation error of a node at a point, as a fraction of the allowed one. It is below 1
/// because the point is farther away than the nearest one, and because degrees are integers.
pub(crate) const USED_ERROR_SHARE: f64 = 0.5;

/// Expected largest truncation error at the next points, as a multiple of the mean at the points
/// before; [`ADDED_NODE_ERRORS`] is added.
pub(crate) const ERROR_OVER_MEAN: f64 = 1.6;

/// Addition to the expected largest truncation error, in allowed truncation errors of one node.
pub(crate) const ADDED_NODE_ERRORS: f64 = 2.0;

/// Smallest estimated field, in truncation errors of the estimate, that is accepted.
pub(crate) const FIELD_OVER_ERROR: f64 = 4.0;

/// Factor by which the truncation error decreases from one estimate to the next.
pub(crate) const ESTIMATE_STEP: f64 = 1e-2;

/// Allowed truncation error, as a fraction of the tolerance at the weakest of some points. The
/// field may be weaker between them.
pub(crate) const SAFETY_FACTOR: f64 = 0.7;

/// Maximum number of refinement rounds before a point falls back to direct summation.
pub(crate) const MAX_REFINEMENT_ROUNDS: usize = 4;

/// Number of bisections in the search for the distance from which an expansion replaces direct
/// summation.
pub(crate) const DISTANCE_BISECTIONS: usize = 8;

/// Largest number of tiles in a node whose truncation error is bounded by the corners of each tile.
/// With more tiles only the farthest distance of each is used.
pub(crate) const CORNER_MEAN_TILES: usize = 64;

/// Largest ratio of the longest to the second side of a bar. Bars use the compact closed form,
/// whose error is at least that ratio in units of round-off.
pub(crate) const LONGEST_BAR: f64 = 10.0;

/// Largest error of one part of a cluster, over the error of a single tile at the end of its closed
/// form. Next to a thin part only the error of this part counts. The errors of single tiles that
/// were measured are below a fifth of [`EXACT_BOUND`].
pub(crate) const LARGEST_ERROR_OF_PART: f64 = 3.0;

/// Factor by which the closed form of a cluster reaches farther than [`CLOSED_FORM_REACH`] under a
/// tolerance. Its error grows with that ratio.
pub(crate) const STRETCH: f64 = 2.0;

/// Error bound of direct summation within a tree, as a fraction like [`EXACT_BOUND`].
pub(crate) const STRETCHED_BOUND: f64 = STRETCH * EXACT_BOUND;

/// Largest number of tiles in each of four groups that share a division. Products of 12 lengths for
/// each tile, between 1 / [`PRODUCT_RANGE`] and [`PRODUCT_RANGE`], then stay in range.
pub(crate) const SMALL_GROUP: usize = 4;

/// Largest number of tiles whose terms are multiplied before one logarithm or arctangent is taken.
/// With more tiles each costs less. But the total angle must stay below half a turn, so that the
/// points must be farther away.
pub(crate) const TILES_PER_GROUP: usize = 16;

/// [`TILES_PER_GROUP`] for the elements of rods. Some of their lengths are as small as the square
/// of the least distance over the longest.
pub(crate) const RODS_PER_GROUP: usize = 8;

/// Smallest distance d from a group at which its product is used, as a multiple of the cube root of
/// its volume V. The total half angle of the group is then below 2.5. Whatever the tiles, they lie
/// beyond a plane. The angle is therefore at most the integral of dV / r^3 over the cap of a ball
/// with that volume, 2 pi (ln(R / d) - 1 + d / R), which is 2.5 for V = 24 d^3.
pub(crate) const GROUP_DISTANCE: f64 = 0.35;

/// Distance at which points may still use the product of a group, in thicknesses of the thickest
/// tile. It limits the volume of the group, see [`GROUP_DISTANCE`].
pub(crate) const GROUP_THICKNESSES: f64 = 2.0;

/// Largest distance from tiles whose terms are multiplied, scaled to their size; the smallest is
/// its inverse. Products of 12 lengths for each tile of a group then stay in range.
pub(crate) const PRODUCT_RANGE: f64 = 16.0;

/// Largest number of tiles that share tables of corners. It is large enough that most corners are
/// shared, and small enough that the tables stay in the first caches.
pub(crate) const TILES_PER_CLUSTER: usize = 64;

/// Largest number of tiles in a cluster that a tree never halves. A tree halves larger clusters
/// that are long, see [`HALVED_RADIUS`]. The spheres of the halves are smaller, so that expansions
/// converge nearer to them.
pub(crate) const TILES_PER_ITEM: usize = 32;

/// Largest radius of the halves of a cluster, as a fraction of the radius of the cluster, at which
/// the cluster is halved. Halves of rows and of rectangles of 3 : 2 and longer are smaller. Halves
/// of a square would have four fifths of its radius, and there would be twice as many nodes.
pub(crate) const HALVED_RADIUS: f64 = 0.7;

/// Number of neighbouring leaves whose moments are computed at the same time: the lanes of the
/// longest vector.
pub(crate) const LEAVES_PER_GROUP: usize = 8;

/// Largest number of corners in the tables of a cluster, a power of two. Tiles that need longer
/// tables are divided further.
pub(crate) const MOST_CORNERS: usize = 512;

/// See [`MOST_CORNERS`].
pub(crate) const MOST_PLANES: usize = 128;

/// See [`MOST_CORNERS`].
pub(crate) const MOST_GROUPS: usize = 256;

/// Largest number of shapes whose multipole series are kept, 10 kB each. In a scene with more
/// shapes no series is kept; each is computed when it is needed.
pub(crate) const KEPT_SERIES: usize = 4096;

/// Smallest and largest number of points that one thread evaluates at a time. The smallest divides
/// 405 points among the threads. The largest fills the vectors of each method and still fits the
/// first caches.
pub(crate) const POINTS_PER_BATCH: [usize; 2] = [64, 512];

/// Least field that keeps a tolerance, over the bound of the magnitude in a box, up to which the
/// bound decides nearly all points of a single tile. The field is rarely below a hundredth of that
/// bound. Above it the closed form writes a bound for each point, for some 10 % of its time.
pub(crate) const DECIDED_BY_BOX: f64 = 0.01;

/// Largest number of points of a scene of one tile that one thread evaluates at a time. It is
/// larger because the last vectors of each method are not full.
pub(crate) const POINTS_OF_ONE_TILE: usize = 8192;

/// Number of points of a scene of one tile whose methods are determined at a time. They are so many
/// that most methods have full vectors, and so few that their queues stay in the first caches.
pub(crate) const STREAMED_POINTS: usize = 256;

/// Number of points by which memory is requested ahead. Their evaluation takes longer than the
/// memory access, and they fit the second cache.
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

/// Number of points of a grid whose exact field is evaluated at a time. Their coordinates take 1.5
/// MB, and they give every thread batches enough.
pub(crate) const GRID_POINTS_AT_ONCE: usize = 1 << 16;

/// Number of batches for each thread, where there are enough points. More batches divide the work
/// more evenly.
pub(crate) const BATCHES_PER_THREAD: usize = 8;

/// Number of neighbouring tiles whose magnitudes are bounded together at points far from them. A
/// bound of one tile costs a twelfth of its closed form; far away the exact field of a cluster
/// costs as little, and there the groups are far too.
pub(crate) const TILES_PER_GROUP_BOUND: usize = 16;

/// Distance from the centre of such a group, in radii of the sphere around it, from which its tiles
/// are bounded together. The bound is at most 8^3 / 7^3 = 1.5 times what dipoles in the group have.
pub(crate) const GROUP_BOUND_FROM: f64 = 8.0;

/// Number of points in a task when a [`PolarizationMap`](crate::PolarizationMap) is applied. A task
/// costs more than its scheduling.
pub(crate) const POINTS_PER_TASK: usize = 64;

/// Number of partial sums of a scalar product, which do not wait for each other.
pub(crate) const PARTIAL_SUMS: usize = 8;

/// Smallest number of grid points that a Chebyshev fit is tried for. A fit would need as many
/// nodes.
pub(crate) const MIN_FIT_POINTS: usize = 1000;

/// Smallest number of pairs of tiles and grid points that a Chebyshev fit is tried for. The proof
/// of its error costs as much as thousands of pairs, whether the fit is then made or not.
pub(crate) const MIN_FIT_PAIRS: usize = 24_000;

/// Smallest relative tolerance that a fit is tried for. A fit of 8 nodes along each axis amplifies
/// the bound of the exact field 12 times, and the magnitudes of the fields of several tiles add up
/// to a multiple of |B|.
pub(crate) const MIN_FIT_FRACTION: f64 = 50.0 * EXACT_BOUND;

/// Smallest number of grid points per node of a fit. Each node costs one exact field.
pub(crate) const GRID_POINTS_PER_NODE: usize = 2;

/// Cost of the transform of the values at nodes to coefficients, for each node, in exact fields of
/// one tile over [`GRID_POINTS_PER_NODE`]. Where tiles are few, it costs more than the exact field.
pub(crate) const NODE_TRANSFORM_TILES: usize = 6;

/// Smallest number of points per node that the distances of tiles suggest for a fit, of a list or
/// of few tiles ([`MIN_LOOK_UP_TILES`]). They suggest fewer nodes than the fit needs; a box that
/// would need still more is sampled in vain, which costs most where the exact field is cheap.
pub(crate) const POINTS_PER_EXPECTED_NODE: usize = 12;

/// Largest number of nodes along an axis. A box that needs more is divided.
pub(crate) const MAX_FIT_NODES: usize = 64;

/// Slowest decay from one coefficient to the next for which a box is fitted. Slower ones need more
/// than [`MAX_FIT_NODES`] nodes.
pub(crate) const MAX_DECAY: f64 = 0.95;

/// Bound of the truncation error of a fit, as a fraction of its allowed error. The rest is for
/// rounding, and for points with a weaker field than those at which |B| was looked at.
pub(crate) const TRUNCATION_SHARE: f64 = 0.75;

/// Growth of the rounding error that is allowed for when more nodes are needed because of it.
pub(crate) const LARGER_ROUNDING: f64 = 1.2;

/// Smallest truncation error of a fit that is aimed at, as a fraction of the allowed error. Below
/// it rounding would need nearly all of the allowance.
pub(crate) const MIN_TRUNCATION_SHARE: f64 = 0.1;

/// Number of points along each axis of a box, its ends included, at which the smallest |B| is
/// looked for.
pub(crate) const RANGE_POINTS: usize = 5;

/// Number of patches of a face, in the bound of the truncation error, along a side as long as the
/// distance of its tile from the box. With half as many, the bound needs a node more along an axis.
pub(crate) const PATCHES_PER_DISTANCE: f64 = 2.0;

/// Largest number of patches of a face along each of its sides.
pub(crate) const PATCHES: f64 = 6.0;

/// A tile is described by dipoles instead of charges in the bound of the truncation error if this
/// times its moment is less than its charges times their distance: the bound of a coefficient of
/// degree k grows by about k over the distance with each derivative.
pub(crate) const DIPOLE_DEGREE: f64 = 16.0;

/// Largest rounding error of a coordinate of a node and of a point relative to it, as a fraction of
/// the coordinate plus half the box: at most four roundings.
pub(crate) const NODE_ROUNDING: f64 = 2.0 * f64::EPSILON;

/// Largest difference between a tile and its mirror image, as a fraction of the smaller of the tile
/// and its distance, of which their fields are still treated as mirror images. The difference is
/// counted as an error.
pub(crate) const MIRROR_ROUNDING: f64 = 3e-14;

/// Largest number of tiles among which mirror images are searched. The time of the search grows
/// with the square of that number.
pub(crate) const MAX_MIRRORED_TILES: usize = 4096;

/// Smallest |B| in a box, as a fraction of the largest, for which nodes are added. Points with a
/// weaker field use direct summation.
pub(crate) const MIN_FIELD_SHARE: f64 = 1e-2;

/// Degree of the field in a cell. A lower degree needs more cells, which no longer fit the second
/// cache and have fewer points each; a higher degree costs more at each point.
pub(crate) const CELL_DEGREE: usize = 9;

/// Exponent with which the truncation error of a cell is assumed to decrease with its size. Only
/// small cells reach that of the next degree, 10.
pub(crate) const CELL_ERROR_EXPONENT: f64 = 7.0;

/// Largest number of cells of a box. They take 22 MB.
pub(crate) const MAX_CELLS: usize = 8192;

/// Maximum number of times that cells are made smaller until their error is small enough.
pub(crate) const MAX_CELL_ROUNDS: usize = 12;

/// Largest number of nodes of the fit of a [`FittedField`](crate::FittedField).
pub(crate) const MAX_FITTED_FIELD_NODES: usize = 200_000;

/// Smallest and largest number of points that are sorted by cell at a time. Among more points, more
/// share the coefficients of a cell.
pub(crate) const POINTS_PER_LOOK_UP: [usize; 2] = [1 << 10, 1 << 16];
