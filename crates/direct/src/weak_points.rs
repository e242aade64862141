//! Points of a single tile whose field may be too weak for a tolerance.
//!
//! Most points are decided by their method. Where the series is used, the bound of the magnitude is
//! at most [`FAR_MAGNITUDE`] times the field. Elsewhere one bound holds for all points of a method,
//! then a bound from the distances of each point in the vectors of its method.

use std::f64::consts::PI;

use fearless_simd::prelude::*;
use glam::DVec3;
use magsplice_cuboid::block::Block;
use magsplice_cuboid::magnitude_bound::MagnitudeBound;
use magsplice_cuboid::method::{CLOSED_FORM, FIRST_FAR, MethodIndex, MethodRanges, SMALL_ELEMENTS};
use magsplice_cuboid::tolerances::{EXACT_BOUND, LARGEST_FIELD_OVER_J, SMALL_ANGLE};
use magsplice_magnet::Tolerance;
use magsplice_simd::lanes::Lanes;

use super::least_field::{LEAST_COMPARED, LeastField};
use super::magnitude::MagnitudeBounds;
use super::queues::OWN_QUEUE;
use crate::tolerances::{DECIDED_BY_DISTANCE, FAR_MAGNITUDE, NEAR_FIELD_OVER_J};

/// Bounds of the magnitude of the only block of a scene, whatever the tolerance.
#[derive(Clone, Debug)]
pub(super) struct MethodBounds {
    /// Upper bounds at the points of the closed form and of its form for small elements, in tesla.
    closed_form_t: [f64; 2],
    /// Upper bound at the points of the series, in tesla.
    far_t: f64,
    /// Upper bound at any point, in tesla.
    largest_t: f64,
    error_weight: f64,
    /// The bound from the distances of a point, in the frame of the block.
    at_points: MagnitudeBound,
}

impl MethodBounds {
    /// Prepares the only block of a scene, whose tiles have these `magnitudes`.
    pub(super) fn new(block: &Block, ranges: &MethodRanges, magnitudes: &MagnitudeBounds) -> MethodBounds {
        let half_diagonal = ranges.half_size.iter().map(|half| half * half).sum::<f64>().sqrt();
        let series_from = ranges.far.first().map_or(f64::INFINITY, |(square, _)| square.sqrt());
        // |T| is at most the integral of dV / 2 pi r^3.
        let small_t = SMALL_ANGLE / (2.0 * PI) * block.error_weight() * block.polarization_t.abs().element_sum();
        MethodBounds {
            closed_form_t: [magnitudes.beyond_t(ranges.closed_form_from.sqrt() / ranges.scale), small_t],
            far_t: magnitudes.beyond_t((series_from - half_diagonal) / ranges.scale),
            largest_t: magnitudes.largest_t(),
            error_weight: block.error_weight(),
            at_points: MagnitudeBound::of_block(block, magnitudes.roundoff()),
        }
    }
}

/// The comparison of fields with a tolerance, and the points where it fails.
#[derive(Debug)]
pub struct WeakPoints<'a> {
    bounds: &'a MethodBounds,
    least: LeastField,
    /// Smallest squares of fields that keep the tolerance, in square tesla: of the closed form and
    /// of its form for small elements, and of the series.
    closed_form_squared: [f64; 2],
    far_squared: f64,
    /// Of the forms close to the tile, and of the scalar kernel.
    near_squared: [f64; 2],
    by_closed_form: bool,
    /// Index of each point, and the bound of its magnitude in tesla, infinite where it is unknown.
    pub(super) points: Vec<(u32, f64)>,
}

impl<'a> WeakPoints<'a> {
    /// Prepares the only block of a scene.
    pub(super) fn new(tolerance: Tolerance, bounds: &'a MethodBounds) -> WeakPoints<'a> {
        let least = LeastField::new(tolerance);
        let far_is_kept = least.at_t(EXACT_BOUND * bounds.error_weight * FAR_MAGNITUDE) <= 1.0
            || least.at_t(EXACT_BOUND * bounds.far_t) == 0.0;
        WeakPoints {
            bounds,
            least,
            closed_form_squared: bounds.closed_form_t.map(|t| least.squared_at(EXACT_BOUND * t)),
            far_squared: if far_is_kept { LEAST_COMPARED.powi(2) } else { f64::INFINITY },
            near_squared: [NEAR_FIELD_OVER_J / LARGEST_FIELD_OVER_J, 1.0]
                .map(|share| least.squared_at(EXACT_BOUND * share * bounds.largest_t)),
            by_closed_form: !(least.at_t(EXACT_BOUND) <= DECIDED_BY_DISTANCE),
            points: Vec::new(),
        }
    }

    /// The same comparison with a bound from the closed form at each point, for other points;
    /// `None` if it had these bounds.
    pub(super) fn by_closed_form(&self) -> Option<WeakPoints<'a>> {
        (!self.by_closed_form).then(|| WeakPoints { by_closed_form: true, points: Vec::new(), ..*self })
    }

    /// Whether the closed form computes a bound of the magnitude at the points of a method.
    #[inline(always)]
    pub(super) fn needs_magnitudes(&self, method: MethodIndex) -> bool {
        self.by_closed_form && method < FIRST_FAR
    }

    /// Compares the fields at points of one method, in tesla, given by component. `points` are
    /// their coordinates in the frame of the block, in whole pairs of vectors. `magnitudes_t` has
    /// room for as many values; it holds the bounds of the closed form where they are needed.
    #[inline(always)]
    pub(super) fn check<S: Simd>(
        &mut self,
        simd: S,
        method: MethodIndex,
        (points, places): ([&[f64]; 3], &[u32]),
        [x, y, z]: [&[f64]; 3],
        magnitudes_t: &mut [f64],
    ) {
        let squares = x.iter().zip(y).zip(z).map(|((x, y), z)| x * x + y * y + z * z);
        // Without a branch for each point, because usually no field is weak.
        if !self.needs_magnitudes(method) {
            let least_squared = match method {
                CLOSED_FORM => self.closed_form_squared[0],
                SMALL_ELEMENTS => self.closed_form_squared[1],
                FIRST_FAR..OWN_QUEUE => self.far_squared,
                _ => self.near_squared[0],
            };
            if !squares.clone().fold(false, |any, square| any | (square < least_squared)) {
                return;
            }
            write_bounds::<_, true>(simd, &self.bounds.at_points, points, magnitudes_t);
            if !self.is_any_weak(squares.clone(), magnitudes_t) {
                return;
            }
            write_bounds::<_, false>(simd, &self.bounds.at_points, points, magnitudes_t);
        }
        if self.is_any_weak(squares.clone(), magnitudes_t) {
            let least = self.least;
            let is_weak = |(square, magnitude_t): (f64, &f64)| square < least.squared_at(EXACT_BOUND * magnitude_t);
            let points = squares.zip(&*magnitudes_t).zip(places);
            let weak = points.filter(|(point, _)| is_weak(*point));
            self.points.extend(weak.map(|((_, magnitude_t), place)| (*place, *magnitude_t)));
        }
    }

    #[inline(always)]
    fn is_any_weak(&self, squares: impl Iterator<Item = f64>, magnitudes_t: &[f64]) -> bool {
        let least = self.least;
        let is_weak = |(square, magnitude_t): (f64, &f64)| square < least.squared_at(EXACT_BOUND * magnitude_t);
        // Without a branch for each point, because usually no field is weak.
        squares.zip(magnitudes_t).fold(false, |any, point| any | is_weak(point))
    }

    /// Compares the field at one point close to the tile.
    pub(super) fn check_one(&mut self, place: u32, field_t: DVec3) {
        if field_t.length_squared() < self.near_squared[1] {
            self.points.push((place, f64::INFINITY));
        }
    }
}

/// Writes the bounds from the distances of points in whole pairs of vectors.
#[inline(never)]
fn write_bounds<S: Simd, const ROUGH: bool>(
    simd: S,
    bound: &MagnitudeBound,
    [x, y, z]: [&[f64]; 3],
    magnitudes_t: &mut [f64],
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let points = x.chunks_exact(Lanes::<S>::LEN).zip(y.chunks_exact(Lanes::<S>::LEN));
            let points = points.zip(z.chunks_exact(Lanes::<S>::LEN));
            for (((x, y), z), own_t) in points.zip(magnitudes_t.chunks_exact_mut(Lanes::<S>::LEN)) {
                bound.at::<S, ROUGH>(simd, [x, y, z].map(|axis| Lanes::load(simd, axis))).store(own_t);
            }
        },
    );
}
