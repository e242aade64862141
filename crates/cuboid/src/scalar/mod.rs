//! The reference kernel: the closed-form field and gradient of one cuboid at one point, free of
//! cancellation at every point (docs/physics.md, sections 2.1 to 2.5).

/// Numbers that carry derivatives.
mod dual;
/// Off-diagonal elements of the demagnetizing tensor: logarithms of edges.
mod edge;
/// Diagonal elements of the demagnetizing tensor: solid angles of faces.
mod face;
/// Field and gradient from the elements.
pub mod kernel;
/// The number types of the kernel.
pub(crate) mod number;
/// The position of a point relative to the faces.
pub mod offsets;
/// The kernel against a law.
#[cfg(test)]
mod tests;
