//! Running sums over tiles at a batch of points, without loss (Neumaier), in the scene's frame.

use fearless_simd::prelude::*;
use glam::{DMat3, DVec3};

use super::lanes::{LONGEST_VECTOR, Lanes, Number};
use super::one_tile::Pairwise;
use super::superposition::Source;
use crate::two_sum::TwoSum;

/// Sum and carry of each component.
#[derive(Clone, Debug, Default)]
pub(super) struct Totals {
    sums: [Vec<f64>; 3],
    carries: [Vec<f64>; 3],
}

impl Totals {
    pub(super) fn start(&mut self, count: usize) {
        for values in self.sums.iter_mut().chain(&mut self.carries) {
            values.clear();
            values.resize(count, 0.0);
        }
    }

    /// The sums with their carries.
    pub(super) fn write(&self, field: &mut [DVec3]) {
        let ([x, y, z], [p, q, r]) = (&self.sums, &self.carries);
        let count = field.len();
        let (x, y, z) = (&x[..count], &y[..count], &z[..count]);
        let (p, q, r) = (&p[..count], &q[..count], &r[..count]);
        for (index, field) in field.iter_mut().enumerate() {
            *field = DVec3::new(x[index] + p[index], y[index] + q[index], z[index] + r[index]);
        }
    }

    #[inline(always)]
    pub(super) fn add_one(&mut self, index: usize, field: [f64; 3]) {
        for (axis, term) in field.into_iter().enumerate() {
            let step = TwoSum::of(self.sums[axis][index], term);
            self.sums[axis][index] = step.hi;
            self.carries[axis][index] += step.lo;
        }
    }

    /// Adds the field of `source` at all points, given by axis and filled up to whole vectors.
    #[inline(always)]
    pub(super) fn add<S: Simd>(
        &mut self,
        simd: S,
        rotation: Option<&DMat3>,
        points: &[Vec<f64>; 3],
        mut source: impl Source<S>,
    ) {
        source.start(simd, [load(simd, points, 0), load(simd, points, 1)]);
        for number in 0..points[0].len() / Lanes::<S>::LEN {
            let field = source.field(simd, load(simd, points, number + 2));
            self.add_vector(simd, number, in_scene::<S>(rotation, field));
        }
    }

    /// The same of what takes two vectors at a time.
    #[inline(always)]
    pub(super) fn add_pairs<S: Simd>(
        &mut self,
        simd: S,
        rotation: Option<&DMat3>,
        points: &[Vec<f64>; 3],
        what: &impl Pairwise<S>,
    ) {
        self.add_varied_pairs(simd, rotation, points, |_| what);
    }

    /// The same of what depends on the index of the first point of both vectors.
    #[inline(always)]
    pub(super) fn add_varied_pairs<S: Simd, P: Pairwise<S>>(
        &mut self,
        simd: S,
        rotation: Option<&DMat3>,
        points: &[Vec<f64>; 3],
        what: impl Fn(usize) -> P,
    ) {
        let count = points[0].len() / Lanes::<S>::LEN;
        for number in (0..count).step_by(2) {
            let [first, second] = what(number * Lanes::<S>::LEN)
                .fields(simd, [load(simd, points, number), load(simd, points, number + 1)]);
            self.add_vector(simd, number, in_scene::<S>(rotation, first));
            if number + 1 < count {
                self.add_vector(simd, number + 1, in_scene::<S>(rotation, second));
            }
        }
    }

    #[inline(always)]
    fn add_vector<S: Simd>(&mut self, simd: S, number: usize, field: [Lanes<S>; 3]) {
        let (start, end) = (number * Lanes::<S>::LEN, (number + 1) * Lanes::<S>::LEN);
        for (axis, term) in field.into_iter().enumerate() {
            let (sums, carries) = (&mut self.sums[axis][start..end], &mut self.carries[axis][start..end]);
            let before = Lanes::<S>::load(simd, sums);
            let (sum, low) = before.two_sum(term);
            sum.store(sums);
            (Lanes::<S>::load(simd, carries) + low).store(carries);
        }
    }

    /// Adds other sums at the same points.
    #[inline(always)]
    pub(super) fn add_totals<S: Simd>(&mut self, simd: S, other: &Totals) {
        for axis in 0..3 {
            let own = self.sums[axis]
                .chunks_exact_mut(Lanes::<S>::LEN)
                .zip(self.carries[axis].chunks_exact_mut(Lanes::<S>::LEN));
            let others =
                other.sums[axis].chunks_exact(Lanes::<S>::LEN).zip(other.carries[axis].chunks_exact(Lanes::<S>::LEN));
            for ((sums, carries), (terms, lows)) in own.zip(others) {
                let (before, term) = (Lanes::<S>::load(simd, sums), Lanes::<S>::load(simd, terms));
                let (sum, low) = before.two_sum(term);
                sum.store(sums);
                ((Lanes::<S>::load(simd, carries) + low) + Lanes::<S>::load(simd, lows)).store(carries);
            }
        }
    }

    /// Adds other sums, which are those at the points with the indices `chosen`.
    pub(super) fn add_totals_at(&mut self, other: &Totals, chosen: &[u32]) {
        for axis in 0..3 {
            let terms = other.sums[axis].iter().zip(&other.carries[axis]);
            for ((term, low), &index) in terms.zip(chosen) {
                let step = TwoSum::of(self.sums[axis][index as usize], *term);
                self.sums[axis][index as usize] = step.hi;
                let carry = &mut self.carries[axis][index as usize];
                *carry = (*carry + step.lo) + low;
            }
        }
    }

    /// Adds fields at all points, given by component.
    #[inline(always)]
    pub(super) fn add_fields<S: Simd>(&mut self, simd: S, rotation: Option<&DMat3>, fields: &[Vec<f64>; 3]) {
        for number in 0..self.sums[0].len() / Lanes::<S>::LEN {
            self.add_vector(simd, number, in_scene::<S>(rotation, load(simd, fields, number)));
        }
    }

    /// Adds fields at the points with the indices `chosen`, which are turned in place.
    #[inline(always)]
    pub(super) fn add_fields_at<S: Simd>(
        &mut self,
        simd: S,
        rotation: Option<&DMat3>,
        fields: &mut [Vec<f64>; 3],
        chosen: &[u32],
    ) {
        if rotation.is_some() {
            for number in 0..fields[0].len() / Lanes::<S>::LEN {
                let turned = in_scene(rotation, load(simd, fields, number));
                for (values, turned) in fields.iter_mut().zip(turned) {
                    turned.store(&mut values[number * Lanes::<S>::LEN..(number + 1) * Lanes::<S>::LEN]);
                }
            }
        }
        let [x, y, z] = fields;
        for (((x, y), z), &index) in x.iter().zip(y).zip(z).zip(chosen) {
            self.add_one(index as usize, [*x, *y, *z]);
        }
    }

    /// Adds the field of `source` at the points with the indices `chosen`.
    #[inline(always)]
    pub(super) fn add_some<S: Simd>(
        &mut self,
        simd: S,
        rotation: Option<&DMat3>,
        points: &[Vec<f64>; 3],
        chosen: &[u32],
        mut source: impl Source<S>,
    ) {
        source.start(simd, [load(simd, points, 0), load(simd, points, 1)]);
        for (number, chosen) in chosen.chunks(Lanes::<S>::LEN).enumerate() {
            let field = source.field(simd, load(simd, points, number + 2));
            self.add_at(simd, chosen, in_scene::<S>(rotation, field));
        }
    }

    /// The same of what takes two vectors at a time.
    #[inline(always)]
    pub(super) fn add_some_pairs<S: Simd>(
        &mut self,
        simd: S,
        rotation: Option<&DMat3>,
        points: &[Vec<f64>; 3],
        chosen: &[u32],
        what: &impl Pairwise<S>,
    ) {
        self.add_some_varied_pairs(simd, rotation, points, chosen, |_| what);
    }

    /// See [`Totals::add_varied_pairs`]; the index is that among the chosen.
    #[inline(always)]
    pub(super) fn add_some_varied_pairs<S: Simd, P: Pairwise<S>>(
        &mut self,
        simd: S,
        rotation: Option<&DMat3>,
        points: &[Vec<f64>; 3],
        chosen: &[u32],
        what: impl Fn(usize) -> P,
    ) {
        for (pair, chosen) in chosen.chunks(2 * Lanes::<S>::LEN).enumerate() {
            let start = 2 * pair * Lanes::<S>::LEN;
            let [first, second] =
                what(start).fields(simd, [load(simd, points, 2 * pair), load(simd, points, 2 * pair + 1)]);
            let (chosen, others) = chosen.split_at(chosen.len().min(Lanes::<S>::LEN));
            self.add_at(simd, chosen, in_scene::<S>(rotation, first));
            self.add_at(simd, others, in_scene::<S>(rotation, second));
        }
    }

    #[inline(always)]
    fn add_at<S: Simd>(&mut self, simd: S, chosen: &[u32], field: [Lanes<S>; 3]) {
        // The present sums side by side, as the points are.
        let mut sums = [[0.0; LONGEST_VECTOR]; 3];
        for (axis, term) in field.into_iter().enumerate() {
            for (sum, &index) in sums[axis].iter_mut().zip(chosen) {
                *sum = self.sums[axis][index as usize];
            }
            let before = Lanes::<S>::load(simd, &sums[axis][..Lanes::<S>::LEN]);
            let (sum, low) = before.two_sum(term);
            for (lane, &index) in chosen.iter().enumerate() {
                self.sums[axis][index as usize] = sum.lane(lane);
                self.carries[axis][index as usize] += low.lane(lane);
            }
        }
    }
}

/// One vector of points; beyond the last the first again, to have something to prepare.
#[inline(always)]
fn load<S: Simd>(simd: S, [x, y, z]: &[Vec<f64>; 3], number: usize) -> [Lanes<S>; 3] {
    let start = number * Lanes::<S>::LEN;
    let start = if start < x.len() { start } else { 0 };
    let end = start + Lanes::<S>::LEN;
    [Lanes::load(simd, &x[start..end]), Lanes::load(simd, &y[start..end]), Lanes::load(simd, &z[start..end])]
}

#[inline(always)]
fn in_scene<S: Simd>(rotation: Option<&DMat3>, own: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    let Some(m) = rotation else { return own };
    let mut field = own;
    for (row, component) in field.iter_mut().enumerate() {
        *component = own[2].scale_add(m.z_axis[row], own[1].scale_add(m.y_axis[row], own[0] * m.x_axis[row]));
    }
    field
}
