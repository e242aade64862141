//! Tolerances and tuning constants.

/// Most cells of one solution. The 96 768 cells of the published film at level 12 take 2.5 GB and
/// 86 s of one core with a permeability of 1.2; 102 400 cells of a board of 40 x 40 cubes take 1.5
/// GB and 37 s.
pub const MAX_CELLS: usize = 120_000;

/// Most cells whose pairs all have their tensors, times the root of the number of images of each
/// cell in mirror planes. A tree has the tensors of a quarter of the pairs of 1500 cells, and of
/// about a third of those of this many; what it saves is what its expansions cost.
pub const MOST_CELLS_OF_TENSORS: usize = 1_000;

/// Largest difference of a tile and the image of another in a mirror plane, in lengths of all tiles
/// and in the largest polarization. It is above the rounding of coordinates and below any
/// difference that is meant.
pub(crate) const MIRROR_ERROR: f64 = 1e-12;

/// Most memory that the tensors and expansions of a tree may take, in bytes. The rest of 4 GiB is
/// for the cells, the vectors of the iteration and the field that is computed from them.
pub(crate) const MOST_BYTES: usize = 3 << 30;

/// Error of the tensors of near pairs beside a tree, relative to their norm.
pub(crate) const NEAR_TENSOR_ERROR: f64 = 3e-7;

/// Unit to which lengths of near pairs are rounded, in sides of the cube of all cells. It is above
/// the rounding of coordinates, and a millionth of the smallest sides of cells that are of use.
pub(crate) const CACHED_LENGTH: f64 = 1e-12;

/// Most tensors that one thread keeps, in 150 MB.
pub(crate) const CACHED_TENSORS: usize = 1_000_000;

/// Largest permeability with a tree. It multiplies the error of the sums, [`TREE_ERROR`].
pub const MOST_PERMEABILITY_OF_TREE: f64 = 100.0;

/// Residual of the iteration, relative to that at the start, at which it ends. The tensors are
/// known to no more than [`TENSOR_ERROR`](magsplice_pair::tolerances::TENSOR_ERROR).
pub(crate) const RESIDUAL: f64 = 1e-12;

/// [`RESIDUAL`] with a tree, whose sums are known to no more than [`TREE_ERROR`].
pub(crate) const RESIDUAL_OF_TREE: f64 = 1e-8;

/// Error of the sums over the cells by a tree, in the root mean square, relative to that of the
/// sums. Measured against all tensors: 5e-6 to 1.3e-5 for boards, designed films and a cube of 1500
/// to 4400 cells. B outside is right to 4e-6 of what the permeability changes.
pub const TREE_ERROR: f64 = 1e-5;

/// Most iterations. For a permeability of 1.2 ten are needed, for [`crate::MAX_PERMEABILITY`] about
/// a thousand.
pub(crate) const MOST_ITERATIONS: usize = 5_000;
