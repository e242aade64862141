//! A bound of the magnitude of a tile's field from the elements that its closed form computes.

use std::f64::consts::PI;

use magsplice_simd::lanes::Number;

use super::elements::{ElementSum, FieldSum};
use super::terms::{AA, BB, CC, Terms};
use crate::block::Block;
use crate::tolerances::MAGNITUDE_ROUNDING;

/// Weights from the squares of elements to a bound of the magnitude (docs/physics.md, Eq. P53).
pub struct MagnitudeTerms {
    /// Contribution of the square of half of 4 pi T to the square of the bound, by element.
    weights: [f64; 6],
    /// The weight of T_cc where it follows from the trace.
    by_trace: f64,
    /// The signs of T_aa and T_bb, by element.
    signs: [f64; 6],
    /// Sum of |J_k| in tesla, times the block's error weight.
    j_t: f64,
}

impl MagnitudeTerms {
    /// Prepares a block with its terms.
    pub fn new(block: &Block, terms: &Terms) -> MagnitudeTerms {
        let j_t = block.polarization_t.abs();
        let sum_t = j_t.element_sum().max(f64::MIN_POSITIVE);
        let [a, b, c] = terms.axes.map(|axis| j_t[axis] / sum_t / (2.0 * PI).powi(2));
        let direct = if terms.is_needed(CC) { c } else { 0.0 };
        // The terms have the sign with a positive first coefficient.
        let sign = |element: usize| {
            let (axis, last, j) = (terms.axes[element - AA], terms.axes[2], block.polarization_t);
            let [own, by_trace] = [axis, last].map(|axis| terms.coefficients[element][axis]);
            let is_kept = if j[axis] != 0.0 { own == j[axis] } else { by_trace == -j[last] };
            if is_kept { 1.0 } else { -1.0 }
        };
        MagnitudeTerms {
            weights: [a + b, a + c, b + c, a, b, direct],
            by_trace: c - direct,
            signs: [0.0, 0.0, 0.0, sign(AA), sign(BB), 0.0],
            j_t: sum_t * block.error_weight(),
        }
    }
}

/// mu0 H of a tile, and a bound of its magnitude.
pub struct FieldAndMagnitude<'a, N> {
    /// The field.
    pub field: FieldSum<'a, N>,
    terms: &'a MagnitudeTerms,
    /// The square of the bound over the square of the sum of |J_k|, without T_cc from the trace.
    square: N,
    /// T_aa + T_bb, as half of 4 pi T.
    trace: N,
}

impl<N: Number> ElementSum<N> for FieldAndMagnitude<'_, N> {
    #[inline(always)]
    fn add(&mut self, element: usize, half: N) {
        self.field.add(element, half);
        self.square = (half * half).scale_add(self.terms.weights[element], self.square);
        if element == AA || element == BB {
            self.trace = half.scale_add(self.terms.signs[element], self.trace);
        }
    }
}

impl<'a, N: Number> FieldAndMagnitude<'a, N> {
    /// Begins a sum.
    #[inline(always)]
    pub fn new(simd: N::Instructions, field: FieldSum<'a, N>, terms: &'a MagnitudeTerms) -> FieldAndMagnitude<'a, N> {
        FieldAndMagnitude { field, terms, square: N::splat(simd, 0.0), trace: N::splat(simd, 0.0) }
    }

    /// The bound, in tesla.
    #[inline(always)]
    pub fn magnitude_t(&self) -> N {
        let square = (self.trace * self.trace).scale_add(self.terms.by_trace, self.square);
        square.sqrt() * (self.terms.j_t * (1.0 + MAGNITUDE_ROUNDING))
    }
}
