//! The coordinates of a batch of points, by axis.

use fearless_simd::prelude::*;
use glam::DVec3;
use magsplice_magnet::tolerances::UNIT_ROUNDOFF;
use magsplice_magnet::{MAX_LENGTH, is_in_range};
use magsplice_simd::column::Column;
use magsplice_simd::lanes::{Lanes, Number, PAIR};

use crate::prepare::frames::{Frame, Frames};
use crate::tolerances::POINT_ROUNDINGS;

/// Points by axis, padded to whole pairs of vectors; NaN where a point is out of range.
#[derive(Debug, Default)]
pub(super) struct Coordinates {
    pub(super) axes: [Column; 3],
    /// Indices of the points out of range.
    pub(super) out_of_range: Vec<usize>,
}

impl Coordinates {
    pub(super) fn padded(&self) -> usize {
        self.axes[0].len()
    }

    /// Copies and checks points in vectors, without a branch for each point.
    #[inline(always)]
    pub(super) fn set<S: Simd>(&mut self, simd: S, points: &[DVec3]) {
        simd.vectorize(
            #[inline(always)]
            || self.copy(points),
        );
        self.out_of_range.clear();
        if !self.are_in_range(simd) {
            self.out_of_range.extend((0..points.len()).filter(|&index| !is_in_range(points[index])));
            for &index in &self.out_of_range {
                self.axes.iter_mut().for_each(|coordinates| coordinates[index] = f64::NAN);
            }
        }
    }

    #[inline(always)]
    fn copy(&mut self, points: &[DVec3]) {
        let last = points.last().copied().unwrap_or_default();
        let whole = points.len().next_multiple_of(PAIR);
        let [x, y, z] = &mut self.axes;
        for (coordinates, last) in [&mut *x, &mut *y, &mut *z].into_iter().zip(last.to_array()) {
            coordinates.set_len(whole);
            coordinates[points.len()..].fill(last);
        }
        for (((x, y), z), point) in x.iter_mut().zip(y.iter_mut()).zip(z.iter_mut()).zip(points) {
            (*x, *y, *z) = (point.x, point.y, point.z);
        }
    }

    #[inline(always)]
    fn are_in_range<S: Simd>(&self, simd: S) -> bool {
        let mut all = Lanes::<S>::splat(simd, 1.0);
        for axis in &self.axes {
            for lanes in axis.chunks_exact(Lanes::<S>::LEN) {
                all = all * Lanes::<S>::load(simd, lanes).abs().at_most(simd, MAX_LENGTH);
            }
        }
        (0..Lanes::<S>::LEN).all(|lane| all.lane(lane) != 0.0)
    }

    pub(super) fn out_of_range(&self) -> &[usize] {
        &self.out_of_range
    }

    /// Coordinates of `points` in a frame, bit-identical to [`Frames::locals`].
    #[inline(always)]
    pub(super) fn set_in_frame<S: Simd>(&mut self, simd: S, frames: &Frames, frame: &Frame, points: &Coordinates) {
        self.out_of_range.clone_from(&points.out_of_range);
        let [x, y, z] = &points.axes;
        for (axis, coordinates) in self.axes.iter_mut().enumerate() {
            let (direction, origin) = match frames.axis(frame, axis) {
                Ok(scene) => {
                    coordinates.copy_from(&points.axes[scene]);
                    continue;
                }
                Err(measured) => measured,
            };
            coordinates.set_len(x.len());
            for (number, coordinates) in coordinates.chunks_exact_mut(Lanes::<S>::LEN).enumerate() {
                let (start, end) = (number * Lanes::<S>::LEN, (number + 1) * Lanes::<S>::LEN);
                let x = (Lanes::<S>::load(simd, &x[start..end]) - origin.x) * direction.x;
                let y = (Lanes::<S>::load(simd, &y[start..end]) - origin.y) * direction.y;
                let z = (Lanes::<S>::load(simd, &z[start..end]) - origin.z) * direction.z;
                (x + y + z).store(coordinates);
            }
        }
    }

    /// Bounds of the errors of the coordinates of `points` in a frame, bit-identical to
    /// [`Frames::roundoff`].
    #[inline(always)]
    pub(super) fn set_roundoff<S: Simd>(&mut self, simd: S, frames: &Frames, frame: &Frame, points: &Coordinates) {
        let [x, y, z] = &points.axes;
        for (axis, bounds) in self.axes.iter_mut().enumerate() {
            bounds.set_len(x.len());
            let Err((_, origin)) = frames.axis(frame, axis) else {
                bounds.fill(0.0);
                continue;
            };
            for (number, bounds) in bounds.chunks_exact_mut(Lanes::<S>::LEN).enumerate() {
                let (start, end) = (number * Lanes::<S>::LEN, (number + 1) * Lanes::<S>::LEN);
                let x = (Lanes::<S>::load(simd, &x[start..end]) - origin.x).abs();
                let y = (Lanes::<S>::load(simd, &y[start..end]) - origin.y).abs();
                let z = (Lanes::<S>::load(simd, &z[start..end]) - origin.z).abs();
                ((x + y + z) * (POINT_ROUNDINGS * UNIT_ROUNDOFF)).store(bounds);
            }
        }
    }

    /// Smallest and largest coordinates.
    #[inline(always)]
    pub(super) fn reach<S: Simd>(&self, simd: S) -> ([f64; 3], [f64; 3]) {
        let (mut lows, mut highs) = ([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
        if !self.out_of_range.is_empty() {
            return (lows, highs);
        }
        for (axis, coordinates) in self.axes.iter().enumerate() {
            let mut low = Lanes::<S>::splat(simd, f64::INFINITY);
            let mut high = Lanes::<S>::splat(simd, f64::NEG_INFINITY);
            for lanes in coordinates.chunks_exact(Lanes::<S>::LEN) {
                let lanes = Lanes::<S>::load(simd, lanes);
                (low, high) = (low.min(lanes), high.max(lanes));
            }
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            for lane in 0..Lanes::<S>::LEN {
                least = least.min(low.lane(lane));
                most = most.max(high.lane(lane));
            }
            (lows[axis], highs[axis]) = (least, most);
        }
        (lows, highs)
    }

    /// Copies the chosen points, padded to whole pairs of vectors; all must be in range.
    pub(super) fn set_chosen(&mut self, points: &[DVec3], chosen: &[u32]) {
        for (axis, coordinates) in self.axes.iter_mut().enumerate() {
            coordinates.fill_with(0.0, chosen.len().next_multiple_of(PAIR));
            for (coordinate, &index) in coordinates.iter_mut().zip(chosen) {
                *coordinate = points[index as usize][axis];
            }
        }
    }

    /// Copies the chosen points, padded to whole pairs of vectors.
    pub(super) fn gather(&mut self, points: &Coordinates, chosen: &[u32]) {
        let whole = chosen.len().next_multiple_of(PAIR);
        for (from, to) in points.axes.iter().zip(&mut self.axes) {
            to.set_len(whole);
            for (to, &index) in to.iter_mut().zip(chosen) {
                *to = from[index as usize];
            }
            let last = to[chosen.len() - 1];
            to[chosen.len()..].fill(last);
        }
    }
}
