//! Building of a tree by bisection.

use std::ops::Range as Span;
use std::sync::OnceLock;

use fearless_simd::Level;
use glam::{DVec2, DVec3, Vec3Swizzles};
use magsplice_expansion::tolerances::HIGHEST_DEGREE;
use magsplice_magnet::Tile;
use magsplice_simd::power_of_two::power_of_two_reciprocal;

use super::blocks::{ClusterSource, TreeBlock, TreeItem, bounding_box, expansion_centre, items_of_frame};
use super::nodes::{Tree, TreeNode};
use crate::tolerances::{FLAT_NODE_COST, LEAVES_PER_GROUP, NODE_COST};
use magsplice_direct::direct_sum::DirectSum;
use magsplice_direct::prepare::frames::Frames;

impl Tree {
    /// A tree over prepared tiles, with expansions up to `degree` where they are faster than direct
    /// summation.
    pub(crate) fn new(direct: &DirectSum, degree: usize) -> Tree {
        Tree::from_frames(direct.level(), direct.frames(), direct.tiles(), degree)
    }

    fn from_frames(level: Level, prepared: &Frames, tiles: &[Tile], degree: usize) -> Tree {
        let mut unsorted: Vec<Option<(Vec<TreeBlock>, usize, ClusterSource)>> = Vec::new();
        for (index, frame) in prepared.frames().iter().enumerate() {
            for (blocks, source) in items_of_frame(frame) {
                let blocks = blocks.map(|block| {
                    let block = &frame.blocks[block];
                    let size = DVec3::from(block.size);
                    TreeBlock {
                        centre: prepared.centre_in_scene(frame, block, &tiles[block.tile]),
                        size,
                        frame: index,
                        polarization_t: frame.to_scene.vector(block.polarization_t),
                        half_diagonal: 0.5 * size.length(),
                        error_weight: block.error_weight(),
                    }
                });
                unsorted.push(Some((blocks.collect(), index, source)));
            }
        }
        let centres: Vec<DVec3> = unsorted.iter().flatten().map(|(blocks, ..)| bounding_box(blocks).centre()).collect();
        let mut order: Vec<usize> = (0..unsorted.len()).collect();
        let rotations = prepared.frames().iter().map(|frame| frame.to_scene.rotation().copied()).collect();
        let largest_j_t = tiles.iter().map(|tile| tile.polarization_t().length()).fold(0.0, f64::max);
        let mut tree = Tree {
            level,
            rotations,
            blocks: Vec::new(),
            largest_j_t,
            items: Vec::new(),
            nodes: Vec::new(),
            leaves: Vec::new(),
            leaf_expansions: Vec::new(),
        };
        let mut spans = Vec::new();
        if !order.is_empty() {
            bisect(&centres, &mut order, 0, &mut spans);
        }
        for index in order {
            let (blocks, frame, source) = unsorted[index].take().expect("each once");
            let start = tree.blocks.len();
            tree.blocks.extend(blocks);
            tree.items.push(TreeItem { frame, source, blocks: start..tree.blocks.len() });
        }
        for (items, halves) in spans {
            tree.add_node(items, halves, degree);
        }
        tree.leaf_expansions.resize_with(tree.items.len().div_ceil(LEAVES_PER_GROUP), OnceLock::new);
        tree
    }

    fn add_node(&mut self, items: Span<usize>, halves: Option<[usize; 2]>, degree: usize) {
        let span = self.items[items.start].blocks.start..self.items[items.end - 1].blocks.end;
        let blocks = &self.blocks[span.clone()];
        let centre = expansion_centre(blocks);
        let radius = blocks.iter().map(|b| (b.centre - centre).length() + b.half_diagonal).fold(0.0, f64::max);
        let scale = power_of_two_reciprocal(radius);
        let strength_t = blocks.iter().map(|block| block.error_weight * block.strength_t(scale)).sum();
        let cost: f64 = self.items[items.clone()].iter().map(TreeItem::cost).sum();
        let node_cost = if self.is_flat(blocks) { FLAT_NODE_COST } else { NODE_COST };
        let highest = |cost: f64| {
            let pays = |degree: &usize| node_cost * ((degree + 2) * (degree + 3)) as f64 <= cost;
            (1..=degree.min(HIGHEST_DEGREE)).take_while(pays).last().unwrap_or(1)
        };
        if halves.is_none() {
            debug_assert_eq!(self.leaves.len(), items.start, "leaves come in the order of their items");
            self.leaves.push(self.nodes.len());
        }
        self.nodes.push(TreeNode {
            items,
            blocks: span,
            centre,
            radius,
            bounds: bounding_box(blocks),
            scale,
            strength_t,
            degree: highest(cost),
            moment_degree: highest(2.0 * cost),
            halves,
            absolute_moment_t: OnceLock::new(),
            expansion: OnceLock::new(),
        });
    }

    /// Whether the moments have a [parity](magsplice_expansion::moments::Parity): tiles in one
    /// plane, not tilted, with J in the plane or normal to it.
    fn is_flat(&self, blocks: &[TreeBlock]) -> bool {
        let upright =
            |block: &TreeBlock| self.rotations[block.frame].is_none_or(|turn| turn.z_axis.xy() == DVec2::ZERO);
        let level = |block: &TreeBlock| block.centre.z == blocks[0].centre.z;
        let j_t = |block: &TreeBlock| block.polarization_t;
        blocks.iter().all(|block| level(block) && upright(block))
            && (blocks.iter().all(|block| j_t(block).z == 0.0)
                || blocks.iter().all(|block| j_t(block).xy() == DVec2::ZERO))
    }
}

/// Sorts items by recursive bisection across the axis along which their centres extend farthest.
/// Appends the span of each node in the new order, and its child nodes after it. Returns the index
/// of the node.
fn bisect(
    centres: &[DVec3],
    order: &mut [usize],
    start: usize,
    spans: &mut Vec<(Span<usize>, Option<[usize; 2]>)>,
) -> usize {
    let own = spans.len();
    spans.push((start..start + order.len(), None));
    if order.len() > 1 {
        let lower = order.iter().map(|&i| centres[i]).fold(DVec3::INFINITY, DVec3::min);
        let upper = order.iter().map(|&i| centres[i]).fold(DVec3::NEG_INFINITY, DVec3::max);
        let axis = (upper - lower).max_position();
        let middle = order.len() / 2;
        let along = |index: usize| centres[index][axis];
        order.select_nth_unstable_by(middle, |&a, &b| along(a).total_cmp(&along(b)).then(a.cmp(&b)));
        let (low, high) = order.split_at_mut(middle);
        let halves = [bisect(centres, low, start, spans), bisect(centres, high, start + middle, spans)];
        spans[own].1 = Some(halves);
    }
    own
}
