//! The interaction list of a batch of points: the interaction of each part of a tree with them.

use glam::DVec3;
use magsplice_cuboid::tolerances::CLOSED_FORM_COST;
use magsplice_direct::direct_sum::DirectSum;
use magsplice_direct::tolerances::STRETCHED_BOUND;
use magsplice_magnet::BoundingBox;

use super::interaction::{DirectItem, ExpandedNode, Interaction, TranslatedNode};
use super::nodes::Tree;
use crate::tolerances::{LARGEST_LIST_COST, LOCAL_ERROR_SHARE, MIN_TRANSLATION_POINTS, NODE_COST, ROUNDING_SHARE};

/// Numbers of tiles by interaction.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TileCounts {
    /// Tiles of expanded and translated nodes.
    pub(crate) expanded: usize,
    /// Tiles summed directly at some points or all.
    pub(crate) direct: usize,
    /// Tiles of ignored nodes.
    pub(crate) ignored: usize,
}

/// The parts of a tree that add up to the field at neighbouring points.
#[derive(Clone, Debug, Default)]
pub(crate) struct InteractionList {
    /// Nodes that act through their multipole expansions.
    pub(crate) expanded: Vec<ExpandedNode>,
    /// Nodes translated into a local expansion about `centre`.
    pub(crate) translated: Vec<TranslatedNode>,
    /// Centre of the box around the points.
    pub(crate) centre: DVec3,
    /// Distance from the centre to a corner of the box.
    pub(crate) radius: f64,
    /// Items summed directly at points near them. Items of one frame follow each other.
    pub(crate) direct: Vec<DirectItem>,
    /// Upper bound of the truncation error of all nodes at any of the points, in tesla.
    pub(crate) truncation_error_t: f64,
    /// The contribution of ignored nodes to it.
    pub(crate) ignored_t: f64,
    /// Upper bound of the sum over tiles of the magnitudes of their fields, in tesla.
    pub(crate) magnitude_t: f64,
    /// Numbers of tiles by interaction.
    pub(crate) tiles: TileCounts,
    /// Cost of the items summed directly, in multiply-adds.
    pub(crate) direct_cost: f64,
}

impl InteractionList {
    /// The interaction list of `count` points in a box, with the largest nodes whose truncation
    /// error is at most `allowed_t` each. For many points far nodes are translated.
    pub(crate) fn new(tree: &Tree, points: &BoundingBox, count: usize, allowed_t: f64) -> InteractionList {
        InteractionList::below(tree, points, count, allowed_t, f64::INFINITY).expect("no cost is too large")
    }

    /// [`InteractionList::new`]; `None` as soon as it costs more than `most`.
    pub(crate) fn below(
        tree: &Tree,
        points: &BoundingBox,
        count: usize,
        allowed_t: f64,
        most: f64,
    ) -> Option<InteractionList> {
        let (centre, radius) = (points.centre(), points.half_size().length());
        let mut list = InteractionList { centre, radius, ..InteractionList::default() };
        let mut waiting: Vec<usize> = (0..tree.nodes.len().min(1)).collect();
        while let Some(index) = waiting.pop() {
            if let Some(expanded) = tree.expanded_node(index, points, allowed_t) {
                let interaction = list.interaction(tree, &expanded, count >= MIN_TRANSLATION_POINTS, allowed_t);
                list.add(tree, points, expanded, interaction);
                continue;
            }
            match tree.nodes[index].halves {
                Some([low, high]) => waiting.extend([high, low]),
                None => {
                    let item = tree.nodes[index].items.start;
                    let beyond = tree.expansion_distance(index, points, allowed_t);
                    list.truncation_error_t += beyond.map_or(0.0, |(_, expanded)| expanded.truncation_error_t);
                    list.direct.push(DirectItem { item, beyond });
                    list.tiles.direct += tree.tiles_of_item(item);
                    list.direct_cost += tree.items[item].cost();
                    if list.direct_cost > most * CLOSED_FORM_COST {
                        return None;
                    }
                    list.magnitude_t +=
                        tree.leaf_field_bound_t(index, points, ROUNDING_SHARE / STRETCHED_BOUND * allowed_t);
                }
            }
        }
        // Nodes translated at the same time use the highest of their degrees.
        list.translated.sort_by_key(|of| (of.local_degree, of.degree, of.node));
        list.direct.sort_by_key(|direct| (tree.items[direct.item].frame, direct.item));
        (list.cost() <= most).then_some(list)
    }

    /// The interaction of a node with the points.
    fn interaction(&self, tree: &Tree, of: &ExpandedNode, may_translate: bool, allowed_t: f64) -> Interaction {
        if of.degree == 0 {
            return Interaction::Ignored;
        }
        let share_t = LOCAL_ERROR_SHARE * allowed_t;
        let local = may_translate.then(|| tree.local_degree(of.node, of.degree, self.centre, self.radius, share_t));
        match local.flatten() {
            Some((local_degree, local_truncation_error_t)) => {
                Interaction::Translated { local_degree, local_truncation_error_t }
            }
            None => Interaction::Expanded,
        }
    }

    /// Adds a node with its interaction.
    fn add(&mut self, tree: &Tree, points: &BoundingBox, of: ExpandedNode, interaction: Interaction) {
        let ExpandedNode { node, distance, degree, truncation_error_t } = of;
        self.truncation_error_t += truncation_error_t;
        self.magnitude_t += tree.node_field_bound_t(node, points);
        match interaction {
            Interaction::Ignored => self.ignored_t += truncation_error_t,
            Interaction::Translated { local_degree, local_truncation_error_t } => {
                self.truncation_error_t += local_truncation_error_t;
                self.translated.push(TranslatedNode {
                    node,
                    distance,
                    degree,
                    truncation_error_t,
                    local_degree,
                    local_truncation_error_t,
                });
            }
            Interaction::Expanded => self.expanded.push(of),
        }
        let count = match interaction {
            Interaction::Ignored => &mut self.tiles.ignored,
            Interaction::Translated { .. } | Interaction::Expanded => &mut self.tiles.expanded,
        };
        *count += tree.tiles_of_node(node);
    }

    /// Cost at a point, in exact fields of one tile.
    pub(crate) fn cost(&self) -> f64 {
        self.direct_cost / CLOSED_FORM_COST + self.cost_of_expansions()
    }

    /// [`InteractionList::cost`] with the methods of direct summation at a point.
    pub(crate) fn cost_at(&self, (direct, tree): (&DirectSum, &Tree), point: DVec3) -> f64 {
        let item_cost = |of: &DirectItem| {
            let item = &tree.items[of.item];
            let frame = &direct.frames().frames()[item.frame];
            direct.cost_of_cluster(frame, item.cluster(frame), point)
        };
        self.direct.iter().map(item_cost).sum::<f64>() + self.cost_of_expansions()
    }

    fn cost_of_expansions(&self) -> f64 {
        self.degrees().map(|p| NODE_COST * ((p + 2) * (p + 3)) as f64).sum::<f64>() / CLOSED_FORM_COST
    }

    /// Whether the list costs clearly less than direct summation, which costs `exact_cost`.
    pub(crate) fn pays(&self, exact_cost: f64) -> bool {
        self.cost() <= LARGEST_LIST_COST * exact_cost
    }

    /// The degrees of the expansions.
    pub(crate) fn degrees(&self) -> impl Iterator<Item = usize> {
        self.expanded.iter().map(|of| of.degree).chain(self.translated.iter().map(|of| of.degree))
    }

    /// Number of expansions, including expansions for some of the points only.
    pub(crate) fn expansions(&self) -> usize {
        self.degrees().count() + self.direct.iter().filter(|direct| direct.beyond.is_some()).count()
    }
}
