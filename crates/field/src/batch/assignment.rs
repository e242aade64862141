//! Which parts of a tree serve a batch of points, and how.

use glam::DVec3;

use super::tree::Tree;
use crate::tolerances::{CERTAIN_SHARE, STRETCHED_BOUND, TRANSLATED_POINTS, TRANSLATED_SHARE};
use crate::within::magnitude::Box3;

/// For points that lie together, the parts of a tree that add up to the field there.
#[derive(Clone, Debug, Default)]
pub(crate) struct Assignment {
    /// Nodes taken by their expansions.
    pub(super) expanded: Vec<Nearest>,
    /// Nodes translated to the middle of the points.
    pub(super) translated: Vec<Translated>,
    /// That, and the distance of the farthest corner of the box around them.
    pub(super) middle: DVec3,
    pub(super) reach: f64,
    /// Items taken exactly at points near them, those of one frame together.
    pub(super) near: Vec<Near>,
    /// At most what all degrees left out add up to at any of the points, in tesla.
    pub(crate) left_out_t: f64,
    /// Of that, what whole nodes would have added.
    pub(crate) ignored_t: f64,
    /// At most the sum over tiles of the magnitudes of their fields, in tesla.
    pub(crate) magnitude_t: f64,
    /// Tiles taken by expansions, exactly, and not at all.
    pub(crate) tiles: [usize; 3],
}

/// What serves a batch of points.
pub(crate) struct Assigned<'a> {
    pub(crate) assignment: &'a Assignment,
    /// Becomes at most what is left out at each of the points, in tesla.
    pub(crate) left_out_t: &'a mut [f64],
}

/// A node that is taken by its expansion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    pub(super) node: usize,
    /// From its centre to the nearest of the points, scaled.
    pub(super) distance: f64,
    /// The degree there, and at most what it leaves out there, in tesla. No lower degree leaves out more than that at points farther away.
    pub(super) degree: usize,
    pub(super) left_out_t: f64,
}

/// A node that is taken by its expansion translated to the middle of the points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Translated {
    pub(super) node: usize,
    /// From its centre to the nearest of the points, scaled.
    pub(super) distance: f64,
    /// The degree, and at most what it leaves out there, in tesla.
    pub(super) degree: usize,
    pub(super) left_out_t: f64,
    /// Of the field around the middle, and at most what that leaves out anywhere.
    pub(super) local_degree: usize,
    pub(super) local_left_out_t: f64,
}

/// An item that is taken exactly, at least at some points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    pub(super) item: usize,
    /// The distance from which its expansion is taken instead.
    pub(super) beyond: Option<(f64, Nearest)>,
}

impl Assignment {
    /// Of the nodes farthest up that leave out no more than `allowed_t` each. Of many points those far away are translated.
    pub(crate) fn of(tree: &Tree, points: &Box3, count: usize, allowed_t: f64) -> Assignment {
        let (middle, reach) = (points.centre(), points.half_size().length());
        let mut assignment = Assignment { middle, reach, ..Assignment::default() };
        let mut waiting: Vec<usize> = (0..tree.nodes.len().min(1)).collect();
        while let Some(index) = waiting.pop() {
            if let Some(nearest) = tree.nearest(index, points, allowed_t) {
                let Nearest { node, distance, degree, left_out_t } = nearest;
                let tiles = tree.tiles_of_node(index);
                assignment.left_out_t += left_out_t;
                assignment.magnitude_t += tree.most_of_node_t(index, points);
                if degree > 0 {
                    assignment.tiles[0] += tiles;
                    let share_t = TRANSLATED_SHARE * allowed_t;
                    let local = (count >= TRANSLATED_POINTS)
                        .then(|| tree.local_degree(index, degree, middle, reach, share_t))
                        .flatten();
                    if let Some((local_degree, local_left_out_t)) = local {
                        assignment.left_out_t += local_left_out_t;
                        assignment.translated.push(Translated {
                            node,
                            distance,
                            degree,
                            left_out_t,
                            local_degree,
                            local_left_out_t,
                        });
                    } else {
                        assignment.expanded.push(nearest);
                    }
                } else {
                    assignment.ignored_t += left_out_t;
                    assignment.tiles[2] += tiles;
                }
                continue;
            }
            match tree.nodes[index].halves {
                Some([low, high]) => waiting.extend([high, low]),
                None => {
                    let item = tree.nodes[index].items.start;
                    let beyond = tree.least_distance(index, points, allowed_t);
                    assignment.left_out_t += beyond.map_or(0.0, |(_, nearest)| nearest.left_out_t);
                    assignment.near.push(Near { item, beyond });
                    assignment.tiles[1] += tree.tiles_of_item(item);
                    assignment.magnitude_t +=
                        tree.most_of_item_t(index, points, CERTAIN_SHARE / STRETCHED_BOUND * allowed_t);
                }
            }
        }
        // Nodes that are translated at the same time take the highest of their degrees.
        assignment.translated.sort_by_key(|of| (of.local_degree, of.degree, of.node));
        assignment.near.sort_by_key(|near| (tree.items[near.item].frame, near.item));
        assignment
    }

    /// Whether nothing is left out.
    pub(crate) fn is_exact(&self) -> bool {
        self.expansions() == 0 && self.tiles[2] == 0
    }

    /// The expansions' degrees.
    pub(crate) fn degrees(&self) -> impl Iterator<Item = usize> {
        self.expanded.iter().map(|of| of.degree).chain(self.translated.iter().map(|of| of.degree))
    }

    /// How many expansions there are, some for some of the points only.
    pub(crate) fn expansions(&self) -> usize {
        self.expanded.len() + self.translated.len() + self.near.iter().filter(|near| near.beyond.is_some()).count()
    }
}
