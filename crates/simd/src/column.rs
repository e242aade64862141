//! Numbers in memory aligned to cache lines.

use std::ops::{Deref, DerefMut};

use crate::lanes::LONGEST_VECTOR;

/// One number for each point of a batch, aligned to a cache line. The longest vectors fill a cache
/// line; an unaligned vector takes two memory accesses.
#[derive(Debug, Default)]
pub struct Column {
    room: Vec<f64>,
    start: usize,
    count: usize,
}

impl Column {
    /// Sets the number of values. Their content is unspecified.
    #[inline]
    pub fn set_len(&mut self, count: usize) {
        if self.start + count > self.room.len() {
            self.room = vec![0.0; count + LONGEST_VECTOR - 1];
            let line = LONGEST_VECTOR * size_of::<f64>();
            // Where the alignment is unknown, any start is correct.
            self.start = self.room.as_ptr().align_offset(line).min(LONGEST_VECTOR - 1);
        }
        self.count = count;
    }

    /// Sets all of `count` values.
    #[inline]
    pub fn fill_with(&mut self, value: f64, count: usize) {
        self.set_len(count);
        self.fill(value);
    }

    /// Replaces the values by a copy of `values`.
    #[inline]
    pub fn copy_from(&mut self, values: &[f64]) {
        self.set_len(values.len());
        self.copy_from_slice(values);
    }
}

impl Deref for Column {
    type Target = [f64];

    #[inline(always)]
    fn deref(&self) -> &[f64] {
        &self.room[self.start..self.start + self.count]
    }
}

impl DerefMut for Column {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.room[self.start..self.start + self.count]
    }
}

/// The values of three columns.
#[inline(always)]
pub fn views(columns: &[Column; 3]) -> [&[f64]; 3] {
    columns.each_ref().map(|column| &**column)
}

/// Three columns of `count` unspecified values, to be written.
#[inline]
pub fn room(columns: &mut [Column; 3], count: usize) -> [&mut [f64]; 3] {
    columns.each_mut().map(|column| {
        column.set_len(count);
        &mut **column
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_begin_with_a_cache_line_and_are_as_long_as_asked_for() {
        let mut column = Column::default();
        for count in [3, 8, 100, 7, 513, 0, 512] {
            column.fill_with(count as f64, count);
            assert!(column.len() == count && column.iter().all(|&value| value == count as f64));
            assert_eq!(column.as_ptr().addr() % 64, 0, "{count}");
        }
    }
}
