//! Many points looked up in the cells of a box: sorted by cell, so that those of one fill vectors.

use fearless_simd::dispatch;
use fearless_simd::prelude::*;
use glam::DVec3;
use magsplice_simd::lanes::{LONGEST_VECTOR, Lanes, Number};

use super::fitted_field::FittedField;
use super::harmonic_potential::fields;

/// Points whose coordinates are put apart by axis at a time: so many that no vector is loaded from what has just been written.
const TOGETHER: usize = 16 * LONGEST_VECTOR;

/// 2^52: the last bits of a small integer added to it are the integer.
const INTEGER: f64 = 4_503_599_627_370_496.0;

/// Coordinates of points, or components of their field.
type Room = [[f64; TOGETHER]; 3];

impl FittedField {
    /// Not a number outside the box. The least |B|, not a number if any point is outside.
    pub(super) fn look_up(&self, points: &[DVec3], field: &mut [DVec3]) -> f64 {
        dispatch!(self.level, simd => self.look_up_by(simd, points, field))
    }

    #[inline(always)]
    fn look_up_by<S: Simd>(&self, simd: S, points: &[DVec3], field: &mut [DVec3]) -> f64 {
        let outside = self.cells.iter().product::<usize>();
        let mut room = [[0.0; TOGETHER]; 3];
        // First the cell of each point, then its place among all sorted by cell.
        let mut places = vec![0_u32; points.len()];
        for (points, cells) in points.chunks(TOGETHER).zip(places.chunks_mut(TOGETHER)) {
            self.find_cells(simd, points, cells, &mut room);
        }
        let mut ends = vec![0_u32; outside + 1];
        for &cell in &places {
            ends[cell as usize] += 1;
        }
        let mut count = 0;
        for end in &mut ends {
            (*end, count) = (count, count + *end);
        }
        // Points and fields are moved so that neighbours in memory come one after the other on both sides: cells are few.
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
                least_square = least_square.min(self.look_up_in(simd, cell, own, &mut room));
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

    /// The cells of points as [`FittedField::cell`] gives them; their number outside the box.
    #[inline(always)]
    fn find_cells<S: Simd>(&self, simd: S, points: &[DVec3], cells: &mut [u32], room: &mut Room) {
        let length = Lanes::<S>::LEN;
        set_apart(points, length, room);
        let zero = Lanes::<S>::splat(simd, 0.0);
        let [nx, ny, nz] = self.cells;
        let outside = Lanes::<S>::splat(simd, INTEGER + (nx * ny * nz) as f64);
        for (start, cells) in (0..).step_by(length).zip(cells.chunks_mut(length)) {
            let (mut cell, mut inside) = (Lanes::<S>::splat(simd, INTEGER), Lanes::<S>::splat(simd, 1.0));
            for (axis, next) in [ny * nz, nz, 1].into_iter().enumerate() {
                let coordinate = Lanes::<S>::load(simd, &room[axis][start..start + length]);
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

    /// The field in place of the points, all in one cell; the least square of |B|.
    #[inline(always)]
    fn look_up_in<S: Simd>(&self, simd: S, cell: usize, points: &mut [DVec3], room: &mut Room) -> f64 {
        let length = Lanes::<S>::LEN;
        let (numbers, centre) = self.numbers_and_centre(cell);
        let mut least = Lanes::<S>::splat(simd, f64::INFINITY);
        for points in points.chunks_mut(TOGETHER) {
            set_apart(points, 2 * length, room);
            for start in (0..points.len()).step_by(2 * length) {
                let halves = [start..start + length, start + length..start + 2 * length];
                let mut places = [[Lanes::<S>::splat(simd, 0.0); 3]; 2];
                for (half, place) in halves.iter().zip(&mut places) {
                    for ((place, room), centre) in place.iter_mut().zip(&*room).zip(centre) {
                        *place = (Lanes::<S>::load(simd, &room[half.clone()]) - centre) * self.scale;
                    }
                }
                let values = fields(simd, numbers, places);
                for (half, values) in halves.into_iter().zip(values) {
                    let [x, y, z] = values;
                    least = least.min(z.mul_add(z, y.mul_add(y, x * x)));
                    for (room, value) in room.iter_mut().zip(values) {
                        value.store(&mut room[half.clone()]);
                    }
                }
            }
            let [x, y, z] = &*room;
            for (((x, y), z), point) in x.iter().zip(y).zip(z).zip(points) {
                *point = DVec3::new(*x, *y, *z);
            }
        }
        (0..length).map(|lane| least.lane(lane)).fold(f64::INFINITY, f64::min)
    }
}

/// Coordinates by axis; the last point again up to a multiple of `whole`.
#[inline(always)]
fn set_apart(points: &[DVec3], whole: usize, room: &mut Room) {
    let [x, y, z] = room;
    for (((x, y), z), point) in x.iter_mut().zip(y).zip(z).zip(points) {
        (*x, *y, *z) = (point.x, point.y, point.z);
    }
    if let Some(last) = points.last() {
        for (room, last) in room.iter_mut().zip(last.to_array()) {
            room[points.len()..points.len().next_multiple_of(whole)].fill(last);
        }
    }
}
