//! Self-consistent magnetization of cuboid tiles with a linear recoil line.
//!
//! The polarization of a tile is J = J_r + chi mu0 H, chi = mu_r - 1. H is the field of all tiles,
//! including its own demagnetizing field.
//!
//! * [`RecoilTile`]: a tile with its polarization J_r and its [`Permeability`].
//! * [`Magnetization`]: the polarization of cells, consistent with their field.
//! * [`DemagnetizedCell`]: a cell beyond the knee of the demagnetization curve.
//! * [`TileChange`]: the mean polarization of a tile, its weakening and its turn.
//! * [`refine`]: finer divisions until a quantity is known to a tolerance.
//!
//! # Accuracy
//! For few cells the tensors of all pairs are computed, with an error of
//! [`TENSOR_ERROR`](magsplice_pair::tolerances::TENSOR_ERROR), and the equations are solved to
//! round-off. For many, pairs of distant cells interact by multipole expansions, with an error of
//! [`tolerances::TREE_ERROR`]. The division into cells is the remaining error. [`refine`] estimates
//! it for the requested quantity. The estimate is no bound: its constants were fitted to the values
//! of the tests.
//!
//! # Example
//! ```
//! use glam::DVec3;
//! use magsplice_field::{Quantity, Scene};
//! use magsplice_magnet::{IronPlanes, Tile};
//! use magsplice_recoil::{Permeability, RecoilTile, RefinementSettings, refine};
//!
//! let permeability = Permeability::isotropic(1.05)?;
//! let beside = |x: f64, j_t: f64| -> Result<RecoilTile, Box<dyn std::error::Error>> {
//!     let tile = Tile::new(DVec3::new(x, 0.0, 0.0), DVec3::ONE, DVec3::new(0.0, 0.0, j_t))?;
//!     Ok(RecoilTile { tile, permeability })
//! };
//! let tiles = [beside(0.0, 1.3)?, beside(1.0, -1.3)?];
//! let below = [DVec3::new(0.0, 0.0, -2.0)];
//! let b_t = |tiles: &[Tile]| match Scene::new(tiles).field_at(Quantity::FluxDensity, &below) {
//!     Ok(field) => field[0].to_array().to_vec(),
//!     Err(_) => vec![f64::NAN; 3],
//! };
//! let settings = RefinementSettings { tolerances: vec![1e-4; 3], most_cells: 1_000, iron: IronPlanes::default() };
//! let refined = refine(&tiles, &settings, b_t, |_| {})?;
//! assert!(refined.errors.iter().all(|error_t| *error_t <= 1e-4));
//! assert!(refined.magnetization.tile_changes()[0].weakening > 0.005);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Units
//! Lengths are in any one unit, polarizations in tesla. This crate reads no files and prints
//! nothing.

// Rules are written as `!(x <= limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// Tiles divided into cells.
mod cells;
/// A set of tiles divided into cells.
mod division;
/// Errors of the polarization.
mod error;
/// The sums of the mean tensors of all pairs in time proportional to the number of cells.
mod fast_sum;
/// The polarization to first order in the susceptibility.
mod first_order;
/// Cells beyond the knee of the demagnetization curve.
mod knee;
/// Cells with their polarization.
mod magnetization;
/// Magnets with a linear recoil line.
mod material;
/// The sums of the mean tensors of all pairs of cells.
mod pair_sums;
/// The mean tensors of all pairs of cells.
mod pair_tensors;
/// Levels of division until a quantity is known to a tolerance.
mod refinement;
/// The polarization of cells, consistent with their field.
mod solver;
/// Mirror planes of tiles.
mod symmetry;
/// Tolerances and tuning constants.
pub mod tolerances;

pub use cells::{cell_count, cell_counts, cells};
pub use error::RecoilError;
pub use knee::DemagnetizedCell;
pub use magnetization::{Magnetization, TileChange};
pub use magsplice_magnet::{InvalidPermeability, MAX_PERMEABILITY, Permeability};
pub use material::RecoilTile;
pub use refinement::{
    Group, Refined, RefinementError, RefinementSettings, extrapolated_at, highest_level, refine, refine_within,
};
