//! The exact field of many uniformly magnetized cuboids, summed over every tile at every point.
//!
//! [`DirectSum`](direct_sum::DirectSum) prepares tiles once: tiles of one orientation share a
//! frame, and neighbouring tiles share tables of corners. It then sums B, H or the gradient at
//! batches of points in vectors. `magsplice-field` uses it for trees and interpolation.
//!
//! The error of a field is at most
//! [`EXACT_BOUND`](magsplice_cuboid::tolerances::EXACT_BOUND) of the sum of magnitudes over tiles.
//! Lengths are in any one unit, polarization and B in tesla, H in ampere per metre.

// Rules are written as `!(x <= limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// Points divided into batches for threads.
pub mod batches;
/// The gradient of the tiles of a cluster, in vectors.
mod cluster_gradient;
/// The closed form of the tiles of a cluster, in vectors.
mod cluster_kernel;
/// Coordinates of a batch of points, by axis.
mod coordinates;
/// The time of the exact field, by counted operations.
mod cost;
/// Tiles prepared for the exact field.
pub mod direct_sum;
/// Edges on which the field is unbounded.
mod edges;
/// The error bound of the exact field.
mod error_bounds;
/// The far field of a cluster within a tolerance.
pub mod far_field;
/// The gradient summed over tiles at a batch of points.
pub mod gradient_sum;
/// Compensated sums of gradients at a batch of points.
mod gradient_totals;
/// The field that keeps a tolerance.
pub mod least_field;
/// Upper bounds of the sum of magnitudes over tiles.
pub mod magnitude;
/// The scalar kernel at points in and close to a tile.
mod near_field;
/// Points of several tiles whose field may be too weak for a tolerance.
pub mod open_points;
/// Tiles grouped into frames and clusters.
pub mod prepare;
/// Queues of points that share a method.
pub mod queues;
/// Runs of consecutive points with one method.
mod runs;
/// The only tile of a scene.
mod single_tile;
/// Indices of points sorted by method.
mod sorted_points;
/// The sum over tiles at a batch of points.
pub mod sum;
/// Tolerances and tuning constants.
pub mod tolerances;
/// Compensated sums at a batch of points.
mod totals;
/// Points of a single tile whose field may be too weak for a tolerance.
mod weak_points;
/// The exact field where it keeps a tolerance.
mod within_tolerance;
