//! Compensated sums over tiles at a batch of points (Neumaier), in the frame of the scene.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::{DMat3, DVec3};
use magsplice_simd::column::{Column, views};
use magsplice_simd::compensated_sum::TwoSum;
use magsplice_simd::lanes::{Lanes, Number};

/// Sum and carry of each component.
#[derive(Debug, Default)]
pub(crate) struct Totals {
    sums: [Column; 3],
    carries: [Column; 3],
}

impl Totals {
    pub(crate) fn start(&mut self, count: usize) {
        for values in self.sums.iter_mut().chain(&mut self.carries) {
            values.fill_with(0.0, count);
        }
    }

    /// Writes the sums with their carries.
    pub(crate) fn write(&self, field: &mut [DVec3]) {
        let ([x, y, z], [p, q, r]) = (&self.sums, &self.carries);
        let count = field.len();
        let (x, y, z) = (&x[..count], &y[..count], &z[..count]);
        let (p, q, r) = (&p[..count], &q[..count], &r[..count]);
        for (index, field) in field.iter_mut().enumerate() {
            *field = DVec3::new(x[index] + p[index], y[index] + q[index], z[index] + r[index]);
        }
    }

    #[inline(always)]
    pub(crate) fn add_one(&mut self, index: usize, field: [f64; 3]) {
        for (axis, term) in field.into_iter().enumerate() {
            let step = TwoSum::new(self.sums[axis][index], term);
            self.sums[axis][index] = step.hi;
            self.carries[axis][index] += step.lo;
        }
    }

    /// Adds other sums at the same points.
    pub(crate) fn add_totals(&mut self, level: Level, other: &Totals) {
        dispatch!(level, simd => self.add_totals_by(simd, other));
    }

    #[inline(always)]
    fn add_totals_by<S: Simd>(&mut self, simd: S, other: &Totals) {
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

    /// Adds other sums, given at the points with the indices `chosen`.
    pub(crate) fn add_totals_at(&mut self, other: &Totals, chosen: &[u32]) {
        for axis in 0..3 {
            let terms = other.sums[axis].iter().zip(other.carries[axis].iter());
            for ((term, low), &index) in terms.zip(chosen) {
                let step = TwoSum::new(self.sums[axis][index as usize], *term);
                self.sums[axis][index as usize] = step.hi;
                let carry = &mut self.carries[axis][index as usize];
                *carry = (*carry + step.lo) + low;
            }
        }
    }

    /// Adds fields in a frame at all points, given by component.
    pub(crate) fn add_fields(&mut self, level: Level, rotation: Option<&DMat3>, fields: &[Column; 3]) {
        dispatch!(level, simd => self.add_fields_by(simd, rotation, fields));
    }

    #[inline(always)]
    fn add_fields_by<S: Simd>(&mut self, simd: S, rotation: Option<&DMat3>, fields: &[Column; 3]) {
        let len = Lanes::<S>::LEN;
        let [x, y, z] = views(fields);
        let fields = x.chunks_exact(len).zip(y.chunks_exact(len)).zip(z.chunks_exact(len));
        let [x, y, z] = self.sums.each_mut().map(|sums| sums.chunks_exact_mut(len));
        let [p, q, r] = self.carries.each_mut().map(|carries| carries.chunks_exact_mut(len));
        for (((x, y), z), (((sx, sy), sz), ((p, q), r))) in fields.zip(x.zip(y).zip(z).zip(p.zip(q).zip(r))) {
            let own = [Lanes::load(simd, x), Lanes::load(simd, y), Lanes::load(simd, z)];
            let [x, y, z] = in_scene::<S>(rotation, own);
            add_vector(simd, x, sx, p);
            add_vector(simd, y, sy, q);
            add_vector(simd, z, sz, r);
        }
    }

    /// Adds fields in a frame at the points with the indices `chosen`; `fields` is rotated in
    /// place.
    pub(crate) fn add_fields_at(
        &mut self,
        level: Level,
        rotation: Option<&DMat3>,
        fields: &mut [Column; 3],
        chosen: &[u32],
    ) {
        if rotation.is_some() {
            dispatch!(level, simd => turn(simd, rotation, fields));
        }
        let [x, y, z] = fields;
        for (((x, y), z), &index) in x.iter().zip(y.iter()).zip(z.iter()).zip(chosen) {
            self.add_one(index as usize, [*x, *y, *z]);
        }
    }
}

/// Adds a vector of terms to sums with carries.
#[inline(always)]
pub(crate) fn add_vector<S: Simd>(simd: S, term: Lanes<S>, sums: &mut [f64], carries: &mut [f64]) {
    let (sum, low) = Lanes::<S>::load(simd, sums).two_sum(term);
    sum.store(sums);
    (Lanes::<S>::load(simd, carries) + low).store(carries);
}

#[inline(always)]
fn turn<S: Simd>(simd: S, rotation: Option<&DMat3>, fields: &mut [Column; 3]) {
    for number in 0..fields[0].len() / Lanes::<S>::LEN {
        let turned = in_scene(rotation, load(simd, fields, number));
        for (values, turned) in fields.iter_mut().zip(turned) {
            turned.store(&mut values[number * Lanes::<S>::LEN..(number + 1) * Lanes::<S>::LEN]);
        }
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, [x, y, z]: &[Column; 3], number: usize) -> [Lanes<S>; 3] {
    let (start, end) = (number * Lanes::<S>::LEN, (number + 1) * Lanes::<S>::LEN);
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
