//! A flat half space of iron, and the image of a tile in it.

use glam::{DQuat, DVec3};
use thiserror::Error;

use crate::axis::Axis;
use crate::tile::{Tile, TileFaults};
use crate::tolerances::{MAX_LENGTH, NORM_ROUNDING};

/// An infinite half space of permeable material behind a plane, such as a steel sheet behind a
/// film. It does not saturate.
///
/// Before the plane its field is the field of image tiles: mirrored tiles whose polarization is
/// (mu_r - 1) / (mu_r + 1) times (-J_x, -J_y, J_z) for a normal along z (Jackson, Classical
/// Electrodynamics, 3rd ed., section 5.11, and Hague 1929 for finite mu_r).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct IronPlane {
    point: DVec3,
    normal: DVec3,
    relative_permeability: f64,
}

/// A rule that a plane of iron breaks.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum IronPlaneFault {
    /// A coordinate of the point is not finite or beyond [`MAX_LENGTH`].
    #[error("the point of a plane must have finite coordinates")]
    Point,
    /// The normal has no direction.
    #[error("the normal of a plane must be finite and not zero")]
    Normal,
    /// The permeability is below 1 or not a number.
    #[error("the relative permeability of a plane is {0}, must be at least 1, or infinite")]
    Permeability(f64),
}

impl IronPlane {
    /// A plane through a point. `normal` points out of the iron; it need not have the length 1.
    /// `relative_permeability` may be infinite.
    ///
    /// # Errors
    /// The first broken rule.
    pub fn new(point: DVec3, normal: DVec3, relative_permeability: f64) -> Result<IronPlane, IronPlaneFault> {
        if !point.abs().cmple(DVec3::splat(MAX_LENGTH)).all() {
            return Err(IronPlaneFault::Point);
        }
        let largest = normal.abs().max_element();
        // Normalising a unit vector again would only change the last digit.
        let normal = match (normal.length() - 1.0).abs() <= NORM_ROUNDING {
            true => normal,
            false => (normal / largest).try_normalize().ok_or(IronPlaneFault::Normal)?,
        };
        if !(relative_permeability >= 1.0) {
            return Err(IronPlaneFault::Permeability(relative_permeability));
        }
        Ok(IronPlane { point, normal, relative_permeability })
    }

    /// A point of the plane.
    pub fn point(&self) -> DVec3 {
        self.point
    }

    /// The unit normal, out of the iron.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// The relative permeability mu_r of the iron.
    pub fn relative_permeability(&self) -> f64 {
        self.relative_permeability
    }

    /// Polarization of an image over that of its tile: (mu_r - 1) / (mu_r + 1).
    pub fn image_factor(&self) -> f64 {
        1.0 - 2.0 / (self.relative_permeability + 1.0)
    }

    /// Distance of a point from the plane, negative in the iron.
    pub fn distance(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.point)
    }

    /// The mirror image of a point.
    pub fn mirrored(&self, point: DVec3) -> DVec3 {
        point - 2.0 * self.distance(point) * self.normal
    }

    /// The same iron after a rigid motion.
    pub(crate) fn after(&self, placed: impl Fn(DVec3) -> DVec3, turned: impl Fn(DVec3) -> DVec3) -> IronPlane {
        IronPlane { point: placed(self.point), normal: turned(self.normal), ..*self }
    }

    /// The image of a tile. Its axes are those of the tile if the normal is along one of them.
    ///
    /// # Errors
    /// If the image is out of the range of tiles.
    pub fn image(&self, tile: &Tile) -> Result<Tile, TileFaults> {
        // The mirror image of a cuboid is a cuboid whose own mirror image in one of its symmetry
        // planes is a rotated tile. The plane nearest to the mirror leaves the least rotation.
        let local = tile.rotation().inverse() * self.normal;
        let nearest = Axis::ALL.into_iter().max_by(|a, b| local[a.index()].abs().total_cmp(&local[b.index()].abs()));
        let axis = nearest.unwrap_or(Axis::Z);
        let along = axis.unit() * local[axis.index()].signum();
        // The product of two reflections is the rotation by twice the angle of their normals.
        let between = DQuat::from_vec4(along.cross(local).extend(along.dot(local))).normalize();
        let mut polarization_t = -self.image_factor() * tile.polarization_t();
        polarization_t[axis.index()] *= -1.0;
        Tile::new(self.mirrored(tile.position()), tile.size(), polarization_t)?.rotated(tile.rotation() * between)
    }
}
