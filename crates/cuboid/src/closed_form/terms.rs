//! What each tile needs of its demagnetizing tensor.

use std::f64::consts::PI;

use crate::block::Block;
use crate::tolerances::DIRECT_DIAGONAL;

/// Elements of the demagnetizing tensor of a tile whose sides along a, b, c fall in length.
pub const AB: usize = 0;
pub const AC: usize = 1;
pub const BC: usize = 2;
pub const AA: usize = 3;
pub const BB: usize = 4;
pub const CC: usize = 5;

/// Terms that differ in sign at most and share a division and a series.
#[derive(Clone, Copy, Debug)]
pub struct Group {
    /// Whether it is of diagonal elements: angles, not logarithms.
    pub diagonal: bool,
    /// What one unit of half of 4 pi T adds to mu0 H, in tesla.
    pub coefficient: [f64; 3],
}

/// What the polarization of one tile needs of its tensor.
pub struct Terms {
    /// The axes a, b, c.
    pub axes: [usize; 3],
    /// By element: what one unit adds to each component of mu0 H, its first component not zero positive; nothing if not needed.
    pub coefficients: [[f64; 3]; 6],
    pub factors: [f64; 6],
    pub squares: [f64; 3],
}

impl Terms {
    pub fn new(block: &Block, scale: f64) -> Terms {
        let (size, j) = (block.size.map(|s| s * scale), block.polarization_t);
        let mut axes = [0, 1, 2];
        axes.sort_by(|&a, &b| size[b].total_cmp(&size[a]));
        let [a, b, c] = axes;
        let off_diagonal = |i: usize, k: usize| {
            let mut coefficient = [0.0; 3];
            (coefficient[i], coefficient[k]) = (j[k], j[i]);
            coefficient
        };
        // T_cc = -(T_aa + T_bb) loses less than the difference of two faces close together, and is free if these are needed anyway.
        let by_trace = (j[a] != 0.0 && j[b] != 0.0) || size[c] < DIRECT_DIAGONAL * size[b];
        let diagonal = |axis: usize| {
            let mut coefficient = [0.0; 3];
            coefficient[axis] = j[axis];
            if by_trace {
                coefficient[c] = if axis == c { 0.0 } else { -j[c] };
            }
            coefficient
        };
        let mut terms = Terms {
            axes,
            coefficients: [
                off_diagonal(a, b),
                off_diagonal(a, c),
                off_diagonal(b, c),
                diagonal(a),
                diagonal(b),
                diagonal(c),
            ],
            factors: [
                size[b] * size[c],
                size[c] * size[b],
                size[c] * size[a],
                size[b] * size[c],
                size[c] * size[a],
                size[a] * size[b],
            ],
            squares: axes.map(|axis| size[axis] * size[axis]),
        };
        for (coefficient, factor) in terms.coefficients.iter_mut().zip(&mut terms.factors) {
            if coefficient.iter().find(|c| **c != 0.0).is_some_and(|c| *c < 0.0) {
                *coefficient = coefficient.map(|c| -c);
                *factor = -*factor;
            }
            // No zero is negative, so that equal coefficients have equal bits.
            *coefficient = coefficient.map(|c| c + 0.0);
        }
        terms
    }

    /// Of the tile, scaled.
    pub fn volume(&self) -> f64 {
        self.squares.iter().product::<f64>().sqrt()
    }

    pub fn is_needed(&self, element: usize) -> bool {
        self.coefficients[element] != [0.0; 3]
    }

    pub fn group(&self, element: usize) -> Group {
        Group { diagonal: element >= AA, coefficient: self.coefficients[element].map(|c| c / (2.0 * PI)) }
    }
}
