//! The scalar kernel at points inside a tile, close to it, or in the plane of a face.

use glam::DVec3;
use magsplice_cuboid::block::{Block, LocalPoint};
use magsplice_cuboid::scalar::kernel::{FieldKind, cuboid_field};

use super::edges::EdgesAtPoint;
use crate::prepare::frames::Frame;

/// B or mu0 H of a block in tesla, in the frame of the scene. If the point is on the line of an
/// edge, `edges` receives the edge.
pub(super) fn near_field<'a>(
    block: &Block,
    at: &LocalPoint,
    frame: &Frame,
    kind: FieldKind,
    edges: impl FnOnce() -> &'a mut EdgesAtPoint,
) -> DVec3 {
    let Some(placed) = block.place(at) else { return DVec3::ZERO };
    let own = cuboid_field(&placed.offsets, block.polarization_t.to_array(), kind);
    if placed.on_edge_line() {
        edges().add(block, &placed, &frame.to_scene);
    }
    frame.to_scene.vector(DVec3::from_array(own))
}
