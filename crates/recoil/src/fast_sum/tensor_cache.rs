//! A cache of tensors of pairs of cells.
//!
//! Films repeat tiles, and the cells of a tile repeat sizes and offsets in all its octants. Tensors
//! are computed from rounded lengths, so they do not depend on the pair that was met first.

use std::collections::HashMap;

use glam::{DQuat, DVec3, I64Vec3};
use magsplice_magnet::Tile;
use magsplice_pair::{NotConverged, SymmetricTensor, mean_tensor_of_boxes, mean_tensor_within};

use crate::tolerances::{CACHED_LENGTH, CACHED_TENSORS, NEAR_TENSOR_ERROR};

/// Sizes of receiver and source, and the magnitude of the offset, in units of length.
type Key = [I64Vec3; 3];

/// The tensors met so far.
pub(super) struct TensorCache {
    unit: f64,
    tensors: HashMap<Key, SymmetricTensor>,
}

impl TensorCache {
    /// An empty cache for cells within a cube of this side.
    pub(super) fn new(side: f64) -> TensorCache {
        TensorCache { unit: CACHED_LENGTH * side, tensors: HashMap::new() }
    }

    /// The mean tensor, to [`NEAR_TENSOR_ERROR`].
    pub(super) fn mean_tensor(&mut self, receiver: &Tile, source: &Tile) -> Result<SymmetricTensor, NotConverged> {
        if [receiver, source].iter().any(|tile| tile.rotation() != DQuat::IDENTITY) {
            return mean_tensor_within(receiver, source, NEAR_TENSOR_ERROR);
        }
        let offset = receiver.position() - source.position();
        let units = |lengths: DVec3| (lengths / self.unit).round().as_i64vec3();
        let key = [units(receiver.size()), units(source.size()), units(offset.abs())];
        if self.tensors.len() >= CACHED_TENSORS {
            self.tensors.clear();
        }
        let unit = self.unit;
        let tensor = *self.tensors.entry(key).or_insert_with(|| {
            let [receiver, source, offset] = key.map(|lengths| lengths.as_dvec3() * unit);
            mean_tensor_of_boxes(receiver, source, offset, NEAR_TENSOR_ERROR)
        });
        let s = offset.signum();
        let signs = DVec3::new(s.y * s.z, s.z * s.x, s.x * s.y);
        Ok(SymmetricTensor { off_diagonal: tensor.off_diagonal * signs, ..tensor })
    }
}
