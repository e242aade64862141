//! Cells in an octree of cubes.

use std::ops::Range;

use glam::{DVec3, I64Vec3};
use magsplice_magnet::Tile;

/// Largest number of cells of a leaf. A smaller number increases the pairs of nodes, a larger
/// number the pairs of near cells.
const CELLS_PER_LEAF: usize = 16;

/// Largest number of halvings of the cube of all cells.
const MOST_LEVELS: u32 = 40;

/// A cube with the cells whose centres are in it.
pub(super) struct Node {
    /// Number of halvings of the cube of all cells.
    pub(super) level: u32,
    /// The position among the cubes of the level.
    pub(super) place: I64Vec3,
    /// The range of its cells in [`Octree::order`].
    pub(super) cells: Range<usize>,
    /// The octants that have cells.
    pub(super) children: Range<usize>,
    /// Radius of a sphere about the centre that contains the cells.
    pub(super) radius: f64,
}

/// Cells in cubes. A node comes before its children.
pub(super) struct Octree {
    pub(super) nodes: Vec<Node>,
    /// Indices of the cells.
    pub(super) order: Vec<usize>,
    lower: DVec3,
    side: f64,
}

impl Octree {
    /// The tree of one or more cells.
    pub(super) fn new(cells: &[Tile]) -> Octree {
        let lower = cells.iter().map(|cell| cell.position()).fold(DVec3::INFINITY, DVec3::min);
        let upper = cells.iter().map(|cell| cell.position()).fold(DVec3::NEG_INFINITY, DVec3::max);
        let side = (upper - lower).max_element().max(cells[0].size().max_element());
        let middle = 0.5 * (lower + upper);
        let mut tree =
            Octree { nodes: Vec::new(), order: (0..cells.len()).collect(), lower: middle - 0.5 * side, side };
        let root = tree.node(cells, 0, I64Vec3::ZERO, 0..cells.len());
        tree.nodes.push(root);
        let mut at = 0;
        while at < tree.nodes.len() {
            tree.halve(cells, at);
            at += 1;
        }
        tree
    }

    /// The side of the cubes of a level.
    pub(super) fn side(&self, level: u32) -> f64 {
        self.side * 0.5_f64.powi(level as i32)
    }

    /// The centre of a node.
    pub(super) fn centre(&self, node: &Node) -> DVec3 {
        self.centre_of(node.level, node.place)
    }

    pub(super) fn is_leaf(&self, node: usize) -> bool {
        self.nodes[node].children.is_empty()
    }

    fn centre_of(&self, level: u32, place: I64Vec3) -> DVec3 {
        self.lower + self.side(level) * (place.as_dvec3() + 0.5)
    }

    fn node(&self, cells: &[Tile], level: u32, place: I64Vec3, own: Range<usize>) -> Node {
        let centre = self.centre_of(level, place);
        let reach = |index: &usize| (cells[*index].position() - centre).length() + 0.5 * cells[*index].size().length();
        let radius = self.order[own.clone()].iter().map(reach).fold(0.0, f64::max);
        Node { level, place, cells: own, children: 0..0, radius }
    }

    fn halve(&mut self, cells: &[Tile], at: usize) {
        let Node { level, place, cells: own, .. } = &self.nodes[at];
        let (level, place, own) = (*level, *place, own.clone());
        if own.len() <= CELLS_PER_LEAF || level == MOST_LEVELS {
            return;
        }
        let centre = self.centre(&self.nodes[at]);
        let octant = |index: usize| {
            let above = cells[index].position().cmpge(centre);
            I64Vec3::new(above.x.into(), above.y.into(), above.z.into())
        };
        self.order[own.clone()].sort_by_key(|index| octant(*index).to_array());
        let first = self.nodes.len();
        let mut start = own.start;
        while start < own.end {
            let part = octant(self.order[start]);
            let count = self.order[start..own.end].iter().take_while(|index| octant(**index) == part).count();
            let child = self.node(cells, level + 1, 2 * place + part, start..start + count);
            self.nodes.push(child);
            start += count;
        }
        self.nodes[at].children = first..self.nodes.len();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The centres of the cells of a node are in its cube, each node has at most
    /// [`CELLS_PER_LEAF`] cells or children with all of them, and the cubes of a level are half as
    /// wide as the cubes above.
    #[test]
    fn nodes_are_cubes_around_their_cells() {
        let place = |n: usize| DVec3::new((n % 7) as f64, (n / 7 % 5) as f64, (n / 35) as f64) * 3.0;
        let cells: Vec<Tile> = (0..210).map(|n| Tile::new(place(n), DVec3::ONE, DVec3::Z).unwrap()).collect();
        let tree = Octree::new(&cells);
        assert_eq!(tree.side(0), 18.0);
        for level in 0..4 {
            assert_eq!(tree.side(level + 1), 0.5 * tree.side(level));
        }
        for node in &tree.nodes {
            let half = 0.5 * tree.side(node.level);
            for &cell in &tree.order[node.cells.clone()] {
                let offset = (cells[cell].position() - tree.centre(node)).abs().max_element();
                assert!(offset <= half * (1.0 + 1e-12), "{offset} of {half}");
            }
            let children = &tree.nodes[node.children.clone()];
            let count: usize = children.iter().map(|child| child.cells.len()).sum();
            assert_eq!(count, if children.is_empty() { 0 } else { node.cells.len() });
            assert!(!children.is_empty() || node.cells.len() <= CELLS_PER_LEAF);
        }
        assert!(tree.nodes.iter().any(|node| node.level >= 2));
    }
}
