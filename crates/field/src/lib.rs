//! The magnetic field of one to thousands of uniformly magnetized cuboids, exact at every point.
//!
//! * [`Scene`]: B, H, J and gradients of tiles, at a point or at many points in parallel, exact or
//!   within a tolerance.
//! * [`IronPlanes`]: flat iron around the tiles, see [`Scene::with_planes`].
//! * [`Plan`]: the models that a tolerance uses, with their errors and costs.
//! * [`FittedField`]: a box prepared for repeated look-ups.
//! * [`PolarizationMap`]: the field at fixed points as a linear map of the tiles' polarizations.
//! * [`InstructionSet`]: the vector instructions of the processor.
//!
//! # Units
//! Lengths are in any one unit: the field depends on their ratios only. Polarization and B are in
//! tesla, H in ampere per metre. This crate reads no files and prints nothing.

// Rules are written as `!(x <= limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// Interpolation of the field in boxes without tiles.
mod interpolation;
/// The models that a tolerance uses.
mod plan;
/// B at fixed points as a linear map of polarizations.
mod polarization_map;
/// The scalar product of long rows.
mod scalar_product;
/// The facade over direct summation, tree and interpolation.
mod scene;
/// Tolerances and tuning constants.
mod tolerances;
/// Fast summation to a tolerance.
mod tree;
/// The choice of a model for each point, within a tolerance.
mod within;

pub use interpolation::fitted_field::{FittedField, FittedFieldError, LookUpError, LookUpErrors};
pub use magsplice_cuboid::tolerances::{EXACT_BOUND, GRADIENT_BOUND};
pub use magsplice_cuboid::{FaceDerivatives, FaceHessian};
pub use magsplice_ideal::{Comparison, ComparisonError, IdealFilm, IdealFilmFault, IdealFilmFaults};
pub use magsplice_magnet::{
    Accuracy, BoundingBox, Grid, GridFault, InvalidTolerance, IronPlane, IronPlaneFault, IronPlanes, IronPlanesFault,
    MAX_LENGTH, MAX_POLARIZATION_T, MIN_ASPECT, MIN_SIZE, MU_0, Overlap, PointError, PointErrorCause, PointErrors,
    Quantity, Tile, TileBehindPlane, TileFault, TileFaults, Tolerance, UNIT_NORM_TOLERANCE, overlap, overlaps,
};
pub use magsplice_simd::{InstructionSet, MissingInstructions};
pub use plan::{Model, Plan, PlannedPart};
pub use polarization_map::{PolarizationMap, PolarizationMapError};
pub use scene::Scene;
