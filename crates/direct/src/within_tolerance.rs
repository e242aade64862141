//! The exact field where it keeps a tolerance, judged by upper bounds of the magnitude.
//!
//! Cheap bounds come first, because they decide nearly all points.

use glam::DVec3;
use magsplice_cuboid::tolerances::EXACT_BOUND;
use magsplice_magnet::{MU_0, PointError, PointErrorCause, Quantity, Tolerance};

use super::batches::{PointProgress, for_each_batch};
use super::direct_sum::DirectSum;
use super::least_field::LeastField;
use super::open_points::OpenPoints;
use super::weak_points::WeakPoints;
use crate::prepare::frames::Frame;

/// Passes a point without a value to the caller: its index and the cause.
type Failed<'a> = &'a mut dyn FnMut(usize, PointErrorCause);

impl DirectSum {
    /// Writes the exact field at every point where it keeps the tolerance; returns the other
    /// points, where `field` is NaN.
    pub fn field_within_into(
        &self,
        tolerance: Tolerance,
        quantity: Quantity,
        points: &[DVec3],
        field: &mut [DVec3],
        progress: PointProgress,
    ) -> Vec<PointError> {
        let evaluated = for_each_batch(points, field, self.batches(), progress, |points, field, failed| {
            match self.frames().only_tile() {
                Some(frame) => self.only_tile_within(frame, tolerance, quantity, points, field, failed),
                None => self.tiles_within(tolerance, quantity, points, field, failed),
            }
        });
        evaluated.err().map_or(Vec::new(), |errors| errors.0)
    }

    /// The field of the only tile at each point of a batch. Points without one, and points at which
    /// the bound of its error does not keep the tolerance, are passed to `failed`, and their field
    /// is NaN.
    fn only_tile_within(
        &self,
        frame: &Frame,
        tolerance: Tolerance,
        quantity: Quantity,
        points: &[DVec3],
        field: &mut [DVec3],
        failed: Failed,
    ) {
        let least = LeastInUnit::new(tolerance, quantity);
        let mut weak = WeakPoints::new(tolerance, self.magnitudes_by_method(frame));
        self.field_and_weak_points_of_batch(quantity, points, field, Some(&mut weak), failed);
        if weak.points.is_empty() {
            return;
        }
        self.set_magnitudes(points, &mut weak.points);
        let is_weak = |&(index, own_t): &(u32, f64)| least.is_weak(field[index as usize], own_t);
        weak.points.retain(is_weak);
        if weak.points.is_empty() {
            return;
        }
        if let Some(mut closer) = weak.by_closed_form() {
            let again: Vec<DVec3> = weak.points.iter().map(|&(index, _)| points[index as usize]).collect();
            let mut values = vec![DVec3::ZERO; again.len()];
            self.field_and_weak_points_of_batch(quantity, &again, &mut values, Some(&mut closer), &mut |_, _| ());
            self.set_magnitudes(&again, &mut closer.points);
            closer.points.iter_mut().for_each(|(number, _)| *number = weak.points[*number as usize].0);
            closer.points.retain(is_weak);
            weak = closer;
        }
        // In the order of the points, which is not the order of their methods.
        let mut magnitudes_t = vec![None; points.len()];
        weak.points.iter().for_each(|&(index, own_t)| magnitudes_t[index as usize] = Some(own_t));
        for (index, own_t) in magnitudes_t.into_iter().enumerate() {
            if let Some(own_t) = own_t {
                refuse(index, own_t, field, failed);
            }
        }
    }

    /// Sets bounds that are infinite so far.
    fn set_magnitudes(&self, points: &[DVec3], bounds: &mut [(u32, f64)]) {
        let unknown: Vec<&mut (u32, f64)> = bounds.iter_mut().filter(|(_, own_t)| own_t.is_infinite()).collect();
        let at_unknown: Vec<DVec3> = unknown.iter().map(|(index, _)| points[*index as usize]).collect();
        unknown.into_iter().zip(self.magnitudes_t(&at_unknown)).for_each(|(bound, own_t)| bound.1 = own_t);
    }

    /// The same of several tiles.
    fn tiles_within(
        &self,
        tolerance: Tolerance,
        quantity: Quantity,
        points: &[DVec3],
        field: &mut [DVec3],
        failed: Failed,
    ) {
        let (magnitudes, least) = (self.magnitudes(), LeastInUnit::new(tolerance, quantity));
        self.field_of_batch(quantity, points, field, failed);
        OpenPoints::with_buffers(|open| {
            magnitudes.find_weak(self.level(), least.least, (points, &*field, least.per_tesla), self.boxes(), open);
            for (index, own_t) in open.bounds() {
                refuse(index, own_t, field, failed);
            }
        });
    }
}

fn refuse(index: usize, magnitude_t: f64, field: &mut [DVec3], failed: Failed) {
    field[index] = DVec3::NAN;
    failed(index, PointErrorCause::TooExact { bound_t: EXACT_BOUND * magnitude_t });
}

/// [`LeastField`] of the exact field, in the unit of a quantity.
struct LeastInUnit {
    least: LeastField,
    per_tesla: f64,
}

impl LeastInUnit {
    fn new(tolerance: Tolerance, quantity: Quantity) -> LeastInUnit {
        let per_tesla = if quantity == Quantity::FieldStrength { 1.0 / MU_0 } else { 1.0 };
        LeastInUnit { least: LeastField::new(tolerance), per_tesla }
    }

    /// Smallest square of the field that a magnitude allows.
    fn squared(&self, magnitude_t: f64) -> f64 {
        self.least.squared_at(EXACT_BOUND * magnitude_t) * self.per_tesla.powi(2)
    }

    fn is_weak(&self, field: DVec3, magnitude_t: f64) -> bool {
        field.length_squared() < self.squared(magnitude_t)
    }
}
