//! The tree over all tiles of a scene: its nodes, and bounds of their fields (docs/physics.md,
//! section 5.2).

use std::f64::consts::PI;
use std::ops::Range as Span;
use std::sync::OnceLock;

use fearless_simd::Level;
use glam::{DMat3, DVec3};
use magsplice_cuboid::tolerances::LARGEST_FIELD_OVER_J;
use magsplice_expansion::moments::Moments;
use magsplice_expansion::multipole::MultipoleExpansion;
use magsplice_magnet::BoundingBox;

use super::blocks::{TreeBlock, TreeItem};

/// A binary tree over the tiles of a scene. Node 0 contains all of them.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(super) level: Level,
    /// Rotation from each frame to the scene.
    pub(super) rotations: Vec<Option<DMat3>>,
    /// Blocks in the order of their items.
    pub(super) blocks: Vec<TreeBlock>,
    /// The largest |J|, in tesla.
    pub(super) largest_j_t: f64,
    pub(super) items: Vec<TreeItem>,
    pub(super) nodes: Vec<TreeNode>,
    /// The leaf of each item.
    pub(super) leaves: Vec<usize>,
    /// Expansions of the leaves, in groups of `LEAVES_PER_GROUP`. A group is computed when one of
    /// its leaves is first needed.
    pub(super) leaf_expansions: Vec<OnceLock<Vec<NodeExpansion>>>,
}

/// A node of neighbouring items; a leaf has a single item.
#[derive(Clone, Debug)]
pub(super) struct TreeNode {
    pub(super) items: Span<usize>,
    pub(super) blocks: Span<usize>,
    /// Centre of the expansion.
    pub(super) centre: DVec3,
    /// Radius of a sphere around the tiles.
    pub(super) radius: f64,
    /// A box around the tiles.
    pub(super) bounds: BoundingBox,
    /// A power of two that brings the radius to order one. Scaled lengths are multiplied by it.
    pub(super) scale: f64,
    /// The sum over tiles of |J| V / 4 pi in tesla, scaled, times their error weights.
    pub(super) strength_t: f64,
    /// Highest degree at which the expansion is faster than direct summation.
    pub(super) degree: usize,
    /// Highest degree of the moments. It is chosen for twice as many tiles, because the moments of
    /// the parent derive from these moments.
    pub(super) moment_degree: usize,
    /// The two child nodes.
    pub(super) halves: Option<[usize; 2]>,
    /// Upper bound of the sum over tiles of |J| / 4 pi times the integral of distance^degree from
    /// the centre, in tesla, scaled (Eq. P29). Computed when first needed.
    pub(super) absolute_moment_t: OnceLock<f64>,
    /// The expansion of a node with child nodes, computed when first needed.
    pub(super) expansion: OnceLock<NodeExpansion>,
}

impl TreeNode {
    /// Distance from the centre to the nearest of the points, scaled.
    pub(super) fn distance(&self, points: &BoundingBox) -> f64 {
        points.gap(&BoundingBox { lower: self.centre, upper: self.centre }).length() * self.scale
    }
}

/// The field of a node outside its sphere.
#[derive(Clone, Debug)]
pub(super) struct NodeExpansion {
    pub(super) moments: Moments,
    pub(super) multipole: MultipoleExpansion,
    /// Upper bound of the field of each degree at scaled distance 1, in tesla: q_l of Eq. P28.
    pub(super) field_bounds_t: Vec<f64>,
    /// `field_bounds_t` divided by (l + 1)^1/2, as in Eq. P37.
    pub(super) mean_field_bounds_t: Vec<f64>,
}

impl NodeExpansion {
    /// The expansion of a node with these moments.
    pub(super) fn new(node: &TreeNode, moments: Moments) -> NodeExpansion {
        let field_bounds_t = moments.field_bounds();
        let mean = |(l, bound_t): (usize, &f64)| bound_t / (l as f64 + 1.0).sqrt();
        NodeExpansion {
            multipole: MultipoleExpansion::from_moments(&moments, node.centre.to_array(), node.scale),
            mean_field_bounds_t: field_bounds_t.iter().enumerate().map(mean).collect(),
            field_bounds_t,
            moments,
        }
    }
}

impl Tree {
    /// Upper bound of the sum over a node's tiles of the magnitudes of their fields, times their
    /// error weights, at points outside its sphere or its box, in tesla. Infinite where points can
    /// be inside both.
    pub(super) fn node_field_bound_t(&self, node: usize, points: &BoundingBox) -> f64 {
        let of = &self.nodes[node];
        let gap = (of.distance(points) - of.radius * of.scale).max(points.gap(&of.bounds).length() * of.scale);
        2.0 * 3.0_f64.sqrt() * of.strength_t / gap.powi(3)
    }

    /// Upper bound of the sum over a leaf's tiles of the magnitudes of their fields, times their
    /// error weights, at any points, in tesla. Returns a faster bound if it is at most `enough_t`.
    pub(super) fn leaf_field_bound_t(&self, leaf: usize, points: &BoundingBox, enough_t: f64) -> f64 {
        let item = self.nodes[leaf].items.start;
        let node_bound_t = self.node_field_bound_t(leaf, points);
        if node_bound_t <= enough_t {
            return node_bound_t;
        }
        let block_bound_t = |block: &TreeBlock| {
            let gap = (points.gap(&BoundingBox { lower: block.centre, upper: block.centre }).length()
                - block.half_diagonal)
                .max(0.0);
            let dipoles = (block.size / gap).element_product() / (2.0 * PI);
            block.error_weight * block.polarization_t.length() * 3.0_f64.sqrt() * dipoles.min(LARGEST_FIELD_OVER_J)
        };
        self.blocks[self.items[item].blocks.clone()].iter().map(block_bound_t).sum()
    }

    /// Number of tiles of an item.
    pub(super) fn tiles_of_item(&self, item: usize) -> usize {
        self.items[item].blocks.len()
    }

    /// Number of tiles of a node.
    pub(super) fn tiles_of_node(&self, node: usize) -> usize {
        self.nodes[node].blocks.len()
    }

    /// The largest |J|, in tesla.
    pub(crate) fn largest_j_t(&self) -> f64 {
        self.largest_j_t
    }
}
