//! Memory requested before it is needed.

use glam::DVec3;
use prefetch_index::prefetch_index;

use crate::lanes::PAIR;

/// A cache line holds at least two points.
const POINTS_PER_LINE: usize = 2;

/// The next points, and the memory of their fields.
///
/// They are requested a few at a time during the computation. A request takes as long as the
/// computation of several vectors, and a processor handles only a few requests at a time.
pub struct Prefetch<'a> {
    points: &'a [DVec3],
    field: &'a [DVec3],
    /// The points before this index have been requested.
    next: usize,
}

impl<'a> Prefetch<'a> {
    /// Points and fields of which those before `next` have been requested.
    #[inline(always)]
    pub fn new(points: &'a [DVec3], field: &'a [DVec3], next: usize) -> Prefetch<'a> {
        Prefetch { points, field, next }
    }

    /// An empty prefetch, for points that are in the cache.
    #[inline(always)]
    pub fn nothing() -> Prefetch<'static> {
        Prefetch { points: &[], field: &[], next: 0 }
    }

    /// Requests the points of one step of the computation.
    #[inline(always)]
    pub fn request(&mut self) {
        let end = self.next + PAIR;
        if end <= self.points.len() {
            for index in (self.next..end).step_by(POINTS_PER_LINE) {
                prefetch_index(self.points, index);
                prefetch_index(self.field, index);
            }
            self.next = end;
        }
    }

    /// Index of the first point that has not been requested.
    #[inline(always)]
    pub fn next(&self) -> usize {
        self.next
    }
}
