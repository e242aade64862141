//! Magnets and the points of their field.
//!
//! * [`Tile`]: a uniformly magnetized cuboid with position, size, polarization and rotation.
//! * [`TileError`], [`PerTileError`]: the twelve errors with which a tile is made.
//! * [`overlaps`]: the pairs of tiles that share volume.
//! * [`Grid`]: regular points.
//! * [`Quantity`]: B, H or J.
//! * [`Permeability`]: how the polarization of a magnet follows the field.
//! * [`Accuracy`]: exact, or within a [`Tolerance`].
//! * [`PointErrors`]: the points at which a field does not exist, and why.
//! * [`BoundingBox`]: a box with sides along the axes.
//! * [`HallSensor`]: the sensor that reads the field.
//! * [`IronPlanes`]: flat iron around tiles, and their images in it.
//! * [`Deformation`]: films that are shifted, turned and bent.
//!
//! # Units
//! Lengths are in any one unit, the same for tiles and points: a field depends on their ratios
//! only. Polarization and flux density are in tesla, field strength in ampere per metre.
//!
//! # Features
//! * `serde` (off by default): `Serialize` and `Deserialize` for [`Tile`], [`Grid`], [`Quantity`],
//!   [`Accuracy`], [`Tolerance`], [`Axis`], [`TileError`] and [`PerTileError`]. Deserialized values
//!   obey the rules of their constructors.
//!
//! This crate computes no field, reads no files and prints nothing.

// Rules are written as `!(x <= limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// Exact evaluation, or a tolerance.
mod accuracy;
/// The axes x, y, z.
mod axis;
/// Boxes with sides along the axes.
mod bounding_box;
/// Films that are shifted, turned and bent.
mod deformation;
/// Regular grids of points.
mod grid;
/// Three-axis Hall sensors.
mod hall_sensor;
/// Heights over a plane.
mod height_map;
/// A flat half space of iron, and the image of a tile in it.
mod iron_plane;
/// The iron around tiles, and their images between its planes.
mod iron_planes;
/// Corners and outlines of tiles.
mod outline;
/// Pairs of tiles that share volume.
mod overlap;
/// The recoil permeability of magnets.
mod permeability;
/// Identical pieces among tiles.
mod pieces;
/// Points without a field, and the reason.
mod point_error;
/// Field quantities and the vacuum permeability.
mod quantity;
/// The images of tiles by the field of the tiles themselves.
mod reflection;
/// Tests of serialized values.
#[cfg(all(test, feature = "serde"))]
mod serde_tests;
/// The uniformly magnetized cuboid and the rules it obeys.
mod tile;
/// The errors of a tile, and a value for each.
mod tile_error;
/// Limits on tiles, and the round-off that geometry tolerates.
pub mod tolerances;

pub use accuracy::{Accuracy, InvalidTolerance, Tolerance};
pub use axis::Axis;
pub use bounding_box::BoundingBox;
pub use deformation::{Bend, Deformation, DeformationError};
pub use grid::{Grid, GridFault};
pub use hall_sensor::{GAIN_MAGNITUDES, HallSensor, HallSensorFault, MAX_SENSOR_ERROR_T};
pub use height_map::{HeightMap, HeightMapError, InvalidHeightMap};
pub use iron_plane::{IronPlane, IronPlaneFault};
pub use iron_planes::{IronPlanes, IronPlanesFault, TileBehindPlane, TileImages};
pub use outline::convex_hull;
pub use overlap::{Overlap, TooManyPairs, box_overlap, overlap, overlaps, overlaps_among};
pub use permeability::{InvalidPermeability, MAX_PERMEABILITY, Permeability};
pub use pieces::{Piece, pieces};
pub use point_error::{PointError, PointErrorCause, PointErrors, is_in_range};
pub use quantity::{MU_0, Quantity};
pub use reflection::Reflection;
pub use tile::{Tile, TileFault, TileFaults};
pub use tile_error::{DirectionError, PerTileError, TileError};
pub use tolerances::{MAX_LENGTH, MAX_POLARIZATION_T, MIN_ASPECT, MIN_SIZE, UNIT_NORM_TOLERANCE};
