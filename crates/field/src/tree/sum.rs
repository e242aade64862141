//! The field of an interaction list at a batch of points.

use fearless_simd::{Level, dispatch};
use glam::DVec3;
use magsplice_cuboid::scalar::kernel::FieldKind;
use magsplice_expansion::local::LocalExpansion;
use magsplice_expansion::m2l::{M2lInput, translate};
use magsplice_magnet::{PointErrorCause, Quantity};
use magsplice_simd::power_of_two::power_of_two_reciprocal;

use super::interaction::{DirectItem, ExpandedNode};
use super::interaction_list::InteractionList;
use super::nodes::Tree;
use magsplice_direct::direct_sum::DirectSum;
use magsplice_direct::far_field::{BeyondSphere, DegreesByPoints, FarField};
use magsplice_direct::prepare::frames::Frames;
use magsplice_direct::sum::{FrameClusters, Sum};

/// Writes B or H at a batch of points, and an upper bound of the truncation error at each, in
/// tesla. Points without a field are passed to `failed`, and their field is NaN.
pub(super) fn field_of_list(
    (direct, tree): (&DirectSum, &Tree),
    list: &InteractionList,
    quantity: Quantity,
    points: &[DVec3],
    field: &mut [DVec3],
    truncation_error_t: &mut [f64],
    failed: &mut dyn FnMut(usize, PointErrorCause),
) {
    let kind = if quantity == Quantity::FieldStrength { FieldKind::Strength } else { FieldKind::Density };
    direct.field_of_batch_by(kind, points, field, failed, |sum, field| {
        sum_list(sum, direct, tree, list, kind, points, field);
        truncation_error_t.copy_from_slice(&sum.points_and_truncation_error_t().1[..points.len()]);
    });
}

/// Writes B or mu0 H of an interaction list in tesla.
pub(super) fn sum_list(
    sum: &mut Sum,
    direct: &DirectSum,
    tree: &Tree,
    list: &InteractionList,
    kind: FieldKind,
    points: &[DVec3],
    field: &mut [DVec3],
) {
    let level = direct.level();
    sum.start(level, points, list.ignored_t);
    if !points.is_empty() {
        for &node in &list.expanded {
            sum.add_far_field(level, &NodeField { tree, node });
        }
        let local = local_expansion(level, tree, list);
        let (coordinates, truncation_error_t) = sum.points_and_truncation_error_t();
        for of in &list.translated {
            tree.add_truncation_error(of, coordinates, truncation_error_t);
        }
        if let Some(local) = local {
            sum.add_local_expansion(level, &local);
        }
        let outside = list.direct.iter().map(|direct| direct.beyond.map(|(_, node)| NodeField { tree, node }));
        let outside: Vec<Option<NodeField>> = outside.collect();
        sum.add_clusters(level, direct.frames(), clusters(tree, list, &outside, direct.frames()), kind, points, true);
    }
    sum.finish(field);
}

/// The local expansion of all translated nodes.
pub(super) fn local_expansion(level: Level, tree: &Tree, list: &InteractionList) -> Option<LocalExpansion> {
    let degree = list.translated.iter().map(|of| of.local_degree).max()?;
    let scale = power_of_two_reciprocal(list.radius);
    let inputs: Vec<M2lInput> = list.translated.iter().map(|of| tree.m2l_input(of, list.centre, scale)).collect();
    Some(dispatch!(level, simd => translate(simd, &inputs, degree, list.centre, scale)))
}

/// The clusters for direct summation, by frame.
fn clusters<'a>(
    tree: &'a Tree,
    list: &InteractionList,
    outside: &'a [Option<NodeField<'a>>],
    frames: &'a Frames,
) -> Vec<FrameClusters<'a>> {
    let frame_of = |direct: &DirectItem| tree.items[direct.item].frame;
    let mut outside = outside.iter();
    let runs_of_frames = list.direct.chunk_by(|a, b| frame_of(a) == frame_of(b));
    let with_clusters = runs_of_frames.map(|items| {
        let frame = &frames.frames()[frame_of(&items[0])];
        let cluster = |(direct, node_field): (&DirectItem, &'a Option<NodeField<'a>>)| {
            let beyond = direct.beyond.zip(node_field.as_ref()).map(|((distance, expanded), far_field)| BeyondSphere {
                centre: tree.nodes[expanded.node].centre.to_array(),
                radius_squared: distance * distance,
                far_field,
            });
            (tree.items[direct.item].cluster(frame), beyond)
        };
        (frame, items.iter().zip(outside.by_ref()).map(cluster).collect())
    });
    with_clusters.collect()
}

/// The multipole expansion of a node.
pub(super) struct NodeField<'a> {
    pub(super) tree: &'a Tree,
    pub(super) node: ExpandedNode,
}

impl FarField for NodeField<'_> {
    fn fields(&self, level: Level, points: [&[f64]; 3], fields: [&mut [f64]; 3], degrees: &mut DegreesByPoints) {
        self.tree.set_degrees(&self.node, points, degrees);
        let expansion = self.tree.multipole_expansion(self.node.node);
        dispatch!(level, simd => expansion.fields(simd, &degrees.degree, points, fields));
    }
}
