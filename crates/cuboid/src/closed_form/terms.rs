//! The elements of the demagnetizing tensor that a polarization needs, with their coefficients.

use std::f64::consts::PI;

use crate::block::Block;
use crate::tolerances::DIRECT_DIAGONAL;

/// T_ab, an element of the demagnetizing tensor of a tile whose sides decrease along a, b, c.
pub const AB: usize = 0;
/// T_ac.
pub const AC: usize = 1;
/// T_bc.
pub const BC: usize = 2;
/// T_aa.
pub const AA: usize = 3;
/// T_bb.
pub const BB: usize = 4;
/// T_cc.
pub const CC: usize = 5;

/// The closed form that evaluates a cuboid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// The form of [`CornerGeometry::ratio`](super::elements::CornerGeometry::ratio) for all
    /// elements.
    Compact,
    /// The form of [`ratios_of_rod`](super::rod::ratios_of_rod) for T_bc and T_bb.
    Rod,
    /// The form of rods for T_ac and T_aa too, for points close to plates and rods.
    Thin,
}

/// Terms that differ at most in sign. They share a division and a series.
#[derive(Clone, Copy, Debug)]
pub struct Group {
    /// Whether the elements are diagonal: angles instead of logarithms.
    pub diagonal: bool,
    /// Contribution of one unit of half of 4 pi T to mu0 H, in tesla.
    pub coefficient: [f64; 3],
}

/// The elements that the polarization of one tile needs.
pub struct Terms {
    /// The closed form of the terms.
    pub form: Form,
    /// The axes a, b, c.
    pub axes: [usize; 3],
    /// Contribution of one unit of each element to the components of mu0 H, with a positive first
    /// nonzero component; zero if the element is not needed.
    pub coefficients: [[f64; 3]; 6],
    /// Length of the edges times the size across, area of the faces, or cross-section of a rod;
    /// scaled, with the sign of the term.
    pub factors: [f64; 6],
    /// The factors for [`Form::Compact`].
    pub compact: [f64; 6],
    /// Squares of the sizes along a, b, c, scaled.
    pub squares: [f64; 3],
}

impl Terms {
    /// The terms of a block whose lengths `scale` brings to order one.
    pub fn new(block: &Block, scale: f64, form: Form) -> Terms {
        let (size, j) = (block.size.map(|s| s * scale), block.polarization_t);
        let mut axes = [0, 1, 2];
        axes.sort_by(|&a, &b| size[b].total_cmp(&size[a]));
        let [a, b, c] = axes;
        let off_diagonal = |i: usize, k: usize| {
            let mut coefficient = [0.0; 3];
            (coefficient[i], coefficient[k]) = (j[k], j[i]);
            coefficient
        };
        // T_cc = -(T_aa + T_bb) loses less than the difference of two close faces, and costs
        // nothing if T_aa and T_bb are needed anyway.
        let by_trace = (j[a] != 0.0 && j[b] != 0.0) || size[c] < DIRECT_DIAGONAL * size[b] || form != Form::Compact;
        let diagonal = |axis: usize| {
            let mut coefficient = [0.0; 3];
            coefficient[axis] = j[axis];
            if by_trace {
                coefficient[c] = if axis == c { 0.0 } else { -j[c] };
            }
            coefficient
        };
        let [ab, ac, bc] = [size[a] * size[b], size[c] * size[a], size[b] * size[c]];
        let compact = [bc, bc, ac, bc, ac, ab];
        let factors = match form {
            Form::Compact => compact,
            Form::Rod => [bc, bc, bc, bc, bc, ab],
            Form::Thin => [bc, ac, bc, ac, bc, ab],
        };
        let mut terms = Terms {
            form,
            axes,
            coefficients: [
                off_diagonal(a, b),
                off_diagonal(a, c),
                off_diagonal(b, c),
                diagonal(a),
                diagonal(b),
                diagonal(c),
            ],
            factors,
            compact,
            squares: axes.map(|axis| size[axis] * size[axis]),
        };
        for (element, coefficient) in terms.coefficients.iter_mut().enumerate() {
            if coefficient.iter().find(|c| **c != 0.0).is_some_and(|c| *c < 0.0) {
                *coefficient = coefficient.map(|c| -c);
                terms.factors[element] = -terms.factors[element];
                terms.compact[element] = -terms.compact[element];
            }
            // Negative zeros are removed, so that equal coefficients have equal bits.
            *coefficient = coefficient.map(|c| c + 0.0);
        }
        terms
    }

    /// Volume of the tile, scaled.
    pub fn volume(&self) -> f64 {
        self.squares.iter().product::<f64>().sqrt()
    }

    /// Whether the polarization needs an element.
    pub fn is_needed(&self, element: usize) -> bool {
        self.coefficients[element] != [0.0; 3]
    }

    /// The group of an element.
    pub fn group(&self, element: usize) -> Group {
        Group { diagonal: element >= AA, coefficient: self.coefficients[element].map(|c| c / (2.0 * PI)) }
    }
}
