//! Points of several tiles whose field may be too weak for a tolerance. Bounds of the magnitude,
//! each closer and slower than the one before, decide one point after the other.

use std::cell::RefCell;

use fearless_simd::prelude::*;
use glam::DVec3;
use magsplice_cuboid::tolerances::EXACT_BOUND;
use magsplice_magnet::BoundingBox;
use magsplice_simd::column::{Column, views};
use magsplice_simd::lanes::{LONGEST_VECTOR, Lanes, PAIR};

use super::least_field::LeastField;

/// Points stay where they are unless at most one of this many is open. A decided point takes less
/// time in the vectors of the next bound than all others take to move.
const MOVED_SHARE: usize = 2;

/// Points of a batch that no bound has decided yet, by component and in whole pairs of vectors. The
/// last point is repeated.
#[derive(Debug, Default)]
pub struct OpenPoints {
    count: usize,
    /// Index of each point in the batch.
    indices: Vec<u32>,
    axes: [Column; 3],
    /// Squares of fields, in square tesla; infinite at points that are decided.
    squares: Column,
    /// Upper bounds of the magnitude, in tesla.
    magnitudes_t: Column,
}

impl OpenPoints {
    /// Calls `work` with the buffers of the calling thread.
    pub fn with_buffers<R>(work: impl FnOnce(&mut OpenPoints) -> R) -> R {
        thread_local! {
            static BUFFERS: RefCell<OpenPoints> = RefCell::default();
        }
        BUFFERS.with_borrow_mut(work)
    }

    /// Sets the fields of all points of a batch, in tesla over `per_tesla`. Returns the smallest
    /// square of those that are numbers, in square tesla.
    #[inline(always)]
    pub fn set_fields<S: Simd>(&mut self, simd: S, field: &[DVec3], per_tesla: f64) -> f64 {
        let in_tesla = per_tesla.powi(2).recip();
        self.count = field.len();
        self.squares.set_len(field.len().next_multiple_of(PAIR));
        for (square, b) in self.squares.iter_mut().zip(field) {
            *square = b.length_squared() * in_tesla;
        }
        self.squares[field.len()..].fill(f64::INFINITY);
        ends_of(simd, &self.squares)[0]
    }

    /// Sets the coordinates of the same points. Returns the box around those that are numbers.
    #[inline(always)]
    pub fn set_points<S: Simd>(&mut self, simd: S, points: &[DVec3]) -> BoundingBox {
        let last = points.last().copied().unwrap_or_default();
        let whole = self.squares.len();
        let [x, y, z] = &mut self.axes;
        for (axis, last) in [&mut *x, &mut *y, &mut *z].into_iter().zip(last.to_array()) {
            axis.set_len(whole);
            axis[points.len()..].fill(last);
        }
        for (((x, y), z), point) in x.iter_mut().zip(y.iter_mut()).zip(z.iter_mut()).zip(points) {
            (*x, *y, *z) = (point.x, point.y, point.z);
        }
        self.indices.clear();
        self.indices.extend(0..points.len() as u32);
        self.magnitudes_t.set_len(whole);
        let [x, y, z] = [ends_of(simd, x), ends_of(simd, y), ends_of(simd, z)];
        BoundingBox { lower: DVec3::new(x[0], y[0], z[0]), upper: DVec3::new(x[1], y[1], z[1]) }
    }

    /// The coordinates by axis, and room for a bound at each point.
    pub fn points_and_magnitudes_t(&mut self) -> ([&[f64]; 3], &mut [f64]) {
        (views(&self.axes), &mut self.magnitudes_t)
    }

    /// Whether all points are decided.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Removes all points.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Decides the points at which the bounds of the magnitude show that the tolerance is kept, and
    /// removes them if they are many.
    #[inline(always)]
    pub fn keep_weak<S: Simd>(&mut self, simd: S, least: LeastField) {
        let weak = self.decide(simd, least);
        if weak > self.count / MOVED_SHARE {
            return;
        }
        let (mut kept, whole) = (0, weak.next_multiple_of(PAIR));
        if weak > 0 {
            let (indices, magnitudes_t, squares) = (&mut self.indices[..], &mut *self.magnitudes_t, &mut *self.squares);
            let [x, y, z] = self.axes.each_mut().map(|axis| &mut **axis);
            for number in 0..self.count {
                indices[kept] = indices[number];
                (x[kept], y[kept], z[kept]) = (x[number], y[number], z[number]);
                (squares[kept], magnitudes_t[kept]) = (squares[number], magnitudes_t[number]);
                kept += usize::from(squares[number] < f64::INFINITY);
            }
            for axis in [x, y, z] {
                let last = axis[kept - 1];
                axis[kept..whole].fill(last);
            }
            squares[kept..whole].fill(f64::INFINITY);
        }
        self.count = kept;
        for column in self.axes.iter_mut().chain([&mut self.squares, &mut self.magnitudes_t]) {
            column.set_len(whole);
        }
    }

    /// Sets the squares of decided points. Returns the number of the other points.
    #[inline(always)]
    fn decide<S: Simd>(&mut self, simd: S, least: LeastField) -> usize {
        let len = Lanes::<S>::LEN;
        let (zero, one) = (S::f64s::splat(simd, 0.0), S::f64s::splat(simd, 1.0));
        let infinite = S::f64s::splat(simd, f64::INFINITY);
        let mut weak = zero;
        for (squares, magnitudes_t) in self.squares.chunks_exact_mut(len).zip(self.magnitudes_t.chunks_exact(len)) {
            let error_t = Lanes::<S>::load(simd, magnitudes_t) * EXACT_BOUND;
            let Lanes(least_squared) = least.squared_in_vectors(simd, error_t);
            let Lanes(own) = Lanes::<S>::load(simd, squares);
            let is_weak = own.simd_lt(least_squared);
            weak += is_weak.select(one, zero);
            Lanes::<S>(is_weak.select(own, infinite)).store(squares);
        }
        lanes(Lanes::<S>(weak)).into_iter().sum::<f64>() as usize
    }

    /// The index in the batch of each point that is not decided, and the bound of its magnitude in
    /// tesla.
    pub fn bounds(&self) -> impl Iterator<Item = (usize, f64)> {
        let points = self.indices[..self.count].iter().zip(&*self.magnitudes_t).zip(&*self.squares);
        let open = points.filter(|(_, square)| **square < f64::INFINITY);
        open.map(|((&index, &own_t), _)| (index as usize, own_t))
    }
}

/// The smallest and the largest of the values that are numbers, which are in whole pairs of
/// vectors.
#[inline(always)]
fn ends_of<S: Simd>(simd: S, values: &[f64]) -> [f64; 2] {
    let mut least = [S::f64s::splat(simd, f64::INFINITY); 2];
    let mut most = [S::f64s::splat(simd, f64::NEG_INFINITY); 2];
    for pair in values.chunks_exact(2 * Lanes::<S>::LEN) {
        for half in 0..2 {
            let Lanes(values) = Lanes::<S>::load(simd, &pair[half * Lanes::<S>::LEN..(half + 1) * Lanes::<S>::LEN]);
            least[half] = values.simd_lt(least[half]).select(values, least[half]);
            most[half] = values.simd_gt(most[half]).select(values, most[half]);
        }
    }
    let smallest = least[0].simd_lt(least[1]).select(least[0], least[1]);
    let largest = most[0].simd_gt(most[1]).select(most[0], most[1]);
    let [least, most] = [smallest, largest].map(|ends| lanes(Lanes::<S>(ends)));
    let len = Lanes::<S>::LEN;
    [
        least[..len].iter().copied().fold(f64::INFINITY, f64::min),
        most[..len].iter().copied().fold(f64::NEG_INFINITY, f64::max),
    ]
}

/// The lanes of a vector, then zeros.
#[inline(always)]
fn lanes<S: Simd>(vector: Lanes<S>) -> [f64; LONGEST_VECTOR] {
    let mut lanes = [0.0; LONGEST_VECTOR];
    vector.store(&mut lanes[..Lanes::<S>::LEN]);
    lanes
}
