//! Two cuboids with parallel edges, in the frame of their edges.

use glam::{DMat3, DVec3};
use magsplice_magnet::Tile;
use magsplice_magnet::tolerances::{ROTATED_SEAM_ROUNDINGS, SAME_ROTATION, SEAM_ROUNDINGS, UNIT_ROUNDOFF};

use crate::double_double::DoubleDouble;
use crate::load::Load;

/// Two cuboids with parallel edges. Lengths are scaled by a power of two.
pub(crate) struct AlignedPair {
    /// Centre of the first cuboid relative to the centre of the second.
    pub(crate) offset: [DoubleDouble; 3],
    /// Sides of both.
    pub(crate) sizes: [DVec3; 2],
    /// Polarizations of both, in tesla.
    pub(crate) polarizations_t: [DVec3; 2],
    /// Faces closer than this touch.
    pub(crate) seam: f64,
    /// The power-of-two factor in all lengths.
    pub(crate) scale: f64,
}

impl AlignedPair {
    /// The pair in the frame of the first tile; `None` if their edges are not parallel. Tiles
    /// turned by multiples of 90 degrees against each other have parallel edges.
    pub(crate) fn new(first: &Tile, second: &Tile) -> Option<AlignedPair> {
        let relative = DMat3::from_quat(first.rotation().inverse() * second.rotation());
        let permutation = axes_to_axes(relative, SAME_ROTATION)?;
        let apart = [0, 1, 2].map(|k| DoubleDouble::sum(first.position()[k], -second.position()[k]));
        let unrotated = first.rotation() == glam::DQuat::IDENTITY;
        let offset = if unrotated {
            apart
        } else {
            let inverse = first.rotation().inverse();
            let high = inverse * DVec3::from_array(apart.map(|d| d.hi));
            let low = inverse * DVec3::from_array(apart.map(|d| d.lo));
            [0, 1, 2].map(|k| DoubleDouble::sum(high[k], low[k]))
        };
        let sizes = [first.size(), (permutation * second.size()).abs()];
        let extent = first.position().abs().max(second.position().abs()).max(sizes[0]).max(sizes[1]).max_element();
        let roundings = if unrotated { SEAM_ROUNDINGS } else { ROTATED_SEAM_ROUNDINGS };
        let largest = offset.iter().map(|d| d.hi.abs()).fold(sizes[0].max(sizes[1]).max_element(), f64::max);
        let scale = 2_f64.powi(-(largest.log2().round() as i32));
        Some(AlignedPair {
            offset: offset.map(|d| d.scaled(scale)),
            sizes: sizes.map(|size| size * scale),
            polarizations_t: [first.polarization_t(), permutation * second.polarization_t()],
            seam: roundings * UNIT_ROUNDOFF * extent * scale,
            scale,
        })
    }

    /// Converts a load from scaled lengths and the frame of the first tile to the lengths and the
    /// frame of the scene.
    pub(crate) fn to_scene(&self, load: Load, first: &Tile) -> Load {
        let unscaled = 1.0 / self.scale;
        Load {
            force: first.rotation() * (load.force * unscaled * unscaled),
            torque: first.rotation() * (load.torque * unscaled * unscaled * unscaled),
        }
    }
}

/// The signed permutation matrix from which a rotation differs by at most `tolerance`.
pub(crate) fn axes_to_axes(rotation: DMat3, tolerance: f64) -> Option<DMat3> {
    let nearest = |column: DVec3| {
        let largest = column.abs().max_position();
        let axis = DVec3::AXES[largest] * column[largest].signum();
        column.abs_diff_eq(axis, tolerance).then_some(axis)
    };
    Some(DMat3::from_cols(nearest(rotation.x_axis)?, nearest(rotation.y_axis)?, nearest(rotation.z_axis)?))
}
