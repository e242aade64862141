//! The field that keeps a tolerance.

use fearless_simd::prelude::*;
use magsplice_magnet::Tolerance;
use magsplice_simd::lanes::{Lanes, Number};

/// Smallest length of a field whose square is a normal number, in any unit.
pub(crate) const LEAST_COMPARED: f64 = 1e-153;

/// The smallest field at which an error keeps a tolerance.
#[derive(Clone, Copy, Debug)]
pub struct LeastField {
    /// The field over the error.
    per_error: f64,
    /// The error allowed for any field, in tesla.
    allowed_t: f64,
}

impl LeastField {
    /// The smallest field for a tolerance.
    pub fn new(tolerance: Tolerance) -> LeastField {
        // Far above the round-off of the compared fields.
        const MARGIN: f64 = 1.0 + 1e-9;
        match tolerance {
            Tolerance::Relative { fraction, .. } => {
                LeastField { per_error: MARGIN * (1.0 + 1.0 / fraction), allowed_t: 0.0 }
            }
            Tolerance::AbsoluteT { error_t, .. } => LeastField { per_error: f64::INFINITY, allowed_t: error_t },
        }
    }

    /// An error in tesla that a field of this square keeps.
    pub fn error_t(self, square: f64) -> f64 {
        if square < LEAST_COMPARED * LEAST_COMPARED {
            return self.allowed_t;
        }
        self.allowed_t.max(square.sqrt() / self.per_error)
    }

    /// The smallest |B| in tesla for an error; infinite if no field allows it.
    #[inline(always)]
    pub fn at_t(self, error_t: f64) -> f64 {
        if error_t <= self.allowed_t { 0.0 } else { self.per_error * error_t }
    }

    /// Smallest |B|^2 in square tesla that allows an error. Squares that are normal numbers can be
    /// compared.
    #[inline(always)]
    pub fn squared_at(self, error_t: f64) -> f64 {
        let least_t = self.at_t(error_t);
        if least_t > 0.0 { least_t.max(LEAST_COMPARED).powi(2) } else { 0.0 }
    }

    /// [`LeastField::squared_at`] of a vector of errors.
    #[inline(always)]
    pub(crate) fn squared_in_vectors<S: Simd>(self, simd: S, error_t: Lanes<S>) -> Lanes<S> {
        let least_t = (error_t * self.per_error).max(Lanes::splat(simd, LEAST_COMPARED));
        error_t.where_more(self.allowed_t, least_t * least_t, Lanes::splat(simd, 0.0))
    }
}
