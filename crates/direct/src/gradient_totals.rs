//! Compensated sums of gradients over tiles at a batch of points (Neumaier), in the frame of the
//! scene.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DMat3;
use magsplice_cuboid::closed_form::gradient::COMPONENTS;
use magsplice_simd::column::Column;
use magsplice_simd::compensated_sum::TwoSum;
use magsplice_simd::lanes::{LONGEST_VECTOR, Lanes, Number};

use super::totals::add_vector;

/// Gradients at points: xx, yy, zz, yz, xz, xy.
pub(super) type Gradients = [Column; COMPONENTS];

/// Sum and carry of each component at [`LONGEST_VECTOR`] points, next to each other in memory:
/// columns of all points would take turns in the same lines of the first cache.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Block([[[f64; LONGEST_VECTOR]; 2]; COMPONENTS]);

/// Sums of gradients.
#[derive(Default)]
pub(super) struct GradientTotals(Vec<Block>);

impl GradientTotals {
    pub(super) fn start(&mut self, count: usize) {
        self.0.clear();
        self.0.resize(count.div_ceil(LONGEST_VECTOR), Block([[[0.0; LONGEST_VECTOR]; 2]; COMPONENTS]));
    }

    /// Writes the sums with their carries. Returns whether all of them are finite.
    pub(super) fn write(&self, gradient: &mut [DMat3]) -> bool {
        let mut finite = true;
        for (gradient, Block(block)) in gradient.chunks_mut(LONGEST_VECTOR).zip(&self.0) {
            let mut values = [[0.0; LONGEST_VECTOR]; COMPONENTS];
            let mut magnitudes = [0.0; LONGEST_VECTOR];
            for (values, [sums, carries]) in values.iter_mut().zip(block) {
                for (index, value) in values.iter_mut().enumerate() {
                    *value = sums[index] + carries[index];
                    magnitudes[index] += value.abs();
                }
            }
            let [xx, yy, zz, yz, xz, xy] = &values;
            for (n, gradient) in gradient.iter_mut().enumerate() {
                *gradient = DMat3::from_cols_array(&[xx[n], xy[n], xz[n], xy[n], yy[n], yz[n], xz[n], yz[n], zz[n]]);
                finite &= magnitudes[n] < f64::INFINITY;
            }
        }
        finite
    }

    #[inline(always)]
    pub(super) fn add_one(&mut self, index: usize, gradient: [f64; COMPONENTS]) {
        let (Block(block), lane) = (&mut self.0[index / LONGEST_VECTOR], index % LONGEST_VECTOR);
        for ([sums, carries], term) in block.iter_mut().zip(gradient) {
            let step = TwoSum::new(sums[lane], term);
            sums[lane] = step.hi;
            carries[lane] += step.lo;
        }
    }

    /// Adds gradients in a frame at all points, or at the points with the indices `chosen`. They
    /// are rotated in place.
    pub(super) fn add(
        &mut self,
        level: Level,
        rotation: Option<&DMat3>,
        gradients: &mut Gradients,
        chosen: Option<&[u32]>,
    ) {
        if let Some(rotation) = rotation {
            dispatch!(level, simd => turn(simd, rotation, gradients));
        }
        let Some(chosen) = chosen else {
            return dispatch!(level, simd => self.add_all(simd, gradients));
        };
        let terms = gradients.each_ref().map(|terms| &terms[..chosen.len()]);
        for (number, &index) in chosen.iter().enumerate() {
            self.add_one(index as usize, terms.map(|terms| terms[number]));
        }
    }

    #[inline(always)]
    fn add_all<S: Simd>(&mut self, simd: S, gradients: &Gradients) {
        simd.vectorize(
            #[inline(always)]
            || {
                let len = Lanes::<S>::LEN;
                for (number, Block(block)) in self.0.iter_mut().enumerate() {
                    for ([sums, carries], terms) in block.iter_mut().zip(gradients) {
                        let terms = &terms[number * LONGEST_VECTOR..(number + 1) * LONGEST_VECTOR];
                        let sums = sums.chunks_exact_mut(len).zip(carries.chunks_exact_mut(len));
                        for ((sums, carries), terms) in sums.zip(terms.chunks_exact(len)) {
                            add_vector(simd, Lanes::load(simd, terms), sums, carries);
                        }
                    }
                }
            },
        );
    }
}

/// Rotates tensors in place: R G R^T.
#[inline(always)]
fn turn<S: Simd>(simd: S, rotation: &DMat3, gradients: &mut Gradients) {
    simd.vectorize(
        #[inline(always)]
        || {
            let len = Lanes::<S>::LEN;
            for start in (0..gradients[0].len()).step_by(len) {
                let mut own = [Lanes::<S>::splat(simd, 0.0); COMPONENTS];
                for (own, values) in own.iter_mut().zip(&*gradients) {
                    *own = Lanes::load(simd, &values[start..start + len]);
                }
                for (values, turned) in gradients.iter_mut().zip(turned(simd, rotation, own)) {
                    turned.store(&mut values[start..start + len]);
                }
            }
        },
    );
}

#[inline(always)]
fn turned<S: Simd>(simd: S, rotation: &DMat3, own: [Lanes<S>; COMPONENTS]) -> [Lanes<S>; COMPONENTS] {
    let columns = rotation.to_cols_array_2d();
    let [xx, yy, zz, yz, xz, xy] = own;
    let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let zero = Lanes::<S>::splat(simd, 0.0);
    // R G, then its products with the rows of R.
    let mut half = [[zero; 3]; 3];
    for (row, half) in half.iter_mut().enumerate() {
        for (column, half) in half.iter_mut().enumerate() {
            let first = rows[0][column] * columns[0][row];
            *half = rows[2][column].scale_add(columns[2][row], rows[1][column].scale_add(columns[1][row], first));
        }
    }
    let mut whole = [zero; COMPONENTS];
    for (component, (row, column)) in whole.iter_mut().zip([(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]) {
        let first = half[row][0] * columns[0][column];
        *component = half[row][2].scale_add(columns[2][column], half[row][1].scale_add(columns[1][column], first));
    }
    whole
}
