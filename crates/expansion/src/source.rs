//! A cuboid as a source of an expansion.

use glam::{DMat3, DVec3};

/// A uniformly magnetized cuboid, relative to the centre of an expansion. Lengths are scaled.
#[derive(Clone, Copy, Debug, Default)]
pub struct CuboidSource {
    /// Centre of the cuboid.
    pub centre: DVec3,
    /// Half of each side, as a vector along it.
    pub half_sides: [DVec3; 3],
    /// Polarization J in tesla, along the axes of the expansion.
    pub polarization_t: DVec3,
}

impl CuboidSource {
    /// A cuboid with sides along the columns of `rotation`; without a rotation, along x, y, z.
    pub fn new(centre: DVec3, size: DVec3, rotation: Option<&DMat3>, polarization_t: DVec3) -> CuboidSource {
        let half_sides = [0, 1, 2].map(|axis: usize| {
            let direction = rotation.map_or(DVec3::AXES[axis], |rotation| rotation.col(axis));
            direction * (0.5 * size[axis])
        });
        CuboidSource { centre, half_sides, polarization_t }
    }

    /// Volume of the cuboid, scaled.
    pub fn volume(&self) -> f64 {
        self.half_sides.iter().map(|side| 2.0 * side.length()).product()
    }
}
