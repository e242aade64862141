//! The position of a tile's corners and planes in the tables of its cluster, and the groups of its
//! elements.

use magsplice_cuboid::closed_form::terms::{Form, Terms};

/// The corners, planes and groups of a tile in the tables of its cluster.
#[derive(Clone, Copy, Debug)]
pub struct TileTerms {
    /// The closed form in use.
    pub form: Form,
    /// Corners; bits 2, 1, 0 are set for the high side along a, b, c.
    pub corners: [u16; 8],
    /// Low and high plane along a, b, c.
    pub planes: [u16; 6],
    /// Group of each element; [`NO_GROUP`] if the element is not needed, [`OWN`] if no other tile
    /// has the same strength.
    pub groups: [u16; 6],
    /// Whether any of the groups is [`OWN`].
    pub has_own: bool,
    /// Contribution of one unit of half of 4 pi T to mu0 H, in tesla, by element.
    pub coefficients: [[f64; 3]; 6],
    /// See [`Terms::factors`].
    pub factors: [f64; 6],
    /// Squares of the sizes along a, b, c, scaled.
    pub squares: [f64; 3],
}

/// See [`TileTerms::groups`].
pub const NO_GROUP: u16 = u16::MAX;
/// See [`TileTerms::groups`].
pub const OWN: u16 = u16::MAX - 1;

impl TileTerms {
    /// The terms of a tile with these planes (low and high along x, y, z) and corners (bits 2, 1, 0
    /// set for the high side along x, y, z).
    pub(super) fn new(terms: &Terms, planes: [[u16; 2]; 3], corners: [u16; 8], groups: [u16; 6]) -> TileTerms {
        let [a, b, c] = terms.axes;
        TileTerms {
            form: terms.form,
            corners: [0, 1, 2, 3, 4, 5, 6, 7].map(|bits: usize| {
                corners[(bits >> 2) << (2 - a) | (bits >> 1 & 1) << (2 - b) | (bits & 1) << (2 - c)]
            }),
            planes: [0, 1, 2, 3, 4, 5].map(|n: usize| planes[terms.axes[n / 2]][n % 2]),
            groups,
            has_own: false,
            coefficients: [0, 1, 2, 3, 4, 5].map(|element| terms.group(element).coefficient),
            factors: terms.factors,
            squares: terms.squares,
        }
    }
}
