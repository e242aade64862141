//! What each tile needs of its demagnetizing tensor.

use std::f64::consts::PI;

use crate::block::Block;
use crate::tolerances::DIRECT_DIAGONAL;

/// Elements of the demagnetizing tensor of a tile whose sides along a, b, c fall in length.
pub(super) const AB: usize = 0;
pub(super) const AC: usize = 1;
pub(super) const BC: usize = 2;
pub(super) const AA: usize = 3;
pub(super) const BB: usize = 4;
pub(super) const CC: usize = 5;

/// Where a tile's corners and planes are in the tables, and the groups its elements belong to.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileTerms {
    /// Bits 2, 1, 0: low or high along a, b, c.
    pub(super) corners: [u16; 8],
    /// Low and high plane along a, b, c.
    pub(super) planes: [u16; 6],
    /// By element; [`NO_GROUP`] where it is not needed, [`OWN`] where no other tile's has its strength.
    pub(super) groups: [u16; 6],
    /// Whether there is such an element.
    pub(super) has_own: bool,
    /// The axes a, b, c.
    pub(super) axes: [usize; 3],
    /// By element: what one unit of half of 4 pi T adds to mu0 H, in tesla.
    pub(super) coefficients: [[f64; 3]; 6],
    /// Off the diagonal the length of the edges times the size across, on it the area of the faces. Scaled, with the sign of the term.
    pub(super) factors: [f64; 6],
    /// Squares of the sizes along a, b, c, scaled.
    pub(super) squares: [f64; 3],
}

/// See [`TileTerms::groups`].
pub(super) const NO_GROUP: u16 = u16::MAX;
/// See [`TileTerms::groups`].
pub(super) const OWN: u16 = u16::MAX - 1;

/// Terms that differ in sign at most and share a division and a series.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    /// Whether it is of diagonal elements: angles, not logarithms.
    pub(super) diagonal: bool,
    /// What one unit of half of 4 pi T adds to mu0 H, in tesla.
    pub(super) coefficient: [f64; 3],
}

/// What the polarization of one tile needs of its tensor.
pub(super) struct Terms {
    /// The axes a, b, c.
    pub(super) axes: [usize; 3],
    /// By element: what one unit adds to each component of mu0 H, its first component not zero positive; nothing if not needed.
    pub(super) coefficients: [[f64; 3]; 6],
    pub(super) factors: [f64; 6],
    pub(super) squares: [f64; 3],
}

impl Terms {
    pub(super) fn of(block: &Block, scale: f64) -> Terms {
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
    pub(super) fn volume(&self) -> f64 {
        self.squares.iter().product::<f64>().sqrt()
    }

    pub(super) fn is_needed(&self, element: usize) -> bool {
        self.coefficients[element] != [0.0; 3]
    }

    pub(super) fn group(&self, element: usize) -> Group {
        Group { diagonal: element >= AA, coefficient: self.coefficients[element].map(|c| c / (2.0 * PI)) }
    }

    /// With planes low and high along x, y, z, and corners whose bits 2, 1, 0 are set if high along x, y, z.
    pub(super) fn placed(&self, planes: [[u16; 2]; 3], corners: [u16; 8], groups: [u16; 6]) -> TileTerms {
        let [a, b, c] = self.axes;
        TileTerms {
            corners: [0, 1, 2, 3, 4, 5, 6, 7].map(|bits: usize| {
                corners[(bits >> 2) << (2 - a) | (bits >> 1 & 1) << (2 - b) | (bits & 1) << (2 - c)]
            }),
            planes: [0, 1, 2, 3, 4, 5].map(|n: usize| planes[self.axes[n / 2]][n % 2]),
            groups,
            has_own: false,
            axes: self.axes,
            coefficients: [0, 1, 2, 3, 4, 5].map(|element| self.group(element).coefficient),
            factors: self.factors,
            squares: self.squares,
        }
    }
}
