//! Memory asked for before it is needed.

use glam::DVec3;
use prefetch_index::prefetch_index;

use crate::lanes::PAIR;

/// A line of a cache has two points at least.
const POINTS_PER_LINE: usize = 2;

/// Points, and where their fields will be written.
///
/// They are asked for a few at a time, while others are computed: it takes as long as some vectors, and only so many lines are on their way at a
/// time.
pub struct Ahead<'a> {
    points: &'a [DVec3],
    field: &'a [DVec3],
    /// Those before have been asked for.
    next: usize,
}

impl<'a> Ahead<'a> {
    #[inline(always)]
    pub fn of(points: &'a [DVec3], field: &'a [DVec3], next: usize) -> Ahead<'a> {
        Ahead { points, field, next }
    }

    /// For points that are at hand.
    #[inline(always)]
    pub fn nothing() -> Ahead<'static> {
        Ahead { points: &[], field: &[], next: 0 }
    }

    /// As many points more as are computed together.
    #[inline(always)]
    pub fn ask(&mut self) {
        let end = self.next + PAIR;
        if end <= self.points.len() {
            for index in (self.next..end).step_by(POINTS_PER_LINE) {
                prefetch_index(self.points, index);
                prefetch_index(self.field, index);
            }
            self.next = end;
        }
    }

    #[inline(always)]
    pub fn next(&self) -> usize {
        self.next
    }
}
