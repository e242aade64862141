//! Where the field is unbounded.
//!
//! Beside an edge along axis k the field grows like `-(J_i e_j + J_j e_i) ln(rho) / 2 pi`, at a corner half as fast for each
//! of its three edges. Where touching tiles share the edge these terms can cancel: then the field is bounded there, and
//! the common displacement of the point from the edge (see `FACE_NUDGE`) drops out of the sum.

use glam::DVec3;

use crate::block::Block;
use crate::kernel::offsets::Offsets;
use crate::tolerances::EDGE_CANCELLATION;

/// The sum of the coefficients of the logarithms at a point.
#[derive(Default)]
pub(crate) struct EdgeCharge {
    sum: DVec3,
    magnitude: f64,
    tile: usize,
}

impl EdgeCharge {
    /// Adds the edges of `block` that the point lies on; `to_scene` turns vectors of its frame.
    pub(crate) fn add(&mut self, block: &Block, offsets: &[Offsets<f64>; 3], to_scene: impl Fn(DVec3) -> DVec3) {
        let j = block.polarization_t;
        for edges in 0..3 {
            let (a, b) = ((edges + 1) % 3, (edges + 2) % 3);
            // Not an edge the point lies on, or only on its extension.
            if !(offsets[a].on_face && offsets[b].on_face) || !(offsets[edges].within() || offsets[edges].on_face) {
                continue;
            }
            let ends = if offsets[edges].on_face { 1.0 } else { 2.0 };
            let weight = ends * offsets[a].sign() * offsets[b].sign();
            let mut coefficient = DVec3::ZERO;
            coefficient[a] = weight * j[b];
            coefficient[b] = weight * j[a];
            self.sum += to_scene(coefficient);
            self.magnitude += coefficient.length();
            if coefficient != DVec3::ZERO {
                self.tile = block.tile;
            }
        }
    }

    /// A tile with an edge at the point whose logarithm nothing cancels.
    pub(crate) fn exposed(&self) -> Option<usize> {
        (self.sum.length() > EDGE_CANCELLATION * self.magnitude).then_some(self.tile)
    }
}
