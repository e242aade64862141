//! Standard deviations of the errors of one tile.

use glam::DVec3;

/// Standard deviations of the errors of one tile. All errors are normal and independent. The default
/// is a tile without errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TileErrors {
    /// Error of the centre along each axis of the scene.
    pub position: DVec3,
    /// Error of the rotation about each axis of the scene, in radians.
    pub rotation_rad: DVec3,
    /// Error of each side along the tile's own axes.
    pub size: DVec3,
    /// Error of |J|, as a fraction of it.
    pub strength: f64,
    /// Error of the direction of J about each of two axes normal to it, in radians.
    pub direction_rad: f64,
}

impl TileErrors {
    /// The errors of tiles that were cut and laid with care: 0.05 mm in position along each axis,
    /// 0.5 degrees about each axis, and 1 % in strength. Lengths in millimetres.
    pub const WORKSHOP_MM: TileErrors = TileErrors {
        position: DVec3::splat(0.05),
        rotation_rad: DVec3::splat(0.5 * std::f64::consts::PI / 180.0),
        size: DVec3::ZERO,
        strength: 0.01,
        direction_rad: 0.0,
    };
}
