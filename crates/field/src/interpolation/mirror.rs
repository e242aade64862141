//! Mirror symmetry of scenes about the middle planes of a box. With it half of the nodes of a fit
//! determine the other half.

use glam::DQuat;
use magsplice_cuboid::field_bound::tile_field_bound_t;
use magsplice_magnet::{BoundingBox, Tile};

use crate::tolerances::{MAX_MIRRORED_TILES, MIRROR_ROUNDING};
use magsplice_direct::direct_sum::DirectSum;

/// Symmetry of the field about the three middle planes of a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mirrors {
    /// For each axis, s of B(M x) = s M B(x), where M mirrors x in the plane across the axis.
    /// `None` if the tiles are not symmetric.
    pub(super) signs: [Option<f64>; 3],
    /// Upper bound of the error from tiles that deviate from their mirror images, in tesla.
    pub(super) error_t: f64,
}

impl Mirrors {
    /// The symmetry of the tiles about the middle of a box.
    pub(super) fn new(direct: &DirectSum, region: &BoundingBox) -> Mirrors {
        let mut mirrors = Mirrors { signs: [None; 3], error_t: 0.0 };
        let tiles = direct.tiles();
        if tiles.len() > MAX_MIRRORED_TILES || tiles.iter().any(|tile| tile.rotation() != DQuat::IDENTITY) {
            return mirrors;
        }
        for axis in (0..3).filter(|&axis| region.half_size()[axis] > 0.0) {
            for sign in [1.0, -1.0] {
                if let Some(error_t) = mirror_error_t(direct, region, axis, sign) {
                    mirrors.signs[axis] = Some(sign);
                    mirrors.error_t += error_t;
                    break;
                }
            }
        }
        mirrors
    }

    /// Factor of a component of B from a point to its mirror image across an axis.
    pub(super) fn factor(&self, component: usize, axis: usize) -> Option<f64> {
        self.signs[axis].map(|sign| if component == axis { -sign } else { sign })
    }
}

/// Upper bound of the difference, in tesla, between the field in a box and its mirror image times a
/// sign. `None` if a tile has no mirror image among the tiles.
fn mirror_error_t(direct: &DirectSum, region: &BoundingBox, axis: usize, sign: f64) -> Option<f64> {
    let tiles = direct.tiles();
    let middle = region.centre()[axis];
    let mut is_image = vec![false; tiles.len()];
    let mut error_t = 0.0;
    for (tile, around) in tiles.iter().zip(direct.boxes()) {
        let mut position = tile.position();
        position[axis] = 2.0 * middle - position[axis];
        let mut j_t = sign * tile.polarization_t();
        j_t[axis] = -j_t[axis];
        let distance = region.gap(around).length();
        // A dipole's field changes along any direction by at most three times its bound over the
        // distance. A layer on a face counts as another tile.
        let apart = |image: &Tile| {
            let moved = (image.position() - position).length();
            let grown = (image.size() - tile.size()).abs().element_sum();
            let turned = (image.polarization_t() - j_t).length() / j_t.length();
            3.0 * (moved + grown) / distance + grown / tile.size().min_element() + turned
        };
        let images = tiles.iter().enumerate().filter(|&(index, _)| !is_image[index]);
        let (index, apart) = images.map(|(i, image)| (i, apart(image))).find(|&(_, apart)| apart <= MIRROR_ROUNDING)?;
        is_image[index] = true;
        error_t += apart * tile_field_bound_t(tile, distance);
    }
    Some(error_t)
}
