//! Which parts of a tree serve a batch of points, and how.

use super::tree::Tree;
use crate::within::magnitude::Box3;

/// For points that lie together, the parts of a tree that add up to the field there.
#[derive(Clone, Debug, Default)]
pub(crate) struct Assignment {
    /// Nodes taken by their expansions, with the degree.
    pub(super) expanded: Vec<(usize, usize)>,
    /// Items taken exactly at points near them, those of one frame together.
    pub(super) near: Vec<Near>,
    /// At most what all degrees left out add up to, in tesla.
    pub(crate) left_out_t: f64,
    /// Of that, what whole nodes would have added.
    pub(crate) ignored_t: f64,
    /// At most the sum over tiles of the magnitudes of their fields, in tesla.
    pub(crate) magnitude_t: f64,
    /// Tiles taken by expansions, exactly, and not at all.
    pub(crate) tiles: [usize; 3],
}

/// An item that is taken exactly, at least at some points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    pub(super) item: usize,
    /// That of the item alone.
    pub(super) node: usize,
    /// The distance from which its expansion of a degree is taken instead.
    pub(super) beyond: Option<(f64, usize)>,
}

impl Assignment {
    /// Of the nodes farthest up that leave out no more than `allowed_t` each.
    pub(crate) fn of(tree: &Tree, points: &Box3, allowed_t: f64) -> Assignment {
        let mut assignment = Assignment::default();
        let mut waiting: Vec<usize> = (0..tree.nodes.len().min(1)).collect();
        while let Some(index) = waiting.pop() {
            if let Some((degree, left_out_t)) = tree.degree(index, points, allowed_t) {
                let tiles = tree.tiles_of_node(index);
                assignment.left_out_t += left_out_t;
                assignment.magnitude_t += tree.most_of_node_t(index, points);
                if degree > 0 {
                    assignment.expanded.push((index, degree));
                    assignment.tiles[0] += tiles;
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
                    if beyond.is_some() {
                        assignment.left_out_t += allowed_t;
                    }
                    assignment.near.push(Near { item, node: index, beyond });
                    assignment.tiles[1] += tree.tiles_of_item(item);
                    assignment.magnitude_t += tree.most_of_item_t(item, points);
                }
            }
        }
        assignment.near.sort_by_key(|near| (tree.items[near.item].frame, near.item));
        assignment
    }

    /// Whether nothing is left out.
    pub(crate) fn is_exact(&self) -> bool {
        self.expansions() == 0 && self.tiles[2] == 0
    }

    /// The expansions' degrees.
    pub(crate) fn degrees(&self) -> impl Iterator<Item = usize> {
        self.expanded.iter().map(|(_, degree)| *degree)
    }

    /// How many expansions there are, some for some of the points only.
    pub(crate) fn expansions(&self) -> usize {
        self.expanded.len() + self.near.iter().filter(|near| near.beyond.is_some()).count()
    }
}
