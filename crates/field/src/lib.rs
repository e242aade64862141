//! The magnetic field of uniformly magnetized cuboids, one or thousands, correct to the last digits at every point.
//!
//! * [`Tile`]: a cuboid with position, size, polarization and rotation.
//! * [`Scene`]: tiles together; B, H and J at a point or at many points in parallel.
//! * [`Accuracy`]: exact, or as cheap as a tolerance allows; [`Plan`]: by which models; [`FittedField`]: a box prepared for repeated look-ups.
//! * [`PolarizationMap`]: the field at given points as a linear map of the tiles' polarizations.
//! * [`FaceSlopes`]: how the field changes as the faces of a tile move.
//! * [`IdealFilm`]: the sinusoidally magnetized film a spliced film stands in for (Dai 2024, Eqs. 1 and 2).
//! * [`Comparison`]: how far one field is from another.
//! * [`Grid`]: regular points.
//!
//! Lengths are in any one unit: the field depends on their ratios only. This crate knows no files, no text formats, and prints
//! nothing.
//!
//! ```
//! use glam::DVec3;
//! use magsplice_field::{Quantity, Scene, Tile};
//!
//! let cube = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::new(0.0, 0.0, 1.2)).unwrap();
//! let scene = Scene::new(&[cube]);
//! // At the centre of a cube the demagnetizing factors are one third each.
//! let b = scene.field(Quantity::FluxDensity, DVec3::ZERO).unwrap();
//! assert!((b.z - 0.8).abs() < 1e-15);
//! // On an edge the field is unbounded, and the answer says so.
//! assert!(scene.field(Quantity::FluxDensity, DVec3::new(0.5, 0.0, 0.5)).is_err());
//! ```

// Rules are written as `!(x <= limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod arrangement;
mod batch;
mod block;
mod compare;
mod edge_policy;
mod evaluate;
mod face_slopes;
mod grid;
mod ideal;
mod kernel;
mod merge;
mod orientation;
mod overlap;
mod polarization_map;
mod quantity;
mod scene;
mod seam;
mod tile;
mod tolerances;
mod two_sum;
mod within;

pub use batch::instruction_set::{InstructionSet, MissingInstructions};
pub use compare::{Comparison, ComparisonError};
pub use evaluate::{PointError, PointErrors};
pub use face_slopes::FaceSlopes;
pub use grid::Grid;
pub use ideal::{IdealFilm, IdealFilmFault};
pub use overlap::{Overlap, overlap, overlaps};
pub use polarization_map::{PolarizationMap, PolarizationMapError};
pub use quantity::{MU_0, Quantity};
pub use scene::{Cause, Scene};
pub use tile::{Tile, TileFault, TileFaults};
pub use tolerances::{MAX_LENGTH, MAX_POLARIZATION_T, MIN_ASPECT, MIN_SIZE, UNIT_NORM_TOLERANCE};
pub use within::accuracy::{Accuracy, InvalidTolerance, Tolerance};
pub use within::fitted_field::{FittedField, FittedFieldError, LookUpError};
pub use within::plan::{Model, Plan, PlannedPart};
