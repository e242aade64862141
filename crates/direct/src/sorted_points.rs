//! Indices of a batch of points, sorted by method.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use magsplice_cuboid::method::{FIRST_FAR, MOST_FAR, MethodIndex, MethodRanges};
use magsplice_simd::column::{Column, views};
use magsplice_simd::lanes::{Lanes, Number};

use super::coordinates::Coordinates;

/// The method of points outside a sphere around a cluster: an expansion to a tolerance.
pub(super) const BEYOND_SPHERE: MethodIndex = FIRST_FAR + MOST_FAR as MethodIndex;
/// Number of methods.
pub(super) const METHODS: usize = BEYOND_SPHERE as usize + 1;

/// Indices of points by method.
#[derive(Debug, Default)]
pub(super) struct SortedPoints {
    /// One block of indices for each method, and one for points out of range.
    indices: Vec<u32>,
    counts: [usize; METHODS + 1],
    stretch: usize,
    methods: Column,
}

impl SortedPoints {
    /// Sorts the first `count` points. `stretched` extends the closed form as a tolerance allows.
    /// Points outside the sphere `beyond` (its centre and squared radius, with its own coordinates
    /// of the points) have the method [`BEYOND_SPHERE`].
    pub(super) fn sort_all(
        &mut self,
        level: Level,
        ranges: &MethodRanges,
        points: &Coordinates,
        count: usize,
        stretched: bool,
        beyond: Option<(&Coordinates, ([f64; 3], f64))>,
    ) {
        self.find_methods(level, ranges, points, stretched);
        if let Some((points, sphere)) = beyond {
            dispatch!(level, simd => self.find_beyond(simd, points, sphere));
        }
        for index in 0..count {
            let method = if !points.out_of_range.is_empty() && points.axes[0][index].is_nan() {
                METHODS
            } else {
                (self.methods[index] as usize).min(BEYOND_SPHERE as usize)
            };
            self.add(method, index as u32);
        }
    }

    /// Sorts the points with these indices in the batch.
    pub(super) fn sort(&mut self, level: Level, ranges: &MethodRanges, points: &Coordinates, indices: &[u32]) {
        self.find_methods(level, ranges, points, false);
        for (number, &index) in indices.iter().enumerate() {
            self.add(self.methods[number] as usize, index);
        }
    }

    fn find_methods(&mut self, level: Level, ranges: &MethodRanges, points: &Coordinates, stretched: bool) {
        self.stretch = points.padded();
        self.indices.resize((METHODS + 1) * self.stretch, 0);
        self.counts = [0; METHODS + 1];
        self.methods.set_len(self.stretch);
        dispatch!(level, simd => ranges.methods(simd, views(&points.axes), stretched, &mut self.methods));
    }

    #[inline(always)]
    fn find_beyond<S: Simd>(&mut self, simd: S, points: &Coordinates, (centre, square): ([f64; 3], f64)) {
        let [x, y, z] = &points.axes;
        for (number, methods) in self.methods.chunks_exact_mut(Lanes::<S>::LEN).enumerate() {
            let (start, end) = (number * Lanes::<S>::LEN, (number + 1) * Lanes::<S>::LEN);
            let x = Lanes::<S>::load(simd, &x[start..end]) - centre[0];
            let y = Lanes::<S>::load(simd, &y[start..end]) - centre[1];
            let z = Lanes::<S>::load(simd, &z[start..end]) - centre[2];
            let far = z.mul_add(z, y.mul_add(y, x * x)).at_least(simd, square);
            (far.mul_add(Lanes::<S>::splat(simd, f64::from(BEYOND_SPHERE)), Lanes::<S>::load(simd, methods)))
                .store(methods);
        }
    }

    #[inline(always)]
    fn add(&mut self, method: usize, index: u32) {
        let method = method.min(METHODS);
        self.indices[method * self.stretch + self.counts[method]] = index;
        self.counts[method] += 1;
    }

    /// The methods of at least one point.
    pub(super) fn methods(&self) -> impl Iterator<Item = MethodIndex> + use<> {
        let counts = self.counts;
        (0..METHODS as MethodIndex).filter(move |method| counts[usize::from(*method)] > 0)
    }

    pub(super) fn points(&self, method: MethodIndex) -> &[u32] {
        let (method, start) = (usize::from(method), usize::from(method) * self.stretch);
        &self.indices[start..start + self.counts[method]]
    }
}
