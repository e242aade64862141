//! The field of one uniformly magnetized cuboid.
//!
//! * [`scalar`]: the reference kernel, exact at every point.
//! * [`closed_form`]: the closed form for many points, in vectors.
//! * [`series`]: the multipole series far away.
//! * [`method`]: the choice of the method by distance, and its reasons.
//! * [`FaceDerivatives`], [`FaceHessian`]: first and second derivatives of B with respect to the
//!   positions of the faces.
//!
//! # Units
//! Lengths are in any one unit, polarization and mu0 H in tesla.

/// A cuboid prepared in its frame, and the position of a point relative to it.
pub mod block;
/// The closed form in vectors.
pub mod closed_form;
/// One cuboid at points that share a method.
pub mod evaluator;
/// Derivatives of B with respect to the positions of the faces.
mod face_derivatives;
/// Second derivatives of B with respect to the positions of the faces.
mod face_hessian;
/// The bound of the magnitude far from a cuboid, in single precision.
pub mod far_magnitude;
/// A bound of the field that needs no evaluation of it.
pub mod field_bound;
/// The gradient of one cuboid at points that share a method.
pub mod gradient_evaluator;
/// An upper bound of the magnitude of the field, in vectors.
pub mod magnitude_bound;
/// The choice of the method by distance.
pub mod method;
/// The reference kernel at one point.
pub mod scalar;
/// The multipole series.
pub mod series;
/// Lengths of a cuboid that determine the choice of the method.
pub mod shape;
/// Tolerances and tuning constants.
pub mod tolerances;

pub use face_derivatives::FaceDerivatives;
pub use face_hessian::FaceHessian;

/// Numbers that carry their rounding error, and the error analysis of every form.
#[cfg(test)]
mod rounding;
#[cfg(test)]
mod tests;
