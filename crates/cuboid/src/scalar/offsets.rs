//! The position of a point relative to the faces of a cuboid.

use super::number::Scalar;

/// Offsets along one axis, after mirroring the point into the half-space beyond the centre of the
/// cuboid.
///
/// `far > 0` and `far >= |near|` hold always; `near < 0` exactly when the point is between the two
/// faces.
#[derive(Clone, Copy, Debug)]
pub struct Offsets<S> {
    /// Signed distance to the nearer face, positive outside. Never zero.
    pub near: S,
    /// Distance to the other face.
    pub far: S,
    /// `near + far`: twice the distance to the middle of the tile.
    pub sum: S,
    /// Full side length, `far - near`.
    pub size: f64,
    /// Whether the point was mirrored.
    pub mirrored: bool,
    /// Whether the point was on the nearer face.
    pub on_face: bool,
}

impl<S: Scalar> Offsets<S> {
    /// The offset to the near (0) or the far (1) face.
    pub fn face(&self, bit: usize) -> S {
        if bit == 0 { self.near } else { self.far }
    }

    /// far^2 - near^2, without cancellation.
    pub fn square_step(&self) -> S {
        self.sum.scale(self.size)
    }

    /// Whether the point is between the two faces.
    pub fn within(&self) -> bool {
        self.near.value() < 0.0
    }

    /// -1 where the point was mirrored, +1 elsewhere.
    pub fn sign(&self) -> f64 {
        if self.mirrored { -1.0 } else { 1.0 }
    }
}
