//! Which parts of a tree serve a batch of points, and how.

use std::sync::Arc;

use glam::DVec3;

use super::far::Far;
use super::tree::Tree;
use crate::tolerances::{CERTAIN_SHARE, STRETCHED_BOUND, TRANSLATED_POINTS, TRANSLATED_SHARE};
use crate::within::magnitude::Box3;

/// For points that lie together, the parts of a tree that add up to the field there.
#[derive(Clone, Debug, Default)]
pub(crate) struct Assignment {
    /// What serves them and the other parts of more points.
    pub(super) far: Option<Arc<Far>>,
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

/// How a node serves points.
#[derive(Clone, Copy, Debug)]
pub(super) enum Service {
    /// Not at all, as all of it may be left out.
    Ignored,
    /// By its expansion, translated to their middle: a field of this degree, and at most what that leaves out anywhere, in tesla.
    Translated { degree: usize, left_out_t: f64 },
    /// By its expansion.
    Expanded,
}

/// An item that is taken exactly, at least at some points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    pub(super) item: usize,
    /// The distance from which its expansion is taken instead.
    pub(super) beyond: Option<(f64, Nearest)>,
}

impl Assignment {
    /// Of nothing, to points in a box.
    pub(super) fn around(points: &Box3) -> Assignment {
        Assignment { middle: points.centre(), reach: points.half_size().length(), ..Assignment::default() }
    }

    /// Of the nodes farthest up that leave out no more than `allowed_t` each, but for those that are served for several parts of points together. Of many points those
    /// far away are translated.
    pub(crate) fn of(tree: &Tree, far: Option<&Arc<Far>>, points: &Box3, count: usize, allowed_t: f64) -> Assignment {
        let mut assignment = Assignment::around(points);
        let mut waiting: Vec<usize> = (0..tree.nodes.len().min(1)).collect();
        if let Some(far) = far {
            waiting = far.rest.iter().rev().copied().collect();
            assignment.left_out_t = far.assignment.left_out_t;
            assignment.ignored_t = far.assignment.ignored_t;
            assignment.magnitude_t = far.assignment.magnitude_t;
            assignment.tiles = far.assignment.tiles;
            assignment.far = Some(far.clone());
        }
        while let Some(index) = waiting.pop() {
            if let Some(nearest) = tree.nearest(index, points, allowed_t) {
                let service = assignment.service(tree, &nearest, count >= TRANSLATED_POINTS, allowed_t);
                assignment.take(tree, points, nearest, service);
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

    /// How a node serves the points.
    pub(super) fn service(&self, tree: &Tree, of: &Nearest, may_translate: bool, allowed_t: f64) -> Service {
        if of.degree == 0 {
            return Service::Ignored;
        }
        let share_t = TRANSLATED_SHARE * allowed_t;
        let local = may_translate.then(|| tree.local_degree(of.node, of.degree, self.middle, self.reach, share_t));
        match local.flatten() {
            Some((degree, left_out_t)) => Service::Translated { degree, left_out_t },
            None => Service::Expanded,
        }
    }

    /// Adds a node that serves the points.
    pub(super) fn take(&mut self, tree: &Tree, points: &Box3, of: Nearest, service: Service) {
        let Nearest { node, distance, degree, left_out_t } = of;
        self.left_out_t += left_out_t;
        self.magnitude_t += tree.most_of_node_t(node, points);
        match service {
            Service::Ignored => self.ignored_t += left_out_t,
            Service::Translated { degree: local_degree, left_out_t: local_left_out_t } => {
                self.left_out_t += local_left_out_t;
                self.translated.push(Translated { node, distance, degree, left_out_t, local_degree, local_left_out_t });
            }
            Service::Expanded => self.expanded.push(of),
        }
        let kind = if let Service::Ignored = service { 2 } else { 0 };
        self.tiles[kind] += tree.tiles_of_node(node);
    }

    /// Whether nothing is left out.
    pub(crate) fn is_exact(&self) -> bool {
        self.expansions() == 0 && self.tiles[2] == 0
    }

    /// The expansions' degrees.
    pub(crate) fn degrees(&self) -> impl Iterator<Item = usize> {
        let far = self.far.iter().flat_map(|far| &far.assignment.translated);
        self.expanded.iter().map(|of| of.degree).chain(self.translated.iter().chain(far).map(|of| of.degree))
    }

    /// How many expansions there are, some for some of the points only.
    pub(crate) fn expansions(&self) -> usize {
        self.degrees().count() + self.near.iter().filter(|near| near.beyond.is_some()).count()
    }
}
