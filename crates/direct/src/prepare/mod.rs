//! Tiles grouped into frames and clusters: the geometry of a scene before any field is computed.

/// Tiles in a row with one component of J, as fewer and longer cuboids.
mod bars;
/// The distances at which each method of a cluster reaches the error bound.
pub mod cluster_methods;
/// Neighbouring tiles of a frame, prepared for many points.
pub mod clusters;
/// Corners and planes shared by the tiles of a cluster.
pub mod corner_tables;
/// Tiles with a common orientation.
pub mod frames;
/// Tiles of one polarization that form a cuboid.
pub mod merge;
/// Rotations that share a frame or an axis.
pub mod orientation;
/// Faces that differ by round-off.
mod seam;
/// The elements of a tile in the tables of its cluster.
pub mod tile_terms;
