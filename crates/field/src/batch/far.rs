//! Nodes of a tree that are far from several parts of neighbouring points, translated once for all of them (docs/physics.md, section 5.2).

use fearless_simd::dispatch;

use super::assignment::{Assignment, Service};
use super::local::Local;
use super::translation::translated;
use super::tree::Tree;
use crate::tolerances::LEAST_FAR_REACHES;
use crate::within::magnitude::Box3;

/// Nodes far from points, and those that are left to the parts of them.
#[derive(Debug)]
pub(crate) struct Far {
    /// Of what is translated to the middle of the points, or left out at all of them.
    pub(super) assignment: Assignment,
    /// The field of what is translated.
    pub(super) local: Option<Local>,
    /// The other nodes.
    pub(super) rest: Vec<usize>,
}

impl Far {
    /// Of the nodes farthest up that leave out no more than `allowed_t` each.
    pub(crate) fn of(tree: &Tree, points: &Box3, allowed_t: f64) -> Far {
        let mut far = Far { assignment: Assignment::around(points), local: None, rest: Vec::new() };
        if !tree.nodes.is_empty() {
            far.take(tree, 0, points, allowed_t);
        }
        let Assignment { translated: nodes, middle, reach, .. } = &mut far.assignment;
        nodes.sort_by_key(|of| (of.local_degree, of.degree, of.node));
        far.local = dispatch!(tree.level(), simd => translated(simd, tree, nodes, *middle, *reach));
        far
    }

    /// A node or what is far away of it; returns whether anything is.
    fn take(&mut self, tree: &Tree, node: usize, points: &Box3, allowed_t: f64) -> bool {
        if let Some(nearest) = tree.nearest(node, points, allowed_t) {
            match self.assignment.service(tree, &nearest, true, allowed_t) {
                Service::Expanded => {}
                service => {
                    self.assignment.take(tree, points, nearest, service);
                    return true;
                }
            }
        } else if let Some(halves) = tree.nodes[node].halves
            && tree.reaches_beyond(node, self.assignment.middle, LEAST_FAR_REACHES * self.assignment.reach)
        {
            let before = self.rest.len();
            let taken = halves.map(|half| self.take(tree, half, points, allowed_t));
            if taken != [false; 2] {
                return true;
            }
            self.rest.truncate(before);
        }
        self.rest.push(node);
        false
    }
}
