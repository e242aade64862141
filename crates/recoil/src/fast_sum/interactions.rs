//! Pairs of nodes that interact by expansions, and pairs of leaves whose cells have tensors.

use glam::I64Vec3;

use super::octree::Octree;

/// Largest ratio of the sum of the radii of two nodes to the distance of their centres for
/// interaction by expansions.
const SEPARATION: f64 = 0.7;

/// Pairs of nodes.
#[derive(Default)]
pub(super) struct Interactions {
    /// Pairs of nodes that interact by expansions, each once.
    pub(super) far: Vec<[usize; 2]>,
    /// Pairs of leaves, each once, including each leaf with itself; the first index is at most the
    /// second.
    pub(super) near: Vec<[usize; 2]>,
}

/// Key of a translation: the difference of the levels of source and receiver, and the offset of
/// their centres in half sides of the smaller node.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub(super) struct Offset {
    pub(super) levels: i32,
    pub(super) halves: [i64; 3],
}

impl Offset {
    pub(super) fn new(tree: &Octree, receiver: usize, source: usize) -> Offset {
        let [receiver, source] = [receiver, source].map(|node| &tree.nodes[node]);
        let finer = receiver.level.max(source.level);
        let centre = |level: u32, place: I64Vec3| (2 * place + I64Vec3::ONE) * (1_i64 << (finer - level));
        let halves = centre(receiver.level, receiver.place) - centre(source.level, source.place);
        Offset { levels: source.level as i32 - receiver.level as i32, halves: halves.to_array() }
    }
}

impl Interactions {
    pub(super) fn new(tree: &Octree) -> Interactions {
        let mut all = Interactions::default();
        let mut waiting = vec![[0, 0]];
        while let Some([a, b]) = waiting.pop() {
            let (first, second) = (&tree.nodes[a], &tree.nodes[b]);
            let distance = (tree.centre(first) - tree.centre(second)).length();
            if a != b && first.radius + second.radius <= SEPARATION * distance {
                all.far.push([a, b]);
            } else if tree.is_leaf(a) && tree.is_leaf(b) {
                all.near.push([a.min(b), a.max(b)]);
            } else if a == b {
                let children = first.children.clone();
                waiting.extend(children.clone().flat_map(|i| (i..children.end).map(move |j| [i, j])));
            } else if tree.is_leaf(b) || (!tree.is_leaf(a) && first.level <= second.level) {
                waiting.extend(first.children.clone().map(|child| [child, b]));
            } else {
                waiting.extend(second.children.clone().map(|child| [a, child]));
            }
        }
        all
    }
}
