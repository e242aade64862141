//! Direct summation: every tile at every point, to the last digits.

/// Points divided into batches for threads.
pub(crate) mod batches;
/// The gradient of the tiles of a cluster, in vectors.
mod cluster_gradient;
/// The closed form of the tiles of a cluster, in vectors.
mod cluster_kernel;
/// Coordinates of a batch of points, by axis.
mod coordinates;
/// Prepared tiles with the vector instructions: the exact field.
pub(crate) mod direct_sum;
/// Edges on which the field is unbounded.
mod edges;
/// The stated error of the exact field.
mod error_bounds;
/// The far field of a cluster, as a tree provides it.
pub(crate) mod far_field;
/// The gradient summed over tiles at a batch of points.
pub(crate) mod gradient_sum;
/// Upper bounds of the sum of magnitudes over tiles.
mod magnitude;
/// The scalar kernel at points in and close to a tile.
mod near_field;
/// Points that wait for vectors of one method.
mod queues;
/// Points in their order, in runs of one method.
mod runs;
/// The only tile of a scene.
mod single_tile;
/// Indices of points sorted by method.
mod sorted_points;
/// The sum over tiles at a batch of points.
pub(crate) mod sum;
/// Compensated sums at a batch of points.
mod totals;
