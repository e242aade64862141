//! Tolerances and tuning constants of many cuboids, each with what it trades.

use magsplice_cuboid::tolerances::EXACT_BOUND;

/// Along a rotated axis, a point closer to a face than this many units of round-off of its distance from the axis's origin
/// lies on the face: its coordinate is no better known.
pub(crate) const POINT_ROUNDINGS: f64 = 4.0;

/// Directions are looked up in cells of this width; any width far above `SAME_ROTATION` does.
pub(crate) const DIRECTION_CELL: f64 = 1e-9;

/// At a shared edge the logarithmic terms of several tiles cancel to this fraction, or the field is unbounded there.
///
/// What is left of a cancelled term is multiplied by ln(2^-240) = -166, so 1e-14 stays at round-off of the polarization.
pub(crate) const EDGE_CANCELLATION: f64 = 1e-14;

/// Edges whose unit directions differ by no more than this run together. Far above round-off, far below any angle meant.
pub(crate) const SAME_RAY: f64 = 1e-9;

/// What an expansion of degree p takes for (p + 2) (p + 3), in the same unit: six sums and three operations for the recurrence, of half as many terms.
pub(crate) const NODE_COST: f64 = 4.5;

/// The same of a flat film: half of the sums.
pub(crate) const FLAT_NODE_COST: f64 = 3.0;

/// What a translation leaves out, as a fraction of what its node's own expansion may. The more, the lower the degree around the middle, but the less is left for all others:
/// between 0.1 and this, times differ by about 1 %.
pub(crate) const TRANSLATED_SHARE: f64 = 0.25;

/// The round-off of an item is not found more closely than to this fraction of what a node may leave out.
pub(crate) const CERTAIN_SHARE: f64 = 1e-3;

/// Fewer points are not worth a translation: each takes as much as the expansion at so many.
pub(crate) const TRANSLATED_POINTS: usize = 32;

/// How far the spheres on which the field of a translated node is bounded stay from its centre, in its radii: the farther, the weaker the field on them; the nearer,
/// the larger the sphere, and the lower the degree. The best of them is taken.
pub(crate) const SPHERE_GAPS: [f64; 4] = [1.0, 1.4, 2.0, 3.0];

/// A node of the tree is not asked for its moments nearer than this many of its radii: no degree would do.
pub(crate) const NEAREST_NODE: f64 = 1.2;

/// Degrees beyond the binary logarithm of a tolerance, for the factors that grow with the degree.
pub(crate) const ADDED_DEGREES: f64 = 16.0;

/// Degrees of a tree, at least.
pub(crate) const LEAST_DEGREE: usize = 6;

/// Points of a list that are sorted together, at most: 400 MB of copies.
pub(crate) const POINTS_TOGETHER: usize = 1 << 22;

/// The box around a list of fewer points is not expanded to look them up,
pub(crate) const LOOKED_UP_POINTS: usize = 20_000;

/// nor if there are fewer tiles, which exactly take no longer than to look a point up,
pub(crate) const LOOKED_UP_TILES: usize = 24;

/// nor by more exact values than one for so many points.
pub(crate) const POINTS_PER_FITTED_NODE: usize = 4;

/// Of fewer tiles the exact field takes no longer than to sort points into batches.
pub(crate) const TREE_TILES: usize = 64;

/// Points that one thread serves one after the other, at least and at most: what may be left out at the first of them is estimated, at others told from those
/// before; those with a weak field are served together again.
pub(crate) const POINTS_PER_ROUND: [usize; 2] = [256, 2048];

/// So many rounds are shared out among threads evenly, where there are points enough.
pub(crate) const ROUNDS_TO_SHARE: usize = 64;

/// Of these the points that parts of a tree are assigned to together: more share the choice, fewer lie closer together, leave more of the tiles far away, and
/// need lower degrees of expansions.
pub(crate) const ASSIGNED_POINTS: usize = 128;

/// One of so many points may have a field too weak for what is left out, and is served again. Each of these takes as long as five others; to halve their
/// number takes 3 % more for all.
pub(crate) const POINTS_PER_WEAK: usize = 32;

/// Of these the points at which the field is found roughly first.
pub(crate) const SAMPLED_POINTS: usize = 16;

/// What the first rough field may leave out, as a fraction of the largest J.
pub(crate) const ROUGH_FIELD_OVER_J: f64 = 1e-3;

/// Nodes among which it is divided, where nothing better is known.
pub(crate) const ROUGH_NODES: f64 = 16.0;

/// What nodes leave out at a point of what each may, on average: the point is farther away than the nearest, and degrees are whole numbers.
pub(crate) const USED_SHARE: f64 = 0.5;

/// What is left out at the next points may be so many times the mean over those before,
pub(crate) const LEFT_OUT_OVER_MEAN: f64 = 1.6;

/// and so many times what each node may leave out more.
pub(crate) const LEAST_SHARES: f64 = 2.0;

/// A rough field must be so many times what it leaves out.
pub(crate) const CLEAR_OF_ERROR: f64 = 4.0;

/// Where it is not, at most this fraction may be left out the next time.
pub(crate) const ROUGH_STEP: f64 = 1e-2;

/// Of the tolerance, what may be left out at the weakest of some points: between them the field may be weaker.
pub(crate) const SAFE_SHARE: f64 = 0.7;

/// Tries, after which points get the exact field.
pub(crate) const ASSIGNMENT_ROUNDS: usize = 4;

/// The distance from which an expansion serves is found to this many halvings of the way across the points.
pub(crate) const DISTANCE_BISECTIONS: usize = 8;

/// Of so many tiles at most each one's distances are taken at its corners to bound what an expansion leaves out, of more at the farthest only.
pub(crate) const CORNERED_TILES: usize = 64;

/// To a tolerance the closed form of tiles together goes so many times farther than [`CLOSED_FORM_REACH`]: its error grows with that ratio.
pub(crate) const STRETCH: f64 = 2.0;

/// The error of what a tree leaves to the exact field, as [`EXACT_BOUND`].
pub(crate) const STRETCHED_BOUND: f64 = STRETCH * EXACT_BOUND;

/// Then four groups of at most so many tiles share a division: products of 12 lengths for each, between 1 / [`PRODUCT_RANGE`] and this, stay in range.
pub(crate) const SMALL_GROUP: usize = 4;

/// Tiles whose terms are multiplied before one logarithm or arctangent is taken. More share it among more, but their total angle must stay
/// below half a turn, which keeps points away from them.
pub(crate) const TILES_PER_GROUP: usize = 16;

/// The total half angle of a group stays below 2.5 from a distance d of this multiple of the cube root of its volume V: whatever the tiles, they
/// lie beyond a plane, so the angle is at most the integral of dV / r^3 over the cap of a ball with that volume,
/// 2 pi (ln(R / d) - 1 + d / R), which for V = 24 d^3 is 2.5.
pub(crate) const GROUP_DISTANCE: f64 = 0.35;

/// A group takes no more volume than lets points come this close, in units of the thickest tile's thickness.
pub(crate) const GROUP_THICKNESSES: f64 = 2.0;

/// Distances from tiles that are multiplied together, scaled to their size, lie between 1 / this and this, so that products of
/// 12 lengths for each tile of a group stay in range.
pub(crate) const PRODUCT_RANGE: f64 = 16.0;

/// Tiles that share tables of corners, at most. Large enough to share most corners, small enough for the tables to stay in the first caches.
pub(crate) const TILES_PER_CLUSTER: usize = 64;

/// Of more that are long a tree takes the halves: their spheres are smaller, so that expansions serve nearer to them.
pub(crate) const TILES_PER_ITEM: usize = 32;

/// That pays where the radius of the halves is at most this fraction of the whole's: for rows and for rectangles of 3 : 2 and longer. Halves of a square would have
/// four fifths, and be twice as many nodes.
pub(crate) const HALVED_RADIUS: f64 = 0.7;

/// So many neighbours in a tree get their expansions together: what the longest vectors hold.
pub(crate) const ITEMS_EXPANDED: usize = 8;

/// Lengths of those tables; powers of two. Tiles that need longer ones are divided further.
pub(crate) const MOST_CORNERS: usize = 512;

/// See [`MOST_CORNERS`].
pub(crate) const MOST_PLANES: usize = 128;

/// See [`MOST_CORNERS`].
pub(crate) const MOST_GROUPS: usize = 256;

/// Shapes whose multipole series are kept, 10 kB each. In a scene with more they are made when needed.
pub(crate) const KEPT_SERIES: usize = 4096;

/// Points that one thread takes at a time, at least and at most: small enough to share out 405 points, large enough for full vectors of each
/// form, small enough for the first caches.
pub(crate) const POINTS_PER_BATCH: [usize; 2] = [64, 512];

/// Points of a scene of one tile that one thread takes at a time, at most: each form's last vectors are not full.
pub(crate) const POINTS_OF_ONE_TILE: usize = 8192;

/// Of these the points whose forms are found together: so many that most forms have full vectors, so few that their queues stay in the first caches.
pub(crate) const STREAMED_POINTS: usize = 256;

/// How many points ahead memory is asked for: longer than it takes to come, and short of what the second cache holds.
pub(crate) const FETCHED_AHEAD: usize = 512;

/// Points are brought together by form unless, as they lie, at most one pair of vectors of so many has points of several forms: each of these is
/// then served once for each form.
pub(crate) const MIXED_SHARE: usize = 4;

/// Scenes divided into at least so many parts have the points of a batch chosen so that they lie together and one form serves most parts at
/// all of them.
pub(crate) const REGROUPED_PARTS: usize = 100;

/// Points among which the neighbours are chosen: a megabyte of copies.
pub(crate) const REGROUPED_POINTS: usize = 16_384;

/// Batches for each thread, where there are points enough: the more, the more evenly they are shared out.
pub(crate) const BATCHES_PER_THREAD: usize = 8;

/// From so many half diagonals on the field of a tile counts as that of dipoles on their axis, as near as its nearest point: at most 2 (1 + 1 / 4)^3 = 4 times too
/// large.
pub(crate) const DIPOLE_DISTANCE: f64 = 4.0;

/// Points that one thread takes at a time when a [`PolarizationMap`](crate::PolarizationMap) is applied: to share them out costs less than they do.
pub(crate) const POINTS_PER_TASK: usize = 64;

/// Sums of a scalar product that do not wait for each other.
pub(crate) const CHAINS: usize = 8;

/// Chebyshev expansions are not tried for fewer points: their nodes would be as many.
pub(crate) const FITTED_POINTS: usize = 1000;

/// An expansion is made if it serves at least so many points for each exact value it takes.
pub(crate) const POINTS_PER_NODE: usize = 2;

/// Nodes along an axis, at least, so that the fall of the coefficients can be seen.
pub(crate) const LEAST_NODES: usize = 6;

/// Nodes along an axis, at most: a box that needs more is divided.
pub(crate) const MOST_NODES: usize = 64;

/// How often the number of nodes is raised until the estimate of the error is small enough.
pub(crate) const FIT_ROUNDS: usize = 4;

/// What each axis of an expansion may leave out, as a fraction of the error wanted: a quarter is for rounding.
pub(crate) const SHARE_OF_AXIS: f64 = 0.25;

/// Coefficients are not assumed to fall faster than by this from one to the next, whatever the last ones do,
pub(crate) const LEAST_DECAY: f64 = 0.1;

/// nor is a tail summed that falls more slowly than this.
pub(crate) const MOST_DECAY: f64 = 0.95;

/// Points of a box at which an expansion is compared with the exact field before it is used.
pub(crate) const CHECKED_POINTS: usize = 24;

/// Where |B| is below this fraction of its most in a box, points get the exact field rather than the box more nodes.
pub(crate) const LOWEST_FIELD_SHARE: f64 = 1e-2;

/// The degree of the field in a cell. Lower ones make more cells, which no longer fit the second cache and get fewer points each; higher ones take longer
/// for each point.
pub(crate) const CELL_DEGREE: usize = 9;

/// What a cell leaves out falls with its size to this power, as a first guess: that of the next degree, 10, is reached only by small cells.
pub(crate) const CELL_FALL: f64 = 7.0;

/// Cells of a box, at most: 22 MB.
pub(crate) const MOST_CELLS: usize = 8192;

/// How often cells are made smaller until their error is small enough.
pub(crate) const CELL_ROUNDS: usize = 12;

/// Exact values for a box to be looked up in, at most.
pub(crate) const MOST_FITTED_NODES: usize = 200_000;

/// Points sorted by cell together, at least and at most: the more, the more share a cell's coefficients.
pub(crate) const LOOKED_UP_TOGETHER: [usize; 2] = [1 << 10, 1 << 16];
