//! Points of a single tile whose field may be too weak for a tolerance.
//!
//! Most points are decided by their method. Where the series is used, the bound of the magnitude is
//! at most [`FAR_MAGNITUDE`] times the field. Elsewhere one bound holds for all points of a method.

use std::f64::consts::PI;

use glam::DVec3;
use magsplice_cuboid::block::Block;
use magsplice_cuboid::method::{CLOSED_FORM, FIRST_FAR, MethodIndex, MethodRanges, SMALL_ELEMENTS};
use magsplice_cuboid::tolerances::{EXACT_BOUND, LARGEST_FIELD_OVER_J, SMALL_ANGLE};
use magsplice_magnet::Tolerance;

use super::magnitude::{LEAST_COMPARED, LeastField, MagnitudeBounds};
use super::queues::OWN_QUEUE;
use crate::tolerances::{DECIDED_BY_DISTANCE, FAR_MAGNITUDE, NEAR_FIELD_OVER_J};

/// The comparison of fields with a tolerance, and the points where it fails.
#[derive(Debug)]
pub struct WeakPoints {
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

impl WeakPoints {
    /// Prepares the only block of a scene, whose tiles have these `magnitudes`.
    pub(super) fn new(
        tolerance: Tolerance,
        block: &Block,
        ranges: &MethodRanges,
        magnitudes: &MagnitudeBounds,
    ) -> WeakPoints {
        let least = LeastField::new(tolerance);
        let far_error_t = EXACT_BOUND * block.error_weight() * FAR_MAGNITUDE;
        let far_is_kept = least.at_t(far_error_t) <= 1.0 || {
            let half_diagonal = ranges.half_size.iter().map(|half| half * half).sum::<f64>().sqrt();
            let series_from = ranges.far.first().map_or(f64::INFINITY, |(square, _)| square.sqrt());
            let far_t = magnitudes.beyond_t((series_from - half_diagonal) / ranges.scale);
            least.at_t(EXACT_BOUND * far_t) == 0.0
        };
        let closed_form_t = magnitudes.beyond_t(ranges.closed_form_from.sqrt() / ranges.scale);
        // |T| is at most the integral of dV / 2 pi r^3.
        let small_t = SMALL_ANGLE / (2.0 * PI) * block.error_weight() * block.polarization_t.abs().element_sum();
        WeakPoints {
            least,
            closed_form_squared: [closed_form_t, small_t].map(|t| least.squared_at(EXACT_BOUND * t)),
            far_squared: if far_is_kept { LEAST_COMPARED.powi(2) } else { f64::INFINITY },
            near_squared: [NEAR_FIELD_OVER_J / LARGEST_FIELD_OVER_J, 1.0]
                .map(|share| least.squared_at(EXACT_BOUND * share * magnitudes.largest_t())),
            by_closed_form: !(least.at_t(EXACT_BOUND) <= DECIDED_BY_DISTANCE),
            points: Vec::new(),
        }
    }

    /// The same comparison with a bound from the closed form at each point, for other points;
    /// `None` if it had these bounds.
    pub(super) fn by_closed_form(&self) -> Option<WeakPoints> {
        (!self.by_closed_form).then(|| WeakPoints { by_closed_form: true, points: Vec::new(), ..*self })
    }

    /// Whether the closed form computes a bound of the magnitude at the points of a method.
    #[inline(always)]
    pub(super) fn needs_magnitudes(&self, method: MethodIndex) -> bool {
        self.by_closed_form && method < FIRST_FAR
    }

    /// Compares the fields at points of one method, in tesla, given by component.
    #[inline(always)]
    pub(super) fn check(&mut self, method: MethodIndex, places: &[u32], [x, y, z]: [&[f64]; 3], magnitudes_t: &[f64]) {
        let squares = x.iter().zip(y).zip(z).map(|((x, y), z)| x * x + y * y + z * z);
        // Without a branch for each point, because usually no field is weak.
        if self.needs_magnitudes(method) {
            let least = self.least;
            let is_weak = |(square, magnitude_t): (f64, &f64)| square < least.squared_at(EXACT_BOUND * magnitude_t);
            if squares.clone().zip(magnitudes_t).fold(false, |any, point| any | is_weak(point)) {
                let points = squares.zip(magnitudes_t).zip(places);
                let weak = points.filter(|(point, _)| is_weak(*point));
                self.points.extend(weak.map(|((_, magnitude_t), place)| (*place, *magnitude_t)));
            }
            return;
        }
        let least_squared = match method {
            CLOSED_FORM => self.closed_form_squared[0],
            SMALL_ELEMENTS => self.closed_form_squared[1],
            FIRST_FAR..OWN_QUEUE => self.far_squared,
            _ => self.near_squared[0],
        };
        if squares.clone().fold(false, |any, square| any | (square < least_squared)) {
            let weak = squares.zip(places).filter(|(square, _)| *square < least_squared);
            self.points.extend(weak.map(|(_, place)| (*place, f64::INFINITY)));
        }
    }

    /// Compares the field at one point close to the tile.
    pub(super) fn check_one(&mut self, place: u32, field_t: DVec3) {
        if field_t.length_squared() < self.near_squared[1] {
            self.points.push((place, f64::INFINITY));
        }
    }
}
