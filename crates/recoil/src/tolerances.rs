//! Tolerances and tuning constants.

/// Largest number of cells of one solution. The 96 768 cells of the published film at level 12 take
/// 2.5 GB and 86 s of one core with a permeability of 1.2; 102 400 cells of a board of 40 x 40
/// cubes take 1.5 GB and 37 s.
pub const MAX_CELLS: usize = 120_000;

/// Largest number of cells for tensors of all pairs, times the root of the number of images of each
/// cell in mirror planes. A tree has the tensors of a quarter of the pairs of 1500 cells, and of
/// about a third of the pairs of this number of cells, where its savings equal the time of its
/// expansions.
pub const MOST_CELLS_OF_TENSORS: usize = 1_000;

/// Flux density of the images between two planes of iron that may be left out, in tesla. It
/// changes polarizations by at most the susceptibility times it: a millionth of a typical change.
pub(crate) const NEGLIGIBLE_T: f64 = 1e-6;

/// Largest difference of a tile and the image of another in a mirror plane, in units of the extent
/// of all tiles and of the largest polarization. It is above the rounding of coordinates and below
/// any intended difference.
pub(crate) const MIRROR_ERROR: f64 = 1e-12;

/// Largest memory of the tensors and expansions of a tree, in bytes. The rest of 4 GiB is for the
/// cells, the vectors of the iteration and the field computed from them.
pub(crate) const MOST_BYTES: usize = 3 << 30;

/// Error of the tensors of near pairs beside a tree, relative to their norm.
pub(crate) const NEAR_TENSOR_ERROR: f64 = 3e-7;

/// Unit to which lengths of near pairs are rounded, in sides of the cube of all cells. It is above
/// the rounding of coordinates, and a millionth of the smallest useful sides of cells.
pub(crate) const CACHED_LENGTH: f64 = 1e-12;

/// Largest number of tensors kept by one thread, in 150 MB.
pub(crate) const CACHED_TENSORS: usize = 1_000_000;

/// Largest permeability with a tree. The permeability multiplies the error of the sums,
/// [`TREE_ERROR`].
pub const MOST_PERMEABILITY_OF_TREE: f64 = 100.0;

/// Residual at which the iteration ends, relative to the residual at the start. The error of the
/// tensors is [`TENSOR_ERROR`](magsplice_pair::tolerances::TENSOR_ERROR).
pub(crate) const RESIDUAL: f64 = 1e-12;

/// [`RESIDUAL`] with a tree, whose sums have the error [`TREE_ERROR`].
pub(crate) const RESIDUAL_OF_TREE: f64 = 1e-8;

/// Root mean square error of the sums over the cells by a tree, relative to the root mean square of
/// the sums. Measured against all tensors, it is 5e-6 to 1.3e-5 for boards, designed films and a
/// cube of 1500 to 4400 cells. The error of B outside is 4e-6 of its change by the permeability.
pub const TREE_ERROR: f64 = 1e-5;

/// Largest number of iterations. A permeability of 1.2 needs ten, [`crate::MAX_PERMEABILITY`] about
/// a thousand.
pub(crate) const MOST_ITERATIONS: usize = 5_000;
