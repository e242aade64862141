//! Look-ups of many points in the cells of a box. Points are sorted by cell to fill vectors.

use fearless_simd::dispatch;
use fearless_simd::prelude::*;
use glam::DVec3;
use magsplice_simd::lanes::{LONGEST_VECTOR, Lanes, Number};

use super::fitted_field::FittedField;
use super::harmonic_potential::fields;

/// Number of points whose coordinates are split by axis at a time. It is large enough that no
/// vector is loaded from memory just written.
const CHUNK: usize = 16 * LONGEST_VECTOR;

/// 2^52. The lowest bits of its sum with a small integer are the integer.
const INTEGER_OFFSET: f64 = 4_503_599_627_370_496.0;

/// Coordinates of a chunk of points by axis, or components of their field.
type AxisBuffers = [[f64; CHUNK]; 3];

impl FittedField {
    /// Writes B in tesla at many points; NaN outside the box. Returns the smallest |B|, or NaN if
    /// any point is outside.
    pub(super) fn look_up(&self, points: &[DVec3], field: &mut [DVec3]) -> f64 {
        dispatch!(self.level, simd => self.look_up_by(simd, points, field))
    }

    #[inline(always)]
    fn look_up_by<S: Simd>(&self, simd: S, points: &[DVec3], field: &mut [DVec3]) -> f64 {
        let outside = self.cells.iter().product::<usize>();
        let mut buffers = [[0.0; CHUNK]; 3];
        // First the cell of each point, then its position in the order of cells.
        let mut places = vec![0_u32; points.len()];
        for (points, cells) in points.chunks(CHUNK).zip(places.chunks_mut(CHUNK)) {
            self.find_cells(simd, points, cells, &mut buffers);
        }
        let mut ends = vec![0_u32; outside + 1];
        for &cell in &places {
            ends[cell as usize] += 1;
        }
        let mut count = 0;
        for end in &mut ends {
            (*end, count) = (count, count + *end);
        }
        // Points are read in the order of memory, and written in that order within each of the few
        // cells.
        let mut sorted = vec![DVec3::ZERO; points.len()];
        for (place, &point) in places.iter_mut().zip(points) {
            let end = &mut ends[*place as usize];
            *place = *end;
            sorted[*end as usize] = point;
            *end += 1;
        }
        let mut least_square = f64::INFINITY;
        let mut start = 0;
        for (cell, &end) in ends[..outside].iter().enumerate() {
            if start < end {
                let own = &mut sorted[start as usize..end as usize];
                least_square = least_square.min(self.look_up_in_cell(simd, cell, own, &mut buffers));
            }
            start = end;
        }
        let without_field = &mut sorted[start as usize..];
        if !without_field.is_empty() {
            without_field.fill(DVec3::NAN);
            least_square = f64::NAN;
        }
        for (field, &place) in field.iter_mut().zip(&places) {
            *field = sorted[place as usize];
        }
        least_square.sqrt()
    }

    /// Sets the cells of points like [`FittedField::cell`]. A point outside the box gets the number
    /// of cells.
    #[inline(always)]
    fn find_cells<S: Simd>(&self, simd: S, points: &[DVec3], cells: &mut [u32], buffers: &mut AxisBuffers) {
        let length = Lanes::<S>::LEN;
        split_axes(points, length, buffers);
        let zero = Lanes::<S>::splat(simd, 0.0);
        let [nx, ny, nz] = self.cells;
        let outside = Lanes::<S>::splat(simd, INTEGER_OFFSET + (nx * ny * nz) as f64);
        for (start, cells) in (0..).step_by(length).zip(cells.chunks_mut(length)) {
            let (mut cell, mut inside) = (Lanes::<S>::splat(simd, INTEGER_OFFSET), Lanes::<S>::splat(simd, 1.0));
            for (axis, next) in [ny * nz, nz, 1].into_iter().enumerate() {
                let coordinate = Lanes::<S>::load(simd, &buffers[axis][start..start + length]);
                let (lower, upper) = (self.region.lower[axis], self.region.upper[axis]);
                inside = inside * (coordinate.at_least(simd, lower) * coordinate.at_most(simd, upper));
                let last = Lanes::splat(simd, (self.cells[axis] - 1) as f64);
                let position = (coordinate - lower) * self.per_cell[axis];
                cell = position.max(zero).min(last).floor().scale_add(next as f64, cell);
            }
            let cell = inside.where_at_least(0.5, cell, outside);
            for (lane, found) in cells.iter_mut().enumerate() {
                *found = cell.lane(lane).to_bits() as u32;
            }
        }
    }

    /// Replaces points of one cell by their field. Returns the smallest |B|^2.
    #[inline(always)]
    fn look_up_in_cell<S: Simd>(&self, simd: S, cell: usize, points: &mut [DVec3], buffers: &mut AxisBuffers) -> f64 {
        let length = Lanes::<S>::LEN;
        let (coefficients, centre) = self.cell_coefficients_and_centre(cell);
        let mut least = Lanes::<S>::splat(simd, f64::INFINITY);
        for points in points.chunks_mut(CHUNK) {
            split_axes(points, 2 * length, buffers);
            for start in (0..points.len()).step_by(2 * length) {
                let halves = [start..start + length, start + length..start + 2 * length];
                let mut places = [[Lanes::<S>::splat(simd, 0.0); 3]; 2];
                for (half, place) in halves.iter().zip(&mut places) {
                    for ((place, buffer), centre) in place.iter_mut().zip(&*buffers).zip(centre) {
                        *place = (Lanes::<S>::load(simd, &buffer[half.clone()]) - centre) * self.scale;
                    }
                }
                let values = fields(simd, coefficients, places);
                for (half, values) in halves.into_iter().zip(values) {
                    let [x, y, z] = values;
                    least = least.min(z.mul_add(z, y.mul_add(y, x * x)));
                    for (buffer, value) in buffers.iter_mut().zip(values) {
                        value.store(&mut buffer[half.clone()]);
                    }
                }
            }
            let [x, y, z] = &*buffers;
            for (((x, y), z), point) in x.iter().zip(y).zip(z).zip(points) {
                *point = DVec3::new(*x, *y, *z);
            }
        }
        (0..length).map(|lane| least.lane(lane)).fold(f64::INFINITY, f64::min)
    }
}

/// Splits the coordinates of points by axis. The last point is repeated up to a multiple of
/// `multiple`.
#[inline(always)]
fn split_axes(points: &[DVec3], multiple: usize, buffers: &mut AxisBuffers) {
    let [x, y, z] = buffers;
    for (((x, y), z), point) in x.iter_mut().zip(y).zip(z).zip(points) {
        (*x, *y, *z) = (point.x, point.y, point.z);
    }
    if let Some(last) = points.last() {
        for (buffer, last) in buffers.iter_mut().zip(last.to_array()) {
            buffer[points.len()..points.len().next_multiple_of(multiple)].fill(last);
        }
    }
}
