//! Points inside a compact cuboid and close to its edges, and points close to plates and rods, in
//! vectors (docs/physics.md, section 2.6).
//!
//! These methods keep the digits that the closed form of `single_tile` loses near an edge. In a
//! compact cuboid each edge and each corner has its own term, free of cancellation. The sum of the
//! terms is accurate to the round-off of the largest term. This is sufficient where every column of
//! the tensor is nearly as large: inside and close to a cuboid that is neither a plate nor a rod.

use std::f64::consts::PI;

use fearless_simd::prelude::*;
use magsplice_simd::functions::Functions;
use magsplice_simd::lanes::{Lanes, Number};
use magsplice_simd::power_of_two::power_of_two_reciprocal;

use super::positive::Octant;
use super::single_tile::ClosedForm;
use super::terms::Form;
use crate::block::{Block, LocalPoint};
use crate::scalar::kernel::FieldKind;
use crate::tolerances::{LEAST_OFFSET, NEAR_EDGE_ASPECT, NEAR_FRACTION, POSITIVE_FIELD_REACH, THIN_FROM, THINNEST};
use magsplice_simd::compensated_sum::TwoSum;

/// The points inside a tile or close to it, and clearly off the planes of all faces.
pub struct Interior {
    faces: [[TwoSum; 2]; 3],
    /// Smallest distance from the plane of a face. The scalar kernel evaluates nearer points.
    least_offset: f64,
    /// Largest distance along an axis. Other methods evaluate points farther away.
    reach: f64,
}

impl Interior {
    /// Prepares a block.
    pub fn new(block: &Block) -> Interior {
        let largest = block.size.into_iter().fold(0.0, f64::max);
        Interior { faces: block.faces, least_offset: LEAST_OFFSET * largest, reach: NEAR_FRACTION * largest }
    }

    /// The same with this largest distance along an axis.
    pub fn within(self, reach: f64) -> Interior {
        Interior { reach, ..self }
    }

    /// Whether a point is inside the tile or close to it, and clearly off the planes of all faces.
    pub fn covers(&self, point: &LocalPoint) -> bool {
        greatest_gap(&self.faces, point) <= self.reach && self.is_off_planes(point)
    }

    /// [`Interior::covers`] at points given by axis in whole vectors, with the bounds of the errors
    /// of their coordinates: 1 or 0.
    #[inline(never)]
    pub fn cover<S: Simd>(&self, simd: S, points: [&[f64]; 3], roundoff: [&[f64]; 3], covered: &mut [f64]) {
        simd.vectorize(
            #[inline(always)]
            || {
                for (number, covered) in covered.chunks_exact_mut(Lanes::<S>::LEN).enumerate() {
                    let (point, roundoff) = (load(simd, points, number), load(simd, roundoff, number));
                    self.cover_vector(simd, point, roundoff).store(covered);
                }
            },
        );
    }

    #[inline(always)]
    fn cover_vector<S: Simd>(&self, simd: S, point: [Lanes<S>; 3], roundoff: [Lanes<S>; 3]) -> Lanes<S> {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let mut covered = greatest_gap_of_vector(simd, &self.faces, point).at_most(simd, self.reach);
        for axis in 0..3 {
            for face in self.faces[axis] {
                let offset = ((point[axis] - face.hi) - face.lo).abs();
                covered = offset.where_more(self.least_offset, covered, zero);
                covered = covered * (offset - roundoff[axis]).where_more(0.0, one, zero);
            }
        }
        covered
    }

    /// Whether a point is clearly off the planes of all faces.
    pub fn is_off_planes(&self, point: &LocalPoint) -> bool {
        (0..3).all(|axis| {
            let least = self.least_offset.max(point.roundoff[axis]);
            self.faces[axis].iter().all(|face| ((point.coordinates[axis] - face.hi) - face.lo).abs() > least)
        })
    }
}

/// Largest number of forms of one tile for points close to it.
pub const NEAR_FORMS: usize = 2;

/// A tile for points close to it, with one or two forms.
pub struct NearEdges(Vec<NearEdge>);

/// One form of a tile for points close to it.
pub(crate) enum NearEdge {
    /// A compact tile, inside and outside.
    Compact(Box<NearCompact>),
    /// A plate or a rod, inside and very close to it.
    Positive(Box<NearPositive>),
    /// A plate or a rod, outside.
    Thin(Box<NearThin>),
}

/// A plate or a rod for points inside it and very close to it, evaluated by [`Octant`].
pub(crate) struct NearPositive {
    faces: [[TwoSum; 2]; 3],
    interior: Interior,
    scale: f64,
    /// Side lengths, scaled.
    size: [f64; 3],
    /// Axes a, b, c, whose sides decrease.
    axes: [usize; 3],
    polarization_t: [f64; 3],
    part: FieldKind,
}

/// A plate or a rod for points outside and close to it, evaluated by [`Form::Thin`].
pub(crate) struct NearThin {
    faces: [[TwoSum; 2]; 3],
    /// Distances along an axis at which the form begins and ends.
    reach: [f64; 2],
    closed_form: ClosedForm,
}

/// A compact tile for points inside it and close to it.
pub(crate) struct NearCompact {
    faces: [[TwoSum; 2]; 3],
    interior: Interior,
    scale: f64,
    /// Side lengths, scaled.
    size: [f64; 3],
    polarization_t: [f64; 3],
    part: FieldKind,
}

impl NearEdges {
    /// Prepares a block. There is no form if its sides differ too much.
    pub fn new(block: &Block, part: FieldKind) -> NearEdges {
        let [x, y, z] = block.size;
        let (largest, smallest) = (x.max(y).max(z), x.min(y).min(z));
        let scale = power_of_two_reciprocal(largest);
        let (faces, polarization_t) = (block.faces, block.polarization_t.to_array());
        let size = block.size.map(|size| size * scale);
        if smallest >= NEAR_EDGE_ASPECT * largest {
            let interior = Interior::new(block);
            return NearEdges(vec![NearEdge::Compact(Box::new(NearCompact {
                faces,
                interior,
                scale,
                size,
                polarization_t,
                part,
            }))]);
        }
        if smallest < THINNEST * largest {
            return NearEdges(Vec::new());
        }
        let mut axes = [0, 1, 2];
        axes.sort_by(|&a, &b| block.size[b].total_cmp(&block.size[a]));
        let from = (NEAR_FRACTION * smallest).max(THIN_FROM * block.size[axes[1]]);
        NearEdges(vec![
            NearEdge::Positive(Box::new(NearPositive {
                faces,
                interior: Interior::new(block).within(from.min(POSITIVE_FIELD_REACH * smallest)),
                scale,
                size,
                axes,
                polarization_t,
                part,
            })),
            NearEdge::Thin(Box::new(NearThin {
                faces,
                reach: [from, NEAR_FRACTION * largest],
                closed_form: ClosedForm::new(block, scale, Form::Thin),
            })),
        ])
    }

    /// The form for a point, as an index below [`NEAR_FORMS`].
    pub fn form(&self, point: &LocalPoint) -> Option<usize> {
        self.0.iter().position(|form| form.covers(point))
    }

    /// [`NearEdges::form`] of points given by axis in whole vectors, with the bounds of the errors
    /// of their coordinates; [`NEAR_FORMS`] where there is no form.
    #[inline(never)]
    pub fn forms<S: Simd>(&self, simd: S, points: [&[f64]; 3], roundoff: [&[f64]; 3], forms: &mut [f64]) {
        simd.vectorize(
            #[inline(always)]
            || {
                for (number, forms) in forms.chunks_exact_mut(Lanes::<S>::LEN).enumerate() {
                    let (point, roundoff) = (load(simd, points, number), load(simd, roundoff, number));
                    let mut first = Lanes::splat(simd, NEAR_FORMS as f64);
                    for (index, form) in self.0.iter().enumerate().rev() {
                        let covered = form.cover_vector(simd, point, roundoff);
                        first = covered.where_more(0.0, Lanes::splat(simd, index as f64), first);
                    }
                    first.store(forms);
                }
            },
        );
    }

    /// B or mu0 H of the tile in tesla, in its frame, at points given by axis in whole vectors.
    pub fn fields<S: Simd>(&self, simd: S, form: usize, points: [&[f64]; 3], fields: [&mut [f64]; 3]) {
        self.0[form].fields(simd, points, fields);
    }

    /// The form for a point.
    #[cfg(test)]
    pub(crate) fn covering(&self, point: &LocalPoint) -> Option<&NearEdge> {
        self.form(point).map(|form| &self.0[form])
    }
}

impl NearEdge {
    fn covers(&self, point: &LocalPoint) -> bool {
        match self {
            NearEdge::Compact(tile) => tile.interior.covers(point),
            NearEdge::Positive(tile) => tile.interior.covers(point),
            NearEdge::Thin(tile) => {
                let gap = greatest_gap(&tile.faces, point);
                tile.reach[0] <= gap && gap <= tile.reach[1]
            }
        }
    }

    #[inline(always)]
    fn cover_vector<S: Simd>(&self, simd: S, point: [Lanes<S>; 3], roundoff: [Lanes<S>; 3]) -> Lanes<S> {
        match self {
            NearEdge::Compact(tile) => tile.interior.cover_vector(simd, point, roundoff),
            NearEdge::Positive(tile) => tile.interior.cover_vector(simd, point, roundoff),
            NearEdge::Thin(tile) => {
                let gap = greatest_gap_of_vector(simd, &tile.faces, point);
                gap.at_least(simd, tile.reach[0]) * gap.at_most(simd, tile.reach[1])
            }
        }
    }

    #[inline(never)]
    fn fields<S: Simd>(&self, simd: S, [x, y, z]: [&[f64]; 3], [fx, fy, fz]: [&mut [f64]; 3]) {
        simd.vectorize(
            #[inline(always)]
            || {
                for start in (0..x.len()).step_by(Lanes::<S>::LEN) {
                    let lanes = start..start + Lanes::<S>::LEN;
                    let point = [
                        Lanes::load(simd, &x[lanes.clone()]),
                        Lanes::load(simd, &y[lanes.clone()]),
                        Lanes::load(simd, &z[lanes.clone()]),
                    ];
                    let field = match self {
                        NearEdge::Compact(tile) => tile.field(simd, point),
                        NearEdge::Positive(tile) => tile.field(simd, point),
                        NearEdge::Thin(tile) => tile.field(simd, point),
                    };
                    field[0].store(&mut fx[lanes.clone()]);
                    field[1].store(&mut fy[lanes.clone()]);
                    field[2].store(&mut fz[lanes]);
                }
            },
        );
    }
}

/// The greatest distance of a point from the tile along any of its axes; zero inside.
fn greatest_gap(faces: &[[TwoSum; 2]; 3], point: &LocalPoint) -> f64 {
    let gap = |axis: usize| {
        let ([low, high], at) = (faces[axis], point.coordinates[axis]);
        (low.hi - at).max(at - high.hi).max(0.0)
    };
    gap(0).max(gap(1)).max(gap(2))
}

/// [`greatest_gap`] of a vector of points.
#[inline(always)]
fn greatest_gap_of_vector<S: Simd>(simd: S, faces: &[[TwoSum; 2]; 3], point: [Lanes<S>; 3]) -> Lanes<S> {
    let mut gap = Lanes::splat(simd, 0.0);
    for ([low, high], at) in faces.iter().zip(point) {
        let below = Lanes::splat(simd, low.hi) - at;
        gap = gap.max(below).max(at - high.hi);
    }
    gap
}

#[inline(always)]
fn load<S: Simd>(simd: S, [x, y, z]: [&[f64]; 3], number: usize) -> [Lanes<S>; 3] {
    let lanes = number * Lanes::<S>::LEN..(number + 1) * Lanes::<S>::LEN;
    [Lanes::load(simd, &x[lanes.clone()]), Lanes::load(simd, &y[lanes.clone()]), Lanes::load(simd, &z[lanes])]
}

/// Scaled offsets of points from the low and high faces along each axis, and twice their offsets
/// from the centre. The sum of the offsets from both faces has lost the digits of small ones.
#[inline(always)]
pub(crate) fn offsets_and_steps<N: Functions>(
    simd: N::Instructions,
    faces: &[[TwoSum; 2]; 3],
    scale: f64,
    point: [N; 3],
) -> ([[N; 2]; 3], [N; 3]) {
    let zero = N::splat(simd, 0.0);
    let (mut offsets, mut steps) = ([[zero; 2]; 3], [zero; 3]);
    for (axis, coordinate) in point.into_iter().enumerate() {
        let [low, high] = faces[axis];
        for (offset, face) in offsets[axis].iter_mut().zip([low, high]) {
            *offset = ((coordinate - face.hi) - face.lo) * scale;
        }
        let centre = TwoSum::new(low.hi, high.hi);
        steps[axis] = ((coordinate + coordinate - centre.hi) - (centre.lo + low.lo + high.lo)) * scale;
    }
    (offsets, steps)
}

impl NearPositive {
    /// B or mu0 H in tesla.
    #[inline(always)]
    pub(crate) fn field<N: Functions>(&self, simd: N::Instructions, point: [N; 3]) -> [N; 3] {
        let (zero, one) = (N::splat(simd, 0.0), N::splat(simd, 1.0));
        let (offsets, steps) = offsets_and_steps(simd, &self.faces, self.scale, point);
        let place = Octant::new(simd, offsets, steps, self.size);
        let mut inside = one;
        for [near, _] in place.faces {
            inside = near.where_at_least(0.0, zero, inside);
        }
        let j = self.polarization_t;
        let mut field = [zero; 3];
        for edges in 0..3 {
            let (i, k) = ((edges + 1) % 3, (edges + 2) % 3);
            if j[i] != 0.0 || j[k] != 0.0 {
                let half = place.off_diagonal(simd, [i, k, edges]);
                field[i] = half.scale_add(j[k] / (2.0 * PI), field[i]);
                field[k] = half.scale_add(j[i] / (2.0 * PI), field[k]);
            }
        }
        // T_cc is minus the sum of the others, and minus 1 inside.
        let [a, b, c] = self.axes;
        let is_density = self.part == FieldKind::Density;
        for own in [a, b] {
            if j[own] != 0.0 || j[c] != 0.0 {
                let element = place.diagonal(simd, [own, a + b - own, c]);
                field[own] = element.scale_add(j[own] / (4.0 * PI), field[own]);
                field[c] = element.scale_add(-j[c] / (4.0 * PI), field[c]);
                if is_density {
                    field[own] = inside.scale_add(j[own], field[own]);
                }
            }
        }
        if !is_density {
            field[c] = inside.scale_add(-j[c], field[c]);
        }
        field
    }
}

impl NearThin {
    /// mu0 H in tesla, which is B outside.
    #[inline(always)]
    pub(crate) fn field<N: Functions>(&self, simd: N::Instructions, point: [N; 3]) -> [N; 3] {
        self.closed_form.field_of_thin(simd, &self.closed_form.place(simd, point))
    }
}

impl NearCompact {
    /// B or mu0 H in tesla.
    #[inline(always)]
    pub(crate) fn field<N: Functions>(&self, simd: N::Instructions, point: [N; 3]) -> [N; 3] {
        let (zero, one) = (N::splat(simd, 0.0), N::splat(simd, 1.0));
        let (offsets, _) = offsets_and_steps(simd, &self.faces, self.scale, point);
        let mut inside = one;
        for [low, high] in offsets {
            inside = low.where_at_least(0.0, high.where_at_least(0.0, zero, inside), zero);
        }
        let mut distances = [zero; 8];
        for (corner, distance) in distances.iter_mut().enumerate() {
            let [x, y, z] = [offsets[0][corner & 1], offsets[1][corner >> 1 & 1], offsets[2][corner >> 2]];
            *distance = x.mul_add(x, y.mul_add(y, z * z)).root(simd);
        }
        let mut field = [zero; 3];
        for edges in 0..3 {
            let (i, j) = ((edges + 1) % 3, (edges + 2) % 3);
            let (ji, jj) = (self.polarization_t[i], self.polarization_t[j]);
            if ji != 0.0 || jj != 0.0 {
                let half = half_of_edges(simd, &offsets, &distances, [i, j, edges], self.size[edges]);
                field[i] = half.scale_add(jj / (2.0 * PI), field[i]);
                field[j] = half.scale_add(ji / (2.0 * PI), field[j]);
            }
        }
        for (axis, (component, &j)) in field.iter_mut().zip(&self.polarization_t).enumerate() {
            if j != 0.0 {
                let angles = angles_of_faces(simd, &offsets, &distances, axis);
                *component = angles.scale_add(-j / (4.0 * PI), *component);
                if self.part == FieldKind::Density {
                    *component = inside.scale_add(j, *component);
                }
            }
        }
        field
    }
}

/// Distance from the corner on these sides along axes i, j, k.
#[inline(always)]
fn at<N: Copy>(distances: &[N; 8], [i, j, k]: [usize; 3], [bi, bj, bk]: [usize; 3]) -> N {
    distances[bi << i | bj << j | bk << k]
}

/// 2 pi T_ij from the four edges along k, each as ln((S + l) / (S - l)) (Eq. P4), with S - l by Eq.
/// P7 without its divisions.
#[inline(always)]
fn half_of_edges<N: Functions>(
    simd: N::Instructions,
    offsets: &[[N; 2]; 3],
    distances: &[N; 8],
    axes: [usize; 3],
    length: f64,
) -> N {
    let (zero, one, length) = (N::splat(simd, 0.0), N::splat(simd, 1.0), N::splat(simd, length));
    let [i, j, k] = axes;
    let [low, high] = offsets[k];
    let beyond = high.where_at_least(0.0, high, (zero - low).where_at_least(0.0, zero - low, zero));
    let overhang = beyond * 2.0;
    let (low, high) = (absolute(simd, low), absolute(simd, high));
    let mut products = [one; 2];
    for bi in 0..2 {
        for bj in 0..2 {
            let (first, second) = (at(distances, axes, [bi, bj, 0]), at(distances, axes, [bi, bj, 1]));
            let (a, b) = (first + low, second + high);
            let (x, y) = (offsets[i][bi], offsets[j][bj]);
            let product = a * b;
            let minus = x.mul_add(x, y * y).mul_add(a + b, overhang * product);
            let plus = (first + second + length) * product;
            let own = bi ^ bj;
            products[own] = products[own] * plus;
            products[1 - own] = products[1 - own] * minus;
        }
    }
    N::half_logarithm_of_ratio(simd, products[0], products[1]).divided(simd)
}

/// Solid angle of the lower face across an axis minus the solid angle of the upper face, each
/// positive for points above it: the angle of a product of complex numbers, x R + i y z at two
/// corners and their conjugates at the other two.
#[inline(always)]
fn angles_of_faces<N: Functions>(simd: N::Instructions, offsets: &[[N; 2]; 3], distances: &[N; 8], axis: usize) -> N {
    let axes = [axis, (axis + 1) % 3, (axis + 2) % 3];
    let [_, j, k] = axes;
    let (zero, turn) = (N::splat(simd, 0.0), N::splat(simd, 2.0 * PI));
    // The angle exceeds half a turn only where the point is above or below the face.
    let (across_j, across_k) = (offsets[j][0] * offsets[j][1], offsets[k][0] * offsets[k][1]);
    let beyond = across_j.where_at_least(0.0, zero, across_k.where_at_least(0.0, zero, turn));
    let mut faces = [zero; 2];
    for (side, face) in faces.iter_mut().enumerate() {
        let x = offsets[axis][side];
        let height = absolute(simd, x);
        let mut pairs = [[zero; 2]; 2];
        for (bj, pair) in pairs.iter_mut().enumerate() {
            let y = offsets[j][bj];
            let (re, re_2) = (height * at(distances, axes, [side, bj, 0]), height * at(distances, axes, [side, bj, 1]));
            let (im, im_2) = (y * offsets[k][0], y * offsets[k][1]);
            *pair = [re.mul_add(re_2, im * im_2), im.mul_sub(re_2, re * im_2)];
        }
        let [[re, im], [re_2, im_2]] = pairs;
        let im_of_product = im.mul_sub(re_2, re * im_2);
        let angle = N::angle(simd, re.mul_add(re_2, im * im_2), im_of_product).divided(simd);
        let angle = angle + im_of_product.where_at_least(0.0, zero, beyond);
        *face = x.where_at_least(0.0, angle, zero - angle);
    }
    faces[0] - faces[1]
}

#[inline(always)]
fn absolute<N: Functions>(simd: N::Instructions, value: N) -> N {
    value.where_at_least(0.0, value, N::splat(simd, 0.0) - value)
}
