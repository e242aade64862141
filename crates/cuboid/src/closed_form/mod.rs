//! The closed form in vectors (docs/physics.md, section 2.6).

/// The six elements of the demagnetizing tensor from distances and offsets.
pub mod elements;
/// The gradient in vectors.
pub mod gradient;
/// A bound of the magnitude of the field.
pub mod magnitude;
/// Points inside a compact cuboid and close to its edges.
pub mod near_edge;
/// Elements by sums of positive terms.
pub mod positive;
/// The elements of rods for which the error of the other closed form is too large.
pub mod rod;
/// A single cuboid.
pub mod single_tile;
/// The elements that a polarization needs, with their coefficients.
pub mod terms;
