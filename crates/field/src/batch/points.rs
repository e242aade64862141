//! A batch of points by coordinate, and sorted by form.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec3;

use super::column::{Column, views};
use super::lanes::{Lanes, Number, PAIR};
use super::range::{BEYOND, FORMS, Form, MIDDLE, OUTER, Range};
use crate::arrangement::{Arrangement, Frame};
use crate::scene::is_in_range;
use crate::tolerances::MAX_LENGTH;

/// Points by axis, filled up to whole pairs of vectors; not a number where the point is out of range.
#[derive(Debug, Default)]
pub(super) struct Coordinates {
    pub(super) axes: [Column; 3],
    /// Those that are not numbers.
    out_of_range: Vec<usize>,
}

impl Coordinates {
    pub(super) fn padded(&self) -> usize {
        self.axes[0].len()
    }

    /// In vectors, without a branch for each point.
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

    /// The coordinates of `points` in a frame; those of each point digit for digit as the arrangement gives them.
    #[inline(always)]
    pub(super) fn set_in_frame<S: Simd>(
        &mut self,
        simd: S,
        arrangement: &Arrangement,
        frame: &Frame,
        points: &Coordinates,
    ) {
        self.out_of_range.clone_from(&points.out_of_range);
        let [x, y, z] = &points.axes;
        for (axis, coordinates) in self.axes.iter_mut().enumerate() {
            let (direction, origin) = match arrangement.axis(frame, axis) {
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

    /// The least and the greatest coordinates.
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

    /// The coordinates of chosen points, filled up to whole pairs of vectors.
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

/// Indices of points by form.
#[derive(Debug, Default)]
pub(super) struct Chosen {
    /// One stretch for each form, then one for points that have none.
    indices: Vec<u32>,
    counts: [usize; FORMS + 1],
    stretch: usize,
    forms: Column,
}

impl Chosen {
    /// All the first `count` points, the closed form perhaps `stretched`. Those `beyond` a sphere, given by its centre and squared radius in the coordinates that come with it, have the form
    /// [`BEYOND`].
    pub(super) fn sort_all(
        &mut self,
        level: Level,
        range: &Range,
        points: &Coordinates,
        count: usize,
        stretched: bool,
        beyond: Option<(&Coordinates, ([f64; 3], f64))>,
    ) {
        self.find_forms(level, range, points, stretched);
        if let Some((points, sphere)) = beyond {
            dispatch!(level, simd => self.find_beyond(simd, points, sphere));
        }
        for index in 0..count {
            let form = if !points.out_of_range.is_empty() && points.axes[0][index].is_nan() {
                FORMS
            } else {
                (self.forms[index] as usize).min(BEYOND as usize)
            };
            self.add(form, index as u32);
        }
        if beyond.is_some() {
            self.fill_up();
        }
    }

    /// Gives so many points beyond the sphere to the closed form that those left fill pairs of vectors, if its own last pair has room for them and it serves so many:
    /// there they cost nothing, and a pair of the expansion is saved.
    fn fill_up(&mut self) {
        let Some(last) = [OUTER, MIDDLE].into_iter().find(|form| self.counts[usize::from(*form)] > 0) else { return };
        let (last, beyond) = (usize::from(last), usize::from(BEYOND));
        let (closed, spare) = (self.counts[last], self.counts[beyond] % PAIR);
        let start = beyond * self.stretch;
        let is_served = |index: u32| self.forms[index as usize] == (beyond + last) as f64;
        let served = (start..start + self.counts[beyond]).rev().filter(|&at| is_served(self.indices[at]));
        let room = closed.next_multiple_of(PAIR) - closed;
        let Some(first) = spare.checked_sub(1).filter(|_| spare <= room).and_then(|before| served.clone().nth(before))
        else {
            return;
        };
        let (mut kept, mut taken) = (first, last * self.stretch + closed);
        for at in first..start + self.counts[beyond] {
            let index = self.indices[at];
            let place = if is_served(index) { &mut taken } else { &mut kept };
            self.indices[*place] = index;
            *place += 1;
        }
        self.counts[beyond] -= spare;
        self.counts[last] += spare;
    }

    /// Points that have these indices in the batch.
    pub(super) fn sort(&mut self, level: Level, range: &Range, points: &Coordinates, indices: &[u32]) {
        self.find_forms(level, range, points, false);
        for (number, &index) in indices.iter().enumerate() {
            self.add(self.forms[number] as usize, index);
        }
    }

    fn find_forms(&mut self, level: Level, range: &Range, points: &Coordinates, stretched: bool) {
        self.stretch = points.padded();
        self.indices.resize((FORMS + 1) * self.stretch, 0);
        self.counts = [0; FORMS + 1];
        self.forms.set_len(self.stretch);
        dispatch!(level, simd => range.forms(simd, views(&points.axes), stretched, &mut self.forms));
    }

    #[inline(always)]
    fn find_beyond<S: Simd>(&mut self, simd: S, points: &Coordinates, (centre, square): ([f64; 3], f64)) {
        let [x, y, z] = &points.axes;
        for (number, forms) in self.forms.chunks_exact_mut(Lanes::<S>::LEN).enumerate() {
            let (start, end) = (number * Lanes::<S>::LEN, (number + 1) * Lanes::<S>::LEN);
            let x = Lanes::<S>::load(simd, &x[start..end]) - centre[0];
            let y = Lanes::<S>::load(simd, &y[start..end]) - centre[1];
            let z = Lanes::<S>::load(simd, &z[start..end]) - centre[2];
            let far = z.mul_add(z, y.mul_add(y, x * x)).at_least(simd, square);
            (far.mul_add(Lanes::<S>::splat(simd, f64::from(BEYOND)), Lanes::<S>::load(simd, forms))).store(forms);
        }
    }

    #[inline(always)]
    fn add(&mut self, form: usize, index: u32) {
        let form = form.min(FORMS);
        self.indices[form * self.stretch + self.counts[form]] = index;
        self.counts[form] += 1;
    }

    /// The forms that occur.
    pub(super) fn forms(&self) -> impl Iterator<Item = Form> + use<> {
        let counts = self.counts;
        (0..FORMS as Form).filter(move |form| counts[usize::from(*form)] > 0)
    }

    pub(super) fn points(&self, form: Form) -> &[u32] {
        let (form, start) = (usize::from(form), usize::from(form) * self.stretch);
        &self.indices[start..start + self.counts[form]]
    }
}
