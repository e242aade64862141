//! Tolerances and tuning constants of trees, interpolation and plans, each with its trade-off.

use magsplice_cuboid::tolerances::EXACT_BOUND;

/// Cost of a multipole expansion of degree p at a vector of points, in multiply-adds over (p + 2)
/// (p + 3). The number of terms is half of that product, each with six sums and three operations of
/// the recurrence.
pub(crate) const NODE_COST: f64 = 4.5;

/// [`NODE_COST`] of a flat film, whose parity halves the sums.
pub(crate) const FLAT_NODE_COST: f64 = 3.0;

/// Allowed truncation error of a local expansion, as a fraction of the error allowed for its node.
///
/// A larger fraction lowers the degree of the local expansion, but less remains for all other
/// nodes. Times for fractions from 0.1 to this value differ by about 1 %.
pub(crate) const LOCAL_ERROR_SHARE: f64 = 0.25;

/// Rounding of an item's field below which a coarse bound is sufficient, as a fraction of the
/// truncation error allowed for a node.
pub(crate) const ROUNDING_SHARE: f64 = 1e-3;

/// Smallest number of points for which nodes are translated. A translation takes the time of the
/// multipole expansion at that many points.
pub(crate) const MIN_TRANSLATION_POINTS: usize = 32;

/// Distances from a translated node's centre, in its radii, to candidate spheres for the bound of
/// its field (r - rho of Eq. P37).
///
/// Farther from the node the field is weaker; nearer, the sphere is larger, which lowers the
/// degree. The best distance is used.
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

/// Smallest time of the exact field at a point for which the bounding box of a list is
/// interpolated, in exact fields of one tile. A look-up takes a tenth, and the fit takes as long as
/// thousands.
pub(crate) const MIN_LOOK_UP_COST: f64 = 24.0;

/// Smallest number of points per node for interpolation of the bounding box of a list. Each node
/// takes one exact field.
pub(crate) const LOOK_UP_POINTS_PER_NODE: usize = 4;

/// Smallest time of the exact field at a point for which the tree is used, in exact fields of one
/// tile. Direct summation in less time is faster than sorting the points.
pub(crate) const MIN_TREE_COST: f64 = 64.0;

/// Smallest number of points for which the tree is used. Direct summation at fewer points is faster
/// than building the tree.
pub(crate) const MIN_TREE_POINTS: usize = 256;

/// Number of points of a list at which the tree is compared with direct summation before the points
/// are sorted. They take at most a sixtieth of the time of the exact field.
pub(crate) const TREE_SAMPLES: usize = 4;

/// Largest number of points among which the neighbours of such a point are counted. The distances
/// take less time than the exact field at one point of a list.
pub(crate) const NEIGHBOURHOOD_SAMPLES: usize = 512;

/// Largest cost of an interaction list, as a fraction of the cost of direct summation, for which
/// the tree is used. It is below 1 because costs are counted instead of measured, and the tree's
/// points must be sorted.
pub(crate) const LARGEST_LIST_COST: f64 = 0.8;

/// Smallest and largest number of points in a batch of the tree.
///
/// One thread evaluates the parts of a batch in turn. The allowed truncation error of the first
/// part is estimated; for each further part it follows from the part before. Points of the whole
/// batch with a weak field are refined together.
pub(crate) const POINTS_PER_TREE_BATCH: [usize; 2] = [256, 2048];

/// Number of batches that keep all threads busy until the end, where there are enough points.
pub(crate) const TREE_BATCHES: usize = 64;

/// Number of points that share an interaction list. With more points, more share the cost of the
/// list. Fewer points are closer together, so more tiles are far away and expansions have lower
/// degrees.
pub(crate) const POINTS_PER_LIST: usize = 128;

/// Number of points per expected point with a field too weak for the truncation error, which is
/// refined. A refined point takes as long as five others. Half as many refined points would slow
/// all others down by 3 %.
pub(crate) const POINTS_PER_WEAK_FIELD: usize = 32;

/// Number of points of a part at which the field is estimated first.
pub(crate) const ESTIMATE_POINTS: usize = 16;

/// Allowed truncation error of the first estimate of the field, as a fraction of the largest J.
pub(crate) const FIRST_ERROR_OVER_J: f64 = 1e-3;

/// Number of nodes that share a truncation error before an interaction list is known.
pub(crate) const FIRST_NODE_COUNT: f64 = 16.0;

/// Mean truncation error of a node at a point, as a fraction of the allowed error. It is below 1
/// because most points are farther away than the nearest point, and because degrees are integers.
pub(crate) const USED_ERROR_SHARE: f64 = 0.5;

/// Expected largest truncation error at the next points, as a multiple of the mean at the points
/// before, without [`ADDED_NODE_ERRORS`].
pub(crate) const ERROR_OVER_MEAN: f64 = 1.6;

/// Addition to the expected largest truncation error, in allowed truncation errors of one node.
pub(crate) const ADDED_NODE_ERRORS: f64 = 2.0;

/// Smallest accepted estimate of the field, in truncation errors of the estimate.
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

/// Largest number of tiles in a node for a bound of the truncation error from the corners of each
/// tile. For more tiles the bound uses only the farthest distance of each.
pub(crate) const CORNER_MEAN_TILES: usize = 64;

/// Number of neighbouring leaves whose moments are computed at the same time: the lanes of the
/// longest vector.
pub(crate) const LEAVES_PER_GROUP: usize = 8;

/// Number of points of a grid whose exact field is evaluated at a time. Their coordinates take 1.5
/// MB, and every thread gets enough batches.
pub(crate) const GRID_POINTS_AT_ONCE: usize = 1 << 16;

/// Number of points in a task when a [`PolarizationMap`](crate::PolarizationMap) is applied. A task
/// takes longer than its scheduling.
pub(crate) const POINTS_PER_TASK: usize = 64;

/// Number of independent partial sums of a scalar product.
pub(crate) const PARTIAL_SUMS: usize = 8;

/// Smallest number of grid points for which a Chebyshev fit is tried. A fit needs about as many
/// nodes.
pub(crate) const MIN_FIT_POINTS: usize = 1000;

/// Largest time of a fit with its sums at all points, as a fraction of the time of the exact field.
/// It is below 1 because operations are counted instead of measured.
pub(crate) const LARGEST_FIT_COST: f64 = 0.8;

/// Largest time of fits of parts of a grid that fail, as a fraction of the time of the exact field
/// at all of its points. A larger fraction finds more fits beside tiles.
pub(crate) const LARGEST_TRIAL_COST: f64 = 0.1;

/// Time for a charge or dipole in the bound of the truncation error of a fit along one axis, in
/// exact fields of one tile: its distance, and some five powers.
pub(crate) const SOURCE_COST: f64 = 20.0;

/// Number of exact fields before the bound of the truncation error: for the smallest |B| in the
/// box, [`RANGE_POINTS`] along each axis, and for the rounding at its corners.
pub(crate) const FIELD_RANGE_POINTS: f64 = (RANGE_POINTS * RANGE_POINTS * RANGE_POINTS + 8) as f64;

/// Time to begin the sums of a fit in a plane of constant x and on a line along z, in exact fields
/// of one tile. It exceeds the time of the sums in grids with few points along z.
pub(crate) const PLANE_COST: f64 = 100.0;
/// See [`PLANE_COST`].
pub(crate) const LINE_COST: f64 = 10.0;

/// Smallest relative tolerance for which a fit is tried. A fit of 8 nodes along each axis amplifies
/// the bound of the exact field 12 times, and the magnitudes of the fields of several tiles add up
/// to a multiple of |B|.
pub(crate) const MIN_FIT_FRACTION: f64 = 50.0 * EXACT_BOUND;

/// Time of the transform from values at nodes to coefficients, for each node, in exact fields of
/// one tile.
pub(crate) const NODE_TRANSFORM_COST: f64 = 6.0;

/// Smallest number of points per node, estimated from the distances of tiles, for a fit of a list.
/// The estimate has fewer nodes than the fit needs. A box that needs still more is sampled in vain.
pub(crate) const POINTS_PER_EXPECTED_NODE: usize = 12;

/// Largest number of nodes along an axis. A box that needs more is divided.
pub(crate) const MAX_FIT_NODES: usize = 64;

/// Slowest decay from one coefficient to the next for which a box is fitted. A slower decay needs
/// more than [`MAX_FIT_NODES`] nodes.
pub(crate) const MAX_DECAY: f64 = 0.95;

/// Bound of the truncation error of a fit, as a fraction of its allowed error. The rest is for
/// rounding, and for points with a weaker field than the points sampled for |B|.
pub(crate) const TRUNCATION_SHARE: f64 = 0.75;

/// Assumed growth of the rounding error when it requires more nodes.
pub(crate) const LARGER_ROUNDING: f64 = 1.2;

/// Smallest target of the truncation error of a fit, as a fraction of the allowed error. Below it
/// rounding would take nearly all of the allowed error.
pub(crate) const MIN_TRUNCATION_SHARE: f64 = 0.1;

/// Number of points along each axis of a box, including its ends, in the search for the smallest
/// |B|.
pub(crate) const RANGE_POINTS: usize = 5;

/// Number of patches of a face, in the bound of the truncation error, along a side as long as the
/// distance of its tile from the box. With half as many, the bound requires one more node along an
/// axis.
pub(crate) const PATCHES_PER_DISTANCE: f64 = 2.0;

/// Largest number of patches of a face along each of its sides.
pub(crate) const PATCHES: f64 = 6.0;

/// Factor of a tile's moment that must be below its charges times their distance for dipoles to
/// replace charges in the bound of the truncation error. The bound of a coefficient of degree k
/// grows by about k over the distance with each derivative.
pub(crate) const DIPOLE_DEGREE: f64 = 16.0;

/// Largest rounding error of a coordinate of a node and of a point relative to it, as a fraction of
/// the coordinate plus half the box: at most four roundings.
pub(crate) const NODE_ROUNDING: f64 = 2.0 * f64::EPSILON;

/// Largest difference between a tile and its mirror image, as a fraction of the smaller of the tile
/// and its distance, for which their fields count as mirror images. The difference enters the
/// error.
pub(crate) const MIRROR_ROUNDING: f64 = 3e-14;

/// Largest number of tiles in a search for mirror images. The time of the search grows with the
/// square of that number.
pub(crate) const MAX_MIRRORED_TILES: usize = 4096;

/// Smallest |B| in a box, as a fraction of the largest, for which nodes are added. Points with a
/// weaker field use direct summation.
pub(crate) const MIN_FIELD_SHARE: f64 = 1e-2;

/// Degree of the field in a cell. A lower degree needs more cells, which exceed the second cache
/// and have fewer points each. A higher degree takes longer at each point.
pub(crate) const CELL_DEGREE: usize = 9;

/// Assumed exponent of the truncation error of a cell as a function of its size. Only small cells
/// reach the exponent of the next degree, 10.
pub(crate) const CELL_ERROR_EXPONENT: f64 = 7.0;

/// Largest number of cells of a box. They take 22 MB.
pub(crate) const MAX_CELLS: usize = 8192;

/// Maximum number of reductions of the cell size until the error is small enough.
pub(crate) const MAX_CELL_ROUNDS: usize = 12;

/// Largest number of nodes of the fit of a [`FittedField`](crate::FittedField).
pub(crate) const MAX_FITTED_FIELD_NODES: usize = 200_000;

/// Smallest and largest number of points sorted by cell at a time. Among more points, more share
/// the coefficients of a cell.
pub(crate) const POINTS_PER_LOOK_UP: [usize; 2] = [1 << 10, 1 << 16];
