//! The contents of a tree: blocks in the frame of the scene, grouped into items for direct
//! summation.

use std::f64::consts::PI;
use std::ops::Range as Span;
use std::sync::OnceLock;

use glam::{DMat3, DVec3};
use magsplice_cuboid::tolerances::{CLOSED_FORM_COST, SINGLE_TILE_COST};
use magsplice_magnet::BoundingBox;

use magsplice_direct::prepare::clusters::Cluster;
use magsplice_direct::prepare::frames::Frame;

/// A block in the frame of the scene.
#[derive(Clone, Debug)]
pub(super) struct TreeBlock {
    pub(super) centre: DVec3,
    pub(super) size: DVec3,
    /// Index of its frame.
    pub(super) frame: usize,
    pub(super) polarization_t: DVec3,
    pub(super) half_diagonal: f64,
    /// Error bound of its field over the bound of the exact field.
    pub(super) error_weight: f64,
}

impl TreeBlock {
    /// |J| V / 4 pi in tesla, with lengths multiplied by `scale`.
    pub(super) fn strength_t(&self, scale: f64) -> f64 {
        self.polarization_t.length() * (self.size * scale).element_product() / (4.0 * PI)
    }

    /// Upper bound of the mean over the block of distance^power from a centre, with lengths
    /// multiplied by `scale`.
    ///
    /// |x|^power is convex, so its mean over the block is at most its mean over the corners.
    pub(super) fn mean_power(&self, rotation: Option<&DMat3>, centre: DVec3, scale: f64, power: i32) -> f64 {
        let half = 0.5 * self.size;
        let along = |axis: DVec3| rotation.map_or(axis, |rotation| *rotation * axis);
        let (x, y, z) = (along(DVec3::X * half.x), along(DVec3::Y * half.y), along(DVec3::Z * half.z));
        let middle = self.centre - centre;
        let corners = [x + y + z, x + y - z, x - y + z, x - y - z].map(|corner| {
            [middle + corner, middle - corner].map(|from| (from.length() * scale).powi(power)).iter().sum::<f64>()
        });
        corners.iter().sum::<f64>() / 8.0
    }
}

/// The unit of direct summation in a tree: a cluster of tiles that share corners, or one tile.
#[derive(Clone, Debug)]
pub(super) struct TreeItem {
    /// Index of its frame.
    pub(super) frame: usize,
    pub(super) source: ClusterSource,
    pub(super) blocks: Span<usize>,
}

/// The storage of an item's cluster.
#[derive(Clone, Debug)]
pub(super) enum ClusterSource {
    /// In the frame's table, at this index.
    InTable(usize),
    /// In the item, a half of a cluster in the table.
    Half {
        /// Blocks of the frame.
        blocks: Span<usize>,
        /// Built when first needed.
        cluster: OnceLock<Box<Cluster>>,
    },
}

impl TreeItem {
    /// The cluster for direct summation of the item.
    pub(super) fn cluster<'a>(&'a self, frame: &'a Frame) -> &'a Cluster {
        match &self.source {
            ClusterSource::InTable(index) => &frame.clusters.clusters[*index],
            ClusterSource::Half { blocks, cluster } => {
                cluster.get_or_init(|| Box::new(Cluster::half(&frame.blocks, blocks.clone())))
            }
        }
    }

    /// Cost of the closed form at a vector of points, in multiply-adds.
    pub(super) fn cost(&self) -> f64 {
        if self.blocks.len() == 1 { SINGLE_TILE_COST } else { CLOSED_FORM_COST * self.blocks.len() as f64 }
    }
}

/// The items of a frame: clusters of its table, or their halves.
pub(super) fn items_of_frame(frame: &Frame) -> impl Iterator<Item = (Span<usize>, ClusterSource)> {
    frame.clusters.clusters.iter().enumerate().flat_map(|(index, of)| match of.halves(&frame.blocks) {
        Some(halves) => halves
            .map(|blocks| (blocks.clone(), ClusterSource::Half { blocks, cluster: OnceLock::new() }))
            .into_iter()
            .collect(),
        None => vec![(of.blocks.clone(), ClusterSource::InTable(index))],
    })
}

/// Expansion centre: the centre of the bounding box. It has exactly any coordinate shared by all
/// blocks, so moments that vanish by symmetry are exactly zero.
pub(super) fn expansion_centre(blocks: &[TreeBlock]) -> DVec3 {
    let (first, middle) = (blocks[0].centre, bounding_box(blocks).centre());
    let level = |axis: usize| blocks.iter().all(|block| block.centre[axis] == first[axis]);
    DVec3::from([0, 1, 2].map(|axis: usize| if level(axis) { first[axis] } else { middle[axis] }))
}

/// A box around the circumscribed spheres of blocks.
pub(super) fn bounding_box(blocks: &[TreeBlock]) -> BoundingBox {
    let lower = blocks.iter().map(|b| b.centre - b.half_diagonal).fold(DVec3::INFINITY, DVec3::min);
    let upper = blocks.iter().map(|b| b.centre + b.half_diagonal).fold(DVec3::NEG_INFINITY, DVec3::max);
    BoundingBox { lower, upper }
}
