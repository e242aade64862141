//! Points inside a compact cuboid and close to its edges, and points close to plates and rods, in
//! vectors (docs/physics.md, section 2.6).
//!
//! These methods keep the digits that the closed form of `single_tile` loses near an edge. In a
//! compact cuboid each edge and each corner has its own term, free of cancellation. The sum of the
//! terms is accurate to the round-off of the largest term. This is sufficient where every column of
//! the tensor is nearly as large: inside and close to a cuboid that is neither a plate nor a rod.

use std::f64::consts::PI;

use fearless_simd::prelude::*;
use magsplice_simd::functions::{angle, half_logarithm_of_ratio};
use magsplice_simd::lanes::{Lanes, Number};
use magsplice_simd::power_of_two::power_of_two_reciprocal;

use super::single_tile::ClosedForm;
use super::terms::Form;
use crate::block::{Block, LocalPoint};
use crate::scalar::kernel::FieldKind;
use crate::tolerances::{LEAST_OFFSET, NEAR_EDGE_ASPECT, NEAR_FRACTION, THINNEST};
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

    /// Whether a point is inside the tile or close to it, and clearly off the planes of all faces.
    pub fn covers(&self, point: &LocalPoint) -> bool {
        greatest_gap(&self.faces, point) <= self.reach
            && (0..3).all(|axis| {
                let least = self.least_offset.max(point.roundoff[axis]);
                self.faces[axis].iter().all(|face| ((point.coordinates[axis] - face.hi) - face.lo).abs() > least)
            })
    }
}

/// A tile for points close to it: inside and outside of compact tiles, outside of plates and rods.
pub enum NearEdge {
    /// A compact tile.
    Compact(Box<NearCompact>),
    /// A plate or a rod.
    Thin(Box<NearThin>),
}

/// A plate or a rod for points outside and close to it, evaluated by [`Form::Thin`].
pub struct NearThin {
    faces: [[TwoSum; 2]; 3],
    /// Distances along an axis at which the form begins and ends.
    reach: [f64; 2],
    closed_form: ClosedForm,
}

/// A compact tile for points inside it and close to it.
pub struct NearCompact {
    faces: [[TwoSum; 2]; 3],
    interior: Interior,
    scale: f64,
    /// Side lengths, scaled.
    size: [f64; 3],
    polarization_t: [f64; 3],
    part: FieldKind,
}

impl NearEdge {
    /// Prepares a block; `None` if its sides differ too much.
    pub fn new(block: &Block, part: FieldKind) -> Option<NearEdge> {
        let [x, y, z] = block.size;
        let (largest, smallest) = (x.max(y).max(z), x.min(y).min(z));
        let scale = power_of_two_reciprocal(largest);
        if smallest >= NEAR_EDGE_ASPECT * largest {
            return Some(NearEdge::Compact(Box::new(NearCompact {
                faces: block.faces,
                interior: Interior::new(block),
                scale,
                size: block.size.map(|size| size * scale),
                polarization_t: block.polarization_t.to_array(),
                part,
            })));
        }
        (smallest >= THINNEST * largest).then(|| {
            NearEdge::Thin(Box::new(NearThin {
                faces: block.faces,
                reach: [NEAR_FRACTION * smallest, NEAR_FRACTION * largest],
                closed_form: ClosedForm::new(block, scale, Form::Thin),
            }))
        })
    }

    /// Whether a point is in the region that the tile is prepared for.
    pub fn covers(&self, point: &LocalPoint) -> bool {
        match self {
            NearEdge::Compact(tile) => tile.interior.covers(point),
            NearEdge::Thin(tile) => {
                let gap = greatest_gap(&tile.faces, point);
                tile.reach[0] <= gap && gap <= tile.reach[1]
            }
        }
    }

    /// B or mu0 H of the tile in tesla, in its frame, at points given by axis in whole vectors.
    #[inline(never)]
    pub fn fields<S: Simd>(&self, simd: S, [x, y, z]: [&[f64]; 3], [fx, fy, fz]: [&mut [f64]; 3]) {
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
                        NearEdge::Thin(tile) => {
                            tile.closed_form.field_of_thin(simd, &tile.closed_form.place(simd, point))
                        }
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

impl NearCompact {
    #[inline(always)]
    fn field<S: Simd>(&self, simd: S, point: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
        let (zero, one) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, 1.0));
        let mut offsets = [[zero; 2]; 3];
        let mut inside = one;
        for ((offsets, coordinate), faces) in offsets.iter_mut().zip(point).zip(&self.faces) {
            for (offset, face) in offsets.iter_mut().zip(faces) {
                *offset = ((coordinate - face.hi) - face.lo) * self.scale;
            }
            inside = inside * offsets[0].at_least(simd, 0.0) * offsets[1].at_most(simd, 0.0);
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
fn at<S: Simd>(distances: &[Lanes<S>; 8], [i, j, k]: [usize; 3], [bi, bj, bk]: [usize; 3]) -> Lanes<S> {
    distances[bi << i | bj << j | bk << k]
}

/// 2 pi T_ij from the four edges along k, each as ln((S + l) / (S - l)) (Eq. P4), with S - l by Eq.
/// P7 without its divisions.
#[inline(always)]
fn half_of_edges<S: Simd>(
    simd: S,
    offsets: &[[Lanes<S>; 2]; 3],
    distances: &[Lanes<S>; 8],
    axes: [usize; 3],
    length: f64,
) -> Lanes<S> {
    let (one, length) = (Lanes::<S>::splat(simd, 1.0), Lanes::<S>::splat(simd, length));
    let [i, j, k] = axes;
    let [low, high] = offsets[k];
    let beyond = (low * high).at_least(simd, 0.0);
    let (low, high) = (low.abs(), high.abs());
    let overhang = low.min(high) * beyond * 2.0;
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
    half_logarithm_of_ratio(simd, products[0], products[1])
}

/// Solid angle of the lower face across an axis minus the solid angle of the upper face, each
/// positive for points above it: sums of arctangents of y z / (x R), two of which form one angle.
#[inline(always)]
fn angles_of_faces<S: Simd>(simd: S, offsets: &[[Lanes<S>; 2]; 3], distances: &[Lanes<S>; 8], axis: usize) -> Lanes<S> {
    let axes = [axis, (axis + 1) % 3, (axis + 2) % 3];
    let [_, j, k] = axes;
    let mut faces = [Lanes::<S>::splat(simd, 0.0); 2];
    for (side, face) in faces.iter_mut().enumerate() {
        let x = offsets[axis][side];
        let (height, sign) = (x.abs(), x.sign(simd));
        for bj in 0..2 {
            let y = sign * offsets[j][bj];
            let (re, re_2) = (height * at(distances, axes, [side, bj, 0]), height * at(distances, axes, [side, bj, 1]));
            let (im, im_2) = (y * offsets[k][0], y * offsets[k][1]);
            let pair = angle(simd, re.mul_add(re_2, im * im_2), im.mul_sub(re_2, re * im_2));
            *face = if bj == 0 { pair } else { *face - pair };
        }
    }
    faces[0] - faces[1]
}
