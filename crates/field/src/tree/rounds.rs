//! Rounds of evaluation over a tree until every point keeps the tolerance (docs/physics.md, section
//! 5.2).

use glam::DVec3;
use magsplice_direct::tolerances::STRETCHED_BOUND;
use magsplice_expansion::tolerances::POINTS_PER_DEGREE;
use magsplice_magnet::{BoundingBox, MU_0, PointError, PointErrorCause, Quantity, Tolerance};
use rayon::prelude::*;

use super::interaction_list::InteractionList;
use super::nodes::Tree;
use super::sum::field_of_list;
use crate::tolerances::{
    ADDED_NODE_ERRORS, ERROR_OVER_MEAN, ESTIMATE_POINTS, ESTIMATE_STEP, FIELD_OVER_ERROR, FIRST_ERROR_OVER_J,
    FIRST_NODE_COUNT, MAX_REFINEMENT_ROUNDS, POINTS_PER_LIST, POINTS_PER_TREE_BATCH, POINTS_PER_WEAK_FIELD,
    SAFETY_FACTOR, TREE_BATCHES, USED_ERROR_SHARE,
};
use magsplice_direct::batches::{PointProgress, neighbours_together};
use magsplice_direct::direct_sum::DirectSum;

/// The tiles of a scene, with the mean time of their exact field at a point in exact fields of one
/// tile.
#[derive(Clone, Copy)]
pub(crate) struct TilesAndTree<'a> {
    pub(crate) direct: &'a DirectSum,
    pub(crate) tree: &'a Tree,
    pub(crate) exact_cost: f64,
}

/// Writes B or H at the `usable` points to `field`. Returns the points without a field, and the
/// indices of points where the tolerance is missed.
pub(crate) fn sum_over_tree(
    tiles: TilesAndTree,
    tolerance: Tolerance,
    quantity: Quantity,
    points: &[DVec3],
    usable: Vec<u32>,
    field: &mut [DVec3],
    progress: PointProgress,
) -> (Vec<PointError>, Vec<usize>) {
    let size = batch_size(usable.len());
    let order = batch_order(points, usable, size);
    let sorted: Vec<DVec3> = order.iter().map(|&index| points[index as usize]).collect();
    let mut values = vec![DVec3::NAN; sorted.len()];
    let batches = sorted.par_chunks(size).zip(values.par_chunks_mut(size)).enumerate();
    let open: Vec<OpenPoints> = batches
        .map(|(number, (points, values))| {
            progress(points.len());
            let mut batch = PointBatch::new(tiles, tolerance, quantity, points, values);
            batch.evaluate_all();
            batch.open.shifted(number * size)
        })
        .collect();
    for (&index, value) in order.iter().zip(values) {
        field[index as usize] = value;
    }
    let index = |position: usize| order[position] as usize;
    let failed = open.iter().flat_map(|open| &open.failed);
    let errors = failed
        .map(|&(position, cause)| PointError { index: index(position), point: points[index(position)], cause })
        .collect();
    (errors, open.iter().flat_map(|open| &open.missed).map(|&position| index(position)).collect())
}

/// The first interaction list of each part of the points, with the number of points.
/// [`sum_over_tree`] estimates the allowed truncation error of each part anew.
pub(crate) fn interaction_lists(
    tiles: TilesAndTree,
    tolerance: Tolerance,
    points: &[DVec3],
    usable: Vec<u32>,
) -> Vec<(usize, InteractionList)> {
    let size = batch_size(usable.len());
    let order = batch_order(points, usable, size);
    let lists = order.par_chunks(POINTS_PER_LIST).map(|order| {
        let part: Vec<DVec3> = order.iter().map(|&index| points[index as usize]).collect();
        let batch = PointBatch::new(tiles, tolerance, Quantity::FluxDensity, &part, &mut []);
        (part.len(), batch.list(&part, batch.first_budget(&part)))
    });
    lists.collect()
}

/// The expected cost of the interaction list of the points around one of them, in exact fields of
/// one tile, at most the cost of direct summation. The points are in a box, and the tolerance there
/// is `tolerance_t`.
pub(crate) fn expected_list_cost(
    TilesAndTree { direct, tree, exact_cost }: TilesAndTree,
    point: DVec3,
    around: &BoundingBox,
    tolerance_t: f64,
) -> f64 {
    let allowed_t = SAFETY_FACTOR * tolerance_t / FIRST_NODE_COUNT;
    let list = InteractionList::below(tree, around, POINTS_PER_LIST, allowed_t, exact_cost);
    list.map_or(exact_cost, |list| list.cost_at((direct, tree), point).min(exact_cost))
}

/// A tolerance in tesla, where |B| is `b_t`.
pub(crate) fn tolerance_t(tolerance: Tolerance, b_t: f64) -> f64 {
    match tolerance {
        Tolerance::Relative { fraction, .. } => fraction * b_t,
        Tolerance::AbsoluteT { error_t, .. } => error_t,
    }
}

/// Number of points in a batch: small enough for [`TREE_BATCHES`] batches, and otherwise as large
/// as possible, so that points with a weak field are refined in full lists.
fn batch_size(points: usize) -> usize {
    let [min, max] = POINTS_PER_TREE_BATCH;
    points.div_ceil(TREE_BATCHES).next_multiple_of(POINTS_PER_LIST).clamp(min, max)
}

/// An order of the points in which neighbours follow each other: in batches, in parts with an
/// interaction list of their own, and in groups with one degree.
fn batch_order(points: &[DVec3], usable: Vec<u32>, size: usize) -> Vec<u32> {
    neighbours_together(points, usable, &[size, POINTS_PER_LIST, POINTS_PER_DEGREE])
}

/// Neighbouring points that one thread evaluates.
struct PointBatch<'a> {
    tiles: TilesAndTree<'a>,
    tolerance: Tolerance,
    quantity: Quantity,
    points: &'a [DVec3],
    values: &'a mut [DVec3],
    open: OpenPoints,
}

/// Points without a value within the tolerance.
#[derive(Default)]
struct OpenPoints {
    /// Points where the tolerance is missed.
    missed: Vec<usize>,
    /// Points without a field.
    failed: Vec<(usize, PointErrorCause)>,
}

impl OpenPoints {
    /// The same points with larger indices.
    fn shifted(mut self, by: usize) -> OpenPoints {
        self.missed.iter_mut().for_each(|index| *index += by);
        self.failed.iter_mut().for_each(|(index, _)| *index += by);
        self
    }
}

/// Points of the next refinement round.
struct NextRound {
    /// Points where the tolerance is missed.
    missed: Vec<usize>,
    /// Whether a smaller truncation error would keep the tolerance at any of them, apart from
    /// rounding.
    can_improve: bool,
    /// The smallest truncation error at any point that can improve, in tesla.
    truncation_error_t: f64,
}

impl Default for NextRound {
    fn default() -> NextRound {
        NextRound { missed: Vec::new(), can_improve: false, truncation_error_t: f64::INFINITY }
    }
}

/// The allowed truncation error of an interaction list.
#[derive(Clone, Copy)]
struct ErrorBudget {
    /// Total over all nodes, in tesla.
    total_t: f64,
    /// Number of nodes that share it evenly.
    nodes: f64,
}

/// The field of an interaction list at its points.
struct ListResult {
    list: InteractionList,
    values: Vec<DVec3>,
    /// Upper bound of the truncation error at each point, in tesla.
    truncation_error_t: Vec<f64>,
    failed: Vec<(usize, PointErrorCause)>,
}

impl ListResult {
    /// Number of nodes that share the next budget, such that the truncation error uses about all of
    /// it.
    fn node_count(&self, budget: ErrorBudget) -> f64 {
        let own_t = budget.total_t / budget.nodes;
        let mean_t = self.truncation_error_t.iter().sum::<f64>() / self.truncation_error_t.len() as f64;
        ERROR_OVER_MEAN * mean_t / own_t + ADDED_NODE_ERRORS
    }
}

impl<'a> PointBatch<'a> {
    fn new(
        tiles: TilesAndTree<'a>,
        tolerance: Tolerance,
        quantity: Quantity,
        points: &'a [DVec3],
        values: &'a mut [DVec3],
    ) -> PointBatch<'a> {
        PointBatch { tiles, tolerance, quantity, points, values, open: OpenPoints::default() }
    }

    fn evaluate_all(&mut self) {
        let all: Vec<usize> = (0..self.points.len()).collect();
        let (mut next, mut budget) = (NextRound::default(), None);
        for part in all.chunks(POINTS_PER_LIST) {
            let own = budget.unwrap_or_else(|| self.first_budget(&self.points[..part.len()]));
            let list = self.list(&self.points_of(part), own);
            if !list.pays(self.tiles.exact_cost) {
                // The lists of neighbouring points will not keep it either.
                self.open.missed.extend(part[0]..self.points.len());
                break;
            }
            // The field hardly changes from these points to the next, so the next part uses their
            // budget.
            budget = Some(self.evaluate_part(part, own, list, &mut next));
        }
        // Points with a weak field are few. From here on they are combined into full lists.
        for _ in 1..MAX_REFINEMENT_ROUNDS {
            // A smaller truncation error does not reduce rounding.
            if !next.can_improve {
                break;
            }
            let last = std::mem::take(&mut next);
            for part in last.missed.chunks(POINTS_PER_LIST) {
                let lengths = part.iter().map(|&index| self.values[index].length() * self.in_tesla());
                let tolerance_t = tolerance_t(self.tolerance, lengths.fold(f64::INFINITY, f64::min));
                // In any case smaller than before.
                let total_t = SAFETY_FACTOR * tolerance_t.min(last.truncation_error_t);
                let first = ErrorBudget { total_t, nodes: FIRST_NODE_COUNT };
                // These points are farther apart, so the list has more nodes than before.
                let nodes = expected_nodes(&self.list(&self.points_of(part), first));
                let budget = ErrorBudget { total_t, nodes };
                let list = self.list(&self.points_of(part), budget);
                if list.pays(self.tiles.exact_cost) {
                    self.evaluate_part(part, budget, list, &mut next);
                } else {
                    self.open.missed.extend(part);
                }
            }
        }
        self.open.missed.extend(next.missed);
    }

    /// Evaluates points with one interaction list, and adds points where the tolerance is missed to
    /// the next round. Returns the budget for points with a similar field.
    fn evaluate_part(
        &mut self,
        part: &[usize],
        budget: ErrorBudget,
        list: InteractionList,
        next: &mut NextRound,
    ) -> ErrorBudget {
        let points = self.points_of(part);
        let result = self.evaluate(&points, list);
        // One bound for all points is often sufficient; otherwise each point has its own.
        let most_rounding_t = STRETCHED_BOUND * result.list.magnitude_t;
        let mut own_magnitudes_t = None;
        let mut lengths_t = Vec::with_capacity(part.len());
        let mut largest_rounding_t = 0.0_f64;
        let errors_t = result.truncation_error_t.iter().enumerate();
        for ((&index, &value), (number, &error_t)) in part.iter().zip(&result.values).zip(errors_t) {
            self.values[index] = value;
            let b = value * self.in_tesla();
            if value.is_nan() {
                continue;
            }
            lengths_t.push(b.length());
            if self.tolerance.is_kept(b, error_t + most_rounding_t) {
                continue;
            }
            let magnitudes_t = own_magnitudes_t.get_or_insert_with(|| self.tiles.direct.magnitudes_t(&points));
            let rounding_t = most_rounding_t.min(STRETCHED_BOUND * magnitudes_t[number]);
            largest_rounding_t = largest_rounding_t.max(rounding_t);
            if !self.tolerance.is_kept(b, error_t + rounding_t) {
                next.missed.push(index);
                if self.tolerance.is_kept(b, rounding_t) {
                    next.can_improve = true;
                    next.truncation_error_t = next.truncation_error_t.min(error_t);
                }
            }
        }
        let nodes = result.node_count(budget);
        self.open.failed.extend(result.failed.into_iter().map(|(number, cause)| (part[number], cause)));
        if lengths_t.is_empty() {
            return budget;
        }
        let weak = lengths_t.len() / POINTS_PER_WEAK_FIELD;
        let weak_t = *lengths_t.select_nth_unstable_by(weak, f64::total_cmp).1;
        // A truncation error below rounding has no benefit, for example where the field vanishes by
        // symmetry.
        let total_t = (SAFETY_FACTOR * tolerance_t(self.tolerance, weak_t)).max(largest_rounding_t);
        ErrorBudget { total_t, nodes }
    }

    fn points_of(&self, indices: &[usize]) -> Vec<DVec3> {
        indices.iter().map(|&index| self.points[index]).collect()
    }

    /// The budget of the first points of a batch.
    fn first_budget(&self, points: &[DVec3]) -> ErrorBudget {
        match self.tolerance {
            Tolerance::AbsoluteT { error_t, .. } => {
                let total_t = SAFETY_FACTOR * error_t;
                let first = self.list(points, ErrorBudget { total_t, nodes: FIRST_NODE_COUNT });
                ErrorBudget { total_t, nodes: expected_nodes(&first) }
            }
            Tolerance::Relative { fraction, .. } => self.estimated_budget(points, fraction),
        }
    }

    /// The budget of a relative tolerance, from an estimate of the field at some of the points.
    fn estimated_budget(&self, points: &[DVec3], fraction: f64) -> ErrorBudget {
        let step = points.len().div_ceil(ESTIMATE_POINTS);
        let some: Vec<DVec3> = points.iter().copied().step_by(step).collect();
        let total_t = FIRST_ERROR_OVER_J * self.tiles.tree.largest_j_t();
        let mut budget = ErrorBudget { total_t, nodes: FIRST_NODE_COUNT };
        for _ in 0..MAX_REFINEMENT_ROUNDS {
            let result = self.evaluate(&some, self.list(&some, budget));
            let lengths = result.values.iter().filter(|b| !b.is_nan()).map(|b| b.length() * self.in_tesla());
            let least_t = lengths.fold(f64::INFINITY, f64::min);
            let (nodes, error_t) = (result.node_count(budget), result.list.truncation_error_t);
            if error_t == 0.0 || least_t > FIELD_OVER_ERROR * error_t {
                let total_t = if least_t.is_finite() { SAFETY_FACTOR * fraction * least_t } else { budget.total_t };
                return ErrorBudget { total_t, nodes };
            }
            budget = ErrorBudget { total_t: ESTIMATE_STEP * error_t.min(budget.total_t), nodes };
        }
        budget
    }

    fn evaluate(&self, points: &[DVec3], list: InteractionList) -> ListResult {
        let mut result = ListResult {
            list,
            values: vec![DVec3::NAN; points.len()],
            truncation_error_t: vec![0.0; points.len()],
            failed: Vec::new(),
        };
        let ListResult { list, values, truncation_error_t, failed } = &mut result;
        field_of_list(
            (self.tiles.direct, self.tiles.tree),
            list,
            self.quantity,
            points,
            values,
            truncation_error_t,
            &mut |index, cause| {
                failed.push((index, cause));
            },
        );
        result
    }

    fn list(&self, points: &[DVec3], budget: ErrorBudget) -> InteractionList {
        let around = BoundingBox::from_points(points);
        InteractionList::new(self.tiles.tree, &around, points.len(), budget.total_t / budget.nodes)
    }

    /// The factor from the unit of the quantity to tesla.
    fn in_tesla(&self) -> f64 {
        if self.quantity == Quantity::FieldStrength { MU_0 } else { 1.0 }
    }
}

/// Number of nodes that share a budget, for a list with about as many expansions as this.
fn expected_nodes(list: &InteractionList) -> f64 {
    USED_ERROR_SHARE * list.expansions() as f64 + FIRST_NODE_COUNT
}
