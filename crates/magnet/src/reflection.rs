//! The images of tiles by the field of the tiles themselves.

use glam::{DMat3, DVec3};

use crate::iron_plane::IronPlane;

/// Reflections at planes of iron, one after another. The field of the images that they make is the
/// field of the tiles themselves at another place, turned and weakened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflection {
    turn: DMat3,
    shift: DVec3,
    factor: f64,
}

impl Reflection {
    /// No reflection: the tiles themselves.
    pub const NONE: Reflection = Reflection { turn: DMat3::IDENTITY, shift: DVec3::ZERO, factor: 1.0 };

    /// The same reflections, then one at a plane.
    #[must_use]
    pub fn then(&self, plane: &IronPlane) -> Reflection {
        let normal = plane.normal();
        let across = DMat3::from_cols(2.0 * normal.x * normal, 2.0 * normal.y * normal, 2.0 * normal.z * normal);
        Reflection {
            turn: self.turn * (DMat3::IDENTITY - across),
            shift: self.place(2.0 * normal.dot(plane.point()) * normal),
            factor: -plane.image_factor() * self.factor,
        }
    }

    /// The place at which the tiles have the field that their images have at a point.
    pub fn place(&self, point: DVec3) -> DVec3 {
        self.turn * point + self.shift
    }

    /// The motion of this place by a motion of the point.
    pub fn motion(&self, motion: DVec3) -> DVec3 {
        self.turn * motion
    }

    /// The matrix that maps the polarization of a tile to the polarization of its image.
    pub fn of_polarization(&self) -> DMat3 {
        self.factor * self.turn.transpose()
    }

    /// The axis of this place's turn by a turn of the point about an axis.
    pub fn turn(&self, axis: DVec3) -> DVec3 {
        self.turn.determinant().signum() * (self.turn * axis)
    }

    /// The field of the images at a point, from the field of the tiles at its place.
    pub fn field(&self, at_place: DVec3) -> DVec3 {
        self.factor * (self.turn.transpose() * at_place)
    }
}
