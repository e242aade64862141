//! The cells of a box: their expansions, and the field in them.

use fearless_simd::Level;
use fearless_simd::prelude::*;
use glam::DVec3;
use rayon::prelude::*;

use super::chebyshev::{nodes, polynomials, transform};
use super::combine::{combine, padded};
use super::fit::{Fit, tail_of};
use crate::batch::lanes::{LONGEST_VECTOR, Lanes, Number};
use crate::tolerances::CELL_NODES;

/// Room for the coefficients of equal degree along x and y.
const LINE: usize = CELL_NODES.next_multiple_of(LONGEST_VECTOR);
/// Room for the coefficients of one component in a cell.
const COMPONENT: usize = CELL_NODES * CELL_NODES * LINE;
/// Room for those of a cell.
pub(super) const CELL: usize = 3 * COMPONENT;

/// The sum over the degrees of a cell's coefficients times a number for each degree along x, y and z.
#[inline(always)]
pub(super) fn sum_of_products<S: Simd>(simd: S, coefficients: &[f64], [x, y, z]: &[[f64; CELL_NODES]; 3]) -> DVec3 {
    let length = Lanes::<S>::LEN;
    let mut along_z = [0.0; LINE];
    along_z[..CELL_NODES].copy_from_slice(z);
    let mut field = [0.0; 3];
    for (field, coefficients) in field.iter_mut().zip(coefficients.chunks_exact(COMPONENT)) {
        for start in (0..LINE).step_by(length) {
            // Sums that do not wait for each other.
            let mut sums = [Lanes::<S>::splat(simd, 0.0); CELL_NODES];
            for (plane, x) in coefficients.chunks_exact(CELL_NODES * LINE).zip(x) {
                for ((sum, line), y) in sums.iter_mut().zip(plane.chunks_exact(LINE)).zip(y) {
                    *sum = Lanes::<S>::load(simd, &line[start..start + length]).scale_add(x * y, *sum);
                }
            }
            let mut total = sums[0];
            for sum in &sums[1..] {
                total = total + *sum;
            }
            let total = total * Lanes::<S>::load(simd, &along_z[start..start + length]);
            for lane in 0..length {
                *field += total.lane(lane);
            }
        }
    }
    DVec3::from(field)
}

/// All points of a cell, two vectors at a time.
#[inline(always)]
pub(super) fn in_cell<S: Simd>(
    simd: S,
    coefficients: &[f64],
    order: &[u32],
    places: &[(u32, DVec3)],
    field: &mut [DVec3],
) {
    let length = Lanes::<S>::LEN;
    for order in order.chunks(2 * length) {
        let mut coordinates = [[0.0; 2 * LONGEST_VECTOR]; 3];
        for (lane, &index) in order.iter().enumerate() {
            for (axis, c) in places[index as usize].1.to_array().into_iter().enumerate() {
                coordinates[axis][lane] = c;
            }
        }
        let mut along = [[[Lanes::<S>::splat(simd, 0.0); 2]; CELL_NODES]; 3];
        for (axis, along) in along.iter_mut().enumerate() {
            for half in 0..2 {
                let t = Lanes::<S>::load(simd, &coordinates[axis][half * length..(half + 1) * length]);
                let (mut last, mut value) = (t, Lanes::<S>::splat(simd, 1.0));
                for entry in along.iter_mut() {
                    entry[half] = value;
                    (last, value) = (value, (t * 2.0).mul_sub(value, last));
                }
            }
        }
        for component in 0..3 {
            let coefficients = &coefficients[component * COMPONENT..(component + 1) * COMPONENT];
            let mut sum = [Lanes::<S>::splat(simd, 0.0); 2];
            for (plane, x) in coefficients.chunks_exact(CELL_NODES * LINE).zip(&along[0]) {
                let mut in_plane = [Lanes::<S>::splat(simd, 0.0); 2];
                for (line, y) in plane.chunks_exact(LINE).zip(&along[1]) {
                    let mut on_line = [Lanes::<S>::splat(simd, 0.0); 2];
                    for (c, z) in line.iter().zip(&along[2]) {
                        on_line[0] = z[0].scale_add(*c, on_line[0]);
                        on_line[1] = z[1].scale_add(*c, on_line[1]);
                    }
                    in_plane[0] = on_line[0].mul_add(y[0], in_plane[0]);
                    in_plane[1] = on_line[1].mul_add(y[1], in_plane[1]);
                }
                sum[0] = in_plane[0].mul_add(x[0], sum[0]);
                sum[1] = in_plane[1].mul_add(x[1], sum[1]);
            }
            for (lane, &index) in order.iter().enumerate() {
                field[index as usize][component] = sum[lane / length].lane(lane % length);
            }
        }
    }
}

/// The coefficients of all cells, from those of the whole box.
pub(super) fn divided(level: Level, fit: &Fit, cells: [usize; 3]) -> Vec<f64> {
    // Along each axis, cell by cell, what each coefficient of the box adds to each of the cell's.
    let along = [0, 1, 2].map(|axis: usize| -> Vec<Vec<Vec<f64>>> {
        (0..cells[axis]).map(|cell| restriction(fit.counts[axis], cell, cells[axis])).collect()
    });
    let (slab, room) = (Fit::slab(fit.counts), padded(fit.counts[2]));
    let mut coefficients = vec![0.0; cells.iter().product::<usize>() * CELL];
    let cell_rows = coefficients.par_chunks_mut(cells[1] * cells[2] * CELL).zip(&along[0]);
    cell_rows.for_each(|(coefficients, along_x)| {
        let (mut plane, mut line) = (vec![0.0; slab], vec![0.0; room]);
        for component in 0..3 {
            for (a, weights) in along_x.iter().enumerate() {
                combine(level, weights, &fit.coefficients[component], &mut plane);
                for (j, along_y) in along[1].iter().enumerate() {
                    for (b, weights) in along_y.iter().enumerate() {
                        combine(level, weights, &plane, &mut line);
                        for (k, along_z) in along[2].iter().enumerate() {
                            let start = (j * cells[2] + k) * CELL + component * COMPONENT + (a * CELL_NODES + b) * LINE;
                            for (c, weights) in along_z.iter().enumerate() {
                                coefficients[start + c] = weights.iter().zip(&line).map(|(w, v)| w * v).sum();
                            }
                        }
                    }
                }
            }
        }
    });
    coefficients
}

/// Row k: what coefficient c of an expansion on [-1, 1] adds to coefficient k of one of its `cells` equal parts.
fn restriction(count: usize, cell: usize, cells: usize) -> Vec<Vec<f64>> {
    let mut at_nodes = vec![vec![0.0; count]; CELL_NODES];
    for (node, values) in nodes(CELL_NODES).into_iter().zip(&mut at_nodes) {
        polynomials((2.0 * cell as f64 + 1.0 + node) / cells as f64 - 1.0, values);
    }
    let rows = transform(CELL_NODES);
    rows.iter()
        .map(|row| (0..count).map(|c| row.iter().zip(&at_nodes).map(|(w, values)| w * values[c]).sum()).collect())
        .collect()
}

/// Along each axis, the most that is left out in any cell, as [`Fit`] estimates it.
pub(super) fn tails_t(coefficients: &[f64]) -> DVec3 {
    coefficients.chunks_exact(CELL).map(cell_tails_t).fold(DVec3::ZERO, DVec3::max)
}

fn cell_tails_t(coefficients: &[f64]) -> DVec3 {
    let mut sums = [[DVec3::ZERO; CELL_NODES]; 3];
    for (index, coefficient) in coefficients.iter().enumerate() {
        let (component, index) = (index / COMPONENT, index % COMPONENT);
        let degrees = [index / (CELL_NODES * LINE), index / LINE % CELL_NODES, index % LINE];
        if degrees[2] >= CELL_NODES {
            continue;
        }
        for (axis, degree) in degrees.into_iter().enumerate() {
            sums[axis][degree][component] += coefficient.abs();
        }
    }
    DVec3::from(sums.map(|sums| tail_of(&sums.map(|s| s.length())).sum_t))
}
