//! The field at points anywhere, to a tolerance: many points of a box without tiles by its expansion, others with tiles far away by expansions of
//! nodes of a tree (docs/physics.md, section 5.2).

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::accuracy::Tolerance;
use super::fitted_field::FittedField;
use super::magnitude::Box3;
use crate::batch::assignment::{Assigned, Assignment};
use crate::batch::far::Far;
use crate::evaluate::{PointError, neighbours_together};
use crate::quantity::{MU_0, Quantity};
use crate::scene::{Cause, Scene, is_in_range};
use crate::tolerances::{
    ASSIGNED_POINTS, ASSIGNMENT_ROUNDS, CLEAR_OF_ERROR, FAR_POINTS, FAR_SHARE, LEAST_SHARES, LEFT_OUT_OVER_MEAN,
    LOOKED_UP_POINTS, LOOKED_UP_TILES, POINTS_PER_DEGREE, POINTS_PER_FITTED_NODE, POINTS_PER_ROUND, POINTS_PER_WEAK,
    POINTS_TOGETHER, ROUGH_FIELD_OVER_J, ROUGH_NODES, ROUGH_STEP, ROUNDS_TO_SHARE, SAFE_SHARE, SAMPLED_POINTS,
    STRETCHED_BOUND, TREE_TILES, USED_SHARE,
};

/// B or H at all points; points that have none, with NaN there.
pub(crate) fn at_points(
    scene: &Scene,
    tolerance: Tolerance,
    quantity: Quantity,
    points: &[DVec3],
    field: &mut [DVec3],
) -> Vec<PointError> {
    let together = points.chunks(POINTS_TOGETHER).zip(field.chunks_mut(POINTS_TOGETHER)).enumerate();
    let errors = together.flat_map(|(number, (points, field))| {
        let errors = at_some_points(scene, tolerance, quantity, points, field);
        errors.into_iter().map(move |error| PointError { index: number * POINTS_TOGETHER + error.index, ..error })
    });
    errors.collect()
}

fn at_some_points(
    scene: &Scene,
    tolerance: Tolerance,
    quantity: Quantity,
    points: &[DVec3],
    field: &mut [DVec3],
) -> Vec<PointError> {
    field.fill(DVec3::NAN);
    let usable: Vec<u32> = match fitted(scene, tolerance, points) {
        Some(fitted) => {
            // All others are in the box, where |B| is large enough.
            let weak = fitted.flux_density_into(points, field).err().unwrap_or_default();
            if quantity == Quantity::FieldStrength {
                field.par_iter_mut().for_each(|h| *h /= MU_0);
            }
            weak.into_iter().map(|error| error.index as u32).collect()
        }
        None if scene.tile_count() < TREE_TILES => {
            let all: Vec<usize> = (0..points.len()).collect();
            return scene.exact_at(tolerance, quantity, points, &all, field);
        }
        None => (0..points.len() as u32).filter(|&index| is_in_range(points[index as usize])).collect(),
    };
    let size = batch_size(usable.len());
    let order = batches_together(points, usable, size);
    let near: Vec<DVec3> = order.iter().map(|&index| points[index as usize]).collect();
    let mut values = vec![DVec3::NAN; near.len()];
    let batches = near.par_chunks(size).zip(values.par_chunks_mut(size)).enumerate();
    let outcomes: Vec<Outcome> = batches
        .map(|(number, (points, values))| {
            let mut batch = Batch::new(scene, tolerance, quantity, points, values);
            batch.serve();
            batch.outcome.shifted(number * size)
        })
        .collect();
    for (&index, value) in order.iter().zip(values) {
        field[index as usize] = value;
    }
    let place = |position: usize| order[position] as usize;
    let failed = outcomes.iter().flat_map(|outcome| &outcome.failed);
    let mut errors: Vec<PointError> = failed
        .map(|&(position, cause)| PointError { index: place(position), point: points[place(position)], cause })
        .collect();
    let out_of_range = (0..points.len()).filter(|&index| !is_in_range(points[index]));
    let mut exact: Vec<usize> = outcomes.iter().flat_map(|outcome| &outcome.missed).map(|&p| place(p)).collect();
    exact.extend(out_of_range);
    exact.sort_unstable();
    errors.extend(scene.exact_at(tolerance, quantity, points, &exact, field));
    errors.sort_by_key(|error| error.index);
    errors
}

/// An expansion of the box around so many points that it pays, if there is one.
pub(super) fn fitted(scene: &Scene, tolerance: Tolerance, points: &[DVec3]) -> Option<FittedField> {
    let pays = points.len() >= LOOKED_UP_POINTS && scene.tile_count() >= LOOKED_UP_TILES;
    if !pays || !points.iter().all(|point| is_in_range(*point)) {
        return None;
    }
    let Box3 { lower, upper } = Box3::around(points);
    FittedField::of(scene, lower, upper, tolerance, points.len() / POINTS_PER_FITTED_NODE).ok()
}

/// What [`at_points`] tries first for each part of the points, with its number of points; but what may be left out is estimated for each anew.
pub(super) fn assignments(scene: &Scene, tolerance: Tolerance, points: &[DVec3]) -> Vec<(usize, Assignment)> {
    let usable: Vec<u32> = (0..points.len() as u32).filter(|&index| is_in_range(points[index as usize])).collect();
    let size = batch_size(usable.len());
    let order = batches_together(points, usable, size);
    let assignments = order.par_chunks(FAR_POINTS).flat_map_iter(|order| {
        let points: Vec<DVec3> = order.iter().map(|&index| points[index as usize]).collect();
        let mut batch = Batch::new(scene, tolerance, Quantity::FluxDensity, &points, &mut []);
        let parts = points.chunks(ASSIGNED_POINTS).map(|part| {
            let allowance = batch.first_allowance(part);
            batch.share(&points, part.len(), allowance);
            (part.len(), batch.assigned(part, allowance))
        });
        parts.collect::<Vec<_>>()
    });
    assignments.collect()
}

/// So few points that there are batches enough to share out, and otherwise so many that weak fields are found together.
fn batch_size(points: usize) -> usize {
    let [least, most] = POINTS_PER_ROUND;
    points.div_ceil(ROUNDS_TO_SHARE).next_multiple_of(ASSIGNED_POINTS).clamp(least, most)
}

/// An order in which neighbours follow each other: all points of a batch, and of these those that share an assignment.
fn batches_together(points: &[DVec3], usable: Vec<u32>, size: usize) -> Vec<u32> {
    neighbours_together(points, usable, &[size, FAR_POINTS, ASSIGNED_POINTS, POINTS_PER_DEGREE])
}

/// Points that lie together.
struct Batch<'a> {
    scene: &'a Scene,
    tolerance: Tolerance,
    quantity: Quantity,
    points: &'a [DVec3],
    /// What serves the parts at work together.
    far: Option<Arc<Far>>,
    values: &'a mut [DVec3],
    outcome: Outcome,
}

/// What has not been served.
#[derive(Default)]
struct Outcome {
    /// Points at which the tolerance was not reached.
    missed: Vec<usize>,
    /// Points that have no field.
    failed: Vec<(usize, Cause)>,
}

impl Outcome {
    fn shifted(mut self, by: usize) -> Outcome {
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
struct Served {
    assignment: Assignment,
    values: Vec<DVec3>,
    /// At most what was left out at each, in tesla.
    left_out_t: Vec<f64>,
    failed: Vec<(usize, Cause)>,
}

impl Served {
    /// Among how many nodes the next allowance is to be divided so that about all of it is left out.
    fn nodes(&self, allowance: Allowance) -> f64 {
        let own_t = allowance.whole_t / allowance.nodes;
        let mean_t = self.left_out_t.iter().sum::<f64>() / self.left_out_t.len() as f64;
        LEFT_OUT_OVER_MEAN * mean_t / own_t + LEAST_SHARES
    }
}

impl<'a> Batch<'a> {
    fn new(
        scene: &'a Scene,
        tolerance: Tolerance,
        quantity: Quantity,
        points: &'a [DVec3],
        values: &'a mut [DVec3],
    ) -> Batch<'a> {
        Batch { scene, tolerance, quantity, points, far: None, values, outcome: Outcome::default() }
    }

    fn serve(&mut self) {
        let all: Vec<usize> = (0..self.points.len()).collect();
        let (mut next, mut allowance) = (Next::default(), None);
        for together in all.chunks(FAR_POINTS) {
            for part in together.chunks(ASSIGNED_POINTS) {
                let own = allowance.unwrap_or_else(|| self.first_allowance(&self.points[..part.len()]));
                self.share(&self.points[together[0]..][..together.len()], part.len(), own);
                // The field hardly changes from these points to the next.
                allowance = Some(self.serve_some(part, own, &mut next));
            }
            self.far = None;
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
                let nodes = nodes_like(&self.assigned(&self.points_of(open), rough));
                self.serve_some(open, Allowance { whole_t, nodes }, &mut next);
            }
        }
        self.outcome.missed = next.missed;
    }

    /// Points that share an assignment. Returns what may be left out where the field is like that at these.
    fn serve_some(&mut self, open: &[usize], allowance: Allowance, next: &mut Next) -> Allowance {
        let served = self.evaluate(&self.points_of(open), allowance);
        let rounding_t = STRETCHED_BOUND * served.assignment.magnitude_t;
        let mut lengths_t = Vec::with_capacity(open.len());
        for ((&index, &value), &left_out_t) in open.iter().zip(&served.values).zip(&served.left_out_t) {
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
        let nodes = served.nodes(allowance);
        self.outcome.failed.extend(served.failed.into_iter().map(|(number, cause)| (open[number], cause)));
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
            Tolerance::Relative(fraction) => fraction * b_t,
            Tolerance::AbsoluteT(error_t) => error_t,
        }
    }

    fn first_allowance(&self, points: &[DVec3]) -> Allowance {
        match self.tolerance {
            Tolerance::AbsoluteT(error_t) => {
                let whole_t = SAFE_SHARE * error_t;
                let like = self.assigned(points, Allowance { whole_t, nodes: ROUGH_NODES });
                Allowance { whole_t, nodes: nodes_like(&like) }
            }
            Tolerance::Relative(fraction) => self.estimate(points, fraction),
        }
    }

    /// From a rough field at some of the points, what may be left out.
    fn estimate(&self, points: &[DVec3], fraction: f64) -> Allowance {
        let step = points.len().div_ceil(SAMPLED_POINTS);
        let some: Vec<DVec3> = points.iter().copied().step_by(step).collect();
        let mut allowance =
            Allowance { whole_t: ROUGH_FIELD_OVER_J * self.scene.tree().largest_j_t(), nodes: ROUGH_NODES };
        for _ in 0..ASSIGNMENT_ROUNDS {
            let served = self.evaluate(&some, allowance);
            let lengths = served.values.iter().filter(|b| !b.is_nan()).map(|b| b.length() * self.in_tesla());
            let least_t = lengths.fold(f64::INFINITY, f64::min);
            let (nodes, left_out_t) = (served.nodes(allowance), served.assignment.left_out_t);
            if left_out_t == 0.0 || least_t > CLEAR_OF_ERROR * left_out_t {
                let whole_t = if least_t.is_finite() { SAFE_SHARE * fraction * least_t } else { allowance.whole_t };
                return Allowance { whole_t, nodes };
            }
            allowance = Allowance { whole_t: ROUGH_STEP * left_out_t.min(allowance.whole_t), nodes };
        }
        allowance
    }

    fn evaluate(&self, points: &[DVec3], allowance: Allowance) -> Served {
        let mut served = Served {
            assignment: self.assigned(points, allowance),
            values: vec![DVec3::NAN; points.len()],
            left_out_t: vec![0.0; points.len()],
            failed: Vec::new(),
        };
        let Served { assignment, values, left_out_t, failed } = &mut served;
        let assigned = Some(Assigned { assignment, left_out_t });
        self.scene.field_of_batch(self.quantity, assigned, points, values, &mut |index, cause| {
            failed.push((index, cause));
        });
        served
    }

    /// What is far from points is served for all of them together, from the first part on, if they have several.
    fn share(&mut self, points: &[DVec3], part: usize, allowance: Allowance) {
        if self.far.is_none() && points.len() > part {
            let allowed_t = FAR_SHARE * allowance.whole_t / allowance.nodes;
            self.far = Some(Arc::new(Far::of(self.scene.tree(), &Box3::around(points), allowed_t)));
        }
    }

    fn assigned(&self, points: &[DVec3], allowance: Allowance) -> Assignment {
        Assignment::of(
            self.scene.tree(),
            self.far.as_ref(),
            &Box3::around(points),
            points.len(),
            allowance.whole_t / allowance.nodes,
        )
    }

    fn in_tesla(&self) -> f64 {
        if self.quantity == Quantity::FieldStrength { MU_0 } else { 1.0 }
    }
}

/// Among how many nodes an allowance is to be divided, if an assignment will be about like this one.
fn nodes_like(assignment: &Assignment) -> f64 {
    USED_SHARE * assignment.expansions() as f64 + ROUGH_NODES
}
