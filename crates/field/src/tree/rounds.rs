//! Rounds of evaluation over a tree until every point keeps the tolerance (docs/physics.md, section
//! 5.2).

use glam::DVec3;
use magsplice_expansion::tolerances::POINTS_PER_DEGREE;
use magsplice_magnet::{BoundingBox, Cause, MU_0, PointError, Quantity, Tolerance, is_in_range};
use rayon::prelude::*;

use super::interaction_list::InteractionList;
use super::nodes::Tree;
use super::sum::field_of_list;
use crate::direct::batches::neighbours_together;
use crate::direct::direct_sum::DirectSum;
use crate::tolerances::{
    ASSIGNED_POINTS, ASSIGNMENT_ROUNDS, CLEAR_OF_ERROR, LEAST_SHARES, LEFT_OUT_OVER_MEAN, POINTS_PER_ROUND,
    POINTS_PER_WEAK, ROUGH_FIELD_OVER_J, ROUGH_NODES, ROUGH_STEP, ROUNDS_TO_SHARE, SAFE_SHARE, SAMPLED_POINTS,
    STRETCHED_BOUND, USED_SHARE,
};

/// Writes B or H at the `usable` points to `field`. Returns the points without a field, and the indices of
/// points at which the tolerance was not reached.
pub(crate) fn sum_over_tree(
    direct: &DirectSum,
    tree: &Tree,
    tolerance: Tolerance,
    quantity: Quantity,
    points: &[DVec3],
    usable: Vec<u32>,
    field: &mut [DVec3],
) -> (Vec<PointError>, Vec<usize>) {
    let size = batch_size(usable.len());
    let order = batches_together(points, usable, size);
    let near: Vec<DVec3> = order.iter().map(|&index| points[index as usize]).collect();
    let mut values = vec![DVec3::NAN; near.len()];
    let batches = near.par_chunks(size).zip(values.par_chunks_mut(size)).enumerate();
    let unserved: Vec<Unserved> = batches
        .map(|(number, (points, values))| {
            let mut batch = Batch::new(direct, tree, tolerance, quantity, points, values);
            batch.evaluate_all();
            batch.unserved.shifted(number * size)
        })
        .collect();
    for (&index, value) in order.iter().zip(values) {
        field[index as usize] = value;
    }
    let place = |position: usize| order[position] as usize;
    let failed = unserved.iter().flat_map(|unserved| &unserved.failed);
    let errors = failed
        .map(|&(position, cause)| PointError { index: place(position), point: points[place(position)], cause })
        .collect();
    (errors, unserved.iter().flat_map(|unserved| &unserved.missed).map(|&p| place(p)).collect())
}

/// The first interaction list of each part of the points, with the number of points; [`sum_over_tree`]
/// estimates the allowed truncation error of each part anew.
pub(crate) fn interaction_lists(
    direct: &DirectSum,
    tree: &Tree,
    tolerance: Tolerance,
    points: &[DVec3],
) -> Vec<(usize, InteractionList)> {
    let usable: Vec<u32> = (0..points.len() as u32).filter(|&index| is_in_range(points[index as usize])).collect();
    let size = batch_size(usable.len());
    let order = batches_together(points, usable, size);
    let lists = order.par_chunks(ASSIGNED_POINTS).map(|order| {
        let part: Vec<DVec3> = order.iter().map(|&index| points[index as usize]).collect();
        let batch = Batch::new(direct, tree, tolerance, Quantity::FluxDensity, &part, &mut []);
        (part.len(), batch.list(&part, batch.first_allowance(&part)))
    });
    lists.collect()
}

/// So few points that there are batches enough to share out, and otherwise so many that weak fields are found together.
fn batch_size(points: usize) -> usize {
    let [least, most] = POINTS_PER_ROUND;
    points.div_ceil(ROUNDS_TO_SHARE).next_multiple_of(ASSIGNED_POINTS).clamp(least, most)
}

/// An order in which neighbours follow each other: all points of a batch, and of these those that share an assignment.
fn batches_together(points: &[DVec3], usable: Vec<u32>, size: usize) -> Vec<u32> {
    neighbours_together(points, usable, &[size, ASSIGNED_POINTS, POINTS_PER_DEGREE])
}

/// Points that lie together.
struct Batch<'a> {
    direct: &'a DirectSum,
    tree: &'a Tree,
    tolerance: Tolerance,
    quantity: Quantity,
    points: &'a [DVec3],
    values: &'a mut [DVec3],
    unserved: Unserved,
}

/// What has not been evaluated.
#[derive(Default)]
struct Unserved {
    /// Points at which the tolerance was not reached.
    missed: Vec<usize>,
    /// Points that have no field.
    failed: Vec<(usize, Cause)>,
}

impl Unserved {
    fn shifted(mut self, by: usize) -> Unserved {
        self.missed.iter_mut().for_each(|index| *index += by);
        self.failed.iter_mut().for_each(|(index, _)| *index += by);
        self
    }
}

/// What the next round is about.
struct Next {
    /// Points at which the tolerance has not been reached.
    missed: Vec<usize>,
    /// Whether more than rounding is in the way at any of them.
    may_be_reached: bool,
    /// The least that was left out at any of those.
    left_out_t: f64,
}

impl Default for Next {
    fn default() -> Next {
        Next { missed: Vec::new(), may_be_reached: false, left_out_t: f64::INFINITY }
    }
}

/// What an assignment may leave out.
#[derive(Clone, Copy)]
struct Allowance {
    whole_t: f64,
    /// Nodes among which it is divided.
    nodes: f64,
}

/// Points at which parts of a tree have been added up.
struct Evaluated {
    list: InteractionList,
    values: Vec<DVec3>,
    /// At most what was left out at each, in tesla.
    truncation_error_t: Vec<f64>,
    failed: Vec<(usize, Cause)>,
}

impl Evaluated {
    /// Among how many nodes the next allowance is to be divided so that about all of it is left out.
    fn nodes(&self, allowance: Allowance) -> f64 {
        let own_t = allowance.whole_t / allowance.nodes;
        let mean_t = self.truncation_error_t.iter().sum::<f64>() / self.truncation_error_t.len() as f64;
        LEFT_OUT_OVER_MEAN * mean_t / own_t + LEAST_SHARES
    }
}

impl<'a> Batch<'a> {
    fn new(
        direct: &'a DirectSum,
        tree: &'a Tree,
        tolerance: Tolerance,
        quantity: Quantity,
        points: &'a [DVec3],
        values: &'a mut [DVec3],
    ) -> Batch<'a> {
        Batch { direct, tree, tolerance, quantity, points, values, unserved: Unserved::default() }
    }

    fn evaluate_all(&mut self) {
        let all: Vec<usize> = (0..self.points.len()).collect();
        let (mut next, mut allowance) = (Next::default(), None);
        for part in all.chunks(ASSIGNED_POINTS) {
            let own = allowance.unwrap_or_else(|| self.first_allowance(&self.points[..part.len()]));
            // The field hardly changes from these points to the next.
            allowance = Some(self.evaluate_some(part, own, &mut next));
        }
        // Points at which the field is weak are few, and taken together from here on.
        for _ in 1..ASSIGNMENT_ROUNDS {
            // Against rounding it does not help to leave out less.
            if !next.may_be_reached {
                break;
            }
            let last = std::mem::take(&mut next);
            for open in last.missed.chunks(ASSIGNED_POINTS) {
                let lengths = open.iter().map(|&index| self.values[index].length() * self.in_tesla());
                let wanted_t = self.wanted_t(lengths.fold(f64::INFINITY, f64::min));
                // Less than before in any case.
                let whole_t = SAFE_SHARE * wanted_t.min(last.left_out_t);
                let rough = Allowance { whole_t, nodes: ROUGH_NODES };
                // They lie farther from each other, so that there are more nodes than before.
                let nodes = nodes_like(&self.list(&self.points_of(open), rough));
                self.evaluate_some(open, Allowance { whole_t, nodes }, &mut next);
            }
        }
        self.unserved.missed = next.missed;
    }

    /// Points that share an assignment. Returns what may be left out where the field is like that at these.
    fn evaluate_some(&mut self, open: &[usize], allowance: Allowance, next: &mut Next) -> Allowance {
        let evaluated = self.evaluate(&self.points_of(open), allowance);
        let rounding_t = STRETCHED_BOUND * evaluated.list.magnitude_t;
        let mut lengths_t = Vec::with_capacity(open.len());
        for ((&index, &value), &left_out_t) in open.iter().zip(&evaluated.values).zip(&evaluated.truncation_error_t) {
            self.values[index] = value;
            let b = value * self.in_tesla();
            if value.is_nan() {
                continue;
            }
            lengths_t.push(b.length());
            if !self.tolerance.is_kept(b, left_out_t + rounding_t) {
                next.missed.push(index);
                if self.tolerance.is_kept(b, rounding_t) {
                    next.may_be_reached = true;
                    next.left_out_t = next.left_out_t.min(left_out_t);
                }
            }
        }
        let nodes = evaluated.nodes(allowance);
        self.unserved.failed.extend(evaluated.failed.into_iter().map(|(number, cause)| (open[number], cause)));
        if lengths_t.is_empty() {
            return allowance;
        }
        let weak = lengths_t.len() / POINTS_PER_WEAK;
        let weak_t = *lengths_t.select_nth_unstable_by(weak, f64::total_cmp).1;
        // Less than rounding is of no use, as where the field vanishes by symmetry.
        let whole_t = (SAFE_SHARE * self.wanted_t(weak_t)).max(rounding_t);
        Allowance { whole_t, nodes }
    }

    fn points_of(&self, indices: &[usize]) -> Vec<DVec3> {
        indices.iter().map(|&index| self.points[index]).collect()
    }

    /// The tolerance in tesla.
    fn wanted_t(&self, b_t: f64) -> f64 {
        match self.tolerance {
            Tolerance::Relative { fraction, .. } => fraction * b_t,
            Tolerance::AbsoluteT { error_t, .. } => error_t,
        }
    }

    fn first_allowance(&self, points: &[DVec3]) -> Allowance {
        match self.tolerance {
            Tolerance::AbsoluteT { error_t, .. } => {
                let whole_t = SAFE_SHARE * error_t;
                let like = self.list(points, Allowance { whole_t, nodes: ROUGH_NODES });
                Allowance { whole_t, nodes: nodes_like(&like) }
            }
            Tolerance::Relative { fraction, .. } => self.estimate(points, fraction),
        }
    }

    /// From a rough field at some of the points, what may be left out.
    fn estimate(&self, points: &[DVec3], fraction: f64) -> Allowance {
        let step = points.len().div_ceil(SAMPLED_POINTS);
        let some: Vec<DVec3> = points.iter().copied().step_by(step).collect();
        let mut allowance = Allowance { whole_t: ROUGH_FIELD_OVER_J * self.tree.largest_j_t(), nodes: ROUGH_NODES };
        for _ in 0..ASSIGNMENT_ROUNDS {
            let evaluated = self.evaluate(&some, allowance);
            let lengths = evaluated.values.iter().filter(|b| !b.is_nan()).map(|b| b.length() * self.in_tesla());
            let least_t = lengths.fold(f64::INFINITY, f64::min);
            let (nodes, left_out_t) = (evaluated.nodes(allowance), evaluated.list.truncation_error_t);
            if left_out_t == 0.0 || least_t > CLEAR_OF_ERROR * left_out_t {
                let whole_t = if least_t.is_finite() { SAFE_SHARE * fraction * least_t } else { allowance.whole_t };
                return Allowance { whole_t, nodes };
            }
            allowance = Allowance { whole_t: ROUGH_STEP * left_out_t.min(allowance.whole_t), nodes };
        }
        allowance
    }

    fn evaluate(&self, points: &[DVec3], allowance: Allowance) -> Evaluated {
        let mut evaluated = Evaluated {
            list: self.list(points, allowance),
            values: vec![DVec3::NAN; points.len()],
            truncation_error_t: vec![0.0; points.len()],
            failed: Vec::new(),
        };
        let Evaluated { list, values, truncation_error_t, failed } = &mut evaluated;
        field_of_list(
            (self.direct, self.tree),
            list,
            self.quantity,
            points,
            values,
            truncation_error_t,
            &mut |index, cause| {
                failed.push((index, cause));
            },
        );
        evaluated
    }

    fn list(&self, points: &[DVec3], allowance: Allowance) -> InteractionList {
        let around = BoundingBox::from_points(points);
        InteractionList::new(self.tree, &around, points.len(), allowance.whole_t / allowance.nodes)
    }

    fn in_tesla(&self) -> f64 {
        if self.quantity == Quantity::FieldStrength { MU_0 } else { 1.0 }
    }
}

/// Among how many nodes an allowance is to be divided, if an assignment will be about like this one.
fn nodes_like(list: &InteractionList) -> f64 {
    USED_SHARE * list.expansions() as f64 + ROUGH_NODES
}
