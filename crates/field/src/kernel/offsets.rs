//! Where a point lies relative to a tile's faces.

use super::scalar::Scalar;

/// Offsets along one axis, after mirroring the point into the half-space beyond the tile's centre.
///
/// `far > 0` and `far >= |near|` always; `near < 0` exactly when the point is between the two faces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Offsets<S> {
    /// Signed distance to the nearer face, positive outside. Never zero.
    pub(crate) near: S,
    /// Distance to the other face.
    pub(crate) far: S,
    /// Sum of the two: twice the distance to the middle of the tile.
    pub(crate) sum: S,
    /// Full side length, `far - near`.
    pub(crate) size: f64,
    /// Whether the point was mirrored.
    pub(crate) mirrored: bool,
    /// Whether the point lay on the nearer face.
    pub(crate) on_face: bool,
}

impl<S: Scalar> Offsets<S> {
    /// The offset to the near (0) or the far (1) face.
    pub(crate) fn face(&self, bit: usize) -> S {
        if bit == 0 { self.near } else { self.far }
    }

    /// far^2 - near^2, without cancellation.
    pub(crate) fn square_step(&self) -> S {
        self.sum.scale(self.size)
    }

    pub(crate) fn within(&self) -> bool {
        self.near.value() < 0.0
    }

    /// -1 where the point was mirrored, +1 elsewhere.
    pub(crate) fn sign(&self) -> f64 {
        if self.mirrored { -1.0 } else { 1.0 }
    }
}
